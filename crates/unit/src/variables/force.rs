//! The variables of a unit of forces, in the order of the table.

use super::computed_rows::{OF_A_STRIP, fill_computed_dependencies};
use super::dof_names::names_of;
use super::real::{SMALLEST, constants, force_scale, nominal, real};
use super::section::{air_density, filter, gust_filter, gust_inputs, name_rates, wind_speed};
use super::{Dependency, Response, Role, StripParameter, Variable};
use crate::aerodynamics::{GustForce, Realizable, Realization};
use crate::error::Result;
use crate::force_options::{ForceOptions, MAX_PREDICTION, StripsOfModel};
use crate::section::Dof;
use crate::si::{self, SiUnit};
use crate::trained_model::TrainedModel;

/// All variables with their dependencies.
pub(super) fn variables(
    model: &TrainedModel,
    options: &ForceOptions,
    gusts: Option<&GustForce>,
) -> Result<Vec<Variable>> {
    let parts = options.parts(model, gusts);
    let each = || {
        parts
            .iter()
            .flat_map(|p| p.strips.clone().map(move |s| (p.model, s)))
    };
    let mut table = vec![wind_speed(model)];
    for (model, s) in each() {
        table.extend(motion(model, s, options));
        if gusts.is_some() {
            table.extend(gust_inputs(s, |of| name(options, s, of)));
        }
    }
    for (model, s) in each() {
        table.extend(forces(model, s, options, gusts.is_some()));
        let names = name(options, s, "");
        table.extend(OF_A_STRIP.iter().map(|row| row.of_strip(s, &names)));
    }
    table.push(air_density().start(model.section.air_density_kg_m3));
    for s in 0..options.strips.len() {
        table.extend(strip(s, options));
    }
    table.extend(coupling(options));
    let models: Vec<&TrainedModel> = parts.iter().map(|p| p.model).collect();
    let filters = parts.iter().map(|p| p.filters).max();
    table.extend(constants(&models, filters.unwrap_or(0))?);
    let states = strip_states(&parts);
    let sampled = |m: &&TrainedModel| matches!(m.model.realize(), Realization::Discrete(_));
    if !models.iter().any(sampled) {
        add_states(&mut table, options, &states);
        name_rates(&mut table);
    }
    fill_dependencies(&mut table, options.strips.len(), &states);
    fill_computed_dependencies(&mut table);
    Ok(table)
}

/// A filter or lagging gust of a strip.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StripState {
    /// Its strip.
    pub strip: usize,
    /// Which of the filters, or of the lagging gusts.
    pub number: usize,
    /// Whether it is a lagging gust.
    pub lags: bool,
}

/// Filters, then lagging gusts of strips in the order of [`Role::Filter`]: each of all strips that have it before the next, as
/// arrays stand.
pub(crate) fn strip_states(parts: &[StripsOfModel<'_>]) -> Vec<StripState> {
    let mut all = Vec::new();
    for lags in [false, true] {
        let count = |p: &StripsOfModel<'_>| if lags { p.lags } else { p.filters };
        for number in 0..parts.iter().map(count).max().unwrap_or(0) {
            let having = parts.iter().filter(|p| number < count(p));
            let strips = having.flat_map(|p| p.strips.clone());
            all.extend(strips.map(|strip| StripState {
                strip,
                number,
                lags,
            }));
        }
    }
    all
}

/// Filters and lagging gusts with their rates, for importers that integrate.
fn add_states(table: &mut Vec<Variable>, options: &ForceOptions, states: &[StripState]) {
    for (i, state) in states.iter().enumerate() {
        let of = |kind: &str| {
            let kind = format!("{kind}[{}]", state.number + 1);
            name(options, state.strip, &kind)
        };
        table.extend(match state.lags {
            false => filter(i, &of("filter")),
            true => gust_filter(i, &of("gust_filter")),
        });
    }
}

/// Name of a variable of a strip.
fn name(options: &ForceOptions, s: usize, of: &str) -> String {
    match options.nodes.get(s) {
        Some(node) => format!("node[{node}].{of}"),
        None if options.named_strips => format!("strip[{}].{of}", s + 1),
        None => of.to_owned(),
    }
}

fn motion<'a>(
    model: &'a TrainedModel,
    s: usize,
    options: &'a ForceOptions,
) -> impl Iterator<Item = Variable> + 'a {
    let dofs = model.section.dofs().into_iter();
    let each = dofs.flat_map(|dof| Response::MOTION.map(|response| (dof, response)));
    each.map(move |(dof, response)| {
        let w = names_of(dof);
        let more = match response {
            Response::Displacement => " of the deck, at the reference point of the forces",
            _ => "; need not be connected in co-simulation",
        };
        let role = Role::Motion(s, response, dof);
        let text = w.describe(response) + more;
        real(name(options, s, &w.name(response)), role, text)
            .start(0.0)
            .measured_as(response, dof)
            .nominal(nominal(model, dof, response))
    })
}

fn forces<'a>(
    model: &'a TrainedModel,
    s: usize,
    options: &'a ForceOptions,
    of_gusts: bool,
) -> impl Iterator<Item = Variable> + 'a {
    let kind = match of_gusts {
        true => "Self-excited and gust",
        false => "Self-excited",
    };
    model.section.dofs().into_iter().flat_map(move |dof| {
        let w = names_of(dof);
        let (total_unit, total_quantity): (&'static SiUnit, _) = match dof {
            Dof::Torsion => (&si::NEWTON_METRE, "Torque"),
            _ => (&si::NEWTON, "Force"),
        };
        let of = w.force_name;
        let ahead = "at the instant at which it acts (see prediction)";
        let per_length = format!("{kind} {}, {ahead}", w.force);
        let total = format!("{kind} {of} on the length of the strip, {ahead}");
        let output = |of: &str, role, text| real(name(options, s, of), role, text);
        [
            output(of, Role::Force(s, dof), per_length)
                .measured_as(Response::SelfExcitedForce, dof)
                .nominal(force_scale(model, dof)),
            output(&format!("total_{of}"), Role::TotalForce(s, dof), total)
                .quantity(total_quantity, Some(total_unit)),
        ]
    })
}

fn strip(s: usize, options: &ForceOptions) -> [Variable; 3] {
    let of = &options.strips[s];
    let metre: Option<&SiUnit> = Some(&si::METRE);
    let parameter = |which, key, text: &str, start| {
        real(name(options, s, key), Role::Strip(s, which), text).start(start)
    };
    let wind = "Wind speed at the strip over wind_speed";
    let (width, length) = ("Full deck width B", "Length of span of the strip");
    [
        parameter(StripParameter::Width, "width", width, of.width_m)
            .quantity("Length", metre)
            .min(SMALLEST),
        parameter(StripParameter::Length, "length", length, of.length_m)
            .quantity("Length", metre)
            .min(SMALLEST),
        parameter(
            StripParameter::WindFactor,
            "wind_factor",
            wind,
            of.wind_factor,
        )
        .min(0.0),
    ]
}

/// What has to be known of the importer.
fn coupling(options: &ForceOptions) -> [Variable; 2] {
    [
        real(
            "prediction",
            Role::Prediction,
            "The forces put out are those of this many communication steps after the motion that was set for the last \
             step: 1.5 for an explicit importer that holds them over its next step (the default), 1 for one that \
             extrapolates them from the end of the step, 0.5 for one that steps the structure first and sets the motion of \
             the end of the step, 0 for iterations within a step; without effect in model exchange",
        )
        .min(0.0)
        .max(MAX_PREDICTION)
        .start(options.prediction_steps),
        real(
            "motion_derivatives",
            Role::MotionDerivatives,
            "Derivatives of the motion that are set: 0 none, 1 rates, 2 rates and accelerations, -1 those that have \
             been set since the last step",
        )
        .min(-1.0)
        .max(2.0)
        .start(-1.0),
    ]
}

/// Forces follow the wind and the motion of their strip, its states, and everything that is stated of it; a filter's rate
/// the displacements and all filters, that of a lagging gust the gusts and itself.
fn fill_dependencies(table: &mut [Variable], strips: usize, states: &[StripState]) {
    let mut shared = Vec::new();
    // inputs and parameters, filters, lagging gusts of each strip
    let [mut of_strip, mut filters, mut lags] = [(); 3].map(|()| vec![Vec::new(); strips]);
    for (index, variable) in table.iter().enumerate() {
        match variable.role {
            Role::WindSpeed | Role::Section(_) | Role::MotionDerivatives => shared.push(index),
            Role::Motion(s, ..) | Role::Gust(s, _) | Role::Strip(s, _) => of_strip[s].push(index),
            Role::Filter(i) if is_lag(variable) => lags[states[i].strip].push(index),
            Role::Filter(i) => filters[states[i].strip].push(index),
            _ => {}
        }
    }
    let roles: Vec<Role> = table.iter().map(|v| v.role).collect();
    for (index, variable) in table.iter_mut().enumerate() {
        let (strip, inner): (usize, Vec<usize>) = match variable.role {
            Role::Force(s, _) | Role::TotalForce(s, _) => (s, [&filters[s][..], &lags[s]].concat()),
            Role::Filter(i) => (states[i].strip, vec![index]),
            // behind its state
            Role::FilterRate(i) if is_lag(variable) => (states[i].strip, vec![index - 1]),
            Role::FilterRate(i) => (states[i].strip, filters[states[i].strip].clone()),
            _ => continue,
        };
        let known = shared.iter().chain(&of_strip[strip]).copied();
        let mut known: Vec<usize> = known.filter(|on| follows(variable, roles[*on])).collect();
        known.sort_unstable();
        let input = |index: &usize| {
            matches!(
                roles[*index],
                Role::WindSpeed | Role::Motion(..) | Role::Gust(..)
            )
        };
        if !matches!(variable.role, Role::Filter(_)) {
            let direct = known.iter().copied().filter(input);
            variable.direct_inputs = direct.map(Dependency::plain).collect();
        }
        variable
            .direct_inputs
            .extend(inner.into_iter().map(Dependency::plain));
        variable.initial_dependencies = known.into_iter().map(Dependency::plain).collect();
    }
}

/// Whether a state, or the state of a rate, is a lagging gust.
fn is_lag(variable: &Variable) -> bool {
    matches!(variable.quantity, Some("Velocity" | "Acceleration"))
}

/// Whether a force, a state or its rate depends on an input or parameter of its strip, or of all.
fn follows(variable: &Variable, on: Role) -> bool {
    let displacement = matches!(on, Role::Motion(_, Response::Displacement, _));
    let width = matches!(on, Role::Strip(_, StripParameter::Width));
    let wind = on == Role::WindSpeed || matches!(on, Role::Strip(_, StripParameter::WindFactor));
    let gust = matches!(on, Role::Gust(..));
    match variable.role {
        Role::Force(..) => !matches!(on, Role::Strip(_, StripParameter::Length)),
        Role::TotalForce(..) => true,
        Role::Filter(_) if is_lag(variable) => gust,
        Role::Filter(_) => displacement || width,
        _ if is_lag(variable) => gust || width || wind,
        _ => displacement || width || wind,
    }
}
