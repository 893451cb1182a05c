//! Inquiry, creation, logging and the course of a run.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::Fmi3Boolean;
use crate::fmi2::guard::{Component, array, exported, guarded};
use crate::fmi2::logger::{Category, Logger, PlainLogger};
use crate::fmi2::types::{
    fmi2CoSimulation, fmi2Component, fmi2ModelExchange, fmi2Status, fmi2String, fmi2Type,
    fmi2ValueReference,
};
use crate::fmi2::{
    check_name, fmi2FreeInstance, fmi2Reset, handle, identified, instantiate, made, text,
};
use crate::groups::Groups;
use crate::lifecycle::Call;
use crate::refusal::{CallResult, Refusal};
use crate::resources::Resources;
use std::ffi::{CStr, c_char, c_void};
use std::path::Path;

/// Version of the standard.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// # Safety
/// Texts are NULL or end with a zero byte.
unsafe fn made_of_texts(
    function: &str,
    kind: fmi2Type,
    texts: [fmi2String; 3],
    logger: Option<Logger>,
) -> fmi2Component {
    // SAFETY: by the contract of this function; everything needed later is copied
    let [name, token, path] = texts.map(|pointer| unsafe { text(pointer) });
    in_groups(made(function, logger, || {
        instantiate(name, kind, token, path)
    }))
}

/// What the importer holds of a component whose variables it knows by their groups.
fn in_groups(mut component: Option<Box<Component>>) -> fmi2Component {
    if let Some(component) = &mut component {
        component.groups = Groups::new(component.instance.table());
    }
    handle(component)
}

/// An instance for co-simulation of files that the importer reads itself, as [`fmi3InstantiateCoSimulation`] makes one of a folder. The
/// handle is one for all functions of this module, [`fmi3FreeInstance`] included; `log` writes with the environment beside it.
pub fn instantiate_from_files(
    name: &CStr,
    token: &str,
    logging_on: bool,
    log: PlainLogger,
    environment: *mut c_void,
    read: &dyn Fn(&Path) -> crate::error::Result<Option<Vec<u8>>>,
) -> fmi2Component {
    let logger = Logger::plain(log, environment, logging_on);
    in_groups(made("InstantiateCoSimulation", Some(logger), || {
        check_name(Some(name))?;
        let resources = Resources::from_files(Path::new("resources"), read)?;
        identified(resources, fmi2CoSimulation, token)
    }))
}

/// How many values some variables have, elements of arrays counted; as many as references where one of them is unknown.
///
/// # Safety
/// A handle that has not been freed.
pub unsafe fn count_of_values(c: fmi2Component, references: &[fmi2ValueReference]) -> usize {
    // SAFETY: by the contract of this function
    let Some(component) = (unsafe { c.cast::<Component>().as_ref() }) else {
        return references.len();
    };
    let groups = &component.groups;
    let count = |reference: &fmi2ValueReference| match groups.names_at(*reference) {
        Some(names) => names.of.len(),
        None => groups
            .indices(&[*reference])
            .map_or(1, |indices| indices.len()),
    };
    references.iter().map(count).sum()
}

/// Makes an instance that steps itself; NULL with a logged reason when anything is wrong. Event mode, early return and
/// intermediate updates are not offered, as the description says; a wish for event mode is answered with a warning.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    instanceName: fmi2String,
    instantiationToken: fmi2String,
    resourcePath: fmi2String,
    _visible: Fmi3Boolean,
    loggingOn: Fmi3Boolean,
    eventModeUsed: Fmi3Boolean,
    _earlyReturnAllowed: Fmi3Boolean,
    _requiredIntermediateVariables: *const fmi2ValueReference,
    _nRequiredIntermediateVariables: usize,
    instanceEnvironment: *mut c_void,
    logMessage: Option<PlainLogger>,
    _intermediateUpdate: *const c_void,
) -> fmi2Component {
    let logger = logMessage.map(|log| Logger::plain(log, instanceEnvironment, loggingOn != 0));
    let texts = [instanceName, instantiationToken, resourcePath];
    // SAFETY: by the contract of the interface; the handle is new
    unsafe {
        let handle = made_of_texts("InstantiateCoSimulation", fmi2CoSimulation, texts, logger);
        let component = handle.cast::<Component>().as_ref();
        if let Some(component) = component.filter(|_| eventModeUsed != 0) {
            let message = "fmi3InstantiateCoSimulation: eventModeUsed: expected false, as hasEventMode of the description, found \
                           true: steps follow the initialisation at once";
            component.logger.log(Category::Warning, message);
        }
        handle
    }
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
    unsafe { made_of_texts("InstantiateModelExchange", fmi2ModelExchange, texts, logger) }
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
        logger.log(Category::Error, message);
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
        let as_exported = guarded(c, Call::Reset, "Reset", |component| {
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

/// The indices of an array of references.
///
/// # Safety
/// NULL, or `count` references.
pub(super) unsafe fn indices(
    component: &Component,
    references: *const fmi2ValueReference,
    count: usize,
    name: &str,
) -> CallResult<Vec<u32>> {
    // SAFETY: by the contract of this function
    let references = unsafe { array(references, count, name) }?;
    Ok(component.groups.indices(references)?.into_owned())
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
