//! Turbulence at nodes along a line and its forces over time, from random Fourier coefficients.
//!
//! A record of `N` samples is one period `T = NΔt` of a periodic Gaussian process. Its coefficients at `f_k = k/T`,
//! `0 < k < N/2`, are independent, with the variance that the spectrum has between `f_k − 1/2T` and `f_k + 1/2T`. So the
//! expected variance of every record is exactly the integral of the spectrum from `1/2T` to `f_N − 1/2T`, `f_N = 1/2Δt`, and
//! each single record scatters about it as a Gaussian process does. Admittance is applied to the coefficients, so that it is
//! exact at every `f_k`, phase included.
//!
//! Coefficients of a frequency run along the line as a chain `ξ_{i+1} = ρ_i ξ_i + √(1 − ρ_i²) ν_i` with `ρ_i = exp(−C f Δs_i/V)`: every
//! pair of nodes then has exactly the coherence `exp(−C f |Δs|/V)`.

use super::problem::{BuffetingProblem, Gust};
use crate::aerodynamics::GustComponent;
use crate::error::{Error, Result, ensure, positive};
use crate::signal::{Fourier, random_stream};
use aerodeck_core::threads;
use nalgebra::{Complex, DMatrix};
use rand::Rng;
use rand_distr::StandardNormal;

/// Samples of one record.
const SAMPLES: std::ops::RangeInclusive<usize> = 16..=1 << 24;
/// Numbers of a record at all nodes at most: four gigabytes.
const NUMBERS_AT_MOST: usize = 1 << 29;

/// Turbulence `u`, `w`, m/s, a row per node: one period of `samples` samples, an even number, every `step_s` seconds at a mean wind
/// speed. The same seed gives the same gusts.
///
/// # Errors
/// [`Error::Input`] for a step that is not positive or longer than a quarter of the shortest period, and a number of samples that is odd or not between 16 and 2²⁴.
pub fn turbulence_field(
    problem: &BuffetingProblem<'_>,
    speed_m_s: f64,
    step_s: f64,
    samples: usize,
    seed: u64,
) -> Result<[Vec<Vec<f64>>; 2]> {
    problem.check_record(speed_m_s, step_s, samples)?;
    let fourier = Fourier::new(samples);
    Ok(GustComponent::BOTH.map(|component| {
        let mut rows = problem.coefficients(component, speed_m_s, step_s, samples, seed);
        threads::in_parts(&mut rows, 1, |_, row| {
            in_time(&fourier, std::mem::take(&mut row[0]))
        })
    }))
}

/// The real signal of which the numbers of the positive frequencies are twice the Fourier coefficients.
fn in_time(fourier: &Fourier, mut spectrum: Vec<Complex<f64>>) -> Vec<f64> {
    spectrum.resize(fourier.length(), Complex::default());
    fourier.sums(spectrum)
}

/// The same of real and imaginary parts one after the other.
pub(super) fn parts_in_time(fourier: &Fourier, parts: &[f64]) -> Vec<f64> {
    let pairs = parts.chunks_exact(2);
    in_time(fourier, pairs.map(|z| Complex::new(z[0], z[1])).collect())
}

impl BuffetingProblem<'_> {
    /// Whether such a record can be made.
    pub(super) fn check_record(&self, speed_m_s: f64, step_s: f64, samples: usize) -> Result<()> {
        positive("wind speed", speed_m_s)?;
        positive("time step of the turbulence", step_s)?;
        let (highest_hz, longest_s) = (self.highest_hz, 0.25 / self.highest_hz);
        ensure(
            step_s <= longest_s,
            "time step of the turbulence",
            format_args!(
                "at most {longest_s:.4} s, a quarter of the shortest period, for a mode at {highest_hz:.4} Hz"
            ),
            format_args!("{step_s} s"),
        )?;
        let fits = 2 * self.nodes.len().saturating_mul(samples) <= NUMBERS_AT_MOST;
        if SAMPLES.contains(&samples) && samples.is_multiple_of(2) && fits {
            return Ok(());
        }
        let (least, most) = (SAMPLES.start(), SAMPLES.end());
        Err(Error::input(
            "samples of the turbulence",
            format!("an even number from {least} to {most} that fits into memory"),
            samples.to_string(),
        ))
    }

    /// Fourier coefficients of one component, a row per node, from zero to half the rate of the samples. Twice those of the positive
    /// frequencies stand there alone: the real part of the inverse transform is the gust.
    pub(super) fn coefficients(
        &self,
        component: GustComponent,
        speed_m_s: f64,
        step_s: f64,
        samples: usize,
        seed: u64,
    ) -> Vec<Vec<Complex<f64>>> {
        let mut rows = vec![vec![Complex::default(); samples / 2 + 1]; self.nodes.len()];
        let Some(gust) = self.turbulence.component(component) else {
            return rows;
        };
        // a stream of its own for each component: switching one off leaves the other as it is
        let mut random = random_stream(seed, component as u64);
        let width_hz = 1.0 / (samples as f64 * step_s);
        let winds = self.winds_m_s(speed_m_s);
        for k in 1..samples / 2 {
            let frequency = k as f64 * width_hz;
            let sizes = self.at_nodes(|strips| {
                let local = strips.wind_factor * speed_m_s;
                let variance = self.line_variance(gust, component, frequency, width_hz, local);
                variance.sqrt()
            });
            let coherence = &self.coherence;
            let gaps = coherence.of_gaps(component, &self.nodes, frequency, &winds);
            let mut chain = Complex::default();
            for (n, row) in rows.iter_mut().enumerate() {
                let (a, b): (f64, f64) =
                    (random.sample(StandardNormal), random.sample(StandardNormal));
                let fresh = Complex::new(a, -b);
                chain = match n.checked_sub(1).map(|gap| gaps[gap]) {
                    None => fresh,
                    Some(rho) => chain * rho + fresh * (1.0 - rho * rho).sqrt(),
                };
                row[k] = chain * sizes[n];
            }
        }
        rows
    }

    /// The integral of a spectral density over the width of a line.
    fn line_variance(
        &self,
        gust: &Gust,
        component: GustComponent,
        middle_hz: f64,
        width_hz: f64,
        wind_m_s: f64,
    ) -> f64 {
        let parts = self.line_rule.iter().map(|(x, weight)| {
            let f = middle_hz + 0.5 * width_hz * x;
            0.5 * width_hz * weight * gust.spectrum.density(component, f, wind_m_s)
        });
        parts.sum()
    }

    /// Variances of `u` and `w` in the mean wind that records have on average, m²/s².
    pub(super) fn expected_variance(
        &self,
        speed_m_s: f64,
        step_s: f64,
        samples: usize,
    ) -> [f64; 2] {
        let width_hz = 1.0 / (samples as f64 * step_s);
        GustComponent::BOTH.map(|component| {
            let Some(gust) = self.turbulence.component(component) else {
                return 0.0;
            };
            let lines = (1..samples / 2).map(|k| k as f64 * width_hz);
            let each = lines.map(|f| self.line_variance(gust, component, f, width_hz, speed_m_s));
            each.sum()
        })
    }

    /// Forces on the coordinates, one column each, real and imaginary parts of every frequency one after the other, by gusts of which a
    /// row per node is made for each component; the admittance is exact at each frequency.
    pub(super) fn forces(
        &self,
        speed_m_s: f64,
        step_s: f64,
        samples: usize,
        gusts: impl Fn(GustComponent) -> Vec<Vec<Complex<f64>>>,
    ) -> DMatrix<f64> {
        let frequencies = samples / 2 + 1;
        let width_hz = 1.0 / (samples as f64 * step_s);
        let mut forces = DMatrix::zeros(2 * frequencies, self.structure.dofs.len());
        for component in GustComponent::BOTH {
            let Some(gust) = self.turbulence.component(component) else {
                continue;
            };
            let rows = gusts(component);
            // long gusts of the same forces
            let mut long = DMatrix::<f64>::zeros(2 * frequencies, self.nodes.len());
            for strips in &self.strips {
                let factor = |k| self.admittance(gust, strips, k as f64 * width_hz, speed_m_s);
                let factors: Vec<Complex<f64>> = (0..frequencies).map(factor).collect();
                for &n in &strips.nodes {
                    let mut column = long.column_mut(n);
                    let parts = column.as_mut_slice().chunks_exact_mut(2);
                    for ((part, x), factor) in parts.zip(&rows[n]).zip(&factors) {
                        let force = factor * x;
                        (part[0], part[1]) = (force.re, force.im);
                    }
                }
            }
            forces.gemm(1.0, &long, &self.gust_forces[component as usize], 1.0);
        }
        forces
    }
}
