//! Real variables, and the constants that every exported unit has.

use super::parameters::SectionParameter;
use super::{Causality, Initial, Response, Role, StartValue, Variability, Variable};
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::si::{self, SiUnit};
use crate::standard::{each_once, printable};
use crate::trained_model::TrainedModel;
use std::f64::consts::TAU;

/// Smallest width, density and mass: positive, and small enough for any model deck.
pub(super) const SMALLEST: f64 = 1e-6;

/// A real variable without start, unit or limits.
pub(super) fn real(
    name: impl Into<String>,
    role: Role,
    description: impl Into<String>,
) -> Variable {
    let (causality, variability) = role.kind();
    let initial = match (causality, variability) {
        (Causality::Input, _) => None,
        (Causality::Parameter, _) | (_, Variability::Constant) => Some(Initial::Exact),
        _ => Some(Initial::Calculated),
    };
    Variable {
        name: name.into(),
        description: description.into(),
        role,
        is_listed: true,
        causality,
        variability,
        initial,
        value: StartValue::Real(None),
        unit: None,
        display_unit: None,
        quantity: None,
        min: None,
        max: None,
        nominal: None,
        derivative_of: None,
        direct_inputs: Vec::new(),
        initial_dependencies: Vec::new(),
    }
}

impl Variable {
    pub(super) fn start(mut self, value: f64) -> Self {
        self.value = StartValue::Real(Some(value));
        self
    }

    pub(super) fn quantity(
        mut self,
        quantity: &'static str,
        unit: Option<&'static SiUnit>,
    ) -> Self {
        (self.quantity, self.unit) = (Some(quantity), unit);
        self
    }

    /// Shown in the first display unit of its unit, if there is one and where that is wanted: degrees help, kilometres per hour of a
    /// vibrating deck do not.
    pub(super) fn shown_if(mut self, wanted: bool) -> Self {
        let display = self.unit.and_then(|u| u.display.first());
        self.display_unit = display.filter(|_| wanted).map(|(name, _)| *name);
        self
    }

    pub(super) fn min(mut self, min: f64) -> Self {
        self.min = Some(min);
        self
    }

    pub(super) fn max(mut self, max: f64) -> Self {
        self.max = Some(max);
        self
    }

    pub(super) fn nominal(mut self, size: f64) -> Self {
        self.nominal = Some(size);
        self
    }
}

pub(super) const SPEED: Option<&SiUnit> = Some(&si::METRE_PER_SECOND);

/// `filters` is the number of the states of the forces, the largest of several models.
pub(super) fn constants(models: &[&TrainedModel], filters: usize) -> Result<Vec<Variable>> {
    let constant = |name, value, text: &str| Variable {
        value,
        ..real(name, Role::Constant, text)
    };
    // as the description can say it
    let text = |text: &str| StartValue::String(printable(text));
    let states = i32::try_from(filters)
        .map_err(|_| Error::input("model", "fewer filter states", filters.to_string()))?;
    let version = env!("CARGO_PKG_VERSION");
    let words = |of: fn(&TrainedModel) -> &str| text(&each_once(models.iter().map(|m| of(m))));
    Ok(vec![
        constant(
            "filters",
            StartValue::Integer(Some(states)),
            "Number of filter states of the aerodynamic model",
        ),
        constant(
            "model_kind",
            words(|m| m.model.kind()),
            "Kind of the aerodynamic model",
        ),
        constant(
            "model_name",
            words(|m| &m.name),
            "Name of the trained model",
        ),
        constant(
            "aerodeck_version",
            text(version),
            "Version of the program that made this unit",
        ),
    ])
}

/// Usual size: displacements of 2 % of the width and rotations of 1°, at the still-air frequency.
pub(super) fn nominal(model: &TrainedModel, dof: Dof, response: Response) -> f64 {
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
pub(super) fn force_scale(model: &TrainedModel, dof: Dof) -> f64 {
    let inertia = SectionParameter::Inertia(dof).value_in(&model.section);
    power_of_ten(inertia * nominal(model, dof, Response::Acceleration))
}

/// The power of ten nearest to `x` on a logarithmic scale; one when `x` is no positive number.
pub(super) fn power_of_ten(x: f64) -> f64 {
    // through text, because 10f64.powi rounds
    format!("1e{}", x.log10().round() as i32)
        .parse()
        .ok()
        .filter(|p: &f64| x > 0.0 && p.is_normal())
        .unwrap_or(1.0)
}
