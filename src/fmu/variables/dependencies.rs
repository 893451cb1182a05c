//! What depends on what: the structure of outputs while stepping, and of all unknowns while initialising.

use super::{Causality, InitialDependency, Response, Role, SectionParameter, Variable, find};
use crate::aerodynamics::{AerodynamicModel, Realization};
use crate::section::Dof;
use crate::trained_model::TrainedModel;

/// Fills in the dependencies of every output and calculated parameter.
pub(super) fn fill(variables: &mut [Variable], model: &TrainedModel) {
    let added_mass = has_added_mass(model);
    for i in 0..variables.len() {
        let (direct, mut initial) = match variables[i].role {
            Role::Response(response, dof) => (
                direct_inputs(variables, response, dof, added_mass),
                initial_knowns(variables, response, dof, added_mass),
            ),
            Role::Calculated(_) => (Vec::new(), parameters(variables)),
            _ => continue,
        };
        initial.sort_by_key(|d| d.on);
        variables[i].direct_inputs = direct;
        variables[i].initial_dependencies = initial;
    }
}

/// Whether accelerations feed back into the forces, so that every external force acts on every acceleration.
fn has_added_mass(model: &TrainedModel) -> bool {
    match model.model.realize() {
        Some(Realization::Continuous(c)) => c.e2.iter().any(|x| *x != 0.0),
        _ => false,
    }
}

/// Inputs that act at once: displacements and rates are states and none acts on them.
fn direct_inputs(
    variables: &[Variable],
    response: Response,
    dof: Dof,
    added_mass: bool,
) -> Vec<usize> {
    let acts = |role: Role| match (response, role) {
        (Response::Acceleration | Response::SelfExcitedForce, Role::WindSpeed) => true,
        (Response::Acceleration, Role::ExternalForce(on)) => added_mass || on == dof,
        (Response::SelfExcitedForce, Role::ExternalForce(_)) => added_mass,
        _ => false,
    };
    places(variables, acts)
}

fn initial_knowns(
    variables: &[Variable],
    response: Response,
    dof: Dof,
    added_mass: bool,
) -> Vec<InitialDependency> {
    let release = match response {
        Response::Displacement => Some(Role::InitialDisplacement(dof)),
        Response::Rate => Some(Role::InitialRate(dof)),
        _ => None,
    };
    if let Some(role) = release {
        return find(variables, role)
            .map(|on| InitialDependency { on, constant: true })
            .into_iter()
            .collect();
    }
    let accelerates = response == Response::Acceleration;
    let acts = |role: Role| match role {
        Role::InitialDisplacement(_) | Role::InitialRate(_) => true,
        Role::Section(SectionParameter::Width | SectionParameter::AirDensity) => true,
        Role::Section(
            SectionParameter::Inertia(of)
            | SectionParameter::Frequency(of)
            | SectionParameter::DampingRatio(of),
        ) => added_mass || (accelerates && of == dof),
        _ => false,
    };
    let inputs = direct_inputs(variables, response, dof, added_mass);
    dependent(inputs.into_iter().chain(places(variables, acts)))
}

/// Everything that onset and divergence depend on.
fn parameters(variables: &[Variable]) -> Vec<InitialDependency> {
    dependent(places(variables, |role| {
        matches!(role, Role::Section(_) | Role::OnsetSearchLimit)
    }))
}

fn dependent(places: impl IntoIterator<Item = usize>) -> Vec<InitialDependency> {
    places
        .into_iter()
        .map(|on| InitialDependency {
            on,
            constant: false,
        })
        .collect()
}

fn places(variables: &[Variable], wanted: impl Fn(Role) -> bool) -> Vec<usize> {
    (0..variables.len())
        .filter(|&i| wanted(variables[i].role))
        .filter(|&i| {
            matches!(
                variables[i].causality,
                Causality::Input | Causality::Parameter
            )
        })
        .collect()
}
