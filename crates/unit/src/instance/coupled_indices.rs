//! Where the variables of a section or bridge stand.

use super::layout::index_of;
use crate::error::Result;
use crate::section::Dof;
use crate::variables::{Causality, Response, Role, Variable, VariableTable};

/// Indices in the table.
#[derive(Debug)]
pub(super) struct CoupledIndices {
    pub wind_speed: usize,
    /// Wind speed, then forces, then gusts: the inputs.
    pub inputs: Vec<usize>,
    /// Where the gusts begin among them.
    pub first_gust: usize,
    /// Displacements at release, then rates where they can be set.
    pub initial: Vec<usize>,
    /// Upper end of the search for the onset.
    pub limit: usize,
    /// Factor on the turbulence of the archive.
    pub turbulence_factor: Option<usize>,
    /// Where the state begins that [`Role::Filter`] counts.
    pub first_filter: usize,
    /// Entry of the state that a variable is; by index.
    pub state_entry: Vec<Option<usize>>,
}

impl CoupledIndices {
    /// Those of a section or bridge, whose inputs stand first in the table, in this order.
    pub(super) fn new(table: &VariableTable) -> Result<Self> {
        let all = |wanted: &dyn Fn(&Variable) -> bool| -> Vec<usize> {
            let variables = table.variables().iter().enumerate();
            let wanted = variables.filter(|(_, v)| wanted(v));
            wanted.map(|(index, _)| index).collect()
        };
        let inputs = all(&|v| v.causality == Causality::Input);
        let gusts = all(&|v| matches!(v.role, Role::Gust(..))).len();
        let displacements =
            |v: &Variable| matches!(v.role, Role::InitialDisplacement(_) | Role::InitialMode(_));
        let mut initial = all(&displacements);
        initial.extend(all(&|v| matches!(v.role, Role::InitialRate(_))));
        // the state begins with all displacements, then all rates; on a bridge every entry is numbered
        let dofs = table.dofs();
        let first_filter = 2 * dofs.len();
        let of = |dof: Dof| dofs.iter().position(|d| *d == dof);
        let entries = table.variables().iter().map(|v| match v.role {
            Role::Filter(i) => Some(first_filter + i),
            Role::Response(Response::Displacement, dof) => of(dof),
            Role::Response(Response::Rate, dof) => of(dof).map(|i| dofs.len() + i),
            _ => None,
        });
        Ok(Self {
            wind_speed: index_of(table, Role::WindSpeed)?,
            first_gust: inputs.len() - gusts,
            inputs,
            initial,
            limit: index_of(table, Role::OnsetSearchLimit)?,
            first_filter,
            turbulence_factor: table.find(Role::TurbulenceFactor),
            state_entry: entries.collect(),
        })
    }

    pub(super) fn forces(&self) -> &[usize] {
        &self.inputs[1..self.first_gust]
    }

    pub(super) fn gusts(&self) -> &[usize] {
        &self.inputs[self.first_gust..]
    }
}
