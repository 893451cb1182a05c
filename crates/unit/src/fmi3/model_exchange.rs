//! Model exchange: the importer integrates.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::Fmi3Boolean;
use crate::fmi2::guard::{guarded, place};
use crate::fmi2::types::{fmi2Component, fmi2Status};
use crate::fmi2::{
    fmi2EnterContinuousTimeMode, fmi2EnterEventMode, fmi2GetContinuousStates, fmi2GetDerivatives,
    fmi2GetEventIndicators, fmi2GetNominalsOfContinuousStates, fmi2SetContinuousStates,
    fmi2SetTime,
};
use crate::lifecycle::Call;

/// Ends the integration up to here.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterEventMode(c: fmi2Component) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { fmi2EnterEventMode(c) }
}

/// Looks for changes at an event: there are none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3UpdateDiscreteStates(
    c: fmi2Component,
    discreteStatesNeedUpdate: *mut bool,
    terminateSimulation: *mut bool,
    nominalsOfContinuousStatesChanged: *mut bool,
    valuesOfContinuousStatesChanged: *mut bool,
    nextEventTimeDefined: *mut bool,
    nextEventTime: *mut f64,
) -> fmi2Status {
    // SAFETY: handle and pointers are valid by the contract of the interface
    unsafe {
        guarded(
            c,
            Call::NewDiscreteStates.by("UpdateDiscreteStates"),
            |_| {
                for flag in [
                    discreteStatesNeedUpdate,
                    terminateSimulation,
                    nominalsOfContinuousStatesChanged,
                    valuesOfContinuousStatesChanged,
                    nextEventTimeDefined,
                ] {
                    // what the importer has there need not be a truth value yet
                    *place(flag.cast::<u8>(), "flags")? = 0;
                }
                *place(nextEventTime, "nextEventTime")? = 0.0;
                Ok(())
            },
        )
    }
}

/// Begins the integration.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3EnterContinuousTimeMode(c: fmi2Component) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { fmi2EnterContinuousTimeMode(c) }
}

/// A step of the integrator is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3CompletedIntegratorStep(
    c: fmi2Component,
    _noSetFMUStatePriorToCurrentPoint: Fmi3Boolean,
    enterEventMode: *mut bool,
    terminateSimulation: *mut bool,
) -> fmi2Status {
    // SAFETY: handle and pointers are valid by the contract of the interface
    unsafe {
        guarded(
            c,
            Call::CompletedIntegratorStep.by("CompletedIntegratorStep"),
            |component| {
                *place(enterEventMode.cast::<u8>(), "enterEventMode")? = 0;
                *place(terminateSimulation.cast::<u8>(), "terminateSimulation")? = 0;
                component.instance.step_taken()
            },
        )
    }
}

/// Sets the time, s.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetTime(c: fmi2Component, time: f64) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { fmi2SetTime(c, time) }
}

/// Sets the continuous states.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetContinuousStates(
    c: fmi2Component,
    continuousStates: *const f64,
    nContinuousStates: usize,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { fmi2SetContinuousStates(c, continuousStates, nContinuousStates) }
}

/// Reads the rates of the continuous states.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetContinuousStateDerivatives(
    c: fmi2Component,
    derivatives: *mut f64,
    nContinuousStates: usize,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { fmi2GetDerivatives(c, derivatives, nContinuousStates) }
}

/// Reads the event indicators: there are none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetEventIndicators(
    c: fmi2Component,
    eventIndicators: *mut f64,
    nEventIndicators: usize,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { fmi2GetEventIndicators(c, eventIndicators, nEventIndicators) }
}

/// Reads the continuous states.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetContinuousStates(
    c: fmi2Component,
    continuousStates: *mut f64,
    nContinuousStates: usize,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { fmi2GetContinuousStates(c, continuousStates, nContinuousStates) }
}

/// Reads the usual sizes of the continuous states.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNominalsOfContinuousStates(
    c: fmi2Component,
    nominals: *mut f64,
    nContinuousStates: usize,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { fmi2GetNominalsOfContinuousStates(c, nominals, nContinuousStates) }
}

/// Number of event indicators: none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNumberOfEventIndicators(
    c: fmi2Component,
    nEventIndicators: *mut usize,
) -> fmi2Status {
    // SAFETY: handle and pointer are valid by the contract of the interface
    unsafe {
        let call = Call::GetNominalsOfContinuousStates;
        guarded(c, call.by("GetNumberOfEventIndicators"), |_| {
            *place(nEventIndicators, "nEventIndicators")? = 0;
            Ok(())
        })
    }
}

/// Number of continuous states.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNumberOfContinuousStates(
    c: fmi2Component,
    nContinuousStates: *mut usize,
) -> fmi2Status {
    // SAFETY: handle and pointer are valid by the contract of the interface
    unsafe {
        let call = Call::GetNominalsOfContinuousStates;
        guarded(c, call.by("GetNumberOfContinuousStates"), |component| {
            *place(nContinuousStates, "nContinuousStates")? = component.instance.state_count();
            Ok(())
        })
    }
}
