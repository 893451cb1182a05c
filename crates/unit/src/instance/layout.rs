//! The variable table in the form that the calls of every step use: by value reference, without text.

use super::memory::Memory;
use crate::error::{Error, Result};
use crate::lifecycle::{StateSet, gettable_in, settable_in};
use crate::variables::{Causality, Role, StartValue, Variable, VariableTable};

/// Type of a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DataType {
    /// Real number.
    Real,
    /// Integer.
    Integer,
    /// Truth value.
    Boolean,
    /// Text.
    String,
}

impl DataType {
    /// In words, the same in every version of the standard.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Real => "a real number",
            Self::Integer => "an integer",
            Self::Boolean => "a truth value",
            Self::String => "a text",
        }
    }
}

/// Where a value comes from, and what follows when it is set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Source {
    /// Stored; an input.
    Input,
    /// Stored; a property of the section or of a strip.
    Section,
    /// Stored; what turbulence of the archive is multiplied by, on which no property follows.
    Turbulence,
    /// Stored; displacement or rate at release.
    Release,
    /// Stored; upper end of the onset search.
    Limit,
    /// Stored; never changes.
    Constant,
    /// Computed from state and inputs.
    Response,
    /// Computed from the parameters.
    Calculated,
    /// Computed from parameters, wind and state, whenever it is asked for.
    Status,
    /// A state that is nothing else.
    State,
    /// Rate of a state that is nothing else; computed whenever it is asked for.
    Rate,
}

impl Source {
    /// Where the value of a variable with this role comes from.
    pub(super) fn from_role(role: Role) -> Self {
        match role {
            Role::TurbulenceFactor => Self::Turbulence,
            Role::InitialDisplacement(_) | Role::InitialRate(_) | Role::InitialMode(_) => {
                Self::Release
            }
            Role::OnsetSearchLimit => Self::Limit,
            Role::Filter(_) => Self::State,
            Role::FilterRate(_) => Self::Rate,
            Role::Computed(number) if number.causality == Causality::Output => Self::Status,
            Role::OfStrip(..) => Self::Response,
            other => match other.kind().0 {
                Causality::Input => Self::Input,
                Causality::Parameter => Self::Section,
                Causality::CalculatedParameter => Self::Calculated,
                Causality::Output => Self::Response,
                Causality::Local | Causality::Independent => Self::Constant,
            },
        }
    }
}

/// All that a getter or setter needs to know of a variable.
#[derive(Debug, Clone, Copy)]
pub(super) struct Access {
    pub data_type: DataType,
    pub source: Source,
    pub gettable: StateSet,
    pub settable: StateSet,
    pub min: f64,
    pub max: f64,
}

impl Access {
    fn new(v: &Variable) -> Self {
        Self {
            data_type: match v.value {
                StartValue::Real(_) => DataType::Real,
                StartValue::Integer(_) => DataType::Integer,
                StartValue::Boolean(_) => DataType::Boolean,
                StartValue::String(_) => DataType::String,
            },
            source: Source::from_role(v.role),
            gettable: gettable_in(v.causality, v.variability),
            settable: settable_in(v.causality, v.variability),
            min: v.min.unwrap_or(f64::NEG_INFINITY),
            max: v.max.unwrap_or(f64::INFINITY),
        }
    }
}

/// What reading a variable at every step needs, and no more: between steps, whatever can be read may be read.
#[derive(Debug, Clone, Copy)]
struct FastRead {
    /// Its index in the system state; an invalid index if it is not a state.
    entry: u32,
    /// Whether it is read among the stored values without any work: while the outputs are not those of the present, and while they are.
    stored: [bool; 2],
}

impl FastRead {
    fn new(access: &Access, state_index: Option<usize>) -> Self {
        let source = Some(access.source).filter(|_| access.data_type == DataType::Real);
        let is_state = matches!(source, Some(Source::Response | Source::State));
        let entry = state_index.filter(|_| is_state);
        let stored = match source {
            Some(Source::Response) => [false, entry.is_none()],
            Some(Source::Calculated | Source::Status | Source::State | Source::Rate) | None => {
                [false; 2]
            }
            _ => [true; 2],
        };
        let entry = entry.and_then(|entry| u32::try_from(entry).ok());
        Self {
            entry: entry.unwrap_or(u32::MAX),
            stored,
        }
    }
}

/// The variables, by their index in the table, which is that of their stored values.
#[derive(Debug, Clone)]
pub(super) struct VariableLayout {
    pub access: Vec<Access>,
    fast_reads: Vec<FastRead>,
    pub wind_speed: usize,
    /// Rates of the continuous states, in their order.
    pub state_rates: Vec<usize>,
    /// Entries of the system's state that the continuous states are, in the same order.
    pub state_entries: Vec<usize>,
}

/// Index of the variable with this role.
pub(super) fn index_of(table: &VariableTable, role: Role) -> Result<usize> {
    table
        .find(role)
        .ok_or_else(|| Error::Numerical(format!("variable table: nothing stands for {role:?}")))
}

impl VariableLayout {
    /// The layout of a table; `state_index` says which outputs are entries of the system's state.
    pub(super) fn new(
        table: &VariableTable,
        state_index: impl Fn(usize) -> Option<usize>,
    ) -> Result<Self> {
        let access: Vec<_> = table.variables().iter().map(Access::new).collect();
        let each = access.iter().enumerate();
        let state_rates = table.state_rates();
        let of = |rate: &usize| {
            table.variables()[*rate]
                .derivative_of
                .and_then(&state_index)
        };
        let state_entries = state_rates.iter().map(of).collect::<Option<_>>();
        Ok(Self {
            state_entries: state_entries.ok_or_else(|| {
                Error::Numerical(
                    "variable table: a continuous state is no part of the state".into(),
                )
            })?,
            fast_reads: each
                .map(|(i, a)| FastRead::new(a, state_index(i)))
                .collect(),
            access,
            wind_speed: index_of(table, Role::WindSpeed)?,
            state_rates,
        })
    }

    /// Entry of the system's state that the output at `index` is, if it is one.
    pub(super) fn state_index(&self, index: usize) -> Option<usize> {
        let entry = self.fast_reads[index].entry;
        (entry != u32::MAX).then_some(entry as usize)
    }

    /// The value of a real variable that needs no work, between steps: most of what is read at every step.
    #[inline]
    pub(super) fn read_fast(
        &self,
        reference: u32,
        memory: &Memory,
        outputs_current: bool,
    ) -> Option<f64> {
        let index = reference as usize;
        let fast = self.fast_reads.get(index)?;
        if let Some(state) = memory.system.values.get(fast.entry as usize) {
            return Some(*state);
        }
        fast.stored[usize::from(outputs_current)].then(|| memory.values[index])
    }
}
