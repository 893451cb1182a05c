//! What is stated of the wind and of the forces of a section.

use crate::files::{study, tables, text};
use aerodeck::aerodynamics::derivatives::notation::{Argument, Axes, Convention, Notation};
use aerodeck::aerodynamics::{FlatPlate, Transfer as _};
use aerodeck::bridge::Bridge;
use aerodeck::files::derivatives::{embedded, write_csv_in};
use aerodeck::study::bridge::BridgeStudy;
use aerodeck::units::ReducedFrequency;
use std::fs;
use tempfile::TempDir;

/// Wind from the other side: the same girder counted from its other end, sway and rotation turned round.
#[test]
fn wind_from_the_other_side_takes_the_nodes_in_reverse() {
    let folder = TempDir::new().unwrap();
    tables(folder.path());
    let one = study(folder.path(), &text("csv", "")).unwrap();
    let other = text("csv", "").replace("\"-y\"", "\"y\"");
    let other = study(folder.path(), &other).unwrap();
    let said: Vec<String> = other.findings.iter().map(ToString::to_string).collect();
    let turned = "nodes: taken in the opposite order, since places along the girder";
    assert!(said.iter().any(|t| t.starts_with(turned)), "{said:?}");
    assert_eq!(one.findings.len() + 1, said.len());
    let (one, other) = (one.by_model, other.by_model);
    let places = |bridge: &Bridge| bridge.nodes.iter().map(|n| n.along_m).collect::<Vec<_>>();
    assert_eq!(places(&one), [0.0, 30.0, 70.0, 100.0]);
    assert_eq!(places(&other), [-100.0, -70.0, -30.0, 0.0]);
    assert_eq!((&*other.nodes[0].name, &*other.nodes[3].name), ("14", "11"));
    for (a, b) in one.modes.iter().zip(&other.modes) {
        for (a, b) in a.shape.iter().zip(b.shape.iter().rev()) {
            assert_eq!([a[0], -a[1], -a[2]], *b);
        }
    }
}

/// A table that does not state its notation takes it from the section; the plate needs no table.
#[test]
fn forces_of_a_section_by_a_stated_convention_and_by_theory() {
    let folder = TempDir::new().unwrap();
    tables(folder.path());
    let deck = embedded::deck("LN21-5200").unwrap();
    let mut written = Vec::new();
    let (notation, argument, axes) = (Notation::Polimi, Argument::VStar, Axes::HeaveUp);
    let convention = Convention {
        notation,
        argument,
        axes,
    };
    write_csv_in(&deck, &convention, &mut written).unwrap();
    let bare: Vec<&str> = std::str::from_utf8(&written)
        .unwrap()
        .lines()
        .filter(|l| {
            !["# notation", "# argument", "# axes", "# definition"]
                .iter()
                .any(|h| l.starts_with(h))
        })
        .collect();
    fs::write(folder.path().join("bare.csv"), bare.join("\n")).unwrap();
    let with = |forces: &str| {
        let statics = "static = { lift_slope = 4.0, moment_slope = 1.0 }";
        study(folder.path(), &text("csv", "").replace(statics, forces))
    };
    let at = |study: BridgeStudy| {
        let k = ReducedFrequency::from_full_width(0.5);
        study.by_table.unwrap().groups[0]
            .forces
            .transfer(k)
            .unwrap()
    };
    let message = with("derivatives = \"bare.csv\"")
        .err()
        .unwrap()
        .to_string();
    assert!(
        message.contains("notation: expected it stated"),
        "{message}"
    );
    let stated = "derivatives = \"bare.csv\"\nconvention = { notation = \"polimi\", argument = \"v_star\", axes = \"heave_up\" }";
    let (found, expected) = (
        at(with(stated).unwrap()),
        at(with("derivatives = \"LN21-5200\"").unwrap()),
    );
    assert!(
        (&found - &expected).norm() < 1e-9 * expected.norm(),
        "{found} {expected}"
    );
    let plate = FlatPlate::default();
    let expected = plate
        .transfer(ReducedFrequency::from_full_width(0.5))
        .unwrap();
    assert_eq!(at(with("derivatives = \"flat plate\"").unwrap()), expected);
}

/// One bridge, whichever of its sections is listed first and whichever wind it is referred to: tests of K 0.96 tell of slow wind, and
/// those that end at 0.72 do not, 0.87 of a reference wind though it may be.
#[test]
fn a_verdict_asks_of_no_order_and_of_no_reference_wind() {
    let section = |name: &str, width: f64, part: &str| {
        format!(
            "[[section]]\nname = \"{name}\"\nwidth_m = {width}\nderivatives = \"LN21-5200\"\n\
             motions = [\"vertical\", \"torsion\"]\n{part}\n"
        )
    };
    let head = "schema = 1\nname = \"L\"\nair_density_kg_m3 = 1.25\n[modes]\nformat = \"embedded\"\npath = \"langenuen\"\n\
                damping_ratio = 0.002\nselect = [2, 3, 5, 12, 14, 16, 17, 23]\n";
    let judged = |sections: &str, rest: &str| {
        let study = crate::bridges::read(&format!("{head}{sections}{rest}"));
        let verdict = study.verdict().unwrap();
        (verdict.outcome.unwrap().words(), verdict.explanation)
    };
    let (narrow, wide) = (
        section("a", 25.5, "to = \"1081\""),
        section("b", 31.0, "from = \"1086\""),
    );
    let search = "[flutter]\nspeed_max_m_s = 110\nrequired_speed_m_s = 50\n";
    for sections in [format!("{narrow}{wide}"), format!("{wide}{narrow}")] {
        let (words, why) = judged(&sections, search);
        assert_eq!(words, "MET", "{why}");
    }
    let lower = "[wind]\nprofile = [{ along_m = 0, factor = 0.8 }]\n[flutter]\nspeed_max_m_s = 140\nrequired_speed_m_s = 62.5\n";
    let (words, why) = judged(&section("a", 31.0, ""), lower);
    assert_eq!(words, "MET", "{why}");
}
