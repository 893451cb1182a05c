//! Grids over the number of filters and their pole or decay factor, in one pass over the records.
//!
//! Columns are nested in `L`, so one factorisation of the largest number of filters serves all smaller ones; and every
//! segment is factored by itself, so that leaving segments out costs no further pass.

use super::basis::{Basis, assemble};
use super::discrete::discrete_pass;
use super::form::{Form, number_of_filters};
use super::joint::JointFit;
use super::options::{TimeFit, TimeWeights};
use super::own::StaticTerm;
use super::time::continuous::RecordFit;
use super::time::pass::{ColumnOrder, Pass};
use super::time::record::Records;
use super::time::systems::{ForceSystems, Systems};
use crate::aerodynamics::DiscreteLaguerre;
use crate::error::{Result, ensure};
use crate::numbered::OnDone;
use crate::section::Dof;
use crate::trained_model::Model;
use crate::units::ReducedFrequencyRange;
use crate::wind_tunnel::RecordSource;
use nalgebra::DMatrix;
use std::rc::Rc;

/// What a grid is laid over.
#[derive(Debug, Clone, PartialEq)]
pub enum GridAxis {
    /// Discrete Laguerre filters: decay factors `α`, and the weights of the fit.
    Discrete(Vec<f64>, TimeWeights),
    /// Continuous Laguerre filters with feed-through: poles `p`; form, weights and low-pass are those of the fit.
    Continuous(Vec<f64>, Box<TimeFit>),
}

/// Factors of all candidates and stretches.
pub struct Grid {
    axis: GridAxis,
    /// Degrees of freedom of rows and columns.
    pub(crate) dofs: Vec<Dof>,
    /// Greatest number of filters.
    pub(crate) filters_max: usize,
    /// Reduced frequencies of the records.
    pub(crate) tested: ReducedFrequencyRange,
    delta_s: f64,
    /// Its stretches are in the order in which `keep` sees them.
    pub(crate) pass: Pass,
}

/// Fit of one cell.
#[derive(Debug, Clone, PartialEq)]
pub struct CellFit {
    /// The model.
    pub model: Model,
    /// Root mean square, over the transfer functions, of the relative residuals, as in the search of poles.
    pub objective: f64,
    /// Largest single term over the norm of the fit, of any transfer function.
    pub cancellation: f64,
    coefficients: Vec<DMatrix<f64>>,
}

impl Grid {
    /// One pass over the records.
    ///
    /// # Errors
    /// [`Error::Input`](crate::error::Error::Input) for an axis without values, no filters, records that cannot be read, do not fit together or move
    /// several degrees of freedom at once.
    pub fn new(
        records: &[&dyn RecordSource],
        axis: GridAxis,
        filters_max: usize,
        progress: OnDone<'_>,
    ) -> Result<Self> {
        ensure(
            !axis.values().is_empty() && filters_max != 0,
            "grid",
            "at least one value and one filter",
            "none",
        )?;
        number_of_filters("grid.filters", filters_max)?;
        let records = Records::read(records, StaticTerm::None)?;
        let tested = records.tested_range()?;
        let pass = axis.pass(&records, filters_max, progress)?;
        ensure(
            pass.stretches.iter().all(|s| s.set.len() <= 1),
            "records",
            "one moving degree of freedom a record",
            "several that move at once",
        )?;
        Ok(Self {
            axis,
            delta_s: records.longest_step(),
            dofs: records.dofs,
            filters_max,
            tested,
            pass,
        })
    }

    /// Values along the axis.
    pub fn values(&self) -> &[f64] {
        self.axis.values()
    }

    /// Symbol of the axis.
    pub(crate) fn symbol(&self) -> &'static str {
        match self.axis {
            GridAxis::Discrete(..) => "α",
            GridAxis::Continuous(..) => "p",
        }
    }

    /// All numbers of filters, from one to the greatest, of one value of the axis, fitted to the stretches for which
    /// `keep` is true.
    ///
    /// # Errors
    /// Stretches that do not determine the coefficients: as an entry of the list.
    pub fn fits(&self, value: usize, keep: &dyn Fn(usize) -> bool) -> Vec<Result<CellFit>> {
        let stretches = self.pass.stretches.iter().enumerate();
        let chosen = stretches.filter(|(s, _)| keep(*s)).map(|(_, c)| c);
        let systems = Rc::new(Systems::new(self.pass.order, chosen, value));
        let cell = |filters| self.cell(&systems, value, filters);
        (1..=self.filters_max).map(cell).collect()
    }

    fn leading(&self, filters: usize) -> usize {
        self.pass.order.per_input - self.filters_max + filters
    }

    fn cell(&self, systems: &Rc<Systems>, value: usize, filters: usize) -> Result<CellFit> {
        let per_input = self.leading(filters);
        let leading = self.pass.order.leading(per_input, self.dofs.len());
        let each = systems.whole.iter().map(|factor| factor.solve(leading));
        let mut coefficients = each.collect::<Result<Vec<_>>>()?;
        let mut objective = systems.objective(per_input, &|_, _| true);
        if let Some((constrained, own)) = self.constrained(systems, value, filters)? {
            objective = own;
            let n = self.dofs.len();
            for e in 0..n * n {
                for (c, x) in constrained.values(e).iter().enumerate() {
                    coefficients[e / n][self.pass.order.index(c, e % n)] = *x;
                }
            }
        }
        let mut cancellation: f64 = 0.0;
        for (set, factors) in systems.sets.iter().filter(|(set, _)| !set.is_empty()) {
            for (factor, all) in factors.iter().zip(&coefficients) {
                let own = self.own(set[0], per_input, all);
                cancellation = cancellation.max(factor.cancellation(&own, 0));
            }
        }
        Ok(CellFit {
            model: self.model(value, filters, &coefficients)?,
            objective,
            cancellation,
            coefficients,
        })
    }

    /// The fit under its constraints with its objective, where these are asked for and bind.
    fn constrained(
        &self,
        systems: &Rc<Systems>,
        value: usize,
        filters: usize,
    ) -> Result<Option<(JointFit, f64)>> {
        let GridAxis::Continuous(poles, fit) = &self.axis else {
            return Ok(None);
        };
        let requirements = fit.requirements(&self.dofs, self.tested)?;
        if !requirements.any() {
            return Ok(None);
        }
        let form = with_filters(&fit.form, filters);
        let basis = Basis::orthonormal(&form, &vec![poles[value]; filters])?;
        let held = ForceSystems::held_alike(systems, basis, &requirements)?;
        Ok(Some(held).filter(|(joint, _)| joint.constrained.is_some()))
    }

    /// Coefficients that a system of input `j` alone takes: the constant, if any, then that input's.
    fn own(&self, j: usize, per_input: usize, all: &DMatrix<f64>) -> Vec<f64> {
        let constant = self.pass.order.constant.then(|| all[0]);
        let columns = (0..per_input).map(|c| all[self.pass.order.index(c, j)]);
        constant.into_iter().chain(columns).collect()
    }

    fn model(&self, value: usize, filters: usize, all: &[DMatrix<f64>]) -> Result<Model> {
        let n = self.dofs.len();
        let per_input = self.leading(filters);
        match &self.axis {
            GridAxis::Discrete(alphas, _) => {
                let of_motion =
                    |j| DMatrix::from_fn(n, filters, |i, l| all[i][self.pass.order.index(l, j)]);
                let model = DiscreteLaguerre::shared(
                    self.dofs.clone(),
                    alphas[value],
                    self.delta_s,
                    (0..n).map(of_motion).collect(),
                    all.iter().map(|c| c[0]).collect(),
                );
                model.validate()?;
                Ok(Model::DiscreteLaguerre(model))
            }
            GridAxis::Continuous(poles, fit) => {
                let form = with_filters(&fit.form, filters);
                let of_entry = |e: usize| {
                    let at = |c| self.pass.order.index(c, e % n);
                    (0..per_input).map(|c| all[e / n][at(c)]).collect()
                };
                let coefficients: Vec<Vec<f64>> = (0..n * n).map(of_entry).collect();
                let chains = vec![vec![poles[value]; filters]; n * n];
                assemble(&form, &self.dofs, &chains, &coefficients)
            }
        }
    }

    /// Sum of squared residuals and of squared data of every force, weighted, in one stretch; `None` in one at rest.
    pub(crate) fn residuals(
        &self,
        stretch: usize,
        value: usize,
        fit: &CellFit,
    ) -> Option<Vec<(f64, f64)>> {
        let stretch = &self.pass.stretches[stretch];
        let &j = stretch.set.first()?;
        let factor = &stretch.factors[value];
        let sums = fit.coefficients.iter().enumerate().map(|(i, all)| {
            let per_input = (all.len() - usize::from(self.pass.order.constant)) / self.dofs.len();
            let mut own = self.own(j, per_input, all);
            own.resize(factor.columns(), 0.0);
            let square = stretch.weights[i].powi(2);
            let residual = factor.residual_sum_of(&own, i);
            (square * residual, square * factor.total_sum(i))
        });
        Some(sums.collect())
    }
}

impl GridAxis {
    /// Values along the axis.
    pub fn values(&self) -> &[f64] {
        match self {
            Self::Discrete(values, _) | Self::Continuous(values, _) => values,
        }
    }

    /// One pass over the records with the filters of all values, every segment factored by itself.
    fn pass(&self, records: &Records, filters: usize, progress: OnDone<'_>) -> Result<Pass> {
        let inputs = records.dofs.len();
        match self {
            Self::Discrete(alphas, weights) => {
                for &a in alphas {
                    ensure(a > 0.0 && a < 1.0, "alpha", "0 < alpha < 1", a)?;
                }
                let order = ColumnOrder {
                    inputs,
                    per_input: filters,
                    constant: true,
                };
                let alphas: Vec<Vec<f64>> = alphas.iter().map(|a| vec![*a; inputs]).collect();
                discrete_pass(records, order, &alphas, *weights, 1, progress)
            }
            Self::Continuous(poles, fit) => {
                let task = RecordFit {
                    fit: &TimeFit {
                        form: with_filters(&fit.form, filters),
                        static_term: StaticTerm::None,
                        ..(**fit).clone()
                    },
                    records,
                    progress,
                };
                let everywhere = |p: &f64| -> Result<Vec<Basis>> {
                    let basis = Basis::orthonormal(&task.fit.form, &vec![*p; filters])?;
                    Ok(vec![basis; inputs])
                };
                let bases: Vec<_> = poles.iter().map(everywhere).collect::<Result<_>>()?;
                task.pass(&bases, task.thinning(), 1, 1, 1)
            }
        }
    }
}

fn with_filters(form: &Form, filters: usize) -> Form {
    Form::Laguerre {
        filters: Some(filters),
        feed_through: form.feed_through(),
        pole_per_transfer_function: false,
    }
}

#[cfg(test)]
mod tests;
