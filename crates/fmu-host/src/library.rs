//! The shared library of an FMU: the 34 functions of FMI 2.0 co-simulation with their C signatures.

use super::findings::FmuFindings;
use crate::error::{Error, Result};
use libloading::Library;
use std::ffi::{c_char, c_int, c_uint, c_void};
use std::path::Path;

/// `fmi2Component`.
pub(super) type Component = *mut c_void;
/// `fmi2FMUstate`.
pub(super) type StatePointer = *mut c_void;
/// `fmi2ValueReference`.
pub(super) type ValueReference = c_uint;
/// `fmi2Boolean`, `fmi2Status`, `fmi2StatusKind`, `fmi2Type`: all C ints.
pub(super) type Int = c_int;
/// `fmi2String`.
pub(super) type Text = *const c_char;

/// The logger with its variable arguments, which a C importer would read.
pub(super) type LoggerPointer = unsafe extern "C" fn(
    env: *mut c_void,
    name: Text,
    status: Int,
    category: Text,
    message: Text,
    ...
);

/// `fmi2CallbackFunctions`.
#[repr(C)]
pub(super) struct CallbackFunctions {
    pub logger: LoggerPointer,
    pub allocate_memory: unsafe extern "C" fn(usize, usize) -> *mut c_void,
    pub free_memory: unsafe extern "C" fn(*mut c_void),
    pub step_finished: Option<unsafe extern "C" fn(*mut c_void, Int)>,
    pub environment: *mut c_void,
}

/// Declares the table of functions and how it is filled, from one list of names and signatures.
macro_rules! functions {
    ($($field:ident = $symbol:literal : fn($($argument:ty),*) -> $answer:ty;)*) => {
        /// The functions; pointers are valid as long as the [`Library`] they came from.
        #[derive(Clone, Copy)]
        #[allow(dead_code, reason = "all must be there, also those that this importer has no use for")]
        pub(super) struct Functions {
            $(pub $field: unsafe extern "C" fn($($argument),*) -> $answer,)*
        }

        /// Names of all functions that must be there, supported or not.
        pub(super) const SYMBOLS: [&str; 34] = [$($symbol),*];

        impl Functions {
            /// Looks all functions up.
            fn load(library: &Library) -> Result<Self> {
                Ok(Self {
                    // SAFETY: the signature is that of the standard for this name
                    $($field: *unsafe { library.get($symbol.as_bytes()) }
                        .map_err(|e| Error::input($symbol, "this function in the binary", e.to_string()))?,)*
                })
            }
        }
    };
}

functions! {
    get_types_platform = "fmi2GetTypesPlatform": fn() -> Text;
    get_version = "fmi2GetVersion": fn() -> Text;
    set_debug_logging = "fmi2SetDebugLogging": fn(Component, Int, usize, *const Text) -> Int;
    instantiate = "fmi2Instantiate": fn(Text, Int, Text, Text, *const CallbackFunctions, Int, Int) -> Component;
    free_instance = "fmi2FreeInstance": fn(Component) -> ();
    setup_experiment = "fmi2SetupExperiment": fn(Component, Int, f64, f64, Int, f64) -> Int;
    enter_initialization_mode = "fmi2EnterInitializationMode": fn(Component) -> Int;
    exit_initialization_mode = "fmi2ExitInitializationMode": fn(Component) -> Int;
    terminate = "fmi2Terminate": fn(Component) -> Int;
    reset = "fmi2Reset": fn(Component) -> Int;
    get_real = "fmi2GetReal": fn(Component, *const ValueReference, usize, *mut f64) -> Int;
    get_integer = "fmi2GetInteger": fn(Component, *const ValueReference, usize, *mut c_int) -> Int;
    get_boolean = "fmi2GetBoolean": fn(Component, *const ValueReference, usize, *mut Int) -> Int;
    get_string = "fmi2GetString": fn(Component, *const ValueReference, usize, *mut Text) -> Int;
    set_real = "fmi2SetReal": fn(Component, *const ValueReference, usize, *const f64) -> Int;
    set_integer = "fmi2SetInteger": fn(Component, *const ValueReference, usize, *const c_int) -> Int;
    set_boolean = "fmi2SetBoolean": fn(Component, *const ValueReference, usize, *const Int) -> Int;
    set_string = "fmi2SetString": fn(Component, *const ValueReference, usize, *const Text) -> Int;
    get_fmu_state = "fmi2GetFMUstate": fn(Component, *mut StatePointer) -> Int;
    set_fmu_state = "fmi2SetFMUstate": fn(Component, StatePointer) -> Int;
    free_fmu_state = "fmi2FreeFMUstate": fn(Component, *mut StatePointer) -> Int;
    serialized_fmu_state_size = "fmi2SerializedFMUstateSize": fn(Component, StatePointer, *mut usize) -> Int;
    serialize_fmu_state = "fmi2SerializeFMUstate": fn(Component, StatePointer, *mut u8, usize) -> Int;
    de_serialize_fmu_state = "fmi2DeSerializeFMUstate": fn(Component, *const u8, usize, *mut StatePointer) -> Int;
    get_directional_derivative = "fmi2GetDirectionalDerivative":
        fn(Component, *const ValueReference, usize, *const ValueReference, usize, *const f64, *mut f64) -> Int;
    set_real_input_derivatives = "fmi2SetRealInputDerivatives":
        fn(Component, *const ValueReference, usize, *const c_int, *const f64) -> Int;
    get_real_output_derivatives = "fmi2GetRealOutputDerivatives":
        fn(Component, *const ValueReference, usize, *const c_int, *mut f64) -> Int;
    do_step = "fmi2DoStep": fn(Component, f64, f64, Int) -> Int;
    cancel_step = "fmi2CancelStep": fn(Component) -> Int;
    get_status = "fmi2GetStatus": fn(Component, Int, *mut Int) -> Int;
    get_real_status = "fmi2GetRealStatus": fn(Component, Int, *mut f64) -> Int;
    get_integer_status = "fmi2GetIntegerStatus": fn(Component, Int, *mut c_int) -> Int;
    get_boolean_status = "fmi2GetBooleanStatus": fn(Component, Int, *mut Int) -> Int;
    get_string_status = "fmi2GetStringStatus": fn(Component, Int, *mut Text) -> Int;
}

/// A loaded binary with its functions.
pub(super) struct Binary {
    pub functions: Functions,
    // unloaded after the last use of the functions
    _library: Library,
}

impl Binary {
    /// Loads the library and looks all functions up.
    ///
    /// # Errors
    /// [`Error::Input`] with what the loader said, or naming the function that is missing.
    pub(super) fn load(path: &Path) -> Result<Self> {
        let library = open(path)?;
        let functions = Functions::load(&library)?;
        Ok(Self {
            functions,
            _library: library,
        })
    }
}

/// Adds a finding for each function that is missing; loading problems come as one finding.
pub(super) fn check_symbols(path: &Path, place: &str, findings: &mut FmuFindings) {
    match open(path) {
        Err(e) => findings.error(place, "a library that loads", e.to_string()),
        Ok(library) => {
            for symbol in SYMBOLS {
                // SAFETY: only asked whether it is there, never called through this type
                if unsafe { library.get::<unsafe extern "C" fn()>(symbol.as_bytes()) }.is_err() {
                    findings.error(place, format!("the function {symbol}"), "none");
                }
            }
        }
    }
}

fn open(path: &Path) -> Result<Library> {
    // SAFETY: initialisers of the library run; that is what loading an FMU means, and its user asked for it
    unsafe { Library::new(path) }.map_err(|e| {
        Error::input(
            "binary",
            "a shared library that loads on this machine",
            e.to_string(),
        )
    })
}
