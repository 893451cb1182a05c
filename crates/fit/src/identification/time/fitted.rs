//! Coefficients of every transfer function from the systems of a pass, each force by itself or all held together by
//! constraints, and what the data say of them.

use super::systems::ForceSystems;
use crate::error::{Error, Result};
use crate::identification::affine::AffineMap;
use crate::identification::basis::Basis;
use crate::identification::dissipative::{
    ActiveConstraint, Dissipation, FitRequirements, Solution, Strictness,
};
use crate::identification::entry_report::EntryReport;
use crate::identification::least_squares::Factor;
use crate::identification::report::{
    LEAST_NOISE, OrderReport, StaticReport, enough_rows, relative_noise, variance,
};
use crate::section::Dof;
use nalgebra::DMatrix;
use std::borrow::Cow;

/// The solved systems of all forces.
pub(crate) struct FittedSystems<'a> {
    dofs: &'a [Dof],
    pub systems: ForceSystems,
    /// Variance of white noise over that of the residuals, whose noise a low-pass may have taken.
    noise_ratio: f64,
    /// Coefficients of all columns of each force.
    coefficients: Vec<Vec<f64>>,
    joint: Option<JointTimeFit>,
}

impl<'a> FittedSystems<'a> {
    /// Least squares for every force by itself; `filters` says in words what the motions must be rich enough for.
    ///
    /// # Errors
    /// [`Error::Input`] for columns that are not determined, naming the motion that is silent.
    pub(crate) fn new(
        dofs: &'a [Dof],
        systems: ForceSystems,
        noise_ratio: f64,
        filters: &str,
    ) -> Result<Self> {
        let solve = |i: usize| {
            let factor = systems.whole(i);
            enough_rows("records", factor.rows, factor.columns())?;
            if let Some(column) = factor.undetermined(factor.columns()) {
                let holds = |j: &usize| systems.places(i, *j).contains(&column);
                let silent = (0..dofs.len()).find(holds);
                return Err(Error::input(
                    "records",
                    format!(
                        "a {} motion rich enough for {filters}",
                        silent.map_or("", |j| dofs[j].name())
                    ),
                    "none that determines its coefficients",
                ));
            }
            Ok(factor.solve(factor.columns())?.as_slice().to_vec())
        };
        let coefficients = (0..dofs.len()).map(solve).collect::<Result<_>>()?;
        Ok(Self {
            dofs,
            systems,
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
        let joint = JointTimeFit::new(&self.systems, bases, requirements, Strictness::Everywhere)?;
        if joint.constrained.is_none() {
            return Ok(());
        }
        let n = self.dofs.len();
        for (i, all) in self.coefficients.iter_mut().enumerate() {
            if self.systems.of_force(i).order.constant {
                all[0] = joint.constant(i);
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
            if let Some(covariance) = all.and_then(|v| joint.covariance(i * n + j, &v)) {
                return Ok(Some(covariance));
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

    /// Reports of all transfer functions, row by row; `named` gives the names of the coefficients and the poles of one.
    pub(crate) fn reports(
        &self,
        named: impl Fn(usize) -> Result<(Vec<String>, Vec<f64>)>,
    ) -> Result<Vec<EntryReport>> {
        let n = self.dofs.len();
        let report = |e: usize| {
            let (names, poles) = named(e)?;
            self.report(e / n, e % n, names, poles)
        };
        (0..n * n).map(report).collect()
    }

    fn report(
        &self,
        i: usize,
        j: usize,
        names: Vec<String>,
        poles: Vec<f64>,
    ) -> Result<EntryReport> {
        let (whole, values) = (self.systems.whole(i), self.values(i, j));
        // with single motions the entry has rows of its own, to which the constant belongs as well
        let own = self.systems.alone(i, j);
        let of_rows: Vec<f64> = self.constant(i).into_iter().chain(values.clone()).collect();
        let relative = |f: &Factor| (f.residual_sum_of(&of_rows, 0) / f.total_sum(0)).sqrt();
        let (condition, cancellation) = match own.as_deref() {
            Some(f) => (f.condition(f.columns()), f.cancellation(&of_rows, 0)),
            None => (
                whole.condition(whole.columns()),
                whole.cancellation(&self.coefficients[i], 0),
            ),
        };
        Ok(EntryReport {
            force: self.dofs[i],
            motion: self.dofs[j],
            relative_rms: own
                .as_deref()
                .filter(|f| f.total_sum(0) > 0.0)
                .map(relative),
            worst_relative: None,
            poles,
            coefficients: Vec::new(),
            covariance: Vec::new(),
            condition,
            cancellation,
        }
        .with_coefficients(names, &values, self.covariance(i, j)?))
    }

    /// Objectives with fewer filters, from the same factorisation, for transfer functions of which all have the same
    /// `feed` columns before their filters.
    pub(crate) fn orders(&self, feed: usize) -> Vec<OrderReport> {
        (1..=self.systems.counts[0] - feed)
            .map(|filters| OrderReport {
                filters,
                objective: self.systems.systems[0].objective(feed + filters, &|_, _| true),
            })
            .collect()
    }
}

/// All transfer functions at given poles, each force by itself and together under the constraints.
pub(crate) struct JointTimeFit {
    /// One per transfer function where each has rows of its own, else one per force, constant included.
    whole: Vec<AffineMap>,
    /// One per transfer function.
    entries: Vec<AffineMap>,
    /// Scale of the weighted residual of each of `whole` in the objective.
    shares: Vec<f64>,
    /// Sums of the squares of the residuals without constraints and of the data of each.
    residuals: Vec<(f64, f64)>,
    pub constrained: Option<Solution>,
}

impl JointTimeFit {
    /// The constrained fit in the columns of `bases`, row by row. As in the search of poles, the weighted residuals of
    /// every transfer function that has rows of its own count relative to its weighted data, else those of every force.
    ///
    /// # Errors
    /// Rows that do not determine the coefficients, and constraints that no coefficients satisfy.
    pub(crate) fn new(
        systems: &ForceSystems,
        bases: &[Basis],
        requirements: &FitRequirements,
        strictness: Strictness,
    ) -> Result<Self> {
        let n = bases.len().isqrt();
        let apart = (0..n).all(|i| (0..n).all(|j| systems.alone(i, j).is_some()))
            && !systems.of_force(0).order.constant;
        let mut joint = Self {
            whole: Vec::new(),
            entries: Vec::new(),
            shares: Vec::new(),
            residuals: Vec::new(),
            constrained: None,
        };
        let count = if apart { n * n } else { n } as f64;
        let mut at = 0;
        for i in 0..n {
            let factors: Vec<Cow<'_, Factor>> = match apart {
                true => (0..n).filter_map(|j| systems.alone(i, j)).collect(),
                false => vec![systems.whole(i)],
            };
            for factor in factors {
                let linear = joint.add(&factor, count, at)?;
                at += linear.spread.ncols();
                if apart {
                    joint.entries.push(linear.clone());
                } else {
                    let places = |j| systems.places(i, j).into_iter().map(|p| (p, 1.0));
                    let picked = |j| linear.picked(&places(j).collect::<Vec<_>>());
                    joint.entries.extend((0..n).map(picked));
                }
                joint.whole.push(linear);
            }
        }
        joint.constrained =
            Dissipation::new(bases, requirements).solve(&joint.entries, strictness)?;
        Ok(joint)
    }

    fn add(&mut self, factor: &Factor, count: f64, at: usize) -> Result<AffineMap> {
        let columns = factor.columns();
        let (total, residual) = (factor.total_sum(0), factor.residual_sum(columns, 0));
        let share = if total > 0.0 {
            let noise = relative_noise(residual, total, factor.rows, columns);
            (total * count).sqrt().recip() / noise
        } else {
            1.0
        };
        self.shares.push(share);
        self.residuals.push((residual, total));
        Ok(AffineMap {
            values: factor.solve(columns)?.as_slice().to_vec(),
            spread: factor.inverse_upper(columns)? / share,
            at,
        })
    }

    /// Geometric mean of the relative weighted residuals with the constraints: where it is least, the likelihood of data that
    /// scatter by themselves each is largest.
    pub(crate) fn objective(&self) -> f64 {
        let mut logarithms = 0.0;
        let mut count = 0.0;
        for ((linear, share), (residual, total)) in
            self.whole.iter().zip(&self.shares).zip(&self.residuals)
        {
            if *total > 0.0 {
                let moved = |constrained: &Solution| {
                    let own = constrained.free.rows(linear.at, linear.spread.ncols());
                    own.norm_squared() / (share * share)
                };
                let added = self.constrained.as_ref().map_or(0.0, moved);
                logarithms += ((residual + added) / total + LEAST_NOISE * LEAST_NOISE).ln();
                count += 1.0;
            }
        }
        (0.5 * logarithms / f64::max(count, 1.0)).exp()
    }

    /// Coefficients of a transfer function.
    pub(crate) fn values(&self, e: usize) -> &[f64] {
        match &self.constrained {
            Some(constrained) => &constrained.coefficients[e],
            None => &self.entries[e].values,
        }
    }

    /// The constant of force `i` where one is estimated along with the coefficients.
    pub(crate) fn constant(&self, i: usize) -> f64 {
        match &self.constrained {
            Some(constrained) => self.whole[i].coefficients(&constrained.free)[0],
            None => self.whole[i].values[0],
        }
    }

    /// Covariance of the coefficients of a transfer function, from the variances of the weighted residuals of all forces.
    pub(crate) fn covariance(&self, e: usize, variances: &[f64]) -> Option<DMatrix<f64>> {
        let constrained = self.constrained.as_ref()?;
        let per_force = self.whole.len() / variances.len();
        let free = |(w, (linear, share)): (usize, (&AffineMap, &f64))| {
            let variance = variances[w / per_force] * share * share;
            (linear.spread.ncols(), variance)
        };
        let all = self.whole.iter().zip(&self.shares).enumerate();
        Some(
            constrained
                .space
                .covariance(&self.entries[e], all.map(free)),
        )
    }
}
