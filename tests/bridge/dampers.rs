//! Tuned mass dampers and viscous links: closed forms, the same system written down in other coordinates, all decks.

use crate::bridges::{DECKS, SEARCH, THREE, TWO, coupled, langenuen_text, near, onset, read};
use aerodeck::aerodynamics::{RationalModel, Transfer};
use aerodeck::bridge::{Bridge, DampedPoint, Dampers, MassDamper, ViscousLink};
use aerodeck::flutter::{find_onset, pk_onset};
use aerodeck::section::{Dof, SectionModel};
use aerodeck::study::bridge::BridgeStudy;
use nalgebra::{Complex, DMatrix, DVector};
use std::f64::consts::TAU;
use std::sync::Arc;

fn point(node: usize, motion: Dof, offset_m: f64) -> DampedPoint {
    DampedPoint {
        node,
        motion,
        offset_m,
    }
}

fn mass(at: DampedPoint, mass_kg: f64, frequency_hz: f64, damping_ratio: f64) -> MassDamper {
    MassDamper {
        name: "damper".to_owned(),
        at,
        mass_kg,
        frequency_hz,
        damping_ratio,
    }
}

fn link(at: DampedPoint, to: Option<DampedPoint>, coefficient: f64) -> ViscousLink {
    ViscousLink {
        name: "link".to_owned(),
        at,
        to,
        coefficient,
    }
}

fn of_masses(masses: &[MassDamper]) -> Dampers {
    Dampers {
        masses: masses.to_vec(),
        links: Vec::new(),
    }
}

/// Den Hartog: with the frequency 1/(1 + μ) and the damping √(3μ/8(1 + μ)³) the response of an undamped mass is nowhere larger than
/// about √(1 + 2/μ) times the static one, which it is at both fixed points.
#[test]
fn the_classical_tuning_levels_the_resonance() {
    let mut section = SectionModel::iabse_1_1a();
    section.vertical.damping_ratio = 0.0;
    let plate = Arc::new(RationalModel::jones_flat_plate());
    let (own, hertz) = (section.vertical.mass_kg_m, 0.1);
    for ratio in [0.01_f64, 0.05] {
        let damping = (3.0 * ratio / (8.0 * (1.0 + ratio) * (1.0 + ratio) * (1.0 + ratio))).sqrt();
        let at = point(0, Dof::Vertical, 0.0);
        let damper = mass(at, ratio * own, hertz / (1.0 + ratio), damping);
        let bridge = Bridge::of_section(&section, plate.clone()).unwrap();
        let bridge = bridge.with_dampers(of_masses(&[damper])).unwrap();
        let s = bridge.structure();
        let response = |omega: f64| {
            let resistance = DMatrix::from_fn(3, 3, |i, j| {
                Complex::new(
                    s.stiffness[(i, j)] - omega * omega * s.mass[(i, j)],
                    omega * s.damping[(i, j)],
                )
            });
            let load = DVector::from_vec(vec![1.0, 0.0, 0.0]).map(Complex::from);
            let motion = resistance.lu().solve(&load).unwrap()[0];
            motion.norm() * (TAU * hertz).powi(2)
        };
        // the fixed points, which no damping moves
        let root = (ratio / (2.0 + ratio)).sqrt();
        let level = (1.0 + 2.0 / ratio).sqrt();
        for sign in [-1.0, 1.0] {
            let omega = TAU * hertz * ((1.0 + sign * root) / (1.0 + ratio)).sqrt();
            near(response(omega) / level, 1.0, 1e-9);
        }
        let highest = (1..4000).map(|i| response(TAU * hertz * (0.7 + 1.5e-4 * f64::from(i))));
        // the damping is the mean of two, one for each fixed point
        near(highest.fold(0.0, f64::max) / level, 1.0, 0.01);
    }
}

/// Girder of eight modes with two masses, a link between nodes and one to the ground.
fn damped(study: &BridgeStudy) -> Dampers {
    let node = |name: &str| {
        let all = study.by_model.nodes.iter();
        all.clone().position(|n| n.name == name).unwrap()
    };
    let (middle, quarter) = (node("1156"), node("1081"));
    Dampers {
        masses: vec![
            mass(point(middle, Dof::Vertical, 11.0), 4e4, 0.33, 0.1),
            mass(point(quarter, Dof::Vertical, -11.0), 3e4, 0.29, 0.05),
            mass(point(middle, Dof::Lateral, 0.0), 2e4, 0.06, 0.12),
        ],
        links: vec![
            link(
                point(quarter, Dof::Torsion, 0.0),
                Some(point(middle, Dof::Torsion, 0.0)),
                3e7,
            ),
            link(point(quarter, Dof::Vertical, 0.0), None, 5e4),
        ],
    }
}

/// Still air: eigenvalues of the modes and the strokes, in which the masses stand, instead of springs and dashpots in which the
/// displacements do. Wind: at the onset the impedance of that system is singular.
#[test]
fn strokes_as_coordinates_give_the_same() {
    let plain = crate::bridges::lively();
    let dampers = damped(&plain);
    let bridge = plain
        .by_model
        .clone()
        .with_dampers(dampers.clone())
        .unwrap();
    let bare = &plain.by_model;
    let (m, d) = (bare.modes.len(), dampers.masses.len());
    // u = z + vᵀη: kinetic energy ½ηᵀη + Σ ½m(ż + vᵀη̇)²
    let motion = |p: &DampedPoint| -> DVector<f64> {
        DVector::from_fn(m, |i, _| {
            let mode = &bare.modes[i];
            let [y, x, turned] = mode.shape[p.node];
            let own = match p.motion {
                Dof::Vertical => y - p.offset_m * turned,
                Dof::Lateral => x,
                Dof::Torsion => turned,
            };
            own / mode.generalised_mass.sqrt()
        })
    };
    let zeros = || DMatrix::<f64>::zeros(m + d, m + d);
    let (mut mass, mut damping, mut stiffness) = (zeros(), zeros(), zeros());
    for (i, mode) in bare.modes.iter().enumerate() {
        let omega = TAU * mode.frequency_hz;
        mass[(i, i)] = 1.0;
        damping[(i, i)] = 2.0 * mode.damping_ratio * omega;
        stiffness[(i, i)] = omega * omega;
    }
    for (j, damper) in dampers.masses.iter().enumerate() {
        let mut moved = motion(&damper.at).resize_vertically(m + d, 0.0);
        moved[m + j] = 1.0;
        mass += &moved * moved.transpose() * damper.mass_kg;
        let omega = TAU * damper.frequency_hz;
        stiffness[(m + j, m + j)] = damper.mass_kg * omega * omega;
        damping[(m + j, m + j)] = 2.0 * damper.damping_ratio * damper.mass_kg * omega;
    }
    for link in &dampers.links {
        let mut stretch = motion(&link.at);
        if let Some(to) = &link.to {
            stretch -= motion(to);
        }
        let stretch = stretch.resize_vertically(m + d, 0.0);
        damping += &stretch * stretch.transpose() * link.coefficient;
    }
    let impedance = |lambda: Complex<f64>, forces: &DMatrix<Complex<f64>>| {
        DMatrix::from_fn(m + d, m + d, |i, j| {
            let force = if i < m && j < m {
                forces[(i, j)]
            } else {
                Complex::default()
            };
            (lambda * mass[(i, j)] + damping[(i, j)]) * lambda + stiffness[(i, j)] - force
        })
    };
    let singular = |matrix: DMatrix<Complex<f64>>| {
        // rows of one size
        let scale: Vec<f64> = matrix.row_iter().map(|r| r.norm()).collect();
        let scaled = DMatrix::from_fn(m + d, m + d, |i, j| matrix[(i, j)] / scale[i]);
        let values = scaled.singular_values();
        values.min() / values.max()
    };
    let none = DMatrix::zeros(m, m);
    let s = bridge.structure();
    let n = m + d;
    let mut a = DMatrix::zeros(2 * n, 2 * n);
    a.view_mut((0, n), (n, n)).fill_with_identity();
    a.view_mut((n, 0), (n, n)).copy_from(&-&s.stiffness);
    a.view_mut((n, n), (n, n)).copy_from(&-&s.damping);
    let roots = a.complex_eigenvalues();
    assert_eq!(roots.len(), 2 * n);
    for lambda in roots.iter().filter(|z| z.im >= 0.0) {
        let left = singular(impedance(*lambda, &none));
        assert!(left < 1e-10, "{lambda}: {left}");
    }
    let found = onset(find_onset("bridge", &coupled(&bridge), &SEARCH, None).unwrap());
    let without = onset(find_onset("bridge", &coupled(bare), &SEARCH, None).unwrap());
    eprintln!(
        "{} without, {} m/s with dampers",
        without.at.speed_m_s, found.at.speed_m_s
    );
    let pressure = 0.5 * bare.air_density_kg_m3 * found.at.speed_m_s.powi(2);
    let forces = bare.forces().transfer(found.at.reduced_frequency).unwrap();
    let forces = bare.structure().to_physical(&forces) * Complex::from(pressure);
    let omega = TAU * found.at.frequency_hz;
    let left = |part: f64| singular(impedance(Complex::new(0.0, part * omega), &forces));
    assert!(
        left(1.0) < 1e-8 && left(1.001) > 1e-6,
        "{} {}",
        left(1.0),
        left(1.001)
    );
}

/// The same damper as two halves, at one place or as one of a hundred; of many, modes of one frequency.
#[test]
fn a_damper_may_be_split() {
    let study = crate::bridges::lively();
    let at = point(31, Dof::Vertical, 9.0);
    let of = |count: usize| {
        let part = mass(at.clone(), 5e4 / count as f64, 0.32, 0.08);
        let bridge = study.by_model.clone();
        let bridge = bridge.with_dampers(of_masses(&vec![part; count])).unwrap();
        onset(find_onset("bridge", &coupled(&bridge), &SEARCH, None).unwrap()).at
    };
    let one = of(1);
    for count in [2, 3, 5] {
        near(of(count).speed_m_s / one.speed_m_s, 1.0, 1e-8);
        near(of(count).frequency_hz / one.frequency_hz, 1.0, 1e-8);
    }
}

/// Whatever a damper is: without mass nothing, without spring and dashpot nothing, and as stiff as it may be a mass on the girder.
#[test]
fn extreme_dampers_have_an_onset() {
    let study = crate::bridges::lively();
    let onset_with = |dampers: Dampers| {
        let bridge = study.by_model.clone().with_dampers(dampers).unwrap();
        onset(find_onset("bridge", &coupled(&bridge), &SEARCH, None).unwrap())
            .at
            .speed_m_s
    };
    let plain = onset_with(Dampers::default());
    let at = |motion| point(31, motion, 0.0);
    let light = mass(at(Dof::Vertical), 1e-3, 0.3, 0.1);
    near(onset_with(of_masses(&[light])) / plain, 1.0, 1e-6);
    // so slow that it hardly pulls, and overdamped
    let slow = mass(at(Dof::Vertical), 1e4, 1e-3, 0.0);
    near(onset_with(of_masses(&[slow])) / plain, 1.0, 1e-3);
    let overdamped = onset_with(of_masses(&[mass(at(Dof::Lateral), 1e4, 0.3, 5.0)]));
    assert!(
        (overdamped / plain - 1.0).abs() < 0.1,
        "{overdamped}, {plain}"
    );
    // a node that cannot turn at all leaves no flutter in these winds
    for coefficient in [0.0, 1e4, 1e6, 1e9] {
        let dampers = Dampers {
            masses: Vec::new(),
            links: vec![link(at(Dof::Torsion), None, coefficient)],
        };
        let bridge = study.by_model.clone().with_dampers(dampers).unwrap();
        let found = find_onset("bridge", &coupled(&bridge), &SEARCH, None).unwrap();
        let found = found.critical_speed_m_s();
        eprintln!("link of {coefficient} N·m·s/rad: {found:?}, {plain} m/s without");
        assert_eq!(found.is_some(), coefficient < 1e7, "{coefficient}");
        assert!(
            found.is_none_or(|v| v >= plain * (1.0 - 1e-9)),
            "{coefficient}"
        );
    }
}

const PAIRS: &str = "[[damper]]\nnode = \"1156\"\nmotion = \"torsion\"\narm_m = 13.0\nmass_kg = 60e3\nfrequency_hz = 0.33\ndamping_ratio = 0.1\n\
     [[damper]]\nnode = \"1081\"\nmotion = \"lateral\"\nmass_kg = 40e3\nfrequency_hz = 0.055\ndamping_ratio = 0.08\n\
     [[damper]]\nnode = \"1001\"\nmotion = \"vertical\"\ncoefficient = 1e5\n";

/// All decks with two and three motions: the onset of the model against the largest growth of all eigenvalues on both sides of it.
#[test]
fn all_decks_with_dampers() {
    for (deck, motions) in DECKS.iter().flat_map(|d| [(d, TWO), (d, THREE)]) {
        let select = "damping_ratio = 0.02\nselect = [1, 2, 3, 5, 12, 14, 16, 17, 23]";
        let text =
            langenuen_text(deck, motions, "linear_v_hat").replace("damping_ratio = 0.002", select);
        let study = read(&(text + PAIRS));
        assert_eq!(study.by_model.dampers.masses.len(), 3);
        let section = coupled(&study.by_model);
        let found = find_onset("model", &section, &SEARCH, None).unwrap();
        let growth = |speed: f64| {
            let all = section.at(speed).unwrap().eigenvalues().unwrap();
            all.iter().map(|z| z.re).fold(f64::MIN, f64::max)
        };
        let Some(critical) = found.critical_speed_m_s() else {
            assert!(
                growth(SEARCH.speed_max_m_s) < 0.0,
                "{deck} {motions}: {}",
                found.explain()
            );
            continue;
        };
        eprintln!("{deck} {motions}: {critical} m/s");
        if found.onset().is_some() {
            assert!(growth(critical * (1.0 - 1e-6)) < 0.0 && growth(critical * (1.0 + 1e-6)) > 0.0);
        } else {
            assert!(
                growth(critical * (1.0 + 1e-6)) > 0.0,
                "{deck} {motions}: {}",
                found.explain()
            );
        }
        for wind in [0.01, 10.0] {
            if wind < critical {
                assert!(growth(wind) < 0.0, "{deck} {motions} at {wind} m/s");
            }
        }
        let table = study.by_table.as_ref().unwrap();
        let by_table = pk_onset(
            "table",
            &table.structure(),
            &table.forces(),
            &SEARCH,
            study.tested_range(),
        );
        eprintln!(
            "    by the table {:?}",
            by_table.unwrap().critical_speed_m_s()
        );
    }
}

/// Langenuen with dampers of 60 t: what they bring, and that the p-k iteration of the model agrees.
#[test]
fn dampers_lift_the_onset_of_langenuen() {
    let text = langenuen_text("LN21-5200", TWO, "modified_akima");
    let of = |study: &BridgeStudy| {
        onset(find_onset("model", &coupled(&study.by_model), &SEARCH, None).unwrap()).at
    };
    let before = of(&read(&text)).speed_m_s;
    // mid-span, or a quarter to either side; one pair of 60 t or two
    let cases = [
        (["1156", "1156"], 0.34, 89.377),
        (["1156", "1156"], 0.32, 92.810),
        (["1081", "1231"], 0.32, 85.774),
        (["1156", ""], 0.32, 90.565),
        // another motion, of 0.22 Hz, before that which the dampers act against
        (["1156", "1156"], 0.30, 94.150),
    ];
    for (nodes, hertz, expected) in cases {
        let of_node = |node: &&str| {
            format!(
                "[[damper]]\nnode = \"{node}\"\nmotion = \"torsion\"\narm_m = 13.0\nmass_kg = 60e3\nfrequency_hz = {hertz}\ndamping_ratio = 0.1\n"
            )
        };
        let blocks: String = nodes
            .iter()
            .filter(|n| !n.is_empty())
            .map(of_node)
            .collect();
        let study = read(&(text.clone() + &blocks));
        let bridge = &study.by_model;
        let after = of(&study);
        eprintln!(
            "{nodes:?}, {hertz} Hz: {before} to {} m/s, {} Hz",
            after.speed_m_s, after.frequency_hz
        );
        let pk = pk_onset(
            "model",
            &bridge.structure(),
            &bridge.forces(),
            &SEARCH,
            None,
        );
        near(
            pk.unwrap().critical_speed_m_s().unwrap() / after.speed_m_s,
            1.0,
            1e-6,
        );
        near(after.speed_m_s, expected, 1e-3);
    }
}
