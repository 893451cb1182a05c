//! The variables of the coupled section, in the order of the table.

use super::computed_rows::{OF_THE_PRESENT, SEARCHED};
use super::dof_names::{DofNames, names_of};
use super::parameters::SectionParameter;
use super::real::{SMALLEST, SPEED, constants, force_scale, nominal, real};
use super::{ComputedNumber, Response, Role, Variable};
use crate::aerodynamics::{GustComponent, GustForce, Realizable, Realization};
use crate::error::Result;
use crate::onset_bounds::OnsetBounds;
use crate::section::{Dof, SectionModel};
use crate::si::{self, SiUnit};
use crate::trained_model::{Model, TrainedModel};

/// Usual size of filter states: dimensionless motion of some hundredths.
const FILTER_SIZE: f64 = 0.01;
/// Smallest inertia per length, kg·m²/m.
const SMALLEST_INERTIA: f64 = 1e-9;

/// Variables of a section of five filters a motion, about: room for more is made.
const USUAL_VARIABLES: usize = 80;

/// All variables without their dependencies.
pub(super) fn variables(
    model: &TrainedModel,
    gusts: Option<&GustForce>,
    bounds: Option<&OnsetBounds>,
) -> Result<Vec<Variable>> {
    let dofs = model.section.dofs();
    let realization = model.model.realize();
    let mut table = Vec::with_capacity(USUAL_VARIABLES);
    table.extend(inputs(model, &dofs));
    if gusts.is_some() {
        table.extend(gust_inputs(0, str::to_owned));
    }
    table.extend(outputs(model, &dofs));
    let parameters = SectionParameter::all(&model.section).into_iter();
    table.extend(parameters.map(|p| section_parameter(p, &model.section)));
    table.extend(dofs.iter().flat_map(|&dof| initial_values(dof, model)));
    table.push(search_limit(model));
    table.extend(SEARCHED.iter().map(ComputedNumber::variable));
    table.extend(constants(&[model], realization.states())?);
    table.extend(bounds.into_iter().flat_map(|b| onset_bounds(b, "section")));
    table.extend(OF_THE_PRESENT.iter().map(ComputedNumber::variable));
    if let Realization::Continuous(c) = realization {
        let (filters, lags) = (c.a.nrows(), gusts.map_or(0, GustForce::states));
        table.extend((0..filters).flat_map(|i| filter(i, &format!("filter[{}]", i + 1))));
        let lag = |i| gust_filter(filters + i, &format!("gust_filter[{}]", i + 1));
        table.extend((0..lags).flat_map(lag));
        name_rates(&mut table);
    }
    Ok(table)
}

/// The interval that the data leave of the onset of a section or bridge.
pub(super) fn onset_bounds(bounds: &OnsetBounds, of: &str) -> [Variable; 2] {
    let end = |name, end, value| {
        let text = format!(
            "{end} end of the 95 % interval of the flutter onset by the scatter of the data and the form of the model, for the {of} as exported"
        );
        real(name, Role::Constant, text)
            .start(value)
            .quantity("Velocity", SPEED)
    };
    [
        end("onset_speed_low", "Lower", bounds.low_m_s),
        end("onset_speed_high", "Upper", bounds.high_m_s),
    ]
}

/// The gusts at a strip.
pub(super) fn gust_inputs(strip: usize, name: impl Fn(&str) -> String) -> [Variable; 2] {
    let along = "Turbulence along the mean wind, on top of it";
    [
        (GustComponent::Along, "gust_u", along),
        (GustComponent::Vertical, "gust_w", "Turbulence upwards"),
    ]
    .map(|(of, plain, text)| {
        real(name(plain), Role::Gust(strip, of), text)
            .start(0.0)
            .quantity("Velocity", SPEED)
            .nominal(1.0)
    })
}

/// A filter state and its rate: for importers that integrate, and for linear state spaces.
pub(super) fn filter(i: usize, name: &str) -> [Variable; 2] {
    let text = "Filter state of the aerodynamic model";
    let [state, rate] = inner_state(i, name, text);
    [
        state.quantity("FilterState", None).nominal(FILTER_SIZE),
        rate.quantity("FilterRate", Some(&si::PER_SECOND)),
    ]
}

/// The same of a gust that acts through a lag.
pub(super) fn gust_filter(i: usize, name: &str) -> [Variable; 2] {
    let text = "Gust behind a lag of its admittance, in m/s";
    let [state, rate] = inner_state(i, name, text);
    [
        state.quantity("Velocity", SPEED).nominal(1.0),
        rate.quantity("Acceleration", Some(&si::METRE_PER_SECOND2)),
    ]
}

fn inner_state(i: usize, name: &str, text: &str) -> [Variable; 2] {
    [
        real(name, Role::Filter(i), text),
        real(
            format!("der({name})"),
            Role::FilterRate(i),
            "Rate of that state",
        ),
    ]
}

/// Enters which variable is the rate of which state: that before it.
pub(super) fn name_rates(table: &mut [Variable]) {
    for (before, variable) in table[1..].iter_mut().enumerate() {
        if let Role::Response(Response::Rate | Response::Acceleration, _) | Role::FilterRate(_) =
            variable.role
        {
            variable.derivative_of = Some(before);
        }
    }
}

pub(super) fn wind_speed(model: &TrainedModel) -> Variable {
    let text = "Mean wind speed V, normal to the span";
    real("wind_speed", Role::WindSpeed, text)
        .start(model.experiment.wind_speed_m_s)
        .quantity("Velocity", SPEED)
        .min(0.0)
        .nominal(10.0)
}

/// Moments of a section that states its axis are about that.
fn force_words(model: &TrainedModel, w: &DofNames) -> String {
    match model.section.axis_offset_m {
        Some(_) => w
            .force
            .replace("the reference point", "the axis of rotation"),
        None => w.force.to_owned(),
    }
}

fn inputs(model: &TrainedModel, dofs: &[Dof]) -> Vec<Variable> {
    let external = dofs.iter().map(|&dof| {
        let w = names_of(dof);
        let text = format!("External {}", force_words(model, w));
        real(
            format!("external_{}", w.force_name),
            Role::ExternalForce(dof),
            text,
        )
        .start(0.0)
        .measured_as(Response::SelfExcitedForce, dof)
        .nominal(force_scale(model, dof))
    });
    std::iter::once(wind_speed(model)).chain(external).collect()
}

fn outputs(model: &TrainedModel, dofs: &[Dof]) -> Vec<Variable> {
    let sampling = match &model.model {
        Model::DiscreteLaguerre(m) => format!(
            "; sampled and held over internal steps of delta_s*B/V, delta_s = {}",
            m.delta_s
        ),
        _ => String::new(),
    };
    dofs.iter()
        .flat_map(|&dof| Response::ALL.map(|response| (dof, response)))
        .map(|(dof, response)| {
            let w = names_of(dof);
            let text = match response {
                Response::SelfExcitedForce => {
                    let force = force_words(model, w);
                    format!("Self-excited {force}, added mass included{sampling}")
                }
                motion => w.describe(motion),
            };
            real(w.name(response), Role::Response(response, dof), text)
                .measured_as(response, dof)
                .nominal(nominal(model, dof, response))
        })
        .collect()
}

/// Density of the air, of a unit of any kind; without a start value.
pub(super) fn air_density() -> Variable {
    real(
        "air_density",
        Role::Section(SectionParameter::AirDensity),
        "Air density rho",
    )
    .quantity("Density", Some(&si::KILOGRAM_PER_METRE3))
    .min(SMALLEST)
}

fn section_parameter(parameter: SectionParameter, section: &SectionModel) -> Variable {
    let variable = |name: String, text: &str| real(name, Role::Section(parameter), text);
    let of_support = |dof: Dof, of: &str, text: &str| {
        let motion = match dof {
            Dof::Torsion => "torsional",
            other => other.name(),
        };
        variable(
            format!("{}_{of}", names_of(dof).support),
            &format!("{text}, {motion} motion"),
        )
        .min(0.0)
    };
    let metre: Option<&SiUnit> = Some(&si::METRE);
    match parameter {
        SectionParameter::AxisOffset => variable(
            "axis_offset".into(),
            "Axis about which the section turns, to which heave, lift and moment belong: distance from the reference point of the aerodynamic forces, positive downwind",
        )
        .quantity("Length", metre),
        SectionParameter::MassOffset => variable(
            "mass_offset".into(),
            "Centre of mass: distance from the axis, positive downwind",
        )
        .quantity("Length", metre),
        SectionParameter::Width => variable("width".into(), "Full deck width B")
            .quantity("Length", metre)
            .min(SMALLEST),
        SectionParameter::AirDensity => air_density(),
        SectionParameter::Inertia(dof) => {
            let (min, text) = match dof {
                Dof::Vertical => (SMALLEST, "Mass per unit length of span, vertical motion"),
                Dof::Lateral => (SMALLEST, "Mass per unit length of span, lateral motion"),
                Dof::Torsion => (SMALLEST_INERTIA, "Mass moment of inertia per unit length of span"),
            };
            let w = names_of(dof);
            variable(w.inertia.into(), text)
                .quantity(w.inertia_quantity, Some(w.inertia_unit))
                .min(min)
        }
        SectionParameter::Frequency(dof) => of_support(dof, "frequency", "Natural frequency in still air")
            .quantity("Frequency", Some(&si::HERTZ)),
        SectionParameter::DampingRatio(dof) => {
            of_support(dof, "damping_ratio", "Structural damping as a ratio to critical")
                .quantity("DampingRatio", None)
        }
    }
    .start(parameter.value_in(section))
}

/// Displacement and rate at release.
fn initial_values(dof: Dof, model: &TrainedModel) -> [Variable; 2] {
    let w = names_of(dof);
    let release = match dof {
        Dof::Vertical => model.experiment.initial_vertical_m,
        Dof::Lateral => 0.0,
        Dof::Torsion => model.experiment.initial_rotation_rad,
    };
    let variable = |response, start: f64, role: Role, what: &str| {
        let text = format!("At release: {what}{}", w.motion);
        real(format!("initial_{}", w.name(response)), role, text)
            .start(start)
            .measured_as(response, dof)
    };
    let displacement = Role::InitialDisplacement(dof);
    [
        variable(Response::Displacement, release, displacement, ""),
        variable(Response::Rate, 0.0, Role::InitialRate(dof), "rate of the "),
    ]
}

pub(super) fn search_limit(model: &TrainedModel) -> Variable {
    let text = "Flutter onset and divergence are searched up to this wind speed";
    real("onset_search_limit", Role::OnsetSearchLimit, text)
        .start(model.experiment.onset_search_limit_m_s)
        .quantity("Velocity", SPEED)
        .min(SMALLEST)
}
