//! Metric of the distributions of values.

use super::kde::{Density, POINTS};
use super::{Metric, SignalPair};
use crate::error::{Error, Result};
use crate::signal::extremes;
use serde::Serialize;

/// Parameters of [`probability_density`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct DensityParameters {
    /// Compare standard scores (mean removed, divided by the standard deviation), so that only the shape of the
    /// distribution counts; default `true`.
    pub standard_score: bool,
}

impl Default for DensityParameters {
    fn default() -> Self {
        Self {
            standard_score: true,
        }
    }
}

/// What [`probability_density`] found, in standard deviations or in the unit of the signals.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DensityDetails {
    /// Value at the first point of the densities.
    pub first: f64,
    /// Distance of the points.
    pub step: f64,
    /// Density of the reference; times `step` it sums up to 1.
    pub reference: Vec<f64>,
    /// Density of the compared signal.
    pub compared: Vec<f64>,
    /// Bandwidths of reference and compared signal.
    pub bandwidths: [f64; 2],
}

/// Probability density metric, the Bhattacharyya coefficient `M_pdf = Σ √(p₁p₂) h`.
///
/// Densities by diffusion (Botev, Grotowski and Kroese 2010) on 4096 points over the common range of both
/// signals, from the smallest to the largest value of either.
///
/// # Errors
/// [`Error::Input`] if a signal is constant.
pub fn probability_density(
    pair: &SignalPair<'_>,
    parameters: &DensityParameters,
) -> Result<Metric<DensityDetails>> {
    let first = values("reference signal", pair.reference(), parameters)?;
    let second = values("compared signal", pair.compared(), parameters)?;
    let (low, high) = extremes(first.iter().chain(&second).copied());
    let step = (high - low) / POINTS as f64;
    let [reference, compared] = [&first, &second].map(|x| Density::new(x, [low, high]));
    let overlap: f64 = reference
        .values
        .iter()
        .zip(&compared.values)
        .map(|(p, q)| (p * q).sqrt() * step)
        .sum();
    Ok(Metric {
        value: overlap.min(1.0),
        details: DensityDetails {
            first: low + 0.5 * step,
            step,
            bandwidths: [reference.bandwidth, compared.bandwidth],
            reference: reference.values,
            compared: compared.values,
        },
    })
}

/// The values themselves or their standard scores.
fn values(place: &str, signal: &[f64], parameters: &DensityParameters) -> Result<Vec<f64>> {
    let n = signal.len() as f64;
    let mean = signal.iter().sum::<f64>() / n;
    let variance = signal.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let deviation = variance.sqrt();
    let largest = signal.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    // The deviation of a constant is the rounding error of its mean.
    if deviation <= 1e-12 * largest {
        return Err(Error::input(
            place,
            "a signal that varies",
            format!("{mean} throughout"),
        ));
    }
    if !deviation.is_finite() {
        return Err(Error::Numerical(format!(
            "{place}: the variance is too large for double precision"
        )));
    }
    Ok(if parameters.standard_score {
        signal.iter().map(|x| (x - mean) / deviation).collect()
    } else {
        signal.to_vec()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};
    use std::f64::consts::TAU;

    const AS_THEY_ARE: DensityParameters = DensityParameters {
        standard_score: false,
    };

    fn normal(count: usize, seed: u64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        (0..count)
            .map(|_| StandardNormal.sample(&mut random))
            .collect()
    }

    /// Quantiles of the logistic distribution, a sample without randomness.
    fn logistic(count: usize) -> Vec<f64> {
        (0..count)
            .map(|k| (k as f64 + 0.5) / count as f64)
            .map(|u| (u / (1.0 - u)).ln())
            .collect()
    }

    #[test]
    fn harmonics_of_any_amplitude_and_phase_are_alike() {
        let wave = |a: f64, shift: usize| -> Vec<f64> {
            (0..4000)
                .map(|k| a * (TAU * ((k + shift) % 400) as f64 / 400.0).cos())
                .collect()
        };
        let (x1, x2) = (wave(1.0, 0), wave(1.7, 37));
        let pair = SignalPair::new(&x1, &x2, 0.01).unwrap();
        let metric = probability_density(&pair, &DensityParameters::default()).unwrap();
        // Values at the edge of a cell fall to either side by rounding.
        assert_abs_diff_eq!(metric.value, 1.0, epsilon = 1e-3);
    }

    #[test]
    fn overlap_of_shifted_normals_is_the_closed_form() {
        // ∫ √(N(0,1) N(d,1)) = exp(−d²/8)
        let (x1, mut x2) = (normal(20_000, 1), normal(20_000, 2));
        x2.iter_mut().for_each(|x| *x += 1.5);
        let pair = SignalPair::new(&x1, &x2, 0.01).unwrap();
        let metric = probability_density(&pair, &AS_THEY_ARE).unwrap();
        // Scatter of the estimate for 20 000 samples.
        assert_abs_diff_eq!(metric.value, (-1.5_f64.powi(2) / 8.0).exp(), epsilon = 5e-3);
        let scored = probability_density(&pair, &DensityParameters::default()).unwrap();
        assert!(scored.value > 0.998, "{}", scored.value);
    }

    #[test]
    fn densities_are_those_of_the_distribution() {
        let x = logistic(2000);
        let pair = SignalPair::new(&x, &x, 0.01).unwrap();
        let metric = probability_density(&pair, &AS_THEY_ARE).unwrap();
        assert_abs_diff_eq!(metric.value, 1.0, epsilon = 1e-12);
        let d = &metric.details;
        assert_abs_diff_eq!(
            d.reference.iter().sum::<f64>() * d.step,
            1.0,
            epsilon = 1e-9
        );
        for (k, p) in d.reference.iter().enumerate() {
            let e = (-(d.first + k as f64 * d.step)).exp();
            // Bias h²f″/2 with h = 0.397 and |f″| ≤ 1/8.
            assert_abs_diff_eq!(*p, e / (1.0 + e).powi(2), epsilon = 1e-2);
        }
    }

    #[test]
    fn constants_are_refused() {
        let (x, y) = ([0.1; 8], normal(8, 3));
        let pair = SignalPair::new(&x, &y, 0.01).unwrap();
        assert!(probability_density(&pair, &DensityParameters::default()).is_err());
    }
}
