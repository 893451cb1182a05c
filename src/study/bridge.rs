//! A bridge file resolved: sections with their forces, groups of strips, and what is to be known before a search.

mod answers;
mod buffeting;
mod envelope;
mod evidence;
mod export;
mod forces;
mod interval;
mod motion;
mod parts;
mod scatter;
mod similarity;

pub(crate) use answers::NAMED_SHARE;
pub use answers::{BridgeAnswer, BridgeFlutter, LeftOut, TableDivergence, bridge_flutter};
pub use buffeting::{BridgeBuffeting, BuffetingBlock, ModelsBesideTables};
pub use envelope::{SectionForceResponse, SpanEnvelope};
pub use export::BridgeExportOptions;
pub use forces::SectionForceModels;
pub(crate) use forces::block_table;
pub use motion::{BridgeMotion, ModeShare, NodeMotion, motion_at_onset, static_deflection};
pub use parts::SectionForcePart;
pub use scatter::{DerivativeScatter, Scatter};
pub use similarity::{Similarity, equivalent_section, similarities};

use super::KnownUncertainty;
use super::speeds::{SEARCHED_AT_LEAST, reaching};
use crate::aerodynamics::Transfer;
use crate::aerodynamics::quasi_steady::LinearQuasiSteady;
use crate::bridge::{Bridge, BridgeMode, StripGroup};
use crate::error::{Result, counted};
use crate::files::bridge::{BridgeFile, BridgeModes, BridgeSectionBlock};
use crate::flutter::OnsetSearch;
use crate::plausibility::{
    Finding, of_bridge, of_coefficients, of_modes_left_out, of_profile, of_required_speed,
    sentences,
};
use crate::section::Dof;
use crate::trained_model::TrainedModel;
use crate::units::ReducedFrequencyRange;
use crate::verdict::RequiredSpeed;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Text of the bridge file of the demo.
pub(crate) fn demo_bridge_text() -> &'static str {
    include_str!("bridge/demo.toml")
}

/// Text of a new bridge file, with a comment at every key that is left out most often.
pub(crate) fn new_bridge_text() -> &'static str {
    include_str!("bridge/new_bridge.toml")
}

/// Winds of one section at most; with more, the profile is taken in steps.
const WINDS_AT_MOST: usize = 8;
/// Those steps, as a part of the wind speed of the bridge, and how many there are at most.
const WIND_STEP: f64 = 0.02;
const STEPS_AT_MOST: f64 = 20.0;

/// A bridge ready to be computed.
#[derive(Debug, Clone)]
pub struct BridgeStudy {
    /// What the file states.
    pub file: BridgeFile,
    /// With forces that have a realisation: trained, fitted to a table, or quasi-steady.
    pub by_model: Bridge,
    /// With tables where there are some; `None` without any.
    pub by_table: Option<Bridge>,
    /// Forces of each section, in the order of the file.
    pub sections: Vec<SectionForceModels>,
    /// Section of each group.
    section_of_group: Vec<usize>,
    /// Modes of the file that are not taken.
    left_out: Vec<BridgeMode>,
    /// What a reader should know: simplifications, what was assumed.
    pub notes: Vec<String>,
    /// What is odd about modes, sections and tables.
    pub findings: Vec<Finding>,
}

impl BridgeStudy {
    /// Reads modes and sections and fits models to tables.
    ///
    /// # Errors
    /// [`crate::Error::Io`] and [`crate::Error::Input`] with file and place; [`crate::Error::Numerical`] when a fit has no answer.
    pub fn new(file: BridgeFile) -> Result<Self> {
        Self::with_trained(file, |_| None)
    }

    /// The same, with models at hand for some sections.
    pub(crate) fn with_trained(
        file: BridgeFile,
        trained: impl Fn(&BridgeSectionBlock) -> Option<(TrainedModel, KnownUncertainty)>,
    ) -> Result<Self> {
        let modes = file.read_modes()?;
        let mut notes = Vec::new();
        let mut findings = modes.findings();
        let section = |block: &BridgeSectionBlock| {
            SectionForceModels::new(block, trained(block), &file.directory, &mut findings)
        };
        let sections: Vec<SectionForceModels> =
            file.sections.iter().map(section).collect::<Result<_>>()?;
        notes.extend(sections.iter().flat_map(|s| s.notes.iter().cloned()));
        let groups = groups(&file, &modes, &sections, &mut notes).map_err(|e| file.located(e))?;
        let (section_of_group, groups): (Vec<usize>, Vec<StripGroup>) = groups.into_iter().unzip();
        let dampers = file.dampers(&modes).map_err(|e| file.located(e))?;
        if !dampers.is_empty() {
            notes.push(format!(
                "the structure has {} and {}",
                counted(dampers.masses.len(), "tuned mass damper"),
                counted(dampers.links.len(), "viscous link")
            ));
        }
        let (name, density) = (file.name.clone(), file.air_density_kg_m3);
        let (nodes, shapes) = (modes.nodes.clone(), modes.modes.clone());
        let by_model = Bridge::new(name, density, nodes, shapes, groups)?.with_dampers(dampers)?;
        findings.extend(of_bridge(&by_model));
        findings.extend(of_modes_left_out(&by_model, &modes.left_out));
        let required = file.flutter.required_speed_m_s;
        findings.extend(of_required_speed(required, by_model.width_m()));
        let profile: Vec<f64> = file.wind.profile.iter().map(|p| p.along_m).collect();
        findings.extend(of_profile(&profile, &modes.nodes));
        for block in &file.sections {
            let place = format!("section {}: static.", block.name);
            let statics = block.statics.iter();
            findings
                .extend(statics.flat_map(|s| of_coefficients(&place, &s.coefficients(), &s.arms)));
        }
        let mut study = Self {
            by_model,
            by_table: None,
            section_of_group,
            left_out: modes.left_out,
            sections,
            notes,
            findings,
            file,
        };
        if study.sections.iter().any(|s| s.table.is_some()) {
            let groups = study.by_model.groups.iter().zip(&study.section_of_group);
            let by_table = groups
                .map(|(group, section)| group.with_forces(study.sections[*section].forces(true)));
            study.by_table = Some(study.with_groups(by_table.collect())?);
        }
        Ok(study)
    }

    /// Notes and findings in words.
    pub fn warnings(&self) -> Vec<String> {
        [self.notes.clone(), sentences(&self.findings)].concat()
    }

    /// What is required.
    fn required(&self) -> Option<RequiredSpeed> {
        let speed = self.file.flutter.required_speed_m_s;
        speed.map(|speed_m_s| RequiredSpeed { speed_m_s })
    }

    /// Where an onset is searched.
    pub fn search(&self) -> OnsetSearch {
        OnsetSearch::new(
            reaching(self.file.flutter.speed_max_m_s, self.required()),
            self.file.flutter.speeds.max(SEARCHED_AT_LEAST),
        )
    }

    /// Reduced frequencies, of the bridge, in which the forces of every section were tested.
    pub fn tested_range(&self) -> Option<ReducedFrequencyRange> {
        let of = |group: &StripGroup| {
            let sections = self.file.sections.iter().zip(&self.sections);
            sections
                .filter(|(block, _)| block.name == group.name)
                .find_map(|(_, s)| s.tested)
        };
        self.by_model.forces().common_range(of)
    }

    /// Reduced frequencies in which each section was tested, its own; those that no test stands behind are left out.
    pub(crate) fn section_ranges(&self) -> impl Iterator<Item = ReducedFrequencyRange> {
        self.sections.iter().filter_map(|s| s.tested)
    }

    /// Angle of the tests at each node, deg; 0 where nothing is stated, or the forces are no tests.
    pub(crate) fn tested_angles_deg(&self) -> Vec<f64> {
        let mut angles = vec![0.0; self.by_model.nodes.len()];
        let groups = self.by_model.groups.iter().zip(&self.section_of_group);
        for (group, section) in groups {
            let angle = self.sections[*section].angle_deg.unwrap_or(0.0);
            group.nodes.iter().for_each(|n| angles[*n] = angle);
        }
        angles
    }

    /// Static coefficients `(C_L, C_D, C_M)` of each group, `None` where a section does not state them.
    pub(crate) fn static_coefficients(&self) -> Option<Vec<[f64; 3]>> {
        let of = |section: &usize| {
            let statics = self.file.sections[*section].statics?;
            Some([statics.lift, statics.drag, statics.moment])
        };
        self.section_of_group.iter().map(of).collect()
    }

    /// The bridge in the quasi-steady forces of heave and sway; `None` where no section with derivatives or a model states static
    /// coefficients too.
    ///
    /// # Errors
    /// As [`Bridge::new`].
    pub(crate) fn by_coefficients(&self) -> Result<Option<Bridge>> {
        let mut groups = Vec::new();
        for (group, section) in self.by_model.groups.iter().zip(&self.section_of_group) {
            let block = &self.file.sections[*section];
            let of_motion = self.sections[*section].tested.is_some()
                || block.derivatives.is_some()
                || block.model.is_some();
            let mut motions = block.motions.clone();
            motions.retain(|d| *d != Dof::Torsion);
            let Some(statics) = &block.statics else {
                continue;
            };
            if !of_motion || motions.is_empty() {
                continue;
            }
            let theory =
                LinearQuasiSteady::new(&motions, statics.arms, 0.0, statics.coefficients());
            let forces: Arc<dyn Transfer> = Arc::new(theory);
            groups.push(group.with_forces(forces));
        }
        if groups.is_empty() {
            return Ok(None);
        }
        self.with_groups(groups).map(Some)
    }

    /// Similarities of vertical and torsional modes.
    pub fn similarities(&self) -> Vec<Similarity> {
        similarities(&self.by_model)
    }
}

/// Strips of every section in the forces of its model, a group in each wind, with the place of the section.
fn groups(
    file: &BridgeFile,
    modes: &BridgeModes,
    forces: &[SectionForceModels],
    notes: &mut Vec<String>,
) -> Result<Vec<(usize, StripGroup)>> {
    let mut groups = Vec::new();
    for (section, block) in file.sections.iter().enumerate() {
        let (first, last) = ends(block, modes, section)?;
        let winds = modes.nodes[first..=last].iter();
        let winds = winds.map(|n| file.wind.factor(n.along_m));
        let (step, by_wind) = by_wind(&winds.collect::<Vec<_>>(), first);
        if let Some(step) = step {
            notes.push(format!(
                "section {}: the wind profile is taken in steps of {step:.3} of the wind speed, which move an onset by less than 0.05 %",
                block.name
            ));
        }
        let group = |(wind_factor, nodes)| StripGroup {
            name: block.name.clone(),
            width_m: block.width_m,
            wind_factor,
            nodes,
            forces: forces[section].forces(false),
        };
        groups.extend(by_wind.into_iter().map(|of| (section, group(of))));
    }
    Ok(groups)
}

/// Nodes from `first` on by their wind, and the step in which many winds are taken. The wind of a step is that of its mean pressure;
/// the lowest and the highest stay as they are, since the reduced frequencies that were tested rest on them.
fn by_wind(winds: &[f64], first: usize) -> (Option<f64>, Vec<(f64, Vec<usize>)>) {
    let mut sorted = winds.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.dedup();
    let (lowest, highest) = (sorted[0], sorted[sorted.len() - 1]);
    let step =
        (sorted.len() > WINDS_AT_MOST).then(|| WIND_STEP.max((highest - lowest) / STEPS_AT_MOST));
    // numbers above zero stand in the order of their bits
    let mut groups: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for (place, wind) in winds.iter().enumerate() {
        let middle = match step {
            Some(step) if lowest < *wind && *wind < highest => {
                lowest + step * (0.5 + ((wind - lowest) / step).floor())
            }
            _ => *wind,
        };
        groups.entry(middle.to_bits()).or_default().push(place);
    }
    let groups = groups.into_values().map(|places| {
        let pressures = places.iter().map(|p| winds[*p].powi(2)).sum::<f64>();
        let mean = (pressures / places.len() as f64).sqrt();
        let same = places.iter().all(|p| winds[*p] == winds[places[0]]);
        let wind = if same { winds[places[0]] } else { mean };
        (wind, places.into_iter().map(|p| first + p).collect())
    });
    (step, groups.collect())
}

/// Places of the first and the last node of a section.
fn ends(block: &BridgeSectionBlock, modes: &BridgeModes, section: usize) -> Result<(usize, usize)> {
    let last = modes.nodes.len().saturating_sub(1);
    let place = |key: &str, name: &Option<String>, otherwise: usize| match name {
        None => Ok(otherwise),
        Some(name) => modes.index_of(format!("section[{section}].{key}"), name),
    };
    let from = place("from", &block.from, 0)?;
    let to = place("to", &block.to, last)?;
    // whichever way the wind numbers them
    Ok((from.min(to), from.max(to)))
}
