//! Least squares at one test point, and the standard errors of its solution.

use super::result::{DerivativeEstimate, IdentifiedDerivatives};
use super::test_points::{CROSS_TALK, TestRun};
use crate::aerodynamics::derivatives::{Derivative, Part};
use crate::error::{Error, Result, ensure};
use crate::identification::least_squares::{Factor, StreamingQr};
use crate::identification::time::driven::DRIVEN_TOO;
use crate::section::Dof;
use crate::signal::mean;
use nalgebra::{Complex, DMatrix, DVector};
use std::f64::consts::TAU;

/// Fourier frequencies on either side of the motion that tell the noise there: at least and at most.
const NEIGHBOURS: (usize, usize) = (4, 12);

/// Fits all forces of one test point and appends what it determines to `result`.
pub(super) fn solve(
    dofs: &[Dof],
    group: &[TestRun],
    result: &mut IdentifiedDerivatives,
) -> Result<()> {
    let point = TestPointEquations::new(dofs, group)?;
    result.warnings.extend(point.cross_talk()?);
    let factor = point.factor()?;
    let solution = factor.solve(point.columns)?;
    let inverse = factor.inverse_gram(point.columns)?;
    for force in 0..dofs.len() {
        let coefficients = solution.column(force).into_owned();
        let (residuals, meat) = point.residuals(force, &coefficients);
        let covariance = &inverse * meat * &inverse;
        for a in 0..point.active.len() {
            let estimates = point.estimates(force, a, &coefficients, &covariance, &residuals);
            result.estimates.extend(estimates);
        }
    }
    Ok(())
}

/// The equations of one test point. Columns: two per motion that some run drives, then constant and trend of each run.
struct TestPointEquations<'a> {
    dofs: &'a [Dof],
    group: &'a [TestRun],
    /// Motions that some run drives.
    active: Vec<usize>,
    columns: usize,
    /// Rows of each run.
    rows: Vec<DMatrix<f64>>,
    /// `zᵀz` of each run.
    grams: Vec<DMatrix<f64>>,
    /// Forces of each run.
    forces: Vec<Vec<Vec<f64>>>,
}

impl<'a> TestPointEquations<'a> {
    fn new(dofs: &'a [Dof], group: &'a [TestRun]) -> Result<Self> {
        let driven = |j: &usize| group.iter().any(|s| s.driven == *j);
        let active: Vec<usize> = (0..dofs.len()).filter(driven).collect();
        let columns = 2 * active.len() + 2 * group.len();
        let (mut rows, mut grams, mut forces) = (Vec::new(), Vec::new(), Vec::new());
        for (run, stretch) in group.iter().enumerate() {
            let z = regressors(&stretch.motions(), run, &active, columns);
            grams.push(z.tr_mul(&z));
            rows.push(z);
            forces.push(stretch.forces()?);
        }
        Ok(Self {
            dofs,
            group,
            columns,
            rows,
            grams,
            forces,
            active,
        })
    }

    /// Warnings of motions that no run drives.
    ///
    /// # Errors
    /// [`Error::Input`] naming the run, of one that drives several at once.
    fn cross_talk(&self) -> Result<Vec<String>> {
        let mut warnings = Vec::new();
        for stretch in self.group {
            let own = stretch.amplitude[stretch.driven];
            for j in (0..self.dofs.len()).filter(|j| !self.active.contains(j)) {
                let part = stretch.amplitude[j] / own;
                let (run, hertz) = (&stretch.header.name, stretch.frequency_hz);
                let (driven, other) = (self.dofs[stretch.driven].name(), self.dofs[j].name());
                ensure(
                    part <= DRIVEN_TOO,
                    format_args!("run {run} at {hertz:.3} Hz"),
                    format_args!(
                        "{driven} motion alone, or a run of {other} motion at that frequency and speed: forces of motions that are driven \
                         at once are not told apart"
                    ),
                    format_args!(
                        "{other} motion of {:.0} % of that, both over the width",
                        100.0 * part
                    ),
                )?;
                if part > CROSS_TALK {
                    warnings.push(format!(
                        "run {run} at {hertz:.3} Hz also moves {other} by {:.1} % and no run drives that: its share of the force is \
                         taken for that of {driven}",
                        100.0 * part
                    ));
                }
            }
        }
        Ok(warnings)
    }

    /// The triangular factor of all runs, with the forces as right-hand sides.
    fn factor(&self) -> Result<Factor> {
        let mut qr = StreamingQr::new(self.columns, self.dofs.len());
        for (forces, z) in self.forces.iter().zip(&self.rows) {
            let regressors = z.as_slice().chunks_exact(z.nrows().max(1));
            let columns = regressors.chain(forces.iter().map(Vec::as_slice));
            qr.push_columns(&columns.collect::<Vec<_>>());
        }
        let factor = qr.finish();
        if factor.undetermined(self.columns).is_some() || factor.condition(self.columns) > 1e6 {
            let runs: Vec<&str> = self.group.iter().map(|s| s.header.name.as_str()).collect();
            let hertz = self.group[0].frequency_hz;
            return Err(Error::input(
                format!("runs {} at {hertz:.3} Hz", runs.join(", ")),
                "motions that can be told apart",
                "motions in step with each other",
            ));
        }
        Ok(factor)
    }

    /// What is left of a force in each run, relative to the force, and the middle of the sandwich of its covariance.
    fn residuals(&self, force: usize, coefficients: &DVector<f64>) -> (Vec<f64>, DMatrix<f64>) {
        let mut meat = DMatrix::zeros(self.columns, self.columns);
        let mut relative = Vec::with_capacity(self.group.len());
        for (run, (stretch, z)) in self.group.iter().zip(&self.rows).enumerate() {
            let fitted = z * coefficients;
            let measured = &self.forces[run][force];
            let rest: Vec<f64> = measured.iter().zip(&fitted).map(|(f, x)| f - x).collect();
            meat += &self.grams[run] * noise_level(&rest, stretch.periods);
            relative.push(self.relative(run, &rest, measured, coefficients));
        }
        (relative, meat)
    }

    /// RMS of the residual over that of the force, the latter without constant and trend.
    fn relative(&self, run: usize, rest: &[f64], force: &[f64], solution: &DVector<f64>) -> f64 {
        let z = &self.rows[run];
        let at = 2 * self.active.len() + 2 * run;
        let (mut above, mut below) = (0.0, 0.0);
        for (k, (e, f)) in rest.iter().zip(force).enumerate() {
            let base = z[(k, at)] * solution[at] + z[(k, at + 1)] * solution[at + 1];
            above += e * e;
            below += (f - base).powi(2);
        }
        match below > 0.0 {
            true => (above / below).sqrt(),
            false => 0.0,
        }
    }

    /// Both derivatives of a force by the `a`-th active motion, if some run drives it.
    fn estimates(
        &self,
        force: usize,
        a: usize,
        coefficients: &DVector<f64>,
        covariance: &DMatrix<f64>,
        residuals: &[f64],
    ) -> Vec<DerivativeEstimate> {
        let motion = self.active[a];
        let Some(run) = self.group.iter().position(|s| s.driven == motion) else {
            return Vec::new();
        };
        let s = &self.group[run];
        let v_hat = s.k.v_hat();
        let of = |part, c: usize| DerivativeEstimate {
            derivative: Derivative::from_entry(self.dofs[force], self.dofs[motion], part),
            run: s.header.name.clone(),
            mean_speed_m_s: s.header.mean_speed_m_s,
            frequency_hz: s.frequency_hz,
            v_hat,
            value: coefficients[c] * v_hat * v_hat,
            standard_error: covariance[(c, c)].max(0.0).sqrt() * v_hat * v_hat,
            periods: s.periods,
            residual: residuals[run],
        };
        vec![of(Part::Real, 2 * a), of(Part::Imaginary, 2 * a + 1)]
    }
}

/// Rows of one run: motions and rates, then its own constant and trend.
fn regressors(
    motion: &[[Vec<f64>; 2]],
    run: usize,
    active: &[usize],
    columns: usize,
) -> DMatrix<f64> {
    let count = motion[0][0].len();
    let middle = 0.5 * (count as f64 - 1.0);
    DMatrix::from_fn(count, columns, |k, c| {
        if c < 2 * active.len() {
            return motion[active[c / 2]][c % 2][k];
        }
        match c - 2 * active.len() {
            own if own == 2 * run => 1.0,
            own if own == 2 * run + 1 => (k as f64 - middle) / middle.max(1.0),
            _ => 0.0,
        }
    })
}

/// Spectral level of a residual next to the harmonic of `periods` in its length: the variance that white noise of the same level
/// would have.
fn noise_level(rest: &[f64], periods: usize) -> f64 {
    let n = rest.len();
    let reach = (periods / 2).clamp(NEIGHBOURS.0, NEIGHBOURS.1);
    // the first Fourier frequency is gone with the trend
    let bins = periods.saturating_sub(reach).max(2)..=(periods + reach).min(n / 2);
    let bins = bins.filter(|b| *b != periods);
    let steps = bins.map(|b| Complex::from_polar(1.0, -TAU * b as f64 / n as f64));
    let (re, im): (Vec<f64>, Vec<f64>) = steps.map(|step| (step.re, step.im)).unzip();
    let mut sums = vec![[0.0; 2]; re.len()];
    // Horner's rule from the last sample backwards, for all bins side by side
    for e in rest.iter().rev() {
        for (sum, (re, im)) in sums.iter_mut().zip(re.iter().zip(&im)) {
            *sum = [sum[0] * re - sum[1] * im + e, sum[0] * im + sum[1] * re];
        }
    }
    let level = |[re, im]: &[f64; 2]| (re * re + im * im) / n as f64;
    mean(&sums.iter().map(level).collect::<Vec<_>>())
}
