//! Growth rate and frequency of the dominant mode of sampled free motion.
//!
//! The samples `z = [q₁, q̇₁, q₂, q̇₂, …]` of a linear section move as `z(t+T) = Φ z(t)` once the filters have decayed.
//! `Φ` is fitted by least squares over the later half of the samples, in the directions in which there is motion
//! (Schmid 2010, dynamic mode decomposition). `T` is about two periods: the longer it is, the less a disturbance of
//! the samples biases `|μ|`. A motion that hardly oscillates has no such time; half the samples then have to do. Of the
//! eigenvalues `μ` with energy at the end the largest counts: growth rate `ln|μ|/T`. Its frequency is known up to multiples of `2π/T` from `arg μ`, and the multiple from the
//! eigenvector, in which rate and displacement stand in the ratio `λ`.

use crate::error::{Error, Result};
use crate::state_space::{eigenvalues, eigenvector};
use nalgebra::{Complex, DMatrix, DVector, SVD};
use std::f64::consts::TAU;

/// Directions with less motion than this part of the largest are left out: rounding.
const RANK_TOLERANCE: f64 = 1e-9;
/// `T` in periods.
const LAG_PERIODS: f64 = 2.0;
/// An eigenvalue counts if at the end its part of the motion is at least this part of the largest: above what the filters
/// and rounding leave.
const HEARD: f64 = 1e-4;

/// Growth of the dominant mode at one wind speed.
#[derive(Debug, Clone, PartialEq)]
pub struct GrowthPoint {
    /// Wind speed, m/s.
    pub speed_m_s: f64,
    /// Real part of the eigenvalue, 1/s; negative when it decays.
    pub growth_rate_per_s: f64,
    /// Imaginary part, rad/s; 0 when it does not oscillate.
    pub frequency_rad_s: f64,
    /// Complex amplitudes of the displacements, one for each motion.
    pub shape: Vec<Complex<f64>>,
}

impl GrowthPoint {
    /// Its frequency, Hz.
    pub fn frequency_hz(&self) -> f64 {
        self.frequency_rad_s / TAU
    }
}

/// Period in s from the size of rates against displacements, by the slowest motion.
pub(super) fn rough_period(samples: &[f64], width: usize) -> f64 {
    let sizes = sizes(samples, width);
    let moving = sizes
        .chunks_exact(2)
        .filter(|pair| pair[0] > f64::MIN_POSITIVE);
    TAU / moving
        .map(|pair| pair[1] / pair[0])
        .fold(f64::INFINITY, f64::min)
}

/// The rows up to the last in which something is at least `rest`.
pub(super) fn before_rest(samples: &[f64], width: usize, rest: f64) -> &[f64] {
    let last = samples.iter().rposition(|x| x.is_nan() || x.abs() >= rest);
    &samples[..last.map_or(0, |i| (i / width + 1) * width)]
}

/// Growth of the dominant mode in samples a step of `step_s` apart: rows of `width` values, displacement and rate of each
/// motion in turn. The wind speed is left at zero.
///
/// # Errors
/// [`Error::Numerical`] when there are too few samples for two periods, or they are not finite or all zero.
pub(super) fn growth_of_samples(samples: &[f64], width: usize, step_s: f64) -> Result<GrowthPoint> {
    let unclear = |why: &str| Error::Numerical(format!("growth rate: {why}"));
    if width == 0 || !width.is_multiple_of(2) || !samples.len().is_multiple_of(width) {
        return Err(unclear("rows must hold pairs of displacement and rate"));
    }
    if !samples.iter().all(|x| x.is_finite()) {
        return Err(unclear("the samples are not finite"));
    }
    let count = samples.len() / width;
    let half = &samples[count / 2 * width..];
    let rows = half.len() / width;
    let period = rough_period(half, width);
    if !half.iter().any(|x| *x != 0.0) {
        return Err(unclear("no motion"));
    }
    if rows < 6 * width {
        return Err(unclear("too few samples"));
    }
    // the slow motion of one degree of freedom must not take the time that tells the others apart
    let wished = (LAG_PERIODS * period / step_s).round();
    let lag = (wished.max(1.0) as usize).min(rows / 3);
    // each signal in units of its own size, so that metres and radians count alike
    let scale = sizes(half, width);
    let scaled = DMatrix::from_fn(width, rows, |i, j| half[j * width + i] / scale[i]);
    let early = scaled.columns(0, rows - lag);
    let late = scaled.columns(lag, rows - lag);
    let (phi, basis) = transition(&early.into_owned(), &late.into_owned())
        .ok_or_else(|| unclear("no decomposition of the samples"))?;
    let end = basis.transpose() * scaled.column(rows - 1);
    let (mu, vector) = dominant(&phi, &end)?;
    let vector = basis.map(|x| Complex::new(x, 0.0)) * vector;
    let physical: Vec<_> = vector.iter().zip(&scale).map(|(v, s)| v * *s).collect();
    let time = lag as f64 * step_s;
    Ok(GrowthPoint {
        speed_m_s: 0.0,
        growth_rate_per_s: mu.norm().ln() / time,
        frequency_rad_s: frequency(mu, &physical, time),
        shape: forward_displacements(&physical),
    })
}

/// Displacements of the mode that turns with positive frequency: rates lead displacements by a right angle in it, and
/// lag in its conjugate.
fn forward_displacements(physical: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let pairs = physical.chunks_exact(2);
    let turn: f64 = pairs.clone().map(|p| (p[0].conj() * p[1]).im).sum();
    let forward = |p: &[Complex<f64>]| if turn < 0.0 { p[0].conj() } else { p[0] };
    pairs.map(forward).collect()
}

/// Norm of each signal, from parts of its largest value: the squares of a motion that has grown long enough overflow.
fn sizes(samples: &[f64], width: usize) -> Vec<f64> {
    let size = |i: usize| {
        let signal = || samples.iter().skip(i).step_by(width);
        let largest = signal().fold(f64::MIN_POSITIVE, |most, x| x.abs().max(most));
        let squares: f64 = signal().map(|x| (x / largest).powi(2)).sum();
        (largest * squares.sqrt()).max(f64::MIN_POSITIVE)
    };
    (0..width).map(size).collect()
}

/// `Φ` on the directions of `early` that matter, and these directions as columns.
fn transition(early: &DMatrix<f64>, late: &DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    let svd = SVD::try_new(early.transpose(), true, true, f64::EPSILON, 1000)?;
    let (u, v_t) = (svd.u?, svd.v_t?);
    let s = svd.singular_values;
    let rank = s.iter().filter(|x| **x > RANK_TOLERANCE * s[0]).count();
    if rank == 0 {
        return None;
    }
    let basis = v_t.rows(0, rank).transpose();
    let mut weights = u.columns(0, rank).into_owned();
    let columns = weights.column_iter_mut().zip(s.iter());
    columns.for_each(|(mut column, value)| column /= *value);
    Some((basis.transpose() * late * weights, basis))
}

/// Eigenvalue and eigenvector of `Φ` that grow fastest among those heard in the state `end`.
fn dominant(
    phi: &DMatrix<f64>,
    end: &DVector<f64>,
) -> Result<(Complex<f64>, DVector<Complex<f64>>)> {
    let values = eigenvalues(phi)?;
    let vectors = values.iter().map(|mu| eigenvector(phi, *mu));
    let vectors = vectors.collect::<Result<Vec<_>>>()?;
    let matrix = DMatrix::from_columns(&vectors).lu();
    let amplitudes = matrix.solve(&end.map(|x| Complex::new(x, 0.0)));
    let coincide = || Error::Numerical("growth rate: modes coincide".into());
    let amplitudes = amplitudes.ok_or_else(coincide)?;
    let energy = |i: usize| amplitudes[i].norm() * vectors[i].norm();
    let most = (0..values.len()).map(energy).fold(0.0, f64::max);
    let fastest = (0..values.len())
        .filter(|i| energy(*i) >= HEARD * most)
        .max_by(|a, b| values[*a].norm().total_cmp(&values[*b].norm()))
        .unwrap_or(0);
    Ok((values[fastest], vectors[fastest].clone()))
}

/// `|Im λ|`: the multiple of `2π/T` that `arg μ` leaves open is taken from rate over displacement.
fn frequency(mu: Complex<f64>, vector: &[Complex<f64>], time: f64) -> f64 {
    if mu.im == 0.0 && mu.re > 0.0 {
        return 0.0;
    }
    let pairs = vector.chunks_exact(2);
    let largest = pairs.max_by(|a, b| a[0].norm().total_cmp(&b[0].norm()));
    let Some(pair) = largest else { return 0.0 };
    let ratio = (pair[1] / pair[0]).im;
    let turns = ((ratio * time - mu.arg()) / TAU).round();
    ((mu.arg() + TAU * turns) / time).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two modes and a filter transient with known eigenvalues, sampled at `step`.
    fn motion(modes: &[(Complex<f64>, [Complex<f64>; 2])], step: f64, seconds: f64) -> Vec<f64> {
        let mut samples = Vec::new();
        for k in 0..(seconds / step) as usize {
            let t = k as f64 * step;
            let mut row = [0.0; 4];
            for (lambda, shape) in modes {
                for (i, amplitude) in shape.iter().enumerate() {
                    let z = amplitude * (lambda * t).exp();
                    row[2 * i] += z.re;
                    row[2 * i + 1] += (z * lambda).re;
                }
            }
            samples.extend(row);
        }
        samples
    }

    fn c(re: f64, im: f64) -> Complex<f64> {
        Complex::new(re, im)
    }

    #[test]
    fn growth_and_frequency_at_steps_ten_apart() {
        // torsion branch near onset, strongly damped heave, a filter as slow as the heave
        let modes = [
            (c(0.013, 22.3), [c(0.3, 0.2), c(1.0, 0.0)]),
            (c(-1.7, 14.0), [c(2.0, 0.0), c(0.1, 0.3)]),
            (c(-1.5, 0.0), [c(0.5, 0.0), c(0.2, 0.0)]),
        ];
        for step in [0.005, 0.05] {
            let found = growth_of_samples(&motion(&modes, step, 30.0), 4, step).unwrap();
            assert!((found.growth_rate_per_s - 0.013).abs() < 1e-8, "{found:?}");
            assert!((found.frequency_rad_s - 22.3).abs() < 1e-7, "{found:?}");
            let ratio = found.shape[0] / found.shape[1];
            let expected = c(0.3, 0.2);
            assert!((ratio - expected).norm() < 1e-7, "{ratio}");
        }
    }

    #[test]
    fn two_lightly_damped_modes_are_told_apart() {
        let modes = [
            (c(-0.040, 12.6), [c(1.0, 0.0), c(0.02, 0.0)]),
            (c(-0.095, 31.4), [c(0.01, 0.0), c(1.0, 0.0)]),
        ];
        let found = growth_of_samples(&motion(&modes, 0.02, 10.0), 4, 0.02).unwrap();
        assert!((found.growth_rate_per_s + 0.040).abs() < 1e-10, "{found:?}");
        assert!((found.frequency_rad_s - 12.6).abs() < 1e-9);
    }

    #[test]
    fn a_motion_whose_squares_overflow_is_no_loss() {
        let modes = [(c(0.5, 12.6), [c(1.0, 0.0), c(0.02, 0.0)])];
        let small = motion(&modes, 0.02, 10.0);
        let large: Vec<_> = small.iter().map(|x| x * 1e200).collect();
        for samples in [small, large] {
            let found = growth_of_samples(&samples, 4, 0.02).unwrap();
            assert!((found.growth_rate_per_s - 0.5).abs() < 1e-8, "{found:?}");
            assert!((rough_period(&samples, 4) - TAU / 12.6).abs() < 0.01);
        }
    }

    #[test]
    fn a_motion_that_died_away_has_its_rate_from_before() {
        let modes = [(c(-60.0, 12.6), [c(1.0, 0.0), c(0.02, 0.0)])];
        let samples = motion(&modes, 0.02, 60.0);
        assert!(growth_of_samples(&samples, 4, 0.02).is_err());
        let found = growth_of_samples(before_rest(&samples, 4, 1e-250), 4, 0.02).unwrap();
        assert!((found.growth_rate_per_s + 60.0).abs() < 1e-6, "{found:?}");
        assert!(before_rest(&[0.0; 8], 4, 1e-250).is_empty());
    }

    #[test]
    fn samples_that_tell_nothing_are_refused() {
        for samples in [vec![0.0; 400], vec![f64::NAN; 400], vec![1.0; 8]] {
            assert!(growth_of_samples(&samples, 4, 0.01).is_err());
        }
        assert!(growth_of_samples(&[1.0; 9], 3, 0.01).is_err());
    }
}
