//! The variables of a whole bridge, in the order of the table.

use super::real::{FIXED, INPUT, OUTPUT, constants, real};
use super::section::{calculated_parameters, capitalized, search_limit, wind_speed};
use super::words::words;
use super::{InitialDependency, ModeOutput, Response, Role, Variable};
use crate::error::Result;
use crate::fmu::bridge_options::BridgeOptions;
use crate::fmu::si;
use crate::section::Dof;
use crate::trained_model::TrainedModel;

/// Motions that are put out.
const MOTION: [Response; 3] = [
    Response::Displacement,
    Response::Rate,
    Response::Acceleration,
];

/// All variables with their dependencies.
pub(super) fn variables(model: &TrainedModel, options: &BridgeOptions) -> Result<Vec<Variable>> {
    let mut table = vec![wind_speed(model)];
    let named = 0..options.named.len();
    table.extend(
        named
            .clone()
            .flat_map(|n| Dof::THREE.map(|dof| force(options, n, dof))),
    );
    table.extend(named.flat_map(|n| motions(options, n)));
    table.extend((0..options.modes.len()).flat_map(|m| mode(options, m)));
    table.push(search_limit(model));
    table.extend((0..options.modes.len()).map(|m| initial(options, m)));
    table.extend(calculated_parameters());
    table.extend(constants(model)?);
    fill_dependencies(&mut table);
    Ok(table)
}

/// Where a node is, in words.
fn place(options: &BridgeOptions, named: usize) -> String {
    let node = &options.nodes[options.named[named]];
    format!("at node {}, {} m along the girder", node.name, node.along_m)
}

fn force(options: &BridgeOptions, named: usize, dof: Dof) -> Variable {
    let (unit, quantity, what) = match dof {
        Dof::Vertical => (&si::NEWTON, "Force", "vertical force, positive up"),
        Dof::Lateral => (&si::NEWTON, "Force", "lateral force, positive downwind"),
        Dof::Torsion => (&si::NEWTON_METRE, "Torque", "moment, positive nose-up"),
    };
    let name = format!("node[{}].{}", options.node_name(named), words(dof).external);
    let text = format!("External {what}, {}", place(options, named));
    real(name, Role::NodeForce(named, dof), INPUT, text)
        .start(0.0)
        .quantity(quantity, Some(unit))
}

fn motions(options: &BridgeOptions, named: usize) -> impl Iterator<Item = Variable> + '_ {
    let each = Dof::THREE
        .into_iter()
        .flat_map(|dof| MOTION.map(|response| (dof, response)));
    each.map(move |(dof, response)| {
        let (w, i) = (words(dof), response as usize);
        let what = match response {
            Response::Displacement => capitalized(w.motion),
            Response::Rate => format!("Rate of the {}", w.motion),
            _ => format!("Second rate of the {}", w.motion),
        };
        let name = format!("node[{}].{}", options.node_name(named), w.responses[i]);
        let text = format!("{what}, {}", place(options, named));
        real(name, Role::NodeMotion(named, response, dof), OUTPUT, text)
            .quantity(w.quantities[i], Some(w.units[i]))
            .shown_if(dof == Dof::Torsion)
    })
}

fn mode(options: &BridgeOptions, m: usize) -> [Variable; 3] {
    let of = &options.modes[m];
    let number = of.number;
    let output = |name: &str, which, text: String| {
        real(
            format!("mode[{number}].{name}"),
            Role::Mode(m, which),
            OUTPUT,
            text,
        )
    };
    let coordinate = format!(
        "Coordinate of mode {number} ({} Hz, generalised mass {} kg)",
        of.frequency_hz, of.generalised_mass
    );
    [
        output("coordinate", ModeOutput::Coordinate, coordinate),
        output(
            "rate",
            ModeOutput::Rate,
            format!("Rate of the coordinate of mode {number}, per second"),
        ),
        output(
            "force",
            ModeOutput::Force,
            format!(
                "Self-excited generalised force on mode {number}: work per unit of its coordinate, added mass included"
            ),
        ),
    ]
}

fn initial(options: &BridgeOptions, m: usize) -> Variable {
    let number = options.modes[m].number;
    let name = format!("mode[{number}].initial_coordinate");
    let text = format!("At release: coordinate of mode {number}");
    real(name, Role::InitialMode(m), FIXED, text).start(options.initial[m])
}

/// Displacements and rates follow the state; accelerations and forces follow wind and external forces at once.
fn fill_dependencies(table: &mut [Variable]) {
    let places = |wanted: &dyn Fn(Role) -> bool| -> Vec<usize> {
        (0..table.len())
            .filter(|i| wanted(table[*i].role))
            .collect()
    };
    let inputs = places(&|r| matches!(r, Role::WindSpeed | Role::NodeForce(..)));
    let release = places(&|r| matches!(r, Role::InitialMode(_)));
    let limit = places(&|r| r == Role::OnsetSearchLimit);
    let mut all = [inputs.clone(), release.clone()].concat();
    all.sort_unstable();
    let dependent = |on: &[usize]| -> Vec<InitialDependency> {
        on.iter()
            .map(|on| InitialDependency {
                on: *on,
                constant: false,
            })
            .collect()
    };
    for variable in table.iter_mut() {
        (variable.direct_inputs, variable.initial_dependencies) = match variable.role {
            Role::NodeMotion(_, Response::Acceleration, _) | Role::Mode(_, ModeOutput::Force) => {
                (inputs.clone(), dependent(&all))
            }
            Role::NodeMotion(..) | Role::Mode(..) => (Vec::new(), dependent(&release)),
            Role::Calculated(_) => (Vec::new(), dependent(&limit)),
            _ => continue,
        };
    }
}
