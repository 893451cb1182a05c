//! The minimum-state form under constraints: for given lags and `E` they are convex in `D` and the feed-through of all forces.

use super::{Fitted, LagSearch, LinearProblem, LinearSolution};
use crate::error::Result;
use crate::identification::affine::AffineMap;
use crate::identification::dissipative::{ActiveConstraint, ConstraintReport};
use crate::identification::joint::JointFit;
use crate::identification::report::SearchPoint;
use crate::section::Dof;
use crate::units::ReducedFrequencyRange;
use nalgebra::DMatrix;

/// All forces at one point of the search.
pub(super) struct FittedForces {
    pub problems: Vec<LinearProblem>,
    pub solutions: Vec<LinearSolution>,
    /// Coefficients of each force.
    pub values: Vec<Vec<f64>>,
    /// What holds them.
    pub active: Option<Vec<ActiveConstraint>>,
}

impl LagSearch<'_> {
    /// The fit under its constraints, searched from the best point of least squares alone; that fit where nothing binds.
    pub(super) fn constrain(
        &self,
        dofs: &[Dof],
        best: Vec<f64>,
        tested: ReducedFrequencyRange,
        alone: Fitted,
    ) -> Result<Fitted> {
        if self.rows(&best, true)?.active.is_none() {
            return Ok(alone);
        }
        let point = self.normalised(self.descended(best).as_slice());
        let mut search = alone.report.search.clone();
        for report in &mut search {
            report.chosen = SearchPoint {
                poles: self.lags_at(&point),
                objective: self.residuals(&point)?.norm(),
            };
            report.points.push(report.chosen.clone());
        }
        let (mut fitted, active) = self.finish(dofs, &point, tested, search)?;
        let before = &alone.report.entries;
        let bases = vec![self.roger_basis(&before[0].poles)?; self.entries.len()];
        fitted.report.constraints = active.map(|active| {
            let with = &fitted.report.entries;
            ConstraintReport::new(active, dofs, before, &bases, with, alone.model)
        });
        Ok(fitted)
    }

    /// Coefficients of every force at one point, under the constraints once these are asked for.
    pub(super) fn rows(&self, x: &[f64], everywhere: bool) -> Result<FittedForces> {
        let (lags, e) = (self.lags_at(x), self.e_at(x));
        let problems: Vec<_> = (0..self.n).map(|i| self.row(i, &lags, &e)).collect();
        let solved = problems.iter().enumerate().map(|(i, p)| self.solve(i, p));
        let solutions = solved.collect::<Result<Vec<_>>>()?;
        let mut rows = FittedForces {
            problems,
            values: solutions.iter().map(|s| s.coefficients.clone()).collect(),
            solutions,
            active: None,
        };
        let Some(requirements) = &self.requirements else {
            return Ok(rows);
        };
        let (mut joint, mut entries) = (JointFit::default(), Vec::new());
        for solution in &rows.solutions {
            let force = joint.add(solution.coefficients.clone(), solution.spread()?, 1.0);
            entries.extend((0..self.n).map(|j| self.entry_of(force, j, &e)));
        }
        let bases = vec![self.roger_basis(&lags)?; self.entries.len()];
        let joint = joint.held(entries, &bases, requirements, everywhere)?;
        rows.values = (0..self.n).map(|i| joint.of_part(i)).collect();
        rows.active = joint.constrained.map(|constrained| constrained.active);
        Ok(rows)
    }

    /// One transfer function of a force in the columns of Roger's form.
    fn entry_of(&self, force: &AffineMap, j: usize, e: &DMatrix<f64>) -> AffineMap {
        let feed = self.feed.count();
        let lags = (0..self.states).map(|l| (self.n * feed + l, e[(l, j)]));
        let places = (0..feed).map(|c| (j * feed + c, 1.0)).chain(lags);
        force.picked(&places.collect::<Vec<_>>())
    }
}
