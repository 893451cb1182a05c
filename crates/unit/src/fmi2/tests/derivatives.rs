//! Derivatives against differences of the run itself.

use super::*;
use fmi2Status::fmi2Error;

fn output_rates<const N: usize>(unit: &StartedUnit, names: [&str; N]) -> [f64; N] {
    let (vr, order, mut values) = (unit.references(&names), [1; N], [f64::NAN; N]);
    unit.ok(unsafe {
        fmi2GetRealOutputDerivatives(
            unit.handle,
            vr.as_ptr(),
            N,
            order.as_ptr(),
            values.as_mut_ptr(),
        )
    });
    values
}

fn directional(unit: &StartedUnit, unknown: &str, known: &[&str], seeds: &[f64]) -> f64 {
    let (u, k) = (unit.references(&[unknown]), unit.references(known));
    let mut value = f64::NAN;
    unit.ok(unsafe {
        fmi2GetDirectionalDerivative(
            unit.handle,
            u.as_ptr(),
            1,
            k.as_ptr(),
            k.len(),
            seeds.as_ptr(),
            &raw mut value,
        )
    });
    value
}

const NAMES: [&str; 8] = [
    "heave",
    "heave_rate",
    "heave_acceleration",
    "lift",
    "rotation",
    "rotation_rate",
    "rotation_acceleration",
    "moment",
];

/// `|a − b|` small against `b`, or against one where `b` is small.
#[track_caller]
fn close(a: f64, b: f64, tolerance: f64, name: &str) {
    assert!(
        (a - b).abs() <= tolerance * b.abs().max(1.0),
        "{name}: {a} {b}"
    );
}

/// Rates of outputs with ramped wind and forces, against one short step to either side of the instant.
#[test]
fn output_rates_are_those_of_the_run() {
    for kind in ["continuous_laguerre", "rational"] {
        let unit = StartedUnit::started(kind);
        unit.set("external_lift", 3.0);
        unit.ok(unit.step(0.0, 0.4));
        unit.set_rate("external_lift", 40.0);
        unit.set_rate("wind_speed", 3.0);
        let step = 1e-5;
        let before = unit.get(NAMES);
        unit.ok(unit.step(0.4, step));
        let rates = output_rates(&unit, NAMES);
        unit.ok(unit.step(0.4 + step, step));
        let after = unit.get(NAMES);
        for i in 0..8 {
            let difference = (after[i] - before[i]) / (2.0 * step);
            // the difference loses about eps/step of the value, and has an error of step²
            close(rates[i], difference, 1e-7, NAMES[i]);
        }
        let [rate, acceleration] = unit.get(["heave_rate", "heave_acceleration"]);
        let now = output_rates(&unit, ["heave", "heave_rate"]);
        close(now[0], rate, 1e-12, "heave");
        close(now[1], acceleration, 1e-12, "heave_rate");
    }
}

#[test]
fn outputs_by_inputs() {
    for kind in ["continuous_laguerre", "rational", "discrete_laguerre"] {
        let unit = StartedUnit::started(kind);
        unit.ok(unit.step(0.0, 0.37));
        for (input, delta) in [
            ("wind_speed", 1e-3),
            ("external_lift", 1.0),
            ("external_moment", 1.0),
        ] {
            let [value] = unit.get([input]);
            unit.set(input, value - delta);
            let below = unit.get(NAMES);
            unit.set(input, value + delta);
            let above = unit.get(NAMES);
            unit.set(input, value);
            for i in 0..8 {
                let difference = (above[i] - below[i]) / (2.0 * delta);
                let exact = directional(&unit, NAMES[i], &[input], &[1.0]);
                close(exact, difference, 1e-9, NAMES[i]);
            }
        }
        // a direction is a sum of columns
        let both = directional(
            &unit,
            "heave_acceleration",
            &["wind_speed", "external_lift"],
            &[2.0, -3.0],
        );
        let speed = directional(&unit, "heave_acceleration", &["wind_speed"], &[1.0]);
        let lift = directional(&unit, "heave_acceleration", &["external_lift"], &[1.0]);
        close(both, 2.0 * speed - 3.0 * lift, 1e-14, "sum");
    }
}

#[test]
fn unknowns_by_parameters_while_initialising() {
    let unit = StartedUnit::new("continuous_laguerre");
    unit.ok(unit.set_up());
    unit.ok(unit.enter());
    for (known, delta, tolerance) in [
        ("initial_rotation", 1e-3, 1e-10),
        ("initial_heave_rate", 1e-3, 1e-10),
        ("mass", 1e-3, 1e-6),
        ("width", 1e-5, 1e-6),
        ("torsion_damping_ratio", 1e-6, 1e-6),
    ] {
        let [value] = unit.get([known]);
        unit.set(known, value - delta);
        let below = unit.get(NAMES);
        unit.set(known, value + delta);
        let above = unit.get(NAMES);
        unit.set(known, value);
        for i in 0..8 {
            let difference = (above[i] - below[i]) / (2.0 * delta);
            let derivative = directional(&unit, NAMES[i], &[known], &[1.0]);
            close(
                derivative,
                difference,
                tolerance,
                &format!("{} by {known}", NAMES[i]),
            );
        }
    }
    assert_eq!(directional(&unit, "heave", &["initial_heave"], &[1.0]), 1.0);
    // the onset speed grows with the torsional frequency and does not feel the wind
    let slope = directional(&unit, "onset_speed", &["torsion_frequency"], &[1.0]);
    let [speed] = unit.get(["onset_speed"]);
    unit.set("torsion_frequency", 5.01);
    let [higher] = unit.get(["onset_speed"]);
    assert!((slope - (higher - speed) / 0.01).abs() < 0.01 * slope);
    assert_eq!(
        directional(&unit, "onset_speed", &["wind_speed"], &[1.0]),
        0.0
    );
}

#[test]
fn wrong_derivatives_are_refused() {
    let call = |unknown: &str, known: &str| {
        let unit = StartedUnit::started("rational");
        let (u, k) = (unit.references(&[unknown]), unit.references(&[known]));
        let mut value = 0.0;
        let status = unsafe {
            fmi2GetDirectionalDerivative(
                unit.handle,
                u.as_ptr(),
                1,
                k.as_ptr(),
                1,
                [1.0].as_ptr(),
                &raw mut value,
            )
        };
        unit.refused(
            status,
            fmi2Error,
            &["directional derivative", "step complete"],
        );
    };
    call("heave", "mass"); // parameters are knowns only while initialising
    call("onset_speed", "wind_speed");
    call("heave", "lift");
    call("wind_speed", "wind_speed");
    let unit = StartedUnit::started("rational");
    let vr = unit.references(&["heave"]);
    let mut value = 0.0;
    let status = unsafe {
        fmi2GetRealOutputDerivatives(unit.handle, vr.as_ptr(), 1, [2].as_ptr(), &raw mut value)
    };
    unit.refused(status, fmi2Error, &["order", "found 2"]);
    unit.ok(unit.step(0.0, 0.1)); // the run goes on
    let unit = StartedUnit::started("rational");
    let status = unsafe {
        fmi2SetRealInputDerivatives(unit.handle, vr.as_ptr(), 1, [1].as_ptr(), [0.1].as_ptr())
    };
    unit.refused(status, fmi2Error, &["`heave` is no input"]);
}
