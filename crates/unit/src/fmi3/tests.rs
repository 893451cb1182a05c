//! The shell of FMI 3.0 against that of FMI 2.0.

use super::*;
use crate::fmi2::types::{fmi2Component, fmi2Status, fmi2String};
use crate::force_options::{FORCE_FILE, ForceOptions};
use crate::groups::Groups;
use crate::resources::Resources;
use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr::{null, null_mut};
use std::sync::Mutex;

mod messages;
mod structure;
mod unknown;

type Messages = Mutex<Vec<String>>;

unsafe extern "C" fn collect(
    environment: *mut c_void,
    _: fmi2Status,
    _: *const c_char,
    message: *const c_char,
) {
    let messages = unsafe { &*environment.cast::<Messages>() };
    let text = unsafe { CStr::from_ptr(message) }.to_string_lossy();
    messages.lock().unwrap().push(text.into_owned());
}

struct NewStandardUnit {
    folder: tempfile::TempDir,
    resources: Resources,
    groups: Groups,
    messages: Box<Messages>,
    handle: fmi2Component,
}

impl Drop for NewStandardUnit {
    fn drop(&mut self) {
        unsafe { fmi3FreeInstance(self.handle) };
    }
}

impl NewStandardUnit {
    fn new(kind: &str, strips: Option<usize>, integrated: bool) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let file = format!(
            "{}/../../tests/data/models/{kind}.json",
            env!("CARGO_MANIFEST_DIR")
        );
        let model = std::fs::read(file).unwrap();
        std::fs::write(folder.path().join("model.json"), &model).unwrap();
        let force = strips.map(|count| {
            let mut options = ForceOptions::single(0.5);
            options.strips = vec![options.strips[0].clone(); count];
            options.named_strips = true;
            let text = options.to_json().unwrap();
            std::fs::write(folder.path().join(FORCE_FILE), &text).unwrap();
            text
        });
        let options = [force.as_deref().map(str::as_bytes), None, None];
        let resources = Resources::from_bytes(&model, options).unwrap();
        let mut unit = Self {
            groups: Groups::new(&resources.table),
            resources,
            folder,
            messages: Box::default(),
            handle: null_mut(),
        };
        unit.handle = unit.instantiate(integrated, 0);
        assert!(!unit.handle.is_null(), "{:?}", unit.messages);
        unit
    }

    /// Of co-simulation with all of the log.
    fn instantiate(&self, integrated: bool, event_mode_used: u8) -> fmi2Component {
        let c = |text: String| CString::new(text).unwrap();
        let name = c("deck".into());
        let token = c(self.resources.guid.to_string());
        let path = c(format!("{}/", self.folder.path().display()));
        let environment = std::ptr::from_ref::<Messages>(&self.messages)
            .cast_mut()
            .cast();
        let (name, token, path) = (name.as_ptr(), token.as_ptr(), path.as_ptr());
        unsafe {
            if integrated {
                fmi3InstantiateModelExchange(name, token, path, 0, 0, environment, Some(collect))
            } else {
                fmi3InstantiateCoSimulation(
                    name,
                    token,
                    path,
                    0,
                    1,
                    event_mode_used,
                    0,
                    null(),
                    0,
                    environment,
                    Some(collect),
                    null(),
                )
            }
        }
    }

    #[track_caller]
    fn ok(&self, status: fmi2Status) {
        assert_eq!(status, fmi2Status::fmi2OK, "{:?}", self.messages);
    }

    fn refused(&self, status: fmi2Status, word: &str) {
        assert_eq!(status, fmi2Status::fmi2Error);
        let last = self.messages.lock().unwrap().last().cloned().unwrap();
        assert!(last.starts_with("fmi3") && last.contains(word), "{last}");
    }

    fn start(&self) {
        self.ok(unsafe { fmi3EnterInitializationMode(self.handle, 0, 0.0, 0.0, 1, 100.0) });
        self.ok(unsafe { fmi3ExitInitializationMode(self.handle) });
    }

    /// The reference of a variable, or of the array that its name without the strip stands for.
    fn reference(&self, name: &str) -> u32 {
        let named = |index: &u32| {
            let v = &self.resources.table.variables()[*index as usize];
            v.name == name || v.name == format!("strip[1].{name}")
        };
        let found = self
            .groups
            .all()
            .iter()
            .position(|indices| named(&indices[0]));
        found.unwrap_or_else(|| panic!("no variable `{name}`")) as u32
    }

    fn get(&self, name: &str, count: usize) -> Vec<f64> {
        let vr = [self.reference(name)];
        let mut values = vec![f64::NAN; count];
        let at = values.as_mut_ptr();
        self.ok(unsafe { fmi3GetFloat64(self.handle, vr.as_ptr(), 1, at, count) });
        values
    }

    fn flag(&self, name: &str) -> bool {
        let vr = [self.reference(name)];
        let mut value = true;
        self.ok(unsafe { fmi3GetBoolean(self.handle, vr.as_ptr(), 1, &raw mut value, 1) });
        value
    }

    fn set(&self, name: &str, values: &[f64]) {
        let vr = [self.reference(name)];
        let at = values.as_ptr();
        self.ok(unsafe { fmi3SetFloat64(self.handle, vr.as_ptr(), 1, at, values.len()) });
    }

    fn step(&self, time: f64, step: f64) -> fmi2Status {
        let mut flags = [true; 3];
        let mut last = f64::NAN;
        let [event, end, early] = &mut flags;
        let status =
            unsafe { fmi3DoStep(self.handle, time, step, 1, event, end, early, &raw mut last) };
        assert_eq!(flags, [false; 3]);
        if status == fmi2Status::fmi2OK {
            assert_eq!(last, time + step);
        }
        status
    }
}

/// The instance of both shells is one, driven directly.
#[test]
fn the_trajectory_is_that_of_the_instance_bit_for_bit() {
    for kind in ["continuous_laguerre", "rational", "discrete_laguerre"] {
        let unit = NewStandardUnit::new(kind, None, false);
        let read = |name: &str| unit.resources.table.find_name(name).unwrap() as u32;
        let (outputs, wind) = (["heave", "rotation", "lift", "moment"], read("wind_speed"));
        let indices = outputs.map(read);
        let json = std::fs::read(unit.folder.path().join("model.json")).unwrap();
        let resources = Resources::from_bytes(&json, [None; 3]).unwrap();
        let mut own = crate::instance::Instance::new(resources).unwrap();
        own.set_up_experiment(0.0, None).unwrap();
        own.enter_initialization();
        own.exit_initialization().unwrap();
        unit.start();
        for i in 0..100 {
            let speed = 20.0 + f64::from(i % 10);
            unit.set("wind_speed", &[speed]);
            own.set_reals(&[wind], &[speed]).unwrap();
            let time = f64::from(i) * 0.01;
            unit.ok(unit.step(time, 0.01));
            own.do_step(time, 0.01).unwrap();
            let mut values = [0.0; 4];
            own.reals(&indices, &mut values).unwrap();
            for (name, value) in outputs.iter().zip(values) {
                assert_eq!(unit.get(name, 1), [value], "{kind}, {name}");
            }
        }
        let mut both = [f64::NAN; 2];
        let vr = [unit.groups.time(), unit.reference("heave")];
        unit.ok(unsafe { fmi3GetFloat64(unit.handle, vr.as_ptr(), 2, both.as_mut_ptr(), 2) });
        assert_eq!(both[0], 0.99 + 0.01);
        assert_eq!(both[1], unit.get("heave", 1)[0]);
    }
}

#[test]
fn strips_are_arrays() {
    let unit = NewStandardUnit::new("rational", Some(3), false);
    unit.start();
    unit.set("wind_speed", &[20.0]);
    unit.set("heave", &[0.01, 0.0, -0.02]);
    unit.set("heave_rate", &[0.0, 0.1, 0.0]);
    unit.ok(unit.step(0.0, 0.01));
    let lift = unit.get("lift", 3);
    assert!(lift[0] != 0.0 && lift[1] != 0.0);
    // forces are linear in the motion
    assert!((lift[2] / lift[0] + 2.0).abs() < 1e-9, "{lift:?}");
    let mut few = [0.0; 2];
    let vr = [unit.reference("lift")];
    let status = unsafe { fmi3GetFloat64(unit.handle, vr.as_ptr(), 1, few.as_mut_ptr(), 2) };
    unit.refused(status, "expected 3 values, found 2");
}

/// The adjoint is the transpose of the directional derivative.
#[test]
fn adjoints_are_transposed_directions() {
    let unit = NewStandardUnit::new("rational", None, false);
    unit.start();
    unit.ok(unit.step(0.0, 0.1));
    let unknowns = ["heave_acceleration", "moment"].map(|n| unit.reference(n));
    let knowns = ["wind_speed", "external_lift", "rotation"].map(|n| unit.reference(n));
    let mut matrix = [[0.0; 2]; 3];
    for (j, column) in matrix.iter_mut().enumerate() {
        let mut seed = [0.0; 3];
        seed[j] = 1.0;
        unit.ok(unsafe {
            fmi3GetDirectionalDerivative(
                unit.handle,
                unknowns.as_ptr(),
                2,
                knowns.as_ptr(),
                3,
                seed.as_ptr(),
                3,
                column.as_mut_ptr(),
                2,
            )
        });
    }
    let (seed, mut found) = ([2.0, -0.5], [f64::NAN; 3]);
    unit.ok(unsafe {
        fmi3GetAdjointDerivative(
            unit.handle,
            unknowns.as_ptr(),
            2,
            knowns.as_ptr(),
            3,
            seed.as_ptr(),
            2,
            found.as_mut_ptr(),
            3,
        )
    });
    for (column, found) in matrix.iter().zip(found) {
        assert_eq!(seed[0] * column[0] + seed[1] * column[1], found);
    }
    let (orders, mut rates) = ([1, 1], [f64::NAN; 2]);
    unit.ok(unsafe {
        fmi3GetOutputDerivatives(
            unit.handle,
            unknowns.as_ptr(),
            2,
            orders.as_ptr(),
            rates.as_mut_ptr(),
            2,
        )
    });
    assert!(rates.iter().all(|x| x.is_finite() && *x != 0.0));
}

/// What is no direction has no derivative.
#[test]
fn seeds_that_are_no_numbers_are_refused() {
    for seed in [f64::NAN, f64::INFINITY] {
        let unit = NewStandardUnit::new("rational", None, false);
        unit.start();
        let (unknown, known) = ([unit.reference("moment")], [unit.reference("rotation")]);
        let mut found = [7.0];
        let status = unsafe {
            fmi3GetAdjointDerivative(
                unit.handle,
                unknown.as_ptr(),
                1,
                known.as_ptr(),
                1,
                &raw const seed,
                1,
                found.as_mut_ptr(),
                1,
            )
        };
        unit.refused(status, "seed: expected finite numbers");
        assert_eq!(found, [7.0]);
    }
}

#[test]
fn an_importer_may_integrate() {
    let unit = NewStandardUnit::new("continuous_laguerre", None, true);
    unit.start();
    let mut flags = [true; 5];
    let [a, b, c, d, e] = &mut flags;
    let mut next = f64::NAN;
    unit.ok(unsafe { fmi3UpdateDiscreteStates(unit.handle, a, b, c, d, e, &raw mut next) });
    assert_eq!(flags, [false; 5]);
    unit.ok(unsafe { fmi3EnterContinuousTimeMode(unit.handle) });
    let mut count = 0;
    unit.ok(unsafe { fmi3GetNumberOfContinuousStates(unit.handle, &raw mut count) });
    assert_eq!(count, unit.resources.table.state_rates().len());
    let (mut x, mut rates) = (vec![0.0; count], vec![0.0; count]);
    unit.ok(unsafe { fmi3GetContinuousStates(unit.handle, x.as_mut_ptr(), count) });
    x[2] = 0.3;
    unit.ok(unsafe { fmi3SetContinuousStates(unit.handle, x.as_ptr(), count) });
    unit.ok(unsafe { fmi3GetContinuousStateDerivatives(unit.handle, rates.as_mut_ptr(), count) });
    assert_eq!(rates[0], 0.3);
    let (mut event, mut end) = (true, true);
    unit.ok(unsafe { fmi3CompletedIntegratorStep(unit.handle, 1, &raw mut event, &raw mut end) });
    assert!(!event && !end);
}

/// States of strips are arrays, which follow one another as the importer's list does.
#[test]
fn states_of_strips_are_arrays() {
    let unit = NewStandardUnit::new("rational", Some(3), true);
    unit.start();
    unit.ok(unsafe { fmi3EnterContinuousTimeMode(unit.handle) });
    unit.set("wind_speed", &[20.0]);
    unit.set("heave", &[0.01, 0.0, -0.02]);
    let count = unit.resources.table.state_rates().len();
    let x: Vec<f64> = (0..count).map(|i| 0.01 * (i + 1) as f64).collect();
    unit.ok(unsafe { fmi3SetContinuousStates(unit.handle, x.as_ptr(), count) });
    let mut rates = vec![f64::NAN; count];
    unit.ok(unsafe { fmi3GetContinuousStateDerivatives(unit.handle, rates.as_mut_ptr(), count) });
    for (i, (x, rates)) in x.chunks(3).zip(rates.chunks(3)).enumerate() {
        assert_eq!(unit.get(&format!("filter[{}]", i + 1), 3), x);
        let rate = unit
            .resources
            .table
            .find_name(&format!("der(strip[1].filter[{}])", i + 1));
        let group = unit.groups.reference_of(rate.unwrap()).unwrap() as u32;
        let mut values = [f64::NAN; 3];
        unit.ok(unsafe {
            fmi3GetFloat64(unit.handle, [group].as_ptr(), 1, values.as_mut_ptr(), 3)
        });
        assert_eq!(values, rates);
    }
}

#[test]
fn what_there_is_not_is_refused_and_the_run_goes_on() {
    let unit = NewStandardUnit::new("rational", None, false);
    unit.start();
    let vr = [unit.groups.time()];
    let status = unsafe { fmi3EnterStepMode(unit.handle) };
    unit.refused(status, "no event mode");
    let status = unsafe { fmi3GetShiftDecimal(unit.handle, vr.as_ptr(), 1, null_mut()) };
    unit.refused(status, "no clocks");
    unit.ok(unsafe { fmi3GetFloat32(unit.handle, null(), 0, null_mut(), 0) });
    unit.ok(unit.step(0.0, 0.1));
    let status = unsafe { fmi3GetInt8(unit.handle, vr.as_ptr(), 1, null_mut(), 1) };
    unit.refused(status, "no variables of this type");
    // a resource path, a token and a kind that do not fit
    assert!(
        NewStandardUnit::new("discrete_laguerre", Some(2), false)
            .instantiate(true, 0)
            .is_null()
    );
    let text: fmi2String = c"nothing".as_ptr();
    let none = unsafe {
        fmi3InstantiateScheduledExecution(
            text,
            text,
            text,
            0,
            0,
            null_mut(),
            None,
            null(),
            null(),
            null(),
        )
    };
    assert!(none.is_null());
}
