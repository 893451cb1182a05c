//! The variables of a whole bridge, in the order of the table.

use super::computed_rows::{OF_THE_PRESENT, SEARCHED};
use super::dof_names::names_of;
use super::real::{SMALLEST, constants, real};
use super::section::{air_density, gust_inputs, onset_bounds, search_limit, wind_speed};
use super::{ComputedNumber, Response, Role, StartValue, Variable};
use super::{bridge_states, dampers};
use crate::bridge_options::BridgeOptions;
use crate::error::Result;
use crate::response::Stepper;
use crate::section::Dof;
use crate::si;
use crate::trained_model::TrainedModel;

/// All variables with their dependencies.
pub(super) fn variables(
    model: &TrainedModel,
    options: &BridgeOptions,
    stepper: &Stepper,
    turbulence: bool,
) -> Result<Vec<Variable>> {
    let mut table = vec![wind_speed(model)];
    let named = 0..options.named.len();
    table.extend(
        named
            .clone()
            .flat_map(|n| Dof::THREE.map(|dof| force(options, n, dof))),
    );
    table.extend(options.gusts.iter().flat_map(|g| gusts(options, &g.strips)));
    table.extend(named.flat_map(|n| motions(options, n)));
    table.extend((0..options.modes.len()).flat_map(|m| mode(options, m)));
    table.extend(dampers::strokes(&options.dampers));
    table.extend(parameters(options, turbulence));
    table.push(search_limit(model));
    table.extend((0..options.modes.len()).map(|m| initial(options, m)));
    table.extend(SEARCHED.iter().map(ComputedNumber::variable));
    let filters = stepper.section().aerodynamics().states();
    table.extend(constants(&[model], filters)?);
    let interval = options.onset_interval.iter();
    table.extend(interval.flat_map(|b| onset_bounds(b, "bridge")));
    table.extend(OF_THE_PRESENT.iter().map(ComputedNumber::variable));
    bridge_states::add(&mut table, options, stepper);
    if options.structure_alone {
        for variable in &mut table {
            variable.is_listed = is_of_structure(variable.role);
            if variable.role == Role::WindSpeed {
                variable.value = StartValue::Real(Some(0.0));
            }
        }
    }
    Ok(table)
}

/// Whether a variable says something of a bridge without wind.
fn is_of_structure(role: Role) -> bool {
    matches!(
        role,
        Role::NodeForce(..)
            | Role::NodeMotion(..)
            | Role::Mode(_, Response::Displacement | Response::Rate)
            | Role::ModeFrequency(_)
            | Role::ModeDamping(_)
            | Role::Damper(..)
            | Role::DamperParameter(_)
            | Role::InitialMode(_)
            | Role::Filter(_)
            | Role::FilterRate(_)
    )
}

/// The gusts of every strip.
fn gusts<'a>(
    options: &'a BridgeOptions,
    strips: &'a [Vec<usize>],
) -> impl Iterator<Item = Variable> + 'a {
    strips.iter().enumerate().flat_map(|(s, nodes)| {
        let ends = [nodes.first(), nodes.last()].map(|n| n.map(|n| &options.nodes[*n].name));
        let location = match ends {
            [Some(a), Some(b)] if a != b => format!(", at the nodes {a} to {b}"),
            [Some(a), _] => format!(", at node {a}"),
            _ => String::new(),
        };
        gust_inputs(s, |of| format!("strip[{}].{of}", s + 1)).map(|mut v| {
            v.description.push_str(&location);
            v
        })
    })
}

/// What may change while it runs.
fn parameters(options: &BridgeOptions, turbulence: bool) -> Vec<Variable> {
    let density = air_density().start(options.air_density_kg_m3);
    let factor = real(
        "turbulence_factor",
        Role::TurbulenceFactor,
        "Factor on the turbulence in the archive, which begins at the time zero and repeats itself",
    )
    .start(1.0);
    let modes = options.modes.iter().enumerate().flat_map(|(m, mode)| {
        let parameter =
            |of, role, text: &str| real(format!("mode[{}].{of}", mode.number), role, text);
        let (frequency, damping) = (Role::ModeFrequency(m), Role::ModeDamping(m));
        [
            parameter("frequency", frequency, "Natural frequency without wind")
                .quantity("Frequency", Some(&si::HERTZ))
                .min(SMALLEST)
                .start(mode.frequency_hz),
            parameter(
                "damping_ratio",
                damping,
                "Structural damping as a ratio to critical",
            )
            .quantity("DampingRatio", None)
            .min(0.0)
            .start(mode.damping_ratio),
        ]
    });
    std::iter::once(density)
        .chain(turbulence.then_some(factor))
        .chain(modes)
        .chain(dampers::parameters(&options.dampers))
        .collect()
}

/// Where a node is, in words.
fn location(options: &BridgeOptions, named: usize) -> String {
    let node = &options.nodes[options.named[named]];
    format!("at node {}, {} m along the girder", node.name, node.along_m)
}

fn force(options: &BridgeOptions, named: usize, dof: Dof) -> Variable {
    let (unit, quantity, what) = match dof {
        Dof::Vertical => (&si::NEWTON, "Force", "vertical force, positive up"),
        Dof::Lateral => (&si::NEWTON, "Force", "lateral force, positive downwind"),
        Dof::Torsion => (&si::NEWTON_METRE, "Torque", "moment, positive nose-up"),
    };
    let name = format!(
        "node[{}].external_{}",
        options.node_name(named),
        names_of(dof).force_name
    );
    let text = format!("External {what}, {}", location(options, named));
    real(name, Role::NodeForce(named, dof), text)
        .start(0.0)
        .quantity(quantity, Some(unit))
}

fn motions(options: &BridgeOptions, named: usize) -> impl Iterator<Item = Variable> + '_ {
    let each = Dof::THREE
        .into_iter()
        .flat_map(|dof| Response::MOTION.map(|response| (dof, response)));
    each.map(move |(dof, response)| {
        let w = names_of(dof);
        let name = format!("node[{}].{}", options.node_name(named), w.name(response));
        let text = format!("{}, {}", w.describe(response), location(options, named));
        real(name, Role::NodeMotion(named, response, dof), text).measured_as(response, dof)
    })
}

fn mode(options: &BridgeOptions, m: usize) -> [Variable; 3] {
    let of = &options.modes[m];
    let number = of.number;
    let coordinate = format!(
        "Coordinate of mode {number} ({} Hz, generalised mass {} kg)",
        of.frequency_hz, of.generalised_mass
    );
    let rate = format!("Rate of the coordinate of mode {number}, per second");
    let force = format!(
        "Self-excited generalised force on mode {number}: work per unit of its coordinate, added mass included"
    );
    [
        ("coordinate", Response::Displacement, coordinate),
        ("rate", Response::Rate, rate),
        ("force", Response::SelfExcitedForce, force),
    ]
    .map(|(name, which, text)| real(format!("mode[{number}].{name}"), Role::Mode(m, which), text))
}

fn initial(options: &BridgeOptions, m: usize) -> Variable {
    let number = options.modes[m].number;
    let name = format!("mode[{number}].initial_coordinate");
    let text = format!("At release: coordinate of mode {number}");
    real(name, Role::InitialMode(m), text).start(options.initial[m])
}
