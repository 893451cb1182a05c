//! Turbulence that a study states.

use crate::command::{aerodeck, flowing, succeeds};
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

/// A study that states turbulence has the response of the command on a wind file with its model, in its report too; one whose
/// turbulence has no answer keeps everything else.
#[test]
fn a_study_states_its_turbulence() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["new", "--deck", "flat plate"]);
    let plain = succeeds(at, &["study", "study.toml", "--out", "plain", "--json"]);
    let study = fs::read_to_string(at.join("study.toml")).unwrap();
    let turbulence = "turbulence.vertical]\nspectrum = { shape = { kind = \"von_karman\" }, length_m = 20.0, intensity = 0.05 }\n\
                      admittance = { kind = \"sears\" }\n";
    let gusts = format!("{study}[buffeting]\nspeeds_m_s = [10.0, 14.0]\n[buffeting.{turbulence}");
    fs::write(at.join("gusts.toml"), &gusts).unwrap();
    let text = succeeds(at, &["study", "gusts.toml", "--out", "r"]);
    assert!(text.contains("\nGusts     RMS at 14 m/s: y "), "{text}");
    let extrapolated = "variance inside the tested range of K: ";
    assert!(flowing(&text).contains(extrapolated), "{text}");
    let page = fs::read_to_string(at.join("r/report.html")).unwrap();
    assert!(page.contains("Response to turbulence") && page.contains("expected peak"));
    assert!(page.contains(extrapolated));
    let of_study: Value =
        serde_json::from_str(&fs::read_to_string(at.join("r/buffeting.json")).unwrap()).unwrap();
    let wind = format!(
        "schema = 1\nname = \"w\"\naerodynamics = \"r/model.json\"\n[speeds]\nspeed_min_m_s = 10\nspeed_max_m_s = 14\nspeeds = 2\n[{turbulence}"
    );
    fs::write(at.join("wind.toml"), wind).unwrap();
    let told = succeeds(at, &["buffeting", "wind.toml", "--json"]);
    let told: Value = serde_json::from_str(&told).unwrap();
    assert_eq!(of_study["responses"], told["buffeting"]["responses"]);

    let fast = gusts.replace("[10.0, 14.0]", "[500.0]");
    fs::write(at.join("gusts.toml"), fast).unwrap();
    let (code, said, _) = aerodeck(at, &["study", "gusts.toml", "--out", "fast", "--json"]);
    assert_eq!(code, 1, "{said}");
    let [plain, fast]: [Value; 2] = [&plain, &said].map(|t| serde_json::from_str(t).unwrap());
    assert_eq!(plain["onsets"], fast["onsets"]);
    assert_eq!(plain["verdict"], fast["verdict"]);
    assert_eq!(fast["failed"][0]["stage"], "buffeting");
}
