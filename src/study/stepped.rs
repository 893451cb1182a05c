//! Onset of an exported FMU, found by stepping it through its C interface: the third route.

use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result, counted};
use crate::flutter::{
    CriticalPoint, FlutterSearch, Onset, OnsetInterval, OnsetMethod, OnsetSearch, StableRange,
    UnstableStart, judged_speeds,
};
use crate::fmu::importer::{
    Fmu, GrowthOnset as Found, GrowthPoint, SteppedSearch, growth_by_stepping, onset_by_stepping,
};
use crate::trained_model::TrainedModel;
use crate::units::ReducedFrequency;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::path::Path;

/// Communication steps that are tried, as parts of the shortest still-air period; a factor of ten apart.
const STEPS_PER_PERIOD: [f64; 2] = [40.0, 4.0];
/// Relative change of the speed at which a motion counts as being at the end of the tested range, and rounds to it.
const ENTRY_TOLERANCE: f64 = 1e-4;
const MAX_ROUNDS: usize = 12;
/// The search starts at this part of its highest wind speed.
const LOWEST_PART: f64 = 0.15;

/// Onset found by stepping.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SteppedOnset {
    /// The onset, found with the shorter communication step.
    pub onset: Onset,
    /// Onset speed for each communication step.
    pub runs: Vec<SteppedRun>,
}

/// The search with one communication step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SteppedRun {
    /// Communication step, s.
    pub communication_step_s: f64,
    /// Onset speed, m/s.
    pub speed_m_s: f64,
    /// Communication steps done in all.
    pub steps: usize,
}

impl SteppedOnset {
    /// In words.
    pub(crate) fn explain(&self) -> String {
        let run = |r: &SteppedRun| {
            let (speed, step, steps) = (r.speed_m_s, r.communication_step_s, r.steps);
            let steps = counted(steps, "step");
            format!("{speed:.4} m/s with a step of {step:.4} s ({steps})")
        };
        let runs: Vec<String> = self.runs.iter().map(run).collect();
        format!("FMU stepped: {}", runs.join(", "))
    }
}

/// Onset of the FMU at `path`, packed from `model`, by the growth of its released section. The second communication step
/// is tried only where the first finds an onset. Growth counts at the lowest speed stepped, or where the motion comes into the tested
/// range; the search with each communication step stands beside an onset alone.
pub fn stepped_onset(
    model: &TrainedModel,
    path: &Path,
    speed_max_m_s: f64,
) -> Result<(FlutterSearch, Vec<SteppedRun>)> {
    let without_runs = |search| Ok((search, Vec::new()));
    let fmu = Fmu::open(path)?;
    let structure = model.section.structure()?;
    let fastest_hz = structure.still_air_rad_s().fold(0.0, f64::max) / TAU;
    let mut found: Vec<Found> = Vec::with_capacity(STEPS_PER_PERIOD.len());
    for steps in STEPS_PER_PERIOD {
        let step = 1.0 / (steps * fastest_hz);
        match onset_by_stepping(&fmu, LOWEST_PART * speed_max_m_s, speed_max_m_s, step)? {
            SteppedSearch::Onset(onset) => found.push(*onset),
            SteppedSearch::UnstableAtOrBelow(at) => {
                let reason = match at.frequency_rad_s > 0.0 {
                    true => "the lowest speed stepped",
                    false => "the lowest speed stepped, where it diverges without oscillating",
                };
                let reason = reason.to_owned();
                return without_runs(unstable(model, &at, reason));
            }
            SteppedSearch::StableUpTo(range) => {
                // what is stepped knows nothing of tests; where its modes leave them is asked of the model
                let section = CoupledSection::with_model(&structure, &model.model)?;
                let search = OnsetSearch::up_to(speed_max_m_s);
                let (judged, _) = judged_speeds(&section, &search, Some(model.tested_range))?;
                return without_runs(FlutterSearch::StableUpTo(range.and(judged)));
            }
        }
    }
    let runs = found.iter().map(|f| SteppedRun {
        communication_step_s: f.communication_step_s,
        speed_m_s: f.speed_m_s,
        steps: f.steps,
    });
    let runs = runs.collect();
    let Some(first) = found.first() else {
        return Err(Error::Numerical("FMU stepped: no run".into()));
    };
    if first.frequency_hz <= 0.0 {
        return without_runs(diverges(first));
    }
    let mut onset = as_onset(model, first);
    if let Some(at) = entering(&fmu, model, first)? {
        if at.growth_rate_per_s > 0.0 && at.frequency_rad_s > 0.0 {
            return without_runs(grows_inside(model, &at, first));
        }
        onset.warnings.extend(diverges_inside(&at));
    }
    Ok((FlutterSearch::Onset(Box::new(onset)), runs))
}

/// A section that diverges before anything that oscillates grows.
fn diverges(found: &Found) -> FlutterSearch {
    FlutterSearch::StableUpTo(StableRange {
        from_m_s: found.lowest_m_s,
        to_m_s: found.speed_m_s,
        not_judged: Some(format!(
            "from {:.3} m/s on the section diverges, which hides any oscillation",
            found.speed_m_s
        )),
    })
}

/// The growth of an onset above the tested `K` where its motion comes into the tested range; none of one that was inside from the
/// beginning.
fn entering(fmu: &Fmu, model: &TrainedModel, found: &Found) -> Result<Option<GrowthPoint>> {
    let limit = model.tested_range.max;
    let width = model.section.width_m;
    if ReducedFrequency::from_hertz(found.frequency_hz, width, found.speed_m_s) <= limit {
        return Ok(None);
    }
    let speed_of = |frequency_hz: f64| TAU * frequency_hz * width / limit.full_width();
    let mut speed = speed_of(found.frequency_hz);
    let mut at = growth_by_stepping(fmu, speed, found.communication_step_s)?;
    for _ in 0..MAX_ROUNDS {
        let next = speed_of(at.frequency_hz());
        if at.frequency_rad_s <= 0.0 || (next / speed - 1.0).abs() < ENTRY_TOLERANCE {
            break;
        }
        speed = next;
        at = growth_by_stepping(fmu, speed, found.communication_step_s)?;
    }
    Ok(Some(at))
}

/// A motion that grows where it comes into the tested range: unstable at and below that speed.
fn grows_inside(model: &TrainedModel, at: &GrowthPoint, found: &Found) -> FlutterSearch {
    let reason = format!(
        "there its motion enters the range that can be judged, which ends at K {:.4}; outside, the FMU grows from \
         {:.3} m/s on",
        model.tested_range.max.full_width(),
        found.speed_m_s
    );
    let mut answer = unstable(model, at, reason);
    if let FlutterSearch::UnstableAtOrBelow(start) = &mut answer {
        start.in_tested_range = Some(true);
    }
    answer
}

/// A motion that no longer oscillates where it would come into the tested range, which growth without oscillating hides.
fn diverges_inside(at: &GrowthPoint) -> Option<String> {
    (at.growth_rate_per_s > 0.0).then(|| {
        format!(
            "at {:.3} m/s, where its motion would come into the tested range, the section diverges without \
             oscillating",
            at.speed_m_s
        )
    })
}

fn unstable(model: &TrainedModel, at: &GrowthPoint, reason: String) -> FlutterSearch {
    let point = stepped_point(model, at.speed_m_s, at.frequency_hz());
    FlutterSearch::UnstableAtOrBelow(Box::new(UnstableStart {
        in_tested_range: Some(model.tested_range.contains(point.reduced_frequency)),
        at: point,
        growth_rate_per_s: at.growth_rate_per_s,
        branch: "dominant".to_owned(),
        reason,
        warnings: Vec::new(),
        onset_above: None,
        damped_from_m_s: None,
    }))
}

fn as_onset(model: &TrainedModel, found: &Found) -> Onset {
    let point = stepped_point(model, found.speed_m_s, found.frequency_hz);
    let k = point.reduced_frequency;
    Onset {
        at: point,
        mode: found.mode,
        damping_slope_s_m: None,
        branch: "dominant".to_owned(),
        in_tested_range: Some(model.tested_range.contains(k)),
        gap: model.tested_range.gap_at(k),
        spurious_speeds_m_s: Vec::new(),
        warnings: Vec::new(),
        interval: OnsetInterval::none("that of the model in it"),
    }
}

/// A speed at which the FMU of the model was stepped, with its oscillation.
fn stepped_point(model: &TrainedModel, speed_m_s: f64, frequency_hz: f64) -> CriticalPoint {
    let k = ReducedFrequency::from_hertz(frequency_hz, model.section.width_m, speed_m_s);
    let method = OnsetMethod::FmuStepping;
    CriticalPoint::new(&model.name, method, speed_m_s, frequency_hz, k)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(speed_m_s: f64, growth_rate_per_s: f64, frequency_hz: f64) -> GrowthPoint {
        GrowthPoint {
            speed_m_s,
            growth_rate_per_s,
            frequency_rad_s: TAU * frequency_hz,
            shape: Vec::new(),
        }
    }

    /// A motion without frequency has no reduced frequency to step it at; that the section diverges is the answer.
    #[test]
    fn a_motion_that_diverges_is_an_answer() {
        let found = Found {
            speed_m_s: 21.5,
            frequency_hz: 0.0,
            mode: None,
            communication_step_s: 0.01,
            lowest_m_s: 9.0,
            steps: 1000,
        };
        let said = diverges(&found).explain();
        assert_eq!(
            said,
            "no flutter up to 21.500 m/s, judged from 9.000 m/s (from 21.500 m/s on the section diverges, which hides any \
             oscillation)"
        );
        let said = diverges_inside(&point(30.0, 0.4, 0.0)).unwrap();
        assert!(said.starts_with("at 30.000 m/s, "), "{said}");
        assert_eq!(diverges_inside(&point(30.0, -0.4, 0.0)), None);
    }
}
