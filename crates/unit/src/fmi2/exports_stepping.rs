//! Communication steps, rates of inputs and outputs, status of a step.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::guard::{array, array_mut, exported, not_offered, target};
use super::types::{
    fmi2Boolean, fmi2Component, fmi2Integer, fmi2LastSuccessfulTime, fmi2Real, fmi2Status,
    fmi2StatusKind, fmi2String, fmi2Terminated, fmi2ValueReference,
};
use crate::lifecycle::{Call, State};
use crate::refusal::{CallResult, Refusal};

exported! {
    /// Sets first rates of inputs. They hold, and carry the inputs on, until they are set anew.
    fmi2SetRealInputDerivatives(
        vr: *const fmi2ValueReference, nvr: usize, order: *const fmi2Integer, value: *const fmi2Real
    ) Call::SetRealInputDerivatives => |component| {
        component.instance.set_input_rates(
            array(vr, nvr, "vr")?,
            array(order, nvr, "order")?,
            array(value, nvr, "value")?,
        )
    };
    /// Reads first rates of outputs.
    fmi2GetRealOutputDerivatives(
        vr: *const fmi2ValueReference, nvr: usize, order: *const fmi2Integer, value: *mut fmi2Real
    ) Call::GetRealOutputDerivatives => |component| {
        component.instance.output_rates(
            array(vr, nvr, "vr")?,
            array(order, nvr, "order")?,
            array_mut(value, nvr, "value")?,
        )
    };
    /// Advances the section by one communication step.
    fmi2DoStep(
        currentCommunicationPoint: fmi2Real, communicationStepSize: fmi2Real,
        _noSetFMUStatePriorToCurrentPoint: fmi2Boolean
    ) Call::DoStep => |component| component.instance.do_step(currentCommunicationPoint, communicationStepSize);
}

/// Cancels a pending step: there never is one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CancelStep(c: fmi2Component) -> fmi2Status {
    let why = "no step is ever left pending (canRunAsynchronuously is false)";
    // SAFETY: by the contract of the interface
    unsafe { not_offered(c, "CancelStep", why) }
}

exported! {
    /// Status of a pending step: there never is one.
    fmi2GetStatus(s: fmi2StatusKind, _value: *mut fmi2Status) Call::GetStatus => |_| Err(nothing_to_report(s));
    /// After a discarded step, the point of time it started from.
    fmi2GetRealStatus(s: fmi2StatusKind, value: *mut fmi2Real) Call::GetRealStatus => |component| {
        after_discard(s, fmi2LastSuccessfulTime, component.instance.state())?;
        *target(value, "value")? = component.instance.time_s();
        Ok(())
    };
    /// No status is an integer.
    fmi2GetIntegerStatus(s: fmi2StatusKind, _value: *mut fmi2Integer) Call::GetIntegerStatus =>
        |_| Err(nothing_to_report(s));
    /// After a discarded step, whether the unit wants to end the run: it does not.
    fmi2GetBooleanStatus(s: fmi2StatusKind, value: *mut fmi2Boolean) Call::GetBooleanStatus => |component| {
        after_discard(s, fmi2Terminated, component.instance.state())?;
        *target(value, "value")? = 0;
        Ok(())
    };
    /// Description of a pending step: there never is one.
    fmi2GetStringStatus(s: fmi2StatusKind, value: *mut fmi2String) Call::GetStringStatus => |_| {
        if let Some(value) = value.as_mut() {
            *value = c"".as_ptr(); // importers print it without looking at the status
        }
        Err(nothing_to_report(s))
    };
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
