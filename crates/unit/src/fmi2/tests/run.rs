//! Runs: the unit moves as the stepper in this process does, to the last bit.

use super::*;
use crate::aerodynamics::{Realizable, Transfer};
use crate::aeroelastic::CoupledSection;
use crate::flutter::{OnsetSearch, divergence_speed, find_onset};
use crate::response::{Inputs, Outputs, Stepper};
use crate::units::ReducedFrequency;

/// Stepper and outputs in this process, in the order of the table.
struct InProcess {
    stepper: Stepper,
    state: crate::response::SectionState,
    inputs: Inputs,
}

impl InProcess {
    fn new(model: &TrainedModel) -> Self {
        let structure = model.section.structure().unwrap();
        let n = structure.dofs.len();
        let section = CoupledSection::new(structure, model.model.realize()).unwrap();
        let stepper = Stepper::new(section);
        let mut displacement = vec![0.0; n];
        displacement[0] = model.experiment.initial_vertical_m;
        displacement[n - 1] = model.experiment.initial_rotation_rad;
        Self {
            state: stepper.released(&displacement, &vec![0.0; n]).unwrap(),
            inputs: Inputs::steady(model.experiment.wind_speed_m_s, n),
            stepper,
        }
    }

    fn outputs(&mut self) -> Vec<f64> {
        let mut o = Outputs::default();
        self.stepper
            .outputs(&self.state, &self.inputs, &mut o)
            .unwrap();
        (0..o.rate.len())
            .flat_map(|i| {
                [
                    o.displacement[i],
                    o.rate[i],
                    o.acceleration[i],
                    o.self_excited_force[i],
                ]
            })
            .collect()
    }

    fn step(&mut self, h: f64) {
        self.stepper
            .advance(&mut self.state, &self.inputs, h)
            .unwrap();
        let i = &mut self.inputs;
        i.wind_speed_m_s += i.wind_speed_rate_m_s2 * h;
        for (w, rate) in i.force.iter_mut().zip(&i.force_rate) {
            *w += rate * h;
        }
    }
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|x| x.to_bits()).collect()
}

/// Steps of several sizes with forces, a gust and ramps, outputs compared after every step.
pub(super) fn compare(archive: Extracted) {
    let unit = StartedUnit::instantiate(archive);
    let mut process = InProcess::new(unit.archive.model());
    unit.start();
    let mut time = 0.0;
    for i in 0..200 {
        let h = [0.01, 0.01, 0.003, 0.25, 0.0007][i % 5];
        match i {
            20 => {
                unit.set("external_lift", 3.0);
                process.inputs.force[0] = 3.0;
            }
            40 => {
                unit.set("wind_speed", 30.0);
                process.inputs.wind_speed_m_s = 30.0;
            }
            60 => {
                unit.set_rate("external_moment", 0.2);
                *process.inputs.force_rate.last_mut().unwrap() = 0.2;
            }
            80 => {
                unit.set_rate("wind_speed", 1.5);
                process.inputs.wind_speed_rate_m_s2 = 1.5;
            }
            100 => {
                unit.set_rate("wind_speed", 0.0);
                process.inputs.wind_speed_rate_m_s2 = 0.0;
            }
            _ => {}
        }
        unit.ok(unit.step(time, h));
        process.step(h);
        time += h;
        assert_eq!(bits(&unit.outputs()), bits(&process.outputs()), "step {i}");
    }
    assert!(unit.outputs().iter().all(|x| x.is_finite() && *x != 0.0));
    unit.ok(unsafe { fmi2Terminate(unit.handle) });
    unit.outputs();
}

#[test]
fn every_kind_moves_as_in_process() {
    for kind in ["continuous_laguerre", "rational", "discrete_laguerre"] {
        compare(Extracted::fixture(kind));
    }
}

/// Lags of each force and the minimum-state form: instance and coupling follow from the model, the number of states too.
#[test]
fn newer_rational_forms_move_as_in_process() {
    use crate::aerodynamics::{Lags, MinimumStateModel};
    use crate::trained_model::Model;
    let mut trained = Extracted::fixture("rational").resources.model;
    let Model::Rational(roger) = trained.model.clone() else {
        panic!("the fixture is rational");
    };
    let mut own = roger.clone();
    own.lags = Lags::PerForce(vec![vec![0.08, 0.7], vec![0.1, 0.5]]);
    let row = |l: usize| roger.lag_terms[l].row(0).into_owned();
    let small = MinimumStateModel {
        dofs: roger.dofs.clone(),
        a1: roger.a1.clone(),
        a2: roger.a2.clone(),
        a3: roger.a3.clone(),
        lags: vec![0.091, 0.6],
        d: nalgebra::DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 0.25, 0.25]),
        e: nalgebra::DMatrix::from_rows(&[row(0), row(1)]),
    };
    for (model, states) in [(Model::Rational(own), 4), (Model::MinimumState(small), 2)] {
        trained.schema_version = model.schema_version();
        trained.model = model;
        let archive = Extracted::new(&trained.to_json().unwrap());
        let variable = archive.resources.table.find_name("filters").unwrap();
        let value = &archive.resources.table.variables()[variable].value;
        assert_eq!(*value, crate::variables::StartValue::Integer(Some(states)));
        compare(archive);
    }
}

/// Its lateral support is stated as a stiffness, which the unit keeps to the last bit.
/// One transfer function with slower filters of its own: two states more than the shared ones.
#[test]
fn filters_of_one_transfer_function_move_as_in_process() {
    use crate::aerodynamics::laguerre::DiscreteTerm;
    use crate::trained_model::Model;
    let mut model = Extracted::fixture("discrete_laguerre").resources.model;
    let Model::DiscreteLaguerre(discrete) = &mut model.model else {
        panic!("not discrete");
    };
    discrete.terms[0].coefficients.row_mut(1).fill(0.0);
    discrete.terms.push(DiscreteTerm {
        input: 0,
        alpha: 0.8,
        coefficients: nalgebra::DMatrix::from_row_slice(2, 2, &[0.0, 0.0, -0.9, -0.6]),
    });
    model.schema_version = model.model.schema_version();
    let states = model.model.realize().states();
    assert_eq!(states, 8);
    compare(Extracted::new(&model.to_json().unwrap()));
}

#[test]
fn three_degrees_of_freedom_move_as_in_process() {
    let mut archive = Extracted::three_dof();
    let unit = StartedUnit::instantiate(Extracted::three_dof());
    let [frequency] = unit.get(["sway_frequency"]);
    assert!((frequency - (2000.0_f64 / 15.0).sqrt() / std::f64::consts::TAU).abs() < 1e-15);
    // a lateral motion to compare needs a start; the force of the run gives it
    archive.resources.model.experiment.initial_rotation_rad = 0.02;
    let archive = Extracted::new(&archive.resources.model.to_json().unwrap());
    let unit = StartedUnit::instantiate(archive);
    let mut process = InProcess::new(unit.archive.model());
    unit.start();
    unit.set("external_drag", 4.0);
    process.inputs.force[1] = 4.0;
    for i in 0..100 {
        unit.ok(unit.step(0.01 * f64::from(i), 0.01));
        process.step(0.01);
        assert_eq!(bits(&unit.outputs()), bits(&process.outputs()));
    }
    assert!(unit.get(["sway"])[0] > 1e-4);
}

#[test]
fn initialisation_reads_and_writes() {
    let unit = StartedUnit::new("rational");
    unit.set("initial_heave", 0.02); // start values are set while instantiated …
    unit.set("wind_speed", 20.0);
    unit.ok(unit.set_up());
    unit.ok(unit.enter());
    assert_eq!(unit.get(["heave", "wind_speed"]), [0.02, 20.0]);
    unit.set("initial_heave", 0.03); // … and while initialising
    unit.set("mass", 30.0);
    let [heave, still] = unit.get(["heave", "heave_acceleration"]);
    unit.set("external_lift", 30.0);
    let [pushed] = unit.get(["heave_acceleration"]);
    // m plus the air's ρπB²/4
    let mass = 30.0 + 1.19 * std::f64::consts::PI * 0.25 / 4.0;
    assert_eq!(heave, 0.03);
    assert!((pushed - still - 30.0 / mass).abs() < 1e-12);
    unit.ok(unit.exit());
    assert_eq!(unit.get(["heave", "heave_acceleration"]), [0.03, pushed]);
}

/// `max |heave|` over a second decays below the onset and grows above it.
#[test]
fn tunable_parameters_act_between_steps() {
    let unit = StartedUnit::started("rational");
    unit.ok(unit.step(0.0, 0.5));
    let before = unit.outputs();
    unit.set("torsion_frequency", 4.0);
    let after = unit.outputs();
    assert_eq!(before[0], after[0]);
    assert_ne!(before[6], after[6]); // the torsional acceleration feels the softer spring at once
    unit.ok(unit.step(0.5, 0.5));
    let [speed] = unit.get(["onset_speed"]);
    unit.set("torsion_frequency", 5.0);
    let [stiffer] = unit.get(["onset_speed"]);
    assert!(speed < stiffer - 5.0, "{speed} {stiffer}");
}

#[test]
fn calculated_parameters_are_those_of_the_searches() {
    let unit = StartedUnit::new("rational");
    let model = unit.archive.model().clone();
    let section =
        CoupledSection::new(model.section.structure().unwrap(), model.model.realize()).unwrap();
    let search = OnsetSearch {
        speed_max_m_s: 100.0,
        ..OnsetSearch::default()
    };
    let found = find_onset("", &section, &search, Some(model.tested_range)).unwrap();
    let onset = found.onset().unwrap();
    let steady = model.model.transfer(ReducedFrequency::from_full_width(0.0));
    let divergence = divergence_speed(section.structure(), &steady.unwrap())
        .unwrap()
        .unwrap();
    unit.ok(unit.set_up());
    unit.ok(unit.enter());
    let found = unit.get([
        "onset_speed",
        "onset_frequency",
        "onset_reduced_velocity",
        "divergence_speed",
    ]);
    let searched = [
        onset.at.speed_m_s,
        onset.at.frequency_hz,
        onset.at.reduced_velocity.v_star(),
        divergence,
    ];
    for (found, searched) in found.into_iter().zip(searched) {
        // an onset that is plain is found by the sweep, the search halves to some 1e-11
        assert!((found / searched - 1.0).abs() < 1e-9, "{found} {searched}");
    }
    assert!(unit.flag("onset_found") && unit.flag("divergence_found"));
    assert_eq!(
        unit.flag("onset_in_tested_range"),
        onset.in_tested_range.unwrap()
    );
    unit.set("onset_search_limit", 20.0);
    assert_eq!(
        unit.get(["onset_speed", "onset_frequency", "divergence_speed"]),
        [20.0, 0.0, 20.0]
    );
    assert!(!unit.flag("onset_found") && !unit.flag("divergence_found"));
    assert!(!unit.flag("onset_in_tested_range"));
}

/// The onset of the flat plate (39.468 m/s) is met by the growth of the stepped motion.
#[test]
fn growth_changes_sign_at_the_calculated_onset() {
    let unit = StartedUnit::new("continuous_laguerre");
    unit.ok(unit.set_up());
    unit.ok(unit.enter());
    let [onset] = unit.get(["onset_speed"]);
    // the plain least-squares fit of the fixture is 0.2 % off the exact 39.468
    assert!((onset - 39.468).abs() < 0.1, "{onset}");
    let growth = |speed: f64| {
        unit.ok(unit.reset());
        unit.set("wind_speed", speed);
        unit.start();
        let mut peaks = [0.0_f64; 2];
        for i in 0..2000 {
            unit.ok(unit.step(0.01 * f64::from(i), 0.01));
            let half = usize::from(i >= 1000);
            peaks[half] = peaks[half].max(unit.get(["rotation"])[0].abs());
        }
        // the first second of each half is not compared: the release excites both modes
        peaks[1] / peaks[0]
    };
    assert!(growth(onset * 0.98) < 1.0);
    assert!(growth(onset * 1.02) > 1.0);
}

#[test]
fn integers_texts_and_empty_lists() {
    let unit = StartedUnit::started("discrete_laguerre");
    let vr = unit.references(&["filters"]);
    let mut filters = 0;
    unit.ok(unsafe { fmi2GetInteger(unit.handle, vr.as_ptr(), 1, &raw mut filters) });
    assert_eq!(filters, 6);
    let vr = unit.references(&["model_kind", "aerodeck_version"]);
    let mut texts = [std::ptr::null(); 2];
    unit.ok(unsafe { fmi2GetString(unit.handle, vr.as_ptr(), 2, texts.as_mut_ptr()) });
    let text = |i: usize| unsafe { CStr::from_ptr(texts[i]) }.to_str().unwrap();
    assert_eq!(text(0), "discrete Laguerre");
    assert_eq!(text(1), env!("CARGO_PKG_VERSION"));
    let c = unit.handle;
    for status in unsafe {
        [
            fmi2GetReal(c, null(), 0, null()),
            fmi2SetReal(c, null(), 0, null()),
            fmi2GetInteger(c, null(), 0, null()),
            fmi2SetInteger(c, null(), 0, null()),
            fmi2GetBoolean(c, null(), 0, null()),
            fmi2SetBoolean(c, null(), 0, null()),
            fmi2GetString(c, null(), 0, null()),
            fmi2SetString(c, null(), 0, null()),
            fmi2SetRealInputDerivatives(c, null(), 0, null(), null()),
            fmi2GetRealOutputDerivatives(c, null(), 0, null(), null()),
            fmi2GetDirectionalDerivative(c, null(), 0, null(), 0, null(), null()),
        ]
    } {
        unit.ok(status);
    }
}

#[test]
fn instances_live_side_by_side_and_in_threads() {
    let alone = StartedUnit::started("rational");
    let run = |unit: &StartedUnit| {
        for i in 0..100 {
            unit.ok(unit.step(0.02 * f64::from(i), 0.02));
        }
        bits(&unit.outputs())
    };
    let expected = run(&alone);
    let (first, second) = (
        StartedUnit::started("rational"),
        StartedUnit::started("rational"),
    );
    second.set("wind_speed", 10.0);
    for i in 0..100 {
        first.ok(first.step(0.02 * f64::from(i), 0.02));
        second.ok(second.step(0.02 * f64::from(i), 0.02));
    }
    assert_eq!(bits(&first.outputs()), expected);
    assert_ne!(bits(&second.outputs()), expected);
    std::thread::scope(|scope| {
        let runs: Vec<_> = (0..4)
            .map(|_| scope.spawn(|| run(&StartedUnit::started("rational"))))
            .collect();
        for thread in runs {
            assert_eq!(thread.join().unwrap(), expected);
        }
    });
}

/// FMPy and others sum their steps: the clock is theirs. At all times sums and products of steps are one clock; a point a step away
/// is another, and a step behind the stop time is too late.
#[test]
fn a_clock_is_off_by_roundings_alone() {
    let (count, step) = (2000, 0.0125);
    for start in [0.0, 1e7, 1.76e9] {
        for sum in [false, true] {
            for (ahead, words) in [
                (0.0, "stop time"),
                (-step, "communication point"),
                (0.48, "communication point"),
            ] {
                let unit = StartedUnit::new("rational");
                let stop = start + f64::from(count) * step;
                unit.ok(unsafe { fmi2SetupExperiment(unit.handle, 0, 0.0, start, 1, stop) });
                unit.ok(unit.enter());
                unit.ok(unit.exit());
                let mut time = start;
                for i in 1..=count {
                    unit.ok(unit.step(time, step));
                    let product = start + f64::from(i) * step;
                    time = if sum { time + step } else { product };
                }
                unit.refused(
                    unit.step(time + ahead, step),
                    fmi2Status::fmi2Error,
                    &[words],
                );
            }
        }
    }
}

/// One step of h is two of h/2: steps are exact.
#[test]
fn steps_are_exact() {
    let (one, two) = (
        StartedUnit::started("rational"),
        StartedUnit::started("rational"),
    );
    for unit in [&one, &two] {
        unit.set("external_lift", 5.0);
        unit.set_rate("external_lift", -2.0);
    }
    for i in 0..50 {
        let time = 0.2 * f64::from(i);
        one.ok(one.step(time, 0.2));
        two.ok(two.step(time, 0.1));
        two.ok(two.step(time + 0.1, 0.1));
    }
    for (a, b) in one.outputs().iter().zip(two.outputs()) {
        assert!((a - b).abs() <= 1e-12 * a.abs().max(1.0), "{a} {b}");
    }
}
