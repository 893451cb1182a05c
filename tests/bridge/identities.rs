//! Whole bridges against the section, against sums written out, and against the whole matrix.

use crate::bridges::{SEARCH, THREE, TWO, coupled, langenuen, langenuen_text, near, onset, read};
use aerodeck::aerodynamics::derivatives::InterpolatedTable;
use aerodeck::aerodynamics::{FlatPlate, RationalModel, Realizable, Transfer};
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::bridge::{Bridge, BridgeMode, Node, StripGroup};
use aerodeck::files::bridge::BridgeFile;
use aerodeck::files::bridge::tributary_lengths;
use aerodeck::flutter::OnsetInterval;
use aerodeck::flutter::{
    OnsetSearch, determinant_onset, divergence_speed, find_onset, pk_onset, trace_modes,
};
use aerodeck::section::Dof;
use aerodeck::section::SectionModel;
use aerodeck::study::bridge::{BridgeStudy, equivalent_section, similarities, static_deflection};
use aerodeck::uncertainty::{AdmissibleForm, FormOnset};
use aerodeck::units::{ReducedFrequency, ReducedFrequencyRange};
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
    let range = ReducedFrequencyRange::between(
        ReducedFrequency::from_full_width(0.05),
        ReducedFrequency::from_full_width(10.0),
    );
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

/// Scatter and form of the interval of an onset, with a girder that ends at a node, and another beyond; in either order.
fn parts_of_interval(other: Option<(&str, &str)>, swapped: bool) -> [f64; 2] {
    let whole = langenuen_text("LN21-5200", TWO, "modified_akima");
    let whole = whole.replace("0.002\n", "0.002\nselect = [2, 3, 5, 12, 14, 16, 17, 23]\n");
    let (head, girder) = whole.split_once("[[section]]\n").unwrap();
    let (girder, tail) = girder.split_once("[flutter]").unwrap();
    let mut parts = vec![girder.to_owned()];
    if let Some((deck, width)) = other {
        let far = girder.replace("girder", "far").replace("31.0", width);
        parts[0] += "to = \"1151\"\n";
        parts.push(far.replace("LN21-5200", deck) + "from = \"1156\"\n");
    }
    if swapped {
        parts.reverse();
    }
    let sections: String = parts.iter().map(|p| format!("[[section]]\n{p}")).collect();
    let study = read(&format!("{head}{sections}[flutter]{tail}"));
    let (section, tested) = (coupled(&study.by_model), study.tested_range());
    let found = onset(find_onset("bridge", &section, &SEARCH, tested).unwrap());
    match study.onset_interval(&found).unwrap() {
        OnsetInterval::Known(known) => [known.parts.scatter_m_s, known.parts.form_m_s.unwrap()],
        other => panic!("{other:?}"),
    }
}

/// A girder in two parts of one table has the interval of the girder in one: what the tests leave open is open of both parts together. Of
/// parts of two tables it does not depend on which comes first, whose width the others are asked in.
#[test]
fn the_interval_does_not_depend_on_how_sections_are_written() {
    let other = Some(("LN21-6100", "25.0"));
    for (a, b) in [
        ((None, false), (Some(("LN21-5200", "31.0")), false)),
        ((other, false), (other, true)),
    ] {
        let [a, b] = [a, b].map(|(other, swapped)| parts_of_interval(other, swapped));
        (0..2).for_each(|i| near(a[i] / b[i], 1.0, 1e-3));
    }
}

/// Modes of one shape make the section; so the interval of its onset is that of the section, which takes its slopes from the
/// eigenvectors.
#[test]
fn the_interval_is_that_of_the_section() {
    let folder = tempfile::tempdir().unwrap();
    let (mut nodes, mut shapes) = (
        "node,x_m,y_m,z_m\n".to_owned(),
        "mode,node,ux,uy,uz,rx,ry,rz\n".to_owned(),
    );
    for i in 0..41 {
        let x = 25.0 * f64::from(i);
        let sine = (PI * x / 1000.0).sin();
        nodes += &format!("{},{x},0,0\n", i + 1);
        shapes += &format!("1,{},0,0,{sine},0,0,0\n2,{0},0,0,0,{sine},0,0\n", i + 1);
    }
    let modes = "mode,frequency_hz,generalised_mass_kg\n1,0.10,6e6\n2,0.30,8e8\n";
    for (name, text) in [
        ("nodes.csv", nodes.as_str()),
        ("modes.csv", modes),
        ("shapes.csv", &shapes),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let text = langenuen_text("LN21-5200", TWO, "modified_akima")
        .replace("\"embedded\"", "\"csv\"")
        .replace("\"langenuen\"", "\".\"")
        .replace(
            "damping_ratio",
            "axes = { up = \"z\", downwind = \"-y\" }\ndamping_ratio",
        );
    let file = BridgeFile::from_toml(&text, folder.path().to_path_buf()).unwrap();
    let study = BridgeStudy::new(file).unwrap();
    let found = onset(find_onset("bridge", &coupled(&study.by_model), &SEARCH, None).unwrap());
    let structure = equivalent_section(&study.by_model, &Dof::TWO).unwrap();
    let structure = structure.structure().unwrap();
    let model = study.sections[0].model.realizable().unwrap().realize();
    let section = CoupledSection::new(structure.clone(), model).unwrap();
    let of_section = onset(find_onset("section", &section, &SEARCH, None).unwrap());
    near(found.at.speed_m_s / of_section.at.speed_m_s, 1.0, 1e-8);
    let known = study.sections[0]
        .uncertainty
        .as_ref()
        .unwrap()
        .as_ref()
        .unwrap();
    let saved = &study.sections[0].saved;
    let expected = known.interval(saved, &structure, &of_section).unwrap();
    let (OnsetInterval::Known(own), OnsetInterval::Known(expected)) =
        (study.onset_interval(&found).unwrap(), expected)
    else {
        panic!("no interval");
    };
    let (a, b) = (own.parts, expected.parts);
    println!("{a:?} {b:?}");
    near(a.scatter_m_s / b.scatter_m_s, 1.0, 1e-4);
    // by the same forms
    let forms = known.forms.as_ref().unwrap();
    let search = OnsetSearch::up_to(2.0 * of_section.at.speed_m_s);
    let by_fit = |f: &AdmissibleForm| {
        let section = CoupledSection::with_model(&structure, &f.model)?;
        let found = find_onset(&f.form, &section, &search, study.tested_range())?;
        Ok(FormOnset::new(&f.form, None, &found))
    };
    let by_table = |by: &str, table: &InterpolatedTable| {
        let found = pk_onset(by, &structure, table, &search, study.tested_range())?;
        Ok(FormOnset::new(by, None, &found))
    };
    let spread = forms.spread_by(by_fit, by_table).unwrap();
    let form_m_s = spread.deviation_from_m_s(found.at.speed_m_s).unwrap();
    near(a.form_m_s.unwrap() / form_m_s, 1.0, 1e-4);
    assert!(own.low_m_s < found.at.speed_m_s);
}

/// One torsional mode alone flutters by its own damping, or not at all; nothing is followed that is not there.
#[test]
fn a_bridge_of_one_mode() {
    for deck in ["LN21-5200", "LN21-6100"] {
        let mut one = langenuen(deck, TWO).by_model;
        one.modes.retain(|mode| mode.number == 23);
        let section = coupled(&one);
        let found = find_onset("one mode", &section, &SEARCH, None).unwrap();
        let growing = |v: f64| {
            section
                .at(v)
                .unwrap()
                .eigenvalues()
                .unwrap()
                .iter()
                .any(|z| z.re > 0.0 && z.im > 0.0)
        };
        match found.onset() {
            Some(o) => assert!(growing(1.001 * o.at.speed_m_s) && !growing(0.999 * o.at.speed_m_s)),
            None => assert!((1..=100).all(|v| !growing(f64::from(v)))),
        }
    }
}
