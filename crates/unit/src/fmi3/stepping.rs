//! Communication steps and rates of outputs; and model exchange, where the importer integrates.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::Fmi3Boolean;
use super::life::{check_count, indices};
use crate::fmi2::guard::{Component, array, array_mut, exported, guarded, target};
use crate::fmi2::types::{fmi2Component, fmi2Status, fmi2ValueReference};
use crate::lifecycle::Call;
use crate::refusal::CallResult;

/// # Safety
/// `at` is NULL or points to room for a value.
unsafe fn put<T>(at: *mut T, value: T) {
    if !at.is_null() {
        // SAFETY: not NULL, and by the contract of this function
        unsafe { at.write(value) }
    }
}

exported! {
    /// Advances by one communication step, to its end or not at all.
    fmi3DoStep(
        currentCommunicationPoint: f64, communicationStepSize: f64,
        _noSetFMUStatePriorToCurrentPoint: Fmi3Boolean, eventHandlingNeeded: *mut bool,
        terminateSimulation: *mut bool, earlyReturn: *mut bool, lastSuccessfulTime: *mut f64
    ) Call::DoStep => |component| {
        for flag in [eventHandlingNeeded, terminateSimulation, earlyReturn] {
            put(flag, false);
        }
        let instance = &mut component.instance;
        let outcome = instance.do_step(currentCommunicationPoint, communicationStepSize);
        put(lastSuccessfulTime, instance.time_s());
        outcome
    };
    /// Reads first rates of outputs.
    fmi3GetOutputDerivatives(
        vr: *const fmi2ValueReference, nvr: usize, orders: *const i32, values: *mut f64, nValues: usize
    ) Call::GetRealOutputDerivatives => |component| {
        let references = array(vr, nvr, "valueReferences")?;
        let orders = array(orders, nvr, "orders")?;
        let of_each = of_elements(component, references, orders)?;
        let indices = indices(component, vr, nvr, "valueReferences")?;
        check_count("values", indices.len(), nValues)?;
        let values = array_mut(values, nValues, "values")?;
        component.instance.output_rates(&indices, &of_each, values)
    };
}

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

/// Orders of rates, one for each element of arrays.
fn of_elements(
    component: &Component,
    references: &[fmi2ValueReference],
    orders: &[i32],
) -> CallResult<Vec<i32>> {
    let mut all = Vec::with_capacity(references.len());
    for (reference, order) in references.iter().zip(orders) {
        let count = component.groups.indices(&[*reference])?.len();
        all.extend(std::iter::repeat_n(*order, count));
    }
    Ok(all)
}

/// Sets first rates of inputs, which FMI 3.0 cannot and the draft of FMI-LS-WASM can.
///
/// # Safety
/// A handle that has not been freed, or NULL.
pub unsafe fn set_input_derivatives(
    c: fmi2Component,
    references: &[fmi2ValueReference],
    orders: &[i32],
    values: &[f64],
) -> fmi2Status {
    let body = |component: &mut Component| {
        let indices = component.groups.indices(references)?;
        check_count("values", indices.len(), values.len())?;
        let orders = of_elements(component, references, orders)?;
        component
            .instance
            .set_input_rates(&indices, &orders, values)
    };
    // SAFETY: by the contract of this function
    unsafe {
        guarded(
            c,
            Call::SetRealInputDerivatives,
            "SetInputDerivatives",
            body,
        )
    }
}
