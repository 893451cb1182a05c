//! The functions of model exchange. A section has no event indicators and nothing that changes at an event by itself.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::guard::{array, array_mut, exported, target};
use super::types::{fmi2Boolean, fmi2EventInfo, fmi2Real};
use crate::lifecycle::{Call, State};
use crate::refusal::Refusal;

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
