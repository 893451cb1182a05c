//! A bridge study as what goes into an FMU.

use super::BridgeStudy;
use super::answers::coupled;
use super::motion::{BridgeMotion, motion_at_onset};
use super::similarity::equivalent_section;
use crate::aerodynamics::{RationalAdmittance, Transfer as _};
use crate::aeroelastic::CoupledSection;
use crate::buffeting::Admittance;
use crate::error::{Error, Result, ensure};
use crate::files::bridge::FieldTable;
use crate::flutter::{FlutterSearch, OnsetInterval, divergence_with_forces, unwanted_growth_below};
use crate::fmu::bridge_gusts::{BridgeGusts, TurbulenceOptions};
use crate::fmu::bridge_options::BridgeOptions;
use crate::fmu::onset_bounds::OnsetBounds;
use crate::fmu::onset_start::{OnsetStart, simulated_onset};
use crate::fmu::package::Export;
use crate::trained_model::{Experiment, Provenance, TrainedModel};
use crate::units::{ReducedFrequency, ReducedFrequencyRange};

/// Amplitude of the default release where the girder moves most, of half the width.
const RELEASE: f64 = 0.01;
/// Wind speed of the default experiment as a part of the onset.
const PART_OF_ONSET: f64 = 0.98;
/// Periods of the slowest mode in the default experiment, steps in a period of the fastest.
const PERIODS: f64 = 10.0;
const STEPS_PER_PERIOD: f64 = 50.0;
/// Where gust forces come from, before the names of sections.
pub(super) const STATIC_COEFFICIENTS: &str = "quasi-steady theory with the static coefficients of";

/// What is wanted of an FMU.
#[derive(Debug, Clone, Default)]
pub struct BridgeExportOptions {
    /// Names of the nodes with inputs and outputs; none for mid-span and both quarter points.
    pub nodes: Vec<String>,
    /// Whether a bridge that grows below its onset is exported.
    pub allow_unstable: bool,
    /// Strips with gusts of their own, neighbouring nodes together; `None` for no gusts as inputs.
    pub gust_strips: Option<usize>,
    /// On the gusts.
    pub admittance: RationalAdmittance,
    /// Turbulence that goes with it.
    pub turbulence: Option<FieldTable>,
    /// The interval of the onset by the models where a search has found it; it is found again without.
    pub onset_interval: Option<OnsetInterval>,
}

impl BridgeStudy {
    /// What goes into an FMU: the force model of the first section, with the section that the first modes make, and the bridge.
    ///
    /// # Errors
    /// [`Error::Input`] for nodes and strips that are none, and for gusts on sections without static coefficients;
    /// [`Error::Unstable`] for a bridge that grows below its onset, unless that is allowed.
    pub fn export(&self, wanted: &BridgeExportOptions) -> Result<(TrainedModel, Export)> {
        let named = self.named(&wanted.nodes)?;
        let gusts = self.gusts(wanted)?;
        let search = self.search();
        // as the unit itself judges
        let section = coupled(&self.by_model)?;
        let tested = self.tested_range();
        let found = simulated_onset("bridge", &section, &search, tested)?;
        if !wanted.allow_unstable {
            // tested there or not, or only where nothing was tested
            let why = match found {
                FlutterSearch::UnstableAtOrBelow(_) => Some(format!("is {}", found.explain())),
                _ => {
                    let growth = unwanted_growth_below(Some(&found), &section, &search, tested)?;
                    (!growth.is_none()).then(|| growth.explain())
                }
            };
            if let Some(why) = why {
                let why = format!("the bridge is not exported: it {why}");
                return Err(Error::Unstable(why));
            }
        }
        let bridge = &self.by_model;
        let divergence = divergence_with_forces(&bridge.structure(), &bridge.forces())?;
        let first = found.first_limit_m_s(divergence, search.speed_max_m_s);
        let field = wanted.turbulence.as_ref().map(|field| self.at_nodes(field));
        let turbulence = field.transpose()?.map(|field| {
            let [u, w] = field.gusts;
            let step_s = field.step_s;
            TurbulenceOptions { step_s, u, w }
        });
        let export = Export {
            bridge: Some(self.options(&found, &section, named, gusts, wanted)?),
            turbulence,
            // it was judged here
            allow_unstable: true,
            ..Export::default()
        };
        Ok((self.first_model(first)?, export))
    }

    /// The model of the first section, under the name of the bridge.
    fn first_model(&self, first_m_s: f64) -> Result<TrainedModel> {
        let section = &self.sections[0];
        let model = section.saved.clone();
        let k = ReducedFrequency::from_full_width;
        let everywhere = || ReducedFrequencyRange::between(k(f64::MIN_POSITIVE), k(f64::MAX));
        Ok(TrainedModel {
            schema_version: model.schema_version(),
            name: self.file.name.clone(),
            section: equivalent_section(&self.by_model, model.dofs())?,
            tested_range: section.tested.unwrap_or_else(everywhere),
            provenance: Provenance {
                source: section.source.clone(),
                licence: section.licence.clone(),
                method: "see the files of the sections".to_owned(),
                aerodeck_version: env!("CARGO_PKG_VERSION").to_owned(),
                notes: self.warnings(),
            },
            experiment: self.experiment(first_m_s),
            model,
        })
    }

    /// What the unit holds of the bridge itself, with the forces of every section.
    fn options(
        &self,
        found: &FlutterSearch,
        section: &CoupledSection,
        named: Vec<usize>,
        gusts: Option<BridgeGusts>,
        wanted: &BridgeExportOptions,
    ) -> Result<BridgeOptions> {
        let onset = found.onset();
        // an archive without an interval is better than none
        let interval = onset.and_then(|onset| match &wanted.onset_interval {
            Some(known) => OnsetBounds::from_interval(known),
            None => OnsetBounds::from_interval(&self.onset_interval(onset).ok()?),
        });
        let bridge = &self.by_model;
        let critical = found.critical();
        let motion = critical.map(|at| motion_at_onset(bridge, &bridge.forces(), at));
        let groups = bridge.groups.iter().zip(&self.section_of_group);
        let groups = groups.map(|(group, section)| group.with_forces(*section));
        Ok(BridgeOptions {
            name: self.file.name.clone(),
            air_density_kg_m3: bridge.air_density_kg_m3,
            nodes: bridge.nodes.clone(),
            modes: bridge.modes.clone(),
            dampers: bridge.dampers.clone(),
            structure_alone: false,
            groups: groups.collect(),
            forces: self.sections.iter().map(|s| s.saved.clone()).collect(),
            named,
            tested_range: self.tested_range(),
            section_ranges: self.section_ranges().collect(),
            initial: self.release(motion.transpose()?.as_ref()),
            gusts,
            onset_interval: interval,
            onset: onset.and_then(|o| OnsetStart::from_onset(o, section)),
        })
    }

    /// Gust forces of the sections on strips of neighbouring nodes.
    fn gusts(&self, wanted: &BridgeExportOptions) -> Result<Option<BridgeGusts>> {
        if wanted.gust_strips.is_none() && wanted.turbulence.is_none() {
            return Ok(None);
        }
        let nodes = self.by_model.nodes.len();
        let count = wanted.gust_strips.unwrap_or(0);
        let some = count <= nodes && wanted.gust_strips != Some(0);
        let expected = format_args!("1 to {nodes}, the nodes of the bridge");
        ensure(some, "strips with gusts", expected, count)?;
        let first = |strip: usize| (strip * nodes).div_ceil(count);
        let strips = (0..count).map(|s| (first(s)..first(s + 1)).collect());
        let sections = self.file.sections.iter().map(|s| s.name.as_str());
        let names = sections.collect::<Vec<_>>().join(", ");
        Ok(Some(BridgeGusts {
            coefficients: self.gust_matrices()?,
            admittance: wanted.admittance,
            strips: strips.collect(),
            source: format!("{STATIC_COEFFICIENTS} {names}"),
        }))
    }

    /// That gusts are packed with another admittance than `[buffeting]` states for them.
    pub fn other_admittance(&self, wanted: &BridgeExportOptions) -> Option<String> {
        if wanted.gust_strips.is_none() && wanted.turbulence.is_none() {
            return None;
        }
        let block = self.buffeting_block().ok()?;
        let packed = Admittance::from(wanted.admittance);
        let components = [("u", block.along), ("w", block.vertical)];
        let stated = components.map(|(name, gust)| Some((name, gust?.admittance)));
        let mut others = stated.into_iter().flatten().filter(|(_, a)| *a != packed);
        let (name, stated) = others.next()?;
        Some(format!(
            "gusts are packed with the admittance {} on u and w, where [buffeting] states {} for {name}: motions of the FMU are not those \
             of `bridge buffeting` (--admittance chooses another)",
            packed.name(),
            stated.name(),
        ))
    }

    /// Places of named nodes; of mid-span and both quarter points where none are named.
    pub(super) fn named(&self, named: &[String]) -> Result<Vec<usize>> {
        let nodes = &self.by_model.nodes;
        if named.is_empty() {
            let mut places: Vec<usize> = [1, 2, 3].map(|q| q * (nodes.len() - 1) / 4).to_vec();
            places.dedup();
            return Ok(places);
        }
        let place = |name: &String| {
            let at = nodes.iter().position(|n| n.name == *name);
            at.ok_or_else(|| {
                let (a, b) = (&nodes[0].name, &nodes[nodes.len() - 1].name);
                let expected = format!("nodes of the bridge, {a} to {b}");
                Error::input("nodes", expected, format!("`{name}`"))
            })
        };
        named.iter().map(place).collect()
    }

    /// A small release in the mode that takes part most at the onset, or in the first.
    fn release(&self, motion: Option<&BridgeMotion>) -> Vec<f64> {
        let bridge = &self.by_model;
        let number = motion.and_then(|m| m.modes.first()).map(|m| m.mode);
        let half_width = 0.5 * bridge.width_m();
        let mut modes = bridge.modes.iter();
        let chosen = modes.position(|m| Some(m.number) == number).unwrap_or(0);
        let scale = [1.0, 1.0, half_width];
        let shape = bridge.modes[chosen].shape.iter();
        let values = shape.flat_map(|s| (0..3).map(|i| (s[i] * scale[i]).abs()));
        let greatest = values.fold(f64::MIN_POSITIVE, f64::max);
        let mut initial = vec![0.0; bridge.modes.len()];
        initial[chosen] = RELEASE * half_width / greatest;
        initial
    }

    fn experiment(&self, first_m_s: f64) -> Experiment {
        let hertz = || self.by_model.modes.iter().map(|m| m.frequency_hz);
        let slowest = hertz().fold(f64::MAX, f64::min);
        let fastest = hertz().fold(0.0, f64::max);
        // a round part of a second, and whole steps
        let step = 0.01 * (100.0 / (STEPS_PER_PERIOD * fastest)).floor().max(1.0);
        Experiment {
            wind_speed_m_s: PART_OF_ONSET * first_m_s,
            initial_vertical_m: 0.0,
            initial_rotation_rad: 0.0,
            stop_time_s: step * (PERIODS / slowest / step).round(),
            step_size_s: step,
            onset_search_limit_m_s: self.file.flutter.speed_max_m_s,
        }
    }
}
