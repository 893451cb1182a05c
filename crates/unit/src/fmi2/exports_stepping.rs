//! Communication steps, rates of inputs and outputs, status of a step; and model exchange: a section has no event indicators and nothing
//! that changes at an event by itself.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::guard::{array, array_mut, exported, not_offered, target};
use super::types::{
    fmi2Boolean, fmi2Component, fmi2EventInfo, fmi2Integer, fmi2LastSuccessfulTime, fmi2Real,
    fmi2Status, fmi2StatusKind, fmi2String, fmi2Terminated, fmi2ValueReference,
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

exported! {
    /// Ends the integration up to here.
    fmi2EnterEventMode() Call::EnterEventMode => |component| {
        component.instance.enter(State::EventMode);
        Ok(())
    };
    /// Looks for changes at an event: states in units of a parameter that has been set.
    fmi2NewDiscreteStates(eventInfo: *mut fmi2EventInfo) Call::NewDiscreteStates => |component| {
        *target(eventInfo, "eventInfo")? = fmi2EventInfo {
            valuesOfContinuousStatesChanged: component.instance.has_set_states().into(),
            ..fmi2EventInfo::default()
        };
        Ok(())
    };
    /// Begins the integration.
    fmi2EnterContinuousTimeMode() Call::EnterContinuousTimeMode => |component| {
        component.instance.enter(State::ContinuousTimeMode);
        Ok(())
    };
    /// A step of the integrator is accepted.
    fmi2CompletedIntegratorStep(
        _noSetFMUStatePriorToCurrentPoint: fmi2Boolean, enterEventMode: *mut fmi2Boolean,
        terminateSimulation: *mut fmi2Boolean
    ) Call::CompletedIntegratorStep => |component| {
        *target(enterEventMode, "enterEventMode")? = 0;
        *target(terminateSimulation, "terminateSimulation")? = 0;
        component.instance.step_taken()
    };
    /// Sets the time, s.
    fmi2SetTime(time: fmi2Real) Call::SetTime => |component| component.instance.set_time(time);
    /// Sets the continuous states.
    fmi2SetContinuousStates(x: *const fmi2Real, nx: usize) Call::SetContinuousStates =>
        |component| component.instance.set_continuous_states(array(x, nx, "x")?);
    /// Reads the rates of the continuous states.
    fmi2GetDerivatives(derivatives: *mut fmi2Real, nx: usize) Call::GetDerivatives =>
        |component| component.instance.state_rates(array_mut(derivatives, nx, "derivatives")?);
    /// Reads the event indicators: there are none.
    fmi2GetEventIndicators(_eventIndicators: *mut fmi2Real, ni: usize) Call::GetEventIndicators => |_| {
        if ni == 0 {
            return Ok(());
        }
        Err(Refusal::call(format!(
            "event indicators: expected 0, found {ni}"
        )))
    };
    /// Reads the continuous states.
    fmi2GetContinuousStates(x: *mut fmi2Real, nx: usize) Call::GetContinuousStates =>
        |component| component.instance.continuous_states(array_mut(x, nx, "x")?);
    /// Reads the usual sizes of the continuous states.
    fmi2GetNominalsOfContinuousStates(
        x_nominal: *mut fmi2Real, nx: usize
    ) Call::GetNominalsOfContinuousStates =>
        |component| component.instance.state_nominals(array_mut(x_nominal, nx, "x_nominal")?);
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
