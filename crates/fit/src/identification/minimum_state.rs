//! Fit of the minimum-state form.
//!
//! For given lags and `E` each force is linear in its row of `D` and its feed-through, so only lags and `E` are searched
//! (variable projection), by Levenberg–Marquardt from several starts: Roger's fit with as many lags, whose lag matrices
//! are reduced to rank one, and Karpel's choice, every state driven by one motion. Columns of `D` and rows of `E` may be
//! scaled against each other; `E` gets rows of unit length.

mod constrained;

use super::basis::Basis;
use super::constrained::{LinearProblem, LinearSolution};
use super::dissipative::{ActiveConstraint, Constraints, FitRequirements};
use super::entry_report::EntryReport;
use super::form::{FeedThrough, Form};
use super::options::FrequencyFit;
use super::report::{FitReport, Fitted, SearchPoint, SearchReport};
use super::samples::{EntrySamples, shares};
use super::search::{Bounds, descend, search_poles};
use crate::aerodynamics::MinimumStateModel;
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::trained_model::Model;
use crate::units::ReducedFrequencyRange;
use nalgebra::{Complex, DMatrix, DVector};

/// Descents that follow each other from where the last one ended: each starts with a fresh damping.
const ROUNDS: usize = 3;

/// Everything that stays the same during the search.
struct LagSearch<'a> {
    entries: &'a [EntrySamples],
    /// Weight of the residuals of each entry.
    shares: Vec<f64>,
    n: usize,
    states: usize,
    feed: FeedThrough,
    /// The lags where they are given, and the bounds of their search where not.
    given: Option<&'a Vec<f64>>,
    bounds: Option<Bounds>,
    /// What is asked besides, once least squares alone are known.
    requirements: Option<FitRequirements>,
}

/// Fits the minimum-state form to the entries of `G`.
///
/// # Errors
/// [`Error::Input`] for bounds without room and samples that do not determine the coefficients.
pub(super) fn fit_minimum_state(
    entries: &[EntrySamples],
    dofs: &[Dof],
    fit: &FrequencyFit,
    tested: ReducedFrequencyRange,
) -> Result<Fitted> {
    let states = fit.form.filters();
    let mut task = LagSearch {
        entries,
        shares: shares(&entries.iter().collect::<Vec<_>>()),
        n: dofs.len(),
        states,
        feed: fit.form.feed_through(),
        given: fit.poles.fixed.as_ref(),
        bounds: match fit.poles.fixed {
            Some(_) => None,
            None => Some(Bounds::resolve(&fit.poles, tested, &fit.form)?),
        },
        requirements: None,
    };
    let (best, points) = task.search(fit)?;
    let mut search = Vec::new();
    if let Some(bounds) = task.bounds {
        search.push(SearchReport::new(None, [bounds.min, bounds.max], points)?);
    }
    let (alone, _) = task.finish(dofs, &best, tested, search)?;
    if fit.constraints == Constraints::None {
        return Ok(alone);
    }
    task.requirements = Some(FitRequirements::new(dofs, tested, fit.constraints));
    task.constrain(dofs, best, tested, alone)
}

impl LagSearch<'_> {
    /// Where the best of the descents from all starts ends, and where each does.
    fn search(&self, fit: &FrequencyFit) -> Result<(Vec<f64>, Vec<SearchPoint>)> {
        let mut points = Vec::new();
        let mut best: Option<(f64, Vec<f64>)> = None;
        for start in self.starts(fit)? {
            let at = self.descended(start);
            let Ok(residuals) = self.residuals(at.as_slice()) else {
                continue;
            };
            let objective = residuals.norm();
            points.push(SearchPoint {
                poles: self.lags_at(at.as_slice()),
                objective,
            });
            if objective.is_finite() && best.as_ref().is_none_or(|(o, _)| objective < *o) {
                best = Some((objective, self.normalised(at.as_slice())));
            }
        }
        if let Some((_, best)) = best {
            return Ok((best, points));
        }
        // the first start says what is wrong
        self.residuals(&self.starts(fit)?[0])?;
        let what = "minimum-state form: no start leads to a finite fit";
        Err(Error::Numerical(what.into()))
    }

    /// Where descents that follow each other end.
    fn descended(&self, start: Vec<f64>) -> DVector<f64> {
        let again = |at, _| descend(at, &|x| self.residuals(x).ok());
        (0..ROUNDS).fold(DVector::from_vec(start), again)
    }

    /// Points of the search: variables of the lags, if they are searched, then `E` row by row.
    fn starts(&self, fit: &FrequencyFit) -> Result<Vec<Vec<f64>>> {
        let mut lags = Vec::new();
        lags.extend(self.given.or(fit.poles.start.as_ref()).cloned());
        if let Some(bounds) = self.bounds.filter(|_| lags.is_empty()) {
            let residuals = |poles: &[f64]| self.residuals_of_roger(poles);
            let found = search_poles(self.states, &fit.poles, bounds, None, &residuals);
            lags.extend(found.ok().map(|found| found.chosen.poles));
            lags.push(bounds.poles(&vec![0.0; self.states]));
        }
        let mut starts = Vec::new();
        for lags in &lags {
            let variables = self.bounds.map_or_else(Vec::new, |b| b.free(lags));
            let mut push = |e: Vec<f64>| starts.push([variables.clone(), e].concat());
            if let Ok(e) = self.rank_one(lags) {
                push(e);
            }
            for shift in 0..self.n {
                push(self.driven_by_one(shift));
            }
        }
        Ok(starts)
    }

    fn residuals_of_roger(&self, poles: &[f64]) -> Result<DVector<f64>> {
        let basis = Basis::orthonormal(&self.roger(), poles)?;
        let mut all = Vec::new();
        for (entry, share) in self.entries.iter().zip(&self.shares) {
            let fit = entry.fit(&basis)?;
            all.extend(entry.weighted_residuals(&basis, &fit.coefficients, *share));
        }
        Ok(DVector::from_vec(all))
    }

    /// Directions in which the lag matrices of Roger's fit are strongest.
    fn rank_one(&self, lags: &[f64]) -> Result<Vec<f64>> {
        let basis = self.roger_basis(lags)?;
        let feed = self.feed.count();
        let mut terms = vec![DMatrix::zeros(self.n, self.n); self.states];
        for (at, entry) in self.entries.iter().enumerate() {
            let coefficients = entry.fit(&basis)?.coefficients;
            for (l, term) in terms.iter_mut().enumerate() {
                term[(at / self.n, at % self.n)] = coefficients[feed + l];
            }
        }
        let mut e = Vec::new();
        for term in terms {
            let none = || Error::Numerical("minimum-state form: no singular vectors".into());
            let v = term.svd(false, true).v_t.ok_or_else(none)?;
            e.extend(v.row(0).iter());
        }
        Ok(e)
    }

    /// State `l` driven by the motion `l + shift`, with a little of the others so that none stays zero by symmetry.
    fn driven_by_one(&self, shift: usize) -> Vec<f64> {
        let entry = |l: usize, j: usize| if (l + shift) % self.n == j { 1.0 } else { 0.1 };
        let rows = (0..self.states).flat_map(|l| (0..self.n).map(move |j| entry(l, j)));
        rows.collect()
    }

    fn lags_at(&self, x: &[f64]) -> Vec<f64> {
        let searched = || self.bounds.map(|b| b.poles(&x[..self.states]));
        self.given.cloned().or_else(searched).unwrap_or_default()
    }

    /// `E`, m×n.
    fn e_at(&self, x: &[f64]) -> DMatrix<f64> {
        let tail = &x[x.len() - self.states * self.n..];
        DMatrix::from_row_slice(self.states, self.n, tail)
    }

    /// The same point with rows of `E` of unit length, the largest number of each positive.
    fn normalised(&self, x: &[f64]) -> Vec<f64> {
        let mut x = x.to_vec();
        let at = x.len() - self.states * self.n;
        for row in x[at..].chunks_mut(self.n) {
            let norm = row.iter().map(|e| e * e).sum::<f64>().sqrt();
            let larger = |a: f64, e: &f64| if e.abs() > a.abs() { *e } else { a };
            let largest = row.iter().fold(0.0, larger);
            if norm > 0.0 {
                row.iter_mut().for_each(|e| *e /= norm * largest.signum());
            }
        }
        x
    }

    fn residuals(&self, x: &[f64]) -> Result<DVector<f64>> {
        let rows = self.rows(x, false)?;
        let mut all = Vec::new();
        for (i, problem) in rows.problems.iter().enumerate() {
            let values = &rows.values[i];
            for (row, right) in problem.rows.iter().zip(&problem.right) {
                let fitted: f64 = row.iter().zip(values).map(|(a, c)| a * c).sum();
                all.push(right - fitted);
            }
            all.extend(rows.solutions[i].penalty(values));
        }
        Ok(DVector::from_vec(all))
    }

    fn solve(&self, i: usize, problem: &LinearProblem) -> Result<LinearSolution> {
        let force = self.entries[i * self.n].force.name();
        let per_entry = self.feed.count();
        let name = |c: usize| match c.checked_sub(self.n * per_entry) {
            Some(l) => format!("D of state {}", l + 1),
            None => format!("the feed-through of motion {}", c / per_entry + 1),
        };
        problem.solve(&format!("samples of the {force} force"), &name)
    }

    /// Least squares for one force: the feed-through of each motion, then its row of `D`.
    fn row(&self, i: usize, lags: &[f64], e: &DMatrix<f64>) -> LinearProblem {
        let feed = self.feed.count();
        let width = self.n * feed + self.states;
        let entries = &self.entries[i * self.n..(i + 1) * self.n];
        let mut problem = LinearProblem {
            ridge: vec![0.0; width],
            ..LinearProblem::default()
        };
        for (j, entry) in entries.iter().enumerate() {
            let share = self.shares[i * self.n + j];
            for row in &entry.rows {
                let p = Complex::new(0.0, row.k);
                let mut columns = vec![Complex::new(0.0, 0.0); width];
                for (c, order) in self.feed.orders().enumerate() {
                    columns[j * feed + c] = p.powu(order as u32);
                }
                for (l, d) in lags.iter().enumerate() {
                    columns[self.n * feed + l] = p / (p + d) * e[(l, j)];
                }
                let weight = row.weight * share;
                let seen = row.seen(&columns).map(|x| weight * x);
                problem.rows.push(seen.collect());
                problem.right.push(weight * row.value);
            }
            for (order, target) in entry.limit.into_iter().enumerate() {
                let Some(target) = target else { continue };
                let mut functional = vec![0.0; width];
                if let Some(c) = self.feed.orders().position(|o| o == order) {
                    functional[j * feed + c] = 1.0;
                }
                if order == 1 {
                    for (l, d) in lags.iter().enumerate() {
                        functional[self.n * feed + l] = e[(l, j)] / d;
                    }
                }
                problem.constraints.push((functional, target));
            }
            problem.ridge[self.n * feed..].fill(entry.ridge);
        }
        problem
    }

    /// The model at one point with the account of its fit, and the constraints that bind there.
    fn finish(
        &self,
        dofs: &[Dof],
        x: &[f64],
        tested: ReducedFrequencyRange,
        search: Vec<SearchReport>,
    ) -> Result<(Fitted, Option<Vec<ActiveConstraint>>)> {
        let rows = self.rows(x, true)?;
        let model = self.model_of(dofs, x, &rows.values);
        model.validate()?;
        let reports = self.reports(&model, &rows.values, &rows.solutions)?;
        let fitted = Fitted {
            model: Model::MinimumState(model),
            report: FitReport::new(tested, reports, search),
        };
        Ok((fitted, rows.active))
    }

    /// Feed-through and `D` from the coefficients of every force.
    fn model_of(&self, dofs: &[Dof], x: &[f64], values: &[Vec<f64>]) -> MinimumStateModel {
        let (n, feed) = (self.n, self.feed.count());
        let of_order = |order: usize| {
            let column = self.feed.orders().position(|o| o == order);
            DMatrix::from_fn(n, n, |i, j| column.map_or(0.0, |c| values[i][j * feed + c]))
        };
        MinimumStateModel {
            dofs: dofs.to_vec(),
            a1: of_order(0),
            a2: of_order(1),
            a3: of_order(2),
            lags: self.lags_at(x),
            d: DMatrix::from_fn(n, self.states, |i, l| values[i][n * feed + l]),
            e: self.e_at(x),
        }
    }

    fn reports(
        &self,
        model: &MinimumStateModel,
        values: &[Vec<f64>],
        solutions: &[LinearSolution],
    ) -> Result<Vec<EntryReport>> {
        let (n, feed) = (self.n, self.feed.count());
        let basis = self.roger_basis(&model.lags)?;
        let mut reports = Vec::new();
        for (at, entry) in self.entries.iter().enumerate() {
            let (i, j) = (at / n, at % n);
            let mut own = values[i][j * feed..(j + 1) * feed].to_vec();
            own.extend((0..self.states).map(|l| model.d[(i, l)] * model.e[(l, j)]));
            let residuals = entry.residuals(&basis, &own);
            let report = entry.report(&residuals, &model.lags, &solutions[i]);
            // the product of D and E is not linear in what was searched: no standard errors
            reports.push(report.with_coefficients(basis.names(), &own, None));
        }
        Ok(reports)
    }

    /// Roger's form with as many lags.
    fn roger(&self) -> Form {
        Form::Rational {
            lags: self.states,
            added_mass: self.feed.e2,
        }
    }

    fn roger_basis(&self, lags: &[f64]) -> Result<Basis> {
        Basis::new(&self.roger(), lags)
    }
}
