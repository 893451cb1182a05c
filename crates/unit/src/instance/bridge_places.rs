//! Where the variables of a bridge stand in the table.

use super::coupled::CoupledPlaces;
use super::layout::place;
use crate::bridge_options::BridgeOptions;
use crate::error::Result;
use crate::section::Dof;
use crate::variables::{GustDirection, Role, VariableTable};

impl CoupledPlaces {
    /// The forces in the rows of the shapes, the gusts of each strip.
    pub(super) fn of_bridge(table: &VariableTable, options: &BridgeOptions) -> Result<Self> {
        let forces = (0..options.named.len())
            .flat_map(|node| Dof::THREE.map(|dof| Role::NodeForce(node, dof)));
        let strips = options.gusts.as_ref().map_or(0, |g| g.strips.len());
        let gusts =
            (0..strips).flat_map(|strip| GustDirection::BOTH.map(|gust| Role::Gust(strip, gust)));
        let inputs = std::iter::once(Role::WindSpeed).chain(forces).chain(gusts);
        let initial = (0..options.modes.len()).map(Role::InitialMode);
        let state_entry = table.variables().iter().map(|v| match v.role {
            Role::Filter(entry) => Some(entry),
            _ => None,
        });
        Ok(Self {
            inputs: inputs.map(|r| place(table, r)).collect::<Result<_>>()?,
            first_gust: 1 + 3 * options.named.len(),
            initial: initial.map(|r| place(table, r)).collect::<Result<_>>()?,
            limit: place(table, Role::OnsetSearchLimit)?,
            turbulence_factor: table.find(Role::TurbulenceFactor),
            state_entry: state_entry.collect(),
        })
    }
}
