//! A bridge of sections with force models of their own.

use crate::bridges::{THREE, TWO, langenuen_text, read};
use aerodeck::study::bridge::BridgeStudy;

/// Langenuen in a wind profile with sections of every kind of forces: filters of a girder, fewer of another in three motions, lags of a
/// model on file, the flat plate, static coefficients; node 1301 is in no section.
pub fn patchwork() -> BridgeStudy {
    let one = langenuen_text("LN21-5200", TWO, "linear_v_hat");
    let (before, rest) = one.split_once("[[section]]").unwrap();
    let (_, after) = rest.split_once("[flutter]").unwrap();
    let statics = "static = { drag = 0.08, lift = -0.1, lift_slope = 4.0, moment = 0.02, moment_slope = 1.1 }\n";
    let section = |name: &str, width: f64, ends: &str, forces: &str| {
        format!("[[section]]\nname = \"{name}\"\nwidth_m = {width}\n{ends}\n{statics}{forces}\n")
    };
    let girder = |deck: &str, motions: &str| {
        format!("derivatives = \"{deck}\"\ninterpolation = \"linear_v_hat\"\nmotions = {motions}")
    };
    let sections = [
        section(
            "east",
            31.5,
            "from = \"1211\"\nto = \"1281\"",
            "model = \"../models/rational.json\"",
        ),
        section(
            "west side",
            31.0,
            "to = \"1051\"",
            &girder("LN21-5200", TWO),
        ),
        section(
            "middle",
            31.0,
            "from = \"1056\"\nto = \"1206\"",
            &format!("{}\nfilters = 2", girder("LN21-5500", THREE)),
        ),
        section(
            "fairing",
            30.5,
            "from = \"1286\"\nto = \"1296\"",
            "derivatives = \"flat plate\"",
        ),
        section("end", 30.0, "from = \"1306\"", ""),
    ];
    let profile = "[wind]\nprofile = [{ along_m = -617.5, factor = 0.9 }, { along_m = 617.5, factor = 1.0 }]\n";
    read(&format!(
        "{before}{}{profile}[flutter]{after}",
        sections.concat()
    ))
}
