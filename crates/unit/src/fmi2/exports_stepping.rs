//! Communication steps, rates of inputs and outputs, status of a step.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::guard::{array, array_mut, guarded, not_offered, place};
use super::types::{
    fmi2Boolean, fmi2Component, fmi2Integer, fmi2LastSuccessfulTime, fmi2Real, fmi2Status,
    fmi2StatusKind, fmi2String, fmi2Terminated, fmi2ValueReference,
};
use crate::lifecycle::{Call, State};
use crate::refusal::{CallResult, Refusal};

/// Sets first rates of inputs. They hold, and carry the inputs on, until they are set anew.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetRealInputDerivatives(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    order: *const fmi2Integer,
    value: *const fmi2Real,
) -> fmi2Status {
    // SAFETY: handle and arrays are valid by the contract of the interface
    unsafe {
        guarded(c, Call::SetRealInputDerivatives, |component| {
            component.instance.set_input_rates(
                array(vr, nvr, "vr")?,
                array(order, nvr, "order")?,
                array(value, nvr, "value")?,
            )
        })
    }
}

/// Reads first rates of outputs.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealOutputDerivatives(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    order: *const fmi2Integer,
    value: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: handle and arrays are valid by the contract of the interface
    unsafe {
        guarded(c, Call::GetRealOutputDerivatives, |component| {
            component.instance.output_rates(
                array(vr, nvr, "vr")?,
                array(order, nvr, "order")?,
                array_mut(value, nvr, "value")?,
            )
        })
    }
}

/// Advances the section by one communication step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DoStep(
    c: fmi2Component,
    currentCommunicationPoint: fmi2Real,
    communicationStepSize: fmi2Real,
    _noSetFMUStatePriorToCurrentPoint: fmi2Boolean,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe {
        guarded(c, Call::DoStep, |component| {
            component
                .instance
                .do_step(currentCommunicationPoint, communicationStepSize)
        })
    }
}

/// Cancels a pending step: there never is one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CancelStep(c: fmi2Component) -> fmi2Status {
    let why = "no step is ever left pending (canRunAsynchronuously is false)";
    // SAFETY: by the contract of the interface
    unsafe { not_offered(c, "CancelStep", why) }
}

/// Status of a pending step: there never is one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStatus(
    c: fmi2Component,
    s: fmi2StatusKind,
    _value: *mut fmi2Status,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { guarded(c, Call::GetStatus, |_| Err(nothing_to_report(s))) }
}

/// After a discarded step, the point of time it started from.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(
    c: fmi2Component,
    s: fmi2StatusKind,
    value: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe {
        guarded(c, Call::GetRealStatus, |component| {
            after_discard(s, fmi2LastSuccessfulTime, component.instance.state())?;
            *place(value, "value")? = component.instance.time_s();
            Ok(())
        })
    }
}

/// No status is an integer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetIntegerStatus(
    c: fmi2Component,
    s: fmi2StatusKind,
    _value: *mut fmi2Integer,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { guarded(c, Call::GetIntegerStatus, |_| Err(nothing_to_report(s))) }
}

/// After a discarded step, whether the unit wants to end the run: it does not.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(
    c: fmi2Component,
    s: fmi2StatusKind,
    value: *mut fmi2Boolean,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe {
        guarded(c, Call::GetBooleanStatus, |component| {
            after_discard(s, fmi2Terminated, component.instance.state())?;
            *place(value, "value")? = 0;
            Ok(())
        })
    }
}

/// Description of a pending step: there never is one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStringStatus(
    c: fmi2Component,
    s: fmi2StatusKind,
    value: *mut fmi2String,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe {
        guarded(c, Call::GetStringStatus, |_| {
            if let Some(value) = value.as_mut() {
                *value = c"".as_ptr(); // importers print it without looking at the status
            }
            Err(nothing_to_report(s))
        })
    }
}

fn after_discard(asked: fmi2StatusKind, known: fmi2StatusKind, state: State) -> CallResult<()> {
    if asked == known && state == State::StepFailed {
        Ok(())
    } else {
        Err(nothing_to_report(asked))
    }
}

fn nothing_to_report(kind: fmi2StatusKind) -> Refusal {
    Refusal::discard(format!("status {kind}: nothing to report"))
}
