//! What makes an exported unit a whole bridge: its modes, its strips, the nodes that an importer sees.

use super::bridge_gusts::BridgeGusts;
use super::gust_channels::GustChannels;
use super::onset_bounds::OnsetBounds;
use super::onset_start::OnsetStart;
use crate::aerodynamics::Transfer;
use crate::aeroelastic::CoupledSection;
use crate::bridge::{Bridge, BridgeMode, Dampers, Node, StripGroup};
use crate::error::{Error, Result, ensure, positive};
use crate::response::Stepper;
use crate::trained_model::Model;
use crate::units::ReducedFrequencyRange;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The file of the bridge in `resources/`; an archive without it holds a section.
pub const BRIDGE_FILE: &str = "bridge.json";
/// Modes at most: the step matrix of more would not fit into a gigabyte.
const MAX_MODES: usize = 500;
/// Nodes at most.
const MAX_NODES: usize = 20_000;

/// A bridge as it is exported.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BridgeOptions {
    /// Name.
    pub name: String,
    /// Air density, kg/m³.
    pub air_density_kg_m3: f64,
    /// Nodes along the girder.
    pub nodes: Vec<Node>,
    /// Modes.
    pub modes: Vec<BridgeMode>,
    /// Dampers.
    #[serde(default, skip_serializing_if = "Dampers::is_empty")]
    pub dampers: Dampers,
    /// Whether it is the structure alone, whose forces come from outside: nothing of wind is listed.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub structure_alone: bool,
    /// Groups of nodes, with the places of their force models in [`Self::forces`].
    pub groups: Vec<StripGroup<usize>>,
    /// Force models of the groups.
    pub forces: Vec<Model>,
    /// Indices of the nodes with inputs and outputs.
    pub named: Vec<usize>,
    /// Reduced frequencies, of the bridge, in which the force models were tested.
    pub tested_range: Option<ReducedFrequencyRange>,
    /// Those of each section that was tested, its own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub section_ranges: Vec<ReducedFrequencyRange>,
    /// Modal coordinates at release, one per mode.
    pub initial: Vec<f64>,
    /// Gusts as inputs of strips; none without.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gusts: Option<BridgeGusts>,
    /// 95 % interval of the onset, where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub onset_interval: Option<OnsetBounds>,
    /// The onset of the bridge as it is exported, from which a unit goes on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub onset: Option<OnsetStart>,
}

/// Number of a node in the names of variables: its own name where that is a number, else its position from 1 on.
pub fn node_number(nodes: &[Node], index: usize) -> u32 {
    let number = nodes[index].name.parse().ok();
    number.unwrap_or_else(|| u32::try_from(index + 1).unwrap_or(u32::MAX))
}

impl BridgeOptions {
    /// The bridge.
    ///
    /// # Errors
    /// [`Error::Input`] for numbers that make no bridge.
    pub fn bridge(&self) -> Result<Bridge> {
        // one for all groups of a section
        let shared = |m: &Model| -> Arc<dyn Transfer> { Arc::new(m.clone()) };
        let forces: Vec<_> = self.forces.iter().map(shared).collect();
        let group = |g: &StripGroup<usize>| {
            let forces = forces.get(g.forces).ok_or_else(|| {
                let expected = format!("a force model below {}", self.forces.len());
                Error::input(format!("group {}", g.name), expected, g.forces.to_string())
            })?;
            Ok(g.with_forces(Arc::clone(forces)))
        };
        let groups = self.groups.iter().map(group).collect::<Result<_>>()?;
        let (nodes, modes) = (self.nodes.clone(), self.modes.clone());
        Bridge::new(
            self.name.clone(),
            self.air_density_kg_m3,
            nodes,
            modes,
            groups,
        )?
        .with_dampers(self.dampers.clone())
    }

    /// Number of coordinates: modes, then masses of dampers.
    pub(super) fn coordinates(&self) -> usize {
        self.modes.len() + self.dampers.masses.len()
    }

    /// The stepper of a bridge with these gusts, and what the gusts of the strips do to its modes.
    ///
    /// # Errors
    /// [`Error::Input`] for forces that cannot be stepped and for strips that are none.
    pub(super) fn stepper(&self, bridge: &Bridge) -> Result<(Stepper, Option<GustChannels>)> {
        let coupled = CoupledSection::new(bridge.structure(), bridge.forces().realize()?)?;
        let Some(gusts) = &self.gusts else {
            return Ok((Stepper::new(coupled), None));
        };
        let channels = GustChannels::new(bridge, &gusts.coefficients, &gusts.strips)?;
        let stepper =
            Stepper::in_modal_gusts(coupled, &channels.convection_per_width, gusts.admittance);
        Ok((stepper, Some(channels)))
    }

    /// Name of a node in the names of variables, see [`node_number`].
    pub fn node_name(&self, named: usize) -> String {
        node_number(&self.nodes, self.named[named]).to_string()
    }

    /// Checks what does not need the matrices.
    fn validate(&self) -> Result<()> {
        for (what, count, most) in [
            ("modes", self.modes.len(), MAX_MODES),
            ("nodes", self.nodes.len(), MAX_NODES),
        ] {
            let in_range = (1..=most).contains(&count);
            ensure(in_range, what, format_args!("1 to {most}"), count)?;
        }
        positive("air_density_kg_m3", self.air_density_kg_m3)?;
        let mut names: Vec<String> = Vec::with_capacity(self.named.len());
        for (i, index) in self.named.iter().enumerate() {
            let (place, nodes) = ("nodes with outputs", self.nodes.len());
            let expected = format_args!("a node below {nodes}");
            ensure(*index < nodes, place, expected, index)?;
            names.push(self.node_name(i));
            let found = format_args!("node {} twice", names[i]);
            ensure(!names[..i].contains(&names[i]), place, "each once", found)?;
        }
        let all = self.initial.len() == self.modes.len();
        ensure(
            all && self.initial.iter().all(|x| x.is_finite()),
            "initial",
            format_args!("{} finite modal coordinates", self.modes.len()),
            format_args!("{:?}", self.initial),
        )?;
        if let Some(interval) = &self.onset_interval {
            interval.check().map_err(|e| e.at("onset_interval"))?;
        }
        if let Some(onset) = &self.onset {
            onset.check().map_err(|e| e.at("onset"))?;
        }
        let bridge = self.bridge()?;
        self.gusts.iter().try_for_each(|g| g.validate(&bridge))
    }

    /// Reads and checks the options.
    ///
    /// # Errors
    /// [`Error::Input`] for text that is not such a file, and for numbers that make no bridge.
    pub fn from_json(text: &str) -> Result<Self> {
        let options: Self = serde_json::from_str(text)
            .map_err(|e| Error::json("a bridge as `aerodeck fmu export --bridge` writes it", &e))?;
        options.validate()?;
        Ok(options)
    }

    /// The options as JSON.
    ///
    /// # Errors
    /// [`Error::Input`] for numbers that make no bridge.
    pub fn to_json(&self) -> Result<String> {
        self.validate()?;
        serde_json::to_string(self).map_err(|e| Error::Numerical(e.to_string()))
    }
}
