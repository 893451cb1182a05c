//! The importer integrates: the same motion as in steps of our own, and a linear system that closes on itself.

use super::*;
use fmi2Status::{fmi2Discard, fmi2Error};

const KINDS: [&str; 2] = ["continuous_laguerre", "rational"];

pub(super) fn exchanged(archive: Extracted) -> StartedUnit {
    let messages = Box::<Messages>::default();
    let functions = callbacks(&messages);
    let mut creation = Creation::right(&archive);
    creation.kind = fmi2ModelExchange;
    let handle = creation.call(&functions, false);
    assert!(!handle.is_null(), "{:?}", messages.lock().unwrap());
    StartedUnit {
        archive,
        messages,
        handle,
    }
}

impl StartedUnit {
    pub(super) fn integrate_from_event(&self) {
        let mut info = fmi2EventInfo {
            newDiscreteStatesNeeded: 1,
            ..Default::default()
        };
        self.ok(unsafe { fmi2NewDiscreteStates(self.handle, &raw mut info) });
        assert_eq!(info, fmi2EventInfo::default());
        self.ok(unsafe { fmi2EnterContinuousTimeMode(self.handle) });
    }

    pub(super) fn size(&self) -> usize {
        self.archive.resources.table.state_rates().len()
    }

    pub(super) fn states(&self) -> Vec<f64> {
        let mut x = vec![f64::NAN; self.size()];
        self.ok(unsafe { fmi2GetContinuousStates(self.handle, x.as_mut_ptr(), x.len()) });
        x
    }

    pub(super) fn rates_at(&self, time: f64, x: &[f64]) -> Vec<f64> {
        self.ok(unsafe { fmi2SetTime(self.handle, time) });
        self.ok(unsafe { fmi2SetContinuousStates(self.handle, x.as_ptr(), x.len()) });
        let mut rates = vec![f64::NAN; x.len()];
        self.ok(unsafe { fmi2GetDerivatives(self.handle, rates.as_mut_ptr(), x.len()) });
        rates
    }

    /// One step of the classical Runge–Kutta method in a wind that grows by `ramp` from 20 m/s at time zero.
    pub(super) fn runge_kutta(&self, time: f64, step: f64, ramp: f64) {
        let x = self.states();
        let rates = |time: f64, x: &[f64]| {
            self.set("wind_speed", 20.0 + ramp * time);
            self.rates_at(time, x)
        };
        let moved =
            |k: &[f64], by: f64| -> Vec<f64> { x.iter().zip(k).map(|(x, k)| x + by * k).collect() };
        let k1 = rates(time, &x);
        let k2 = rates(time + 0.5 * step, &moved(&k1, 0.5 * step));
        let k3 = rates(time + 0.5 * step, &moved(&k2, 0.5 * step));
        let k4 = rates(time + step, &moved(&k3, step));
        let mean: Vec<f64> = (0..x.len())
            .map(|i| (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) / 6.0)
            .collect();
        rates(time + step, &moved(&mean, step));
        let (mut event, mut end) = (1, 1);
        self.ok(unsafe {
            fmi2CompletedIntegratorStep(self.handle, 1, &raw mut event, &raw mut end)
        });
        assert_eq!((event, end), (0, 0));
    }

    pub(super) fn directional(&self, unknown: &str, known: &str) -> f64 {
        let (u, k) = (self.references(&[unknown]), self.references(&[known]));
        let mut value = f64::NAN;
        self.ok(unsafe {
            fmi2GetDirectionalDerivative(
                self.handle,
                u.as_ptr(),
                1,
                k.as_ptr(),
                1,
                [1.0].as_ptr(),
                &raw mut value,
            )
        });
        value
    }
}

/// Fixed steps of fourth order against exact ones, in steady and in growing wind; half the step leaves a sixteenth of the difference.
#[test]
fn the_motion_is_that_of_co_simulation() {
    let archives: [fn() -> Extracted; 3] = [
        || Extracted::fixture(KINDS[0]),
        || Extracted::fixture(KINDS[1]),
        Extracted::three_dof,
    ];
    let runs = archives.iter().flat_map(|a| [(a, 0.0), (a, 15.0)]);
    for (archive, ramp) in runs {
        let mut errors = Vec::new();
        for steps in [2000u32, 4000] {
            let (own, foreign) = (StartedUnit::instantiate(archive()), exchanged(archive()));
            own.start();
            foreign.start();
            foreign.set("external_lift", 3.0);
            own.set("external_lift", 3.0);
            own.set("wind_speed", 20.0);
            own.set_rate("wind_speed", ramp);
            foreign.integrate_from_event();
            let step = 1.0 / f64::from(steps);
            for i in 0..steps {
                foreign.runge_kutta(f64::from(i) * step, step, ramp);
            }
            own.ok(own.step(0.0, 1.0));
            let (a, b) = (own.outputs(), foreign.outputs());
            let size = a.iter().fold(0.0_f64, |s, x| s.max(x.abs()));
            let off = a.iter().zip(&b).map(|(a, b)| (a - b).abs());
            errors.push(off.fold(0.0, f64::max) / size);
        }
        assert!(errors[1] < 1e-7, "{errors:?}");
        assert!(
            (12.0..20.0).contains(&(errors[0] / errors[1])),
            "{errors:?}"
        );
    }
}

/// Columns of A, B, C, D from directional derivatives put the rates and outputs together again.
#[test]
fn the_state_space_gives_rates_and_outputs() {
    for kind in KINDS {
        let unit = exchanged(Extracted::fixture(kind));
        unit.start();
        unit.integrate_from_event();
        let table = &unit.archive.resources.table;
        let name = |index: usize| table.variables()[index].name.clone();
        let rates: Vec<String> = table.state_rates().into_iter().map(name).collect();
        let states: Vec<String> = table
            .state_rates()
            .into_iter()
            .map(|i| name(table.variables()[i].derivative_of.unwrap()))
            .collect();
        assert_eq!(
            rates[..2],
            states[2..4],
            "rates of displacements are states"
        );
        let x: Vec<f64> = (0..states.len()).map(|i| 0.01 / (i + 1) as f64).collect();
        let found = unit.rates_at(0.0, &x);
        unit.set("external_lift", 2.0);
        let mut outputs = rates.clone();
        outputs.extend(["lift".to_owned(), "moment".to_owned(), "heave".to_owned()]);
        for (i, output) in outputs.iter().enumerate() {
            let mut sum = 2.0 * unit.directional(output, "external_lift");
            for (state, value) in states.iter().zip(&x) {
                sum += value * unit.directional(output, state);
            }
            let [value] = unit.get([output]);
            assert!(
                (sum - value).abs() <= 1e-12 * value.abs().max(1.0),
                "{kind}, {output}: {sum} {value}"
            );
            // without the force
            let change = 2.0 * unit.directional(output, "external_lift");
            if let Some(rate) = found.get(i) {
                assert!(
                    (value - change - rate).abs() <= 1e-12 * value.abs().max(1.0),
                    "{kind}, {output}"
                );
            }
        }
        assert_eq!(unit.get(["filter[1]"]), [x[4]]);
    }
}

/// The wind's column, against a difference of the rates.
#[test]
fn rates_follow_the_wind() {
    let unit = exchanged(Extracted::fixture(KINDS[0]));
    unit.start();
    unit.integrate_from_event();
    let x: Vec<f64> = (0..unit.size()).map(|i| 0.01 / (i + 1) as f64).collect();
    let rates = unit.archive.resources.table.state_rates();
    let [wind] = unit.get(["wind_speed"]);
    let step = 1e-4;
    unit.set("wind_speed", wind + step);
    let above = unit.rates_at(0.0, &x);
    unit.set("wind_speed", wind - step);
    let below = unit.rates_at(0.0, &x);
    unit.set("wind_speed", wind);
    for (i, rate) in rates.into_iter().enumerate() {
        let name = unit.archive.resources.table.variables()[rate].name.clone();
        let expected = (above[i] - below[i]) / (2.0 * step);
        let found = unit.directional(&name, "wind_speed");
        // rates are of second degree in the wind: the difference is exact but for rounding
        assert!(
            (found - expected).abs() < 1e-8 * expected.abs().max(1.0),
            "{name}: {found} {expected}"
        );
    }
}

/// A sampled model has nothing to integrate.
pub(super) fn cannot_be_integrated(archive: &Extracted) {
    let messages = Box::<Messages>::default();
    let functions = callbacks(&messages);
    let mut creation = Creation::right(archive);
    creation.kind = fmi2ModelExchange;
    assert!(creation.call(&functions, false).is_null());
    let (.., message) = messages.lock().unwrap().last().cloned().unwrap();
    assert!(message.contains("no continuous states"), "{message}");
}

#[test]
fn what_does_not_belong_to_it_is_refused() {
    cannot_be_integrated(&Extracted::fixture("discrete_laguerre"));

    let unit = exchanged(Extracted::fixture(KINDS[1]));
    unit.start();
    unit.integrate_from_event();
    let x = vec![f64::NAN; unit.size()];
    let before = unit.states();
    let set = |x: &[f64]| unsafe { fmi2SetContinuousStates(unit.handle, x.as_ptr(), x.len()) };
    unit.refused(set(&x), fmi2Discard, &["finite"]);
    assert_eq!(unit.states(), before);
    let indicators = unsafe { fmi2GetEventIndicators(unit.handle, null(), 1) };
    unit.refused(indicators, fmi2Error, &["expected 0, found 1"]);
    let mut nominals = vec![0.0; unit.size()];
    unit.ok(unsafe {
        fmi2GetNominalsOfContinuousStates(unit.handle, nominals.as_mut_ptr(), nominals.len())
    });
    assert!(nominals.iter().all(|x| *x > 0.0));

    // a state of the other interface
    let own = StartedUnit::started(KINDS[1]);
    let mut saved = null();
    own.ok(unsafe { fmi2GetFMUstate(own.handle, &raw mut saved) });
    let status = unsafe { fmi2SetFMUstate(unit.handle, saved) };
    unit.refused(status, fmi2Error, &["model exchange", "co-simulation"]);
    own.ok(unsafe { fmi2FreeFMUstate(own.handle, &raw mut saved) });

    for illegal in [
        |u: &StartedUnit| u.step(0.0, 0.1),
        |u: &StartedUnit| u.try_set(&["mass"], &[5.0]),
        |u: &StartedUnit| unsafe { fmi2SetContinuousStates(u.handle, null(), 0) },
    ] {
        let unit = exchanged(Extracted::fixture(KINDS[1]));
        unit.start();
        unit.integrate_from_event();
        unit.refused(illegal(&unit), fmi2Error, &[]);
        unit.ok(unit.reset());
        unit.start();
    }
}

/// Parameters change at events; the motion stays where it is.
#[test]
fn parameters_change_at_events() {
    let unit = exchanged(Extracted::fixture(KINDS[0]));
    unit.start();
    unit.integrate_from_event();
    unit.runge_kutta(0.0, 0.01, 0.0);
    let before = unit.states();
    unit.ok(unsafe { fmi2EnterEventMode(unit.handle) });
    let [acceleration] = unit.get(["heave_acceleration"]);
    let [mass] = unit.get(["mass"]);
    unit.set("mass", 2.0 * mass);
    assert_eq!(unit.states(), before);
    let [heavier] = unit.get(["heave_acceleration"]);
    assert_ne!(heavier, acceleration);
    unit.integrate_from_event();
    unit.ok(unsafe { fmi2Terminate(unit.handle) });
}
