//! `[[damper]]` in bridge files.

use crate::bridges::{TWO, langenuen_text};
use aerodeck::files::bridge::BridgeFile;
use aerodeck::study::bridge::BridgeStudy;
use std::path::PathBuf;

/// File, line, key, what was expected and what was found.
#[test]
fn wrong_dampers_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path: PathBuf = folder.path().join("bridge.toml");
    let good = "[[damper]]\nnode = \"1156\"\nmotion = \"vertical\"\nmass_kg = 1e4\nfrequency_hz = 0.3\ndamping_ratio = 0.1\n";
    let plain = langenuen_text("LN21-5200", TWO, "linear_v_hat");
    let line = plain.lines().count() + 2;
    let refused = |text: &str, at: usize, expected: &str| {
        std::fs::write(&path, format!("{plain}{text}")).unwrap();
        let error = BridgeFile::read(&path)
            .and_then(BridgeStudy::new)
            .unwrap_err();
        let whole = format!(
            "{}: line {}{expected}",
            path.display(),
            line.wrapping_add(at)
        );
        assert!(
            error.to_string().starts_with(&whole),
            "{error}\nnot\n{whole}"
        );
    };
    refused(
        &good.replace("1156", "7"),
        0,
        ", damper[0].node: expected a node of the bridge, 1001 to 1311; next to it are 1001 and 1006, found `7`",
    );
    refused(
        &good.replace("1e4", "-1e4"),
        2,
        ", damper[0].mass_kg: expected a positive number, found -10000",
    );
    refused(
        &good.replace("\"vertical\"", "\"sideways\""),
        1,
        ": expected a bridge file (unknown variant `sideways`",
    );
    refused(
        &good.replace("mass_kg", "weight_kg"),
        2,
        ": expected a bridge file (unknown field `weight_kg`",
    );
    refused(
        &good.replace("mass_kg", "coefficient"),
        3,
        ", damper[0].frequency_hz: expected none beside the `coefficient` of a link, found one",
    );
    refused(
        &good.replace("\"vertical\"", "\"torsion\""),
        -1_isize as usize,
        ", damper[0].arm_m: expected the distance of both halves of the mass from the axis, found none",
    );
    let link =
        "[[damper]]\nnode = \"1156\"\nmotion = \"vertical\"\ncoefficient = 1e4\nto = \"x\"\n";
    refused(
        link,
        3,
        ", damper[0].to: expected a node of the bridge, 1001 to 1311, found `x`",
    );
    refused(
        &good.replace("mass_kg", "to = \"1157\"\nmass_kg"),
        2,
        ", damper[0].to: expected none: only links, of a `coefficient`, have two ends, found one",
    );
}
