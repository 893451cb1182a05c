//! What depends on what: the structure of outputs while stepping, and of all unknowns while initialising.

use super::variable::find;
use super::{Causality, InitialDependency, Response, Role, SectionParameter, Status, Variable};
use crate::aerodynamics::{GustForce, Realizable, Realization};
use crate::section::Dof;
use crate::trained_model::TrainedModel;

/// Fills in the dependencies of every output, state, rate of a state and calculated parameter. States count as known only
/// where importers see them.
pub(super) fn fill(variables: &mut [Variable], model: &TrainedModel, gusts: Option<&GustForce>) {
    let coupling = Coupling {
        added_mass: has_added_mass(model),
        unbalance: model.section.mass_offset_m.is_some(),
        gusts_at_once: gusts.is_some_and(|g| g.states() == 0),
    };
    let filters = model.model.realize().states();
    let seen = variables.iter().any(|v| v.derivative_of.is_some());
    for i in 0..variables.len() {
        let (mut direct, mut initial) = match variables[i].role {
            Role::Filter(i) if i >= filters => (Vec::new(), dependent(gust(variables))),
            Role::FilterRate(i) if i >= filters => {
                let known = places(variables, |role| {
                    matches!(
                        role,
                        Role::WindSpeed | Role::Gust(..) | Role::Section(SectionParameter::Width)
                    )
                });
                let inputs = places(variables, |role| {
                    matches!(role, Role::WindSpeed | Role::Gust(..))
                });
                (inputs, dependent(known))
            }
            Role::Filter(_) => (Vec::new(), settled_flow(variables)),
            Role::FilterRate(_) => {
                let wind = places(variables, |role| role == Role::WindSpeed);
                let known = settled_flow(variables).into_iter();
                (wind.clone(), known.chain(dependent(wind)).collect())
            }
            Role::Response(response, dof) => (
                direct_inputs(variables, response, dof, coupling),
                initial_knowns(variables, response, dof, coupling),
            ),
            Role::Calculated(_) => (Vec::new(), parameters(variables)),
            Role::Status(status) => {
                let windless = [Status::AmplitudeInLinearRange, Status::FlutterSpeed];
                let wind = places(variables, |role| {
                    role == Role::WindSpeed && !windless.contains(&status)
                });
                let known = dependent(wind.iter().copied());
                let stated = parameters(variables).into_iter();
                let release = dependent(places(variables, |role| {
                    role == Role::InitialDisplacement(Dof::Torsion)
                }));
                let known = match status {
                    Status::AmplitudeInLinearRange => release,
                    _ => stated.chain(known).collect(),
                };
                (wind, known)
            }
            _ => continue,
        };
        if seen {
            direct.extend(states_behind(variables, i, filters));
            direct.sort_unstable();
        }
        initial.sort_by_key(|d| d.on);
        variables[i].direct_inputs = direct;
        variables[i].initial_dependencies = initial;
    }
}

/// States on which a variable depends: a state on itself, forces and accelerations on all, a filter's rate on displacements and
/// filters.
fn states_behind(variables: &[Variable], of: usize, filters: usize) -> Vec<usize> {
    let depends = |on: Role| match variables[of].role {
        Role::Status(Status::AmplitudeInLinearRange) => {
            on == Role::Response(Response::Displacement, Dof::Torsion)
        }
        Role::Response(Response::Acceleration | Response::SelfExcitedForce, _) => true,
        Role::FilterRate(i) => match on {
            Role::Filter(j) => (i < filters && j < filters) || i == j,
            on => i < filters && !matches!(on, Role::Response(Response::Rate, _)),
        },
        own @ (Role::Response(..) | Role::Filter(_)) => on == own,
        _ => false,
    };
    (0..variables.len())
        .filter(|&i| variables[i].is_state() && depends(variables[i].role))
        .collect()
}

/// What the filters of a section held still depend on.
fn settled_flow(variables: &[Variable]) -> Vec<InitialDependency> {
    dependent(places(variables, |role| {
        matches!(
            role,
            Role::InitialDisplacement(_)
                | Role::Section(SectionParameter::Width | SectionParameter::AxisOffset)
        )
    }))
}

fn gust(variables: &[Variable]) -> Vec<usize> {
    places(variables, |role| matches!(role, Role::Gust(..)))
}

/// What makes the accelerations depend on one another.
#[derive(Clone, Copy)]
struct Coupling {
    /// Of the air: acts on the self-excited forces as well.
    added_mass: bool,
    /// Of the section itself.
    unbalance: bool,
    /// Gusts act without a lag.
    gusts_at_once: bool,
}

impl Coupling {
    fn of(self, response: Response) -> bool {
        self.added_mass || (self.unbalance && response == Response::Acceleration)
    }
}

/// Whether accelerations feed back into the forces, so that every external force acts on every acceleration.
fn has_added_mass(model: &TrainedModel) -> bool {
    match model.model.realize() {
        Realization::Continuous(c) => c.e2.iter().any(|x| *x != 0.0),
        Realization::Discrete(_) => false,
    }
}

/// Inputs that act at once: displacements and rates are states and none acts on them.
fn direct_inputs(
    variables: &[Variable],
    response: Response,
    dof: Dof,
    coupling: Coupling,
) -> Vec<usize> {
    let coupled = coupling.of(response);
    let acts = |role: Role| match (response, role) {
        (Response::Acceleration | Response::SelfExcitedForce, Role::WindSpeed) => true,
        (Response::Acceleration, Role::ExternalForce(on)) => coupled || on == dof,
        (Response::SelfExcitedForce, Role::ExternalForce(_)) => coupled,
        (Response::Acceleration, Role::Gust(..)) => coupling.gusts_at_once,
        (Response::SelfExcitedForce, Role::Gust(..)) => coupling.gusts_at_once && coupled,
        _ => false,
    };
    places(variables, acts)
}

fn initial_knowns(
    variables: &[Variable],
    response: Response,
    dof: Dof,
    coupling: Coupling,
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
    let (coupled, accelerates) = (coupling.of(response), response == Response::Acceleration);
    let acts = |role: Role| match role {
        Role::InitialDisplacement(_) | Role::InitialRate(_) => true,
        // lags begin where the gusts are
        Role::Gust(..) => !coupling.gusts_at_once && (coupled || accelerates),
        Role::Section(
            SectionParameter::Width | SectionParameter::AirDensity | SectionParameter::AxisOffset,
        ) => true,
        Role::Section(SectionParameter::MassOffset) => coupled || accelerates,
        Role::Section(
            SectionParameter::Inertia(of)
            | SectionParameter::Frequency(of)
            | SectionParameter::DampingRatio(of),
        ) => coupled || (accelerates && of == dof),
        _ => false,
    };
    let inputs = direct_inputs(variables, response, dof, coupling);
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
