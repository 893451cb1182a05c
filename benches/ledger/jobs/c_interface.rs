//! The embedded runtime through its C functions, as an importer calls them.

use aerodeck::fmu::location::location_of;
use aerodeck::fmu::package::Runtime;
use aerodeck::fmu::resources::Resources;
use std::ffi::{CString, c_char, c_int, c_void};
use std::hint::black_box;
use std::path::Path;

type Get = unsafe extern "C" fn(*mut c_void, *const u32, usize, *mut f64) -> c_int;
type Set = unsafe extern "C" fn(*mut c_void, *const u32, usize, *const f64) -> c_int;
type Step = unsafe extern "C" fn(*mut c_void, f64, f64, c_int) -> c_int;
type Plain = unsafe extern "C" fn(*mut c_void) -> c_int;
type SetTime = unsafe extern "C" fn(*mut c_void, f64) -> c_int;
type States = unsafe extern "C" fn(*mut c_void, *mut f64, usize) -> c_int;
type Instantiate = unsafe extern "C" fn(
    *const c_char,
    c_int,
    *const c_char,
    *const c_char,
    *const Callbacks,
    c_int,
    c_int,
) -> *mut c_void;

#[derive(Clone, Copy)]
#[repr(i32)]
pub(crate) enum FmiKind {
    ModelExchange = 0,
    CoSimulation = 1,
}

/// The runtime, loaded as an importer loads it, beside the resources of a unit.
pub(crate) struct Unpacked {
    library: libloading::Library,
    resources: Resources,
    guid: CString,
    location: CString,
    _folder: tempfile::TempDir,
}

impl Unpacked {
    /// Of a section, with gusts where their file is given.
    pub(crate) fn of_section(json: &str, gusts: Option<&str>) -> Self {
        let options = [None, gusts.map(str::as_bytes), None];
        let resources = Resources::from_bytes(json.as_bytes(), options).expect("resources");
        Self::new(
            resources,
            &[("model.json", Some(json)), ("gusts.json", gusts)],
        )
    }

    /// Of a bridge, from its two files.
    pub(crate) fn of_bridge(json: &str, bridge: &str) -> Self {
        let resources = Resources::of_bridge(json.as_bytes(), bridge.as_bytes(), None);
        let files = [("model.json", Some(json)), ("bridge.json", Some(bridge))];
        Self::new(resources.expect("resources"), &files)
    }

    fn new(resources: Resources, files: &[(&str, Option<&str>)]) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, text) in files {
            if let Some(text) = text {
                std::fs::write(folder.path().join(name), text).expect("a file");
            }
        }
        let file = folder.path().join("runtime");
        std::fs::write(&file, Runtime::embedded().expect("a runtime").bytes).expect("a file");
        let text = |text: String| CString::new(text).expect("a text");
        Self {
            // SAFETY: a library of our own
            library: unsafe { libloading::Library::new(&file).expect("a library") },
            guid: text(resources.guid.to_string()),
            location: text(location(folder.path())),
            resources,
            _folder: folder,
        }
    }

    fn function<F: Copy>(&self, name: &[u8]) -> F {
        // SAFETY: the functions of the standard have these types
        unsafe { *self.library.get::<F>(name).expect("a function") }
    }

    fn instantiate(&self, kind: FmiKind) -> *mut c_void {
        let functions = Callbacks::silent();
        let instantiate: Instantiate = self.function(b"fmi2Instantiate");
        // SAFETY: texts and callbacks outlive the call, which copies them
        let handle = unsafe {
            instantiate(
                c"unit".as_ptr(),
                kind as c_int,
                self.guid.as_ptr(),
                self.location.as_ptr(),
                &raw const functions,
                0,
                0,
            )
        };
        assert!(!handle.is_null(), "no instance");
        handle
    }

    /// An instance, made and freed.
    pub(crate) fn make_and_free(&self) {
        type Free = unsafe extern "C" fn(*mut c_void);
        let handle = self.instantiate(FmiKind::CoSimulation);
        // SAFETY: an instance that nobody else has
        unsafe { self.function::<Free>(b"fmi2FreeInstance")(handle) };
    }
}

fn location(folder: &Path) -> String {
    location_of(folder).expect("a location")
}

/// An instance that has been initialised, never freed.
pub(crate) struct LoadedUnit {
    handle: *mut c_void,
    step: Step,
    get: Get,
    set: Set,
    set_time: SetTime,
    set_states: States,
    rates: States,
    archive: Unpacked,
}

impl LoadedUnit {
    /// With these values set before initialisation ends.
    pub(crate) fn new(archive: Unpacked, kind: FmiKind, starts: &[(&str, f64)]) -> Self {
        let handle = archive.instantiate(kind);
        type Setup = unsafe extern "C" fn(*mut c_void, c_int, f64, f64, c_int, f64) -> c_int;
        let setup: Setup = archive.function(b"fmi2SetupExperiment");
        // SAFETY: the handle is alive
        unsafe { setup(handle, 0, 0.0, 0.0, 0, 0.0) };
        let unit = Self {
            handle,
            step: archive.function(b"fmi2DoStep"),
            get: archive.function(b"fmi2GetReal"),
            set: archive.function(b"fmi2SetReal"),
            set_time: archive.function(b"fmi2SetTime"),
            set_states: archive.function(b"fmi2SetContinuousStates"),
            rates: archive.function(b"fmi2GetDerivatives"),
            archive,
        };
        unit.plain(b"fmi2EnterInitializationMode");
        for (name, value) in starts {
            unit.set(&[unit.reference(name)], &[*value]);
        }
        unit.plain(b"fmi2ExitInitializationMode");
        unit
    }

    /// With functions that do nothing in the place of the runtime's.
    pub(crate) fn that_does_nothing(self) -> Self {
        unsafe extern "C" fn step(_: *mut c_void, _: f64, _: f64, _: c_int) -> c_int {
            0
        }
        unsafe extern "C" fn get(_: *mut c_void, _: *const u32, _: usize, _: *mut f64) -> c_int {
            0
        }
        Self {
            step: black_box(step),
            get: black_box(get),
            ..self
        }
    }

    fn plain(&self, name: &[u8]) {
        // SAFETY: the handle is alive
        assert_eq!(
            unsafe { self.archive.function::<Plain>(name)(self.handle) },
            0
        );
    }

    pub(crate) fn reference(&self, name: &str) -> u32 {
        let place = self.archive.resources.table.find_name(name);
        place.unwrap_or_else(|| panic!("no {name}")) as u32
    }

    pub(crate) fn references<const N: usize>(&self, names: [&str; N]) -> [u32; N] {
        names.map(|name| self.reference(name))
    }

    #[inline(always)]
    pub(crate) fn do_step(&self, time_s: f64, step_s: f64) {
        // SAFETY: the handle is alive
        assert_eq!(unsafe { (self.step)(self.handle, time_s, step_s, 1) }, 0);
    }

    #[inline(always)]
    pub(crate) fn get(&self, references: &[u32], values: &mut [f64]) {
        assert_eq!(references.len(), values.len());
        let (of, into) = (references.as_ptr(), values.as_mut_ptr());
        // SAFETY: the handle is alive and the arrays are of this length
        assert_eq!(
            unsafe { (self.get)(self.handle, of, values.len(), into) },
            0
        );
    }

    #[inline(always)]
    pub(crate) fn set(&self, references: &[u32], values: &[f64]) {
        assert_eq!(references.len(), values.len());
        let (of, from) = (references.as_ptr(), values.as_ptr());
        // SAFETY: the handle is alive and the arrays are of this length
        assert_eq!(
            unsafe { (self.set)(self.handle, of, values.len(), from) },
            0
        );
    }

    /// The importer integrates from here on.
    pub(crate) fn integrate(&self) {
        type NewStates = unsafe extern "C" fn(*mut c_void, *mut EventInfo) -> c_int;
        let mut info = EventInfo::default();
        let new_states: NewStates = self.archive.function(b"fmi2NewDiscreteStates");
        // SAFETY: the handle is alive
        assert_eq!(unsafe { new_states(self.handle, &raw mut info) }, 0);
        self.plain(b"fmi2EnterContinuousTimeMode");
    }

    /// Rates of the states at an instant.
    pub(crate) fn rates_at(&self, time_s: f64, states: &mut [f64], rates: &mut [f64]) {
        // SAFETY: the handle is alive and the arrays are of this length
        let answers = unsafe {
            (self.set_time)(self.handle, time_s)
                | (self.set_states)(self.handle, states.as_mut_ptr(), states.len())
                | (self.rates)(self.handle, rates.as_mut_ptr(), rates.len())
        };
        assert_eq!(answers, 0);
    }
}

/// `fmi2EventInfo`.
#[repr(C)]
#[derive(Default)]
struct EventInfo {
    flags: [c_int; 5],
    next_time: f64,
}

/// The importer's functions: a logger that says nothing.
#[repr(C)]
struct Callbacks {
    logger: unsafe extern "C" fn(),
    memory: [Option<unsafe extern "C" fn()>; 3],
    environment: *mut c_void,
}

impl Callbacks {
    fn silent() -> Self {
        unsafe extern "C" fn nothing() {}
        Self {
            logger: nothing,
            memory: [None; 3],
            environment: std::ptr::null_mut(),
        }
    }
}
