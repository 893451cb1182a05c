//! What the program says of a required speed, from file to exit code: whole bridges, and exports.

use crate::bridge::folder;
use crate::command::{aerodeck, flowing, succeeds};
use crate::report::fmu_page;
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

/// The verdict of the bridge of the folder after a change of its file, and the exit code.
fn verdict_after(change: impl Fn(String) -> String) -> (Option<i32>, Value) {
    let folder = folder();
    let file = folder.path().join("bridge.toml");
    fs::write(&file, change(fs::read_to_string(&file).unwrap())).unwrap();
    let run = ["bridge", "flutter", "bridge.toml", "--no-figures", "--json"];
    let (code, said, error) = aerodeck(folder.path(), &run);
    let value: Value = serde_json::from_str(&said).expect(&error);
    (Some(code), value["verdict"].clone())
}

/// Whether something is met depends on what is required, and not on the range in which it was to be looked for.
#[test]
fn a_search_that_ends_early_is_no_answer() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["new", "--deck", "LN21-6100", "--out", "s.toml"]);
    let judged = |keys: &[String]| {
        let mut line = vec!["study", "s.toml", "--no-figures", "--json", "--force"];
        line.extend(keys.iter().flat_map(|key| ["--set", key]));
        let (code, said, error) = aerodeck(at, &line);
        let value: Value = serde_json::from_str(&said).expect(&error);
        (code, value["verdict"].clone())
    };
    let searched_to = |v: f64| format!("flutter.speed_max_m_s={v:?}");
    let required = |v: f64| format!("flutter.required_speed_m_s={v:?}");
    let (_, early) = judged(&[searched_to(24.0)]);
    assert_eq!(early["suggested_m_s"], 12.0, "{early:#}");
    // an interval of 15.2 to 36.8 m/s, seen or not
    let wide = judged(&[required(12.9), searched_to(74.0)]);
    assert_eq!(wide.0, 0, "{:#}", wide.1);
    let says = wide.1["headline"].as_str().unwrap();
    assert!(says.contains("onset 26.0 m/s ± 41 %, 15.2–36.8"), "{says}");
    assert_eq!(judged(&[required(12.9), searched_to(12.9)]), wide);
    // just above the onset of 26.0
    let (_, just) = judged(&[searched_to(26.1)]);
    assert!(just["suggested_m_s"].as_f64().unwrap() > 15.0, "{just:#}");
}

/// A bridge without flutter that diverges meets no requirement above that; the search reaches the requirement.
#[test]
fn divergence_of_a_bridge_without_flutter_is_not_met() {
    let (code, verdict) = verdict_after(|text| {
        text.replace(
            "\"LN21-5200\"\ninterpolation",
            "\"flat plate\"\ninterpolation",
        )
        .replace("damping_ratio = 0.002", "damping_ratio = 0.5")
        .replace("[flutter]", "[flutter]\nrequired_speed_m_s = 200.0")
    });
    let headline = verdict["headline"].as_str().unwrap();
    let (start, end) = (
        "✗ NOT MET, required 200 m/s: static divergence at",
        "no flutter up to 400",
    );
    assert!(
        headline.starts_with(start) && headline.contains(end),
        "{headline}"
    );
    assert_eq!(
        (code, &verdict["outcome"]["below"]),
        (Some(3), &"best_estimate".into())
    );
    assert_eq!(verdict["critical"]["governs"]["phenomenon"], "divergence");
}

/// The few tested nodes of a girder do not answer for the rest of it.
#[test]
fn a_girder_that_is_hardly_tested_is_not_met() {
    let (code, verdict) = verdict_after(|text| {
        let tested = "name = \"girder\"\nto = \"1011\"";
        let rest = "[[section]]\nname = \"rest\"\nfrom = \"1016\"\nwidth_m = 31.0\nderivatives = \"flat plate\"\n\n";
        text.replace("name = \"girder\"", tested).replace(
            "[flutter]",
            &format!("{rest}[flutter]\nrequired_speed_m_s = 60.0"),
        )
    });
    assert_eq!((code, state(&verdict)), (Some(3), "cannot_be_judged"));
    let untested = doubt(&verdict, "untested").unwrap();
    let text = untested["text"].as_str().unwrap();
    assert!(
        text.starts_with("The forces of section rest (")
            && text.contains(
                "are those of Jones's rational functions of the flat plate, which no test of this deck confirms; the onset by the \
                 models is at "
            )
            && text.contains(", with the forces of section girder there at "),
        "{text}"
    );
    assert_eq!(untested["severity"], "severe");
}

/// Without its torsional modes a bridge has no flutter, and meets nothing by that.
#[test]
fn a_bridge_without_its_torsional_modes_is_not_met() {
    let (code, verdict) = verdict_after(|text| {
        text.replace("[2, 3, 5, 12, 14, 16, 17, 23]", "[2, 3, 5, 12, 14, 16]")
            .replace("[flutter]", "[flutter]\nrequired_speed_m_s = 60.0")
    });
    assert_eq!((code, state(&verdict)), (Some(3), "cannot_be_judged"));
    let text = doubt(&verdict, "implausible_input").unwrap()["text"].clone();
    let text = text.as_str().unwrap();
    assert!(text.contains("torsional"), "{text}");
}

/// The search goes on beyond what is required, and a mode that is left out counts by what it does to the onset.
#[test]
fn a_bridge_without_one_of_its_modes_is_judged_with_all() {
    let (code, verdict) = verdict_after(|text| {
        text.replace("[2, 3, 5, 12, 14, 16, 17, 23]", "[1, 2, 3, 23]")
            .replace("[flutter]", "[flutter]\nrequired_speed_m_s = 100.0")
    });
    assert_eq!((code, state(&verdict)), (Some(3), "cannot_be_judged"));
    let left_out = doubt(&verdict, "modes_left_out").unwrap();
    let text = left_out["text"].as_str().unwrap();
    assert!(
        text.starts_with("35 modes of the file are left out;"),
        "{text}"
    );
    assert_eq!(left_out["severity"], "severe");
}

/// Nodes that no section takes have no forces, and that is said.
#[test]
fn nodes_in_no_section_are_doubted() {
    let (code, verdict) = verdict_after(|text| {
        text.replace("name = \"girder\"", "name = \"girder\"\nto = \"1151\"")
            .replace("[flutter]", "[flutter]\nrequired_speed_m_s = 60.0")
    });
    assert_eq!((code, state(&verdict)), (Some(3), "cannot_be_judged"));
    let text = doubt(&verdict, "untested").unwrap()["text"].clone();
    let text = text.as_str().unwrap();
    assert!(
        text.contains("which no section takes (") && text.contains("are none"),
        "{text}"
    );
}

/// Four per cent at mid-span, the same at the ends: what counts is what they do to the onset.
#[test]
fn a_few_untested_nodes_count_by_what_they_do_to_the_onset() {
    let section = |name: &str, ends: [u32; 2], forces: &str| {
        let [from, to] = ends;
        format!(
            "[[section]]\nname = \"{name}\"\nfrom = \"{from}\"\nto = \"{to}\"\nwidth_m = 31.0\nderivatives = \"{forces}\"\n\
             motions = [\"vertical\", \"torsion\"]\n\n"
        )
    };
    let severity = |[from, to]: [u32; 2]| {
        let (_, verdict) = verdict_after(|text| {
            let (start, end) = (text.find("[[section]]"), text.find("[flutter]"));
            let (before, after) = (&text[..start.unwrap()], &text[end.unwrap() + 9..]);
            let deck = "LN21-5200";
            let mut sections =
                section("rest", [from, to], "flat plate") + &section("east", [to + 5, 1311], deck);
            if from > 1001 {
                sections += &section("west", [1001, from - 5], deck);
            }
            format!("{before}{sections}[flutter]\nrequired_speed_m_s = 77.0{after}")
        });
        doubt(&verdict, "untested").unwrap()["severity"].clone()
    };
    assert_eq!(severity([1151, 1156]), "severe");
    assert_eq!(severity([1001, 1016]), "minor");
}

/// Static coefficients beside derivatives: where heave alone gallops by them, that governs.
#[test]
fn galloping_of_a_bridge_is_looked_at_beside_derivatives() {
    let with_slope = |slope: &str| {
        verdict_after(|text| {
            let statics = format!("static = {{ drag = 0.02, lift_slope = {slope} }}\nmotions =");
            text.replace("motions =", &statics)
                .replace("[flutter]", "[flutter]\nrequired_speed_m_s = 60.0")
        })
    };
    let (code, verdict) = with_slope("-8.0");
    assert_eq!((code, state(&verdict)), (Some(3), "not_met"));
    let governs = &verdict["critical"]["governs"];
    assert_eq!(governs["phenomenon"], "galloping");
    // Den Hartog: `2 ζ ω m = ½ ρ V B (−C_L′ − C_D)` at the slowest vertical mode, whose share in heave is not quite one
    assert!(
        (0.1..1.0).contains(&governs["best_m_s"].as_f64().unwrap()),
        "{governs}"
    );
    let (code, verdict) = with_slope("4.5");
    assert_eq!((code, state(&verdict)), (Some(0), "met"));
}

/// The same of a section in turbulence: it was met at 30 m/s beside derivatives, while `study` saw it gallop at 1 m/s.
#[test]
fn galloping_of_a_section_is_looked_at_beside_derivatives() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let box_girder = include_str!("../../data/coefficients/synthetic_box_girder.csv");
    let down = box_girder.lines().map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        let lift = cells.get(2).and_then(|c| c.parse::<f64>().ok());
        lift.map_or(line.to_owned(), |lift| {
            format!("{},{},{},{}", cells[0], cells[1], -lift, cells[3])
        })
    });
    fs::write(at.join("down.csv"), down.collect::<Vec<_>>().join("\n")).unwrap();
    succeeds(at, &["new", "--wind"]);
    let text = fs::read_to_string(at.join("wind.toml")).unwrap();
    let text = text
        .replace("\"quasi-steady\"\n", "\"LN21-5200\"\n")
        .replace("\nlateral", "\n# lateral");
    let text = text.replace("[speeds]", "[speeds]\nrequired_speed_m_s = 30.0");
    fs::write(at.join("wind.toml"), &text).unwrap();
    let buffeting = ["buffeting", "wind.toml", "--no-figures"];
    let (code, said, error) = aerodeck(at, &buffeting);
    assert!(
        code == 0 && said.contains("✓ MET, required 30 m/s"),
        "{said}{error}"
    );
    let text = text.replace("\"synthetic box girder\"", "\"down.csv\"");
    fs::write(at.join("wind.toml"), text).unwrap();
    let (code, said, error) = aerodeck(at, &buffeting);
    assert!(
        code == 3 && said.contains("✗ NOT MET, required 30 m/s: galloping at 1.00 m/s"),
        "{said}{error}"
    );
}

fn state(verdict: &Value) -> &str {
    verdict["outcome"]["state"].as_str().unwrap()
}

fn doubt<'a>(verdict: &'a Value, kind: &str) -> Option<&'a Value> {
    let doubts = verdict["doubts"].as_array().unwrap();
    doubts.iter().find(|d| d["kind"] == kind)
}

/// Tables of 0° say nothing of a deck that the mean wind turns by degrees; those of an angle near all of its angles do.
#[test]
fn a_deck_turned_by_the_mean_wind_is_doubted() {
    let turned = |angle: &str| {
        let (code, verdict) = verdict_after(|text| {
            let statics = "static = { moment = -0.08, lift_slope = 4.5, moment_slope = 1.2 }";
            text.replace("motions =", &format!("{angle}{statics}\nmotions ="))
                .replace("[flutter]", "[flutter]\nrequired_speed_m_s = 60.0")
        });
        let doubts = verdict["doubts"].as_array().unwrap().clone();
        let of_rotation = doubts.into_iter().find(|d| d["kind"] == "mean_rotation");
        (code, of_rotation)
    };
    let (code, doubt) = turned("");
    let doubt = doubt.unwrap();
    let text = doubt["text"].as_str().unwrap();
    assert!(text.starts_with("The deck stands at -"), "{text}");
    assert!(
        text.contains("the forces are those at 0.0°, assumed since no `angle_deg`"),
        "{text}"
    );
    assert_eq!((code, &doubt["severity"]), (Some(3), &"severe".into()));
    let degrees = text
        .split_once("stands at ")
        .unwrap()
        .1
        .split_once('°')
        .unwrap()
        .0;
    // tests at half of it are near enough for the middle and for the ends, which do not turn
    let degrees: f64 = degrees.parse().unwrap();
    let (code, doubt) = turned(&format!("angle_deg = {:?}\n", 0.5 * degrees));
    assert_eq!(code, Some(0));
    assert!(doubt.is_none_or(|d| d["severity"] == "minor"));
}

/// The table is the headline, the models give its interval; divergence counts by both; a requirement makes the exit code.
#[test]
fn a_required_speed_of_a_bridge_is_judged() {
    let folder = folder();
    let at = folder.path();
    let text = fs::read_to_string(at.join("bridge.toml")).unwrap();
    let stated = |required: f64| {
        let text = match text.contains("[flutter]") {
            true => text.replace(
                "[flutter]",
                &format!("[flutter]\nrequired_speed_m_s = {required}"),
            ),
            false => format!("{text}\n[flutter]\nrequired_speed_m_s = {required}\n"),
        };
        fs::write(at.join("bridge.toml"), text).unwrap();
        let run = ["bridge", "flutter", "bridge.toml", "--no-figures", "--json"];
        let (code, said, error) = aerodeck(at, &run);
        let value: Value = serde_json::from_str(&said).expect(&error);
        (code, value["verdict"].clone())
    };
    let (code, verdict) = stated(60.0);
    let headline = verdict["headline"].as_str().unwrap();
    assert_eq!(code, 0, "{verdict:#}");
    assert!(
        headline.starts_with("✓ MET, required 60 m/s: flutter onset"),
        "{headline}"
    );
    assert!(headline.contains("by the tables"), "{headline}");
    let all = verdict["critical"]["others"].as_array().unwrap();
    let divergence = all.iter().filter(|c| c["phenomenon"] == "divergence");
    assert_eq!(divergence.count(), 2, "{verdict:#}");
    let (code, verdict) = stated(95.0);
    assert_eq!((code, &verdict["outcome"]["state"]), (3, &"not_met".into()));
    assert_eq!(verdict["outcome"]["below"], "best_estimate");
}

/// A unit of a bridge that does not meet its requirement is packed, with that verdict in it and in the exit code.
#[test]
fn the_export_of_a_bridge_repeats_its_verdict() {
    let folder = folder();
    let at = folder.path();
    let text = fs::read_to_string(at.join("bridge.toml")).unwrap();
    let text = text.replace("[flutter]", "[flutter]\nrequired_speed_m_s = 95.0");
    fs::write(at.join("bridge.toml"), text).unwrap();
    let run = ["fmu", "export", "--bridge", "bridge.toml", "--out", "b.fmu"];
    let (code, said, error) = aerodeck(at, &run);
    assert_eq!(code, 3, "{said}{error}");
    assert!(
        flowing(&said).contains("✗ NOT MET, required 95 m/s: flutter onset"),
        "{said}"
    );
    assert!(fmu_page(&at.join("b.fmu")).contains("NOT MET, required 95 m/s"));
}

/// The export of a model of its own says what the model answers, as the page in the archive does.
#[test]
fn the_export_of_a_model_says_what_it_answers() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    succeeds(at, &["demo", "--no-figures", "--out", "d"]);
    let export = [
        "fmu",
        "export",
        "d/models/laguerre.json",
        "--out",
        "said.fmu",
    ];
    let said = flowing(&succeeds(at, &export));
    assert!(
        said.starts_with("Laguerre: flutter onset 36.9 m/s, 36.3–37.6"),
        "{said}"
    );
    assert!(fmu_page(&at.join("said.fmu")).contains("flutter onset 36.9 m/s, 36.3–37.6"));
    // what is odd about the section stands in both
    let text = fs::read_to_string(at.join("d/models/laguerre.json")).unwrap();
    let mut model: Value = serde_json::from_str(&text).unwrap();
    let width = model["section"]["width_m"].as_f64().unwrap();
    model["section"]["width_m"] = (0.5 * width).into();
    fs::write(at.join("narrow.json"), model.to_string()).unwrap();
    let said = flowing(&succeeds(
        at,
        &["fmu", "export", "narrow.json", "--out", "narrow.fmu"],
    ));
    for text in [said, fmu_page(&at.join("narrow.fmu"))] {
        assert!(text.contains("were width_m the semi-chord"), "{text}");
    }
}
