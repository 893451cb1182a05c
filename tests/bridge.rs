//! Whole bridges against figures that were computed independently, against the section, and against themselves.

#[allow(dead_code)]
#[path = "common/bridges.rs"]
mod bridges;

use aerodeck::aerodynamics::{FlatPlate, RationalModel, Realizable, Transfer};
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::bridge::{Bridge, BridgeMode, Node, StripGroup, similarities, tributary_lengths};
use aerodeck::flutter::{
    FlutterSearch, NearbyOnset, Onset, OnsetSearch, determinant_onset, divergence_speed,
    find_onset, impedance, motion_at_onset, pk_onset, static_deflection, trace_modes,
};
use aerodeck::section::SectionModel;
use aerodeck::study::bridge::Scatter;
use aerodeck::units::{ReducedFrequency, ReducedFrequencyRange};
use bridges::{DECKS, THREE, TWO, langenuen, read};
use std::f64::consts::PI;
use std::sync::Arc;

/// Half of the last printed digit of the reference figures, and what 63 of 311 nodes cost (4e-5 m/s).
const PRINTED: f64 = 6e-4;

const SEARCH: OnsetSearch = OnsetSearch {
    speed_max_m_s: 100.0,
    speeds: 50,
};

fn coupled(bridge: &Bridge) -> CoupledSection {
    CoupledSection::new(bridge.structure(), bridge.forces().realize().unwrap()).unwrap()
}

fn by_table(bridge: &Bridge) -> FlutterSearch {
    let forces = bridge.forces();
    let range = forces.known_range();
    pk_onset("table", &bridge.structure(), &forces, &SEARCH, range).unwrap()
}

fn onset(search: FlutterSearch) -> Onset {
    match search {
        FlutterSearch::Onset(onset) => *onset,
        other => panic!("{}", other.explain()),
    }
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{found} instead of {expected} ± {tolerance}"
    );
}

/// Interpolated linearly in V̂ as the reference program does; vertical and torsional motion.
#[test]
fn langenuen_by_tables() {
    for (deck, motions, speed, hertz) in [
        ("LN21-5200", TWO, 76.384, 0.3304),
        ("LN21-5200", THREE, 77.674, 0.3293),
        ("LN21-5500", TWO, 80.806, 0.3270),
        ("LN20-5500", TWO, 77.736, 0.3293),
        ("LN21-5800", TWO, 80.032, 0.3298),
    ] {
        let bridge = langenuen(deck, motions).by_table.unwrap();
        let found = onset(by_table(&bridge));
        near(found.at.speed_m_s, speed, PRINTED);
        near(found.at.frequency_hz, hertz, 1.5e-4);
        let structure = bridge.structure();
        let k = found.at.reduced_frequency;
        assert!((k.full_width() - 2.0 * PI * found.at.frequency_hz * 31.0 / speed).abs() < 1e-4);
        // the second path: the impedance is singular there
        let omega = 2.0 * PI * found.at.frequency_hz;
        let z = impedance(&structure, &bridge.forces(), found.at.speed_m_s, omega).unwrap();
        let singular = z.clone().singular_values();
        assert!(singular.min() < 1e-8 * singular.max(), "{}", singular.min());
    }
}

/// With the measured sway derivatives of LN21-5500 the first lateral mode grows where it comes into the table.
#[test]
fn langenuen_with_negative_sway_damping_says_so() {
    let bridge = langenuen("LN21-5500", THREE).by_table.unwrap();
    let FlutterSearch::UnstableAtOrBelow(start) = by_table(&bridge) else {
        panic!("no growth");
    };
    assert_eq!(start.branch, "mode 1");
}

/// A dissipative model of three filters, eigenvalues of 195 states: within a hundredth of the table's.
#[test]
fn langenuen_by_eigenvalues() {
    for (deck, motions, speed) in [
        ("LN21-5200", TWO, 76.53),
        ("LN21-5200", THREE, 77.70),
        ("LN21-5500", TWO, 83.13),
        ("LN20-5500", TWO, 79.03),
        ("LN21-5800", TWO, 81.18),
    ] {
        let study = langenuen(deck, motions);
        let section = coupled(&study.by_model);
        assert_eq!(section.states(), 195);
        let found = onset(find_onset("model", &section, &SEARCH, study.tested_range()).unwrap());
        println!(
            "{deck} {motions}: {} (reference {speed})",
            found.at.speed_m_s
        );
        near(found.at.speed_m_s / speed, 1.0, 0.01);
        assert_eq!(found.in_tested_range, Some(true));
        assert!(found.warnings.is_empty(), "{:?}", found.warnings);
        let motion = motion_at_onset(&study.by_model, &study.by_model.forces(), &found.at).unwrap();
        let total: f64 = motion.modes.iter().map(|m| m.energy_share).sum();
        near(total, 1.0, 1e-12);
        assert!(
            [17, 23, 16].contains(&motion.modes[0].mode),
            "{:?}",
            motion.modes[0]
        );
    }
}

/// Every mode of the bridge at every wind speed below the onset, filters included.
#[test]
fn nothing_grows_below_the_onset() {
    for deck in DECKS {
        for motions in [TWO, THREE] {
            let study = langenuen(deck, motions);
            let section = coupled(&study.by_model);
            let fastest = |speed: f64| {
                let all = section.at(speed).unwrap().eigenvalues().unwrap();
                let oscillating = all.iter().filter(|z| z.im > 1e-6 * z.norm());
                oscillating
                    .map(|z| z.re / z.norm())
                    .fold(f64::MIN, f64::max)
            };
            let (mut low, mut high) = (0.5, 0.5);
            while high < 150.0 && fastest(high) <= 1e-9 {
                low = high;
                high = (1.15 * high).min(high + 3.0);
            }
            for _ in 0..20 {
                let middle = 0.5 * (low + high);
                *(if fastest(middle) > 1e-9 {
                    &mut high
                } else {
                    &mut low
                }) = middle;
            }
            println!("{deck} {motions}: first growth at {high:.3} m/s");
            // the lowest onset of the family is that of LN21-6100
            assert!(high > 60.0, "{deck} {motions}: grows at {high}");
        }
    }
}

fn cheynet(case: usize, rest: &str) -> Bridge {
    read(&format!(
        "schema = 1\nname = \"Cheynet {case}\"\nair_density_kg_m3 = 1.25\n\
         [modes]\nformat = \"csv\"\npath = \"cheynet_case{case}.csv\"\ndamping_ratio = 0.005\n\
         [[section]]\nname = \"girder\"\nmotions = [\"vertical\", \"lateral\", \"torsion\"]\n{rest}\n\
         arms = {{ vertical = 0.25, lateral = 0.25, torsion = 0.25 }} }}\n"
    ))
    .by_model
}

/// Single spans with quasi-steady forces, arms of a quarter of the width. Printed: 62.391 and 140.45 m/s from grids of
/// 0.65 m/s; computed independently: 62.993 m/s at 0.31069 Hz and 140.599 m/s at 0.83071 Hz. The drag of 1 refers to the height.
#[test]
fn spans_of_cheynet() {
    for (case, rest, speed, hertz) in [
        (
            1,
            "width_m = 20.0\nstatic = { drag = 0.15, lift = -0.3, lift_slope = 3.0, moment = 0.01, moment_slope = 0.5,",
            62.993,
            0.31069,
        ),
        (
            2,
            "width_m = 12.3\nstatic = { drag = 0.22439024, lift = 0.1, lift_slope = 3.0, moment = 0.01, moment_slope = 1.0,",
            140.599,
            0.83071,
        ),
    ] {
        let section = coupled(&cheynet(case, rest));
        let search = OnsetSearch {
            speed_max_m_s: 200.0,
            speeds: 80,
        };
        let found = onset(find_onset("quasi-steady", &section, &search, None).unwrap());
        near(found.at.speed_m_s, speed, PRINTED);
        near(found.at.frequency_hz, hertz, 6e-6);
    }
}

/// All modes with one shape, sin(πx/L): the bridge is the section.
fn uniform(section: &SectionModel, forces: Arc<dyn Transfer>) -> Bridge {
    let span = 900.0;
    let along: Vec<f64> = (0..=40).map(|i| span * f64::from(i) / 40.0).collect();
    let lengths = tributary_lengths(&along);
    let sine = |x: f64| (PI * x / span).sin();
    let square: f64 = along
        .iter()
        .zip(&lengths)
        .map(|(x, w)| w * sine(*x).powi(2))
        .sum();
    let mut bridge = Bridge::of_section(section, forces.clone()).unwrap();
    let modes: Vec<BridgeMode> = bridge
        .modes
        .drain(..)
        .map(|m| BridgeMode {
            generalised_mass: m.generalised_mass * square,
            shape: along
                .iter()
                .map(|x| m.shape[0].map(|s| s * sine(*x)))
                .collect(),
            ..m
        })
        .collect();
    let nodes = along.iter().zip(lengths).enumerate();
    let nodes = nodes.map(|(i, (along_m, length_m))| Node {
        name: i.to_string(),
        along_m: *along_m,
        length_m,
    });
    let group = StripGroup {
        name: "girder".into(),
        width_m: section.width_m,
        wind_factor: 1.0,
        nodes: (0..=40).collect(),
        forces,
    };
    let density = section.air_density_kg_m3;
    Bridge::new("uniform", density, nodes.collect(), modes, vec![group]).unwrap()
}

#[test]
fn uniform_shapes_are_the_section() {
    for section in [SectionModel::iabse_1_1a(), SectionModel::table_4_1()] {
        let jones = Arc::new(RationalModel::jones_flat_plate());
        let alone = CoupledSection::new(section.structure().unwrap(), jones.realize()).unwrap();
        let search = OnsetSearch {
            speed_max_m_s: 100.0,
            speeds: 60,
        };
        let of =
            |coupled: &CoupledSection| onset(find_onset("Jones", coupled, &search, None).unwrap());
        let expected = of(&alone).at.speed_m_s;
        let one_node = Bridge::of_section(&section, jones.clone()).unwrap();
        let many = uniform(&section, jones);
        for bridge in [one_node, many] {
            let coupled = coupled(&bridge);
            near(of(&coupled).at.speed_m_s / expected, 1.0, 1e-9);
            // the eigenvalues too, at any speed
            for speed in [5.0, 30.0, 80.0] {
                let sorted = |c: &CoupledSection| {
                    let mut all = c.at(speed).unwrap().eigenvalues().unwrap();
                    all.retain(|z| z.im > 0.0);
                    all.sort_by(|a, b| a.im.total_cmp(&b.im));
                    all
                };
                for (a, b) in sorted(&alone).iter().zip(sorted(&coupled)) {
                    assert!((a - b).norm() < 1e-9 * a.norm(), "{a} {b} at {speed}");
                }
            }
        }
    }
}

/// The same for a force model that is only a G(K), by both routes.
#[test]
fn uniform_shapes_are_the_section_by_transfer() {
    let section = SectionModel::iabse_1_1a();
    let structure = section.structure().unwrap();
    let range = ReducedFrequencyRange {
        min: ReducedFrequency::from_full_width(0.05),
        max: ReducedFrequency::from_full_width(10.0),
    };
    let plate = FlatPlate::default();
    let expected = onset(determinant_onset("plate", &structure, &plate, range, 200.0).unwrap());
    let bridge = uniform(&section, Arc::new(plate));
    let (s, forces) = (bridge.structure(), bridge.forces());
    let determinant = onset(determinant_onset("plate", &s, &forces, range, 200.0).unwrap());
    let pk = onset(pk_onset("plate", &s, &forces, &SEARCH, None).unwrap());
    for found in [determinant, pk] {
        near(found.at.speed_m_s / expected.at.speed_m_s, 1.0, 1e-9);
        near(found.at.frequency_hz / expected.at.frequency_hz, 1.0, 1e-9);
    }
}

/// Realised and as a transfer matrix the forces on the modes are the same, also of two sections in different winds.
#[test]
fn filters_on_modes_are_the_forces_on_strips() {
    let mut bridge = langenuen("LN21-5200", TWO).by_model;
    let nodes = bridge.nodes.len();
    let mut second = bridge.groups[0].clone();
    bridge.groups[0].nodes = (0..nodes / 3).collect();
    second.nodes = (nodes / 3..nodes).collect();
    (second.width_m, second.wind_factor) = (24.0, 0.83);
    second.forces = Arc::new(RationalModel::jones_flat_plate());
    bridge.groups.push(second);
    let forces = bridge.forces();
    let realised = forces.realize().unwrap();
    for k in [0.05, 0.4, 1.3, 6.0] {
        let k = ReducedFrequency::from_full_width(k);
        let (a, b) = (forces.transfer(k).unwrap(), realised.transfer(k).unwrap());
        assert!(
            (&a - &b).camax() < 1e-11 * a.camax(),
            "{}",
            (&a - &b).camax()
        );
    }
}

/// The forces are the sum over strips, written out strip by strip.
#[test]
fn the_sums_over_nodes_are_sums_over_strips() {
    let bridge = langenuen("LN21-5200", THREE).by_model;
    let forces = bridge.forces();
    let k = ReducedFrequency::from_full_width(0.7);
    let found = forces.transfer(k).unwrap();
    let width = bridge.width_m();
    let g = bridge.groups[0].forces.transfer(k).unwrap();
    for (a, b) in [(0, 0), (2, 22), (16, 4), (30, 11)] {
        let (ma, mb) = (&bridge.modes[a], &bridge.modes[b]);
        let mut sum = nalgebra::Complex::new(0.0, 0.0);
        for (n, node) in bridge.nodes.iter().enumerate() {
            let scale = [1.0, 1.0, width];
            for i in 0..3 {
                for j in 0..3 {
                    // rows and columns of G stand in the order vertical, lateral, rotation
                    let motion = mb.shape[n][j] * scale[j] / width;
                    sum += g[(i, j)] * (node.length_m * ma.shape[n][i] * width * scale[i] * motion);
                }
            }
        }
        let mass = (ma.generalised_mass * mb.generalised_mass).sqrt();
        let expected = sum / (mass * width * width);
        assert!((found[(a, b)] - expected).norm() < 1e-12 * found.camax());
    }
}

/// Followed modes are eigenvalues of the whole matrix, and none is lost on the way.
#[test]
fn followed_modes_are_eigenvalues() {
    let study = langenuen("LN21-5200", TWO);
    let section = coupled(&study.by_model);
    let curves = trace_modes("model", &section, &[2.0, 20.0, 45.0, 70.0]).unwrap();
    assert_eq!(curves.ended, None);
    assert_eq!(curves.branches.len(), 39);
    for (i, speed) in [2.0, 20.0, 45.0, 70.0].into_iter().enumerate() {
        let all = section.at(speed).unwrap().eigenvalues().unwrap();
        for branch in &curves.branches {
            let z = branch.points[i].eigenvalue;
            let z = nalgebra::Complex::new(z.re, z.im);
            let nearest = all.iter().map(|l| (l - z).norm()).fold(f64::MAX, f64::min);
            assert!(
                nearest < 1e-10 * z.norm(),
                "{} at {speed}: {nearest:e}",
                branch.name
            );
        }
    }
}

#[test]
fn like_shapes_have_a_similarity_of_one() {
    let section = SectionModel::iabse_1_1a();
    let bridge = uniform(&section, Arc::new(RationalModel::jones_flat_plate()));
    let all = similarities(&bridge);
    assert_eq!(all.len(), 1);
    near(all[0].similarity, 1.0, 1e-12);
    // by hand: ∫ sin² of the first vertical, by the second sine
    let mut other = bridge;
    let along: Vec<f64> = other.nodes.iter().map(|n| n.along_m).collect();
    for (shape, x) in other.modes[0].shape.iter_mut().zip(along) {
        shape[0] = (2.0 * PI * x / 900.0).sin();
    }
    near(similarities(&other)[0].similarity, 0.0, 1e-12);
}

/// Without scatter every sample is the mean; with it the mode followed is the one that a search finds.
#[test]
fn scatter_follows_the_onset() {
    let study = langenuen("LN21-5200", TWO);
    let found = find_onset(
        "model",
        &coupled(&study.by_model),
        &SEARCH,
        study.tested_range(),
    );
    let found = onset(found.unwrap());
    let none = Scatter {
        frequency: 0.0,
        damping: 0.0,
        derivatives: 0.0,
        samples: 3,
        seed: 1,
    };
    let still = study.scattered_onset(&found, &none).unwrap();
    near(still.mean_m_s / found.at.speed_m_s, 1.0, 1e-8);
    assert!(still.standard_deviation_m_s < 1e-6 * still.mean_m_s);
    let some = Scatter {
        frequency: 0.01,
        damping: 0.2,
        derivatives: 0.03,
        samples: 60,
        seed: 5,
    };
    let scattered = study.scattered_onset(&found, &some).unwrap();
    assert_eq!(scattered, study.scattered_onset(&found, &some).unwrap());
    println!("{scattered:?}");
    assert_eq!(scattered.without_onset, 0);
    near(scattered.mean_m_s / found.at.speed_m_s, 1.0, 0.03);
    let relative = scattered.standard_deviation_m_s / scattered.mean_m_s;
    assert!((0.005..0.1).contains(&relative), "{relative}");
    // one bridge of another damping, found by search and from nearby
    let mut other = study.by_model.clone();
    other.modes.iter_mut().for_each(|m| m.damping_ratio = 0.004);
    let other = coupled(&other);
    let searched = onset(find_onset("model", &other, &SEARCH, None).unwrap());
    let nearby = NearbyOnset::of(&study.by_model, &found.at).unwrap();
    let (speed, hertz) = nearby.find(&other).unwrap();
    near(speed / searched.at.speed_m_s, 1.0, 1e-7);
    near(hertz / searched.at.frequency_hz, 1.0, 1e-6);
}

/// In slow wind the mean displacement is the sum of the modes under the steady load; near divergence it grows.
#[test]
fn static_deflection_by_hand() {
    let bridge = langenuen("LN21-5200", TWO).by_model;
    let at_rest = bridge
        .forces()
        .transfer(ReducedFrequency::from_full_width(0.0))
        .unwrap();
    let speed = 0.1;
    let found = static_deflection(&bridge, &[[-0.2, 0.1, 0.03]], &at_rest, speed).unwrap();
    let pressure = 0.5 * 1.25 * speed * speed;
    let load = [
        -0.2 * 31.0 * pressure,
        0.1 * 31.0 * pressure,
        0.03 * 961.0 * pressure,
    ];
    let node = 31;
    for (i, found) in found[node].into_iter().enumerate() {
        let expected: f64 = bridge
            .modes
            .iter()
            .map(|m| {
                let work: f64 = bridge
                    .nodes
                    .iter()
                    .zip(&m.shape)
                    .map(|(n, s)| n.length_m * (0..3).map(|j| s[j] * load[j]).sum::<f64>())
                    .sum();
                let stiffness = m.generalised_mass * (2.0 * PI * m.frequency_hz).powi(2);
                m.shape[node][i] * work / stiffness
            })
            .sum();
        near(found / expected, 1.0, 1e-4);
    }
    let divergence = divergence_speed(&bridge.structure(), &at_rest)
        .unwrap()
        .unwrap();
    let close =
        static_deflection(&bridge, &[[0.0, 0.0, 0.03]], &at_rest, 0.99 * divergence).unwrap();
    let half = static_deflection(&bridge, &[[0.0, 0.0, 0.03]], &at_rest, 0.5 * divergence).unwrap();
    assert!(close[node][2] > 20.0 * half[node][2]);
}
