//! Curves, onsets and divergence of all models of a study, side by side.

use super::routes::THEORY;
use super::{Deck, Study, attempt};
use crate::aerodynamics::{Realizable, Realization};
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::flutter::{
    AssumedAtRest, FlutterCurves, FlutterSearch, Onset, OnsetMethod, QuasiSteadyOnset, StableRange,
    UnstableStart, UnwantedGrowth, determinant_onset, divergence_speed, divergence_with_forces,
    find_onset, quasi_steady_onset, trace_modes, unwanted_growth,
};
use crate::section::Structure;
use crate::trained_model::TrainedModel;
use crate::verdict::{Divergence, StageFailure};
use serde::{Deserialize, Serialize};

/// Results of all models of a study.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct FlutterStudy {
    /// Modes over wind speed, one entry per trained model.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curves: Vec<FlutterCurves>,
    /// Onsets found, one entry per model and method.
    pub onsets: Vec<Onset>,
    /// Onsets that the data leave so far open that they are no results; see `Onset::headline_m_s`.
    pub undetermined: Vec<Onset>,
    /// Searches that found growth at the lowest speed that could be judged.
    pub unstable: Vec<UnstableStart>,
    /// Searches that found none.
    pub stable: Vec<OnsetSummary>,
    /// Growth of each trained model below its onset, by extrapolation alone.
    pub growth: Vec<UnwantedGrowth>,
    /// Static divergence of each trained model and of the deck itself, m/s; `null` where there is none.
    pub divergence: Vec<Divergence>,
    /// Each model's onset against the deck's own (exact, or interpolated table).
    pub deviations: Vec<Deviation>,
    /// Quasi-steady theory, where static coefficients are given.
    #[serde(skip_deserializing, skip_serializing_if = "Option::is_none")]
    pub(crate) quasi_steady: Option<QuasiSteadyOnset>,
    /// What could not be computed, and why.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub failed: Vec<StageFailure>,
}

/// A search without an onset.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OnsetSummary {
    /// Force model.
    pub model: String,
    /// Route.
    pub method: OnsetMethod,
    /// Lowest wind speed at which every mode could be judged, m/s; 0 from still air.
    pub stable_from_m_s: f64,
    /// Highest wind speed searched, m/s.
    pub stable_up_to_m_s: f64,
    /// Why nothing is known outside, where a speed that was asked for is.
    pub not_judged: Option<String>,
}

/// Difference of a model's onset from the deck's own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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

/// Traces and searches every trained model, and the deck itself by the determinant. What cannot be computed is noted and
/// leaves the rest as it is.
pub fn flutter_study(study: &Study, deck: &Deck, trained: &[TrainedModel]) -> Result<FlutterStudy> {
    let structure = study.section.structure()?;
    let mut results = FlutterStudy::default();
    let name = deck.own_model_name();
    let own = deck.own_onset(&structure, study.speeds().searched_to_m_s);
    let own = attempt(&mut results.failed, format!("onset of the {name}"), own)?;
    let reference = own.as_ref().and_then(FlutterSearch::onset);
    for model in trained {
        results.add(study, &structure, model, reference)?;
    }
    if let Some(block) = &study.coefficients {
        let theory = block.theory(&study.directory, &study.section.dofs())?;
        let found = quasi_steady_onset(THEORY, &structure, &theory, &study.speeds().search());
        results.quasi_steady = attempt(&mut results.failed, THEORY, found)?;
    }
    let still = deck.static_transfer().and_then(|(still, assumed)| {
        let speed_m_s = divergence_speed(&structure, &still)?;
        Ok(Divergence {
            lower_m_s: assumed.zip(speed_m_s).map(|(a, v)| a.lower_m_s(v)),
            assumed: assumed.map(AssumedAtRest::explain),
            ..Divergence::at(&name, speed_m_s)
        })
    });
    let stage = format!("divergence of the {name}");
    let still = attempt(&mut results.failed, stage, still)?;
    results.divergence.extend(still);
    if let Some(own) = own {
        results.take(own, &name, OnsetMethod::Determinant);
    }
    Ok(results)
}

impl OnsetSummary {
    /// The answer in words.
    pub(crate) fn explain(&self) -> String {
        self.range().explain()
    }

    /// The speeds without an onset.
    pub(super) fn range(&self) -> StableRange {
        StableRange {
            from_m_s: self.stable_from_m_s,
            to_m_s: self.stable_up_to_m_s,
            not_judged: self.not_judged.clone(),
        }
    }
}

impl FlutterStudy {
    /// Everything about one trained model.
    fn add(
        &mut self,
        study: &Study,
        structure: &Structure,
        model: &TrainedModel,
        reference: Option<&Onset>,
    ) -> Result<()> {
        let (name, speeds) = (&model.name, study.speeds());
        let tested = Some(model.tested_range);
        let failed = &mut self.failed;
        let section = CoupledSection::with_model(structure, &model.model);
        let Some(section) = attempt(failed, format!("coupling of {name}"), section)? else {
            return Ok(());
        };
        let curves = trace_modes(name, &section, &speeds.curve_speeds_m_s());
        let curves = attempt(failed, format!("modes over wind speed of {name}"), curves)?;
        self.curves
            .extend(curves.map(|c| c.marked(structure.width_m, tested)));
        let growth = unwanted_growth(&section, &speeds.search(), tested);
        let growth = attempt(failed, format!("scan for growth of {name}"), growth)?;
        self.growth.extend(growth.map(|growth| UnwantedGrowth {
            model: name.clone(),
            ..growth
        }));
        let steady = divergence_with_forces(structure, &model.model);
        if let Some(speed_m_s) = attempt(failed, format!("divergence of {name}"), steady)? {
            self.divergence.push(Divergence::at(name, speed_m_s));
        }
        let search = find_onset(name, &section, &speeds.search(), tested);
        let Some(search) = attempt(failed, format!("onset of {name}"), search)? else {
            return Ok(());
        };
        if let (Some(reference), Some(onset)) = (reference, search.onset()) {
            let deviation = deviation(study, structure, model, onset, reference);
            let deviation = attempt(failed, format!("deviation of {name}"), deviation)?;
            self.deviations.extend(deviation);
        }
        self.take(search, name, OnsetMethod::Eigenvalues);
        Ok(())
    }

    /// Takes onsets that the data do not determine from the others, with what was said about them.
    pub(super) fn separate_undetermined(&mut self) {
        let all = std::mem::take(&mut self.onsets);
        let (onsets, undetermined): (Vec<_>, Vec<_>) =
            all.into_iter().partition(|o| o.headline_m_s().is_ok());
        self.deviations
            .retain(|d| !undetermined.iter().any(|o| o.at.model == d.model));
        self.onsets = onsets;
        self.undetermined.extend(undetermined);
    }

    /// Puts the answer of a search beside the others.
    pub(crate) fn take(&mut self, search: FlutterSearch, model: &str, method: OnsetMethod) {
        match search {
            FlutterSearch::Onset(onset) => self.onsets.push(*onset),
            FlutterSearch::UnstableAtOrBelow(start) => self.unstable.push(*start),
            FlutterSearch::StableUpTo(range) => self.stable.push(OnsetSummary {
                model: model.to_owned(),
                method,
                stable_from_m_s: range.from_m_s,
                stable_up_to_m_s: range.to_m_s,
                not_judged: range.not_judged,
            }),
        }
    }
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
    let percent = |speed: f64| 100.0 * (speed / reference.at.speed_m_s - 1.0);
    let total = percent(onset.at.speed_m_s);
    let mut from_fit = None;
    if matches!(model.model.realize(), Realization::Discrete(_)) {
        let (name, tested) = (&model.name, model.tested_range);
        let highest_m_s = study.speeds().searched_to_m_s;
        let unheld = determinant_onset(name, structure, &model.model, tested, highest_m_s)?;
        from_fit = unheld.onset().map(|o| percent(o.at.speed_m_s));
    }
    Ok(Deviation {
        model: model.name.clone(),
        reference: reference.at.model.clone(),
        percent: total,
        from_fit_percent: from_fit,
        from_held_force_percent: from_fit.map(|fit| total - fit),
    })
}

impl Deviation {
    /// The deviation in words.
    pub(crate) fn explain(&self) -> String {
        let side = if self.percent < 0.0 { "below" } else { "above" };
        let (percent, reference) = (self.percent.abs(), &self.reference);
        let mut text = format!("{}: {percent:.1} % {side} {reference}", self.model);
        if let (Some(fit), Some(held)) = (self.from_fit_percent, self.from_held_force_percent) {
            text.push_str(&format!(
                "; {fit:+.1} % come from the filters, which have no feed-through and fit the lift due to heave poorly \
                 at low K, {held:+.1} % from holding the force over each step Δt = Δs B/V"
            ));
        }
        text
    }
}
