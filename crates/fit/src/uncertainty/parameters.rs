//! What the parameters of a fit with searched poles are: its coefficients, the poles that a search found inside its
//! bounds, and the directions that active constraints leave to them.

use crate::error::{Error, Result, counted, ensure};
use crate::identification::affine::AffineSpace;
use crate::identification::basis::Basis;
use crate::identification::dissipative::{NOTHING_HELD, SAME_DIRECTION};
use crate::identification::form::number_of_filters;
use crate::identification::{Coefficient, EntryReport, FitReport, Form, OwnFilters, PoleSearch};
use crate::section::Dof;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// Relative step of central differences with respect to poles.
pub(super) const STEP: f64 = 1e-5;
/// Poles closer than this to a bound, relatively, are held by it.
const AT_BOUND: f64 = 0.01;

/// One estimated number of a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parameter {
    /// Name as in the equations; `pole 0` and so on for poles that were searched.
    pub name: String,
    /// Force it belongs to; none for poles that all transfer functions share.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<Dof>,
    /// Motion it belongs to; none for shared poles and static terms.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<Dof>,
    /// Estimate, dimensionless.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
}

impl Parameter {
    /// Before its error is known.
    pub(super) fn new(name: String, force: Option<Dof>, motion: Option<Dof>, value: f64) -> Self {
        Self {
            name,
            force,
            motion,
            value,
            standard_error: 0.0,
        }
    }
}

/// A pole among the parameters.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SearchedPole {
    /// Row and column of its transfer function; `None` when all share it but those apart.
    pub entry: Option<(usize, usize)>,
    /// Rows and columns of the transfer functions that have filters of their own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub apart: Vec<(usize, usize)>,
    /// Place among the free poles.
    pub index: usize,
}

impl SearchedPole {
    /// Whether the transfer function `(i, j)` has it.
    pub(super) fn is_of(&self, i: usize, j: usize) -> bool {
        match self.entry {
            Some(entry) => entry == (i, j),
            None => !self.apart.contains(&(i, j)),
        }
    }

    /// Gives it another value in the poles of every transfer function that has it; these come row by row.
    pub(super) fn move_to(&self, value: f64, form: &Form, chains: &mut [Vec<f64>]) {
        let n = chains.len().isqrt();
        let own = chains.iter_mut().enumerate();
        for (_, chain) in own.filter(|(e, _)| self.is_of(e / n, e % n)) {
            *chain = form.with_pole(chain, self.index, value);
        }
    }
}

/// Coefficients of every transfer function, one after the other in `values`.
pub(super) fn per_chain(form: &Form, chains: &[Vec<f64>], values: &[f64]) -> Vec<Vec<f64>> {
    let mut rest = values.iter().copied();
    let counts = chains.iter().map(|c| form.feed_through().count() + c.len());
    counts.map(|n| rest.by_ref().take(n).collect()).collect()
}

/// How parameters make a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Coordinates {
    /// Coefficients of every transfer function row by row, each in the order of its columns; then the searched poles.
    Continuous {
        /// Form of the model.
        form: Form,
        /// Poles of every transfer function, one per filter, row by row.
        chains: Vec<Vec<Vec<f64>>>,
        /// Poles that are parameters.
        searched: Vec<SearchedPole>,
    },
    /// For each force its static term, then the coefficients of every motion.
    Discrete {
        /// Decay factor.
        alpha: f64,
        /// Step `Δs`.
        delta_s: f64,
        /// Number of filters.
        filters: usize,
    },
}

impl Coordinates {
    /// Number of parameters that a model of `n` motions has in them.
    ///
    /// # Errors
    /// [`Error::Input`](crate::error::Error::Input) for coordinates that make no such model.
    pub(super) fn parameters(&self, n: usize) -> Result<usize> {
        let (form, chains, searched) = match self {
            Self::Discrete { filters, .. } => {
                number_of_filters("coordinates.filters", *filters)?;
                return Ok(n * (1 + n * filters));
            }
            Self::Continuous {
                form,
                chains,
                searched,
            } => (form, chains, searched),
        };
        let square = chains.len() == n && chains.iter().all(|row| row.len() == n);
        let expected = format_args!("poles of {n}×{n} transfer functions");
        ensure(square, "coordinates.chains", expected, "of others")?;
        let all = chains.concat();
        let alike = !form.has_lags() || all.iter().all(|c| c.len() == all[0].len());
        let expected = "as many lags for every transfer function";
        ensure(alike, "coordinates.chains", expected, "others")?;
        let lacks = |pole: &&SearchedPole| {
            let mut own = all.iter().enumerate();
            own.any(|(e, c)| pole.is_of(e / n, e % n) && pole.index >= form.collapse(c).len())
        };
        if let Some(SearchedPole { index, .. }) = searched.iter().find(lacks) {
            let expected = "the place of a pole that its transfer functions have";
            return Err(Error::input(
                "coordinates.searched",
                expected,
                index.to_string(),
            ));
        }
        let count = form.feed_through().count() * all.len();
        Ok(count + all.iter().map(Vec::len).sum::<usize>() + searched.len())
    }
}

/// How the assumption of a covariance says that searched poles are in it.
pub(crate) const SEARCHED_POLES: &str =
    "searched poles are parameters through their Jacobian columns";

/// The parameters of a fit: its coefficients row by row, then the poles that a search left free to follow the data.
pub(super) struct FitParameters {
    /// With the number of filters that the fit has chosen.
    pub form: Form,
    pub all: Vec<Parameter>,
    /// First parameter of every transfer function.
    pub first: Vec<usize>,
    pub searched: Vec<SearchedPole>,
    /// Poles that the bounds or the least ratio of the search hold.
    held: usize,
}

impl FitParameters {
    /// Those of a fit; transfer functions with `own` filters do not share the poles of the others.
    pub(super) fn new(
        form: &Form,
        options: &PoleSearch,
        own: &[OwnFilters],
        report: &FitReport,
    ) -> Self {
        let form = report.form_fitted(form, own);
        let (mut all, mut first) = (Vec::new(), Vec::new());
        for entry in &report.entries {
            first.push(all.len());
            let (force, motion) = (Some(entry.force), Some(entry.motion));
            let parameter =
                |c: &Coefficient| Parameter::new(c.name.clone(), force, motion, c.value);
            all.extend(entry.coefficients.iter().map(parameter));
        }
        let (mut searched, mut held) = (Vec::new(), 0);
        let mut dofs: Vec<Dof> = report.entries.iter().map(|e| e.motion).collect();
        dofs.sort();
        dofs.dedup();
        let place = |dof: Dof| dofs.iter().position(|d| *d == dof).unwrap_or(0);
        let apart: Vec<_> = own.iter().map(|o| (o.force, o.motion)).collect();
        for search in &report.search {
            // the poles in use: a search may end between the points it evaluated
            let has_them = |e: &&EntryReport| match search.entry {
                Some(entry) => entry == (e.force, e.motion),
                None => !apart.contains(&(e.force, e.motion)),
            };
            let used = report.entries.iter().find(has_them);
            let used = used.map_or_else(Vec::new, |e| form.collapse(&e.poles));
            for (index, pole) in used.iter().enumerate() {
                let near = |bound: f64| (pole / bound).ln().abs() < AT_BOUND;
                let pressed =
                    index > 0 && pole / used[index - 1] < (1.0 + AT_BOUND) * options.min_ratio;
                if near(search.min) || near(search.max) || pressed {
                    held += 1;
                    continue;
                }
                searched.push(SearchedPole {
                    entry: search.entry.map(|(f, m)| (place(f), place(m))),
                    apart: apart.iter().map(|(f, m)| (place(*f), place(*m))).collect(),
                    index,
                });
                let (force, motion) = search.entry.unzip();
                let name = format!("pole {index}");
                all.push(Parameter::new(name, force, motion, *pole));
            }
        }
        Self {
            form,
            all,
            first,
            searched,
            held,
        }
    }

    /// How poles enter, in words.
    pub(crate) fn sentence(&self) -> String {
        let searched = match self.searched.is_empty() {
            true => "poles count as known",
            false => SEARCHED_POLES,
        };
        let held = match self.held {
            0 => String::new(),
            n => {
                let poles = counted(n, "pole");
                format!("; counted as known: {poles} held by a bound of the search")
            }
        };
        searched.to_owned() + &held
    }

    /// How they make the model.
    pub(super) fn coordinates(&self, report: &FitReport) -> Coordinates {
        let rows = report.entries.chunks(report.entries.len().isqrt());
        let chains = rows.map(|row| row.iter().map(|e| e.poles.clone()).collect());
        Coordinates::Continuous {
            form: self.form.clone(),
            chains: chains.collect(),
            searched: self.searched.clone(),
        }
    }

    /// Orthonormal directions that the active constraints of a fit leave to its parameters, P×q; all where nothing
    /// holds it.
    pub(super) fn tangent(&self, report: &FitReport) -> Result<DMatrix<f64>> {
        let parameters = self.all.len();
        let Some(constraints) = &report.constraints else {
            return Ok(DMatrix::identity(parameters, parameters));
        };
        let mut gradients = vec![DVector::zeros(parameters); constraints.active.len()];
        // squares of the gradients of what is held, whatever the limit does
        let mut constrained_squares = vec![0.0; gradients.len()];
        let n = report.entries.len().isqrt();
        for (e, entry) in report.entries.iter().enumerate() {
            let (i, j) = (e / n, e % n);
            let values = entry.values();
            let basis = Basis::new(&self.form, &entry.poles)?;
            let each = gradients.iter_mut().zip(&mut constrained_squares);
            for ((gradient, square), active) in each.zip(&constraints.active) {
                let own = active.gradient_beyond_limit(i, j, &basis);
                gradient.as_mut_slice()[self.first[e]..][..own.len()].copy_from_slice(&own);
                let held = active.gradient(i, j, &basis);
                *square += held.iter().map(|x| x * x).sum::<f64>();
            }
            for (m, pole) in self.searched.iter().enumerate() {
                if !pole.is_of(i, j) {
                    continue;
                }
                let step = 2.0 * STEP * entry.poles[pole.index];
                let (up, down) = moved_pole(&self.form, &entry.poles, pole.index)?;
                for (gradient, active) in gradients.iter_mut().zip(&constraints.active) {
                    // what the transfer function adds to what the constraint holds beyond its limit
                    let value = |b: &Basis| -> f64 {
                        let gradient = active.gradient_beyond_limit(i, j, b);
                        gradient.iter().zip(&values).map(|(g, v)| g * v).sum()
                    };
                    let at = parameters - self.searched.len() + m;
                    gradient[at] += (value(&up) - value(&down)) / step;
                }
            }
        }
        let mut space = AffineSpace::whole(parameters);
        for (gradient, square) in gradients.iter().zip(constrained_squares) {
            if gradient.norm_squared() > NOTHING_HELD.powi(2) * square {
                space.hold(gradient, 0.0, SAME_DIRECTION);
            }
        }
        Ok(space.basis())
    }
}

/// The columns of a chain with one of its free poles a little larger, and a little smaller.
pub(super) fn moved_pole(form: &Form, chain: &[f64], index: usize) -> Result<(Basis, Basis)> {
    let moved =
        |factor: f64| Basis::new(form, &form.with_pole(chain, index, factor * chain[index]));
    Ok((moved(1.0 + STEP)?, moved(1.0 - STEP)?))
}

/// How active constraints enter, in words.
pub(super) fn constraint_sentence(report: &FitReport) -> String {
    let Some(constraints) = &report.constraints else {
        return String::new();
    };
    let active = &constraints.active;
    let follows = match active.iter().any(|a| a.limit.is_some()) {
        true => ", but not the growth with which the tests end: it follows the data",
        false => "",
    };
    let held = counted(active.len(), "active constraint");
    format!("; what is held by {held} counts as known{follows}")
}
