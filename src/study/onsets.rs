//! Curves, onsets and divergence of all models of a study, side by side.

use super::{Deck, Study};
use crate::aerodynamics::{AerodynamicModel, Realization};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result};
use crate::flutter::{
    FlutterCurves, FlutterSearch, Onset, OnsetMethod, determinant_onset, divergence_speed,
    find_onset, trace_modes,
};
use crate::section::Structure;
use crate::trained_model::TrainedModel;
use crate::units::ReducedFrequency;
use serde::Serialize;

/// Results of all models of a study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FlutterStudy {
    /// Modes over wind speed, one entry a trained model.
    pub curves: Vec<FlutterCurves>,
    /// Onsets found.
    pub onsets: Vec<Onset>,
    /// Searches that found none.
    pub stable: Vec<OnsetSummary>,
    /// Static divergence of each trained model, m/s; `null` where there is none.
    pub divergence: Vec<Divergence>,
    /// Each model's onset against the deck's own (exact, or interpolated table).
    pub deviations: Vec<Deviation>,
}

/// A search without an onset.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OnsetSummary {
    /// Force model.
    pub model: String,
    /// Route.
    pub method: OnsetMethod,
    /// Highest wind speed searched, m/s.
    pub stable_up_to_m_s: f64,
}

/// Divergence of one model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Divergence {
    /// Force model.
    pub model: String,
    /// Divergence speed, m/s.
    pub speed_m_s: Option<f64>,
}

/// Difference of a model's onset from the deck's own.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Deviation {
    /// Force model.
    pub model: String,
    /// What it is compared with.
    pub reference: String,
    /// `V/V_ref − 1`, percent.
    pub percent: f64,
    /// For the discrete model: the part that comes from the fit of `G` (no feed-through), percent.
    pub from_fit_percent: Option<f64>,
    /// For the discrete model: the part that comes from holding the force over each step, percent.
    pub from_held_force_percent: Option<f64>,
}

/// Traces and searches every trained model, and the deck itself by the determinant.
///
/// # Errors
/// Those of tracking and search.
pub fn flutter_study(study: &Study, deck: &Deck, trained: &[TrainedModel]) -> Result<FlutterStudy> {
    let structure = study.section.structure()?;
    let mut results = FlutterStudy {
        curves: Vec::new(),
        onsets: Vec::new(),
        stable: Vec::new(),
        divergence: Vec::new(),
        deviations: Vec::new(),
    };
    let own = deck.own_onset(&structure, study.flutter.speed_max_m_s)?;
    for model in trained {
        let section = coupled(&structure, &model.model)?;
        results.curves.push(trace_modes(
            &model.name,
            &section,
            &study.flutter.curve_speeds_m_s(),
        )?);
        let search = find_onset(
            &model.name,
            &section,
            &study.flutter.search(),
            Some(model.tested_range),
        )?;
        if let (Some(reference), Some(onset)) = (own.onset(), search.onset()) {
            results
                .deviations
                .push(deviation(study, &structure, model, onset, reference)?);
        }
        results.take(search, &model.name, OnsetMethod::Eigenvalues);
        let still = model
            .model
            .transfer(ReducedFrequency::from_full_width(0.0))?;
        results.divergence.push(Divergence {
            model: model.name.clone(),
            speed_m_s: divergence_speed(&structure, &still)?,
        });
    }
    let name = deck.own_model_name();
    results.take(own, &name, OnsetMethod::Determinant);
    Ok(results)
}

impl FlutterStudy {
    fn take(&mut self, search: FlutterSearch, model: &str, method: OnsetMethod) {
        match search {
            FlutterSearch::Onset(onset) => self.onsets.push(*onset),
            FlutterSearch::StableUpTo(speed) => self.stable.push(OnsetSummary {
                model: model.to_owned(),
                method,
                stable_up_to_m_s: speed,
            }),
        }
    }
}

/// The section of a study with one of its models.
pub(super) fn coupled(
    structure: &Structure,
    model: &dyn AerodynamicModel,
) -> Result<CoupledSection> {
    let realization = model
        .realize()
        .ok_or_else(|| Error::Numerical("the model has no state-space realisation".into()))?;
    CoupledSection::new(structure.clone(), realization)
}

/// The sampled model's deviation is split by asking its transfer matrix without the hold: what is left comes from the
/// fit, the rest from the held force.
fn deviation(
    study: &Study,
    structure: &Structure,
    model: &TrainedModel,
    onset: &Onset,
    reference: &Onset,
) -> Result<Deviation> {
    let percent = |speed: f64| 100.0 * (speed / reference.speed_m_s - 1.0);
    let total = percent(onset.speed_m_s);
    let mut from_fit = None;
    if matches!(model.model.realize(), Some(Realization::Discrete(_))) {
        let unheld = determinant_onset(
            &model.name,
            structure,
            &model.model,
            model.tested_range,
            study.flutter.speed_max_m_s,
        )?;
        from_fit = unheld.onset().map(|o| percent(o.speed_m_s));
    }
    Ok(Deviation {
        model: model.name.clone(),
        reference: reference.model.clone(),
        percent: total,
        from_fit_percent: from_fit,
        from_held_force_percent: from_fit.map(|fit| total - fit),
    })
}

impl Deviation {
    /// The deviation in words.
    pub fn explain(&self) -> String {
        let side = if self.percent < 0.0 { "below" } else { "above" };
        let mut text = format!(
            "{}: {:.1} % {side} {}",
            self.model,
            self.percent.abs(),
            self.reference
        );
        if let (Some(fit), Some(held)) = (self.from_fit_percent, self.from_held_force_percent) {
            text.push_str(&format!(
                "; {fit:+.1} % come from the filters, which have no feed-through and fit the lift due to heave poorly \
                 at low K, {held:+.1} % from holding the force over each step Δt = Δs B/V"
            ));
        }
        text
    }
}
