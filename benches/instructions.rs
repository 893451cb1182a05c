//! Instructions of a communication step, and of an instance, through the C functions of the embedded runtime, as an importer
//! calls them, counted by valgrind; times beside them, and the bare product of the same size as baseline. The loop that calls
//! is counted too; its own share stands in the last line.
//!
//! `cargo bench --bench instructions` prints a table; nothing is asserted here. Without valgrind the times stand alone.

use aerodeck::fmu::location::location_of;
use aerodeck::fmu::package::Runtime;
use aerodeck::fmu::resources::{OptionFiles, Resources};
use std::ffi::{CString, c_char, c_int, c_void};
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// What is done again and again.
#[derive(Clone, Copy)]
enum Doing {
    /// doStep and getReal of these four.
    Step([&'static str; 4]),
    /// The same with another wind before each.
    WindAndStep([&'static str; 4]),
    /// fmi2Instantiate and fmi2FreeInstance.
    Instance,
    /// A product of 12 by 12 numbers.
    Product,
    /// Calls of functions that do nothing.
    Calls,
}

const MOTION: [&str; 4] = ["heave", "heave_rate", "rotation", "rotation_rate"];
const FORCES: [&str; 4] = ["heave", "lift", "rotation", "moment"];

/// Model, what is done, words.
const CASES: [(&str, Doing, &str); 9] = [
    (
        "continuous_laguerre",
        Doing::Step(MOTION),
        "continuous, 12 states: doStep and getReal of the motion (4)",
    ),
    (
        "continuous_laguerre",
        Doing::Step(FORCES),
        "the same with two forces among the four",
    ),
    (
        "continuous_laguerre",
        Doing::WindAndStep(MOTION),
        "the motion, with another wind at every step",
    ),
    (
        "discrete_laguerre",
        Doing::Step(MOTION),
        "discrete, 10 states: doStep and getReal of the motion (4)",
    ),
    (
        "continuous_laguerre",
        Doing::Instance,
        "continuous: an instance, made and freed",
    ),
    (
        "rational",
        Doing::Instance,
        "rational: an instance, made and freed",
    ),
    (
        "discrete_laguerre",
        Doing::Instance,
        "discrete: an instance, made and freed",
    ),
    ("", Doing::Product, "bare product of 12 by 12 numbers"),
    ("", Doing::Calls, "the loop of the caller alone"),
];
const STEP_S: f64 = 0.01;
/// Steps, and instances, of two runs: their difference is free of what comes before.
const COUNTS: [u32; 2] = [2_000, 22_000];
const INSTANCES: [u32; 2] = [20, 120];

fn main() {
    // beside what cargo passes: the case and how often, in a process under valgrind
    let arguments: Vec<String> = std::env::args().collect();
    if let [_, word, case, count] = &arguments[..]
        && word == "count"
    {
        let case: usize = case.parse().expect("a case");
        nanoseconds(case, count.parse().expect("a count"));
        return;
    }
    for (case, (_, doing, words)) in CASES.iter().enumerate() {
        let counts = match doing {
            Doing::Instance => INSTANCES,
            _ => COUNTS,
        };
        let [few, many] = counts.map(|count| instructions(case, count));
        let nanoseconds = (0..5)
            .map(|_| nanoseconds(case, 10 * counts[1]))
            .fold(f64::MAX, f64::min);
        let counted = match (few, many) {
            (Some(few), Some(many)) => {
                let each = (many - few) / u64::from(counts[1] - counts[0]);
                format!("{each} instructions")
            }
            _ => "valgrind is not here".into(),
        };
        println!("{words}: {counted}, {nanoseconds:.1} ns");
    }
}

/// Instructions of a whole run of this program.
fn instructions(case: usize, count: u32) -> Option<u64> {
    let run = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(std::env::current_exe().ok()?)
        .args(["count", &case.to_string(), &count.to_string()])
        .output()
        .ok()?;
    let said = String::from_utf8_lossy(&run.stderr).into_owned();
    let line = said.lines().find(|line| line.contains("Collected :"))?;
    line.rsplit(' ').next()?.parse().ok()
}

/// Nanoseconds of each.
fn nanoseconds(case: usize, count: u32) -> f64 {
    let (kind, doing, _) = CASES[case];
    let folder = tempfile::tempdir().expect("a folder");
    match doing {
        Doing::Product => products(count),
        Doing::Calls => Unit::that_does_nothing().steps(count, None),
        Doing::Step(names) => {
            Unit::new(&Archive::new(folder.path(), kind), names).steps(count, None)
        }
        Doing::WindAndStep(names) => {
            let archive = Archive::new(folder.path(), kind);
            let unit = Unit::new(&archive, names);
            unit.steps(count, Some(archive.reference("wind_speed")))
        }
        Doing::Instance => {
            let archive = Archive::new(folder.path(), kind);
            let begin = Instant::now();
            for _ in 0..count {
                let handle = archive.instantiate();
                // SAFETY: an instance that nobody else has
                unsafe { archive.function::<Free>(b"fmi2FreeInstance")(handle) };
            }
            each_since(begin, count)
        }
    }
}

fn each_since(begin: Instant, count: u32) -> f64 {
    begin.elapsed().as_secs_f64() * 1e9 / f64::from(count)
}

fn products(count: u32) -> f64 {
    // rows that add up to one: the state neither grows nor dies out
    let matrix = black_box([[1.0 / 12.0; 12]; 12]);
    let mut state = black_box([1.0; 12]);
    let begin = Instant::now();
    for _ in 0..count {
        let mut next = [0.0; 12];
        for (column, x) in matrix.iter().zip(state) {
            for (y, a) in next.iter_mut().zip(column) {
                *y += a * x;
            }
        }
        state = black_box(next);
    }
    each_since(begin, count)
}

type Step = unsafe extern "C" fn(*mut c_void, f64, f64, c_int) -> c_int;
type Get = unsafe extern "C" fn(*mut c_void, *const u32, usize, *mut f64) -> c_int;
type Set = unsafe extern "C" fn(*mut c_void, *const u32, usize, *const f64) -> c_int;
type Free = unsafe extern "C" fn(*mut c_void);
type Instantiate = unsafe extern "C" fn(
    *const c_char,
    c_int,
    *const c_char,
    *const c_char,
    *const Callbacks,
    c_int,
    c_int,
) -> *mut c_void;

/// The embedded runtime, loaded as an importer loads it, beside the resources of a model.
struct Archive {
    library: libloading::Library,
    resources: Resources,
    guid: CString,
    location: CString,
}

impl Archive {
    fn new(folder: &Path, kind: &str) -> Self {
        let models = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/models");
        let json =
            std::fs::read(PathBuf::from(models).join(format!("{kind}.json"))).expect("a model");
        std::fs::write(folder.join("model.json"), &json).expect("a file");
        let file = folder.join("runtime");
        std::fs::write(&file, Runtime::embedded().expect("a runtime").bytes).expect("a file");
        let resources = Resources::from_bytes(&json, OptionFiles::default()).expect("resources");
        let text = |text: String| CString::new(text).expect("a text");
        Self {
            // SAFETY: a library of our own
            library: unsafe { libloading::Library::new(&file).expect("a library") },
            guid: text(resources.guid.to_string()),
            location: text(location_of(folder).expect("a location")),
            resources,
        }
    }

    fn function<F: Copy>(&self, name: &[u8]) -> F {
        // SAFETY: the functions of the standard have these types
        unsafe { *self.library.get::<F>(name).expect("a function") }
    }

    fn reference(&self, name: &str) -> u32 {
        self.resources.table.find_name(name).expect("a variable") as u32
    }

    fn instantiate(&self) -> *mut c_void {
        let functions = Callbacks::silent();
        let instantiate: Instantiate = self.function(b"fmi2Instantiate");
        // SAFETY: texts and callbacks outlive the call, which copies them
        let handle = unsafe {
            instantiate(
                c"unit".as_ptr(),
                1,
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
}

/// An instance that has been initialised.
struct Unit {
    handle: *mut c_void,
    references: [u32; 4],
    step: Step,
    get: Get,
    set: Set,
}

impl Unit {
    fn new(archive: &Archive, names: [&str; 4]) -> Self {
        let handle = archive.instantiate();
        type Setup = unsafe extern "C" fn(*mut c_void, c_int, f64, f64, c_int, f64) -> c_int;
        let setup: Setup = archive.function(b"fmi2SetupExperiment");
        // SAFETY: the handle is alive
        unsafe { setup(handle, 0, 0.0, 0.0, 0, 0.0) };
        for name in ["fmi2EnterInitializationMode", "fmi2ExitInitializationMode"] {
            type Mode = unsafe extern "C" fn(*mut c_void) -> c_int;
            // SAFETY: the handle is alive
            assert_eq!(
                unsafe { archive.function::<Mode>(name.as_bytes())(handle) },
                0
            );
        }
        Self {
            handle,
            references: names.map(|name| archive.reference(name)),
            step: archive.function(b"fmi2DoStep"),
            get: archive.function(b"fmi2GetReal"),
            set: archive.function(b"fmi2SetReal"),
        }
    }

    fn that_does_nothing() -> Self {
        unsafe extern "C" fn step(_: *mut c_void, _: f64, _: f64, _: c_int) -> c_int {
            0
        }
        unsafe extern "C" fn get(_: *mut c_void, _: *const u32, _: usize, _: *mut f64) -> c_int {
            0
        }
        unsafe extern "C" fn set(_: *mut c_void, _: *const u32, _: usize, _: *const f64) -> c_int {
            0
        }
        Self {
            handle: std::ptr::null_mut(),
            references: [0; 4],
            step: black_box(step),
            get: black_box(get),
            set: black_box(set),
        }
    }

    /// Nanoseconds a step, with another wind before each where its reference is given.
    fn steps(&self, count: u32, wind: Option<u32>) -> f64 {
        let mut values = [0.0; 4];
        let (references, into) = (self.references.as_ptr(), values.as_mut_ptr());
        let begin = Instant::now();
        for n in 0..count {
            let n = f64::from(n);
            // SAFETY: the handle is alive and the arrays are of these lengths
            let answers = unsafe {
                let set = wind.map_or(0, |wind| {
                    (self.set)(self.handle, &raw const wind, 1, &(10.0 + 1e-6 * n))
                });
                set | (self.step)(self.handle, n * STEP_S, STEP_S, 1)
                    | (self.get)(self.handle, references, 4, into)
            };
            assert_eq!(answers, 0);
        }
        black_box(values);
        each_since(begin, count)
    }
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
