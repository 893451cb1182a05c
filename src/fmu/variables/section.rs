//! The variables of the coupled section, in the order of the table.

use super::parameters::SectionParameter;
use super::words::{Words, motion, words};
use super::{Calculated, Causality, Initial, Response, Role, Value, Variability, Variable};
use crate::aerodynamics::Realizable;
use crate::error::{Error, Result};
use crate::fmu::si::{self, Unit};
use crate::section::{Dof, SectionModel};
use crate::trained_model::{Model, TrainedModel};
use std::f64::consts::TAU;

/// Smallest width, density and mass: positive, and small enough for any model deck.
const SMALLEST: f64 = 1e-6;
/// Smallest inertia per length, kg·m²/m.
const SMALLEST_INERTIA: f64 = 1e-9;

/// All variables without their dependencies.
pub(super) fn variables(model: &TrainedModel) -> Result<Vec<Variable>> {
    let dofs = model.section.dofs();
    let mut table = inputs(model, &dofs);
    table.extend(outputs(model, &dofs));
    table.extend(
        SectionParameter::all(&model.section)
            .into_iter()
            .map(|p| section_parameter(p, &model.section)),
    );
    table.extend(dofs.iter().flat_map(|&dof| initial_values(dof, model)));
    table.push(search_limit(model));
    table.extend(calculated_parameters());
    table.extend(constants(model)?);
    Ok(table)
}

/// A real variable without start, unit or limits.
fn real(
    name: &'static str,
    role: Role,
    (causality, variability): (Causality, Variability),
    description: String,
) -> Variable {
    let initial = match causality {
        Causality::Input => None,
        Causality::Parameter => Some(Initial::Exact),
        _ => Some(Initial::Calculated),
    };
    Variable {
        name,
        description,
        role,
        causality,
        variability,
        initial,
        value: Value::Real(None),
        unit: None,
        display_unit: None,
        quantity: None,
        min: None,
        max: None,
        nominal: None,
        direct_inputs: Vec::new(),
        initial_dependencies: Vec::new(),
    }
}

const INPUT: (Causality, Variability) = (Causality::Input, Variability::Continuous);
const OUTPUT: (Causality, Variability) = (Causality::Output, Variability::Continuous);
const TUNABLE: (Causality, Variability) = (Causality::Parameter, Variability::Tunable);
const FIXED: (Causality, Variability) = (Causality::Parameter, Variability::Fixed);
const CALCULATED: (Causality, Variability) = (Causality::CalculatedParameter, Variability::Tunable);

fn inputs(model: &TrainedModel, dofs: &[Dof]) -> Vec<Variable> {
    let wind = Variable {
        value: Value::Real(Some(model.experiment.wind_speed_m_s)),
        unit: Some(&si::METRE_PER_SECOND),
        display_unit: Some("km/h"),
        quantity: Some("Velocity"),
        min: Some(0.0),
        nominal: Some(10.0),
        ..real(
            "wind_speed",
            Role::WindSpeed,
            INPUT,
            "Mean wind speed V, normal to the span".into(),
        )
    };
    let external = dofs.iter().map(|&dof| {
        let w = words(dof);
        Variable {
            value: Value::Real(Some(0.0)),
            unit: Some(w.units[3]),
            quantity: Some(w.force_quantity),
            nominal: Some(force_scale(model, dof)),
            ..real(
                w.external,
                Role::ExternalForce(dof),
                INPUT,
                format!("External {}", w.force),
            )
        }
    });
    std::iter::once(wind).chain(external).collect()
}

fn outputs(model: &TrainedModel, dofs: &[Dof]) -> Vec<Variable> {
    let held = match &model.model {
        Model::DiscreteLaguerre(m) => format!(
            "; sampled and held over internal steps of delta_s*B/V, delta_s = {}",
            m.delta_s
        ),
        _ => String::new(),
    };
    let describe = |response: Response, w: &Words| match response {
        Response::Displacement => capitalized(w.motion),
        Response::Rate => format!("Rate of the {}", w.motion),
        Response::Acceleration => format!("Second rate of the {}", w.motion),
        Response::SelfExcitedForce => {
            format!("Self-excited {}, added mass included{held}", w.force)
        }
    };
    dofs.iter()
        .flat_map(|&dof| Response::ALL.map(|response| (dof, response)))
        .map(|(dof, response)| {
            let (w, i) = (words(dof), response as usize);
            let quantity = w.quantities.get(i).copied().unwrap_or(w.force_quantity);
            Variable {
                unit: Some(w.units[i]),
                display_unit: w.units[i].display.first().and_then(|d| {
                    // degrees help, kilometres per hour of a vibrating deck do not
                    (dof == Dof::Torsion).then_some(d.name)
                }),
                quantity: Some(quantity),
                nominal: Some(nominal(model, dof, response)),
                ..real(
                    w.responses[i],
                    Role::Response(response, dof),
                    OUTPUT,
                    describe(response, w),
                )
            }
        })
        .collect()
}

fn section_parameter(parameter: SectionParameter, section: &SectionModel) -> Variable {
    let (name, unit, quantity, min, description): (_, Option<&Unit>, _, _, String) = match parameter
    {
        SectionParameter::AxisOffset => (
            "axis_offset",
            Some(&si::METRE),
            "Length",
            None,
            "Axis about which the section turns, to which heave, lift and moment belong: distance from the reference point of the aerodynamic forces, positive downwind".into(),
        ),
        SectionParameter::MassOffset => (
            "mass_offset",
            Some(&si::METRE),
            "Length",
            None,
            "Centre of mass: distance from the axis, positive downwind".into(),
        ),
        SectionParameter::Width => (
            "width",
            Some(&si::METRE),
            "Length",
            Some(SMALLEST),
            "Full deck width B".into(),
        ),
        SectionParameter::AirDensity => (
            "air_density",
            Some(&si::KILOGRAM_PER_METRE3),
            "Density",
            Some(SMALLEST),
            "Air density rho".into(),
        ),
        SectionParameter::Inertia(dof) => {
            let w = words(dof);
            let min = if dof == Dof::Torsion {
                SMALLEST_INERTIA
            } else {
                SMALLEST
            };
            let text = match dof {
                Dof::Vertical => "Mass per unit length of span, vertical motion",
                Dof::Lateral => "Mass per unit length of span, lateral motion",
                Dof::Torsion => "Mass moment of inertia per unit length of span",
            };
            (
                w.support[0],
                Some(w.inertia_unit),
                w.inertia_quantity,
                Some(min),
                text.into(),
            )
        }
        SectionParameter::Frequency(dof) => (
            words(dof).support[1],
            Some(&si::HERTZ),
            "Frequency",
            Some(0.0),
            format!("Natural frequency in still air, {} motion", motion(dof)),
        ),
        SectionParameter::DampingRatio(dof) => (
            words(dof).support[2],
            None,
            "DampingRatio",
            Some(0.0),
            format!(
                "Structural damping as a ratio to critical, {} motion",
                motion(dof)
            ),
        ),
    };
    Variable {
        value: Value::Real(Some(parameter.value_in(section))),
        unit,
        quantity: Some(quantity),
        min,
        ..real(name, Role::Section(parameter), TUNABLE, description)
    }
}

fn initial_values(dof: Dof, model: &TrainedModel) -> [Variable; 2] {
    let w = words(dof);
    let release = match dof {
        Dof::Vertical => model.experiment.initial_vertical_m,
        Dof::Lateral => 0.0,
        Dof::Torsion => model.experiment.initial_rotation_rad,
    };
    let variable = |i: usize, start: f64, role: Role, description: String| Variable {
        value: Value::Real(Some(start)),
        unit: Some(w.units[i]),
        display_unit: (dof == Dof::Torsion)
            .then(|| w.units[i].display.first().map(|d| d.name))
            .flatten(),
        quantity: Some(w.quantities[i]),
        ..real(w.initial[i], role, FIXED, description)
    };
    [
        variable(
            0,
            release,
            Role::InitialDisplacement(dof),
            format!("At release: {}", w.motion),
        ),
        variable(
            1,
            0.0,
            Role::InitialRate(dof),
            format!("At release: rate of the {}", w.motion),
        ),
    ]
}

fn search_limit(model: &TrainedModel) -> Variable {
    Variable {
        value: Value::Real(Some(model.experiment.onset_search_limit_m_s)),
        unit: Some(&si::METRE_PER_SECOND),
        display_unit: Some("km/h"),
        quantity: Some("Velocity"),
        min: Some(SMALLEST),
        ..real(
            "onset_search_limit",
            Role::OnsetSearchLimit,
            FIXED,
            "Flutter onset and divergence are searched up to this wind speed".into(),
        )
    }
}

fn calculated_parameters() -> Vec<Variable> {
    use Calculated as C;
    let number = |name, what, unit: Option<&'static Unit>, quantity, text: &str| Variable {
        unit,
        display_unit: unit.and_then(|u| u.display.first()).map(|d| d.name),
        quantity: Some(quantity),
        ..real(name, Role::Calculated(what), CALCULATED, text.into())
    };
    let flag = |name, what, text: &str| Variable {
        value: Value::Boolean(None),
        ..real(name, Role::Calculated(what), CALCULATED, text.into())
    };
    let speed = Some(&si::METRE_PER_SECOND);
    vec![
        number(
            "onset_speed",
            C::OnsetSpeed,
            speed,
            "Velocity",
            "Wind speed of flutter onset for the current parameters; onset_search_limit when none was found",
        ),
        number(
            "onset_frequency",
            C::OnsetFrequency,
            Some(&si::HERTZ),
            "Frequency",
            "Frequency at flutter onset; zero when none was found",
        ),
        number(
            "onset_reduced_velocity",
            C::OnsetReducedVelocity,
            None,
            "ReducedVelocity",
            "Reduced velocity V/(f*B) at flutter onset; zero when none was found",
        ),
        number(
            "divergence_speed",
            C::DivergenceSpeed,
            speed,
            "Velocity",
            "Wind speed of static divergence for the current parameters; onset_search_limit when none was found",
        ),
        flag(
            "onset_found",
            C::OnsetFound,
            "Whether a flutter onset was found up to onset_search_limit",
        ),
        flag(
            "onset_in_tested_range",
            C::OnsetInTestedRange,
            "Whether the reduced frequency at onset lies in the tested range of the model",
        ),
        flag(
            "divergence_found",
            C::DivergenceFound,
            "Whether divergence was found up to onset_search_limit",
        ),
    ]
}

fn constants(model: &TrainedModel) -> Result<Vec<Variable>> {
    let constant = |name, value, text: &str| Variable {
        initial: Some(Initial::Exact),
        value,
        ..real(
            name,
            Role::Constant,
            (Causality::Local, Variability::Constant),
            text.into(),
        )
    };
    let states = model.model.realize().states();
    let states = i32::try_from(states)
        .map_err(|_| Error::input("model", "fewer filter states", states.to_string()))?;
    Ok(vec![
        constant(
            "filters",
            Value::Integer(Some(states)),
            "Number of filter states of the aerodynamic model",
        ),
        constant(
            "model_kind",
            Value::String(model.model.kind().into()),
            "Kind of the aerodynamic model",
        ),
        constant(
            "model_name",
            Value::String(model.name.clone()),
            "Name of the trained model",
        ),
        constant(
            "aerodeck_version",
            Value::String(env!("CARGO_PKG_VERSION").into()),
            "Version of the program that made this unit",
        ),
    ])
}

fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map_or_else(String::new, |c| c.to_uppercase().chain(letters).collect())
}

/// Usual size: displacements of 2 % of the width and rotations of 1°, at the still-air frequency.
fn nominal(model: &TrainedModel, dof: Dof, response: Response) -> f64 {
    let size = if dof == Dof::Torsion {
        1f64.to_radians()
    } else {
        0.02 * model.section.width_m
    };
    let omega = TAU * SectionParameter::Frequency(dof).value_in(&model.section);
    match response {
        Response::Displacement => power_of_ten(size),
        Response::Rate => power_of_ten(size * omega),
        Response::Acceleration => power_of_ten(size * omega * omega),
        Response::SelfExcitedForce => force_scale(model, dof),
    }
}

/// Usual size of forces: inertia times the usual acceleration.
fn force_scale(model: &TrainedModel, dof: Dof) -> f64 {
    let inertia = SectionParameter::Inertia(dof).value_in(&model.section);
    power_of_ten(inertia * nominal(model, dof, Response::Acceleration))
}

/// The power of ten nearest to `x` on a logarithmic scale; one when `x` is no positive number.
fn power_of_ten(x: f64) -> f64 {
    // through text, because 10f64.powi rounds
    format!("1e{}", x.log10().round() as i32)
        .parse()
        .ok()
        .filter(|p: &f64| x > 0.0 && p.is_normal())
        .unwrap_or(1.0)
}
