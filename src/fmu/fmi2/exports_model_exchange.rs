//! The functions of model exchange. They are not offered; importers that look up every function find them.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::guard::not_offered;
use super::types::{fmi2Boolean, fmi2Component, fmi2Real, fmi2Status};
use std::ffi::c_void;

const WHY: &str = "this unit is for co-simulation, model exchange is not offered";

/// Not offered.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterEventMode(c: fmi2Component) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { not_offered(c, "EnterEventMode", WHY) }
}

/// Not offered.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2NewDiscreteStates(
    c: fmi2Component,
    _eventInfo: *mut c_void,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { not_offered(c, "NewDiscreteStates", WHY) }
}

/// Not offered.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterContinuousTimeMode(c: fmi2Component) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { not_offered(c, "EnterContinuousTimeMode", WHY) }
}

/// Not offered.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CompletedIntegratorStep(
    c: fmi2Component,
    _noSetFMUStatePriorToCurrentPoint: fmi2Boolean,
    _enterEventMode: *mut fmi2Boolean,
    _terminateSimulation: *mut fmi2Boolean,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { not_offered(c, "CompletedIntegratorStep", WHY) }
}

/// Not offered.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetTime(c: fmi2Component, _time: fmi2Real) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { not_offered(c, "SetTime", WHY) }
}

/// Not offered.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetContinuousStates(
    c: fmi2Component,
    _x: *const fmi2Real,
    _nx: usize,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { not_offered(c, "SetContinuousStates", WHY) }
}

/// Not offered.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDerivatives(
    c: fmi2Component,
    _derivatives: *mut fmi2Real,
    _nx: usize,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { not_offered(c, "GetDerivatives", WHY) }
}

/// Not offered.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetEventIndicators(
    c: fmi2Component,
    _eventIndicators: *mut fmi2Real,
    _ni: usize,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { not_offered(c, "GetEventIndicators", WHY) }
}

/// Not offered.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetContinuousStates(
    c: fmi2Component,
    _x: *mut fmi2Real,
    _nx: usize,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { not_offered(c, "GetContinuousStates", WHY) }
}

/// Not offered.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetNominalsOfContinuousStates(
    c: fmi2Component,
    _x_nominal: *mut fmi2Real,
    _nx: usize,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { not_offered(c, "GetNominalsOfContinuousStates", WHY) }
}
