//! The variable table in the form that the calls of every step use: by value reference, without text.

use super::memory::Memory;
use crate::error::{Error, Result};
use crate::lifecycle::{State, StateSet, gettable_in, settable_in};
use crate::response::wind_at_rest;
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

/// Where a value comes from, and what follows when it is set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Source {
    /// Stored; an input.
    Input,
    /// Stored; a property of the section or of a strip.
    Section,
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
    pub(super) fn of(role: Role) -> Self {
        match role {
            Role::WindSpeed
            | Role::ExternalForce(_)
            | Role::Gust(..)
            | Role::Motion(..)
            | Role::NodeForce(..) => Self::Input,
            Role::Section(_)
            | Role::Strip(..)
            | Role::Prediction
            | Role::MotionDerivatives
            | Role::ModeParameter(..)
            | Role::DamperParameter(_)
            | Role::TurbulenceFactor => Self::Section,
            Role::InitialDisplacement(_) | Role::InitialRate(_) | Role::InitialMode(_) => {
                Self::Release
            }
            Role::OnsetSearchLimit => Self::Limit,
            Role::Constant => Self::Constant,
            Role::Response(..)
            | Role::Force(..)
            | Role::NodeMotion(..)
            | Role::Mode(..)
            | Role::Damper(..) => Self::Response,
            Role::Filter(_) => Self::State,
            Role::FilterRate(_) => Self::Rate,
            Role::Computed(number) => match number.causality {
                Causality::Output => Self::Status,
                _ => Self::Calculated,
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
    fn of(v: &Variable) -> Self {
        Self {
            data_type: match v.value {
                StartValue::Real(_) => DataType::Real,
                StartValue::Integer(_) => DataType::Integer,
                StartValue::Boolean(_) => DataType::Boolean,
                StartValue::String(_) => DataType::String,
            },
            source: Source::of(v.role),
            gettable: gettable_in(v.causality, v.variability),
            settable: settable_in(v.causality, v.variability),
            min: v.min.unwrap_or(f64::NEG_INFINITY),
            max: v.max.unwrap_or(f64::INFINITY),
        }
    }
}

/// Where a real variable that is no part of the state is read at once, without any work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ReadableWhen {
    /// Among the stored values.
    Always,
    /// Among them as long as the outputs are those of the present.
    WithOutputs,
    /// Nowhere.
    Never,
}

/// What reading a variable at every step needs, and no more: between steps, whatever can be read may be read.
#[derive(Debug, Clone, Copy)]
struct QuickAccess {
    /// Its index in the system state; an invalid index if it is not a state.
    entry: u32,
    at_hand: ReadableWhen,
}

impl QuickAccess {
    fn of(access: &Access, held: Option<usize>) -> Self {
        let (at_hand, entry) = match (access.data_type, access.source, held) {
            (DataType::Real, Source::Response | Source::State, Some(_)) => {
                (ReadableWhen::Never, held)
            }
            (DataType::Real, Source::Response, None) => (ReadableWhen::WithOutputs, None),
            (
                DataType::Real,
                Source::Calculated | Source::Status | Source::State | Source::Rate,
                _,
            ) => (ReadableWhen::Never, None),
            (DataType::Real, ..) => (ReadableWhen::Always, None),
            _ => (ReadableWhen::Never, None),
        };
        let entry = entry.and_then(|entry| u32::try_from(entry).ok());
        Self {
            entry: entry.unwrap_or(u32::MAX),
            at_hand,
        }
    }
}

/// The variables by place, which is the index into the table and into the stored values.
#[derive(Debug, Clone)]
pub(super) struct VariablePlaces {
    pub access: Vec<Access>,
    glances: Vec<QuickAccess>,
    wind_speed: usize,
    /// Rates of the continuous states, in their order.
    pub state_rates: Vec<usize>,
    /// Entries of the system's state that the continuous states are, in the same order.
    pub state_entries: Vec<usize>,
}

/// Place of the variable with this role.
pub(super) fn place(table: &VariableTable, role: Role) -> Result<usize> {
    table
        .find(role)
        .ok_or_else(|| Error::Numerical(format!("variable table: nothing stands for {role:?}")))
}

impl VariablePlaces {
    /// The layout of a table; `held` says which outputs are entries of the system's state.
    pub(super) fn new(
        table: &VariableTable,
        held: impl Fn(usize) -> Option<usize>,
    ) -> Result<Self> {
        let access: Vec<_> = table.variables().iter().map(Access::of).collect();
        let each = access.iter().enumerate();
        let state_rates = table.state_rates();
        let of = |rate: &usize| table.variables()[*rate].derivative_of.and_then(&held);
        let state_entries = state_rates.iter().map(of).collect::<Option<_>>();
        Ok(Self {
            state_entries: state_entries.ok_or_else(|| {
                Error::Numerical(
                    "variable table: a continuous state is no part of the state".into(),
                )
            })?,
            glances: each.map(|(i, a)| QuickAccess::of(a, held(i))).collect(),
            access,
            wind_speed: place(table, Role::WindSpeed)?,
            state_rates,
        })
    }

    /// Entry of the system's state that the output at `place` is, if it is one.
    pub(super) fn held(&self, place: usize) -> Option<usize> {
        let entry = self.glances[place].entry;
        (entry != u32::MAX).then_some(entry as usize)
    }

    /// The value of a real variable that needs no work, between steps: most of what is read at every step.
    #[inline]
    pub(super) fn at_hand(
        &self,
        reference: u32,
        memory: &Memory,
        outputs_current: bool,
    ) -> Option<f64> {
        let place = reference as usize;
        let glance = self.glances.get(place)?;
        if let Some(held) = memory.system.values.get(glance.entry as usize) {
            return Some(*held);
        }
        let stored = match glance.at_hand {
            ReadableWhen::Always => true,
            ReadableWhen::WithOutputs => outputs_current,
            ReadableWhen::Never => false,
        };
        stored.then(|| memory.values[place])
    }

    /// Where the value at `place` comes from.
    /// Whether a variable may be set in a state.
    pub(super) fn is_settable(&self, place: usize, state: State) -> bool {
        self.access[place].settable.contains(state)
    }

    pub(super) fn source(&self, place: usize) -> Source {
        self.access[place].source
    }

    /// `value` as it is stored at `place`: a wind that rounding has taken below zero is at rest.
    pub(super) fn settled(&self, place: usize, value: f64) -> f64 {
        if place == self.wind_speed {
            wind_at_rest(value, 0.0)
        } else {
            value
        }
    }
}
