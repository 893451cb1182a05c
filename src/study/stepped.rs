//! Onset of an exported FMU, found by stepping it through its C interface: the third route.

use crate::error::Result;
use crate::flutter::{Onset, OnsetInterval, OnsetMethod};
use crate::fmu::importer::{Fmu, SteppedOnset as Found, SteppingSearch, onset_by_stepping};
use crate::trained_model::TrainedModel;
use crate::units::ReducedFrequency;
use serde::Serialize;
use std::path::Path;

/// Communication steps that are tried, as parts of the shortest still-air period; a factor of ten apart.
const STEPS_PER_PERIOD: [f64; 2] = [40.0, 4.0];
/// The search starts at this part of its highest wind speed.
const LOWEST_PART: f64 = 0.15;

/// Onset found by stepping.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SteppedOnset {
    /// The onset, found with the shorter communication step.
    pub onset: Onset,
    /// Onset speed for each communication step.
    pub runs: Vec<SteppedRun>,
}

/// The search with one communication step.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
    pub fn explain(&self) -> String {
        let runs: Vec<String> = self
            .runs
            .iter()
            .map(|r| {
                format!(
                    "{:.4} m/s with a step of {} s ({} steps)",
                    r.speed_m_s, r.communication_step_s, r.steps
                )
            })
            .collect();
        format!("FMU stepped: {}", runs.join(", "))
    }
}

/// Onset of the FMU at `path`, packed from `model`, by the growth of its released section; `None` when it is stable up
/// to the highest speed.
///
/// # Errors
/// Those of the importer and of the search.
pub fn stepped_onset(
    model: &TrainedModel,
    path: &Path,
    speed_max_m_s: f64,
) -> Result<Option<SteppedOnset>> {
    let fmu = Fmu::open(path)?;
    let structure = model.section.structure()?;
    let fastest_hz = (0..structure.dofs.len())
        .map(|i| (structure.stiffness[(i, i)] / structure.mass[(i, i)]).sqrt())
        .fold(0.0, f64::max)
        / std::f64::consts::TAU;
    let mut found: Vec<Found> = Vec::with_capacity(STEPS_PER_PERIOD.len());
    for steps in STEPS_PER_PERIOD {
        let step = 1.0 / (steps * fastest_hz);
        let search = SteppingSearch::between(LOWEST_PART * speed_max_m_s, speed_max_m_s, step);
        match onset_by_stepping(&fmu, &search)?.onset() {
            Some(onset) => found.push(onset.clone()),
            None => return Ok(None),
        }
    }
    let runs = found
        .iter()
        .map(|f| SteppedRun {
            communication_step_s: f.communication_step_s,
            speed_m_s: f.speed_m_s,
            steps: f.steps,
        })
        .collect();
    Ok(found.first().map(|first| SteppedOnset {
        onset: as_onset(model, first),
        runs,
    }))
}

fn as_onset(model: &TrainedModel, found: &Found) -> Onset {
    let k =
        ReducedFrequency::from_hertz(found.frequency_hz, model.section.width_m, found.speed_m_s);
    Onset {
        model: model.name.clone(),
        method: OnsetMethod::FmuStepping,
        speed_m_s: found.speed_m_s,
        frequency_hz: found.frequency_hz,
        reduced_velocity: k.into(),
        reduced_frequency: k,
        mode_ratio: found.mode_ratio.unwrap_or(f64::NAN),
        phase_deg: found.phase_deg,
        damping_slope_s_m: None,
        branch: "dominant".to_owned(),
        in_tested_range: Some(model.tested_range.contains(k)),
        spurious_speeds_m_s: Vec::new(),
        warnings: Vec::new(),
        interval: OnsetInterval::none("that of the model in it"),
    }
}
