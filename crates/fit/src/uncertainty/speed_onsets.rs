//! What the tests at each mean speed say of the onset alone, and whether they contradict each other.

use super::coefficients::{CoefficientUncertainty, spread_over};
use super::onset::{
    CONFIDENCE, OnsetError, followed, onset_error, onset_gradient, speed_and_omega,
};
use super::statistics::two_sided_quantile;
use crate::aerodynamics::Transfer;
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result};
use crate::flutter::{Onset, OnsetSearch};
use crate::section::{Dof, Structure};
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use serde::{Deserialize, Serialize};

/// Reduced frequencies at which the transfer functions of two speeds are compared.
const POINTS: usize = 16;
/// A band ends where the difference is below this part of its largest value.
const HALF: f64 = 0.5;

/// Onsets that are nearer to each other than this part of one do not contradict each other, however little their blocks scatter.
const AGREEING: f64 = 1e-4;

/// Onset by the tests at one mean speed, with the poles of the fit to all of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpeedOnset {
    /// Mean wind speed of the tests, m/s.
    pub mean_speed_m_s: f64,
    /// The onset with the scatter of the blocks of that speed; none when they do not tell.
    pub onset: Option<OnsetError>,
    /// Why there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// Two mean speeds whose onsets differ by more than the scatter of their blocks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contradiction {
    /// The two mean speeds of the tests, m/s.
    pub mean_speeds_m_s: [f64; 2],
    /// Their onsets, m/s.
    pub onsets_m_s: [f64; 2],
    /// Difference of the onsets over its standard error.
    pub z: f64,
    /// Force whose transfer function moves the onset most from one speed to the other.
    pub force: Dof,
    /// Motion of that transfer function.
    pub motion: Dof,
    /// Band of reduced frequency in which it differs most, lower end.
    pub k_low: f64,
    /// Upper end.
    pub k_high: f64,
}

/// Onsets of all mean speeds.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpeedOnsets {
    /// One a mean speed; empty for tests at one speed.
    pub each: Vec<SpeedOnset>,
    /// The worst pair, if two contradict each other.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contradiction: Option<Contradiction>,
}

/// Onsets by the tests at each speed, near that of all tests.
pub(crate) fn speed_onsets(
    estimate: &CoefficientUncertainty,
    structure: &Structure,
    onset: &Onset,
    search: &OnsetSearch,
    tested: ReducedFrequencyRange,
) -> Result<SpeedOnsets> {
    let own = |own: &CoefficientUncertainty| own_onset(own, structure, onset, search, tested);
    let slopes = || onset_gradient(estimate, structure, speed_and_omega(onset));
    speed_onsets_by(estimate, tested, own, slopes)
}

/// The same of whatever the forces are part of: its onset `by` the estimate of one speed, and the `slopes` of its onset by all tests over
/// their coefficients.
///
/// # Errors
/// Those of the slopes, and [`Error::Numerical`] where a transfer function cannot be computed.
pub fn speed_onsets_by(
    estimate: &CoefficientUncertainty,
    tested: ReducedFrequencyRange,
    by: impl Fn(&CoefficientUncertainty) -> Result<OnsetError>,
    slopes: impl Fn() -> Result<Vec<f64>>,
) -> Result<SpeedOnsets> {
    let mut found = SpeedOnsets::default();
    let mut alone = Vec::new();
    for (mean_speed_m_s, own) in estimate.at_each_speed() {
        let judged = own.and_then(|own| {
            let error = by(&own)?;
            Ok((own, error))
        });
        let (error, reason) = match judged {
            Ok((estimate, error)) => {
                alone.push((mean_speed_m_s, estimate, error.clone()));
                (Some(error), None)
            }
            Err(error) => (None, Some(error.to_string())),
        };
        found.each.push(SpeedOnset {
            mean_speed_m_s,
            onset: error,
            reason,
        });
    }
    let apart = |a: &OnsetError, b: &OnsetError| (a.speed_m_s / b.speed_m_s - 1.0).abs() > AGREEING;
    let mut pairs = Vec::new();
    for (i, a) in alone.iter().enumerate() {
        for b in alone[i + 1..].iter().filter(|b| apart(&a.2, &b.2)) {
            let (z, limit) = z_of(&a.2, &b.2);
            pairs.extend((z.abs() > limit).then_some((z, a, b)));
        }
    }
    pairs.sort_by(|x, y| x.0.abs().total_cmp(&y.0.abs()));
    if let Some((z, (v1, first, one), (v2, second, other))) = pairs.pop() {
        let gradient = slopes()?;
        let (force, motion) = greatest_part(estimate, &gradient, first, second);
        let (k_low, k_high) = band(force, motion, tested, [first, second])?;
        found.contradiction = Some(Contradiction {
            mean_speeds_m_s: [*v1, *v2],
            onsets_m_s: [one.speed_m_s, other.speed_m_s],
            z,
            force,
            motion,
            k_low,
            k_high,
        });
    }
    Ok(found)
}

/// The onset of one speed alone: the same eigenvalue, or else the answer of a search.
fn own_onset(
    own: &CoefficientUncertainty,
    structure: &Structure,
    onset: &Onset,
    search: &OnsetSearch,
    tested: ReducedFrequencyRange,
) -> Result<OnsetError> {
    let model = own.model_at(&own.values())?;
    let section = CoupledSection::with_model(structure, &model)?;
    let found = followed(&section, speed_and_omega(onset), search, Some(tested))?;
    let none = || Error::Numerical(format!("no onset up to {} m/s", search.speed_max_m_s));
    onset_error(own, structure, found.ok_or_else(none)?, None)
}

/// Difference over its standard error, and the limit beyond which it is no chance.
fn z_of(a: &OnsetError, b: &OnsetError) -> (f64, f64) {
    let (va, vb) = (a.standard_error_m_s.powi(2), b.standard_error_m_s.powi(2));
    let squares = va * va / a.degrees_of_freedom + vb * vb / b.degrees_of_freedom;
    let freedom = ((va + vb).powi(2) / squares).max(1.0);
    let z = (a.speed_m_s - b.speed_m_s) / (va + vb).sqrt();
    (z, two_sided_quantile(CONFIDENCE, freedom))
}

/// The transfer function whose change from one speed to the other moves the onset most, to first order.
fn greatest_part(
    estimate: &CoefficientUncertainty,
    gradient: &[f64],
    a: &CoefficientUncertainty,
    b: &CoefficientUncertainty,
) -> (Dof, Dof) {
    let (a, b) = (a.values(), b.values());
    let own = estimate.own_coefficients();
    let n = estimate.dofs.len();
    let part = |list: &[usize]| -> f64 {
        let sum: f64 = list.iter().map(|&p| gradient[p] * (a[p] - b[p])).sum();
        sum.abs()
    };
    let greatest = (0..own.len()).max_by(|x, y| part(&own[*x]).total_cmp(&part(&own[*y])));
    let at = greatest.unwrap_or(0);
    (estimate.dofs[at / n], estimate.dofs[at % n])
}

/// Where a transfer function differs most, relative to itself: around the largest difference, as far as it is half of
/// that, among the reduced frequencies that both speeds tested.
fn band(
    force: Dof,
    motion: Dof,
    tested: ReducedFrequencyRange,
    speeds: [&CoefficientUncertainty; 2],
) -> Result<(f64, f64)> {
    let ranges = speeds.map(|s| s.tested_range().unwrap_or(tested));
    let low = ranges[0].min.full_width().max(ranges[1].min.full_width());
    let high = ranges[0].max.full_width().min(ranges[1].max.full_width());
    let (low, high) = match low < high {
        true => (low, high),
        false => (tested.min.full_width(), tested.max.full_width()),
    };
    let dofs = &speeds[0].dofs;
    let place = |dof| dofs.iter().position(|d| *d == dof).unwrap_or(0);
    let entry = (place(force), place(motion));
    let [first, second] = speeds.map(|s| s.model_at(&s.values()));
    let (first, second) = (first?, second?);
    let mut differences = Vec::with_capacity(POINTS);
    let [min, max] = [low, high].map(ReducedFrequency::from_full_width);
    for k in spread_over(ReducedFrequencyRange::between(min, max), POINTS) {
        let (x, y) = (first.transfer(k)?[entry], second.transfer(k)?[entry]);
        let difference = 2.0 * (x - y).norm() / (x.norm() + y.norm());
        differences.push((k.full_width(), difference));
    }
    let top = (0..POINTS).max_by(|x, y| differences[*x].1.total_cmp(&differences[*y].1));
    let top = top.unwrap_or(0);
    let large = |i: &usize| differences[*i].1 >= HALF * differences[top].1;
    let from = (0..=top).rev().take_while(large).last().unwrap_or(top);
    let to = (top..POINTS).take_while(large).last().unwrap_or(top);
    Ok((differences[from].0, differences[to].0))
}

impl SpeedOnsets {
    /// One line with the onset of every speed; none for tests at one speed.
    pub fn explain(&self) -> Option<String> {
        if self.each.is_empty() {
            return None;
        }
        let one = |s: &SpeedOnset| {
            let tests = s.mean_speed_m_s;
            let Some(onset) = &s.onset else {
                let reason = s.reason.as_deref().unwrap_or("not judged");
                return format!("none at {tests:.2} m/s ({reason})");
            };
            let (speed, half) = (onset.speed_m_s, onset.half_width_m_s());
            let (low, high) = (speed - half, speed + half);
            format!("{speed:.3} m/s ({low:.3} to {high:.3}) at {tests:.2} m/s")
        };
        let each: Vec<String> = self.each.iter().map(one).collect();
        let each = each.join("; ");
        Some(format!(
            "onset by the tests of each mean speed alone: {each}"
        ))
    }
}

impl Contradiction {
    /// In words, with what to do.
    pub fn explain(&self) -> String {
        let ([v1, v2], [u1, u2]) = (self.mean_speeds_m_s, self.onsets_m_s);
        format!(
            "the mean speeds contradict each other: onset {u1:.3} m/s by the tests at {v1:.2} m/s, {u2:.3} m/s by those at \
             {v2:.2} m/s (z = {:.1}); what moves it most is the {} force due to {} motion: test again between K {:.2} and {:.2} \
             (or the form of the model does not follow the forces there)",
            self.z.abs(),
            self.force.name(),
            self.motion.name(),
            self.k_low,
            self.k_high
        )
    }
}
