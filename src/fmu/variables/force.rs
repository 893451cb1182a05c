//! The variables of a unit of forces, in the order of the table.

use super::real::{FIXED, INPUT, OUTPUT, SMALLEST, TUNABLE, constants, force_scale, nominal, real};
use super::section::{capitalized, gust_inputs, wind_speed};
use super::words::words;
use super::{
    ForceOutput, InitialDependency, Response, Role, SectionParameter, StripParameter, Variable,
};
use crate::aerodynamics::GustForce;
use crate::error::Result;
use crate::fmu::force_options::{ForceOptions, MAX_PREDICTION};
use crate::fmu::si::{self, Unit};
use crate::section::Dof;
use crate::trained_model::TrainedModel;

/// All variables with their dependencies.
pub(super) fn variables(
    model: &TrainedModel,
    options: &ForceOptions,
    gusts: Option<&GustForce>,
) -> Result<Vec<Variable>> {
    let dofs = model.section.dofs();
    let mut table = vec![wind_speed(model)];
    for (s, _) in options.strips.iter().enumerate() {
        table.extend(motion(model, &dofs, s, options));
        table.extend(
            gusts
                .iter()
                .flat_map(|_| gust_inputs(s, |of| name(options, s, of))),
        );
    }
    for (s, _) in options.strips.iter().enumerate() {
        table.extend(forces(model, &dofs, s, options));
    }
    table.push(
        real(
            "air_density",
            Role::Section(SectionParameter::AirDensity),
            TUNABLE,
            "Air density rho",
        )
        .quantity("Density", Some(&si::KILOGRAM_PER_METRE3))
        .min(SMALLEST)
        .start(model.section.air_density_kg_m3),
    );
    for s in 0..options.strips.len() {
        table.extend(strip(s, options));
    }
    table.extend(coupling(options));
    table.extend(constants(model)?);
    fill_dependencies(&mut table, options.strips.len());
    Ok(table)
}

/// Name of a variable of a strip.
fn name(options: &ForceOptions, s: usize, of: &str) -> String {
    if options.named_strips {
        format!("strip[{}].{of}", s + 1)
    } else {
        of.to_owned()
    }
}

fn motion<'a>(
    model: &'a TrainedModel,
    dofs: &'a [Dof],
    s: usize,
    options: &'a ForceOptions,
) -> impl Iterator<Item = Variable> + 'a {
    let each = dofs
        .iter()
        .flat_map(|&dof| Response::MOTION.map(|response| (dof, response)));
    each.map(move |(dof, response)| {
        let (w, i) = (words(dof), response as usize);
        let text = match response {
            Response::Displacement => {
                format!(
                    "{} of the deck, at the reference point of the forces",
                    capitalized(w.motion)
                )
            }
            Response::Rate => format!("Rate of the {}; need not be connected", w.motion),
            _ => format!("Second rate of the {}; need not be connected", w.motion),
        };
        let role = Role::Motion(s, response, dof);
        real(name(options, s, w.responses[i]), role, INPUT, text)
            .start(0.0)
            .quantity(w.quantities[i], Some(w.units[i]))
            .shown_if(dof == Dof::Torsion)
            .nominal(nominal(model, dof, response))
    })
}

fn forces<'a>(
    model: &'a TrainedModel,
    dofs: &'a [Dof],
    s: usize,
    options: &'a ForceOptions,
) -> impl Iterator<Item = Variable> + 'a {
    dofs.iter().flat_map(move |&dof| {
        let w = words(dof);
        let (total_unit, total_quantity): (&'static Unit, _) = match dof {
            Dof::Torsion => (&si::NEWTON_METRE, "Torque"),
            _ => (&si::NEWTON, "Force"),
        };
        let of = w.responses[3];
        let ahead = "at the instant at which it acts (see prediction)";
        let per_length = format!("Self-excited {}, {ahead}", w.force);
        let total = format!("Self-excited {of} on the length of the strip, {ahead}");
        let output = |of: String, kind, text| {
            let role = Role::Force(s, kind, dof);
            real(name(options, s, &of), role, OUTPUT, text)
        };
        [
            output(of.to_owned(), ForceOutput::PerLength, per_length)
                .quantity(w.force_quantity, Some(w.units[3]))
                .nominal(force_scale(model, dof)),
            output(format!("total_{of}"), ForceOutput::Total, total)
                .quantity(total_quantity, Some(total_unit)),
        ]
    })
}

fn strip(s: usize, options: &ForceOptions) -> [Variable; 3] {
    let of = &options.strips[s];
    let parameter = |of, which, text: &str| {
        let role = Role::Strip(s, which);
        real(name(options, s, of), role, TUNABLE, text)
    };
    let metre: Option<&Unit> = Some(&si::METRE);
    [
        parameter("width", StripParameter::Width, "Full deck width B")
            .quantity("Length", metre)
            .min(SMALLEST)
            .start(of.width_m),
        parameter(
            "length",
            StripParameter::Length,
            "Length of span of the strip",
        )
        .quantity("Length", metre)
        .min(SMALLEST)
        .start(of.length_m),
        parameter(
            "wind_factor",
            StripParameter::WindFactor,
            "Wind speed at the strip over wind_speed",
        )
        .min(0.0)
        .start(of.wind_factor),
    ]
}

/// What has to be known of the importer.
fn coupling(options: &ForceOptions) -> [Variable; 2] {
    [
        real(
            "prediction",
            Role::Prediction,
            TUNABLE,
            "The forces put out are those of this many communication steps after the motion that was set for the last \
             step: 1.5 for an explicit importer that holds them over its next step (the default), 1 for one that \
             extrapolates them from the end of the step, 0.5 for one that steps the structure first and sets the motion of \
             the end of the step, 0 for iterations within a step",
        )
        .min(0.0)
        .max(MAX_PREDICTION)
        .start(options.prediction_steps),
        real(
            "motion_derivatives",
            Role::MotionDerivatives,
            FIXED,
            "Derivatives of the motion that are set: 0 none, 1 rates, 2 rates and accelerations, -1 those that have \
             been set since the last step",
        )
        .min(-1.0)
        .max(2.0)
        .start(-1.0),
    ]
}

/// Forces follow the wind and the motion of their strip, and everything that is stated of it.
fn fill_dependencies(table: &mut [Variable], strips: usize) {
    let (mut shared, mut of_strip) = (Vec::new(), vec![Vec::new(); strips]);
    for (place, variable) in table.iter().enumerate() {
        match variable.role {
            Role::WindSpeed | Role::Section(_) | Role::MotionDerivatives => shared.push(place),
            Role::Motion(s, ..) | Role::Gust(s, _) | Role::Strip(s, _) => of_strip[s].push(place),
            _ => {}
        }
    }
    let roles: Vec<Role> = table.iter().map(|v| v.role).collect();
    for variable in table.iter_mut() {
        let Role::Force(strip, kind, _) = variable.role else {
            continue;
        };
        let known = shared.iter().chain(&of_strip[strip]).copied();
        let length = Role::Strip(strip, StripParameter::Length);
        let mut known: Vec<usize> = known
            .filter(|place| kind == ForceOutput::Total || roles[*place] != length)
            .collect();
        known.sort_unstable();
        let input = |place: &usize| {
            matches!(
                roles[*place],
                Role::WindSpeed | Role::Motion(..) | Role::Gust(..)
            )
        };
        variable.direct_inputs = known.iter().copied().filter(input).collect();
        let dependency = |on| InitialDependency {
            on,
            constant: false,
        };
        variable.initial_dependencies = known.into_iter().map(dependency).collect();
    }
}
