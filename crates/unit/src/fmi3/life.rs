//! Inquiry, creation, logging and the course of a run.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::Fmi3Boolean;
use crate::fmi2::guard::{
    Component, array, behave_as_a_guest, exported, guarded, panic_text, shielded,
};
use crate::fmi2::logger::{Category, Logger, PlainLogger};
use crate::fmi2::types::{
    fmi2CoSimulation, fmi2Component, fmi2ModelExchange, fmi2Status, fmi2String, fmi2Type,
    fmi2ValueReference,
};
use crate::fmi2::{fmi2FreeInstance, fmi2Reset, instantiate, text};
use crate::groups::Groups;
use crate::lifecycle::Call;
use crate::refusal::{CallResult, Refusal};
use std::ffi::{c_char, c_void};

/// Version of the standard.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// # Safety
/// Texts are NULL or end with a zero byte.
unsafe fn made(
    function: &str,
    kind: fmi2Type,
    [name, token, path]: [fmi2String; 3],
    logger: Option<Logger>,
) -> fmi2Component {
    behave_as_a_guest();
    let Some(logger) = logger else {
        return std::ptr::null_mut(); // without a logger there is no one to tell
    };
    // SAFETY: by the contract of this function; everything needed later is copied
    let (name, token, path) = unsafe { (text(name), text(token), text(path)) };
    let refuse = |why: &str| {
        let message = format!("fmi3{function}: {why}");
        logger.log(fmi2Status::fmi2Error, Category::Error, &message);
        std::ptr::null_mut()
    };
    match shielded(|| instantiate(name, kind, token, path)) {
        Ok(Ok(instance)) => {
            let mut component = Component::new(instance, logger);
            component.groups = Groups::new(component.instance.table());
            Box::into_raw(Box::new(component)).cast()
        }
        Ok(Err(refusal)) => refuse(&refusal.message),
        Err(panic) => refuse(&format!("internal error ({})", panic_text(&*panic))),
    }
}

/// Makes an instance that steps itself; NULL with a logged reason when anything is wrong. Event mode, early return and
/// intermediate updates are not offered, as the description says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    instanceName: fmi2String,
    instantiationToken: fmi2String,
    resourcePath: fmi2String,
    _visible: Fmi3Boolean,
    loggingOn: Fmi3Boolean,
    _eventModeUsed: Fmi3Boolean,
    _earlyReturnAllowed: Fmi3Boolean,
    _requiredIntermediateVariables: *const fmi2ValueReference,
    _nRequiredIntermediateVariables: usize,
    instanceEnvironment: *mut c_void,
    logMessage: Option<PlainLogger>,
    _intermediateUpdate: *const c_void,
) -> fmi2Component {
    let logger = logMessage.map(|log| Logger::plain(log, instanceEnvironment, loggingOn != 0));
    let texts = [instanceName, instantiationToken, resourcePath];
    // SAFETY: by the contract of the interface
    unsafe { made("InstantiateCoSimulation", fmi2CoSimulation, texts, logger) }
}

/// Makes an instance that the importer integrates; NULL with a logged reason when anything is wrong.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    instanceName: fmi2String,
    instantiationToken: fmi2String,
    resourcePath: fmi2String,
    _visible: Fmi3Boolean,
    loggingOn: Fmi3Boolean,
    instanceEnvironment: *mut c_void,
    logMessage: Option<PlainLogger>,
) -> fmi2Component {
    let logger = logMessage.map(|log| Logger::plain(log, instanceEnvironment, loggingOn != 0));
    let texts = [instanceName, instantiationToken, resourcePath];
    // SAFETY: by the contract of the interface
    unsafe { made("InstantiateModelExchange", fmi2ModelExchange, texts, logger) }
}

/// Not offered.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    _instanceName: fmi2String,
    _instantiationToken: fmi2String,
    _resourcePath: fmi2String,
    _visible: Fmi3Boolean,
    loggingOn: Fmi3Boolean,
    instanceEnvironment: *mut c_void,
    logMessage: Option<PlainLogger>,
    _clockUpdate: *const c_void,
    _lockPreemption: *const c_void,
    _unlockPreemption: *const c_void,
) -> fmi2Component {
    if let Some(log) = logMessage {
        let logger = Logger::plain(log, instanceEnvironment, loggingOn != 0);
        let message = "fmi3InstantiateScheduledExecution: scheduled execution is not offered";
        logger.log(fmi2Status::fmi2Error, Category::Error, message);
    }
    std::ptr::null_mut()
}

/// Frees an instance; NULL is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeInstance(c: fmi2Component) {
    // SAFETY: by the contract of the interface
    unsafe { fmi2FreeInstance(c) }
}

as_in_fmi2! {
    /// Switches log categories on or off; no categories means all.
    fmi3SetDebugLogging(
        loggingOn: Fmi3Boolean, nCategories: usize, categories: *const fmi2String
    ) => fmi2SetDebugLogging(i32::from(loggingOn != 0), nCategories, categories);
}

exported! {
    /// Sets the times of the run (s) and begins the initialisation. The tolerance is not needed: steps are exact.
    fmi3EnterInitializationMode(
        _toleranceDefined: Fmi3Boolean, _tolerance: f64, startTime: f64, stopTimeDefined: Fmi3Boolean,
        stopTime: f64
    ) Call::EnterInitializationMode => |component| {
        if component.configuration.is_some() {
            return Err(Refusal::error("the configuration mode was not left"));
        }
        component.instance.set_up_experiment(startTime, (stopTimeDefined != 0).then_some(stopTime))?;
        component.instance.enter_initialization();
        Ok(())
    };
}

as_in_fmi2! {
    /// Releases the section.
    fmi3ExitInitializationMode() => fmi2ExitInitializationMode();
    /// Ends the run.
    fmi3Terminate() => fmi2Terminate();
}

/// Restores every default, as after instantiation; logging stays as it is.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3Reset(c: fmi2Component) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe {
        let as_exported = guarded(c, Call::Reset, |component| {
            component.configuration = None;
            if component.instance.is_resized() {
                component.replace(component.instance.resized(None)?);
            }
            Ok(())
        });
        match as_exported {
            fmi2Status::fmi2OK => fmi2Reset(c),
            refused => refused,
        }
    }
}

/// The places of an array of references.
///
/// # Safety
/// NULL, or `count` references.
pub(super) unsafe fn places(
    component: &Component,
    references: *const fmi2ValueReference,
    count: usize,
    name: &str,
) -> CallResult<Vec<u32>> {
    // SAFETY: by the contract of this function
    let references = unsafe { array(references, count, name) }?;
    Ok(component.groups.places(references)?.into_owned())
}

/// Refuses arrays of other lengths than the variables have.
pub(super) fn check_count(name: &str, expected: usize, found: usize) -> CallResult<()> {
    if expected == found {
        return Ok(());
    }
    Err(Refusal::error(format!(
        "{name}: expected {expected} values, found {found}"
    )))
}
