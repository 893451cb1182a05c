//! Response of a bridge in the frequency domain: `S_η = H S_Q Hᴴ` with all modes coupled.

use super::SpanProblem;
use crate::bridge::ModalForces;
use crate::buffeting::quadrature::integrate;
use crate::buffeting::spectrum::GustComponent;
use crate::error::{Error, Result};
use crate::flutter::impedance;
use nalgebra::{Complex, DMatrix};
use serde::Serialize;
use std::f64::consts::TAU;

/// Relative error of the variances.
const TOLERANCE: f64 = 1e-5;
/// The integration ends at this many times the highest frequency of the bridge.
const REACH: f64 = 4.0;
/// Frequencies of a spectrum that are spread evenly, and those to each side of a resonance.
const EVEN: usize = 300;
const AROUND: i32 = 12;

/// Response at named nodes to turbulence at one mean wind speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpanResponse {
    /// Mean wind speed, m/s.
    pub speed_m_s: f64,
    /// Places of the nodes in the bridge.
    pub nodes: Vec<usize>,
    /// Root mean square of vertical, lateral displacement (m) and rotation (rad) of each node.
    pub rms: Vec<[f64; 3]>,
    /// Mean frequency of upward crossings of the mean, Hz.
    pub crossing_frequency_hz: Vec<[f64; 3]>,
}

impl SpanResponse {
    /// Expected greatest departure from the mean in `duration_s`, over the root mean square (Davenport 1964).
    pub(crate) fn peak_factors(&self, duration_s: f64) -> Vec<[f64; 3]> {
        let factor = |hertz: f64| {
            let root = (2.0 * (hertz * duration_s).max(1.0).ln()).sqrt();
            root + 0.577_215_664_901_532_9 / root
        };
        self.crossing_frequency_hz
            .iter()
            .map(|f| f.map(factor))
            .collect()
    }
}

/// Root mean squares of the displacements of `nodes` about their mean.
///
/// # Errors
/// [`Error::Input`] for parts that do not fit together and forces that say nothing at a `K`; [`Error::Unstable`] when the
/// bridge is unstable at this speed.
pub(crate) fn span_response(
    problem: &SpanProblem<'_>,
    nodes: &[usize],
    speed_m_s: f64,
) -> Result<SpanResponse> {
    problem.validate(speed_m_s)?;
    let (_, roots) = problem.coupled(speed_m_s)?;
    let shapes = problem.bridge.shapes_at(nodes);
    let forces = problem.bridge.forces();
    let mut breaks: Vec<f64> = roots
        .iter()
        .map(|z| z.im / TAU)
        .filter(|f| *f > 1e-6)
        .collect();
    breaks.sort_by(f64::total_cmp);
    breaks.dedup_by(|a, b| *a < *b * (1.0 + 1e-4));
    let highest = problem
        .bridge
        .modes
        .iter()
        .map(|m| m.frequency_hz)
        .fold(0.0, f64::max);
    breaks.retain(|f| *f < REACH * highest);
    breaks.insert(0, 0.0);
    breaks.push(REACH * highest);
    let densities = |f: f64| -> Result<Vec<f64>> {
        let spectra = spectra(problem, &forces, &shapes, (f, speed_m_s))?;
        let rates = spectra.iter().map(|s| s * (TAU * f).powi(2));
        Ok(spectra.iter().copied().chain(rates).collect())
    };
    let (variances, _) = integrate(densities, &breaks, TOLERANCE)?;
    let rows = shapes.nrows();
    let of = |n: usize, i: usize| variances[3 * n + i].sqrt();
    let crossing =
        |n: usize, i: usize| (variances[rows + 3 * n + i] / variances[3 * n + i]).sqrt() / TAU;
    let count = 0..nodes.len();
    Ok(SpanResponse {
        speed_m_s,
        nodes: nodes.to_vec(),
        rms: count
            .clone()
            .map(|n| std::array::from_fn(|i| of(n, i)))
            .collect(),
        crossing_frequency_hz: count
            .map(|n| std::array::from_fn(|i| crossing(n, i)))
            .collect(),
    })
}

/// One-sided spectra of the displacements of named nodes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpanSpectra {
    /// Hz, rising; close together at the resonances.
    pub frequencies_hz: Vec<f64>,
    /// Vertical, lateral (m²/Hz) and rotation (rad²/Hz) of each node at every frequency.
    pub densities: Vec<[Vec<f64>; 3]>,
}

/// Spectra of the displacements of `nodes`, from a hundredth of the slowest resonance to four times the highest frequency.
///
/// # Errors
/// [`Error::Input`] for parts that do not fit together and forces that say nothing at a `K`; [`Error::Unstable`] when the
/// bridge is unstable at this speed.
pub(crate) fn span_spectra(
    problem: &SpanProblem<'_>,
    nodes: &[usize],
    speed_m_s: f64,
) -> Result<SpanSpectra> {
    problem.validate(speed_m_s)?;
    let (_, roots) = problem.coupled(speed_m_s)?;
    let frequencies_hz = resolved(&roots);
    let shapes = problem.bridge.shapes_at(nodes);
    let forces = problem.bridge.forces();
    let mut densities = vec![[const { Vec::new() }; 3]; nodes.len()];
    for frequency in &frequencies_hz {
        let all = spectra(problem, &forces, &shapes, (*frequency, speed_m_s))?;
        for (row, density) in all.into_iter().enumerate() {
            densities[row / 3][row % 3].push(density);
        }
    }
    Ok(SpanSpectra {
        frequencies_hz,
        densities,
    })
}

/// Frequencies, Hz, that show every resonance: evenly spread on a logarithmic scale, and within ten half-power widths of
/// each eigenvalue.
fn resolved(roots: &[Complex<f64>]) -> Vec<f64> {
    let resonances = roots.iter().filter(|z| z.im > 1e-6 * z.norm());
    let hertz: Vec<(f64, f64)> = resonances.map(|z| (z.im / TAU, -z.re / TAU)).collect();
    let lowest = hertz.iter().map(|r| r.0).fold(f64::INFINITY, f64::min) / 100.0;
    let highest = hertz.iter().map(|r| r.0).fold(0.0, f64::max) * REACH;
    let even = (0..=EVEN).map(|i| lowest * (highest / lowest).powf(i as f64 / EVEN as f64));
    let near = hertz.iter().flat_map(|(f, half)| {
        (-AROUND..=AROUND)
            .map(move |i| f + half * 10.0 * (f64::from(i) / f64::from(AROUND)).powi(3))
    });
    let mut all: Vec<f64> = even.chain(near.filter(|f| *f > 0.0)).collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| *a <= *b * (1.0 + 1e-9));
    all
}

/// One-sided spectra of the rows of `shapes` at a frequency.
fn spectra(
    problem: &SpanProblem<'_>,
    forces: &ModalForces,
    shapes: &DMatrix<f64>,
    (frequency, speed): (f64, f64),
) -> Result<Vec<f64>> {
    // the limit at zero: what is static has no phase
    let frequency = frequency.max(1e-9);
    let structure = problem.bridge.structure();
    let z = impedance(&structure, forces, speed, TAU * frequency)?;
    // rows of Φ H: (Zᵀ)⁻¹ Φᵀ
    let rows = z
        .transpose()
        .lu()
        .solve(&shapes.transpose().map(Complex::from))
        .ok_or_else(|| {
            Error::Numerical(format!(
                "buffeting: the impedance is singular at {frequency} Hz and {speed} m/s"
            ))
        })?;
    let factors = problem.wind_factors();
    let mut total = vec![0.0; shapes.nrows()];
    for component in GustComponent::BOTH {
        let Some(gust) = problem.turbulence.component(component) else {
            continue;
        };
        let gaps = problem
            .coherence
            .of_gaps(component, problem.bridge, frequency, speed);
        // motion of each row by a gust of the size of the turbulence at each node
        let mut motion = problem.force_of_gusts(component, frequency, speed) * &rows;
        for (n, mut row) in motion.row_iter_mut().enumerate() {
            let local = factors[n] * speed;
            let density = if local > 0.0 {
                gust.spectrum.density(component, frequency, local)
            } else {
                0.0
            };
            row *= Complex::from(density.sqrt());
        }
        for (sum, column) in total.iter_mut().zip(motion.column_iter()) {
            *sum += coherent_power(column.as_slice(), &gaps);
        }
    }
    Ok(total)
}

/// `vᴴ C v` with the exponential coherence of a line, in one pass: `C = T + Tᴴ − I` with a recursion for `T`.
fn coherent_power(v: &[Complex<f64>], gaps: &[f64]) -> f64 {
    let mut sum = 0.0;
    let mut before = Complex::default();
    for (n, z) in v.iter().enumerate() {
        if n > 0 {
            before *= gaps[n - 1];
        }
        sum += z.norm_sqr() + 2.0 * (z.conj() * before).re;
        before += z;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_pass_is_the_double_sum() {
        let along = [0.0, 3.0, 4.5, 10.0, 11.0f64];
        let v: Vec<Complex<f64>> = (0..5)
            .map(|i| Complex::new((f64::from(i) * 1.3).sin(), 0.2 * f64::from(i)))
            .collect();
        let gaps: Vec<f64> = along
            .windows(2)
            .map(|x| (-0.3 * (x[1] - x[0])).exp())
            .collect();
        let mut expected = Complex::<f64>::default();
        for (a, x) in v.iter().zip(along) {
            for (b, y) in v.iter().zip(along) {
                let coherence: f64 = (-0.3 * f64::abs(x - y)).exp();
                expected += a.conj() * b * coherence;
            }
        }
        assert!((coherent_power(&v, &gaps) - expected.re).abs() < 1e-13);
    }
}
