//! Which call is legal when: the state machines of co-simulation and of model exchange as data (FMI 2.0.5, sections 4.2.4
//! and 3.2.3).
//!
//! Two tables decide everything: `LEGAL_CALLS` for whole functions, and `settable_in` and `gettable_in` for single
//! variables. Beyond the letter of the standard, inputs and parameters may be read while instantiated and everything
//! may be read between setting and stepping, because importers do so.

use super::variables::{Causality, Variability};

/// Where an instance stands in its life.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum State {
    /// Created or reset.
    Instantiated = 1,
    /// Between entering and leaving the initialisation mode.
    Initialization = 2,
    /// Ready for the next communication step.
    StepComplete = 4,
    /// The last communication step was discarded.
    StepFailed = 8,
    /// The run has been ended.
    Terminated = 16,
    /// A call returned an error; only a reset or a restored state leads out.
    Error = 32,
    /// Model exchange: at an event, where everything but the states may change.
    EventMode = 64,
    /// Model exchange: between events, where the importer integrates.
    ContinuousTimeMode = 128,
}

impl State {
    /// Every state, in the order of a life.
    pub const ALL: [State; 8] = [
        Self::Instantiated,
        Self::Initialization,
        Self::StepComplete,
        Self::StepFailed,
        Self::EventMode,
        Self::ContinuousTimeMode,
        Self::Terminated,
        Self::Error,
    ];

    /// The state in words, for messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Instantiated => "instantiated",
            Self::Initialization => "initialisation mode",
            Self::StepComplete => "step complete",
            Self::StepFailed => "step failed",
            Self::Terminated => "terminated",
            Self::Error => "error",
            Self::EventMode => "event mode",
            Self::ContinuousTimeMode => "continuous-time mode",
        }
    }

    /// The interface to which the state belongs; none where it belongs to both.
    pub fn interface(self) -> Option<Interface> {
        match self {
            Self::StepComplete | Self::StepFailed => Some(Interface::CoSimulation),
            Self::EventMode | Self::ContinuousTimeMode => Some(Interface::ModelExchange),
            _ => None,
        }
    }

    /// The state with this code, as it stands in a serialised state.
    pub(crate) fn from_code(code: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|s| *s as u8 == code)
    }
}

/// Who solves the equations of an instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interface {
    /// The instance itself, in communication steps.
    CoSimulation,
    /// The importer, from states and derivatives.
    ModelExchange,
}

impl Interface {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::CoSimulation => "co-simulation",
            Self::ModelExchange => "model exchange",
        }
    }
}

/// A set of states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StateSet(u8);

impl StateSet {
    /// No state.
    pub(crate) const NONE: Self = Self(0);
    /// Every state.
    pub(crate) const ANY: Self = Self::of(&State::ALL);
    /// From the end of initialisation on, whatever has happened.
    const STARTED: Self = Self::of(&[
        State::StepComplete,
        State::StepFailed,
        State::EventMode,
        State::ContinuousTimeMode,
        State::Terminated,
        State::Error,
    ]);
    /// From the initialisation mode on.
    const INITIALIZED: Self = Self::STARTED.and(State::Initialization);
    /// States in which parameters may be set.
    const SETTING: Self = Self::of(&[
        State::Instantiated,
        State::Initialization,
        State::StepComplete,
        State::EventMode,
    ]);
    /// Where an importer that integrates stands.
    const INTEGRATING: Self = Self::of(&[State::EventMode, State::ContinuousTimeMode]);

    /// The set of these states.
    pub const fn of(states: &[State]) -> Self {
        let mut bits = 0;
        let mut i = 0;
        while i < states.len() {
            bits |= states[i] as u8;
            i += 1;
        }
        Self(bits)
    }

    const fn and(self, state: State) -> Self {
        Self(self.0 | state as u8)
    }

    /// Whether `state` belongs to the set.
    pub const fn contains(self, state: State) -> bool {
        self.0 & state as u8 != 0
    }

    /// The states by name, for messages.
    pub fn names(self) -> String {
        let names: Vec<_> = State::ALL
            .into_iter()
            .filter(|s| self.contains(*s))
            .map(State::name)
            .collect();
        if names.is_empty() {
            "in no state".into()
        } else {
            format!("in: {}", names.join(", "))
        }
    }
}

/// What an importer may ask of an instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)] // the names are those of the standard
pub enum Call {
    SetDebugLogging,
    FreeInstance,
    SetupExperiment,
    EnterInitializationMode,
    ExitInitializationMode,
    Terminate,
    Reset,
    GetReal,
    GetInteger,
    GetBoolean,
    GetString,
    SetReal,
    SetInteger,
    SetBoolean,
    SetString,
    GetFMUstate,
    SetFMUstate,
    FreeFMUstate,
    SerializedFMUstateSize,
    SerializeFMUstate,
    DeSerializeFMUstate,
    GetDirectionalDerivative,
    SetRealInputDerivatives,
    GetRealOutputDerivatives,
    DoStep,
    EnterEventMode,
    NewDiscreteStates,
    EnterContinuousTimeMode,
    CompletedIntegratorStep,
    SetTime,
    SetContinuousStates,
    GetDerivatives,
    GetEventIndicators,
    GetContinuousStates,
    GetNominalsOfContinuousStates,
    GetStatus,
    GetRealStatus,
    GetIntegerStatus,
    GetBooleanStatus,
    GetStringStatus,
}

/// The calls of [`Call`] in its order, their names without the prefix of the standard's version, and where each is
/// legal. Cancelling a step is missing: no step is ever left pending.
pub(crate) const LEGAL_CALLS: [(Call, &str, StateSet); 40] = {
    use Call as C;
    use StateSet as S;
    let stepping = S::of(&[State::StepComplete, State::StepFailed]);
    let status = stepping.and(State::Terminated);
    let setting = S::SETTING.and(State::ContinuousTimeMode);
    let integrated = S::INTEGRATING
        .and(State::Initialization)
        .and(State::Terminated)
        .and(State::Error);
    [
        (C::SetDebugLogging, "SetDebugLogging", S::ANY),
        (C::FreeInstance, "FreeInstance", S::ANY),
        (
            C::SetupExperiment,
            "SetupExperiment",
            S::of(&[State::Instantiated]),
        ),
        (
            C::EnterInitializationMode,
            "EnterInitializationMode",
            S::of(&[State::Instantiated]),
        ),
        (
            C::ExitInitializationMode,
            "ExitInitializationMode",
            S::of(&[State::Initialization]),
        ),
        (
            C::Terminate,
            "Terminate",
            stepping
                .and(State::EventMode)
                .and(State::ContinuousTimeMode),
        ),
        (C::Reset, "Reset", S::ANY),
        (C::GetReal, "GetReal", S::ANY),
        (C::GetInteger, "GetInteger", S::ANY),
        (C::GetBoolean, "GetBoolean", S::ANY),
        (C::GetString, "GetString", S::ANY),
        (C::SetReal, "SetReal", setting),
        (C::SetInteger, "SetInteger", setting),
        (C::SetBoolean, "SetBoolean", setting),
        (C::SetString, "SetString", setting),
        (C::GetFMUstate, "GetFMUstate", S::ANY),
        (C::SetFMUstate, "SetFMUstate", S::ANY),
        (C::FreeFMUstate, "FreeFMUstate", S::ANY),
        (C::SerializedFMUstateSize, "SerializedFMUstateSize", S::ANY),
        (C::SerializeFMUstate, "SerializeFMUstate", S::ANY),
        (C::DeSerializeFMUstate, "DeSerializeFMUstate", S::ANY),
        (
            C::GetDirectionalDerivative,
            "GetDirectionalDerivative",
            S::INITIALIZED,
        ),
        (
            C::SetRealInputDerivatives,
            "SetRealInputDerivatives",
            S::of(&[
                State::Instantiated,
                State::Initialization,
                State::StepComplete,
            ]),
        ),
        (
            C::GetRealOutputDerivatives,
            "GetRealOutputDerivatives",
            status.and(State::Error),
        ),
        (C::DoStep, "DoStep", S::of(&[State::StepComplete])),
        (
            C::EnterEventMode,
            "EnterEventMode",
            S::of(&[State::ContinuousTimeMode]),
        ),
        (
            C::NewDiscreteStates,
            "NewDiscreteStates",
            S::of(&[State::EventMode]),
        ),
        (
            C::EnterContinuousTimeMode,
            "EnterContinuousTimeMode",
            S::of(&[State::EventMode]),
        ),
        (
            C::CompletedIntegratorStep,
            "CompletedIntegratorStep",
            S::of(&[State::ContinuousTimeMode]),
        ),
        (C::SetTime, "SetTime", S::INTEGRATING),
        (
            C::SetContinuousStates,
            "SetContinuousStates",
            S::of(&[State::ContinuousTimeMode]),
        ),
        (C::GetDerivatives, "GetDerivatives", integrated),
        (C::GetEventIndicators, "GetEventIndicators", integrated),
        (C::GetContinuousStates, "GetContinuousStates", integrated),
        (
            C::GetNominalsOfContinuousStates,
            "GetNominalsOfContinuousStates",
            integrated.and(State::Instantiated),
        ),
        (C::GetStatus, "GetStatus", status),
        (C::GetRealStatus, "GetRealStatus", status),
        (C::GetIntegerStatus, "GetIntegerStatus", status),
        (C::GetBooleanStatus, "GetBooleanStatus", status),
        (C::GetStringStatus, "GetStringStatus", status),
    ]
};

impl Call {
    /// Name without the prefix of the standard's version.
    pub const fn name(self) -> &'static str {
        LEGAL_CALLS[self as usize].1
    }

    /// States in which the call is legal.
    pub(crate) const fn legal_in(self) -> StateSet {
        LEGAL_CALLS[self as usize].2
    }

    /// Whether it belongs to model exchange alone.
    pub(crate) const fn is_model_exchange(self) -> bool {
        matches!(
            self,
            Self::EnterEventMode
                | Self::NewDiscreteStates
                | Self::EnterContinuousTimeMode
                | Self::CompletedIntegratorStep
                | Self::SetTime
                | Self::SetContinuousStates
                | Self::GetDerivatives
                | Self::GetEventIndicators
                | Self::GetContinuousStates
                | Self::GetNominalsOfContinuousStates
        )
    }
}

/// States in which a variable may be set: inputs until the run ends, tunable parameters also, but not between events, fixed
/// parameters until initialisation ends.
pub(crate) fn settable_in(causality: Causality, variability: Variability) -> StateSet {
    match (causality, variability) {
        (Causality::Input, _) => StateSet::SETTING.and(State::ContinuousTimeMode),
        (Causality::Parameter, Variability::Tunable) => StateSet::SETTING,
        (Causality::Parameter, _) => StateSet::of(&[State::Instantiated, State::Initialization]),
        _ => StateSet::NONE,
    }
}

/// States in which a variable may be read: what is computed only from the initialisation mode on.
pub(crate) fn gettable_in(causality: Causality, variability: Variability) -> StateSet {
    match (causality, variability) {
        (Causality::Output | Causality::CalculatedParameter, _)
        | (Causality::Local, Variability::Continuous) => StateSet::INITIALIZED,
        _ => StateSet::ANY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_stands_in_the_order_of_the_calls() {
        for (i, (call, name, _)) in LEGAL_CALLS.into_iter().enumerate() {
            assert_eq!(call as usize, i);
            assert_eq!(format!("{call:?}"), name);
        }
    }

    #[test]
    fn codes_and_names_are_those_of_the_states() {
        for state in State::ALL {
            assert_eq!(State::from_code(state as u8), Some(state));
            assert!(StateSet::ANY.contains(state));
            assert!(!StateSet::NONE.contains(state));
        }
        assert_eq!(State::from_code(3), None);
        assert_eq!(
            Call::DoStep.legal_in().names(),
            "in: step complete".to_owned()
        );
    }
}
