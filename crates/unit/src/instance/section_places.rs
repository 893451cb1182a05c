//! Where the variables of a section stand in the table.

use super::layout::{calculated, place};
use crate::error::Result;
use crate::section::Dof;
use crate::variables::{Calculated, GustDirection, Response, Role, VariableTable};

/// Places of the variables by what they stand for.
#[derive(Debug)]
pub(super) struct SectionPlaces {
    pub wind_speed: usize,
    /// External force of each degree of freedom.
    pub force: Vec<usize>,
    /// Gusts along the mean wind and upwards; none where the unit takes none.
    pub gusts: Vec<usize>,
    /// Displacement, rate, acceleration and self-excited force of each degree of freedom.
    pub responses: Vec<[usize; 4]>,
    /// Entry of the section's state that a variable is, for displacements, rates and filters; by place.
    pub state_entry: Vec<Option<usize>>,
    /// Displacement at release of each degree of freedom.
    pub initial_displacement: Vec<usize>,
    /// Rate at release of each degree of freedom.
    pub initial_rate: Vec<usize>,
    pub search_limit: usize,
    /// Onset and divergence.
    pub calculated: Vec<(usize, Calculated)>,
    pub onset_speed: usize,
}

impl SectionPlaces {
    pub(super) fn new(table: &VariableTable) -> Result<Self> {
        let dofs = table.dofs();
        let each = |role: fn(Dof) -> Role| -> Result<Vec<usize>> {
            dofs.iter().map(|&dof| place(table, role(dof))).collect()
        };
        let mut responses = vec![[0; 4]; dofs.len()];
        for (places, &dof) in responses.iter_mut().zip(&dofs) {
            for (slot, response) in places.iter_mut().zip(Response::ALL) {
                *slot = place(table, Role::Response(response, dof))?;
            }
        }
        let mut state_entry = vec![None; table.variables().len()];
        for (i, places) in responses.iter().enumerate() {
            // the state begins with all displacements, then all rates
            state_entry[places[0]] = Some(i);
            state_entry[places[1]] = Some(dofs.len() + i);
        }
        for (place, variable) in table.variables().iter().enumerate() {
            if let Role::Filter(i) = variable.role {
                state_entry[place] = Some(2 * dofs.len() + i);
            }
        }
        Ok(Self {
            state_entry,
            wind_speed: place(table, Role::WindSpeed)?,
            force: each(Role::ExternalForce)?,
            gusts: GustDirection::BOTH
                .into_iter()
                .filter_map(|gust| table.find(Role::Gust(0, gust)))
                .collect(),
            responses,
            initial_displacement: each(Role::InitialDisplacement)?,
            initial_rate: each(Role::InitialRate)?,
            search_limit: place(table, Role::OnsetSearchLimit)?,
            onset_speed: place(table, Role::Calculated(Calculated::OnsetSpeed))?,
            calculated: calculated(table),
        })
    }
}
