//! Coefficients of every transfer function from the systems of a pass, each force by itself or all held together by
//! constraints, and what the data say of them.

use super::systems::ForceSystems;
use crate::error::{Error, Result};
use crate::identification::basis::Basis;
use crate::identification::dissipative::{ActiveConstraint, FitRequirements};
use crate::identification::entry_report::EntryReport;
use crate::identification::joint::JointFit;
use crate::identification::least_squares::Factor;
use crate::identification::report::{OrderReport, StaticReport, enough_rows, variance};
use crate::section::Dof;
use nalgebra::DMatrix;

/// The solved systems of all forces.
pub(crate) struct FittedSystems<'a> {
    dofs: &'a [Dof],
    pub systems: ForceSystems,
    /// Poles of the filters of every transfer function, row by row; empty in discrete time.
    pub chains: Vec<Vec<f64>>,
    /// Names of its coefficients.
    names: Vec<Vec<String>>,
    /// Variance of white noise over that of the residuals, whose noise a low-pass may have taken.
    noise_ratio: f64,
    /// Coefficients of all columns of each force.
    coefficients: Vec<Vec<f64>>,
    joint: Option<JointFit>,
}

impl<'a> FittedSystems<'a> {
    /// Least squares for every force by itself; `filters` says in words what the motions must be rich enough for.
    ///
    /// # Errors
    /// [`Error::Input`] for columns that are not determined, naming the motion that is silent.
    pub(crate) fn new(
        dofs: &'a [Dof],
        systems: ForceSystems,
        chains: Vec<Vec<f64>>,
        names: Vec<Vec<String>>,
        noise_ratio: f64,
        filters: &str,
    ) -> Result<Self> {
        let solve = |i: usize| {
            let factor = systems.whole(i);
            enough_rows("records", factor.rows, factor.columns())?;
            if let Some(column) = factor.undetermined(factor.columns()) {
                let holds = |j: &usize| systems.places(i, *j).contains(&column);
                let silent = (0..dofs.len()).find(holds);
                let silent = silent.map_or("", |j| dofs[j].name());
                let expected = format!("a {silent} motion rich enough for {filters}");
                let found = "none that determines its coefficients (is a run of it missing among these speeds?)";
                return Err(Error::input("records", expected, found));
            }
            Ok(factor.solve(factor.columns())?.as_slice().to_vec())
        };
        let coefficients = (0..dofs.len()).map(solve).collect::<Result<_>>()?;
        Ok(Self {
            dofs,
            systems,
            chains,
            names,
            noise_ratio,
            coefficients,
            joint: None,
        })
    }

    /// Puts the fit under the constraints; one that satisfies them stays as it is, to the last bit.
    ///
    /// # Errors
    /// Constraints that no coefficients satisfy.
    pub(crate) fn constrain(
        &mut self,
        bases: &[Basis],
        requirements: &FitRequirements,
    ) -> Result<()> {
        let (joint, _) = self.systems.held(bases, requirements, true)?;
        if joint.constrained.is_none() {
            return Ok(());
        }
        let n = self.dofs.len();
        for (i, all) in self.coefficients.iter_mut().enumerate() {
            if self.systems.of_force(i).order.constant {
                all[0] = joint.of_part(i)[0];
            }
            for j in 0..n {
                let values = joint.values(i * n + j);
                for (p, value) in self.systems.places(i, j).into_iter().zip(values) {
                    all[p] = *value;
                }
            }
        }
        self.joint = Some(joint);
        Ok(())
    }

    /// What holds the constrained fit; `None` where nothing does.
    pub(crate) fn active(&self) -> Option<Vec<ActiveConstraint>> {
        Some(self.joint.as_ref()?.constrained.as_ref()?.active.clone())
    }

    /// Coefficients of a transfer function.
    pub(crate) fn values(&self, i: usize, j: usize) -> Vec<f64> {
        let places = self.systems.places(i, j).into_iter();
        places.map(|p| self.coefficients[i][p]).collect()
    }

    /// The constant of force `i`, where one is estimated along.
    pub(crate) fn constant(&self, i: usize) -> Option<f64> {
        let has = self.systems.of_force(i).order.constant;
        has.then_some(self.coefficients[i][0])
    }

    /// The estimated constants with their standard errors.
    pub(crate) fn constants(&self) -> Result<Vec<StaticReport>> {
        let mut reports = Vec::new();
        for (i, &force) in self.dofs.iter().enumerate() {
            let Some(value) = self.constant(i) else {
                continue;
            };
            let whole = self.systems.whole(i);
            let columns = whole.columns();
            let residual = variance(whole.residual_sum(columns, 0), whole.rows, columns);
            let gram = whole.inverse_gram(columns)?;
            reports.push(StaticReport {
                force,
                record: None,
                value,
                standard_error: residual.map(|v| (v * self.noise_ratio * gram[(0, 0)]).sqrt()),
            });
        }
        Ok(reports)
    }

    /// Variance of the noise of force `i`; none without residual degrees of freedom.
    fn variance(&self, i: usize) -> Option<f64> {
        let whole = self.systems.whole(i);
        let residual_sum = match self.joint {
            Some(_) => whole.residual_sum_of(&self.coefficients[i], 0),
            None => whole.residual_sum(whole.columns(), 0),
        };
        variance(residual_sum, whole.rows, whole.columns()).map(|v| v * self.noise_ratio)
    }

    /// Covariance of the coefficients of a transfer function.
    fn covariance(&self, i: usize, j: usize) -> Result<Option<DMatrix<f64>>> {
        let n = self.dofs.len();
        if let Some(joint) = &self.joint {
            let all: Option<Vec<f64>> = (0..n).map(|i| self.variance(i)).collect();
            let per_force = joint.parts.len() / n;
            let held = all.and_then(|v| joint.covariance(i * n + j, |part| v[part / per_force]));
            if held.is_some() {
                return Ok(held);
            }
        }
        let Some(variance) = self.variance(i) else {
            return Ok(None);
        };
        let whole = self.systems.whole(i);
        let gram = whole.inverse_gram(whole.columns())?;
        let places = self.systems.places(i, j);
        let entry = |a: usize, b: usize| gram[(places[a], places[b])] * variance;
        Ok(Some(DMatrix::from_fn(places.len(), places.len(), entry)))
    }

    /// Reports of all transfer functions, row by row.
    pub(crate) fn reports(&self) -> Result<Vec<EntryReport>> {
        (0..self.names.len()).map(|e| self.report(e)).collect()
    }

    fn report(&self, e: usize) -> Result<EntryReport> {
        let (i, j) = (e / self.dofs.len(), e % self.dofs.len());
        let (whole, values) = (self.systems.whole(i), self.values(i, j));
        // with single motions the entry has rows of its own, to which the constant belongs as well
        let own = self.systems.alone(i, j);
        let of_rows: Vec<f64> = self.constant(i).into_iter().chain(values.clone()).collect();
        let relative = |f: &Factor| (f.residual_sum_of(&of_rows, 0) / f.total_sum(0)).sqrt();
        let own = own.as_deref();
        let (judged, coefficients) = match own {
            Some(f) => (f, &of_rows),
            None => (&*whole, &self.coefficients[i]),
        };
        Ok(EntryReport {
            force: self.dofs[i],
            motion: self.dofs[j],
            relative_rms: own.filter(|f| f.total_sum(0) > 0.0).map(relative),
            worst_relative: None,
            poles: self.chains[e].clone(),
            coefficients: Vec::new(),
            covariance: Vec::new(),
            condition: judged.condition(judged.columns()),
            cancellation: judged.cancellation(coefficients, 0),
        }
        .with_coefficients(self.names[e].clone(), &values, self.covariance(i, j)?))
    }

    /// Objectives with fewer filters, from the same factorisation, for transfer functions of which all have the same
    /// `feed` columns before their filters.
    pub(crate) fn orders(&self, feed: usize) -> Vec<OrderReport> {
        let order = |filters| OrderReport {
            filters,
            objective: self.systems.systems[0].objective(feed + filters, &|_, _| true),
        };
        (1..=self.systems.counts[0] - feed).map(order).collect()
    }
}
