//! Forces alone beside an importer that integrates: with a structure outside the section in one piece, and a linear system
//! that closes on itself.

use super::model_exchange::exchanged;
use super::*;
use crate::aerodynamics::{GustForce, RationalAdmittance};
use crate::fmu::force_options::{FORCE_FILE, ForceOptions};
use crate::fmu::variables::Causality;
use crate::section::{Dof, Structure};
use fmi2Status::fmi2Error;
use nalgebra::{DMatrix, DVector};

const KINDS: [&str; 2] = ["continuous_laguerre", "rational"];

/// Which archive of a fixture.
#[derive(Clone, Copy, Default)]
struct What {
    /// Forces alone on so many strips; the section without.
    strips: Option<usize>,
    gusts: bool,
}

fn gust_force() -> Vec<u8> {
    let force = GustForce {
        dofs: Dof::TWO.to_vec(),
        coefficients: vec![[0.3, -5.0], [0.05, 1.2]],
        admittance: RationalAdmittance::Sears,
        source: "test".into(),
    };
    serde_json::to_vec(&force).unwrap()
}

impl Archive {
    fn exported(self, what: What) -> Self {
        let folder = self.folder.path();
        let model = std::fs::read(folder.join("model.json")).unwrap();
        let width = self.model().section.width_m;
        let force = what.strips.map(|count| {
            let mut options = ForceOptions::single(width);
            options.strips = vec![options.strips[0].clone(); count];
            options.named_strips = count > 1;
            options.to_json().unwrap().into_bytes()
        });
        let gusts = what.gusts.then(gust_force);
        for (name, bytes) in [(FORCE_FILE, &force), ("gusts.json", &gusts)] {
            if let Some(bytes) = bytes {
                std::fs::write(folder.join(name), bytes).unwrap();
            }
        }
        let options = OptionFiles {
            force: force.as_deref(),
            gusts: gusts.as_deref(),
            bounds: None,
        };
        Self {
            resources: Resources::from_bytes(&model, options).unwrap(),
            ..self
        }
    }
}

fn archive(kind: &str, what: What) -> Archive {
    Archive::fixture(kind).exported(what)
}

fn alone() -> What {
    What {
        strips: Some(1),
        gusts: false,
    }
}

/// The forces of a unit and the structure of its model, integrated together.
struct Beside {
    forces: Unit,
    structure: Structure,
    /// Mass less the forces by acceleration.
    inertia: DMatrix<f64>,
    ramp: f64,
}

impl Beside {
    fn new(archive: Archive, ramp: f64, q: &[f64]) -> Self {
        let structure = archive.model().section.structure().unwrap();
        let forces = exchanged(archive);
        forces.set("wind_speed", 20.0);
        let this = Self {
            inertia: structure.mass.clone(),
            forces,
            structure,
            ramp,
        };
        for (name, value) in this.names("").iter().zip(q) {
            this.forces.set(name, *value);
        }
        let gusts = this.forces.archive.resources.gusts.is_some();
        if gusts {
            this.forces.set("gust_w", 1.5);
        }
        this.forces.start();
        if gusts {
            this.forces.set("gust_u", -1.0);
        }
        this.forces.integrate_from_event();
        let n = this.structure.dofs.len();
        let (force, acceleration) = (this.forces_names(), this.names("_acceleration"));
        let by = DMatrix::from_fn(n, n, |i, j| {
            this.forces.directional(force[i], &acceleration[j])
        });
        Self {
            inertia: &this.structure.mass - by,
            ..this
        }
    }

    fn names(&self, ending: &str) -> Vec<String> {
        let name = |dof: &Dof| match dof {
            Dof::Vertical => "heave",
            Dof::Lateral => "sway",
            Dof::Torsion => "rotation",
        };
        let dofs = self.forces.archive.model().section.dofs();
        dofs.iter()
            .map(|d| format!("{}{ending}", name(d)))
            .collect()
    }

    fn forces_names(&self) -> Vec<&'static str> {
        let all = self.forces.archive.model().section.dofs();
        let name = |dof: &Dof| match dof {
            Dof::Vertical => "lift",
            Dof::Lateral => "drag",
            Dof::Torsion => "moment",
        };
        all.iter().map(name).collect()
    }

    /// Rates of displacements, their rates and the states of the unit.
    fn rates(&self, time: f64, z: &[f64]) -> Vec<f64> {
        let n = self.structure.dofs.len();
        let (q, rest) = z.split_at(n);
        let (v, x) = rest.split_at(n);
        self.forces.set("wind_speed", 20.0 + self.ramp * time);
        for (ending, values) in [("", q), ("_rate", v), ("_acceleration", &vec![0.0; n])] {
            for (name, value) in self.names(ending).iter().zip(values) {
                self.forces.set(name, *value);
            }
        }
        let states = self.forces.rates_at(time, x);
        let mut force = vec![f64::NAN; n];
        self.forces
            .ok(self.forces.try_get(&self.forces_names(), &mut force));
        let s = &self.structure;
        let (q, velocity) = (DVector::from_row_slice(q), DVector::from_row_slice(v));
        let sum = DVector::from_vec(force) - &s.damping * velocity - &s.stiffness * q;
        let acceleration = self.inertia.clone().lu().solve(&sum).unwrap();
        [v, acceleration.as_slice(), &states].concat()
    }

    /// The classical Runge–Kutta method from `q` at rest over a second.
    fn run(&self, q: &[f64], steps: u32) -> Vec<f64> {
        let h = 1.0 / f64::from(steps);
        let mut z = [q, &vec![0.0; q.len()], &self.forces.states()].concat();
        for i in 0..steps {
            let t = f64::from(i) * h;
            let moved = |k: &[f64], by: f64| -> Vec<f64> {
                z.iter().zip(k).map(|(z, k)| z + by * k).collect()
            };
            let k1 = self.rates(t, &z);
            let k2 = self.rates(t + 0.5 * h, &moved(&k1, 0.5 * h));
            let k3 = self.rates(t + 0.5 * h, &moved(&k2, 0.5 * h));
            let k4 = self.rates(t + h, &moved(&k3, h));
            let mean = |i: usize| (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) / 6.0;
            z = (0..z.len()).map(|i| z[i] + h * mean(i)).collect();
        }
        self.rates(1.0, &z);
        self.forces.completed();
        z
    }
}

impl Unit {
    fn completed_status(&self) -> fmi2Status {
        let (mut event, mut end) = (1, 1);
        unsafe { fmi2CompletedIntegratorStep(self.handle, 1, &raw mut event, &raw mut end) }
    }

    fn completed(&self) {
        self.ok(self.completed_status());
    }
}

/// Forces and structure together against the section's own exact steps, in steady and in growing wind and in gusts; half the
/// step leaves a sixteenth of the difference.
#[test]
fn with_a_structure_outside_it_is_the_section() {
    let plain: [fn() -> Archive; 3] = [
        || Archive::fixture(KINDS[0]),
        || Archive::fixture(KINDS[1]),
        Archive::three_dof,
    ];
    let plain = plain.into_iter().map(|a| (a, false));
    let gusty: [(fn() -> Archive, bool); 1] = [(|| Archive::fixture(KINDS[1]), true)];
    let cases = plain.chain(gusty);
    for ((fixture, gusts), ramp) in cases.flat_map(|c| [(c, 0.0), (c, 15.0)]) {
        let section = What {
            strips: None,
            gusts,
        };
        let own = Unit::instantiate(fixture().exported(section));
        own.set("wind_speed", 20.0);
        if gusts {
            own.set("gust_w", 1.5);
        }
        own.start();
        own.set_rate("wind_speed", ramp);
        let places = own.archive.resources.table.state_rates();
        let table = &own.archive.resources.table;
        let state = |i: usize| {
            let of = table.variables()[places[i]].derivative_of.unwrap();
            table.variables()[of].name.clone()
        };
        let names: Vec<String> = (0..places.len()).map(state).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let n = own.archive.model().section.dofs().len();
        let read = || {
            let mut values = vec![f64::NAN; names.len()];
            own.ok(own.try_get(&names, &mut values));
            values
        };
        let q = read()[..n].to_vec();
        if gusts {
            own.set("gust_u", -1.0);
        }
        own.ok(own.step(0.0, 1.0));
        let expected = read();
        let mut errors = Vec::new();
        for steps in [1000u32, 2000] {
            let beside = Beside::new(fixture().exported(What { gusts, ..alone() }), ramp, &q);
            let found = beside.run(&q, steps);
            let off = |range: std::ops::Range<usize>| {
                let size = expected[range.clone()]
                    .iter()
                    .fold(0.0_f64, |s, x| s.max(x.abs()));
                let off = range.map(|i| (expected[i] - found[i]).abs());
                off.fold(0.0, f64::max) / size
            };
            errors.push(off(0..n).max(off(2 * n..expected.len())));
        }
        assert!(errors[1] < 1e-6, "{errors:?}");
        assert!(
            (12.0..20.0).contains(&(errors[0] / errors[1])),
            "{errors:?}"
        );
    }
}

/// Names of the states in their order, and of their rates.
fn state_names(unit: &Unit) -> [Vec<String>; 2] {
    let table = &unit.archive.resources.table;
    let name = |place: usize| table.variables()[place].name.clone();
    let state = |rate: usize| name(table.variables()[rate].derivative_of.unwrap());
    let rates = table.state_rates();
    [
        rates.iter().map(|r| state(*r)).collect(),
        rates.into_iter().map(name).collect(),
    ]
}

/// Columns of A, B, C, D from directional derivatives put rates and forces together again; those of the wind are slopes.
#[test]
fn the_state_space_gives_rates_and_forces() {
    for (kind, strips, gusts) in [
        (KINDS[0], 1, false),
        (KINDS[1], 1, true),
        (KINDS[1], 2, true),
    ] {
        let strips = Some(strips);
        let unit = exchanged(archive(kind, What { strips, gusts }));
        unit.start();
        unit.integrate_from_event();
        let [states, rates] = state_names(&unit);
        let x: Vec<f64> = (0..states.len()).map(|i| 0.01 / (i + 1) as f64).collect();
        let variables = unit.archive.resources.table.variables();
        let named = |causality| {
            let all = variables.iter().filter(move |v| v.causality == causality);
            all.map(|v| v.name.clone()).filter(|n| n != "wind_speed")
        };
        let inputs: Vec<String> = named(Causality::Input).collect();
        for (i, input) in inputs.iter().enumerate() {
            unit.set(input, 0.1 / (i + 2) as f64);
        }
        let found = unit.rates_at(0.0, &x);
        let outputs = named(Causality::Output);
        for (i, unknown) in rates.iter().cloned().chain(outputs).enumerate() {
            let mut sum = 0.0;
            let mut size = 0.0;
            for known in states.iter().chain(&inputs) {
                let term = unit.directional(&unknown, known) * unit.get([known])[0];
                (sum, size) = (sum + term, size + term.abs());
            }
            let [value] = unit.get([&unknown]);
            assert!(
                (sum - value).abs() <= 1e-13 * size,
                "{unknown}: {sum} {value}"
            );
            assert!(found.get(i).is_none_or(|rate| *rate == value));
            let [wind] = unit.get(["wind_speed"]);
            let slope = unit.directional(&unknown, "wind_speed");
            let ends = [0.9, 1.1].map(|by| {
                unit.set("wind_speed", by * wind);
                unit.get([&unknown])[0]
            });
            unit.set("wind_speed", wind);
            let expected = (ends[1] - ends[0]) / (0.2 * wind);
            assert!((slope - expected).abs() <= 1e-11 * size / wind, "{unknown}");
        }
    }
}

/// Strips are units of their own side by side, and so is every one of their states.
#[test]
fn strips_are_single_units_side_by_side() {
    let what = |count| What {
        strips: Some(count),
        gusts: true,
    };
    let [three, single] = [3, 1].map(|n| exchanged(archive(KINDS[1], what(n))));
    for unit in [&three, &single] {
        unit.start();
        unit.integrate_from_event();
    }
    let each = single.size();
    assert_eq!(three.size(), 3 * each);
    let x: Vec<f64> = (0..3 * each).map(|i| 0.01 / (i + 1) as f64).collect();
    let motion = |s: usize| {
        let at = |i: usize| 0.01 * (s + 1) as f64 - 0.004 * i as f64;
        [
            ("heave", at(0)),
            ("rotation_rate", at(1)),
            ("gust_w", at(2)),
        ]
    };
    for s in 0..3 {
        for (name, value) in motion(s) {
            three.set(&format!("strip[{}].{name}", s + 1), value);
        }
    }
    let rates = three.rates_at(0.0, &x);
    for s in 0..3 {
        for (name, value) in motion(s) {
            single.set(name, value);
        }
        // one state of all strips stands before the next
        let of = |all: &[f64]| -> Vec<f64> { (0..each).map(|k| all[3 * k + s]).collect() };
        assert_eq!(single.rates_at(0.0, &of(&x)), of(&rates));
        let [lift, total] = ["lift", "total_moment"].map(|n| format!("strip[{}].{n}", s + 1));
        assert_eq!(
            three.get([lift.as_str(), &total]),
            single.get(["lift", "total_moment"])
        );
    }
}

/// In co-simulation the same states can be read; at the start they are those of the settled flow.
#[test]
fn the_flow_has_settled_in_both_interfaces() {
    for kind in KINDS {
        let what = What {
            gusts: true,
            ..alone()
        };
        let own = Unit::instantiate(archive(kind, what));
        let foreign = exchanged(archive(kind, what));
        let [states, rates] = state_names(&own);
        for unit in [&own, &foreign] {
            for (name, value) in [("heave", 0.02), ("rotation", -0.01), ("gust_w", 2.0)] {
                unit.set(name, value);
            }
            unit.start();
        }
        let read = |unit: &Unit, names: &[String]| {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let mut values = vec![f64::NAN; names.len()];
            unit.ok(unit.try_get(&names, &mut values));
            values
        };
        assert_eq!(read(&own, &states), foreign.states());
        assert!(foreign.states().iter().any(|x| *x != 0.0));
        assert!(read(&foreign, &rates).iter().all(|x| x.abs() < 1e-12));
        // at rest prediction changes nothing
        let both = [&own, &foreign].map(|u| u.get(["lift", "moment"]));
        for (a, b) in both[0].iter().zip(&both[1]) {
            assert!((a / b - 1.0).abs() < 1e-12, "{both:?}");
        }
        own.ok(own.step(0.0, 0.1));
        assert_eq!(read(&own, &states), foreign.states());
    }
}

/// Motion without its rates would act as if it stood still.
#[test]
fn motion_that_is_not_connected_is_refused() {
    let started = |derivatives: f64| {
        let unit = exchanged(archive(KINDS[1], alone()));
        unit.set("motion_derivatives", derivatives);
        unit.ok(unsafe { fmi2SetDebugLogging(unit.handle, 1, 0, null()) });
        unit.start();
        unit.integrate_from_event();
        unit
    };
    let unit = started(-1.0);
    // what is set once stands still
    unit.set("heave", 0.01);
    unit.ok(unsafe { fmi2EnterEventMode(unit.handle) });
    unit.set("rotation", 0.01);
    unit.integrate_from_event();
    unit.set("rotation", 0.01);
    unit.set("heave_rate", 0.1);
    unit.completed();
    let words = ["added mass", "heave_acceleration"];
    let said = |unit: &Unit| {
        let all = unit.messages.lock().unwrap();
        all.iter()
            .filter(|m| words.iter().all(|w| m.3.contains(w)))
            .count()
    };
    unit.completed();
    assert_eq!(said(&unit), usize::from(has_added_mass(&unit)));
    unit.set("rotation", 0.02);
    let status = unit.completed_status();
    unit.refused(
        status,
        fmi2Error,
        &["`rotation` moves", "`rotation_rate` has never been set"],
    );
    unit.ok(unit.reset());

    let unit = started(1.0);
    unit.set("rotation", 0.02);
    unit.completed();
    assert_eq!(said(&unit), 0);

    let unit = exchanged(archive(KINDS[1], alone()));
    unit.set("motion_derivatives", 0.0);
    unit.ok(unit.set_up());
    unit.ok(unit.enter());
    let status = unit.exit();
    unit.refused(status, fmi2Error, &["motion_derivatives", "found 0"]);
}

fn has_added_mass(unit: &Unit) -> bool {
    unit.directional("lift", "heave_acceleration") != 0.0
}

#[test]
fn sampled_forces_are_refused() {
    let archive = archive("discrete_laguerre", alone());
    assert!(archive.resources.table.state_rates().is_empty());
    let messages = Box::<Messages>::default();
    let functions = callbacks(&messages);
    let mut creation = Creation::right(&archive);
    creation.kind = fmi2ModelExchange;
    assert!(creation.call(&functions, false).is_null());
    let (.., message) = messages.lock().unwrap().last().cloned().unwrap();
    assert!(message.contains("no continuous states"), "{message}");
}
