//! The sweep against the search by eigenvalues, sample by sample.

use super::*;
use crate::aerodynamics::{FilterBank, FilterTerm, LaguerreModel, RationalModel, Realizable};
use crate::aeroelastic::CoupledSection;
use crate::flutter::{OnsetSearch, find_onset};
use crate::section::{Dof, Translation};
use crate::trained_model::{Model, TrainedModel};
use nalgebra::DMatrix;

/// Numbers in [−1, 1] from a multiplicative congruence: no crate needed, the same everywhere.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

fn varied(section: &SectionModel, noise: &mut Noise) -> SectionModel {
    let mut s = section.clone();
    s.width_m *= 1.0 + 0.02 * noise.next();
    s.air_density_kg_m3 *= 1.0 + 0.05 * noise.next();
    s.vertical.mass_kg_m *= 1.0 + 0.2 * noise.next();
    s.vertical.damping_ratio *= 1.0 + noise.next();
    s.torsion.inertia_kg_m2_m *= 1.0 + 0.2 * noise.next();
    s.torsion.damping_ratio *= 1.0 + noise.next();
    s.torsion.frequency_hz = s
        .torsion
        .frequency_hz
        .map(|f| f * (1.0 + 0.3 * noise.next()));
    if let Some(lateral) = &mut s.lateral {
        lateral.mass_kg_m *= 1.0 + 0.2 * noise.next();
    }
    s
}

/// Whether an eigenvalue of the section crosses the imaginary axis there, towards growth.
fn begins_to_grow(section: &CoupledSection, speed: f64) -> bool {
    let growth = |speed: f64| {
        let all = section.at(speed).unwrap().eigenvalues().unwrap();
        let oscillating = all.into_iter().filter(|z| z.im > 0.0);
        oscillating.map(|z| z.re).fold(f64::MIN, f64::max)
    };
    growth(speed * (1.0 - 1e-6)) < 0.0 && growth(speed * (1.0 + 1e-6)) > 0.0
}

/// Counts onsets; asserts that both routes agree on every sample.
fn compare(
    forces: LinearForces,
    section: &SectionModel,
    rebuilt: impl Fn(&[f64]) -> Box<dyn Realizable>,
    samples: usize,
    speed_max: f64,
    scatter: f64,
) -> (usize, usize) {
    let sweep = OnsetSweep::new(forces, &section.structure().unwrap(), speed_max).unwrap();
    let tested = sweep.forces().tested;
    let mut noise = Noise(7);
    let (mut onsets, mut unresolved, mut missed) = (0, 0, 0);
    for sample in 0..samples {
        let s = varied(section, &mut noise);
        let nominal = sweep.forces().coefficients();
        let coefficients: Vec<f64> = nominal
            .iter()
            .map(|c| c * (1.0 + scatter * noise.next()))
            .collect();
        let aero = rebuilt(&coefficients).realize();
        let coupled = CoupledSection::new(s.structure().unwrap(), aero).unwrap();
        let search = OnsetSearch {
            speed_max_m_s: speed_max,
            speeds: 60,
        };
        // a search that cannot follow the modes says nothing of the sweep
        let Ok(full) = find_onset("", &coupled, &search, tested) else {
            unresolved += 1;
            continue;
        };
        match (sweep.onset(&s, &coefficients).unwrap(), full.onset()) {
            (SweepOutcome::Onset(fast), Some(slow))
                if fast.speed_m_s < slow.at.speed_m_s * (1.0 - 1e-9)
                    && begins_to_grow(&coupled, fast.speed_m_s) =>
            {
                // two crossings between neighbouring speeds of the search
                onsets += 1;
                missed += 1;
            }
            (SweepOutcome::Onset(fast), Some(slow)) => {
                onsets += 1;
                assert!(
                    (fast.speed_m_s / slow.at.speed_m_s - 1.0).abs() < 1e-9,
                    "{sample}: {fast:?} {slow:?}"
                );
                assert!(
                    (fast.frequency_hz / slow.at.frequency_hz - 1.0).abs() < 1e-9,
                    "{sample}"
                );
                assert_eq!(
                    fast.in_tested_range,
                    slow.in_tested_range != Some(false),
                    "{sample}"
                );
            }
            (SweepOutcome::Stable { .. }, None) => assert_eq!(full.critical_speed_m_s(), None),
            (SweepOutcome::UnstableAtOrBelow(_), None) => {
                assert!(full.critical_speed_m_s().is_some(), "{sample}: {full:?}");
            }
            (SweepOutcome::Unresolved, _) => unresolved += 1,
            (fast, slow) => panic!("{sample}: {fast:?} against {slow:?}"),
        }
    }
    assert!(100 * missed <= samples, "{missed}");
    (onsets, unresolved)
}

fn with_powers(model: &LaguerreModel, c: &[f64]) -> LaguerreModel {
    let n = model.dofs.len();
    let per_input = c.len() / n;
    let at = |j: usize, b: usize, i: usize| c[j * per_input + b * n + i];
    let mut m = model.clone();
    m.e0 = DMatrix::from_fn(n, n, |i, j| at(j, 0, i));
    m.e1 = DMatrix::from_fn(n, n, |i, j| at(j, 1, i));
    m.e2 = DMatrix::from_fn(n, n, |i, j| at(j, 2, i));
    for term in &mut m.terms {
        let j = term.input;
        let l = term.coefficients.ncols();
        term.coefficients = DMatrix::from_fn(n, l, |i, l| at(j, 3 + l, i));
    }
    m
}

/// The flat plate of Jones as three Laguerre filters a motion would have it, near enough to flutter like one.
fn three_filters() -> LaguerreModel {
    let jones = RationalModel::jones_flat_plate();
    let total = &jones.lag_terms[0] + &jones.lag_terms[1];
    // p/(p + d) = 1 − √(d/2) Λ_0 for one filter of pole d
    let d: f64 = 0.35;
    let terms = (0..2)
        .map(|input| FilterTerm {
            input,
            poles: FilterBank::laguerre(d, 3).unwrap(),
            coefficients: DMatrix::from_fn(2, 3, |i, l| {
                -total[(i, input)] * (d / 2.0).sqrt() * [1.0, 0.1, 0.02][l]
            }),
        })
        .collect();
    LaguerreModel {
        dofs: Dof::TWO.to_vec(),
        e0: &jones.a1 + &total,
        e1: jones.a2.clone(),
        e2: jones.a3.clone(),
        terms,
    }
}

#[test]
fn two_thousand_laguerre_samples() {
    let model = three_filters();
    let forces = LinearForces::of_laguerre(&model, None);
    assert_eq!(forces.coefficients().len(), 2 * 6 * 2);
    let rebuilt = |c: &[f64]| Box::new(with_powers(&model, c)) as Box<dyn Realizable>;
    let section = SectionModel::table_4_1();
    let (onsets, unresolved) = compare(forces, &section, rebuilt, 2000, 60.0, 0.05);
    assert!(onsets > 1500 && unresolved < 4, "{onsets} {unresolved}");
}

/// The torsional frequency falls below that of heave in some samples: other modes flutter, or none.
#[test]
fn frequencies_that_cross() {
    let mut section = SectionModel::table_4_1();
    section.torsion.frequency_hz = Some(2.2);
    let jones = RationalModel::jones_flat_plate();
    let forces = LinearForces::of_rational(&jones, None);
    let rebuilt = |_: &[f64]| Box::new(RationalModel::jones_flat_plate()) as Box<dyn Realizable>;
    let (_, unresolved) = compare(forces, &section, rebuilt, 300, 60.0, 0.0);
    assert!(unresolved < 30, "{unresolved}");
}

#[test]
fn three_degrees_of_freedom() {
    let mut section = SectionModel::table_4_1();
    section.lateral = Some(Translation {
        mass_kg_m: 15.0,
        frequency_hz: Some(1.1),
        stiffness_n_m2: None,
        damping_ratio: 0.003,
    });
    let two = three_filters();
    // a drag that follows the slope of a parabola, and couples back weakly
    let three = |m: &DMatrix<f64>, drag: f64, coupling: f64| {
        let place = [0, 2];
        DMatrix::from_fn(3, 3, |i, j| match (i, j) {
            (1, 1) => drag,
            (1, _) | (_, 1) => coupling,
            _ => {
                m[(
                    place.iter().position(|p| *p == i).unwrap(),
                    place.iter().position(|p| *p == j).unwrap(),
                )]
            }
        })
    };
    let model = LaguerreModel {
        dofs: Dof::THREE.to_vec(),
        e0: three(&two.e0, 0.0, 0.05),
        e1: three(&two.e1, -0.4, -0.02),
        e2: three(&two.e2, 0.0, 0.0),
        terms: (0..3)
            .map(|input| FilterTerm {
                input,
                poles: FilterBank::laguerre(0.35, 3).unwrap(),
                coefficients: DMatrix::from_fn(3, 3, |i, l| match (i, input) {
                    (1, _) | (_, 1) => 0.01,
                    _ => two.terms[input / 2].coefficients[(i / 2, l)],
                }),
            })
            .collect(),
    };
    let rebuilt = |c: &[f64]| Box::new(with_powers(&model, c)) as Box<dyn Realizable>;
    for offset in [None, Some(0.03)] {
        section.axis_offset_m = offset;
        section.mass_offset_m = offset;
        let forces = LinearForces::of_laguerre(&model, None);
        let (onsets, unresolved) = compare(forces, &section, rebuilt, 500, 60.0, 0.05);
        assert!(onsets > 300 && unresolved < 8, "{onsets} {unresolved}");
    }
}

/// Axis and centre of mass on either side: coupled supports, forces about the axis.
#[test]
fn unbalanced_sections() {
    let jones = RationalModel::jones_flat_plate();
    let rebuilt = |_: &[f64]| Box::new(RationalModel::jones_flat_plate()) as Box<dyn Realizable>;
    let mut found = 0;
    for (axis, mass) in [(0.05, 0.03), (-0.05, 0.02), (0.05, 0.0), (0.0, 0.08)] {
        let mut section = SectionModel::table_4_1();
        section.axis_offset_m = Some(axis);
        section.mass_offset_m = Some(mass);
        let forces = LinearForces::of_rational(&jones, None);
        let (onsets, unresolved) = compare(forces, &section, rebuilt, 100, 60.0, 0.0);
        assert!(unresolved < 20, "{axis} {mass}: {unresolved}");
        found += onsets;
    }
    assert!(found > 300, "{found}");
}

#[test]
fn impossible_samples_are_refused_by_name() {
    let model = three_filters();
    let mut section = SectionModel::table_4_1();
    let structure = section.structure().unwrap();
    let sweep = OnsetSweep::new(LinearForces::of_laguerre(&model, None), &structure, 60.0).unwrap();
    let coefficients = sweep.forces().coefficients().to_vec();
    section.vertical.mass_kg_m = -1.0;
    let message = sweep
        .onset(&section, &coefficients)
        .unwrap_err()
        .to_string();
    assert_eq!(
        message,
        "section.vertical.mass_kg_m: expected a positive number, found -1"
    );
    assert!(
        sweep
            .onset(&SectionModel::table_4_1(), &coefficients[1..])
            .is_err()
    );
}

/// The discrete Laguerre model: the onset of the held forces, moved to that of the sampled section, is the one that the
/// search of all eigenvalues finds, for many sections.
#[test]
fn sampled_sections_flutter_where_their_eigenvalues_say() {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/data/models/discrete_laguerre.json"
    );
    let trained = TrainedModel::from_json(&std::fs::read_to_string(file).unwrap()).unwrap();
    let Model::DiscreteLaguerre(model) = &trained.model else {
        panic!("{}", trained.model.kind());
    };
    for (frequency, damping) in [(1.0, 1.0), (1.3, 0.5), (0.8, 3.0)] {
        let mut section = trained.section.clone();
        let torsion = &mut section.torsion;
        torsion.frequency_hz = torsion.frequency_hz.map(|f| f * frequency);
        torsion.damping_ratio *= damping;
        let structure = section.structure().unwrap();
        let coupled = CoupledSection::new(structure.clone(), model.realize()).unwrap();
        let search = OnsetSearch {
            speed_max_m_s: 80.0,
            ..OnsetSearch::default()
        };
        let found = find_onset("", &coupled, &search, None).unwrap();
        let expected = found.onset().unwrap().at.clone();
        let forces = LinearForces::of_discrete_laguerre(model, None);
        let sweep = OnsetSweep::new(forces, &structure, 80.0).unwrap();
        let coefficients = sweep.forces().coefficients().to_vec();
        let SweepOutcome::Onset(held) = sweep.onset(&section, &coefficients).unwrap() else {
            panic!("no onset");
        };
        let sampled = at_samples(&coupled, held).unwrap().unwrap();
        assert!(stands_at_samples(&coupled, held).unwrap());
        let off = |speed: f64| (speed / expected.speed_m_s - 1.0).abs();
        // what sampling adds, and what is left
        assert!(off(held.speed_m_s) < 1e-3, "{held:?}, {expected:?}");
        assert!(off(sampled.speed_m_s) < 1e-8, "{sampled:?}, {expected:?}");
        let frequency = sampled.frequency_hz / expected.frequency_hz;
        assert!((frequency - 1.0).abs() < 1e-8, "{sampled:?}, {expected:?}");
    }
}

/// Derivatives of all functions against differences.
#[test]
fn functions_know_their_derivatives() {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/data/models/discrete_laguerre.json"
    );
    let trained = TrainedModel::from_json(&std::fs::read_to_string(file).unwrap()).unwrap();
    let Model::DiscreteLaguerre(model) = &trained.model else {
        panic!("{}", trained.model.kind());
    };
    let forces = LinearForces::of_discrete_laguerre(model, None);
    let coefficients = forces.coefficients().to_vec();
    for p in [
        Complex64::new(0.0, 0.4),
        Complex64::new(-0.01, 1.5),
        Complex64::new(0.02, 30.0),
    ] {
        let step = 1e-5;
        let (value, slope) = forces.transfer::<2>(p, &coefficients);
        let (above, _) = forces.transfer::<2>(p + step, &coefficients);
        let (below, _) = forces.transfer::<2>(p - step, &coefficients);
        for i in 0..2 {
            for j in 0..2 {
                let difference = (above[i][j] - below[i][j]) / (2.0 * step);
                let off = (difference - slope[i][j]).norm();
                let size = slope[i][j].norm() + value[i][j].norm();
                assert!(
                    off < 1e-6 * size,
                    "{p}: {difference} against {}",
                    slope[i][j]
                );
            }
        }
    }
}
