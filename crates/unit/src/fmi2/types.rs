//! C types of FMI 2.0 under the names of the standard. `fmi2Boolean` is a C `int`.
//!
//! What comes in as an enumeration is taken as an integer: any number may arrive.
#![allow(non_camel_case_types, non_upper_case_globals, non_snake_case)]

use std::ffi::{c_char, c_int, c_uint, c_void};

/// Handle of an instance.
pub(crate) type fmi2Component = *mut c_void;
/// Handle of the importer, passed back to its callbacks.
pub(crate) type fmi2ComponentEnvironment = *mut c_void;
/// Handle of a saved state.
pub type fmi2FMUstate = *mut c_void;
/// Place in the variable table.
pub(crate) type fmi2ValueReference = c_uint;
/// Real number.
pub(crate) type fmi2Real = f64;
/// Integer.
pub(crate) type fmi2Integer = c_int;
/// Truth value: 0 is false, everything else true.
pub type fmi2Boolean = c_int;
/// Text, UTF-8, ended by a zero byte.
pub(crate) type fmi2String = *const c_char;
/// Byte of a serialised state.
pub(crate) type fmi2Byte = c_char;
/// Kind of unit asked for: [`fmi2ModelExchange`] or [`fmi2CoSimulation`].
pub(crate) type fmi2Type = c_int;
/// What status is asked for.
pub(crate) type fmi2StatusKind = c_int;

/// Model exchange.
pub(crate) const fmi2ModelExchange: fmi2Type = 0;
/// Co-simulation.
pub(crate) const fmi2CoSimulation: fmi2Type = 1;

/// Status of a pending step.
pub const fmi2DoStepStatus: fmi2StatusKind = 0;
/// End of the last successful step.
pub const fmi2LastSuccessfulTime: fmi2StatusKind = 2;
/// Whether the unit wants to end the run.
pub const fmi2Terminated: fmi2StatusKind = 3;

/// Result of a call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub enum fmi2Status {
    /// All well.
    fmi2OK,
    /// Done, but something is unexpected.
    fmi2Warning,
    /// Refused; everything is as it was.
    fmi2Discard,
    /// Failed; the run cannot go on.
    fmi2Error,
    /// Failed; nothing can go on.
    fmi2Fatal,
    /// Not finished yet.
    fmi2Pending,
}

/// What an event has changed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(C)]
pub struct fmi2EventInfo {
    /// Another look is needed.
    pub newDiscreteStatesNeeded: fmi2Boolean,
    /// The run has to end.
    pub terminateSimulation: fmi2Boolean,
    /// Usual sizes of states have changed.
    pub nominalsOfContinuousStatesChanged: fmi2Boolean,
    /// States have changed.
    pub valuesOfContinuousStatesChanged: fmi2Boolean,
    /// There is a next event in time.
    pub nextEventTimeDefined: fmi2Boolean,
    /// Its time, s.
    pub nextEventTime: fmi2Real,
}

/// Writes a message: a `printf` format, arguments variadic.
pub type fmi2CallbackLogger = unsafe extern "C" fn(
    fmi2ComponentEnvironment,
    fmi2String,
    fmi2Status,
    fmi2String,
    fmi2String,
    ...
);

/// Functions of the importer. Only the logger is used: memory is our own, and no step is left pending.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct fmi2CallbackFunctions {
    /// Writes a message.
    pub logger: Option<fmi2CallbackLogger>,
    /// Allocates memory.
    pub allocateMemory: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    /// Frees memory.
    pub freeMemory: Option<unsafe extern "C" fn(*mut c_void)>,
    /// Is called at the end of a pending step.
    pub stepFinished: Option<unsafe extern "C" fn(fmi2ComponentEnvironment, fmi2Status)>,
    /// Handle for the callbacks.
    pub componentEnvironment: fmi2ComponentEnvironment,
}
