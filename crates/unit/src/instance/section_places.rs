//! Where the variables of a section stand in the table.

use super::coupled::CoupledPlaces;
use super::layout::place;
use crate::error::Result;
use crate::variables::{GustDirection, Response, Role, VariableTable};

/// Displacement, rate, acceleration and self-excited force of each degree of freedom.
pub(super) type ResponsePlaces = Vec<[usize; 4]>;

pub(super) fn response_places(table: &VariableTable) -> Result<ResponsePlaces> {
    let dofs = table.dofs().into_iter();
    dofs.map(|dof| {
        let mut places = [0; 4];
        for (slot, response) in places.iter_mut().zip(Response::ALL) {
            *slot = place(table, Role::Response(response, dof))?;
        }
        Ok(places)
    })
    .collect()
}

impl CoupledPlaces {
    pub(super) fn of_section(table: &VariableTable, responses: &ResponsePlaces) -> Result<Self> {
        let dofs = table.dofs();
        let forces = dofs.iter().map(|&dof| Role::ExternalForce(dof));
        let inputs = std::iter::once(Role::WindSpeed).chain(forces);
        let mut inputs: Vec<_> = inputs.map(|r| place(table, r)).collect::<Result<_>>()?;
        let first_gust = inputs.len();
        let gusts = GustDirection::BOTH.into_iter();
        inputs.extend(gusts.filter_map(|gust| table.find(Role::Gust(0, gust))));
        let displacements = dofs.iter().map(|&dof| Role::InitialDisplacement(dof));
        let initial = displacements.chain(dofs.iter().map(|&dof| Role::InitialRate(dof)));
        let state_entry = |(place, variable): (usize, &crate::variables::Variable)| {
            // the state begins with all displacements, then all rates
            let row = |order: usize| responses.iter().position(|of| of[order] == place);
            match variable.role {
                Role::Filter(i) => Some(2 * dofs.len() + i),
                _ => row(0).or_else(|| Some(dofs.len() + row(1)?)),
            }
        };
        Ok(Self {
            inputs,
            first_gust,
            initial: initial.map(|r| place(table, r)).collect::<Result<_>>()?,
            limit: place(table, Role::OnsetSearchLimit)?,
            turbulence_factor: None,
            state_entry: table
                .variables()
                .iter()
                .enumerate()
                .map(state_entry)
                .collect(),
        })
    }
}
