//! The C functions, driven as an importer drives them.

mod derivatives;
mod force_exchange;
mod gusts;
mod leniency;
mod logging;
mod model_exchange;
mod offsets;
mod overflow;
mod refusals;
mod run;
mod state;
mod structure_outside;
mod torture;

use super::types::*;
use super::*;
use crate::location::location_of;
use crate::resources::Resources;
use crate::trained_model::{Model, TrainedModel};
use std::ffi::{CStr, CString, c_void};
use std::path::Path;
use std::sync::Mutex;

/// What reached the logger: instance name, status, category, message.
type Messages = Mutex<Vec<(String, fmi2Status, String, String)>>;

unsafe extern "C" fn collect(
    environment: fmi2ComponentEnvironment,
    name: fmi2String,
    status: fmi2Status,
    category: fmi2String,
    message: fmi2String,
) {
    let text = |p| unsafe { CStr::from_ptr(p) }.to_string_lossy().into_owned();
    let messages = unsafe { &*environment.cast::<Messages>() };
    let entry = (text(name), status, text(category), text(message));
    messages.lock().unwrap().push(entry);
}

/// Functions whose logger writes to `messages`.
fn callbacks(messages: &Messages) -> fmi2CallbackFunctions {
    type Plain = unsafe extern "C" fn(
        fmi2ComponentEnvironment,
        fmi2String,
        fmi2Status,
        fmi2String,
        fmi2String,
    );
    fmi2CallbackFunctions {
        // stable Rust cannot define a variadic function; one that reads no variadic argument is called alike
        logger: Some(unsafe { std::mem::transmute::<Plain, fmi2CallbackLogger>(collect as Plain) }),
        allocateMemory: None,
        freeMemory: None,
        stepFinished: None,
        componentEnvironment: std::ptr::from_ref(messages).cast_mut().cast(),
    }
}

/// An unpacked archive as far as the runtime sees it, in a folder whose name needs coding.
struct Extracted {
    folder: tempfile::TempDir,
    resources: Resources,
}

impl Extracted {
    fn new(json: &str) -> Self {
        let folder = tempfile::Builder::new()
            .prefix("Brücke 1 ")
            .tempdir()
            .unwrap();
        std::fs::write(folder.path().join("model.json"), json).unwrap();
        Self {
            folder,
            resources: Resources::from_bytes(json.as_bytes(), [None; 3]).unwrap(),
        }
    }

    fn fixture(kind: &str) -> Self {
        let path = format!("tests/data/models/{kind}.json");
        let path = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../..")
            .join(path);
        Self::new(&std::fs::read_to_string(path).unwrap())
    }

    /// The rational fixture with a light lateral support and a quasi-steady drag.
    fn three_dof() -> Self {
        use crate::section::{Dof, Translation};
        let mut model = Self::fixture("rational").resources.model;
        model.section.lateral = Some(Translation {
            mass_kg_m: 15.0,
            frequency_hz: None,
            stiffness_n_m2: Some(2000.0),
            damping_ratio: 0.003,
        });
        let crate::trained_model::Model::Rational(m) = &mut model.model else {
            panic!("the fixture is rational");
        };
        m.dofs = Dof::THREE.to_vec();
        let widen = |small: &nalgebra::DMatrix<f64>, drag: f64| {
            let at = [0, 2];
            let mut wide = nalgebra::DMatrix::zeros(3, 3);
            for i in 0..2 {
                for j in 0..2 {
                    wide[(at[i], at[j])] = small[(i, j)];
                }
            }
            wide[(1, 1)] = drag;
            wide
        };
        (m.a1, m.a2, m.a3) = (widen(&m.a1, 0.0), widen(&m.a2, -0.05), widen(&m.a3, 0.0));
        m.lag_terms = m.lag_terms.iter().map(|a| widen(a, 0.0)).collect();
        Self::new(&model.to_json().unwrap())
    }

    fn model(&self) -> &TrainedModel {
        &self.resources.model
    }

    fn location(&self) -> String {
        location_of(self.folder.path()).unwrap()
    }

    fn reference(&self, name: &str) -> fmi2ValueReference {
        let index = self.resources.table.find_name(name);
        index.unwrap_or_else(|| panic!("no variable `{name}`")) as fmi2ValueReference
    }
}

/// What `fmi2Instantiate` is called with.
struct Creation {
    name: Option<CString>,
    kind: fmi2Type,
    guid: Option<CString>,
    location: Option<CString>,
}

impl Creation {
    fn right(archive: &Extracted) -> Self {
        let c = |text: String| Some(CString::new(text).unwrap());
        Self {
            name: c("deck".into()),
            kind: fmi2CoSimulation,
            guid: c(archive.resources.guid.to_string()),
            location: c(archive.location()),
        }
    }

    fn call(&self, functions: *const fmi2CallbackFunctions, logging: bool) -> fmi2Component {
        let pointer =
            |text: &Option<CString>| text.as_ref().map_or(std::ptr::null(), |t| t.as_ptr());
        unsafe {
            fmi2Instantiate(
                pointer(&self.name),
                self.kind,
                pointer(&self.guid),
                pointer(&self.location),
                functions,
                0,
                fmi2Boolean::from(logging),
            )
        }
    }
}

/// An instance with its importer.
struct StartedUnit {
    archive: Extracted,
    // the box keeps the address that the logger was given
    messages: Box<Messages>,
    handle: fmi2Component,
}

impl Drop for StartedUnit {
    fn drop(&mut self) {
        unsafe { fmi2FreeInstance(self.handle) };
    }
}

impl StartedUnit {
    fn instantiate(archive: Extracted) -> Self {
        let messages = Box::<Messages>::default();
        let functions = callbacks(&messages);
        let handle = Creation::right(&archive).call(&functions, false);
        assert!(!handle.is_null(), "{:?}", messages.lock().unwrap());
        Self {
            archive,
            messages,
            handle,
        }
    }

    fn new(kind: &str) -> Self {
        Self::instantiate(Extracted::fixture(kind))
    }

    /// Ready for the first step at time zero.
    fn started(kind: &str) -> Self {
        let unit = Self::new(kind);
        unit.start();
        unit
    }

    fn start(&self) {
        self.ok(self.set_up());
        self.ok(self.enter());
        self.ok(self.exit());
    }

    fn set_up(&self) -> fmi2Status {
        unsafe { fmi2SetupExperiment(self.handle, 0, 0.0, 0.0, 0, 0.0) }
    }
    fn enter(&self) -> fmi2Status {
        unsafe { fmi2EnterInitializationMode(self.handle) }
    }
    fn exit(&self) -> fmi2Status {
        unsafe { fmi2ExitInitializationMode(self.handle) }
    }
    fn reset(&self) -> fmi2Status {
        unsafe { fmi2Reset(self.handle) }
    }
    fn step(&self, time: f64, step: f64) -> fmi2Status {
        unsafe { fmi2DoStep(self.handle, time, step, 1) }
    }

    /// Asserts that a call went well.
    #[track_caller]
    fn ok(&self, status: fmi2Status) {
        assert_eq!(status, fmi2Status::fmi2OK, "{:?}", self.last_message());
    }

    /// Asserts that a call was refused like this, with a logged reason that holds all of `words`.
    #[track_caller]
    fn refused(&self, status: fmi2Status, expected: fmi2Status, words: &[&str]) {
        assert_eq!(status, expected);
        let (name, logged, category, message) = self.last_message().expect("a logged reason");
        assert_eq!((name.as_str(), logged), ("deck", expected));
        assert!(category.starts_with("logStatus"));
        for word in words {
            assert!(message.contains(word), "`{word}` is not in: {message}");
        }
    }

    fn last_message(&self) -> Option<(String, fmi2Status, String, String)> {
        self.messages.lock().unwrap().last().cloned()
    }

    fn references(&self, names: &[&str]) -> Vec<fmi2ValueReference> {
        names.iter().map(|n| self.archive.reference(n)).collect()
    }

    fn try_get(&self, names: &[&str], values: &mut [f64]) -> fmi2Status {
        let vr = self.references(names);
        unsafe { fmi2GetReal(self.handle, vr.as_ptr(), vr.len(), values.as_mut_ptr()) }
    }

    #[track_caller]
    fn get<const N: usize>(&self, names: [&str; N]) -> [f64; N] {
        let mut values = [f64::NAN; N];
        self.ok(self.try_get(&names, &mut values));
        values
    }

    fn try_set(&self, names: &[&str], values: &[f64]) -> fmi2Status {
        let vr = self.references(names);
        unsafe { fmi2SetReal(self.handle, vr.as_ptr(), vr.len(), values.as_ptr()) }
    }

    #[track_caller]
    fn set(&self, name: &str, value: f64) {
        self.ok(self.try_set(&[name], &[value]));
    }

    #[track_caller]
    fn set_rate(&self, name: &str, rate: f64) {
        let vr = self.references(&[name]);
        self.ok(unsafe {
            fmi2SetRealInputDerivatives(self.handle, vr.as_ptr(), 1, [1].as_ptr(), [rate].as_ptr())
        });
    }

    fn flag(&self, name: &str) -> bool {
        let mut value = -1;
        let vr = self.references(&[name]);
        self.ok(unsafe { fmi2GetBoolean(self.handle, vr.as_ptr(), 1, &raw mut value) });
        assert!(value == 0 || value == 1);
        value == 1
    }

    /// Motion and forces, in the order of the table.
    fn outputs(&self) -> Vec<f64> {
        let variables = self.archive.resources.table.variables();
        let vr: Vec<_> = (0..variables.len())
            .filter(|i| matches!(variables[*i].role, crate::variables::Role::Response(..)))
            .map(|i| i as fmi2ValueReference)
            .collect();
        let mut values = vec![f64::NAN; vr.len()];
        self.ok(unsafe { fmi2GetReal(self.handle, vr.as_ptr(), vr.len(), values.as_mut_ptr()) });
        values
    }
}

fn null<T>() -> *mut T {
    std::ptr::null_mut()
}
