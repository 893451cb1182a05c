//! Onsets of one force model on many sections.

use super::coefficients;
use super::run::Finder;
use crate::error::{Error, Result};
use crate::flutter::{SweepOutcome, SweptOnset};
use crate::section::SectionModel;
use crate::trained_model::TrainedModel;
use rayon::prelude::*;

/// Sections between two reports of progress, on one core.
const CHUNK: usize = 2048;

/// What was found of one section.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OnsetKind {
    /// An onset inside the tested range.
    Tested,
    /// An onset outside it.
    Untested,
    /// Growth at the lowest speed that could be judged.
    UnstableAtOrBelow,
    /// None up to the highest speed.
    Stable,
}

/// Onsets of many sections, in their order; NaN where there is none.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ManyOnsets {
    /// Onset speeds, m/s.
    pub speeds_m_s: Vec<f64>,
    /// Frequencies at the onset, Hz.
    pub frequencies_hz: Vec<f64>,
    /// What each is.
    pub kinds: Vec<OnsetKind>,
}

/// Finds the onset of the force model of `model` on `count` sections, over all cores; `section` makes the i-th of them from
/// that of the model. Continuous models go through [`crate::flutter::OnsetSweep`].
///
/// # Errors
/// [`Error::Input`] naming the number of the first section that cannot be, those of the searches.
pub fn many_onsets(
    model: &TrainedModel,
    count: usize,
    section: &(dyn Fn(usize, &mut SectionModel) + Sync),
    speed_max_m_s: f64,
    progress: &(dyn Fn(usize) + Sync),
) -> Result<ManyOnsets> {
    let finder = Finder::new(model, speed_max_m_s)?;
    let (values, _) = coefficients::of(&model.model);
    let done = std::sync::atomic::AtomicUsize::new(0);
    let parts: Vec<Result<Vec<SweepOutcome>>> = (0..count.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let range = chunk * CHUNK..count.min((chunk + 1) * CHUNK);
            let length = range.len();
            let mut one = model.section.clone();
            // who wants no more need not wait for what has not begun
            progress(done.load(std::sync::atomic::Ordering::Relaxed));
            let found = range
                .map(|i| {
                    section(i, &mut one);
                    let outcome = finder.onset(&one, &values).map(|(outcome, _)| outcome);
                    outcome.map_err(|e| of_section(i, e))
                })
                .collect();
            progress(length + done.fetch_add(length, std::sync::atomic::Ordering::Relaxed));
            found
        })
        .collect();
    let mut all = ManyOnsets::default();
    for outcome in crate::error::all_or_errors(parts)?.into_iter().flatten() {
        all.push(outcome);
    }
    Ok(all)
}

fn of_section(index: usize, error: Error) -> Error {
    match error {
        Error::Input(mut input) => {
            input.place = format!("section {index}: {}", input.place);
            Error::Input(input)
        }
        other => other,
    }
}

impl ManyOnsets {
    fn push(&mut self, outcome: SweepOutcome) {
        let (kind, at) = match &outcome {
            SweepOutcome::Onset(o) if o.in_tested_range => (OnsetKind::Tested, Some(o)),
            SweepOutcome::Onset(o) => (OnsetKind::Untested, Some(o)),
            SweepOutcome::UnstableAtOrBelow(o) => (OnsetKind::UnstableAtOrBelow, Some(o)),
            // the search in full, which follows an unresolved sweep, always answers
            SweepOutcome::Stable | SweepOutcome::Unresolved => (OnsetKind::Stable, None),
        };
        let value = |pick: fn(&SweptOnset) -> f64| at.map_or(f64::NAN, pick);
        self.speeds_m_s.push(value(|o| o.speed_m_s));
        self.frequencies_hz.push(value(|o| o.frequency_hz));
        self.kinds.push(kind);
    }
}
