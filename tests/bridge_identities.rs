//! Whole bridges against the section, against sums written out, and against the whole matrix.

#[allow(dead_code)]
#[path = "common/bridges.rs"]
mod bridges;

use aerodeck::aerodynamics::{FlatPlate, RationalModel, Realizable, Transfer};
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::bridge::{Bridge, BridgeMode, Node, StripGroup, similarities, tributary_lengths};
use aerodeck::flutter::{
    OnsetSearch, determinant_onset, divergence_speed, find_onset, pk_onset, static_deflection,
    trace_modes,
};
use aerodeck::section::SectionModel;
use aerodeck::units::{ReducedFrequency, ReducedFrequencyRange};
use bridges::{SEARCH, THREE, TWO, coupled, langenuen, near, onset};
use std::f64::consts::PI;
use std::sync::Arc;

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
