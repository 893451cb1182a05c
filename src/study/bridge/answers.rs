//! Flutter and divergence of a bridge, with the modes behind them.

use super::BridgeStudy;
use super::motion::{BridgeMotion, ModeShare, motion_at_onset, static_deflection};
use crate::aerodynamics::{RationalModel, Transfer, TransferMatrix};
use crate::aeroelastic::CoupledSection;
use crate::bridge::Bridge;
use crate::error::Result;
use crate::flutter::{
    AssumedAtRest, FlutterCurves, FlutterSearch, MovedOnset, Onset, OnsetInterval, OnsetSearch,
    UnwantedGrowth, divergence_speed, divergence_with_forces, find_onset, find_onset_of_modes,
    pk_onset, static_part, trace_modes, unwanted_growth_below,
};
use crate::units::ReducedFrequency;
use crate::verdict::{MeanRotation, ModesLeftOut, UntestedParts};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Modes below this share of the energy are left out together, in turn for each number.
const SHARES: [f64; 4] = [0.1, 0.01, 1e-3, 1e-4];

/// Modes with less of the kinetic energy at the onset take no part.
pub(crate) const NAMED_SHARE: f64 = 1e-3;
/// Modes that are drawn in colour.
const SHOWN: usize = 6;

/// One route to the onset.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct BridgeAnswer {
    /// The forces.
    pub forces: String,
    /// What the search found.
    pub search: FlutterSearch,
    /// The motion at the onset.
    pub motion: Option<BridgeMotion>,
}

/// The onset with fewer modes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LeftOut {
    /// Numbers of the modes that are left.
    pub modes: Vec<usize>,
    /// Share of the energy at the onset below which modes were left out.
    pub below_share: f64,
    /// Onset with those alone, m/s; `None` when they do not flutter.
    pub onset_m_s: Option<f64>,
}

/// Divergence by tables, which say nothing of steady flow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TableDivergence {
    /// Speed, m/s; `None` where there is none.
    pub speed_m_s: Option<f64>,
    /// What is left of it when the deck behaves as a plate below the tested reduced frequencies, m/s.
    pub lower_m_s: Option<f64>,
    /// What was assumed.
    pub assumed: String,
}

/// Everything about the flutter of a bridge.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct BridgeFlutter {
    /// By table (p-k) where there is one, then by model (eigenvalues).
    pub answers: Vec<BridgeAnswer>,
    /// Frequencies and damping over the wind speed, by model.
    pub curves: FlutterCurves,
    /// Onset with fewer modes, by model.
    pub left_out: Vec<LeftOut>,
    /// Speed of divergence by model, m/s.
    pub divergence_m_s: Option<f64>,
    /// The same by the static slopes that tables have at their lowest tested reduced frequency; `None` without tables.
    pub table_divergence: Option<TableDivergence>,
    /// Where heave and sway alone gallop by quasi-steady theory, m/s, looked at where sections with derivatives or a model state
    /// static coefficients too; `None` where they do not up to the highest speed.
    pub galloping_m_s: Option<f64>,
    /// Growth of the bridge by its models below their onset, where nothing was tested; `None` where the scan failed.
    pub growth: Option<UnwantedGrowth>,
    /// Mean rotation where it is farthest from the tests, at the onset or else at the required speed, where static coefficients are
    /// stated.
    pub mean_rotation: Option<MeanRotation>,
    /// What constraints on the fits of sections did to the onset; `None` where none hold one, or models were read from files.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub constraints: Option<MovedOnset>,
    /// Parts that no test stands behind, where there are some beside others that were tested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub untested: Option<UntestedParts>,
    /// What modes of the file that are left out do to the onset.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub modes_left_out: Option<ModesLeftOut>,
    /// What could not be computed, and why.
    pub failed: Vec<String>,
}

impl BridgeFlutter {
    /// The onset by the models.
    pub fn onset(&self) -> Option<&Onset> {
        self.answers.last()?.search.onset()
    }

    /// Its interval, as an FMU states it.
    pub fn interval(&self) -> Option<OnsetInterval> {
        Some(self.onset()?.interval.clone())
    }

    /// The modes in the motion by the models, by their share of the energy; none where there is no motion.
    pub(crate) fn shares(&self) -> &[ModeShare] {
        let motion = self.answers.last().and_then(|a| a.motion.as_ref());
        motion.map_or(&[], |m| &m.modes)
    }

    /// The branches of the modes with the largest shares of the energy, the one that flutters among them.
    pub(crate) fn shown_modes(&self, fluttering: Option<&str>) -> Vec<String> {
        let named = |m: &ModeShare| format!("mode {}", m.mode);
        let mut shown: Vec<String> = self.shares().iter().take(SHOWN).map(named).collect();
        if let (Some(last), Some(branch)) = (shown.last().cloned(), fluttering)
            && !shown.iter().any(|s| s == branch)
        {
            shown.retain(|s| *s != last);
            shown.push(branch.to_owned());
        }
        shown
    }

    /// All onsets found, one a route at most.
    pub fn onsets(&self) -> impl Iterator<Item = &Onset> {
        self.answers.iter().filter_map(|a| a.search.onset())
    }
}

/// The rotation in the mean wind; `None` where sections state no static coefficients.
fn mean_rotation(
    study: &BridgeStudy,
    at_rest: &TransferMatrix,
    speed_m_s: f64,
) -> Result<Option<MeanRotation>> {
    let Some(coefficients) = study.static_coefficients() else {
        return Ok(None);
    };
    let mean = static_deflection(&study.by_model, &coefficients, at_rest, speed_m_s)?;
    let nodes = mean.iter().zip(study.tested_angles_deg());
    let rotations = nodes.map(|(deflection, tested_deg)| MeanRotation {
        speed_m_s,
        rotation_deg: deflection[2].to_degrees(),
        tested_deg: Some(tested_deg),
    });
    let away = |r: &MeanRotation| (r.rotation_deg - r.tested_deg.unwrap_or(0.0)).abs();
    Ok(rotations.max_by(|a, b| away(a).total_cmp(&away(b))))
}

/// What was found, or nothing; why nothing was stands among what failed.
fn noted<T: Default>(failed: &mut Vec<String>, what: &str, found: Result<T>) -> T {
    found.unwrap_or_else(|e| {
        failed.push(format!("{what}: {e}"));
        T::default()
    })
}

/// Searches the onset by every route and says what takes part.
///
/// # Errors
/// [`crate::Error::Input`] for forces that cannot be coupled, [`crate::Error::Numerical`] when eigenvalues cannot be
/// computed; what fails beside that is stated in the result.
pub fn bridge_flutter(study: &BridgeStudy) -> Result<BridgeFlutter> {
    let mut failed = Vec::new();
    let mut answers = Vec::new();
    let search = study.search();
    let tested = study.tested_range();
    let (of_tables, by_model) = rayon::join(
        || study.by_table.as_ref().map(|b| by_table(b, &search)),
        || by_model(study),
    );
    let of_tables = of_tables.transpose();
    answers.extend(noted(&mut failed, "p-k iteration of the tables", of_tables));
    let mut by_model = by_model?;
    if let FlutterSearch::Onset(onset) = &mut by_model.search {
        let interval = study.onset_interval(onset).map(Some);
        let interval = noted(&mut failed, "interval of the onset", interval);
        onset.interval = interval.unwrap_or(onset.interval.clone());
        let found = study.contradictions(onset);
        let found = noted(&mut failed, "onsets of single mean speeds", found);
        onset.warnings.extend(found);
    }
    let constraints = study.moved_onset(&by_model.search);
    let constraints = noted(&mut failed, "constraints", constraints);
    let untested = study.untested(&by_model.search);
    let untested = noted(&mut failed, "parts without a test", untested);
    let with_all = study.with_all_modes(&by_model.search);
    let modes_left_out = noted(&mut failed, "modes left out", with_all);
    let section = coupled(&study.by_model)?;
    let speeds = search_speeds(&search);
    let curves = trace_modes("model", &section, &speeds)?;
    let mut curves = curves.marked(study.by_model.width_m(), tested);
    // modal shapes of all modes at all speeds are megabytes that nobody reads
    let points = curves.branches.iter_mut().flat_map(|b| &mut b.points);
    points.for_each(|p| p.shape = Vec::new());
    let left_out = fewer_modes(study, &by_model);
    let left_out = noted(&mut failed, "fewer modes", left_out);
    let forces = study.by_model.forces();
    let at_rest = forces.transfer(ReducedFrequency::from_full_width(0.0))?;
    let divergence_m_s = divergence_speed(&study.by_model.structure(), &at_rest)?;
    let of_tables = table_divergence(study);
    let table_divergence = noted(&mut failed, "divergence of the tables", of_tables);
    let growth = unwanted_growth_below(Some(&by_model.search), &section, &search, tested);
    let growth = noted(&mut failed, "scan for growth", growth.map(Some));
    let galloping_m_s = galloping(study, &search);
    let galloping_m_s = noted(
        &mut failed,
        "galloping by static coefficients",
        galloping_m_s,
    );
    // where the answer is: by the tables first, which are the headline
    let of = |a: &BridgeAnswer| a.search.critical_speed_m_s();
    let critical = answers.iter().find_map(of).or(of(&by_model));
    let required = study.file.flutter.required_speed_m_s;
    let mean_rotation = critical.or(required).and_then(|speed| {
        let mean = mean_rotation(study, &at_rest, speed);
        mean.map_err(|e| failed.push(e.to_string())).ok()?
    });
    answers.push(by_model);
    Ok(BridgeFlutter {
        answers,
        curves,
        left_out,
        divergence_m_s,
        table_divergence,
        galloping_m_s,
        growth,
        mean_rotation,
        constraints,
        untested,
        modes_left_out,
        failed,
    })
}

/// Divergence by the slopes of the tables at rest, of other sections by their models.
fn table_divergence(study: &BridgeStudy) -> Result<Option<TableDivergence>> {
    let Some(bridge) = &study.by_table else {
        return Ok(None);
    };
    let mut still = bridge.clone();
    let mut lowest: Option<ReducedFrequency> = None;
    for group in &mut still.groups {
        let Some(range) = group.forces.known_range() else {
            continue;
        };
        let at_rest = static_part(group.forces.dofs(), &group.forces.transfer(range.min)?);
        let (e0, zero) = (at_rest.map(|z| z.re), at_rest.map(|_| 0.0));
        group.forces = Arc::new(RationalModel::without_lags(group.forces.dofs(), e0, zero));
        lowest = Some(lowest.map_or(range.min, |k| if k > range.min { k } else { range.min }));
    }
    let Some(k) = lowest else { return Ok(None) };
    let assumed = AssumedAtRest::below(k)?;
    let speed_m_s = divergence_with_forces(&still.structure(), &still.forces())?;
    Ok(Some(TableDivergence {
        speed_m_s,
        lower_m_s: speed_m_s.map(|v| assumed.lower_m_s(v)),
        assumed: assumed.explain(),
    }))
}

/// Onset of heave and sway alone in quasi-steady forces, as a theory of coupled motions is no answer beside derivatives. Sections
/// without static coefficients are left in still air: nothing is known of their part.
fn galloping(study: &BridgeStudy, search: &OnsetSearch) -> Result<Option<f64>> {
    let Some(bridge) = study.by_coefficients()? else {
        return Ok(None);
    };
    let found = find_onset("static coefficients", &coupled(&bridge)?, search, None)?;
    Ok(found.critical_speed_m_s())
}

fn search_speeds(search: &OnsetSearch) -> Vec<f64> {
    let step = search.speed_max_m_s / search.speeds as f64;
    (1..=search.speeds).map(|i| step * i as f64).collect()
}

/// The coupled bridge with forces that have a realisation.
pub(super) fn coupled(bridge: &Bridge) -> Result<CoupledSection> {
    CoupledSection::new(bridge.structure(), bridge.forces().realize()?)
}

fn by_table(bridge: &Bridge, search: &OnsetSearch) -> Result<BridgeAnswer> {
    let forces = bridge.forces();
    let range = forces.known_range();
    let found = pk_onset("table", &bridge.structure(), &forces, search, range)?;
    let name = match range {
        Some(_) => "tables between their points",
        None => "flat plate (Theodorsen)",
    };
    answer(name, bridge, &forces, found)
}

fn by_model(study: &BridgeStudy) -> Result<BridgeAnswer> {
    let (bridge, tested) = (&study.by_model, study.tested_range());
    let found = find_onset("model", &coupled(bridge)?, &study.search(), tested)?;
    answer("model", bridge, &bridge.forces(), found)
}

fn answer(
    name: &str,
    bridge: &Bridge,
    forces: &dyn Transfer,
    mut search: FlutterSearch,
) -> Result<BridgeAnswer> {
    let critical = search.critical();
    let motion = critical.map(|at| motion_at_onset(bridge, forces, at));
    let motion = motion.transpose()?;
    if let (FlutterSearch::Onset(onset), Some(motion)) = (&mut search, &motion) {
        // of the node that turns most, as a section there would see it
        onset.mode = motion.mode_ratio(bridge.width_m());
    }
    Ok(BridgeAnswer {
        forces: name.to_owned(),
        motion,
        search,
    })
}

/// The onset with the modes of at least each share of the energy.
fn fewer_modes(study: &BridgeStudy, full: &BridgeAnswer) -> Result<Vec<LeftOut>> {
    let (bridge, mut all) = (&study.by_model, Vec::<LeftOut>::new());
    let shares = full.motion.as_ref().map_or(&[][..], |m| &m.modes);
    for below_share in SHARES.into_iter().filter(|_| !shares.is_empty()) {
        let kept = shares.iter().filter(|m| m.energy_share >= below_share);
        let mut modes: Vec<usize> = kept.map(|m| m.mode).collect();
        modes.sort_unstable();
        let all_or_none = [0, bridge.modes.len()].contains(&modes.len());
        if all_or_none || all.last().is_some_and(|l| l.modes == modes) {
            continue;
        }
        let mut part = bridge.clone();
        part.modes.retain(|m| modes.contains(&m.number));
        // the whole bridge was searched: the modes that are left are followed alone
        let (part, tested) = (coupled(&part)?, study.tested_range());
        let onset_m_s = find_onset_of_modes("fewer modes", &part, &study.search(), tested)?;
        all.push(LeftOut {
            modes,
            below_share,
            onset_m_s,
        });
    }
    Ok(all)
}
