//! The shared library of an FMU: the functions of co-simulation, of FMI 2.0 and of 3.0, with their C signatures.

use super::description::ModelDescription;
use super::findings::FmuFindings;
use super::reading_fmi3::NUMERIC;
use crate::error::{Error, Result, ensure};
use crate::location::location_of;
use aerodeck_unit::fmi2::types::fmi2CallbackFunctions;
use libloading::Library;
use std::ffi::{c_char, c_int, c_uint, c_void};
use std::path::Path;
use std::sync::Arc;
use tempfile::TempDir;

/// `fmi2Component`.
pub(super) type Component = *mut c_void;
/// `fmi2FMUstate`.
pub(super) type StatePointer = *mut c_void;
/// `fmi2ValueReference`.
pub(super) type ValueReference = c_uint;
/// `fmi2Boolean`, `fmi2Status`, `fmi2StatusKind`, `fmi2Type`: all C ints.
pub(super) type Int = c_int;
/// `fmi3Boolean`, whatever byte a binary puts there.
pub(super) type Truth = u8;
/// `fmi2String`.
pub(super) type Text = *const c_char;

/// Answer of a function of FMI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Done.
    Ok,
    /// Done, with a remark in the log.
    Warning,
    /// Not done; the instance is as before.
    Discard,
    /// Not done; the instance is of no further use.
    Error,
    /// As error, for all instances.
    Fatal,
    /// Not finished yet.
    Pending,
    /// A number that is no status.
    Unknown(i32),
}

impl Status {
    pub(super) fn from_code(code: Int) -> Self {
        use Status::{Discard, Error, Fatal, Ok, Pending, Unknown, Warning};
        let known = [Ok, Warning, Discard, Error, Fatal, Pending];
        let index = usize::try_from(code).ok();
        let status = index.and_then(|index| known.get(index).copied());
        status.unwrap_or(Unknown(code))
    }

    /// Whether the call did what it should.
    pub(crate) fn is_good(self) -> bool {
        matches!(self, Self::Ok | Self::Warning)
    }
}

/// The logger of FMI 3.0.
pub(super) type PlainLoggerPointer =
    unsafe extern "C" fn(env: *mut c_void, status: Int, category: Text, message: Text);

/// Declares a table of functions and how it is filled, from one list of names and signatures.
macro_rules! functions {
    ($table:ident, $($field:ident = $suffix:literal : fn($($argument:ty),*) -> $answer:ty;)*) => {
        /// Functions; pointers are valid as long as the [`Library`] they came from.
        #[derive(Clone, Copy)]
        #[allow(dead_code, reason = "all must be there, also those that this importer has no use for")]
        pub(super) struct $table {
            $(pub $field: unsafe extern "C" fn($($argument),*) -> $answer,)*
        }

        impl $table {
            /// Names without the prefix of the version.
            const SUFFIXES: &[&str] = &[$($suffix),*];

            /// Looks all functions up.
            fn load(library: &Library, is_fmi3: bool) -> Result<Self> {
                Ok(Self {
                    $($field: {
                        // SAFETY: the signature is that of the standard for this name
                        unsafe { function(library, &spelt($suffix, is_fmi3)) }?
                    },)*
                })
            }
        }
    };
}

/// Looks a function up.
///
/// # Safety
/// `F` is the type of a pointer to the function of this name.
unsafe fn function<F: Copy>(library: &Library, symbol: &str) -> Result<F> {
    // SAFETY: by the contract of this function
    let found = unsafe { library.get::<F>(symbol.as_bytes()) };
    found
        .map(|found| *found)
        .map_err(|e| Error::input(symbol, "this function in the binary", e.to_string()))
}

/// Name of a function in a version of the standard, which differ in the case of some.
pub(super) fn spelt(suffix: &str, is_fmi3: bool) -> String {
    if !is_fmi3 {
        return format!("fmi2{suffix}");
    }
    let suffix = suffix.replace("FMUstate", "FMUState");
    format!("fmi3{}", suffix.replace("DeSer", "Deser"))
}

// what both versions have with the same arguments
functions! { SharedFunctions,
    get_version = "GetVersion": fn() -> Text;
    free_instance = "FreeInstance": fn(Component) -> ();
    exit_initialization_mode = "ExitInitializationMode": fn(Component) -> Int;
    terminate = "Terminate": fn(Component) -> Int;
    reset = "Reset": fn(Component) -> Int;
    get_fmu_state = "GetFMUstate": fn(Component, *mut StatePointer) -> Int;
    set_fmu_state = "SetFMUstate": fn(Component, StatePointer) -> Int;
    free_fmu_state = "FreeFMUstate": fn(Component, *mut StatePointer) -> Int;
    serialized_fmu_state_size = "SerializedFMUstateSize": fn(Component, StatePointer, *mut usize) -> Int;
    serialize_fmu_state = "SerializeFMUstate": fn(Component, StatePointer, *mut u8, usize) -> Int;
    de_serialize_fmu_state = "DeSerializeFMUstate": fn(Component, *const u8, usize, *mut StatePointer) -> Int;
}

functions! { Fmi2Functions,
    get_types_platform = "GetTypesPlatform": fn() -> Text;
    set_debug_logging = "SetDebugLogging": fn(Component, Int, usize, *const Text) -> Int;
    instantiate = "Instantiate": fn(Text, Int, Text, Text, *const fmi2CallbackFunctions, Int, Int) -> Component;
    setup_experiment = "SetupExperiment": fn(Component, Int, f64, f64, Int, f64) -> Int;
    enter_initialization_mode = "EnterInitializationMode": fn(Component) -> Int;
    get_real = "GetReal": fn(Component, *const ValueReference, usize, *mut f64) -> Int;
    get_integer = "GetInteger": fn(Component, *const ValueReference, usize, *mut c_int) -> Int;
    get_boolean = "GetBoolean": fn(Component, *const ValueReference, usize, *mut Int) -> Int;
    get_string = "GetString": fn(Component, *const ValueReference, usize, *mut Text) -> Int;
    set_real = "SetReal": fn(Component, *const ValueReference, usize, *const f64) -> Int;
    set_integer = "SetInteger": fn(Component, *const ValueReference, usize, *const c_int) -> Int;
    set_boolean = "SetBoolean": fn(Component, *const ValueReference, usize, *const Int) -> Int;
    set_string = "SetString": fn(Component, *const ValueReference, usize, *const Text) -> Int;
    get_directional_derivative = "GetDirectionalDerivative":
        fn(Component, *const ValueReference, usize, *const ValueReference, usize, *const f64, *mut f64) -> Int;
    set_real_input_derivatives = "SetRealInputDerivatives":
        fn(Component, *const ValueReference, usize, *const c_int, *const f64) -> Int;
    get_real_output_derivatives = "GetRealOutputDerivatives":
        fn(Component, *const ValueReference, usize, *const c_int, *mut f64) -> Int;
    do_step = "DoStep": fn(Component, f64, f64, Int) -> Int;
    cancel_step = "CancelStep": fn(Component) -> Int;
    get_status = "GetStatus": fn(Component, Int, *mut Int) -> Int;
    get_real_status = "GetRealStatus": fn(Component, Int, *mut f64) -> Int;
    get_integer_status = "GetIntegerStatus": fn(Component, Int, *mut c_int) -> Int;
    get_boolean_status = "GetBooleanStatus": fn(Component, Int, *mut Int) -> Int;
    get_string_status = "GetStringStatus": fn(Component, Int, *mut Text) -> Int;
}

functions! { Fmi3Functions,
    set_debug_logging = "SetDebugLogging": fn(Component, Truth, usize, *const Text) -> Int;
    instantiate = "InstantiateCoSimulation":
        fn(Text, Text, Text, Truth, Truth, Truth, Truth, *const ValueReference, usize, *mut c_void, PlainLoggerPointer, *const c_void)
            -> Component;
    enter_initialization_mode = "EnterInitializationMode": fn(Component, Truth, f64, f64, Truth, f64) -> Int;
    get_string = "GetString": fn(Component, *const ValueReference, usize, *mut Text, usize) -> Int;
    set_string = "SetString": fn(Component, *const ValueReference, usize, *const Text, usize) -> Int;
    get_directional_derivative = "GetDirectionalDerivative":
        fn(Component, *const ValueReference, usize, *const ValueReference, usize, *const f64, usize, *mut f64, usize) -> Int;
    get_output_derivatives = "GetOutputDerivatives":
        fn(Component, *const ValueReference, usize, *const c_int, *mut f64, usize) -> Int;
    do_step = "DoStep": fn(Component, f64, f64, Truth, *mut Truth, *mut Truth, *mut Truth, *mut f64) -> Int;
}

/// Functions that differ between the versions.
pub(super) enum OwnFunctions {
    Two(Fmi2Functions),
    Three(Box<Fmi3Functions>),
}

/// Reads the values of variables of one numeric type.
pub(super) type Getter =
    unsafe extern "C" fn(Component, *const ValueReference, usize, *mut c_void, usize) -> Int;
/// Sets them.
pub(super) type Setter =
    unsafe extern "C" fn(Component, *const ValueReference, usize, *const c_void, usize) -> Int;

/// A loaded binary with all its functions, and what else an instance needs for as long as it lives.
pub(super) struct Binary {
    /// Where the resources are, as the version of the standard has it.
    pub resources: String,
    pub description: Arc<ModelDescription>,
    pub shared: SharedFunctions,
    pub own: OwnFunctions,
    /// Of FMI 3.0, in the order of [`NUMERIC`].
    pub getters: Vec<Getter>,
    pub setters: Vec<Setter>,
    // unloaded after the last use of the functions
    _library: Library,
    /// The unpacked archive; removed with the last user.
    _folder: Arc<TempDir>,
}

impl Binary {
    /// Loads the library of an archive that is unpacked in a folder, and looks all functions up.
    ///
    /// # Errors
    /// [`Error::Input`] with what the loader said, or naming the function that is missing.
    pub(super) fn load(
        path: &Path,
        folder: &Arc<TempDir>,
        description: &Arc<ModelDescription>,
    ) -> Result<Self> {
        let (library, is_fmi3) = (open(path)?, description.is_fmi3());
        let resources = folder.path().join("resources");
        let shared = SharedFunctions::load(&library, is_fmi3)?;
        let (mut getters, mut setters) = (Vec::new(), Vec::new());
        for (name, _) in NUMERIC.iter().filter(|_| is_fmi3) {
            // SAFETY: the signature is that of the standard for this name, with a pointer to any number
            getters.push(unsafe { function(&library, &format!("fmi3Get{name}")) }?);
            // SAFETY: as above
            setters.push(unsafe { function(&library, &format!("fmi3Set{name}")) }?);
        }
        let own = match is_fmi3 {
            false => OwnFunctions::Two(Fmi2Functions::load(&library, false)?),
            true => OwnFunctions::Three(Box::new(Fmi3Functions::load(&library, true)?)),
        };
        Ok(Self {
            resources: match is_fmi3 {
                false => location_of(&resources)?,
                // a path that ends with a separator
                true => resources.join("").display().to_string(),
            },
            description: Arc::clone(description),
            shared,
            own,
            getters,
            setters,
            _library: library,
            _folder: Arc::clone(folder),
        })
    }
}

/// Adds a finding for each function that is missing, supported or not; loading problems come as one finding.
pub(super) fn check_symbols(path: &Path, is_fmi3: bool, place: &str, findings: &mut FmuFindings) {
    let library = match open(path) {
        Ok(library) => library,
        Err(e) => return findings.error(place, "a library that loads", e.to_string()),
    };
    let own = match is_fmi3 {
        false => Fmi2Functions::SUFFIXES,
        true => Fmi3Functions::SUFFIXES,
    };
    let suffixes = SharedFunctions::SUFFIXES.iter().chain(own);
    let mut symbols: Vec<String> = suffixes.map(|suffix| spelt(suffix, is_fmi3)).collect();
    for (name, _) in NUMERIC.iter().filter(|_| is_fmi3) {
        symbols.extend([format!("fmi3Get{name}"), format!("fmi3Set{name}")]);
    }
    for symbol in symbols {
        // SAFETY: only asked whether it is there, never called through this type
        if unsafe { library.get::<unsafe extern "C" fn()>(symbol.as_bytes()) }.is_err() {
            findings.error(place, format!("the function {symbol}"), "none");
        }
    }
}

pub(super) fn open(path: &Path) -> Result<Library> {
    refuse_cut(path)?;
    // SAFETY: initialisers of the library run; that is what loading an FMU means, and its user asked for it
    unsafe { Library::new(path) }.map_err(|e| {
        // what the loader said stands behind its error
        let why = std::error::Error::source(&e).map_or(e.to_string(), ToString::to_string);
        Error::input("binary", "a shared library that loads on this machine", why)
    })
}

/// Refuses an ELF library of 64 bits that ends before its segments do: a loader would end the process with a bus error.
fn refuse_cut(path: &Path) -> Result<()> {
    const LOADED: u64 = 1;
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    let number = |at: u64, size: usize| {
        let at = usize::try_from(at).ok()?;
        let digits = bytes.get(at..at.checked_add(size)?)?.iter().rev();
        Some(digits.fold(0_u64, |sum, byte| sum << 8 | u64::from(*byte)))
    };
    // 64 bits, lowest byte first
    if !bytes.starts_with(b"\x7fELF\x02\x01") {
        return Ok(());
    }
    let end_of = |header: u64| match number(header, 4)? {
        LOADED => number(header + 8, 8)?.checked_add(number(header + 32, 8)?),
        _ => Some(0),
    };
    let ends = || {
        let (first, size, count) = (number(32, 8)?, number(54, 2)?, number(56, 2)?);
        let mut ends = (0..count).map(|i| end_of(first.checked_add(i * size)?));
        ends.try_fold(0, |last, end| Some(last.max(end?)))
    };
    let whole = ends().is_some_and(|end| end <= bytes.len() as u64);
    let found = format_args!("{} bytes, too few for its segments", bytes.len());
    ensure(whole, "binary", "a whole shared library", found)
}
