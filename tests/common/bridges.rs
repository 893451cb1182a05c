//! Bridges of the tests.

use aerodeck::aeroelastic::CoupledSection;
use aerodeck::bridge::Bridge;
use aerodeck::files::bridge::BridgeFile;
use aerodeck::flutter::{FlutterSearch, Onset, OnsetSearch};
use aerodeck::study::bridge::BridgeStudy;
use std::path::PathBuf;

pub const SEARCH: OnsetSearch = OnsetSearch {
    speed_max_m_s: 100.0,
    speeds: 50,
};

pub fn coupled(bridge: &Bridge) -> CoupledSection {
    CoupledSection::new(bridge.structure(), bridge.forces().realize().unwrap()).unwrap()
}

pub fn onset(search: FlutterSearch) -> Onset {
    match search {
        FlutterSearch::Onset(onset) => *onset,
        other => panic!("{}", other.explain()),
    }
}

#[track_caller]
pub fn near(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{found} instead of {expected} ± {tolerance}"
    );
}

/// Names of the measured girders of the Langenuen bridge.
pub const DECKS: [&str; 5] = [
    "LN20-5500",
    "LN21-5200",
    "LN21-5500",
    "LN21-5800",
    "LN21-6100",
];

pub const TWO: &str = "[\"vertical\", \"torsion\"]";
pub const THREE: &str = "[\"vertical\", \"lateral\", \"torsion\"]";

/// Text of the bridge file of Langenuen with a measured girder.
pub fn langenuen_text(deck: &str, motions: &str, interpolation: &str) -> String {
    format!(
        "schema = 1\nname = \"Langenuen {deck}\"\nair_density_kg_m3 = 1.25\n\
         [modes]\nformat = \"embedded\"\npath = \"langenuen\"\ndamping_ratio = 0.002\n\
         [[section]]\nname = \"girder\"\nwidth_m = 31.0\nderivatives = \"{deck}\"\n\
         interpolation = \"{interpolation}\"\nmotions = {motions}\n\
         [flutter]\nspeed_max_m_s = 100.0\nspeeds = 50\n"
    )
}

pub fn read(text: &str) -> BridgeStudy {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/bridges");
    BridgeStudy::new(BridgeFile::from_toml(text, folder).unwrap()).unwrap()
}

/// Eight modes of Langenuen, well damped, with static coefficients.
pub fn lively() -> BridgeStudy {
    read(
        &(langenuen_text("LN21-5200", TWO, "modified_akima")
            .replace(
                "damping_ratio = 0.002",
                "damping_ratio = 0.02\nselect = [2, 3, 5, 12, 14, 16, 17, 23]",
            )
            .replace(
                "motions =",
                "static = { drag = 0.08, lift = -0.1, lift_slope = 4.0, moment = 0.02, moment_slope = 1.1 }\nmotions =",
            )
            + "[buffeting]\nnodes = [\"1081\", \"1156\"]\n\
               along = { spectrum = { shape = { kind = \"kaimal\" }, length_m = 150.0, intensity = 0.12 } }\n\
               vertical = { spectrum = { shape = { kind = \"kaimal\" }, length_m = 15.0, intensity = 0.06 } }\n\
               time = { records = 2, duration_s = 200.0, step_s = 0.1, seed = 3 }\n"),
    )
}

pub fn langenuen(deck: &str, motions: &str) -> BridgeStudy {
    read(&langenuen_text(deck, motions, "linear_v_hat"))
}
