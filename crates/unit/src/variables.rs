//! The one variable table of an exported unit.
//!
//! Value references, getters and setters, `modelDescription.xml`, the digest that ties binary and archive together and
//! the documentation page are all made from it. The value reference of a variable is its index in the table, over all
//! types.

mod bridge;
mod bridge_states;
mod computed;
mod computed_rows;
mod dampers;
mod dof_names;
mod dual;
mod force;
mod listing;
mod parameters;
mod real;
mod response;
mod section;
#[cfg(test)]
mod tests;
mod variable;

pub use super::standard::{Causality, Initial, Variability};
pub use computed::{ComputedNumber, Formula, Known, OnsetNumbers, Present};
pub(crate) use computed_rows::{LINEAR_ROTATION_RAD, fill_computed_dependencies};
pub use dual::Dual;
pub(crate) use force::{StripState, strip_states};
pub use parameters::SectionParameter;
pub use response::Response;
pub use variable::{Dependency, DependencyKind, Role, StartValue, StripParameter, Variable};

use super::bridge_options::BridgeOptions;
use super::force_options::ForceOptions;
use super::onset_bounds::OnsetBounds;
use crate::aerodynamics::GustForce;
use crate::error::{Error, Result};
use crate::response::Stepper;
use crate::section::Dof;
use crate::trained_model::TrainedModel;

/// The variables of an exported section; see the module.
#[derive(Debug, Clone, PartialEq)]
pub struct VariableTable {
    variables: Vec<Variable>,
    /// What the data leave open of the onset of what was exported, where that is known.
    pub(crate) onset_bounds: Option<OnsetBounds>,
}

impl VariableTable {
    /// The table of a trained model: of its coupled section or, with options, of its forces alone; with gusts where their
    /// forces are known, with the interval of the onset where that is known (of a section alone).
    ///
    /// # Errors
    /// [`Error::Input`] when a start value is not finite or outside the limits of its variable.
    pub fn new(
        model: &TrainedModel,
        force: Option<&ForceOptions>,
        gusts: Option<&GustForce>,
        bounds: Option<OnsetBounds>,
    ) -> Result<Self> {
        let variables = match force {
            None => section::variables(model, gusts, bounds.as_ref())?,
            Some(options) => force::variables(model, options, gusts)?,
        };
        Self::checked(variables, bounds.as_ref())
    }

    /// The table of a whole bridge that is stepped by `stepper`, with or without turbulence of its own.
    ///
    /// # Errors
    /// [`Error::Input`] when a start value is not finite or outside the limits of its variable.
    pub fn of_bridge(
        model: &TrainedModel,
        options: &BridgeOptions,
        stepper: &Stepper,
        turbulence: bool,
    ) -> Result<Self> {
        let variables = bridge::variables(model, options, stepper, turbulence)?;
        Self::checked(variables, options.onset_interval.as_ref())
    }

    /// The same table with one more number, of forces alone one for each strip; for units that run in this process.
    #[must_use]
    pub fn with_number(mut self, number: &'static ComputedNumber) -> Self {
        let strips = self.variables.iter().filter_map(|v| match v.role {
            Role::Strip(s, StripParameter::Width) => Some((s, v.name.strip_suffix("width")?)),
            _ => None,
        });
        let mut rows: Vec<Variable> = strips.map(|(s, of)| number.of_strip(s, of)).collect();
        if rows.is_empty() {
            rows.push(number.variable());
        }
        self.variables.extend(rows);
        fill_computed_dependencies(&mut self.variables);
        self
    }

    fn checked(variables: Vec<Variable>, bounds: Option<&OnsetBounds>) -> Result<Self> {
        variables.iter().try_for_each(check_start)?;
        Ok(Self {
            variables,
            onset_bounds: bounds.cloned(),
        })
    }

    /// The variables; the index of each is its value reference.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// The same, for their dependencies to be entered.
    pub(crate) fn variables_mut(&mut self) -> &mut [Variable] {
        &mut self.variables
    }

    /// Index of the variable with this role.
    pub fn find(&self, role: Role) -> Option<usize> {
        self.variables.iter().position(|v| v.role == role)
    }

    /// Index of the variable with this name.
    pub fn find_name(&self, name: &str) -> Option<usize> {
        self.variables.iter().position(|v| v.name == name)
    }

    /// Rates of the continuous states in the order of the states; none where an importer cannot integrate them.
    pub fn state_rates(&self) -> Vec<usize> {
        state_rates(&self.variables)
    }

    /// Degrees of freedom in the order of every matrix.
    pub fn dofs(&self) -> Vec<Dof> {
        self.variables
            .iter()
            .filter_map(|v| match v.role {
                Role::ExternalForce(dof) => Some(dof),
                _ => None,
            })
            .collect()
    }
}

/// Displacements come first, then rates, then filters.
fn state_rates(variables: &[Variable]) -> Vec<usize> {
    let rank = |index: &usize| match variables[*index].role {
        Role::Response(Response::Rate, _) => 0,
        Role::Response(..) => 1,
        _ => 2,
    };
    let mut rates: Vec<usize> = (0..variables.len())
        .filter(|i| variables[*i].derivative_of.is_some())
        .collect();
    rates.sort_by_key(rank);
    rates
}

/// No checker looks whether a start value lies between minimum and maximum, so it is done here.
fn check_start(variable: &Variable) -> Result<()> {
    let StartValue::Real(Some(start)) = variable.value else {
        return Ok(());
    };
    let above = variable.min.is_none_or(|min| start >= min);
    let below = variable.max.is_none_or(|max| start <= max);
    if start.is_finite() && above && below {
        return Ok(());
    }
    let limit = |value: Option<f64>| value.map_or_else(|| "none".into(), |v| v.to_string());
    let [min, max] = [variable.min, variable.max].map(limit);
    Err(Error::input(
        format!("start value of {}", variable.name),
        format!("a finite number (minimum {min}, maximum {max})"),
        start.to_string(),
    ))
}
