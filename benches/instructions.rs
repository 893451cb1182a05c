//! Instructions of a communication step through the C functions of the embedded runtime, as an importer calls them, counted
//! by valgrind; times beside them, and the bare product of the same size as baseline.
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

/// Model, whether forces are read as well, words.
const CASES: [(&str, bool, &str); 4] = [
    (
        "continuous_laguerre",
        false,
        "continuous, 12 states: doStep and getReal of the motion (4)",
    ),
    (
        "continuous_laguerre",
        true,
        "the same with two forces among the four",
    ),
    (
        "discrete_laguerre",
        false,
        "discrete, 10 states: doStep and getReal of the motion (4)",
    ),
    ("", false, "bare product of 12 by 12 numbers"),
];
const STEP_S: f64 = 0.01;
const COUNTS: [u32; 2] = [2_000, 22_000];

fn main() {
    // beside what cargo passes: the model, which outputs, how many steps, in a process under valgrind
    let arguments: Vec<String> = std::env::args().collect();
    if let [_, word, case, count] = &arguments[..]
        && word == "count"
    {
        let case: usize = case.parse().expect("a case");
        steps(case, count.parse().expect("a count"));
        return;
    }
    for (case, (_, _, words)) in CASES.iter().enumerate() {
        let [few, many] = COUNTS.map(|count| instructions(case, count));
        let nanoseconds = (0..5)
            .map(|_| steps(case, 200_000))
            .fold(f64::MAX, f64::min);
        let counted = match (few, many) {
            (Some(few), Some(many)) => {
                format!(
                    "{} instructions",
                    (many - few) / u64::from(COUNTS[1] - COUNTS[0])
                )
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

/// Nanoseconds a step.
fn steps(case: usize, count: u32) -> f64 {
    let (kind, forces, _) = CASES[case];
    if kind.is_empty() {
        return products(count);
    }
    let folder = tempfile::tempdir().expect("a folder");
    let unit = Unit::new(folder.path(), kind, forces);
    let mut values = [0.0; 4];
    let begin = Instant::now();
    for n in 0..count {
        unit.step(f64::from(n) * STEP_S, &mut values);
    }
    black_box(values);
    begin.elapsed().as_secs_f64() * 1e9 / f64::from(count)
}

fn products(count: u32) -> f64 {
    let matrix = black_box([[0.08; 12]; 12]);
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
    begin.elapsed().as_secs_f64() * 1e9 / f64::from(count)
}

type Step = unsafe extern "C" fn(*mut c_void, f64, f64, c_int) -> c_int;
type Get = unsafe extern "C" fn(*mut c_void, *const u32, usize, *mut f64) -> c_int;

/// An instance of the embedded runtime, loaded as an importer loads it.
struct Unit {
    // keeps the functions loaded
    _library: libloading::Library,
    handle: *mut c_void,
    references: [u32; 4],
    step: Step,
    get: Get,
}

impl Unit {
    fn new(folder: &Path, kind: &str, forces: bool) -> Self {
        let models = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/models");
        let json =
            std::fs::read(PathBuf::from(models).join(format!("{kind}.json"))).expect("a model");
        std::fs::write(folder.join("model.json"), &json).expect("a file");
        let file = folder.join("runtime");
        std::fs::write(&file, Runtime::embedded().expect("a runtime").bytes).expect("a file");
        let resources = Resources::from_bytes(&json, OptionFiles::default()).expect("resources");
        let names = if forces {
            ["heave", "lift", "rotation", "moment"]
        } else {
            ["heave", "heave_rate", "rotation", "rotation_rate"]
        };
        let references = names.map(|n| resources.table.find_name(n).expect("a variable") as u32);
        let text = |text: String| CString::new(text).expect("a text");
        let guid = text(resources.guid.to_string());
        let location = text(location_of(folder).expect("a location"));
        // SAFETY: the functions of the standard with its arguments, from a library of our own
        unsafe {
            let library = libloading::Library::new(&file).expect("a library");
            let handle = {
                type Instantiate = unsafe extern "C" fn(
                    *const c_char,
                    c_int,
                    *const c_char,
                    *const c_char,
                    *const Callbacks,
                    c_int,
                    c_int,
                ) -> *mut c_void;
                let instantiate: libloading::Symbol<Instantiate> =
                    library.get(b"fmi2Instantiate").expect("a function");
                let functions = Callbacks::silent();
                instantiate(
                    c"unit".as_ptr(),
                    1,
                    guid.as_ptr(),
                    location.as_ptr(),
                    &raw const functions,
                    0,
                    0,
                )
            };
            assert!(!handle.is_null(), "no instance");
            type Setup = unsafe extern "C" fn(*mut c_void, c_int, f64, f64, c_int, f64) -> c_int;
            let setup: libloading::Symbol<Setup> =
                library.get(b"fmi2SetupExperiment").expect("a function");
            setup(handle, 0, 0.0, 0.0, 0, 0.0);
            for name in ["fmi2EnterInitializationMode", "fmi2ExitInitializationMode"] {
                type Mode = unsafe extern "C" fn(*mut c_void) -> c_int;
                let mode: libloading::Symbol<Mode> =
                    library.get(name.as_bytes()).expect("a function");
                assert_eq!(mode(handle), 0);
            }
            let step = *library.get::<Step>(b"fmi2DoStep").expect("a function");
            let get = *library.get::<Get>(b"fmi2GetReal").expect("a function");
            Self {
                _library: library,
                handle,
                references,
                step,
                get,
            }
        }
    }

    fn step(&self, time: f64, values: &mut [f64; 4]) {
        // SAFETY: the handle is alive and the arrays are of these lengths
        let answers = unsafe {
            [
                (self.step)(self.handle, time, STEP_S, 1),
                (self.get)(
                    self.handle,
                    self.references.as_ptr(),
                    4,
                    values.as_mut_ptr(),
                ),
            ]
        };
        assert_eq!(answers, [0, 0]);
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
