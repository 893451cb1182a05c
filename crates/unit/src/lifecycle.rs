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
    pub(crate) const ANY: Self = Self::new(&State::ALL);
    /// From the end of initialisation on, whatever has happened.
    const STARTED: Self = Self::new(&[
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
    const SETTING: Self = Self::new(&[
        State::Instantiated,
        State::Initialization,
        State::StepComplete,
        State::EventMode,
    ]);
    /// Where an importer that integrates stands.
    const INTEGRATING: Self = Self::new(&[State::EventMode, State::ContinuousTimeMode]);

    /// The set of these states.
    pub const fn new(states: &[State]) -> Self {
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
        format!("in: {}", names.join(", "))
    }
}

/// Declares the calls and, in the same order, where each is legal; those of model exchange alone last.
macro_rules! calls {
    (both: { $($name:ident: $legal:expr;)* } model_exchange: { $($integrated:ident: $there:expr;)* }) => {
        /// What an importer may ask of an instance.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[allow(missing_docs)] // the names are those of the standard
        pub enum Call {
            $($name,)* $($integrated,)*
        }

        /// Every [`Call`] with where it is legal, by [`Interface`].
        pub(crate) const LEGAL_CALLS: [(Call, [StateSet; 2]);
            [$(Call::$name,)* $(Call::$integrated),*].len()] = [
            $((Call::$name, [$legal, $legal]),)*
            $((Call::$integrated, [StateSet::NONE, $there]),)*
        ];
    };
}

/// Between communication steps.
const STEPPING: StateSet = StateSet::new(&[State::StepComplete, State::StepFailed]);
const STATUS: StateSet = STEPPING.and(State::Terminated);
const SETTING: StateSet = StateSet::SETTING.and(State::ContinuousTimeMode);
/// Where states and their rates are read.
const INTEGRATED: StateSet = StateSet::INTEGRATING
    .and(State::Initialization)
    .and(State::Terminated)
    .and(State::Error);

// cancelling a step is missing: no step is ever left pending
calls! {
    both: {
        SetDebugLogging: StateSet::ANY;
        FreeInstance: StateSet::ANY;
        SetupExperiment: StateSet::new(&[State::Instantiated]);
        EnterInitializationMode: StateSet::new(&[State::Instantiated]);
        ExitInitializationMode: StateSet::new(&[State::Initialization]);
        Terminate: STEPPING.and(State::EventMode).and(State::ContinuousTimeMode);
        Reset: StateSet::ANY;
        GetReal: StateSet::ANY;
        GetInteger: StateSet::ANY;
        GetBoolean: StateSet::ANY;
        GetString: StateSet::ANY;
        SetReal: SETTING;
        SetInteger: SETTING;
        SetBoolean: SETTING;
        SetString: SETTING;
        GetFMUstate: StateSet::ANY;
        SetFMUstate: StateSet::ANY;
        FreeFMUstate: StateSet::ANY;
        SerializedFMUstateSize: StateSet::ANY;
        SerializeFMUstate: StateSet::ANY;
        DeSerializeFMUstate: StateSet::ANY;
        GetDirectionalDerivative: StateSet::INITIALIZED;
        SetRealInputDerivatives: StateSet::new(&[State::Instantiated, State::Initialization, State::StepComplete]);
        GetRealOutputDerivatives: STATUS.and(State::Error);
        DoStep: StateSet::new(&[State::StepComplete]);
        GetStatus: STATUS;
        GetRealStatus: STATUS;
        GetIntegerStatus: STATUS;
        GetBooleanStatus: STATUS;
        GetStringStatus: STATUS;
    }
    model_exchange: {
        EnterEventMode: StateSet::new(&[State::ContinuousTimeMode]);
        NewDiscreteStates: StateSet::new(&[State::EventMode]);
        EnterContinuousTimeMode: StateSet::new(&[State::EventMode]);
        CompletedIntegratorStep: StateSet::new(&[State::ContinuousTimeMode]);
        SetTime: StateSet::INTEGRATING;
        SetContinuousStates: StateSet::new(&[State::ContinuousTimeMode]);
        GetDerivatives: INTEGRATED;
        GetEventIndicators: INTEGRATED;
        GetContinuousStates: INTEGRATED;
        GetNominalsOfContinuousStates: INTEGRATED.and(State::Instantiated);
    }
}

/// States in which a variable may be set: inputs until the run ends, tunable parameters also, but not between events, fixed
/// parameters until initialisation ends.
pub(crate) fn settable_in(causality: Causality, variability: Variability) -> StateSet {
    match (causality, variability) {
        (Causality::Input, _) => StateSet::SETTING.and(State::ContinuousTimeMode),
        (Causality::Parameter, Variability::Tunable) => StateSet::SETTING,
        (Causality::Parameter, _) => StateSet::new(&[State::Instantiated, State::Initialization]),
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
        for (i, (call, _)) in LEGAL_CALLS.into_iter().enumerate() {
            assert_eq!(call as usize, i);
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
            LEGAL_CALLS[Call::DoStep as usize].1[0].names(),
            "in: step complete".to_owned()
        );
    }
}
