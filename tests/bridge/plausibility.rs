//! Every slip of a bridge has its sentence, and the Langenuen bridge has none.

use aerodeck::aerodynamics::FlatPlate;
use aerodeck::bridge::StripGroup;
use aerodeck::bridge::{Bridge, BridgeMode, Node};
use aerodeck::bridge::{DampedPoint, Dampers, MassDamper, ViscousLink};
use aerodeck::files::bridge::tributary_lengths;
use aerodeck::files::bridge::{BridgeModes, embedded};
use aerodeck::plausibility::{
    Finding, FindingKind, FindingSeverity, of_bridge, of_modes, of_modes_left_out, of_profile,
    sentences,
};
use aerodeck::section::Dof;
use std::f64::consts::TAU;
use std::sync::Arc;

fn langenuen() -> BridgeModes {
    let mut modes = embedded::modes("langenuen").unwrap();
    modes.modes.iter_mut().for_each(|m| m.damping_ratio = 0.005);
    modes
}

fn bridge(modes: BridgeModes, width_m: f64, air_density_kg_m3: f64) -> Bridge {
    let group: StripGroup = StripGroup {
        name: "girder".into(),
        width_m,
        wind_factor: 1.0,
        nodes: (0..modes.nodes.len()).collect(),
        forces: Arc::new(FlatPlate::default()),
    };
    let BridgeModes { nodes, modes, .. } = modes;
    Bridge::new("bridge", air_density_kg_m3, nodes, modes, vec![group]).unwrap()
}

/// All findings of the bridge with these modes.
fn found(modes: BridgeModes, width_m: f64, air_density_kg_m3: f64) -> Vec<Finding> {
    let mut found = modes.findings();
    found.extend(of_bridge(&bridge(modes, width_m, air_density_kg_m3)));
    found
}

/// The one doubt about it.
fn doubt(modes: BridgeModes, width_m: f64, air_density_kg_m3: f64) -> String {
    let found = found(modes, width_m, air_density_kg_m3);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].severity, FindingSeverity::Doubt);
    found[0].to_string()
}

fn changed(change: impl Fn(&mut BridgeMode)) -> BridgeModes {
    let mut modes = langenuen();
    modes.modes.iter_mut().for_each(change);
    modes
}

#[test]
fn a_right_bridge_has_no_finding() {
    assert_eq!(
        sentences(&found(langenuen(), 31.0, 1.25)),
        Vec::<String>::new()
    );
    // shapes may be scaled at will, with the mass
    let scaled = changed(|m| {
        m.generalised_mass *= 1e-4;
        m.shape.iter_mut().flatten().for_each(|x| *x *= 1e-2);
    });
    assert!(found(scaled, 31.0, 1.25).is_empty());
}

#[test]
fn other_units_are_recognised() {
    let right = langenuen;
    assert_eq!(
        doubt(right(), 22_000.0, 1.25),
        "section girder: width_m = 22000: 0.02 to 100 m is usual; in mm it would be 22 m"
    );
    assert_eq!(
        doubt(right(), 31.0, 1250.0),
        "air_density_kg_m3 = 1250: 0.7 to 1.6 kg/m³ is usual; in g/m³ it would be 1.25 kg/m³"
    );
    let mut in_mm = right();
    in_mm.nodes.iter_mut().for_each(|n| {
        n.along_m *= 1e3;
        n.length_m *= 1e3;
    });
    assert_eq!(
        doubt(in_mm, 31.0, 1.25),
        "nodes: length = 1235000: 5 to 10000 m is usual; in mm it would be 1235 m"
    );
    assert_eq!(
        doubt(changed(|m| m.damping_ratio = 0.3), 31.0, 1.25),
        "modes.damping_ratio = 0.3: a ratio to critical damping is usually 0.0005 to 0.01; in per cent it would be 0.003"
    );
    assert!(
        sentences(&changed(|m| m.damping_ratio = 0.0126).findings())[0]
            .ends_with("as a logarithmic decrement it would be a ratio of 0.002005")
    );
    let text = doubt(changed(|m| m.frequency_hz *= TAU), 31.0, 1.25);
    assert!(text.starts_with("mode 3: frequency_hz = 0.8727"), "{text}");
    assert!(
        text.contains(
            "with half waves of 412 m 0.03644 to 0.6073 Hz is usual; in rad/s it would be 0.1389 Hz"
        ),
        "{text}"
    );
    let text = doubt(changed(|m| m.generalised_mass *= 1e-3), 31.0, 1.25);
    assert!(
        text.contains("in t it would be 1.71e4 kg/m")
            || text.contains("in t it would be 17100 kg/m"),
        "{text}"
    );
    let text = doubt(changed(|m| m.generalised_mass *= 9.81), 31.0, 1.25);
    assert!(
        text.starts_with("mode 23: frequency_hz = 0.3963: with these masses and frequencies (")
            && text.contains("above 200 m/s as no deck of 31 m"),
        "{text}"
    );
    let text = doubt(right(), 15.5, 1.25);
    assert!(
        text.contains("radius of gyration of 0.721 widths")
            && text.ends_with(
                "were width_m the semi-chord, B would be 31 m and this would be 0.360 widths"
            ),
        "{text}"
    );
}

/// Rotations in degrees, whatever the norm of the shapes.
#[test]
fn rotations_in_degrees_are_recognised() {
    for norm in [1.0, 1e-3] {
        let wrong = changed(|m| {
            for s in &mut m.shape {
                *s = [norm * s[0], norm * s[1], norm * s[2].to_degrees()];
            }
            m.generalised_mass *= norm * norm;
        });
        let all = sentences(&found(wrong, 31.0, 1.25));
        assert!(
            all.iter().any(|t| t.starts_with("mode 23: rotations: ")
                && t.ends_with("were they in degrees, it would be 0.360 widths")),
            "{all:?}"
        );
    }
}

#[test]
fn a_mode_given_twice_is_recognised() {
    let mut modes = langenuen();
    let mut again = modes.modes[22].clone();
    again.number = 40;
    again.frequency_hz *= 1.002;
    // in another norm, turned over
    again.generalised_mass *= 4.0;
    again.shape.iter_mut().flatten().for_each(|x| *x *= -2.0);
    modes.modes.push(again);
    let text = doubt(modes, 31.0, 1.25);
    assert!(
        text.starts_with(
            "mode 40: it has the shape and the mass of mode 23 (0.3971 and 0.3963 Hz)"
        ),
        "{text}"
    );
}

#[test]
fn a_mass_of_one_belongs_to_a_mass_normalised_shape() {
    let text = sentences(&changed(|m| m.generalised_mass = 1.0).findings()).join("\n");
    assert!(
        text.contains("is the mass that of a shape of another norm?"),
        "{text}"
    );
    let turned = |m: &mut BridgeMode| m.shape.iter_mut().for_each(|s| s[2] = 40.0);
    let text = sentences(&changed(turned).findings()).join("\n");
    assert!(text.contains("in degrees it would be 0.6981 rad"), "{text}");
}

/// A straight or circular girder of `length_m`, its ends turned by `end_deg` from the chord, and the chord by `skew_deg` from the axis.
fn girder_findings(length_m: f64, end_deg: f64, skew_deg: f64) -> Vec<Finding> {
    let (sin, cos) = skew_deg.to_radians().sin_cos();
    let places: Vec<[f64; 2]> = (0..=40)
        .map(|i| {
            let part = f64::from(i) / 20.0 - 1.0;
            // of a circular arc
            let turn = end_deg.to_radians();
            let (x, y) = if turn == 0.0 {
                (0.5 * length_m * part, 0.0)
            } else {
                let radius = 0.5 * length_m / turn.sin();
                let at = turn * part;
                (radius * at.sin(), radius * (at.cos() - turn.cos()))
            };
            [cos * x - sin * y, sin * x + cos * y]
        })
        .collect();
    let along: Vec<f64> = places.iter().map(|p| p[0]).collect();
    let lengths = tributary_lengths(&along);
    let nodes: Vec<Node> = along
        .iter()
        .zip(lengths)
        .map(|(along_m, length_m)| Node {
            name: String::new(),
            along_m: *along_m,
            length_m,
        })
        .collect();
    let offsets_m: Vec<[f64; 2]> = places.iter().map(|p| [p[1], 30.0]).collect();
    of_modes(&nodes, &offsets_m, &[])
}

#[test]
fn axes_are_compared_with_the_line_of_the_nodes() {
    assert!(girder_findings(1235.0, 0.0, 0.0).is_empty());
    assert!(girder_findings(1235.0, 0.5, 1.0).is_empty());
    let skew = girder_findings(1235.0, 0.0, 30.0);
    assert_eq!(skew.len(), 1, "{skew:?}");
    assert_eq!(
        (skew[0].kind, skew[0].severity),
        (FindingKind::Axes, FindingSeverity::Doubt)
    );
    assert_eq!(
        skew[0].to_string(),
        "modes.axes.downwind: the line of the nodes is turned by 30.0° from the girder axis up × downwind, so that lengths are \
         taken 13.4 % too short and motions of the girder are mixed; the wind square to the nodes blows 30.0° from the stated \
         direction"
    );
    assert_eq!(
        girder_findings(1235.0, 0.0, 3.0)[0].severity,
        FindingSeverity::Note
    );
    let curved = girder_findings(400.0, 20.0, 0.0);
    assert_eq!(curved.len(), 1, "{curved:?}");
    // the rise of an arc over half its chord is tan(10°)
    let rise = 200.0 * 10f64.to_radians().tan();
    let text = curved[0].to_string();
    assert!(
        text.starts_with(&format!(
            "nodes: the nodes leave a straight line in plan by {rise:.2} m, 8.8 % of its length"
        )),
        "{text}"
    );
    assert_eq!(
        girder_findings(400.0, 3.0, 0.0)[0].severity,
        FindingSeverity::Note
    );
}

/// Shapes without rotations or without vertical displacements look safe in every wind.
#[test]
fn a_bridge_that_turns_or_bends_nowhere_is_doubted_once() {
    for (motion, expected) in [
        (
            2,
            "modes: none of the modes is mainly torsional; more of them may have to be exported, rotations with them, in radians",
        ),
        (
            0,
            "modes: none of the modes is mainly vertical; more of them may have to be exported, vertical displacements with them, in m",
        ),
    ] {
        let still = changed(|m| {
            for s in &mut m.shape {
                // each mode moves somehow
                s[1] += 1e-3;
                s[motion] *= 1e-5;
            }
        });
        let bridge = bridge(still, 31.0, 1.25);
        let said = of_modes_left_out(&bridge, &[]);
        assert_eq!(sentences(&said), [expected]);
        assert_eq!(said[0].severity, FindingSeverity::Doubt);
        // where the file has such modes, the selection is what is odd
        let said = sentences(&of_modes_left_out(&bridge, &langenuen().modes));
        assert_eq!(said.len(), 1, "{said:?}");
        assert!(said[0].starts_with("modes.select: "), "{said:?}");
    }
    // a few modes of which no torsional one is there, and rotations × π/180 once too often
    let mut few = langenuen();
    few.modes.truncate(10);
    let small = changed(|m| m.shape.iter_mut().for_each(|s| s[2] = s[2].to_radians()));
    for modes in [few, small] {
        let said = of_modes_left_out(&bridge(modes, 31.0, 1.25), &[]);
        assert!(said[0].text == "none of the modes is mainly torsional");
    }
    let right = bridge(langenuen(), 31.0, 1.25);
    assert!(of_modes_left_out(&right, &[]).is_empty());
    let null = changed(|m| m.shape.iter_mut().for_each(|s| *s = [0.0; 3]));
    assert_eq!(right.main_motion(&null.modes[0]), None);
    let doubts = sentences(&null.findings());
    assert!(
        doubts
            .iter()
            .any(|d| d.contains("mode 1: it moves no node")),
        "{doubts:?}"
    );
}

#[test]
fn lengths_of_girder_are_compared_with_the_places_of_the_nodes() {
    let times = |factor: f64| {
        let mut modes = langenuen();
        modes.nodes.iter_mut().for_each(|n| n.length_m *= factor);
        sentences(&modes.findings())
    };
    assert!(times(1.03).is_empty());
    assert_eq!(
        times(0.5),
        [
            "nodes: lengths of girder at the nodes (length_m) add up to 617.5 m, where their places (along_m) reach over 1235 m; \
             wind forces grow with the lengths"
        ]
    );
    // strips of full length at both ends
    let mut modes = langenuen();
    let last = modes.nodes.len() - 1;
    modes.nodes[0].length_m *= 2.0;
    modes.nodes[last].length_m *= 2.0;
    assert!(modes.findings().is_empty());
}

#[test]
fn a_wind_profile_beyond_the_girder_is_doubted() {
    let nodes = langenuen().nodes;
    for right in [&[][..], &[0.0], &[-9000.0, 9000.0], &[600.0, 9000.0]] {
        assert_eq!(of_profile(right, &nodes), None, "{right:?}");
    }
    for wrong in [&[5000.0, 6000.0][..], &[-5000.0, -700.0], &[700.0]] {
        let found = of_profile(wrong, &nodes).unwrap();
        assert_eq!(found.severity, FindingSeverity::Doubt);
        let text = found.to_string();
        let end = "wholly beyond the girder from -617.5 to 617.5 m";
        assert!(
            text.starts_with("wind.profile: ") && text.contains(end),
            "{text}"
        );
    }
}

/// Dampers as they are built have no finding; masses, ratios, arms and coefficients that are not, and what nothing moves, have one each.
#[test]
fn dampers_are_compared_with_the_modes() {
    let plain = bridge(langenuen(), 31.0, 1.25);
    let middle = plain.nodes.len() / 2;
    let torsion = plain
        .modes
        .iter()
        .max_by(|a, b| {
            a.shape[middle][2]
                .abs()
                .total_cmp(&b.shape[middle][2].abs())
        })
        .unwrap()
        .frequency_hz;
    let point = |offset_m| DampedPoint {
        node: middle,
        motion: Dof::Vertical,
        offset_m,
    };
    let good = MassDamper {
        name: "damper 1".into(),
        at: point(12.0),
        mass_kg: 1e4,
        frequency_hz: torsion,
        damping_ratio: 0.1,
    };
    let link = |to, coefficient| ViscousLink {
        name: "link 1".into(),
        at: point(0.0),
        to,
        coefficient,
    };
    let said = |masses: &[MassDamper], links: &[ViscousLink]| {
        let (masses, links) = (masses.to_vec(), links.to_vec());
        let dampers = Dampers { masses, links };
        sentences(&of_bridge(&plain.clone().with_dampers(dampers).unwrap()))
    };
    assert_eq!(
        said(std::slice::from_ref(&good), &[link(None, 1e5)]),
        [""; 0]
    );
    let changed = |change: fn(&mut MassDamper)| {
        let mut damper = good.clone();
        change(&mut damper);
        damper
    };
    for (damper, words) in [
        (changed(|d| d.mass_kg = 1e7), "damper 1: mass_kg"),
        (
            changed(|d| d.damping_ratio = 10.0),
            "in per cent it would be 0.1",
        ),
        (
            changed(|d| d.at.offset_m = 12_000.0),
            "in millimetres it would be 12 m",
        ),
        (changed(|d| d.frequency_hz *= 100.0), "tuned to no mode"),
    ] {
        let said = said(&[damper], &[]);
        assert!(said.iter().any(|s| s.contains(words)), "{words}: {said:?}");
    }
    assert!(said(&[], &[link(Some(point(0.0)), 1e5)])[0].contains("damps nothing"));
    assert!(said(&[], &[link(None, 1e12)])[0].starts_with("link 1: coefficient"));
}
