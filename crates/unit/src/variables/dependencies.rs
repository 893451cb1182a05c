//! What depends on what: the structure of outputs while stepping, and of all unknowns while initialising.

use super::{Causality, InitialDependency, Response, Role, SectionParameter, Variable};
use crate::aerodynamics::{GustForce, Realizable, Realization};
use crate::section::Dof;
use crate::trained_model::TrainedModel;

/// What is set from outside: depends on nothing.
macro_rules! stated {
    () => {
        Role::WindSpeed
            | Role::ExternalForce(_)
            | Role::Gust(..)
            | Role::Section(_)
            | Role::InitialDisplacement(_)
            | Role::InitialRate(_)
            | Role::OnsetSearchLimit
    };
}

/// What no section has, and what never changes.
macro_rules! of_other_units {
    () => {
        Role::Constant
            | Role::Motion(..)
            | Role::Force(..)
            | Role::Strip(..)
            | Role::Prediction
            | Role::MotionDerivatives
            | Role::NodeForce(..)
            | Role::NodeMotion(..)
            | Role::Mode(..)
            | Role::InitialMode(_)
            | Role::ModeParameter(..)
            | Role::Damper(..)
            | Role::DamperParameter(_)
            | Role::TurbulenceFactor
    };
}

/// Fills in the dependencies of every output, state, rate of a state and calculated parameter. States count as known only
/// where importers see them.
pub(super) fn fill(variables: &mut [Variable], model: &TrainedModel, gusts: Option<&GustForce>) {
    let coupling = AccelerationCoupling {
        added_mass: has_added_mass(model),
        unbalance: model.section.mass_offset_m.is_some(),
        gusts_at_once: gusts.is_some_and(|g| g.states() == 0),
    };
    let filters = model.model.realize().states();
    let known = &UnknownSources::of(variables);
    for variable in variables.iter_mut() {
        let (mut direct, mut initial) = match variable.role {
            Role::Filter(i) if i >= filters => (Vec::new(), dependent(gust(known))),
            Role::FilterRate(i) if i >= filters => {
                let initial = places(known, |role| {
                    matches!(
                        role,
                        Role::WindSpeed | Role::Gust(..) | Role::Section(SectionParameter::Width)
                    )
                });
                let inputs = places(known, |role| {
                    matches!(role, Role::WindSpeed | Role::Gust(..))
                });
                (inputs, dependent(initial))
            }
            Role::Filter(_) => (Vec::new(), settled_flow(known)),
            Role::FilterRate(_) => {
                let wind = places(known, |role| role == Role::WindSpeed);
                let settled = settled_flow(known).into_iter();
                (wind.clone(), settled.chain(dependent(wind)).collect())
            }
            Role::Response(response, dof) => (
                direct_inputs(known, response, dof, coupling),
                initial_knowns(known, response, dof, coupling),
            ),
            stated!() | of_other_units!() | Role::Computed(_) => continue,
        };
        direct.extend(states_behind(known, variable.role, filters));
        direct.sort_unstable();
        initial.sort_unstable_by_key(|d| d.on);
        variable.direct_inputs = direct;
        variable.initial_dependencies = initial;
    }
}

/// What unknowns depend on, by place in the table, with what each stands for.
struct UnknownSources {
    /// Inputs and parameters.
    stated: Vec<(usize, Role)>,
    /// States, where importers see them.
    states: Vec<(usize, Role)>,
}

impl UnknownSources {
    fn of(variables: &[Variable]) -> Self {
        let seen = variables.iter().any(|v| v.derivative_of.is_some());
        let stated = |v: &Variable| matches!(v.causality, Causality::Input | Causality::Parameter);
        let all = |wanted: &dyn Fn(&Variable) -> bool| {
            let all = variables.iter().enumerate();
            let wanted = all.filter(|(_, v)| wanted(v));
            wanted.map(|(i, v)| (i, v.role)).collect()
        };
        Self {
            stated: all(&stated),
            states: all(&|v| seen && v.is_state()),
        }
    }
}

/// States on which a variable depends: a state on itself, forces and accelerations on all, a filter's rate on displacements and
/// filters.
fn states_behind(known: &UnknownSources, of: Role, filters: usize) -> impl Iterator<Item = usize> {
    let depends = move |on: Role| match of {
        Role::Response(response, _) => match response {
            Response::Acceleration | Response::SelfExcitedForce => true,
            Response::Displacement | Response::Rate => on == of,
        },
        Role::FilterRate(i) => match on {
            Role::Filter(j) => (i < filters && j < filters) || i == j,
            on => i < filters && !matches!(on, Role::Response(Response::Rate, _)),
        },
        Role::Filter(_) => on == of,
        Role::Computed(_) | stated!() | of_other_units!() => false,
    };
    let states = known.states.iter();
    states
        .filter(move |(_, role)| depends(*role))
        .map(|(i, _)| *i)
}

/// What the filters of a section held still depend on.
fn settled_flow(known: &UnknownSources) -> Vec<InitialDependency> {
    dependent(places(known, |role| {
        matches!(
            role,
            Role::InitialDisplacement(_)
                | Role::Section(SectionParameter::Width | SectionParameter::AxisOffset)
        )
    }))
}

fn gust(known: &UnknownSources) -> Vec<usize> {
    places(known, |role| matches!(role, Role::Gust(..)))
}

/// What makes the accelerations depend on one another.
#[derive(Clone, Copy)]
struct AccelerationCoupling {
    /// Of the air: acts on the self-excited forces as well.
    added_mass: bool,
    /// Of the section itself.
    unbalance: bool,
    /// Gusts act without a lag.
    gusts_at_once: bool,
}

impl AccelerationCoupling {
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
    known: &UnknownSources,
    response: Response,
    dof: Dof,
    coupling: AccelerationCoupling,
) -> Vec<usize> {
    let coupled = coupling.of(response);
    // what acts on the motion at once, and what on the forces
    let accelerates = match response {
        Response::Displacement | Response::Rate => return Vec::new(),
        Response::Acceleration => true,
        Response::SelfExcitedForce => false,
    };
    let acts = |role: Role| match role {
        Role::WindSpeed => true,
        Role::ExternalForce(on) => coupled || (accelerates && on == dof),
        Role::Gust(..) => coupling.gusts_at_once && (coupled || accelerates),
        Role::Section(_)
        | Role::InitialDisplacement(_)
        | Role::InitialRate(_)
        | Role::OnsetSearchLimit
        | Role::Response(..)
        | Role::Filter(_)
        | Role::FilterRate(_)
        | Role::Computed(_)
        | of_other_units!() => false,
    };
    places(known, acts)
}

fn initial_knowns(
    known: &UnknownSources,
    response: Response,
    dof: Dof,
    coupling: AccelerationCoupling,
) -> Vec<InitialDependency> {
    let release = match response {
        Response::Displacement => Some(Role::InitialDisplacement(dof)),
        Response::Rate => Some(Role::InitialRate(dof)),
        Response::Acceleration | Response::SelfExcitedForce => None,
    };
    if let Some(role) = release {
        let constant = |on| InitialDependency { on, constant: true };
        let released = places(known, |known| known == role).into_iter();
        return released.map(constant).collect();
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
        Role::WindSpeed
        | Role::ExternalForce(_)
        | Role::OnsetSearchLimit
        | Role::Response(..)
        | Role::Filter(_)
        | Role::FilterRate(_)
        | Role::Computed(_)
        | of_other_units!() => false,
    };
    let inputs = direct_inputs(known, response, dof, coupling);
    dependent(inputs.into_iter().chain(places(known, acts)))
}

pub(super) fn dependent(places: impl IntoIterator<Item = usize>) -> Vec<InitialDependency> {
    places
        .into_iter()
        .map(|on| InitialDependency {
            on,
            constant: false,
        })
        .collect()
}

fn places(known: &UnknownSources, wanted: impl Fn(Role) -> bool) -> Vec<usize> {
    let mut places = Vec::with_capacity(known.stated.len());
    let wanted = known.stated.iter().filter(|(_, role)| wanted(*role));
    places.extend(wanted.map(|(i, _)| *i));
    places
}
