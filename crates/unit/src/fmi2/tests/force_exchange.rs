//! Forces alone beside an importer that integrates: a linear system that closes on itself, strip by strip, and motion that is
//! not connected.

use super::model_exchange::{cannot_be_integrated, exchanged};
use super::*;
use crate::aerodynamics::{GustForce, RationalAdmittance};
use crate::force_options::{FORCE_FILE, ForceOptions};
use crate::section::Dof;
use crate::variables::Causality;
use fmi2Status::fmi2Error;

pub(super) const KINDS: [&str; 2] = ["continuous_laguerre", "rational"];

/// Which archive of a fixture.
#[derive(Clone, Copy, Default)]
pub(super) struct What {
    /// Forces alone on so many strips; the section without.
    pub strips: Option<usize>,
    pub gusts: bool,
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

impl Extracted {
    pub(super) fn exported(self, what: What) -> Self {
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
        let options = [force.as_deref(), gusts.as_deref(), None];
        Self {
            resources: Resources::from_bytes(&model, options).unwrap(),
            ..self
        }
    }
}

fn archive(kind: &str, what: What) -> Extracted {
    Extracted::fixture(kind).exported(what)
}

pub(super) fn alone() -> What {
    What {
        strips: Some(1),
        gusts: false,
    }
}

impl StartedUnit {
    fn completed_status(&self) -> fmi2Status {
        let (mut event, mut end) = (1, 1);
        unsafe { fmi2CompletedIntegratorStep(self.handle, 1, &raw mut event, &raw mut end) }
    }

    pub(super) fn completed(&self) {
        self.ok(self.completed_status());
    }
}

/// Names of the states in their order, and of their rates.
fn state_names(unit: &StartedUnit) -> [Vec<String>; 2] {
    let table = &unit.archive.resources.table;
    let name = |index: usize| table.variables()[index].name.clone();
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

/// In co-simulation motion that is set for one strip is of that strip alone: the others go on as they were, gusts included.
#[test]
fn motion_of_one_strip_is_not_that_of_others() {
    let three = What {
        strips: Some(3),
        gusts: true,
    };
    for kind in KINDS {
        let unit = StartedUnit::instantiate(archive(kind, three));
        unit.start();
        let names = ["strip[1].lift", "strip[2].lift", "strip[3].total_moment"];
        let set = |s: usize, t: f64| {
            let phase = 9.0 * t + s as f64;
            unit.set(&format!("strip[{s}].heave"), 0.01 * phase.sin());
            unit.set(&format!("strip[{s}].rotation"), 0.02 * phase.cos());
            unit.set(&format!("strip[{s}].gust_w"), 0.3 * phase.sin());
        };
        for i in 0..30 {
            (1..=3).for_each(|s| set(s, 0.01 * f64::from(i)));
            unit.ok(unit.step(0.01 * f64::from(i), 0.01));
        }
        let before = unit.get(names);
        set(2, 0.3);
        let after = unit.get(names);
        assert_eq!([after[0], after[2]], [before[0], before[2]], "{kind}");
        assert_ne!(after[1], before[1], "{kind}");
        set(1, 0.3);
        set(3, 0.3);
        let all = unit.get(names);
        assert_eq!(all[1], after[1], "{kind}");
        assert!(all[0] != after[0] && all[2] != after[2], "{kind}");
    }
}

/// No force of a strip, per length or in all, is infinite.
#[test]
fn totals_that_overflow_are_refused() {
    for unit in [
        StartedUnit::instantiate(archive(KINDS[0], alone())),
        exchanged(archive(KINDS[0], alone())),
    ] {
        unit.set("length", 1e308);
        unit.start();
        unit.set("rotation", 1e4);
        let mut total = [0.0];
        let refused = unit.try_get(&["total_lift"], &mut total);
        unit.refused(refused, fmi2Status::fmi2Discard, &["overflowed"]);
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
        let own = StartedUnit::instantiate(archive(kind, what));
        let foreign = exchanged(archive(kind, what));
        let [states, rates] = state_names(&own);
        for unit in [&own, &foreign] {
            for (name, value) in [("heave", 0.02), ("rotation", -0.01), ("gust_w", 2.0)] {
                unit.set(name, value);
            }
            unit.start();
        }
        let read = |unit: &StartedUnit, names: &[String]| {
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
    let said = |unit: &StartedUnit| {
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
    unit.refused(
        status,
        fmi2Status::fmi2Discard,
        &["motion_derivatives", "found 0"],
    );
}

fn has_added_mass(unit: &StartedUnit) -> bool {
    unit.directional("lift", "heave_acceleration") != 0.0
}

#[test]
fn sampled_forces_are_refused() {
    let archive = archive("discrete_laguerre", alone());
    assert!(archive.resources.table.state_rates().is_empty());
    cannot_be_integrated(&archive);
}
