//! Turbulence and its forces over time, from random Fourier coefficients.
//!
//! A record of `N` samples is one period `T = NΔt` of a periodic Gaussian process. Its coefficients at `f_k = k/T`,
//! `0 < k < N/2`, are independent, with the variance that the spectrum has between `f_k − 1/2T` and `f_k + 1/2T`. So the
//! expected variance of every record is exactly the integral of the spectrum from `1/2T` to `f_N − 1/2T`, `f_N = 1/2Δt`, and
//! each single record scatters about it as a Gaussian process does. Admittance is applied to the coefficients, so that it is
//! exact at every `f_k`, phase included.

use super::problem::BuffetingProblem;
use super::spectrum::GustComponent;
use crate::aerodynamics::GustSeries;
use crate::error::{Error, Result, positive};
use crate::signal::{Fourier, random_stream};
use nalgebra::Complex;
use rand::Rng;
use rand_distr::StandardNormal;

/// Samples of one record.
const SAMPLES: std::ops::RangeInclusive<usize> = 16..=1 << 24;

/// Gauss's three points on (−1, 1).
const GAUSS_3: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 9.0),
    (0.0, 8.0 / 9.0),
    (0.774_596_669_241_483_4, 5.0 / 9.0),
];

/// One period of turbulence and of the gust forces.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct GustSample {
    /// The gusts themselves.
    pub gusts: GustSeries,
    /// Gust forces per unit length (n), each at all samples: N/m, N·m/m.
    pub forces: Vec<Vec<f64>>,
    /// Variances of `u` and `w` that records of this step and length have on average, m²/s².
    pub expected_variance: [f64; 2],
}

/// One period of `samples` samples, an even number, every `step_s` seconds. The same seed gives the same record.
///
/// # Errors
/// [`Error::Input`] for parts that do not fit together, a step that is not positive and a number of samples that is odd or
/// not between 16 and 2²⁴.
pub(crate) fn synthesise(
    problem: &BuffetingProblem<'_>,
    speed_m_s: f64,
    step_s: f64,
    samples: usize,
    seed: u64,
) -> Result<GustSample> {
    problem.validate()?;
    positive("wind speed", speed_m_s)?;
    positive("time step of the turbulence", step_s)?;
    if !SAMPLES.contains(&samples) || !samples.is_multiple_of(2) {
        let (least, most) = (SAMPLES.start(), SAMPLES.end());
        let expected = format!("an even number from {least} to {most}");
        let place = "samples of the turbulence";
        return Err(Error::input(place, expected, samples.to_string()));
    }
    let n = problem.structure.dofs.len();
    let zero = || vec![Complex::<f64>::default(); samples];
    let mut gusts = [zero(), zero()];
    let mut forces = vec![zero(); n];
    let mut expected_variance = [0.0; 2];
    let width_hz = 1.0 / (samples as f64 * step_s);
    for (j, component) in GustComponent::BOTH.into_iter().enumerate() {
        let Some(gust) = problem.turbulence.component(component) else {
            continue;
        };
        // a stream of its own for each component: switching one off leaves the other as it is
        let mut random = random_stream(seed, j as u64);
        for k in 1..samples / 2 {
            let middle = k as f64 * width_hz;
            let density = |f| gust.spectrum.density(component, f, speed_m_s);
            let variance = variance_of_line(middle, width_hz, density);
            expected_variance[j] += variance;
            let (a, b): (f64, f64) = (random.sample(StandardNormal), random.sample(StandardNormal));
            // x = Σ a cos + b sin, so half of a − ib at +f and its conjugate at −f
            let coefficient = Complex::new(a, -b) * (0.5 * variance.sqrt());
            add(&mut gusts[j], k, coefficient);
            let per_gust = problem.gust_force(component, middle, speed_m_s);
            for (force, unit) in forces.iter_mut().zip(per_gust.iter()) {
                add(force, k, unit * coefficient);
            }
        }
    }
    let fourier = Fourier::new(samples);
    let to_time = |spectrum| fourier.sums(spectrum);
    let [along, vertical] = gusts.map(to_time);
    Ok(GustSample {
        gusts: GustSeries::new(step_s, along, vertical)?,
        forces: forces.into_iter().map(to_time).collect(),
        expected_variance,
    })
}

/// The integral of a spectral density over the width of a line.
fn variance_of_line(middle_hz: f64, width_hz: f64, density: impl Fn(f64) -> f64) -> f64 {
    let points = GAUSS_3.iter();
    let parts = points.map(|(x, weight)| {
        let f = middle_hz + 0.5 * width_hz * x;
        0.5 * width_hz * weight * density(f)
    });
    parts.sum()
}

/// Adds a coefficient at the frequency `k` and its conjugate at `−k`.
fn add(spectrum: &mut [Complex<f64>], k: usize, coefficient: Complex<f64>) {
    let mirror = spectrum.len() - k;
    spectrum[k] += coefficient;
    spectrum[mirror] += coefficient.conj();
}
