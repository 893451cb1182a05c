//! Steps while the wind changes: the Taylor series against the matrix exponential, against an independent integration,
//! and against itself in other steps.

use crate::steppers::{blown, discrete, distance, jones, runge_kutta};
use aerodeck::aerodynamics::{Realizable, Realization};
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::response::{Inputs, SectionState, Stepper};
use aerodeck::section::SectionModel;
use aerodeck::trained_model::TrainedModel;

/// Eight filters, twelve states.
fn filters() -> Stepper {
    let file = format!(
        "{}/tests/data/models/continuous_laguerre.json",
        env!("CARGO_MANIFEST_DIR")
    );
    let model = TrainedModel::from_json(&std::fs::read_to_string(file).unwrap()).unwrap();
    let structure = model.section.structure().unwrap();
    Stepper::new(CoupledSection::new(structure, model.model.realize()).unwrap())
}

/// The same forces on a deck of 31 m, and on a section whose axis and mass lie beside the middle.
fn others() -> [Stepper; 2] {
    let aerodynamics = jones().section().aerodynamics().clone();
    let mut offset = SectionModel::table_4_1();
    (offset.axis_offset_m, offset.mass_offset_m) = (Some(0.05), Some(-0.03));
    [SectionModel::iabse_1_1a(), offset].map(|section| {
        let structure = section.structure().unwrap();
        Stepper::new(CoupledSection::new(structure, aerodynamics.clone()).unwrap())
    })
}

fn ramp(speed: f64, rate: f64) -> Inputs {
    Inputs {
        wind_speed_rate_m_s2: rate,
        ..blown(speed)
    }
}

/// Inputs after `time` seconds.
fn later(inputs: &Inputs, time: f64) -> Inputs {
    let mut later = inputs.clone();
    later.wind_speed_m_s += inputs.wind_speed_rate_m_s2 * time;
    for (w, rate) in later.force.iter_mut().zip(&inputs.force_rate) {
        *w += rate * time;
    }
    later
}

/// A new wind that is held: what the matrix exponential gives, to rounding.
#[test]
fn a_step_without_matrix_is_the_step_with_it() {
    let steppers = [jones(), filters()].into_iter().chain(others());
    for mut stepper in steppers {
        for speed in [0.0, 0.3, 8.0, 35.0, 90.0] {
            for step in [1e-4, 0.003, 0.02, 0.1, 0.4] {
                for inputs in [Inputs::steady(speed, 2), blown(speed)] {
                    let mut by_matrix = stepper.released(&[0.01, 0.02], &[0.1, -0.2]).unwrap();
                    let mut by_series = SectionState {
                        last_wind_m_s: Some(speed + 1.0),
                        ..by_matrix.clone()
                    };
                    stepper.advance(&mut by_matrix, &inputs, step).unwrap();
                    stepper.advance(&mut by_series, &inputs, step).unwrap();
                    assert_eq!(by_matrix.last_wind_m_s, by_series.last_wind_m_s);
                    let off = distance(&by_matrix.values, &by_series.values);
                    // some ten roundings of either
                    assert!(off < 1e-14, "{speed} m/s, {step} s: {off:e}");
                }
            }
        }
    }
}

#[test]
fn ramps_are_the_solution_of_the_differential_equation() {
    for mut stepper in [jones(), filters()] {
        let start = stepper.released(&[0.01, 0.02], &[0.1, 0.0]).unwrap();
        for inputs in [ramp(25.0, 20.0), ramp(6.0, -20.0), ramp(0.0, 300.0)] {
            let mut state = start.clone();
            stepper.advance(&mut state, &inputs, 0.3).unwrap();
            let reference = runge_kutta(&stepper, &start, &inputs, 0.3, 8000);
            let off = distance(&reference, &state.values);
            // the reference's own error, (ωτ)⁴, in the fastest of these winds
            assert!(off < 1e-10, "{inputs:?}: {off:e}");
        }
    }
}

/// No error of the scheme is left that a shorter step would show; the force of the sampled model follows the wind
/// wherever communication points fall.
#[test]
fn ramps_do_not_depend_on_the_communication_step() {
    for mut stepper in [jones(), filters(), discrete()] {
        for inputs in [ramp(25.0, 20.0), ramp(12.0, -20.0), ramp(0.0, 8.0)] {
            let mut whole = stepper.released(&[0.01, 0.02], &[0.1, 0.0]).unwrap();
            let mut pieces = whole.clone();
            stepper.advance(&mut whole, &inputs, 0.5).unwrap();
            for part in 0..50 {
                let now = later(&inputs, 0.01 * f64::from(part));
                stepper.advance(&mut pieces, &now, 0.01).unwrap();
            }
            let off = distance(&whole.values, &pieces.values);
            assert!(off < 1e-12, "{inputs:?}: {off:e}");
            assert!((whole.phase - pieces.phase).abs() < 1e-9);
        }
    }
}

/// Between its samples the sampled model is a differential equation too: integrated from one to the next.
#[test]
fn ramps_of_the_sampled_model_are_those_of_its_own_equation() {
    let mut stepper = discrete();
    let inputs = ramp(10.0, 15.0);
    let Realization::Discrete(model) = stepper.section().aerodynamics().clone() else {
        panic!("not sampled");
    };
    let width = stepper.section().structure().width_m;
    let way = model.delta_s * width;
    let mut state = stepper.released(&[0.01, 0.02], &[0.1, 0.0]).unwrap();
    let mut expected = state.clone();
    // the wind has covered `k` ways after t with V t + V' t²/2 = k way
    let time = |k: f64| {
        let (v, rate) = (inputs.wind_speed_m_s, inputs.wind_speed_rate_m_s2);
        ((v * v + 2.0 * rate * k * way).sqrt() - v) / rate
    };
    for k in 0..40 {
        let (from, to) = (time(f64::from(k)), time(f64::from(k + 1)));
        let now = later(&inputs, from);
        expected.values = runge_kutta(&stepper, &expected, &now, to - from, 50);
        let (motion, filters) = expected.values.split_at_mut(4);
        let motion = nalgebra::DVector::from_vec(vec![motion[0] / width, motion[1]]);
        let before = nalgebra::DVector::from_column_slice(filters);
        let after = &model.a * before + &model.b * motion;
        filters.copy_from_slice(after.as_slice());
    }
    stepper
        .advance(&mut state, &inputs, time(40.0) + 1e-9)
        .unwrap();
    let off = distance(&expected.values, &state.values);
    // the nanosecond moves the section by 1e-9 of its rates
    assert!(off < 2e-8, "{off:e}");
}

/// A step is a function of state and inputs alone: whatever else was stepped before.
#[test]
fn a_replay_gives_the_same_bits() {
    for mut stepper in [jones(), filters(), discrete()] {
        let mut state = stepper.released(&[0.01, 0.02], &[0.0, 0.0]).unwrap();
        let winds: Vec<f64> = (0..60).map(|i| 30.0 + f64::from(i % 7 / 3)).collect();
        let mut saved = Vec::new();
        for wind in &winds {
            saved.push(state.clone());
            stepper
                .advance(&mut state, &Inputs::steady(*wind, 2), 0.01)
                .unwrap();
        }
        let mut fresh = Stepper::new(stepper.section().clone());
        for (i, wind) in winds.iter().enumerate().rev() {
            let mut again = saved[i].clone();
            fresh
                .advance(&mut again, &Inputs::steady(*wind, 2), 0.01)
                .unwrap();
            assert_eq!(again, *saved.get(i + 1).unwrap_or(&state));
        }
    }
}

/// A wind that jumps to the absurd, a step of hours: the matrix where a series would be long, or a refusal.
#[test]
fn long_steps_in_a_new_wind_take_the_matrix() {
    let mut stepper = filters();
    let mut state = stepper.released(&[0.01, 0.0], &[0.0, 0.0]).unwrap();
    state.last_wind_m_s = Some(10.0);
    stepper
        .advance(&mut state, &Inputs::steady(11.0, 2), 600.0)
        .unwrap();
    let before = state.clone();
    for (wind, step) in [(1e9, 1e4), (1e200, 1.0), (90.0, 1e300)] {
        let absurd = Inputs::steady(wind, 2);
        assert!(stepper.advance(&mut state, &absurd, step).is_err());
        assert_eq!(state, before);
    }
}
