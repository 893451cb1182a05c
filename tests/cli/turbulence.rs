//! Turbulence that a study states.

use crate::bridge::folder;
use crate::command::{aerodeck, flowing, listing, succeeds};
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
    let speeds: Vec<f64> = (0..17).map(|i| 10.0 + 0.25 * f64::from(i)).collect();
    let speeds = format!("{speeds:?}");
    let gusts = format!("{study}[buffeting]\nspeeds_m_s = {speeds}\n[buffeting.{turbulence}");
    fs::write(at.join("gusts.toml"), &gusts).unwrap();
    let text = succeeds(at, &["study", "gusts.toml", "--out", "r"]);
    assert!(text.contains("\nGusts     RMS at 14 m/s: y "), "{text}");
    let extrapolated = "variance inside the tested range of K: ";
    assert!(flowing(&text).contains(extrapolated), "{text}");
    let page = fs::read_to_string(at.join("r/report.html")).unwrap();
    assert!(page.contains("Response to turbulence") && page.contains("expected peak"));
    assert!(page.contains(extrapolated));
    assert!(page.contains("The table has 9 of 17 wind speeds, buffeting.json all."));
    let of_study: Value =
        serde_json::from_str(&fs::read_to_string(at.join("r/buffeting.json")).unwrap()).unwrap();
    let wind = format!(
        "schema = 1\nname = \"w\"\naerodynamics = \"r/model.json\"\n[speeds]\nspeed_min_m_s = 10\nspeed_max_m_s = 14\nspeeds = 17\n[{turbulence}"
    );
    fs::write(at.join("wind.toml"), wind).unwrap();
    let told = succeeds(at, &["buffeting", "wind.toml", "--json"]);
    let told: Value = serde_json::from_str(&told).unwrap();
    assert_eq!(of_study["responses"], told["buffeting"]["responses"]);

    // what was found at other speeds goes with them, and all of it with the turbulence
    let uneven = gusts.replace(&speeds, &format!("[{}]", 40.0 / 3.0));
    fs::write(at.join("gusts.toml"), uneven).unwrap();
    let text = succeeds(at, &["study", "gusts.toml", "--out", "r", "--force"]);
    assert!(text.contains("\nGusts     RMS at 13.33 m/s: y "), "{text}");
    let names = || listing(&at.join("r")).into_iter();
    let of_gusts = names().filter(|n| n.starts_with("buffeting_spectra"));
    assert_eq!(
        of_gusts.collect::<Vec<_>>(),
        ["buffeting_spectra_13.33.svg"]
    );
    succeeds(at, &["study", "study.toml", "--out", "r", "--force"]);
    assert!(!names().any(|n| n.starts_with("buffeting")));

    let fast = gusts.replace(&speeds, "[500.0]");
    fs::write(at.join("gusts.toml"), fast).unwrap();
    let (code, said, _) = aerodeck(at, &["study", "gusts.toml", "--out", "fast", "--json"]);
    assert_eq!(code, 1, "{said}");
    let [plain, mut fast]: [Value; 2] = [&plain, &said].map(|t| serde_json::from_str(t).unwrap());
    assert_eq!(plain["onsets"], fast["onsets"]);
    // the failure is a note of the verdict, which else stays as it is
    let doubts = fast["verdict"]["doubts"].as_array_mut().unwrap();
    let note = doubts.iter().position(|d| d["kind"] == "stage_failed");
    assert_eq!(doubts.remove(note.unwrap())["severity"], "minor");
    assert_eq!(plain["verdict"], fast["verdict"]);
    assert_eq!(fast["failed"][0]["stage"], "buffeting");
    let page = fs::read_to_string(at.join("fast/report.html")).unwrap();
    assert!(page.contains("FAILED buffeting: "));
    succeeds(at, &["new", "--deck", "LN21-5800", "--out", "sway.toml"]);
    let sway = fs::read_to_string(at.join("sway.toml")).unwrap();
    let sway = sway.replace("# lateral =", "lateral =");
    fs::write(
        at.join("sway.toml"),
        format!("{sway}[buffeting.{turbulence}"),
    )
    .unwrap();
    let (_, said, _) = aerodeck(at, &["study", "sway.toml", "--out", "sway", "--no-figures"]);
    let why = "coefficients: expected `[coefficients]` with drag";
    assert!(flowing(&said).contains(why), "{said}");
}

/// A response to turbulence, made or of a file, begins with the verdict that the flutter of the bridge has.
#[test]
fn a_requirement_is_judged_beside_the_response_of_a_bridge() {
    let folder = folder();
    let file = folder.path().join("bridge.toml");
    let text = fs::read_to_string(&file)
        .unwrap()
        .replace(
            "motions =",
            "static = { drag = 0.08, lift_slope = 4.0, moment_slope = 1.1 }\nmotions =",
        )
        .replace("[flutter]", "[flutter]\nrequired_speed_m_s = 90.0");
    let block = "[buffeting]\nnodes = [\"1081\"]\n\
         vertical = { spectrum = { shape = { kind = \"kaimal\" }, length_m = 15.0, intensity = 0.06 }, admittance = { kind = \"liepmann\" } }\n\
         time = { records = 2, duration_s = 20.0, step_s = 0.1, seed = 3 }\n";
    fs::write(&file, text + block).unwrap();
    let run = ["bridge", "buffeting", "bridge.toml", "--speed", "30"];
    for more in [&["--field"][..], &["--turbulence", "turbulence.csv"]] {
        let (code, said, error) = aerodeck(folder.path(), &[&run[..], more].concat());
        assert!(
            said.contains(": ✗ NOT MET, required 90 m/s"),
            "{said}{error}"
        );
        assert_eq!(code, 3);
    }
    // the record is a part of one period of the slowest mode, here also in km/h, and an FMU of it has another admittance
    let field = fs::read_to_string(folder.path().join("turbulence.csv")).unwrap();
    let in_km_h = |line: &str| match line.split_once(',') {
        Some((time, gusts)) if time.parse::<f64>().is_ok() => {
            let each = gusts.split(',').map(|x| 3.6 * x.parse::<f64>().unwrap());
            let each: Vec<String> = each.map(|x| x.to_string()).collect();
            format!("{time},{}\n", each.join(","))
        }
        _ => format!("{line}\n"),
    };
    let fast: String = field.lines().map(in_km_h).collect();
    fs::write(folder.path().join("km_h.csv"), fast).unwrap();
    let told = [&run[..], &["--turbulence", "km_h.csv", "--json"]].concat();
    let (_, said, _) = aerodeck(folder.path(), &told);
    for part in ["does not come into motion in it", "in km/h it would be"] {
        assert!(said.contains(part), "`{part}` is not in {said}");
    }
    let export = [
        "fmu",
        "export",
        "bridge.toml",
        "--bridge",
        "--turbulence",
        "turbulence.csv",
    ];
    let (_, _, warned) = aerodeck(folder.path(), &export);
    let part = "the admittance none on u and w, where [buffeting] states liepmann for w";
    assert!(warned.contains(part), "{warned}");
    let (_, _, warned) = aerodeck(
        folder.path(),
        &[&export[..], &["--admittance", "liepmann", "--force"]].concat(),
    );
    assert!(!warned.contains("where [buffeting] states"), "{warned}");
    let page = fs::read_to_string(folder.path().join("buffeting.html")).unwrap();
    for part in [
        "<section class=\"card not-met\">",
        "✗ NOT MET, required 90 m/s",
        "With any of these nothing is met",
        "variance inside the tested range of K: ",
        "their RMS differs from that of the tables by up to",
        "time domain: 2 records of 20 s, every 0.1 s, seed 3",
    ] {
        assert!(page.contains(part), "`{part}` is not on the page");
    }
}
