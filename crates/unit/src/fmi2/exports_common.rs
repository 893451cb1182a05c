//! Inquiry, creation, logging and the course of a run.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::guard::{Component, array, behave_as_a_guest, exported, guarded, panic_text};
use super::logger::{Category, Logger};
use super::types::{
    fmi2Boolean, fmi2CallbackFunctions, fmi2CoSimulation, fmi2Component, fmi2ModelExchange,
    fmi2Real, fmi2Status, fmi2String, fmi2Type,
};
use crate::instance::Instance;
use crate::lifecycle::Call;
use crate::log_categories::LOG_CATEGORIES;
use crate::refusal::{CallResult, Refusal};
use crate::resources::Resources;
use std::ffi::{CStr, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Platform of the C types.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

/// Version of the standard.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// Makes an instance from the model in the resources; NULL with a logged reason when anything is wrong. There is no
/// default model.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    instanceName: fmi2String,
    fmuType: fmi2Type,
    fmuGUID: fmi2String,
    fmuResourceLocation: fmi2String,
    functions: *const fmi2CallbackFunctions,
    _visible: fmi2Boolean,
    loggingOn: fmi2Boolean,
) -> fmi2Component {
    // SAFETY: NULL or valid by the contract of the interface; everything needed later is copied
    let (functions, name, guid, location) = unsafe {
        (
            functions.as_ref(),
            text(instanceName),
            text(fmuGUID),
            text(fmuResourceLocation),
        )
    };
    let logger = functions.and_then(|f| Logger::new(f, name.unwrap_or_default(), loggingOn != 0));
    let make = || instantiate(name, fmuType, guid, location);
    let component = made("Instantiate", logger, make);
    if let Some(component) = &component {
        let message = "fmi2Instantiate: instantiated";
        component.logger.log(Category::Events, message);
    }
    handle(component)
}

/// A component around what `instantiate` makes; none, with a logged reason, where it makes nothing.
pub(crate) fn made(
    function: &str,
    logger: Option<Logger>,
    instantiate: impl FnOnce() -> CallResult<Instance>,
) -> Option<Box<Component>> {
    behave_as_a_guest();
    let logger = logger?; // without one there is no one to tell
    let why = match catch_unwind(AssertUnwindSafe(instantiate)) {
        Ok(Ok(instance)) => return Some(Box::new(Component::new(instance, logger))),
        Ok(Err(refusal)) => refusal.message,
        Err(panic) => format!("internal error ({})", panic_text(&*panic)),
    };
    logger.say(Category::Error, function, why);
    None
}

/// What the importer holds of a component.
pub(crate) fn handle(component: Option<Box<Component>>) -> fmi2Component {
    component.map_or(std::ptr::null_mut(), |c| Box::into_raw(c).cast())
}

pub(crate) fn instantiate(
    name: Option<&CStr>,
    kind: fmi2Type,
    guid: Option<&CStr>,
    location: Option<&CStr>,
) -> CallResult<Instance> {
    check_name(name)?;
    if ![fmi2CoSimulation, fmi2ModelExchange].contains(&kind) {
        let expected = "model exchange (0) or co-simulation (1)";
        return Err(crate::Error::input("type of the unit", expected, kind.to_string()).into());
    }
    let utf8 = |place: &str, text: Option<&CStr>| {
        let utf8 = text.and_then(|t| t.to_str().ok()).map(str::to_owned);
        utf8.ok_or_else(|| {
            let found = text.map_or("NULL".into(), CStr::to_string_lossy);
            Refusal::from(crate::Error::input(place, "a UTF-8 text", found))
        })
    };
    let guid = utf8("GUID", guid)?;
    // NULL as an empty text: the archive is looked for around the library itself
    let location = location.map_or(Ok(String::new()), |_| utf8("resource location", location))?;
    identified(Resources::read(&location)?, kind, &guid)
}

/// Refuses what has no name in the log.
pub(crate) fn check_name(name: Option<&CStr>) -> CallResult<()> {
    if name.is_some_and(|n| !n.to_string_lossy().trim().is_empty()) {
        return Ok(());
    }
    let found = name.map_or("NULL", |_| "a blank one");
    Err(crate::Error::input("instance name", "a name", found).into())
}

/// An instance of what has been read, if it is what the description names.
pub(crate) fn identified(resources: Resources, kind: fmi2Type, guid: &str) -> CallResult<Instance> {
    let own = resources.guid.to_string();
    if guid != own {
        let expected =
            format!("{own} (from the variables, resources/model.json and the files beside it)");
        let wrong = crate::Error::input("GUID", &expected, format!("`{guid}`"));
        return Err(Refusal::from(wrong));
    }
    let instance = Instance::new(resources)?;
    if kind == fmi2ModelExchange {
        return instance.for_model_exchange();
    }
    Ok(instance)
}

/// # Safety
/// NULL, or a text ended by a zero byte that lives for the call.
pub(crate) unsafe fn text<'a>(pointer: fmi2String) -> Option<&'a CStr> {
    // SAFETY: by the contract of this function
    (!pointer.is_null()).then(|| unsafe { CStr::from_ptr(pointer) })
}

/// Frees an instance; NULL is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(c: fmi2Component) {
    if c.is_null() {
        return;
    }
    // SAFETY: not NULL, and by the contract of the interface made by fmi2Instantiate and not freed before
    let component = unsafe { Box::from_raw(c.cast::<Component>()) };
    // a panic while freeing leaves nothing to poison
    drop(catch_unwind(AssertUnwindSafe(|| drop(component))));
}

/// Switches log categories on or off; no categories means all.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    c: fmi2Component,
    loggingOn: fmi2Boolean,
    nCategories: usize,
    categories: *const fmi2String,
) -> fmi2Status {
    let body = |component: &mut Component| {
        // SAFETY: arrays and texts are valid by the contract of the interface
        let names = unsafe { array(categories, nCategories, "categories") }?;
        let mut selected = Vec::with_capacity(names.len());
        for name in names {
            // SAFETY: as above
            let name = unsafe { text(*name) };
            let mut known = LOG_CATEGORIES.into_iter().map(|(known, _)| known);
            let known = known.find(|known| Some(*known) == name);
            selected.push(known.ok_or_else(|| {
                let name = name.map_or("NULL".to_owned(), |n| format!("`{}`", n.to_string_lossy()));
                Refusal::call(format!(
                    "log category: expected one of the description, found {name}"
                ))
            })?);
        }
        component.logger.select(loggingOn != 0, selected);
        Ok(())
    };
    // SAFETY: by the contract of the interface
    unsafe { guarded(c, Call::SetDebugLogging, "SetDebugLogging", body) }
}

exported! {
    /// Sets start and stop time of the run, s. The tolerance is not needed: steps are exact.
    fmi2SetupExperiment(
        _toleranceDefined: fmi2Boolean, _tolerance: fmi2Real, startTime: fmi2Real,
        stopTimeDefined: fmi2Boolean, stopTime: fmi2Real
    ) Call::SetupExperiment =>
        |component| component.instance.set_up_experiment(startTime, (stopTimeDefined != 0).then_some(stopTime));
    /// Begins the initialisation.
    fmi2EnterInitializationMode() Call::EnterInitializationMode => |component| {
        component.instance.enter_initialization();
        Ok(())
    };
    /// Releases the section.
    fmi2ExitInitializationMode() Call::ExitInitializationMode => |component| {
        component.instance.exit_initialization()?;
        let message = format!("released at {} s", component.instance.time_s());
        component.logger.log(Category::Events, &message);
        Ok(())
    };
    /// Ends the run.
    fmi2Terminate() Call::Terminate => |component| {
        component.instance.terminate();
        Ok(())
    };
    /// Restores every default, as after instantiation; logging stays as it is.
    fmi2Reset() Call::Reset => |component| {
        component.instance.reset();
        let message = "every default restored";
        component.logger.log(Category::Events, message);
        Ok(())
    };
}
