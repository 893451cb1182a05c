//! Whether a variable may be read or set now, and what is said where it may not.

use super::Instance;
use super::layout::{Access, DataType};
use super::trust::shown;
use crate::lifecycle::StateSet;
use crate::refusal::{CallResult, Refusal};
use crate::variables::{Causality, Variability, Variable, VariableTable};

impl Instance {
    /// Access to `reference`, known by the table to be of this type.
    pub(super) fn typed(&self, reference: u32, wanted: DataType) -> CallResult<(usize, Access)> {
        let index = reference as usize;
        match self.layout.access.get(index) {
            Some(access) if access.data_type == wanted => Ok((index, *access)),
            found => Err(wrong_reference(index, found, wanted, self.table())),
        }
    }

    /// Access to a variable that may be read now.
    pub(super) fn readable(&self, reference: u32, wanted: DataType) -> CallResult<(usize, Access)> {
        let (index, access) = self.typed(reference, wanted)?;
        match access.gettable.contains(self.now.memory.state) {
            true => Ok((index, access)),
            false => Err(self.not_in_state(index, "read", access.gettable)),
        }
    }

    /// Access to a variable that may be set now.
    pub(super) fn writable(&self, reference: u32, wanted: DataType) -> CallResult<(usize, Access)> {
        let (index, access) = self.typed(reference, wanted)?;
        match access.settable.contains(self.now.memory.state) {
            true => Ok((index, access)),
            false => Err(self.not_in_state(index, "set", access.settable)),
        }
    }

    #[cold]
    fn not_in_state(&self, index: usize, verb: &str, allowed: StateSet) -> Refusal {
        let v = &self.table().variables()[index];
        let what = match v.causality {
            Causality::Input => "an input",
            Causality::Output => "an output",
            Causality::Parameter => "a parameter",
            Causality::CalculatedParameter => "a calculated parameter",
            Causality::Local if v.variability == Variability::Constant => "a constant",
            Causality::Local => "a state or its rate",
            Causality::Independent => "the time",
        };
        let when = match allowed == StateSet::NONE {
            true => "in any state".to_owned(),
            false => format!(
                "in the state `{}`, only {}",
                self.now.memory.state.name(),
                allowed.names()
            ),
        };
        let (name, changes) = (&v.name, v.variability);
        Refusal::error(format!(
            "`{name}` ({what}, {changes:?}) cannot be {verb} {when}"
        ))
    }

    /// Whether `value` may be stored at `index`: finite, and within the limits of the variable.
    pub(super) fn check_value(&self, index: usize, access: Access, value: f64) -> CallResult<()> {
        if value.is_finite() && value >= access.min && value <= access.max {
            return Ok(());
        }
        Err(wrong_value(&self.table().variables()[index], value))
    }
}

#[cold]
fn wrong_reference(
    index: usize,
    found: Option<&Access>,
    wanted: DataType,
    table: &VariableTable,
) -> Refusal {
    Refusal::error(match found {
        Some(found) => format!(
            "`{}` is {}, not {}",
            table.variables()[index].name,
            found.data_type.words(),
            wanted.words()
        ),
        None => format!(
            "value reference {index}: there is no such variable, the last one is {}",
            table.variables().len() - 1
        ),
    })
}

#[cold]
fn wrong_value(v: &Variable, value: f64) -> Refusal {
    if !value.is_finite() {
        return Refusal::error(format!(
            "`{}`: expected a finite number, found {value}",
            v.name
        ));
    }
    let limit = |x: Option<f64>| x.map_or_else(|| "none".into(), shown);
    Refusal::discard(format!(
        "`{}` = {} lies outside its limits (minimum {}, maximum {})",
        v.name,
        shown(value),
        limit(v.min),
        limit(v.max)
    ))
}
