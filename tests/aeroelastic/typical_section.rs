//! A section that turns about another axis than mid-chord, with its centre of mass elsewhere: two descriptions of one
//! body, Theodorsen's forces about the axis in closed form, every route on one force model.

use crate::matrix;
use aerodeck::aerodynamics::flat_plate::theodorsen;
use aerodeck::aerodynamics::quasi_steady::Arms;
use aerodeck::aerodynamics::quasi_steady::QuasiSteady;
use aerodeck::aerodynamics::{FlatPlate, GustSeries, RationalModel, Realizable, Transfer};
use aerodeck::aeroelastic::{CoupledSection, static_equilibria};
use aerodeck::buffeting::NonlinearSection;
use aerodeck::files::coefficients::embedded;
use aerodeck::flutter::{
    OnsetSearch, determinant_onset, divergence_by_eigenvalues, divergence_speed, find_onset,
    impedance, pk_onset,
};
use aerodeck::response::{Inputs, Stepper};
use aerodeck::section::{Dof, SectionModel, Structure};
use aerodeck::trained_model::TrainedModel;
use aerodeck::units::{ReducedFrequency, ReducedFrequencyRange};
use nalgebra::{Complex, DMatrix};
use std::f64::consts::PI;

/// Axis and centre of mass of the tests as parts of the width, both sides.
const OFFSETS: [(f64, f64); 5] = [
    (0.1, 0.06),
    (-0.1, 0.04),
    (0.1, 0.0),
    (-0.08, -0.06),
    (-0.1, 0.25),
];

fn unbalanced(mut section: SectionModel, [axis, mass]: [f64; 2]) -> SectionModel {
    section.axis_offset_m = Some(axis * section.width_m);
    section.mass_offset_m = Some(mass * section.width_m);
    section
}

/// `[1 a; 0 1]` over (y, θ): motion of mid-chord by motion of the axis; sway is not concerned.
fn to_mid_chord(s: &Structure, sign: f64) -> DMatrix<f64> {
    let n = s.dofs.len();
    let mut t = DMatrix::identity(n, n);
    t[(0, n - 1)] = sign * s.axis_offset_m;
    t
}

/// The same body described by the motion of its mid-chord: full matrices, forces where the models have them.
fn by_mid_chord(s: &Structure) -> Structure {
    let back = to_mid_chord(s, -1.0);
    let congruent = |m: &DMatrix<f64>| back.transpose() * m * &back;
    Structure {
        axis_offset_m: 0.0,
        mass: congruent(&s.mass),
        damping: congruent(&s.damping),
        stiffness: congruent(&s.stiffness),
        ..s.clone()
    }
}

fn fixture(kind: &str) -> TrainedModel {
    let path = format!(
        "{}/tests/data/models/{kind}.json",
        env!("CARGO_MANIFEST_DIR")
    );
    TrainedModel::from_json(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Textbook forces about an axis `a b` aft of mid-chord, `h` and lift down turned up (Fung, section 6.7).
fn theodorsen_about(
    a: f64,
    b: f64,
    density: f64,
    speed: f64,
    omega: f64,
) -> [[Complex<f64>; 2]; 2] {
    let (c, s) = (theodorsen(omega * b / speed), Complex::new(0.0, omega));
    let (apparent, circulatory) = (PI * density * b * b, c * (2.0 * PI * density * speed * b));
    let downwash = s * (b * (0.5 - a)) + speed;
    let lift_by_h = s * s * apparent + circulatory * s;
    let lift_by_rotation = (s * speed - s * s * (b * a)) * apparent + circulatory * downwash;
    let moment_by_h = s * s * (apparent * b * a) + circulatory * s * (b * (a + 0.5));
    let moment_by_rotation = -(s * (speed * b * (0.5 - a)) + s * s * (b * b * (0.125 + a * a)))
        * apparent
        + circulatory * downwash * (b * (a + 0.5));
    // y = −h turns the coupling entries; the textbook's lift is up already
    [
        [-lift_by_h, lift_by_rotation],
        [-moment_by_h, moment_by_rotation],
    ]
}

#[test]
fn the_flat_plate_about_an_axis_is_the_textbooks() {
    for (axis, mass) in OFFSETS {
        let section = unbalanced(SectionModel::table_4_1(), [axis, mass]);
        let s = section.structure().unwrap();
        let b = 0.5 * s.width_m;
        for (speed, omega) in [(5.0, 12.0), (20.0, 25.0), (40.0, 9.0)] {
            let z = impedance(&s, &FlatPlate::default(), speed, omega).unwrap();
            let lambda = Complex::new(0.0, omega);
            let f = theodorsen_about(s.axis_offset_m / b, b, s.air_density_kg_m3, speed, omega);
            for (i, row) in f.iter().enumerate() {
                for (j, force) in row.iter().enumerate() {
                    let body = lambda * lambda * s.mass[(i, j)]
                        + lambda * s.damping[(i, j)]
                        + s.stiffness[(i, j)];
                    let size = body.norm() + force.norm();
                    assert!(
                        (z[(i, j)] - (body - force)).norm() < 1e-12 * size,
                        "{i} {j}"
                    );
                }
            }
        }
    }
}

/// Twice the kinetic energy `m (ẏ − e θ̇)² + J_cg θ̇²`, and the static unbalance on the side that is stated.
#[test]
fn the_mass_matrix_is_that_of_a_rigid_body() {
    let section = unbalanced(SectionModel::table_4_1(), [0.0, 0.06]);
    let s = section.structure().unwrap();
    let (m, e, j) = (15.0, 0.03, 0.6);
    for (y, theta) in [(1.0, 0.0), (0.0, 1.0), (0.7, 2.0), (0.7, -2.0)] {
        let energy = s.mass[(0, 0)] * y * y
            + (s.mass[(0, 1)] + s.mass[(1, 0)]) * y * theta
            + s.mass[(1, 1)] * theta * theta;
        let centre: f64 = y - e * theta;
        let body = m * centre * centre + (j - m * e * e) * theta * theta;
        assert!((energy - body).abs() < 1e-12, "{energy} {body}");
    }
}

#[test]
fn both_descriptions_of_a_body_have_the_same_eigenvalues() {
    for named in matrix::sections_of_two() {
        for offsets in OFFSETS {
            let s = unbalanced(named.section.clone(), offsets.into())
                .structure()
                .unwrap();
            for kind in ["continuous_laguerre", "rational", "discrete_laguerre"] {
                let aero = fixture(kind).model.realize();
                let about = |s: Structure| CoupledSection::new(s, aero.clone()).unwrap();
                let speed = 0.6 * s.stiffness[(1, 1)].sqrt() / s.mass[(1, 1)].sqrt() * s.width_m;
                let of = |c: CoupledSection| c.at(speed).unwrap().eigenvalues().unwrap();
                let (axis, chord) = (of(about(s.clone())), of(about(by_mid_chord(&s))));
                assert_eq!(axis.len(), chord.len());
                let fastest = axis.iter().map(|z| z.norm()).fold(0.0, f64::max);
                let structural = axis.iter().filter(|z| z.im.abs() > 1e-3 * fastest);
                for z in structural {
                    let off = chord
                        .iter()
                        .map(|w| (w - z).norm())
                        .fold(f64::MAX, f64::min);
                    assert!(off < 1e-8 * fastest, "{} {kind} {z}: {off:e}", named.name);
                }
            }
        }
    }
}

/// Eigenvalues, determinant, p-k and divergence of one force model, and of the other description of the body.
#[test]
fn every_route_gives_one_onset() {
    let jones = RationalModel::jones_flat_plate();
    let range = ReducedFrequencyRange::between(
        ReducedFrequency::from_full_width(0.02),
        ReducedFrequency::from_full_width(10.0),
    );
    for named in matrix::sections_of_two() {
        let mut onsets = Vec::new();
        for offsets in OFFSETS {
            let s = unbalanced(named.section.clone(), offsets.into())
                .structure()
                .unwrap();
            let chord = by_mid_chord(&s);
            let steady = jones
                .transfer(ReducedFrequency::from_full_width(0.0))
                .unwrap();
            let divergence = divergence_speed(&s, &steady).unwrap().unwrap();
            let same = divergence_speed(&chord, &steady).unwrap().unwrap();
            assert!((same / divergence - 1.0).abs() < 1e-10);
            let search = OnsetSearch {
                speed_max_m_s: 1.2 * divergence,
                speeds: 120,
            };
            let coupled = CoupledSection::with_model(&s, &jones).unwrap();
            let by_eigenvalues = divergence_by_eigenvalues(&coupled, search.speed_max_m_s);
            let by_eigenvalues = by_eigenvalues.unwrap().unwrap();
            assert!((by_eigenvalues / divergence - 1.0).abs() < 1e-9);
            let onset = find_onset("", &coupled, &search, None).unwrap();
            let onset = onset.onset().unwrap().at.speed_m_s;
            let mut others = vec![
                pk_onset("", &s, &jones, &search, None).unwrap(),
                determinant_onset("", &s, &jones, range, search.speed_max_m_s).unwrap(),
                determinant_onset("", &chord, &jones, range, search.speed_max_m_s).unwrap(),
            ];
            for found in others.drain(..) {
                let speed = found.onset().unwrap().at.speed_m_s;
                assert!(
                    (speed / onset - 1.0).abs() < 1e-8,
                    "{} {offsets:?}: {speed} {onset}",
                    named.name
                );
            }
            onsets.push(onset);
        }
        // the offsets matter: the centre of mass upwind keeps the section stable longest
        assert!(
            onsets[0] < onsets[2] && onsets[2] < onsets[1] && onsets[1] < onsets[3],
            "{onsets:?}"
        );
    }
}

/// Released, stepped through changing wind under forces: `y_mid = y + a θ`, moments about the axis.
#[test]
fn both_descriptions_of_a_body_move_alike() {
    let section = unbalanced(SectionModel::table_4_1(), [0.1, 0.06]);
    let s = section.structure().unwrap();
    let t = to_mid_chord(&s, 1.0);
    for kind in ["continuous_laguerre", "rational", "discrete_laguerre"] {
        let aero = fixture(kind).model.realize();
        let stepper =
            |s: &Structure| Stepper::new(CoupledSection::new(s.clone(), aero.clone()).unwrap());
        let (mut axis, mut chord) = (stepper(&s), stepper(&by_mid_chord(&s)));
        let release = [0.004, 0.03];
        let moved = &t * DMatrix::from_column_slice(2, 1, &release);
        let mut a = axis.released(&release, &[0.0, 0.0]).unwrap();
        let mut c = chord.released(moved.as_slice(), &[0.0, 0.0]).unwrap();
        // a force at mid-chord lifts the axis and turns about it
        let mut by_chord = Inputs::steady(15.0, 2);
        by_chord.force = vec![2.0, 0.1];
        by_chord.wind_speed_rate_m_s2 = 2.0;
        let mut by_axis = by_chord.clone();
        by_axis.force[1] += s.axis_offset_m * 2.0;
        for _ in 0..200 {
            axis.advance(&mut a, &by_axis, 0.01).unwrap();
            chord.advance(&mut c, &by_chord, 0.01).unwrap();
            by_axis.wind_speed_m_s += 0.02;
            by_chord.wind_speed_m_s += 0.02;
            assert!((a.values[1] - c.values[1]).abs() < 1e-10, "{kind}");
            let lifted = a.values[0] + s.axis_offset_m * a.values[1];
            assert!((lifted - c.values[0]).abs() < 1e-10, "{kind}");
        }
    }
}

/// Static coefficients: equilibrium and nonlinear motion in gusts.
#[test]
fn static_forces_act_about_the_axis() {
    let section = unbalanced(SectionModel::table_4_1(), [0.1, 0.06]);
    let s = section.structure().unwrap();
    let arms = Arms {
        lateral: 0.1,
        vertical: -0.25,
        torsion: 0.2,
    };
    let table = embedded::coefficients("synthetic box girder").unwrap();
    let theory = QuasiSteady::new(table, arms, &Dof::TWO).unwrap();
    let chord = by_mid_chord(&s);
    let of = |s: &Structure| static_equilibria(s, &theory, &[14.0]).unwrap().points[0].clone();
    let (a, c) = (of(&s), of(&chord));
    assert!((a.rotation_rad / c.rotation_rad - 1.0).abs() < 1e-10);
    let lifted = a.displacement[0] + s.axis_offset_m * a.rotation_rad;
    assert!((lifted / c.displacement[0] - 1.0).abs() < 1e-10);
    let wave = |rate: f64| (0..=400).map(|i| (rate * f64::from(i)).sin()).collect();
    let gusts = GustSeries::new(0.01, wave(0.07), wave(0.12)).unwrap();
    let run = |s: &Structure, z: &[f64]| {
        let section = NonlinearSection::new(s.clone(), theory.clone(), 14.0, &gusts).unwrap();
        section.run(z, 0.01, 400, 1e-7).unwrap()
    };
    let (by_axis, by_chord) = (run(&s, &[0.0; 4]), run(&chord, &[0.0; 4]));
    let largest = by_chord.rows.iter().map(|r| r[0].abs()).fold(0.0, f64::max);
    for (a, c) in by_axis.rows.iter().zip(&by_chord.rows) {
        let lifted = a[0] + s.axis_offset_m * a[1];
        assert!((lifted - c[0]).abs() < 1e-5 * largest, "{lifted} {}", c[0]);
    }
}

#[test]
fn sections_state_their_offsets_in_files() {
    let mut json = serde_json::to_value(SectionModel::table_4_1()).unwrap();
    assert!(json.get("mass_offset_m").is_none() && json.get("axis_offset_m").is_none());
    json["mass_offset_m"] = 0.02.into();
    json["axis_offset_m"] = (-0.01).into();
    let section: SectionModel = serde_json::from_value(json).unwrap();
    let s = section.structure().unwrap();
    assert_eq!((s.mass[(0, 1)], s.axis_offset_m), (-15.0 * 0.02, -0.01));
}
