//! Turbulence along the span over time: random Fourier coefficients, correlated from node to node.
//!
//! One period of a periodic Gaussian process as for a section ([`synthesise`](super::super::synthesise)). Its coefficients at a
//! frequency run along the span as a chain `ξ_{i+1} = ρ_i ξ_i + √(1 − ρ_i²) ν_i` with `ρ_i = exp(−C f Δs_i/V)`: every pair of
//! nodes then has exactly the coherence `exp(−C f |Δs|/V)`.

use super::SpanProblem;
use crate::buffeting::spectrum::GustComponent;
use crate::error::{Error, Result, positive};
use crate::signal::{Fourier, random_stream};
use nalgebra::Complex;
use rand::Rng;
use rand_distr::StandardNormal;
use rayon::prelude::*;

/// Samples of a field at each node.
const SAMPLES: std::ops::RangeInclusive<usize> = 16..=1 << 22;
/// Numbers of a field at most: four gigabytes.
const NUMBERS_AT_MOST: usize = 1 << 29;

/// Turbulence at every node of a bridge.
#[derive(Debug, Clone, PartialEq)]
pub struct TurbulenceField {
    /// Time step, s.
    pub step_s: f64,
    /// Place of each node along the girder, m.
    pub along_m: Vec<f64>,
    /// `u` then `w`, m/s: a row of samples per node.
    pub gusts: [Vec<Vec<f64>>; 2],
}

impl TurbulenceField {
    /// Samples at each node.
    pub fn samples(&self) -> usize {
        self.gusts[0].first().map_or(0, Vec::len)
    }
}

/// One period of `samples` samples, an even number, every `step_s` seconds at a mean wind speed. The same seed gives the same
/// field.
///
/// # Errors
/// [`Error::Input`] for parts that do not fit together and a number of samples that is odd or out of range.
pub fn turbulence_field(
    problem: &SpanProblem<'_>,
    speed_m_s: f64,
    step_s: f64,
    samples: usize,
    seed: u64,
) -> Result<TurbulenceField> {
    check(problem, speed_m_s, step_s, samples)?;
    let fourier = Fourier::new(samples);
    let gusts = GustComponent::BOTH.map(|component| {
        let rows = coefficients(problem, component, speed_m_s, step_s, samples, seed);
        let in_time = rows.into_par_iter().map(|mut row| {
            row.resize(samples, Complex::default());
            fourier.sums(row)
        });
        in_time.collect()
    });
    Ok(TurbulenceField {
        step_s,
        along_m: problem.bridge.nodes.iter().map(|n| n.along_m).collect(),
        gusts,
    })
}

/// Whether such a field can be made.
pub(super) fn check(
    problem: &SpanProblem<'_>,
    speed_m_s: f64,
    step_s: f64,
    samples: usize,
) -> Result<()> {
    problem.validate(speed_m_s)?;
    positive("time step of the turbulence", step_s)?;
    let nodes = problem.bridge.nodes.len();
    let fits = 2 * nodes.saturating_mul(samples) <= NUMBERS_AT_MOST;
    if !SAMPLES.contains(&samples) || !samples.is_multiple_of(2) || !fits {
        let expected = format!(
            "an even number from {} to {} that fits into memory",
            SAMPLES.start(),
            SAMPLES.end()
        );
        return Err(Error::input(
            "samples of the turbulence",
            expected,
            samples.to_string(),
        ));
    }
    Ok(())
}

/// Fourier coefficients of one component, a row per node, from zero to half the rate of the samples. Twice those of the positive
/// frequencies stand there alone: the real part of the inverse transform is the gust.
pub(super) fn coefficients(
    problem: &SpanProblem<'_>,
    component: GustComponent,
    speed: f64,
    step_s: f64,
    samples: usize,
    seed: u64,
) -> Vec<Vec<Complex<f64>>> {
    let factors = problem.wind_factors();
    let nodes = factors.len();
    let mut rows = vec![vec![Complex::<f64>::default(); samples / 2 + 1]; nodes];
    let Some(gust) = problem.turbulence.component(component) else {
        return rows;
    };
    let mut random = random_stream(seed, component as u64);
    let width_hz = 1.0 / (samples as f64 * step_s);
    let mut winds: Vec<f64> = factors.to_vec();
    winds.sort_by(f64::total_cmp);
    winds.dedup();
    for k in 1..samples / 2 {
        let frequency = k as f64 * width_hz;
        let size = |factor: f64| match factor * speed {
            0.0 => 0.0,
            local => (gust.spectrum.density(component, frequency, local) * width_hz).sqrt(),
        };
        let sizes: Vec<f64> = winds.iter().map(|w| size(*w)).collect();
        let gaps = problem
            .coherence
            .of_gaps(component, problem.bridge, frequency, speed);
        let mut chain = Complex::default();
        for (n, row) in rows.iter_mut().enumerate() {
            let (a, b): (f64, f64) = (random.sample(StandardNormal), random.sample(StandardNormal));
            let fresh = Complex::new(a, -b);
            chain = match n.checked_sub(1).map(|gap| gaps[gap]) {
                None => fresh,
                Some(rho) => chain * rho + fresh * (1.0 - rho * rho).sqrt(),
            };
            let wind = winds.partition_point(|w| *w < factors[n]);
            row[k] = chain * sizes[wind];
        }
    }
    rows
}
