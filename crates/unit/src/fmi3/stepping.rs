//! Communication steps and rates of outputs.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::Fmi3Boolean;
use super::life::{check_count, places};
use crate::fmi2::guard::{array, array_mut, exported};
use crate::fmi2::types::fmi2ValueReference;
use crate::lifecycle::Call;

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
    ) Call::GetRealOutputDerivatives.by("GetOutputDerivatives") => |component| {
        let references = array(vr, nvr, "valueReferences")?;
        let orders = array(orders, nvr, "orders")?;
        let mut of_each = Vec::with_capacity(nValues);
        for (reference, order) in references.iter().zip(orders) {
            let count = component.groups.places(std::slice::from_ref(reference))?.len();
            of_each.extend(std::iter::repeat_n(*order, count));
        }
        let places = places(component, vr, nvr, "valueReferences")?;
        check_count("values", places.len(), nValues)?;
        let values = array_mut(values, nValues, "values")?;
        component.instance.output_rates(&places, &of_each, values)
    };
}
