//! The nonlinear run against the linear stepper, against energy, and at the end of the table.

use aerodeck::aerodynamics::GustSeries;
use aerodeck::aerodynamics::Realizable;
use aerodeck::aerodynamics::quasi_steady::Arms;
use aerodeck::aerodynamics::quasi_steady::LinearQuasiSteady;
use aerodeck::aerodynamics::quasi_steady::QuasiSteady;
use aerodeck::aeroelastic::{CoupledSection, StaticEquilibrium, static_equilibria};
use aerodeck::buffeting::{NonlinearSection, largest_difference};
use aerodeck::files::coefficients::embedded;
use aerodeck::response::{Inputs, Stepper};
use aerodeck::section::Structure;
use aerodeck::section::{SectionModel, Translation};

const SPEED: f64 = 14.0;

fn section(lateral: bool) -> Structure {
    let mut section = SectionModel::table_4_1();
    if lateral {
        section.lateral = Some(Translation {
            mass_kg_m: 15.0,
            frequency_hz: Some(1.2),
            stiffness_n_m2: None,
            damping_ratio: 0.004,
        });
    }
    section.structure().unwrap()
}

fn theory(structure: &Structure) -> QuasiSteady {
    let arms = Arms {
        lateral: 0.1,
        vertical: -0.25,
        torsion: 0.2,
    };
    let table = embedded::coefficients("synthetic box girder").unwrap();
    QuasiSteady::new(table, arms, &structure.dofs).unwrap()
}

fn equilibrium(structure: &Structure, theory: &QuasiSteady) -> StaticEquilibrium {
    let path = static_equilibria(structure, theory, &[SPEED]).unwrap();
    path.points[0].clone()
}

/// Gusts of `size` m/s, not in step with anything.
fn gusts(size: f64) -> GustSeries {
    let at = |a: f64, b: f64| {
        (0..=800)
            .map(|i| size * ((a * f64::from(i)).sin() + 0.7 * (b * f64::from(i)).cos() - 0.7))
            .collect()
    };
    GustSeries::new(0.01, at(0.071, 0.23), at(0.123, 0.31)).unwrap()
}

/// The linear stepper under `½ρV² A (u, w)/V`, which runs on straight lines as the gusts do.
fn linear(structure: &Structure, model: &LinearQuasiSteady, gusts: &GustSeries) -> Vec<Vec<f64>> {
    let n = structure.dofs.len();
    let section = CoupledSection::new(structure.clone(), model.realize()).unwrap();
    let mut stepper = Stepper::new(section);
    let mut state = stepper.released(&vec![0.0; n], &vec![0.0; n]).unwrap();
    let force = |i: usize| -> Vec<f64> {
        let (u, w) = (gusts.along_m_s()[i], gusts.vertical_m_s()[i]);
        (0..n)
            .map(|row| {
                let q = model.buffeting[(row, 0)] * u + model.buffeting[(row, 1)] * w;
                let scale = structure.dofs[row].force_scale(structure.width_m);
                0.5 * structure.air_density_kg_m3 * SPEED * scale * q
            })
            .collect()
    };
    let mut rows = vec![state.values.clone()];
    for i in 0..gusts.along_m_s().len() - 1 {
        let (now, next) = (force(i), force(i + 1));
        let rate = now.iter().zip(&next).map(|(a, b)| (b - a) / gusts.step_s());
        let inputs = Inputs {
            force_rate: rate.collect(),
            force: now,
            ..Inputs::steady(SPEED, n)
        };
        stepper
            .advance(&mut state, &inputs, gusts.step_s())
            .unwrap();
        rows.push(state.values.clone());
    }
    rows
}

/// Largest difference between nonlinear run and linear stepper, as a part of the motion about the equilibrium.
fn distance(lateral: bool, size: f64) -> f64 {
    let structure = section(lateral);
    let theory = theory(&structure);
    let rest = equilibrium(&structure, &theory);
    let gusts = gusts(size);
    let n = structure.dofs.len();
    let initial = [rest.displacement.clone(), vec![0.0; n]].concat();
    let nonlinear = NonlinearSection::new(structure.clone(), theory.clone(), SPEED, &gusts);
    let run = nonlinear.unwrap().run(&initial, 0.01, 800, 1e-9).unwrap();
    let about: Vec<Vec<f64>> = run
        .rows
        .iter()
        .map(|row| row.iter().zip(&initial).map(|(a, b)| a - b).collect())
        .collect();
    let model = theory.linearised(rest.rotation_rad).unwrap();
    largest_difference(&linear(&structure, &model, &gusts), &about)
}

#[test]
fn small_motions_are_linear() {
    for lateral in [false, true] {
        let (small, twice) = (distance(lateral, 1e-4), distance(lateral, 2e-4));
        // what is left out is of second order, so it halves with the gusts; 1e-4 m/s of 14 m/s leave below 1e-4
        assert!(small < 1e-4, "{small:e}");
        assert!((twice / small - 2.0).abs() < 0.05, "{small:e} {twice:e}");
    }
}

/// In air of no weight the run is a damped oscillation in closed form.
#[test]
fn weightless_air_leaves_the_structure_alone() {
    let mut structure = section(false);
    structure.air_density_kg_m3 = 1e-14;
    let calm = GustSeries::calm(2.0).unwrap();
    let nonlinear = NonlinearSection::new(structure.clone(), theory(&structure), 10.0, &calm);
    let run = nonlinear
        .unwrap()
        .run(&[1e-6, 1e-6, 0.0, 0.0], 0.02, 100, 1e-9)
        .unwrap();
    let omega = std::f64::consts::TAU * 2.0;
    let (zeta, t) = (0.003_f64, 2.0);
    let damped = omega * (1.0 - zeta * zeta).sqrt();
    let exact = 1e-6
        * (-zeta * omega * t).exp()
        * ((damped * t).cos() + zeta / (1.0 - zeta * zeta).sqrt() * (damped * t).sin());
    // the stated difference between the runs is 1e-9 of the excursion; the air adds 1e-17 m
    assert!(
        (run.rows[100][0] - exact).abs() < 1e-15,
        "{} {exact}",
        run.rows[100][0]
    );
    assert!(run.step_error <= 1e-9);
}

#[test]
fn leaving_the_table_is_said_with_time_and_angle() {
    let structure = section(false);
    let calm = GustSeries::calm(60.0).unwrap();
    let refused = |initial: &[f64], speed: f64, steps: usize| {
        let nonlinear = NonlinearSection::new(structure.clone(), theory(&structure), speed, &calm);
        let run = nonlinear.unwrap().run(initial, 0.01, steps, 1e-6);
        run.unwrap_err().to_string()
    };
    let message = refused(&[0.0, 0.1, 0.0, 0.0], 120.0, 6000);
    assert!(
        message.starts_with("t = ") && message.contains("an angle of attack from -16 to 16 deg"),
        "{message}"
    );
    let message = refused(&[0.0; 4], 10.0, 6001);
    assert!(message.contains("at least 60.01 s of them"), "{message}");
}
