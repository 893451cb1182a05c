//! Response in the frequency domain: `S_r = H S_F Hᴴ`, and its integral.

use super::problem::BuffetingProblem;
use super::quadrature::{each, integrate};
use super::spectrum::GustComponent;
use super::stability::turning;
use crate::error::{Error, Result};
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use serde::Serialize;

/// Relative error of the variances.
const TOLERANCE: f64 = 1e-8;
/// Of those of the accelerations, which end at the highest frequency below.
const ACCELERATION_TOLERANCE: f64 = 1e-5;
/// The integration over the frequency ends at this many times the highest natural one, that over its inverse begins there.
const REACH: f64 = 20.0;

/// Response to turbulence at one mean wind speed; vectors in the order of the degrees of freedom.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BuffetingResponse {
    /// Mean wind speed, m/s.
    pub speed_m_s: f64,
    /// Root mean square of the displacements about their mean: m, rad.
    pub rms: Vec<f64>,
    /// Root mean square of the rates: m/s, rad/s.
    pub rate_rms: Vec<f64>,
    /// Root mean square of the accelerations: m/s², rad/s².
    pub acceleration_rms: Vec<f64>,
    /// The part of `rms` that each component of the turbulence causes alone, `u` then `w`.
    pub rms_by_gust: [Vec<f64>; 2],
    /// Mean frequency of upward crossings of the mean, Hz: rate over displacement over 2π.
    pub crossing_frequency_hz: Vec<f64>,
    /// Part of each variance inside the tested range of `K`, when the model has one.
    pub part_in_tested_range: Option<Vec<f64>>,
}

/// One-sided spectra of the displacements at a frequency (n): m²/Hz, rad²/Hz.
pub(crate) fn response_spectrum(
    problem: &BuffetingProblem<'_>,
    frequency_hz: f64,
    speed_m_s: f64,
) -> Result<Vec<f64>> {
    let [by_u, by_w] = spectra_by_gust(problem, frequency_hz, speed_m_s)?;
    Ok(added(&by_u, &by_w).collect())
}

fn added<'a>(a: &'a [f64], b: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    a.iter().zip(b).map(|(a, b)| a + b)
}

/// The same by each component of the turbulence; the components are independent, so that they add up.
fn spectra_by_gust(
    problem: &BuffetingProblem<'_>,
    frequency_hz: f64,
    speed_m_s: f64,
) -> Result<[Vec<f64>; 2]> {
    let motion = problem.gust_to_motion(frequency_hz, speed_m_s)?;
    let column = |j: usize| -> Vec<f64> {
        let component = GustComponent::BOTH[j];
        let density = problem.turbulence.component(component).map_or(0.0, |gust| {
            gust.spectrum.density(component, frequency_hz, speed_m_s)
        });
        motion
            .column(j)
            .iter()
            .map(|z| z.norm_sqr() * density)
            .collect()
    };
    Ok([column(0), column(1)])
}

/// Root mean squares at a mean wind speed, the variances integrated over all frequencies to 1e-8.
///
/// `tested` is the range of reduced frequencies in which the model was tested.
///
/// # Errors
/// [`Error::Input`] for parts that do not fit together; [`Error::Unstable`] when the section is unstable at this speed.
pub(crate) fn buffeting_response(
    problem: &BuffetingProblem<'_>,
    speed_m_s: f64,
    tested: Option<ReducedFrequencyRange>,
) -> Result<BuffetingResponse> {
    problem.validate()?;
    let turned = turning(problem.structure, problem.model, speed_m_s)?;
    if turned.growing > 0 {
        return Err(Error::Unstable(format!(
            "buffeting at {speed_m_s} m/s: the section is unstable there ({} growing roots), no response is stationary",
            turned.growing
        )));
    }
    let last = REACH * problem.natural_range_hz().1;
    let peaks = turned.resonances_hz.iter().map(|(hertz, _)| *hertz);
    let peaks: Vec<f64> = peaks.filter(|f| *f < last).collect();
    let n = problem.structure.dofs.len();
    let variances = all_frequencies(problem, speed_m_s, &peaks)?;
    let part = |i: usize| variances[i * n..(i + 1) * n].to_vec();
    let [by_u, by_w, rates] = [part(0), part(1), part(2)];
    let rms: Vec<f64> = added(&by_u, &by_w).map(f64::sqrt).collect();
    let rate_rms = roots(&rates);
    let crossing = rate_rms
        .iter()
        .zip(&rms)
        .map(|(rate, rms)| rate / rms / std::f64::consts::TAU);
    let accelerations = accelerations(problem, speed_m_s, &peaks)?;
    let part_in_tested_range = tested
        .map(|range| tested_part(problem, speed_m_s, &peaks, range, &rms))
        .transpose()?;
    Ok(BuffetingResponse {
        speed_m_s,
        crossing_frequency_hz: crossing.collect(),
        rms_by_gust: [roots(&by_u), roots(&by_w)],
        rms,
        rate_rms,
        acceleration_rms: roots(&accelerations),
        part_in_tested_range,
    })
}

fn roots(variances: &[f64]) -> Vec<f64> {
    variances.iter().map(|v| v.sqrt()).collect()
}

/// Variances of the accelerations, by themselves, so that those of the displacements do not hang on them.
fn accelerations(problem: &BuffetingProblem<'_>, speed: f64, peaks: &[f64]) -> Result<Vec<f64>> {
    let last = REACH * problem.natural_range_hz().1;
    let breaks = [&[0.0], peaks, &[last]].concat();
    let densities = |f: f64| -> Result<Vec<f64>> {
        let [by_u, by_w] = spectra_by_gust(problem, f, speed)?;
        let fourth = (std::f64::consts::TAU * f).powi(4);
        Ok(added(&by_u, &by_w).map(|sum| fourth * sum).collect())
    };
    let (inner, _) = integrate(each(densities), &breaks, ACCELERATION_TOLERANCE)?;
    Ok(inner)
}

/// Variances of the displacements by `u`, by `w`, and of the rates (3n): up to the last break over the frequency, beyond it
/// over its inverse.
fn all_frequencies(problem: &BuffetingProblem<'_>, speed: f64, peaks: &[f64]) -> Result<Vec<f64>> {
    let last = REACH * problem.natural_range_hz().1;
    let mut breaks = vec![0.0];
    breaks.extend_from_slice(peaks);
    breaks.push(last);
    let densities = |f: f64| -> Result<Vec<f64>> {
        let [by_u, by_w] = spectra_by_gust(problem, f, speed)?;
        let square = (std::f64::consts::TAU * f).powi(2);
        let rates: Vec<f64> = added(&by_u, &by_w).map(|sum| square * sum).collect();
        Ok([by_u, by_w, rates].concat())
    };
    let (inner, _) = integrate(each(densities), &breaks, TOLERANCE)?;
    let beyond = |t: f64| -> Result<Vec<f64>> {
        let values = densities(1.0 / t)?;
        Ok(values.into_iter().map(|v| v / (t * t)).collect())
    };
    // a millionth of the whole at most, so a coarser tolerance does
    let (tail, _) = integrate(each(beyond), &[0.0, 1.0 / last], 1e-4)?;
    Ok(added(&inner, &tail).collect())
}

fn tested_part(
    problem: &BuffetingProblem<'_>,
    speed: f64,
    peaks: &[f64],
    range: ReducedFrequencyRange,
    rms: &[f64],
) -> Result<Vec<f64>> {
    let hertz =
        |k: ReducedFrequency| k.circular(problem.structure.width_m, speed) / std::f64::consts::TAU;
    let (low, high) = (hertz(range.min), hertz(range.max));
    let mut breaks = vec![low];
    breaks.extend(peaks.iter().filter(|f| (low..high).contains(f)));
    breaks.push(high);
    let (inside, _) = integrate(
        each(|f| response_spectrum(problem, f, speed)),
        &breaks,
        1e-6,
    )?;
    Ok(inside
        .iter()
        .zip(rms)
        .map(|(v, rms)| v / (rms * rms))
        .collect())
}
