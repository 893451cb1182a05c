//! Model exchange: the importer integrates.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::Fmi3Boolean;
use crate::fmi2::guard::exported;
use crate::fmi2::guard::target;
use crate::lifecycle::Call;

as_in_fmi2! {
    /// Ends the integration up to here.
    fmi3EnterEventMode() => fmi2EnterEventMode();
}

exported! {
    /// Looks for changes at an event: states in units of a parameter that has been set.
    fmi3UpdateDiscreteStates(
        discreteStatesNeedUpdate: *mut bool, terminateSimulation: *mut bool,
        nominalsOfContinuousStatesChanged: *mut bool, valuesOfContinuousStatesChanged: *mut bool,
        nextEventTimeDefined: *mut bool, nextEventTime: *mut f64
    ) Call::NewDiscreteStates => |component| {
        let states_set = component.instance.has_set_states();
        for (flag, value) in [
            (discreteStatesNeedUpdate, false),
            (terminateSimulation, false),
            (nominalsOfContinuousStatesChanged, false),
            (valuesOfContinuousStatesChanged, states_set),
            (nextEventTimeDefined, false),
        ] {
            // what the importer has there need not be a truth value yet
            *target(flag.cast::<u8>(), "flags")? = value.into();
        }
        *target(nextEventTime, "nextEventTime")? = 0.0;
        Ok(())
    };
}

as_in_fmi2! {
    /// Begins the integration.
    fmi3EnterContinuousTimeMode() => fmi2EnterContinuousTimeMode();
}

exported! {
    /// A step of the integrator is accepted.
    fmi3CompletedIntegratorStep(
        _noSetFMUStatePriorToCurrentPoint: Fmi3Boolean, enterEventMode: *mut bool,
        terminateSimulation: *mut bool
    ) Call::CompletedIntegratorStep => |component| {
        *target(enterEventMode.cast::<u8>(), "enterEventMode")? = 0;
        *target(terminateSimulation.cast::<u8>(), "terminateSimulation")? = 0;
        component.instance.step_taken()
    };
}

as_in_fmi2! {
    /// Sets the time, s.
    fmi3SetTime(time: f64) => fmi2SetTime(time);
    /// Sets the continuous states.
    fmi3SetContinuousStates(
        continuousStates: *const f64, nContinuousStates: usize
    ) => fmi2SetContinuousStates(continuousStates, nContinuousStates);
    /// Reads the rates of the continuous states.
    fmi3GetContinuousStateDerivatives(
        derivatives: *mut f64, nContinuousStates: usize
    ) => fmi2GetDerivatives(derivatives, nContinuousStates);
    /// Reads the event indicators: there are none.
    fmi3GetEventIndicators(
        eventIndicators: *mut f64, nEventIndicators: usize
    ) => fmi2GetEventIndicators(eventIndicators, nEventIndicators);
    /// Reads the continuous states.
    fmi3GetContinuousStates(
        continuousStates: *mut f64, nContinuousStates: usize
    ) => fmi2GetContinuousStates(continuousStates, nContinuousStates);
    /// Reads the usual sizes of the continuous states.
    fmi3GetNominalsOfContinuousStates(
        nominals: *mut f64, nContinuousStates: usize
    ) => fmi2GetNominalsOfContinuousStates(nominals, nContinuousStates);
}

exported! {
    /// Number of event indicators: none.
    fmi3GetNumberOfEventIndicators(
        nEventIndicators: *mut usize
    ) Call::GetNominalsOfContinuousStates => |_| {
        *target(nEventIndicators, "nEventIndicators")? = 0;
        Ok(())
    };
    /// Number of continuous states.
    fmi3GetNumberOfContinuousStates(
        nContinuousStates: *mut usize
    ) Call::GetNominalsOfContinuousStates => |component| {
        *target(nContinuousStates, "nContinuousStates")? = component.instance.state_count();
        Ok(())
    };
}
