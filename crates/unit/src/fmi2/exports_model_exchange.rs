//! The functions of model exchange. A section has no event indicators and nothing that changes at an event by itself.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::guard::{array, array_mut, guarded, place};
use super::types::{fmi2Boolean, fmi2Component, fmi2EventInfo, fmi2Real, fmi2Status};
use crate::lifecycle::{Call, State};
use crate::refusal::Refusal;

/// Ends the integration up to here.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterEventMode(c: fmi2Component) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe {
        guarded(c, Call::EnterEventMode, |component| {
            component.instance.enter(State::EventMode);
            Ok(())
        })
    }
}

/// Looks for changes at an event: there are none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2NewDiscreteStates(
    c: fmi2Component,
    eventInfo: *mut fmi2EventInfo,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe {
        guarded(c, Call::NewDiscreteStates, |_| {
            *place(eventInfo, "eventInfo")? = fmi2EventInfo::default();
            Ok(())
        })
    }
}

/// Begins the integration.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterContinuousTimeMode(c: fmi2Component) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe {
        guarded(c, Call::EnterContinuousTimeMode, |component| {
            component.instance.enter(State::ContinuousTimeMode);
            Ok(())
        })
    }
}

/// A step of the integrator is accepted.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CompletedIntegratorStep(
    c: fmi2Component,
    _noSetFMUStatePriorToCurrentPoint: fmi2Boolean,
    enterEventMode: *mut fmi2Boolean,
    terminateSimulation: *mut fmi2Boolean,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe {
        guarded(c, Call::CompletedIntegratorStep, |component| {
            *place(enterEventMode, "enterEventMode")? = 0;
            *place(terminateSimulation, "terminateSimulation")? = 0;
            component.instance.step_taken()
        })
    }
}

/// Sets the time, s.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetTime(c: fmi2Component, time: fmi2Real) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe {
        guarded(c, Call::SetTime, |component| {
            component.instance.set_time(time)
        })
    }
}

/// Sets the continuous states.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetContinuousStates(
    c: fmi2Component,
    x: *const fmi2Real,
    nx: usize,
) -> fmi2Status {
    // SAFETY: handle and array are valid by the contract of the interface
    unsafe {
        guarded(c, Call::SetContinuousStates, |component| {
            component.instance.set_continuous_states(array(x, nx, "x")?)
        })
    }
}

/// Reads the rates of the continuous states.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDerivatives(
    c: fmi2Component,
    derivatives: *mut fmi2Real,
    nx: usize,
) -> fmi2Status {
    // SAFETY: handle and array are valid by the contract of the interface
    unsafe {
        guarded(c, Call::GetDerivatives, |component| {
            component
                .instance
                .state_rates(array_mut(derivatives, nx, "derivatives")?)
        })
    }
}

/// Reads the event indicators: there are none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetEventIndicators(
    c: fmi2Component,
    _eventIndicators: *mut fmi2Real,
    ni: usize,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe {
        guarded(c, Call::GetEventIndicators, |_| {
            if ni == 0 {
                return Ok(());
            }
            Err(Refusal::call(format!(
                "event indicators: expected 0, found {ni}"
            )))
        })
    }
}

/// Reads the continuous states.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetContinuousStates(
    c: fmi2Component,
    x: *mut fmi2Real,
    nx: usize,
) -> fmi2Status {
    // SAFETY: handle and array are valid by the contract of the interface
    unsafe {
        guarded(c, Call::GetContinuousStates, |component| {
            component.instance.continuous_states(array_mut(x, nx, "x")?)
        })
    }
}

/// Reads the usual sizes of the continuous states.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetNominalsOfContinuousStates(
    c: fmi2Component,
    x_nominal: *mut fmi2Real,
    nx: usize,
) -> fmi2Status {
    // SAFETY: handle and array are valid by the contract of the interface
    unsafe {
        guarded(c, Call::GetNominalsOfContinuousStates, |component| {
            component
                .instance
                .state_nominals(array_mut(x_nominal, nx, "x_nominal")?)
        })
    }
}
