//! What must not end a run: legal parameters without an onset, winds that come to rest, missing calls, and the end of
//! the range of numbers.

use super::*;
use fmi2Status::{fmi2Discard, fmi2OK};

/// Everything that is calculated from the parameters, with the log switched on.
fn calculated(unit: &StartedUnit) -> ([f64; 4], [bool; 3]) {
    unit.ok(unsafe { fmi2SetDebugLogging(unit.handle, 1, 0, null()) });
    let numbers = unit.get([
        "onset_speed",
        "onset_frequency",
        "onset_reduced_velocity",
        "divergence_speed",
    ]);
    let flags = ["onset_found", "onset_in_tested_range", "divergence_found"];
    (numbers, flags.map(|name| unit.flag(name)))
}

fn warned(unit: &StartedUnit, words: &str) -> bool {
    let messages = unit.messages.lock().unwrap();
    let is = |m: &&(String, fmi2Status, String, String)| {
        m.1 == fmi2Status::fmi2Warning && m.2 == "logStatusWarning" && m.3.contains(words)
    };
    messages.iter().find(is).is_some()
}

/// Every getter answers for every legal parameter, in every kind.
#[test]
fn legal_parameters_do_not_make_a_getter_fail() {
    let cases: [&[(&str, f64)]; 7] = [
        &[("heave_frequency", 0.0)],
        &[("torsion_frequency", 0.0)],
        &[("heave_frequency", 0.0), ("torsion_frequency", 0.0)],
        &[("heave_damping_ratio", 1.2)],
        &[("torsion_damping_ratio", 1.2)],
        &[("torsion_frequency", 2.0)],
        &[("inertia", 1e-9), ("mass", 1e-6)],
    ];
    for kind in ["continuous_laguerre", "rational", "discrete_laguerre"] {
        for parameters in cases {
            let unit = StartedUnit::new(kind);
            unit.ok(unit.set_up());
            unit.ok(unit.enter());
            for (name, value) in parameters {
                unit.set(name, *value);
            }
            let [limit] = unit.get(["onset_search_limit"]);
            let ([onset, frequency, reduced, divergence], [found, tested, diverges]) =
                calculated(&unit);
            assert!(onset <= limit && divergence <= limit, "{kind}");
            if !found {
                // the limit, or less where less was judged; nothing where nothing is known
                assert!(onset >= 0.0, "{kind}");
                assert_eq!((frequency, reduced, tested), (0.0, 0.0, false));
            }
            if !diverges {
                assert!(divergence == limit || divergence == 0.0, "{kind}");
            }
        }
    }
}

/// No stiffness: onset and divergence are not known. Their speeds are zero, never the limit, which would read as safe, and the log says why. A free
/// motion can still be stepped.
#[test]
fn what_cannot_be_searched_for_is_zero_with_a_warning() {
    let unit = StartedUnit::new("rational");
    unit.ok(unit.set_up());
    unit.ok(unit.enter());
    unit.set("torsion_frequency", 0.0);
    assert_eq!(calculated(&unit), ([0.0; 4], [false; 3]));
    assert!(warned(
        &unit,
        "flutter onset and divergence are not known for these parameters"
    ));
    unit.ok(unit.exit());
    unit.ok(unit.step(0.0, 0.01));
}

/// A ramp to rest by input derivatives, a gust series around zero; a wind that blows backwards is refused as before.
#[test]
fn a_wind_that_rounding_takes_below_zero_is_at_rest() {
    for kind in ["continuous_laguerre", "rational", "discrete_laguerre"] {
        for (wind, parts) in [(7.0, 10), (0.3, 3), (12.7, 49), (25.0, 7)] {
            let unit = StartedUnit::started(kind);
            unit.set("wind_speed", wind);
            let step = 0.1;
            unit.set_rate("wind_speed", -wind / (step * f64::from(parts)));
            for i in 0..parts {
                unit.ok(unit.step(step * f64::from(i), step));
            }
            let [left] = unit.get(["wind_speed"]);
            assert!(
                (0.0..1e-12).contains(&left),
                "{kind} {wind} {parts}: {left}"
            );
            unit.set_rate("wind_speed", 0.0);
            unit.ok(unit.step(step * f64::from(parts), step));
        }
        let unit = StartedUnit::started(kind);
        unit.set("wind_speed", -1e-16);
        assert_eq!(unit.get(["wind_speed"]), [0.0]);
        unit.ok(unit.step(0.0, 0.1));
        let status = unit.try_set(&["wind_speed"], &[-0.01]);
        unit.refused(status, fmi2Discard, &["wind_speed", "minimum 0"]);
        // the lightest breeze there is
        unit.set("wind_speed", 1e-100);
        unit.outputs();
        unit.ok(unit.step(0.1, 0.1));
        unit.outputs();
    }
}

/// A step that would never end is discarded at once.
#[test]
fn endless_steps_are_discarded_within_ten_milliseconds() {
    // the fastest of five: other work on the machine does not count
    let discarded = |kind: &str, (name, value): (&str, f64), rate: f64, step: f64| {
        let spent = (0..5).map(|_| {
            // before the start, where changed parameters are looked at
            let unit = StartedUnit::new(kind);
            unit.set(name, value);
            unit.start();
            unit.set_rate("wind_speed", rate);
            let begin = std::time::Instant::now();
            let status = unit.step(0.0, step);
            let spent = begin.elapsed();
            unit.refused(status, fmi2Discard, &["sub-steps"]);
            spent
        });
        let spent = spent.min().unwrap();
        assert!(spent.as_millis() < 10, "{kind} {name} {value}: {spent:?}");
    };
    let discrete = "discrete_laguerre";
    for (wind, step) in [(20.0, 1e4), (1e9, 0.1), (1e12, 0.1), (1e150, 0.1)] {
        discarded(discrete, ("wind_speed", wind), 0.0, step);
    }
    discarded(discrete, ("width", 1e-6), 0.0, 10.0);
    discarded("rational", ("wind_speed", 20.0), 1e-3, 1e5);
    // one exponential, but of a matrix without a right digit
    let unit = StartedUnit::started("rational");
    let status = unit.step(0.0, 1e40);
    unit.refused(status, fmi2Discard, &["no digit would be right"]);
}

/// Far above the onset every number that is handed out is one, to the end.
#[test]
fn no_output_is_ever_infinite() {
    let unit = StartedUnit::started("rational");
    unit.set("wind_speed", 90.0);
    let names = ["heave", "heave_acceleration", "lift", "rotation", "moment"];
    let mut time = 0.0;
    let mut discarded = false;
    while unit.step(time, 0.01) == fmi2OK {
        time += 0.01;
        let mut values = [f64::NAN; 5];
        match unit.try_get(&names, &mut values) {
            fmi2OK => assert!(values.iter().all(|x| x.is_finite()), "{time}: {values:?}"),
            status => {
                unit.refused(status, fmi2Discard, &["overflowed"]);
                discarded = true;
            }
        }
        assert!(time < 3600.0);
    }
    assert!(
        discarded,
        "accelerations outgrow numbers before the motion does"
    );
}

/// Some importers never set up the experiment.
#[test]
fn an_experiment_that_is_not_set_up_starts_at_zero() {
    let unit = StartedUnit::new("rational");
    unit.ok(unsafe { fmi2SetDebugLogging(unit.handle, 1, 0, null()) });
    unit.ok(unit.enter());
    assert!(warned(&unit, "has not been set up"));
    unit.ok(unit.exit());
    unit.ok(unit.step(0.0, 0.1));
}

/// The continuous fixture with so many filters of heave, nearly all of which do nothing.
fn many_filters(count: usize) -> TrainedModel {
    let mut model = Extracted::fixture("continuous_laguerre").resources.model;
    let Model::Laguerre(filters) = &mut model.model else {
        panic!("the fixture has filters");
    };
    let term = &mut filters.terms[0];
    term.poles = crate::aerodynamics::FilterBank::laguerre(0.3, count).unwrap();
    term.coefficients = nalgebra::DMatrix::from_element(2, count, 1e-9);
    model
}

/// More states than any memory holds: refused before a matrix is made.
#[test]
fn models_of_too_many_states_are_refused() {
    let json = serde_json::to_string(&many_filters(100_000)).unwrap();
    let message = TrainedModel::from_json(&json).unwrap_err().to_string();
    assert!(message.contains("at most 1000 states"), "{message}");
}

/// Eigenvalues by the thousand would take minutes: where the onset is not plain, nothing is searched.
#[test]
fn sections_of_many_states_are_not_searched() {
    let mut model = many_filters(300);
    model.experiment.onset_search_limit_m_s = 5.0;
    let unit = StartedUnit::instantiate(Extracted::new(&model.to_json().unwrap()));
    unit.ok(unsafe { fmi2SetDebugLogging(unit.handle, 1, 0, null()) });
    unit.ok(unit.set_up());
    unit.ok(unit.enter());
    let [speed, margin, wind] = unit.get(["onset_speed", "flutter_margin", "wind_speed"]);
    assert_eq!((speed, margin), (0.0, -wind));
    assert!(!unit.flag("onset_found") && !unit.flag("stable_below_onset"));
    assert!(warned(&unit, "at most 100 states"));
    unit.ok(unit.exit());
    unit.ok(unit.step(0.0, 0.01));
}
