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
    description: impl Into<String>,
) -> Variable {
    let initial = match causality {
        Causality::Input => None,
        Causality::Parameter => Some(Initial::Exact),
        _ => Some(Initial::Calculated),
    };
    Variable {
        name,
        description: description.into(),
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

impl Variable {
    fn start(mut self, value: f64) -> Self {
        self.value = Value::Real(Some(value));
        self
    }

    fn quantity(mut self, quantity: &'static str, unit: Option<&'static Unit>) -> Self {
        (self.quantity, self.unit) = (Some(quantity), unit);
        self
    }

    /// Shown in the first display unit of its unit, if there is one.
    fn shown(mut self) -> Self {
        let display = self.unit.and_then(|u| u.display.first());
        self.display_unit = display.map(|d| d.name);
        self
    }

    /// Degrees help, kilometres per hour of a vibrating deck do not.
    fn shown_if(self, wanted: bool) -> Self {
        if wanted { self.shown() } else { self }
    }

    fn min(mut self, min: f64) -> Self {
        self.min = Some(min);
        self
    }

    fn nominal(mut self, size: f64) -> Self {
        self.nominal = Some(size);
        self
    }
}

const INPUT: (Causality, Variability) = (Causality::Input, Variability::Continuous);
const OUTPUT: (Causality, Variability) = (Causality::Output, Variability::Continuous);
const TUNABLE: (Causality, Variability) = (Causality::Parameter, Variability::Tunable);
const FIXED: (Causality, Variability) = (Causality::Parameter, Variability::Fixed);
const CALCULATED: (Causality, Variability) = (Causality::CalculatedParameter, Variability::Tunable);
const LOCAL: (Causality, Variability) = (Causality::Local, Variability::Constant);
const SPEED: Option<&Unit> = Some(&si::METRE_PER_SECOND);

fn inputs(model: &TrainedModel, dofs: &[Dof]) -> Vec<Variable> {
    let text = "Mean wind speed V, normal to the span";
    let wind = real("wind_speed", Role::WindSpeed, INPUT, text)
        .start(model.experiment.wind_speed_m_s)
        .quantity("Velocity", SPEED)
        .shown()
        .min(0.0)
        .nominal(10.0);
    let external = dofs.iter().map(|&dof| {
        let w = words(dof);
        let text = format!("External {}", w.force);
        real(w.external, Role::ExternalForce(dof), INPUT, text)
            .start(0.0)
            .quantity(w.force_quantity, Some(w.units[3]))
            .nominal(force_scale(model, dof))
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
            let role = Role::Response(response, dof);
            real(w.responses[i], role, OUTPUT, describe(response, w))
                .quantity(quantity, Some(w.units[i]))
                .shown_if(dof == Dof::Torsion)
                .nominal(nominal(model, dof, response))
        })
        .collect()
}

fn section_parameter(parameter: SectionParameter, section: &SectionModel) -> Variable {
    let variable = |name, text: &str| real(name, Role::Section(parameter), TUNABLE, text);
    let of_support = |dof, i: usize, text: &str| {
        let text = format!("{text}, {} motion", motion(dof));
        real(
            words(dof).support[i],
            Role::Section(parameter),
            TUNABLE,
            text,
        )
        .min(0.0)
    };
    let metre: Option<&Unit> = Some(&si::METRE);
    match parameter {
        SectionParameter::AxisOffset => variable(
            "axis_offset",
            "Axis about which the section turns, to which heave, lift and moment belong: distance from the reference point of the aerodynamic forces, positive downwind",
        )
        .quantity("Length", metre),
        SectionParameter::MassOffset => variable(
            "mass_offset",
            "Centre of mass: distance from the axis, positive downwind",
        )
        .quantity("Length", metre),
        SectionParameter::Width => variable("width", "Full deck width B")
            .quantity("Length", metre)
            .min(SMALLEST),
        SectionParameter::AirDensity => variable("air_density", "Air density rho")
            .quantity("Density", Some(&si::KILOGRAM_PER_METRE3))
            .min(SMALLEST),
        SectionParameter::Inertia(dof) => {
            let (min, text) = match dof {
                Dof::Vertical => (SMALLEST, "Mass per unit length of span, vertical motion"),
                Dof::Lateral => (SMALLEST, "Mass per unit length of span, lateral motion"),
                Dof::Torsion => (SMALLEST_INERTIA, "Mass moment of inertia per unit length of span"),
            };
            let w = words(dof);
            variable(w.support[0], text)
                .quantity(w.inertia_quantity, Some(w.inertia_unit))
                .min(min)
        }
        SectionParameter::Frequency(dof) => of_support(dof, 1, "Natural frequency in still air")
            .quantity("Frequency", Some(&si::HERTZ)),
        SectionParameter::DampingRatio(dof) => {
            of_support(dof, 2, "Structural damping as a ratio to critical")
                .quantity("DampingRatio", None)
        }
    }
    .start(parameter.value_in(section))
}

/// Displacement and rate at release.
fn initial_values(dof: Dof, model: &TrainedModel) -> [Variable; 2] {
    let w = words(dof);
    let release = match dof {
        Dof::Vertical => model.experiment.initial_vertical_m,
        Dof::Lateral => 0.0,
        Dof::Torsion => model.experiment.initial_rotation_rad,
    };
    let variable = |i: usize, start: f64, role: Role, what: &str| {
        let text = format!("At release: {what}{}", w.motion);
        real(w.initial[i], role, FIXED, text)
            .start(start)
            .quantity(w.quantities[i], Some(w.units[i]))
            .shown_if(dof == Dof::Torsion)
    };
    [
        variable(0, release, Role::InitialDisplacement(dof), ""),
        variable(1, 0.0, Role::InitialRate(dof), "rate of the "),
    ]
}

fn search_limit(model: &TrainedModel) -> Variable {
    let text = "Flutter onset and divergence are searched up to this wind speed";
    real("onset_search_limit", Role::OnsetSearchLimit, FIXED, text)
        .start(model.experiment.onset_search_limit_m_s)
        .quantity("Velocity", SPEED)
        .shown()
        .min(SMALLEST)
}

fn calculated_parameters() -> Vec<Variable> {
    use Calculated as C;
    let parameter = |name, what, text: &str| real(name, Role::Calculated(what), CALCULATED, text);
    let flag = |name, what, text: &str| Variable {
        value: Value::Boolean(None),
        ..parameter(name, what, text)
    };
    vec![
        parameter(
            "onset_speed",
            C::OnsetSpeed,
            "Wind speed of flutter onset for the current parameters; onset_search_limit when none was found",
        )
        .quantity("Velocity", SPEED)
        .shown(),
        parameter(
            "onset_frequency",
            C::OnsetFrequency,
            "Frequency at flutter onset; zero when none was found",
        )
        .quantity("Frequency", Some(&si::HERTZ))
        .shown(),
        parameter(
            "onset_reduced_velocity",
            C::OnsetReducedVelocity,
            "Reduced velocity V/(f*B) at flutter onset; zero when none was found",
        )
        .quantity("ReducedVelocity", None),
        parameter(
            "divergence_speed",
            C::DivergenceSpeed,
            "Wind speed of static divergence for the current parameters; onset_search_limit when none was found",
        )
        .quantity("Velocity", SPEED)
        .shown(),
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
        ..real(name, Role::Constant, LOCAL, text)
    };
    let text = |text: &str| Value::String(text.to_owned());
    let states = model.model.realize().states();
    let states = i32::try_from(states)
        .map_err(|_| Error::input("model", "fewer filter states", states.to_string()))?;
    let version = env!("CARGO_PKG_VERSION");
    Ok(vec![
        constant(
            "filters",
            Value::Integer(Some(states)),
            "Number of filter states of the aerodynamic model",
        ),
        constant(
            "model_kind",
            text(model.model.kind()),
            "Kind of the aerodynamic model",
        ),
        constant("model_name", text(&model.name), "Name of the trained model"),
        constant(
            "aerodeck_version",
            text(version),
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
