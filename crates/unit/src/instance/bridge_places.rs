//! Where the variables of a bridge stand in the table.

use super::layout::{calculated, place};
use crate::bridge_options::BridgeOptions;
use crate::error::Result;
use crate::section::Dof;
use crate::variables::{Calculated, GustDirection, Role, Variable, VariableTable};

/// See the module.
#[derive(Debug)]
pub(super) struct BridgePlaces {
    /// Wind, then the forces in the rows of the shapes, then the gusts of each strip.
    pub inputs: Vec<usize>,
    /// Where the gusts begin among them.
    pub first_gust: usize,
    /// Motions and modes, with what they stand for.
    pub responses: Vec<(usize, Role)>,
    pub initial: Vec<usize>,
    pub limit: usize,
    /// Onset and divergence.
    pub calculated: Vec<(usize, Calculated)>,
    pub onset_speed: usize,
    pub onset_frequency: usize,
    pub onset_found: usize,
    /// Factor on the turbulence of the archive.
    pub turbulence_factor: Option<usize>,
    /// Entry of the state that a variable is; by place.
    pub state_entry: Vec<Option<usize>>,
}

impl BridgePlaces {
    pub(super) fn new(table: &VariableTable, options: &BridgeOptions) -> Result<Self> {
        let mut inputs = vec![place(table, Role::WindSpeed)?];
        for (node, dof) in
            (0..options.named.len()).flat_map(|node| Dof::THREE.map(|dof| (node, dof)))
        {
            inputs.push(place(table, Role::NodeForce(node, dof))?);
        }
        let first_gust = inputs.len();
        let strips = options.gusts.as_ref().map_or(0, |g| g.strips.len());
        for (strip, gust) in (0..strips).flat_map(|s| GustDirection::BOTH.map(|gust| (s, gust))) {
            inputs.push(place(table, Role::Gust(strip, gust))?);
        }
        let all = || table.variables().iter().enumerate();
        let moves = |v: &Variable| matches!(v.role, Role::NodeMotion(..) | Role::Mode(..));
        let found = |which| place(table, Role::Calculated(which));
        Ok(Self {
            inputs,
            first_gust,
            responses: all()
                .filter(|(_, v)| moves(v))
                .map(|(i, v)| (i, v.role))
                .collect(),
            initial: (0..options.modes.len())
                .map(|m| place(table, Role::InitialMode(m)))
                .collect::<Result<_>>()?,
            limit: place(table, Role::OnsetSearchLimit)?,
            calculated: calculated(table),
            onset_speed: found(Calculated::OnsetSpeed)?,
            onset_frequency: found(Calculated::OnsetFrequency)?,
            onset_found: found(Calculated::OnsetFound)?,
            turbulence_factor: table.find(Role::TurbulenceFactor),
            state_entry: all()
                .map(|(_, v)| match v.role {
                    Role::Filter(entry) => Some(entry),
                    _ => None,
                })
                .collect(),
        })
    }
}
