//! Exact steps against an independent integration and against the sampled system's own matrices.

use crate::steppers::{blown, discrete, distance, jones, runge_kutta};
use aerodeck::aeroelastic::CoupledSystem;
use aerodeck::response::{Inputs, Outputs, Stepper};
use nalgebra::DVector;

#[test]
fn a_step_is_the_solution_of_the_differential_equation() {
    let mut stepper = jones();
    let start = stepper.released(&[0.01, 0.02], &[0.1, 0.0]).unwrap();
    for inputs in [Inputs::steady(35.0, 2), blown(35.0)] {
        let mut state = start.clone();
        stepper.advance(&mut state, &inputs, 0.3).unwrap();
        let reference = runge_kutta(&stepper, &start, &inputs, 0.3, 4000);
        // the reference's own error, (ωτ)⁴ ≈ 1e-11
        assert!(distance(&reference, &state.values) < 1e-10);
    }
}

#[test]
fn one_step_is_two_halves() {
    for mut stepper in [jones(), discrete()] {
        let inputs = Inputs {
            force_rate: vec![0.0; 2],
            ..blown(30.0)
        };
        let mut whole = stepper.released(&[0.01, 0.02], &[0.0, 0.0]).unwrap();
        let mut halves = whole.clone();
        for _ in 0..50 {
            stepper.advance(&mut whole, &inputs, 0.02).unwrap();
            stepper.advance(&mut halves, &inputs, 0.01).unwrap();
            stepper.advance(&mut halves, &inputs, 0.01).unwrap();
        }
        let off = distance(&whole.values, &halves.values);
        assert!(off < 1e-12, "{off:e}");
    }
}

/// Steps of exactly Δt repeat `z(k+1) = A z(k)` of the corrected equation (B.4).
#[test]
fn the_discrete_model_follows_its_own_recursion() {
    let mut stepper = discrete();
    let CoupledSystem { a, step_s } = stepper.section().at(20.0).unwrap();
    let step_s = step_s.expect("sampled");
    let mut state = stepper.released(&[0.01, 0.02], &[0.0, 0.0]).unwrap();
    let mut z = DVector::from_column_slice(&state.values);
    let inputs = Inputs::steady(20.0, 2);
    for _ in 0..500 {
        stepper.advance(&mut state, &inputs, step_s).unwrap();
        z = &a * z;
        assert!(distance(z.as_slice(), &state.values) < 1e-11);
    }
    // long steps that end between samples see the same samples
    let mut long = stepper.released(&[0.01, 0.02], &[0.0, 0.0]).unwrap();
    stepper.advance(&mut long, &inputs, 499.4 * step_s).unwrap();
    stepper.advance(&mut long, &inputs, 0.6 * step_s).unwrap();
    let off = distance(&state.values, &long.values);
    assert!(off < 1e-10, "{off:e}");
}

#[test]
fn outputs_balance_the_equation_of_motion() {
    for mut stepper in [jones(), discrete()] {
        let s = stepper.section().structure().clone();
        let inputs = blown(30.0);
        let mut state = stepper.released(&[0.01, 0.02], &[0.3, -0.5]).unwrap();
        stepper.advance(&mut state, &inputs, 0.05).unwrap();
        let mut out = Outputs::default();
        stepper.outputs(&state, &inputs, &mut out).unwrap();
        let derivative = stepper.state_derivative(&state, &inputs).unwrap();
        for i in 0..2 {
            let inertia = s.mass[(i, i)] * out.acceleration[i];
            let balance = inertia
                + s.damping[(i, i)] * out.rate[i]
                + s.stiffness[(i, i)] * out.displacement[i]
                - inputs.force[i]
                - out.self_excited_force[i];
            assert!(balance.abs() < 1e-9 * inertia.abs().max(1.0), "{balance:e}");
            assert!(
                (derivative[2 + i] - out.acceleration[i]).abs()
                    < 1e-9 * out.acceleration[i].abs().max(1.0)
            );
        }
    }
}

#[test]
fn refusals_leave_the_state_untouched() {
    let mut stepper = jones();
    let mut state = stepper.released(&[0.01, 0.0], &[0.0, 0.0]).unwrap();
    let before = state.clone();
    let good = Inputs::steady(30.0, 2);
    let mut bad = good.clone();
    bad.force[0] = f64::NAN;
    assert!(stepper.advance(&mut state, &bad, 0.01).is_err());
    assert!(stepper.advance(&mut state, &good, -0.01).is_err());
    assert!(
        stepper
            .advance(&mut state, &Inputs::steady(-1.0, 2), 0.01)
            .is_err()
    );
    assert!(stepper.advance(&mut state, &good, f64::INFINITY).is_err());
    // far above the onset the motion overflows sooner or later: an error, not an infinite number
    let storm = Inputs::steady(90.0, 2);
    assert!(stepper.advance(&mut state, &storm, 1e4).is_err());
    assert_eq!(state, before);
}

/// Ramps of any height in any number of steps, as an importer adds them up: rounding must not refuse the last step.
#[test]
fn a_wind_that_ramps_to_rest_comes_to_rest() {
    let mut below = 0;
    for speed in (1..=49).map(|i| 0.7 * f64::from(i)) {
        for parts in 1..=41 {
            for mut stepper in [jones(), discrete()] {
                let h = 0.002;
                let mut inputs = Inputs::steady(speed, 2);
                inputs.wind_speed_rate_m_s2 = -speed / (h * f64::from(parts));
                let mut state = stepper.released(&[0.01, 0.0], &[0.0, 0.0]).unwrap();
                for _ in 0..parts {
                    stepper.advance(&mut state, &inputs, h).unwrap();
                    inputs.wind_speed_m_s += inputs.wind_speed_rate_m_s2 * h;
                }
                assert!(inputs.wind_speed_m_s.abs() < 1e-12);
                below += u32::from(inputs.wind_speed_m_s < 0.0);
                inputs.wind_speed_rate_m_s2 = 0.0;
                stepper.advance(&mut state, &inputs, h).unwrap();
                let mut outputs = Outputs::default();
                stepper.outputs(&state, &inputs, &mut outputs).unwrap();
            }
        }
    }
    assert!(
        below > 100,
        "rounding ends below zero in {below} cases only"
    );
}

#[test]
fn steps_of_too_many_parts_are_refused_at_once() {
    let at = |stepper: &mut Stepper, inputs: &Inputs, step: f64| {
        let mut state = stepper.released(&[0.01, 0.0], &[0.0, 0.0]).unwrap();
        let message = stepper.advance(&mut state, inputs, step).unwrap_err();
        assert!(
            message.to_string().contains("at most 10000 sub-steps"),
            "{message}"
        );
    };
    for (wind, step) in [(30.0, 1e4), (1e9, 1.0), (1e12, 1e-3)] {
        at(&mut discrete(), &Inputs::steady(wind, 2), step);
    }
    let mut rising = Inputs::steady(10.0, 2);
    rising.wind_speed_rate_m_s2 = 1e-3;
    for (wind, rate, step) in [(10.0, 1e-3, 1e5), (1.0, 1e12, 1.0), (1e200, 1e200, 1.0)] {
        rising.wind_speed_m_s = wind;
        rising.wind_speed_rate_m_s2 = rate;
        at(&mut jones(), &rising, step);
        at(&mut discrete(), &rising, step);
    }
}

/// Winds that no anemometer shows are calm: no division by them, no sample for ages.
#[test]
fn the_lightest_breeze_is_still_air() {
    for wind in [1e-9, 1e-100, 1e-320] {
        for mut stepper in [jones(), discrete()] {
            let mut state = stepper.released(&[0.01, 0.02], &[0.0, 0.0]).unwrap();
            let mut still = state.clone();
            let breeze = Inputs::steady(wind, 2);
            stepper.advance(&mut state, &breeze, 1.0).unwrap();
            stepper
                .advance(&mut still, &Inputs::steady(0.0, 2), 1.0)
                .unwrap();
            // the wind acts in proportion to its speed
            assert!(distance(&still.values, &state.values) < 1e-8);
            let mut outputs = Outputs::default();
            stepper.outputs(&state, &breeze, &mut outputs).unwrap();
            stepper.state_derivative(&state, &breeze).unwrap();
        }
    }
}

/// A decay of hours ends at zero, not among the numbers that are slow to compute with.
#[test]
fn what_has_died_out_is_zero() {
    for (mut stepper, step) in [(jones(), 1.0), (discrete(), 1.0)] {
        // most of the decay is left out
        let release = [1e-246, 1e-246];
        let mut state = stepper.released(&release, &[0.0, 0.0]).unwrap();
        let inputs = Inputs::steady(15.0, 2);
        for _ in 0..600 {
            stepper.advance(&mut state, &inputs, step).unwrap();
            assert!(state.values.iter().all(|x| *x == 0.0 || x.abs() >= 1e-250));
        }
        let largest = state.values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        assert_eq!(largest, 0.0, "{:?}", state.values);
    }
}
