//! A running instance of an FMU, driven through its C interface.

mod fmi3;
mod values;

use super::description::{ModelDescription, ScalarVariable};
use super::library::{
    Binary, Component, Int, OwnFunctions, StatePointer, Status, Text, Truth, spelt,
};
use super::log::{LogBook, collect_plain, logger, messages_of};
use crate::error::{Error, Result, ensure};
use aerodeck_unit::fmi2::types::fmi2CallbackFunctions;
use std::cell::Cell;
use std::ffi::{CString, c_void};
use std::rc::Rc;
use std::sync::Arc;

/// The C side of an instance; freed with the last handle, so that saved states never outlive it.
struct FmuComponent {
    component: Component,
    fatal: Cell<bool>,
    binary: Arc<Binary>,
    // the FMU keeps the addresses of both
    _callbacks: Box<fmi2CallbackFunctions>,
    log: Box<LogBook>,
}

impl Drop for FmuComponent {
    fn drop(&mut self) {
        if !self.fatal.get() {
            // SAFETY: a live component of this library, freed once
            unsafe { (self.binary.shared.free_instance)(self.component) }
        }
    }
}

/// A running instance. A call that it answers with neither OK nor a warning returns [`Error::Numerical`] with status and log.
pub struct Slave {
    core: Rc<FmuComponent>,
    /// Of FMI 3.0, what each number was set to last, at first its start value: an element is set along with its whole array.
    kept: Vec<f64>,
    /// Whether the initialisation has begun, so that all numbers can be read.
    begun: bool,
}

impl Slave {
    pub(super) fn new(binary: &Arc<Binary>, name: &str, guid: &str, logging: bool) -> Result<Self> {
        let c_text = |what: &str, text: &str| {
            CString::new(text).map_err(|_| Error::input(what, "text without a zero byte", text))
        };
        let (c_name, c_guid) = (c_text("instance name", name)?, c_text("guid", guid)?);
        let c_resources = c_text("resource location", &binary.resources)?;
        let log = Box::new(LogBook::default());
        let callbacks = Box::new(fmi2CallbackFunctions {
            logger: Some(logger()),
            allocateMemory: Some(calloc),
            freeMemory: Some(free),
            stepFinished: None,
            componentEnvironment: std::ptr::from_ref(&*log).cast_mut().cast::<c_void>(),
        });
        let texts = [c_name.as_ptr(), c_guid.as_ptr(), c_resources.as_ptr()];
        let component = instantiated(&binary.own, texts, &callbacks, logging);
        if component.is_null() {
            let text = format!("`{name}` was not instantiated");
            return Err(with_log(text, &log));
        }
        Ok(Self {
            core: Rc::new(FmuComponent {
                component,
                fatal: Cell::new(false),
                binary: Arc::clone(binary),
                _callbacks: callbacks,
                log,
            }),
            kept: binary.description.start_values(),
            begun: false,
        })
    }

    /// The description of the FMU.
    pub fn model_description(&self) -> &ModelDescription {
        &self.core.binary.description
    }

    /// Messages logged so far, which are then forgotten.
    pub(crate) fn take_log(&self) -> Vec<String> {
        std::mem::take(&mut *messages_of(&self.core.log))
    }

    /// Turns an answer into a status; calls after a fatal one are refused here.
    fn status(&self, call: impl FnOnce(&Binary, Component) -> Int) -> Status {
        if self.core.fatal.get() {
            return Status::Fatal;
        }
        let status = Status::from_code(call(&self.core.binary, self.core.component));
        if status == Status::Fatal {
            self.core.fatal.set(true);
        }
        status
    }

    /// A call that has to succeed, under its name without the prefix of the version.
    fn good(&self, suffix: &str, call: impl FnOnce(&Binary, Component) -> Int) -> Result<()> {
        match self.status(call) {
            status if status.is_good() => Ok(()),
            status => Err(self.failed(suffix, status)),
        }
    }

    /// A function as the version of the FMU spells it.
    fn name_of(&self, suffix: &str) -> String {
        spelt(suffix, self.model_description().is_fmi3())
    }

    fn failed(&self, suffix: &str, status: Status) -> Error {
        let text = format!("{} answered {status:?}", self.name_of(suffix));
        with_log(text, &self.core.log)
    }

    /// `fmi2SetupExperiment` and `fmi2EnterInitializationMode`, which are one in FMI 3.0: times in s.
    ///
    /// # Errors
    /// [`Error::Numerical`] with status and log when the answer is neither OK nor a warning.
    pub fn enter_initialization(
        &mut self,
        start_s: f64,
        stop_s: Option<f64>,
        tolerance: Option<f64>,
    ) -> Result<()> {
        let ((with_tolerance, tolerance), (with_stop, stop)) = (stated(tolerance), stated(stop_s));
        if let OwnFunctions::Two(own) = &self.core.binary.own {
            let (limited, ends) = (with_tolerance.into(), with_stop.into());
            // SAFETY: plain values; so for every call below, with slices of the stated length
            self.good("SetupExperiment", |_, c| unsafe {
                (own.setup_experiment)(c, limited, tolerance, start_s, ends, stop)
            })?;
        }
        // SAFETY: the component lives; plain values
        self.good("EnterInitializationMode", |f, c| unsafe {
            match &f.own {
                OwnFunctions::Two(own) => (own.enter_initialization_mode)(c),
                OwnFunctions::Three(own) => (own.enter_initialization_mode)(
                    c,
                    with_tolerance,
                    tolerance,
                    start_s,
                    with_stop,
                    stop,
                ),
            }
        })?;
        self.begun = true;
        Ok(())
    }

    /// `fmi2ExitInitializationMode`.
    pub fn exit_initialization(&mut self) -> Result<()> {
        // SAFETY: the component lives; plain values
        self.good("ExitInitializationMode", |f, c| unsafe {
            (f.shared.exit_initialization_mode)(c)
        })
    }

    /// `fmi2DoStep` from `time_s` over `step_s`; a discarded step is an answer, not an error.
    ///
    /// # Errors
    /// [`Error::Numerical`] with status and log when the answer is an error.
    pub fn do_step(&mut self, time_s: f64, step_s: f64) -> Result<Status> {
        let (mut event, mut end, mut early, mut last) = (0, 0, 0, time_s);
        // SAFETY: the component lives; all four outlive the call
        let status = self.status(|f, c| unsafe {
            match &f.own {
                OwnFunctions::Two(own) => (own.do_step)(c, time_s, step_s, 1),
                OwnFunctions::Three(own) => (own.do_step)(
                    c, time_s, step_s, 1, &mut event, &mut end, &mut early, &mut last,
                ),
            }
        });
        // a step that ends early or asks for the end of the run was not done
        if status.is_good() && (end != 0 || early != 0) {
            return Ok(Status::Discard);
        }
        match status.is_good() || status == Status::Discard {
            true => Ok(status),
            false => Err(self.failed("DoStep", status)),
        }
    }

    /// As [`Slave::do_step`], where a step that is discarded is an error.
    pub(super) fn whole_step(&mut self, time_s: f64, step_s: f64) -> Result<()> {
        match self.do_step(time_s, step_s)? {
            Status::Discard => {
                let name = self.name_of("DoStep");
                let text = format!("{name} discarded the step from {time_s} s over {step_s} s");
                Err(Error::Numerical(text))
            }
            _ => Ok(()),
        }
    }

    /// `fmi2Terminate`.
    pub fn terminate(&mut self) -> Result<()> {
        // SAFETY: the component lives; plain values
        self.good("Terminate", |f, c| unsafe { (f.shared.terminate)(c) })
    }

    /// `fmi2Reset`.
    pub fn reset(&mut self) -> Result<()> {
        // SAFETY: the component lives; plain values
        self.good("Reset", |f, c| unsafe { (f.shared.reset)(c) })?;
        self.kept = self.model_description().start_values();
        self.begun = false;
        Ok(())
    }

    /// `fmi2GetFMUstate`.
    pub(crate) fn get_state(&self) -> Result<FmuState> {
        let mut pointer: StatePointer = std::ptr::null_mut();
        // SAFETY: the component lives, and the state is its own
        self.good("GetFMUstate", |f, c| unsafe {
            (f.shared.get_fmu_state)(c, &mut pointer)
        })?;
        Ok(self.state(pointer))
    }

    fn state(&self, pointer: StatePointer) -> FmuState {
        FmuState {
            pointer,
            core: Rc::clone(&self.core),
        }
    }

    /// `fmi2SetFMUstate`, for a state of this instance.
    ///
    /// # Errors
    /// [`Error::Input`] for a state of another instance.
    pub(crate) fn set_state(&mut self, state: &FmuState) -> Result<()> {
        self.own(state)?;
        // SAFETY: the component lives, and the state is its own
        self.good("SetFMUstate", |f, c| unsafe {
            (f.shared.set_fmu_state)(c, state.pointer)
        })
    }

    fn own(&self, state: &FmuState) -> Result<()> {
        let is_own = Rc::ptr_eq(&self.core, &state.core);
        let expected = "a state of this instance";
        ensure(is_own, "FMU state", expected, "one of another")
    }

    /// `fmi2SerializeFMUstate`: the state as bytes.
    ///
    /// # Errors
    /// [`Error::Input`] for a state of another instance.
    pub(crate) fn serialize_state(&self, state: &FmuState) -> Result<Vec<u8>> {
        self.own(state)?;
        let mut size = 0;
        // SAFETY: the component lives, and the state is its own
        self.good("SerializedFMUstateSize", |f, c| unsafe {
            (f.shared.serialized_fmu_state_size)(c, state.pointer, &mut size)
        })?;
        let mut bytes = vec![0; size];
        // SAFETY: the component lives, and the state is its own
        self.good("SerializeFMUstate", |f, c| unsafe {
            (f.shared.serialize_fmu_state)(c, state.pointer, bytes.as_mut_ptr(), size)
        })?;
        Ok(bytes)
    }

    /// `fmi2DeSerializeFMUstate`: bytes of an instance of the same FMU as a state of this one.
    pub(crate) fn deserialize_state(&self, bytes: &[u8]) -> Result<FmuState> {
        let mut pointer: StatePointer = std::ptr::null_mut();
        // SAFETY: the component lives, and the state is its own
        self.good("DeSerializeFMUstate", |f, c| unsafe {
            (f.shared.de_serialize_fmu_state)(c, bytes.as_ptr(), bytes.len(), &mut pointer)
        })?;
        Ok(self.state(pointer))
    }
}

/// A saved state of an instance.
pub struct FmuState {
    pointer: StatePointer,
    core: Rc<FmuComponent>,
}

impl Drop for FmuState {
    fn drop(&mut self) {
        if !self.core.fatal.get() {
            // SAFETY: a state of this component, which still lives
            unsafe {
                (self.core.binary.shared.free_fmu_state)(self.core.component, &mut self.pointer);
            }
        }
    }
}

/// Whether there is a number, as C is told, and which.
fn stated(number: Option<f64>) -> (Truth, f64) {
    (Truth::from(number.is_some()), number.unwrap_or(0.0))
}

/// A new component, or null; `texts` are name, fingerprint and place of the resources.
fn instantiated(
    functions: &OwnFunctions,
    [name, guid, resources]: [Text; 3],
    callbacks: &fmi2CallbackFunctions,
    logging: bool,
) -> Component {
    const CO_SIMULATION: Int = 1;
    let (log, none, environment) = (
        logging.into(),
        std::ptr::null(),
        callbacks.componentEnvironment,
    );
    // SAFETY: C strings and callbacks live through the call, callbacks and log as long as the instance
    unsafe {
        match functions {
            OwnFunctions::Two(own) => (own.instantiate)(
                name,
                CO_SIMULATION,
                guid,
                resources,
                callbacks,
                0,
                logging.into(),
            ),
            OwnFunctions::Three(own) => (own.instantiate)(
                name,
                guid,
                resources,
                0,
                log,
                0,
                0,
                none,
                0,
                environment,
                collect_plain,
                none.cast(),
            ),
        }
    }
}

/// The variable of that name.
pub(super) fn find<'a>(d: &'a ModelDescription, name: &str) -> Result<&'a ScalarVariable> {
    d.variable(name).ok_or_else(|| {
        let some = d.variables.iter().take(40);
        let some: Vec<_> = some.map(|v| v.name.as_str()).collect();
        let expected = format!("one of {}", some.join(", "));
        Error::input("variable", expected, format!("`{name}`"))
    })
}

/// The error of this text and the last messages.
fn with_log(mut text: String, log: &LogBook) -> Error {
    let messages = messages_of(log);
    let last = messages.len().saturating_sub(3);
    for message in &messages[last..] {
        text.push_str("; it logged: ");
        text.push_str(message);
    }
    Error::Numerical(text)
}

// of the C library that Rust's standard library links
unsafe extern "C" {
    fn calloc(count: usize, size: usize) -> *mut c_void;
    fn free(memory: *mut c_void);
}
