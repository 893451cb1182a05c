//! A bridge study as what goes into an FMU.

use super::{BridgeStudy, coupled};
use crate::error::{Error, Result};
use crate::flutter::{BridgeMotion, FlutterSearch, OnsetSearch, find_onset};
use crate::fmu::bridge_options::{BridgeOptions, GroupOptions};
use crate::trained_model::{Experiment, Provenance, TrainedModel};

/// Amplitude of the default release where the girder moves most, of half the width.
const RELEASE: f64 = 0.01;
/// Wind speed of the default experiment as a part of the onset.
const PART_OF_ONSET: f64 = 0.98;
/// Periods of the slowest mode in the default experiment, steps in a period of the fastest.
const PERIODS: f64 = 10.0;
const STEPS_PER_PERIOD: f64 = 50.0;

/// Model of the girder and bridge of an FMU.
#[derive(Debug, Clone)]
pub struct BridgeExport {
    /// The force model of the first section, with the section that the first modes make.
    pub model: TrainedModel,
    /// The bridge.
    pub bridge: BridgeOptions,
}

impl BridgeStudy {
    /// What goes into an FMU, with inputs and outputs at the nodes named `named` (left out: mid-span and both quarter points).
    ///
    /// # Errors
    /// [`Error::Input`] for nodes that are none; [`Error::Unstable`] for a bridge that grows below its onset, unless
    /// `allow_unstable`.
    pub fn export(&self, named: &[String], allow_unstable: bool) -> Result<BridgeExport> {
        let bridge = &self.by_model;
        let named = self.named(named)?;
        let search = OnsetSearch {
            speed_max_m_s: self.file.flutter.speed_max_m_s,
            speeds: self.file.flutter.speeds,
        };
        // as the unit itself judges: whatever grows counts, tested or not
        let found = find_onset("bridge", &coupled(bridge)?, &search, None)?;
        if let (FlutterSearch::UnstableAtOrBelow(_), false) = (&found, allow_unstable) {
            return Err(Error::Unstable(format!(
                "the bridge {}: a unit that grows from the lowest wind speed on is exported only with --allow-unstable",
                found.explain()
            )));
        }
        let onset = found.critical_speed_m_s().unwrap_or(search.speed_max_m_s);
        let motion = found
            .critical()
            .map(|at| crate::flutter::motion_at_onset(bridge, &bridge.forces(), at));
        let first = self.sections.first().and_then(|s| s.saved.clone());
        let first = first
            .ok_or_else(|| Error::Numerical("FMU: the first section has no force model".into()))?;
        let model = TrainedModel {
            schema_version: first.schema_version(),
            name: self.file.name.clone(),
            section: bridge.equivalent_section(crate::aerodynamics::Transfer::dofs(&first))?,
            tested_range: self.sections[0]
                .tested
                .unwrap_or(crate::units::ReducedFrequencyRange {
                    min: crate::units::ReducedFrequency::from_full_width(f64::MIN_POSITIVE),
                    max: crate::units::ReducedFrequency::from_full_width(f64::MAX),
                }),
            provenance: Provenance {
                source: self.sections[0].source.clone(),
                licence: self.sections[0].licence.clone(),
                method: "see the files of the sections".to_owned(),
                aerodeck_version: env!("CARGO_PKG_VERSION").to_owned(),
                notes: self.notes.clone(),
            },
            experiment: self.experiment(onset),
            model: first,
        };
        let groups = bridge.groups.iter().zip(&self.section_of_group);
        let groups = groups.map(|(g, section)| GroupOptions {
            name: g.name.clone(),
            width_m: g.width_m,
            wind_factor: g.wind_factor,
            nodes: g.nodes.clone(),
            forces: *section,
        });
        let saved = self.sections.iter().map(|s| s.saved.clone());
        let forces = saved.collect::<Option<Vec<_>>>();
        Ok(BridgeExport {
            model,
            bridge: BridgeOptions {
                name: self.file.name.clone(),
                air_density_kg_m3: bridge.air_density_kg_m3,
                nodes: bridge.nodes.clone(),
                modes: bridge.modes.clone(),
                groups: groups.collect(),
                forces: forces
                    .ok_or_else(|| Error::Numerical("FMU: a section has no force model".into()))?,
                named,
                tested_range: self.tested_range(),
                initial: self.release(motion.transpose()?.as_ref()),
            },
        })
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
            nodes.iter().position(|n| n.name == *name).ok_or_else(|| {
                let (a, b) = (&nodes[0].name, &nodes[nodes.len() - 1].name);
                Error::input(
                    "nodes",
                    format!("nodes of the bridge, {a} to {b}"),
                    format!("`{name}`"),
                )
            })
        };
        named.iter().map(place).collect()
    }

    /// A small release in the mode that takes part most at the onset, or in the first.
    fn release(&self, motion: Option<&BridgeMotion>) -> Vec<f64> {
        let bridge = &self.by_model;
        let number = motion.and_then(|m| m.modes.first()).map(|m| m.mode);
        let half_width = 0.5 * bridge.width_m();
        let chosen = bridge
            .modes
            .iter()
            .position(|m| Some(m.number) == number)
            .unwrap_or(0);
        let scale = [1.0, 1.0, half_width];
        let values = bridge.modes[chosen]
            .shape
            .iter()
            .flat_map(|s| (0..3).map(|i| (s[i] * scale[i]).abs()));
        let greatest = values.fold(f64::MIN_POSITIVE, f64::max);
        let mut initial = vec![0.0; bridge.modes.len()];
        initial[chosen] = RELEASE * half_width / greatest;
        initial
    }

    fn experiment(&self, onset_m_s: f64) -> Experiment {
        let hertz = || self.by_model.modes.iter().map(|m| m.frequency_hz);
        let (slowest, fastest) = (
            hertz().fold(f64::MAX, f64::min),
            hertz().fold(0.0, f64::max),
        );
        // a round part of a second, and whole steps
        let step = 0.01 * (100.0 / (STEPS_PER_PERIOD * fastest)).floor().max(1.0);
        Experiment {
            wind_speed_m_s: PART_OF_ONSET * onset_m_s,
            initial_vertical_m: 0.0,
            initial_rotation_rad: 0.0,
            stop_time_s: step * (PERIODS / slowest / step).round(),
            step_size_s: step,
            onset_search_limit_m_s: self.file.flutter.speed_max_m_s,
        }
    }
}
