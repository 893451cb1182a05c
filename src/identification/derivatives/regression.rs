//! Least squares at one test point, and the standard errors of its solution.

use super::result::{DerivativeEstimate, IdentifiedDerivatives};
use super::test_points::{CROSS_TALK, Stretch};
use crate::aerodynamics::derivatives::{Derivative, Part};
use crate::error::{Error, Result};
use crate::identification::least_squares::StreamingQr;
use crate::section::Dof;
use crate::signal::mean;
use nalgebra::DMatrix;
use std::f64::consts::TAU;

/// Fourier frequencies on either side of the motion that tell the noise there: at least and at most.
const NEIGHBOURS: (usize, usize) = (4, 12);

/// Fits all forces of one test point and appends what it determines to `result`.
pub(super) fn solve(
    dofs: &[Dof],
    group: &[Stretch],
    result: &mut IdentifiedDerivatives,
) -> Result<()> {
    // columns: two a motion that some run drives, then constant and trend of each run
    let active: Vec<usize> = (0..dofs.len())
        .filter(|j| group.iter().any(|s| s.driven == *j))
        .collect();
    for stretch in group {
        let own = stretch.amplitude[stretch.driven];
        for j in (0..dofs.len()).filter(|j| !active.contains(j)) {
            if stretch.amplitude[j] > CROSS_TALK * own {
                result.warnings.push(format!(
                    "run {} at {:.3} Hz also moves {} by {:.1} % and no run drives that: its share of the force is \
                     taken for that of {}",
                    stretch.run,
                    stretch.frequency_hz,
                    dofs[j].name(),
                    100.0 * stretch.amplitude[j] / own,
                    dofs[stretch.driven].name()
                ));
            }
        }
    }
    let columns = 2 * active.len() + 2 * group.len();
    let rows: Vec<DMatrix<f64>> = group
        .iter()
        .enumerate()
        .map(|(run, s)| regressors(s, run, &active, columns))
        .collect();
    let factor = {
        let mut qr = StreamingQr::new(columns, dofs.len());
        let mut line = vec![0.0; columns + dofs.len()];
        for (stretch, z) in group.iter().zip(&rows) {
            for k in 0..z.nrows() {
                for (c, to) in line.iter_mut().enumerate().take(columns) {
                    *to = z[(k, c)];
                }
                for (i, force) in stretch.force.iter().enumerate() {
                    line[columns + i] = force[k];
                }
                qr.push_row(&line);
            }
        }
        qr.finish()
    };
    if factor.undetermined(columns).is_some() || factor.condition(columns) > 1e6 {
        let runs: Vec<&str> = group.iter().map(|s| s.run.as_str()).collect();
        return Err(Error::input(
            format!(
                "runs {} at {:.3} Hz",
                runs.join(", "),
                group[0].frequency_hz
            ),
            "motions that can be told apart",
            "motions in step with each other",
        ));
    }
    let solution = factor.solve(columns)?;
    let inverse = factor.inverse_gram(columns)?;
    for (i, force) in dofs.iter().enumerate() {
        let mut meat = DMatrix::zeros(columns, columns);
        let mut residuals = vec![0.0; group.len()];
        for (run, (stretch, z)) in group.iter().zip(&rows).enumerate() {
            let fitted = z * solution.column(i);
            let rest: Vec<f64> = stretch.force[i]
                .iter()
                .zip(fitted.iter())
                .map(|(f, x)| f - x)
                .collect();
            meat += z.transpose() * z * noise_level(&rest, stretch.periods);
            residuals[run] = relative(&rest, &stretch.force[i], z, &solution, i, run, &active);
        }
        let covariance = &inverse * meat * &inverse;
        for (a, &j) in active.iter().enumerate() {
            let Some(run) = group.iter().position(|s| s.driven == j) else {
                continue;
            };
            let s = &group[run];
            for (part, c) in [(Part::Real, 2 * a), (Part::Imaginary, 2 * a + 1)] {
                let v_hat = s.k.v_hat();
                result.estimates.push(DerivativeEstimate {
                    derivative: Derivative::of(*force, dofs[j], part),
                    run: s.run.clone(),
                    mean_speed_m_s: s.speed_m_s,
                    frequency_hz: s.frequency_hz,
                    v_hat,
                    value: solution[(c, i)] * v_hat * v_hat,
                    standard_error: covariance[(c, c)].max(0.0).sqrt() * v_hat * v_hat,
                    periods: s.periods,
                    residual: residuals[run],
                });
            }
        }
    }
    Ok(())
}

/// Rows of one run: motions and rates, then its own constant and trend.
fn regressors(s: &Stretch, run: usize, active: &[usize], columns: usize) -> DMatrix<f64> {
    let count = s.force[0].len();
    let middle = 0.5 * (count as f64 - 1.0);
    DMatrix::from_fn(count, columns, |k, c| {
        if c < 2 * active.len() {
            return s.motion[active[c / 2]][c % 2][k];
        }
        match c - 2 * active.len() {
            own if own == 2 * run => 1.0,
            own if own == 2 * run + 1 => (k as f64 - middle) / middle.max(1.0),
            _ => 0.0,
        }
    })
}

/// RMS of the residual over that of the force, the latter without constant and trend.
fn relative(
    rest: &[f64],
    force: &[f64],
    z: &DMatrix<f64>,
    solution: &DMatrix<f64>,
    i: usize,
    run: usize,
    active: &[usize],
) -> f64 {
    let at = 2 * active.len() + 2 * run;
    let (mut above, mut below) = (0.0, 0.0);
    for (k, (e, f)) in rest.iter().zip(force).enumerate() {
        let base = z[(k, at)] * solution[(at, i)] + z[(k, at + 1)] * solution[(at + 1, i)];
        above += e * e;
        below += (f - base).powi(2);
    }
    if below > 0.0 {
        (above / below).sqrt()
    } else {
        0.0
    }
}

/// Spectral level of a residual next to the harmonic of `periods` in its length: the variance that white noise of the same level
/// would have.
fn noise_level(rest: &[f64], periods: usize) -> f64 {
    let n = rest.len();
    let reach = (periods / 2).clamp(NEIGHBOURS.0, NEIGHBOURS.1);
    // the first Fourier frequency is gone with the trend
    let bins = periods.saturating_sub(reach).max(2)..=(periods + reach).min(n / 2);
    let levels: Vec<f64> = bins
        .filter(|b| *b != periods)
        .map(|b| {
            let step = nalgebra::Complex::from_polar(1.0, -TAU * b as f64 / n as f64);
            // Horner's rule from the last sample backwards
            let sum = rest
                .iter()
                .rev()
                .fold(nalgebra::Complex::new(0.0, 0.0), |sum, e| sum * step + e);
            sum.norm_sqr() / n as f64
        })
        .collect();
    mean(&levels)
}
