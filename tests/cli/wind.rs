//! The commands on a wind file: what they print and write, and what they refuse.

use crate::command::{aerodeck, flowing, listing, refused, succeeds};
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

fn example() -> String {
    aerodeck::study::example_wind_study_text().to_owned()
}

/// Writes the example with a change and a short time domain.
fn write(folder: &TempDir, old: &str, new: &str) {
    let text = example();
    assert!(text.contains(old), "{old}");
    let text = text
        .replacen(old, new, 1)
        .replace("records = 32", "records = 4");
    fs::write(folder.path().join("wind.toml"), text).unwrap();
}

#[test]
fn quasi_steady_runs_the_example() {
    let folder = TempDir::new().unwrap();
    let text = succeeds(folder.path(), &["quasi-steady"]);
    assert!(
        text.contains("gusts act in full, without the admittance"),
        "{text}"
    );
    assert!(
        text.contains("Static equilibrium") && text.contains("Nonlinear run"),
        "{text}"
    );
    for name in [
        "wind.toml",
        "coefficients.svg",
        "equilibrium.svg",
        "quasi_steady_modes.svg",
        "quasi_steady_run.csv",
        "gusts.csv",
        "quasi_steady.json",
    ] {
        let path = format!("aerodeck-out/{name}");
        assert!(listing(folder.path()).contains(&path), "{path}");
    }
    let gusts = aerodeck::files::gusts::read_gusts(folder.path().join("aerodeck-out/gusts.csv"));
    assert!((gusts.unwrap().duration_s() - 300.0).abs() < 1e-9);
}

/// The criterion of a code stands in the wind file too; an onset of a theory without tests meets none, and may miss one.
#[test]
fn a_required_speed_of_a_wind_file_is_judged() {
    let folder = TempDir::new().unwrap();
    for (required, words) in [
        (
            10.0,
            "? CANNOT BE JUDGED, required 10 m/s: flutter onset 59.0 m/s, interval not known",
        ),
        (
            60.0,
            "✗ NOT MET, required 60 m/s: flutter onset 59.0 m/s, interval not known",
        ),
        // the search reaches it
        (
            90.0,
            "✗ NOT MET, required 90 m/s: flutter onset 59.0 m/s, interval not known",
        ),
    ] {
        let stated = format!("[speeds]\nrequired_speed_m_s = {required:?}\n");
        write(&folder, "[speeds]\n", &stated);
        let arguments = ["quasi-steady", "wind.toml", "--no-figures"];
        let (code, said, error) = aerodeck(folder.path(), &arguments);
        assert_eq!(code, 3, "{error}");
        let said = flowing(&said);
        assert!(
            said.starts_with(&format!("Synthetic box girder: {words}")),
            "{said}"
        );
    }
    write(&folder, "seed = 1", "seed = 1");
    let said = flowing(&succeeds(
        folder.path(),
        &["quasi-steady", "wind.toml", "--no-figures"],
    ));
    assert!(said.contains("No required speed is stated"), "{said}");
}

/// A requirement that stands in the file is judged by the response to turbulence too, by the forces that the file names.
#[test]
fn a_required_speed_is_judged_beside_buffeting() {
    let folder = TempDir::new().unwrap();
    let judged = |coefficients: bool| {
        write(
            &folder,
            "[speeds]\n",
            "[speeds]\nrequired_speed_m_s = 60.0\n",
        );
        let file = folder.path().join("wind.toml");
        let mut text = fs::read_to_string(&file).unwrap();
        if !coefficients {
            let start = text.find("[coefficients]").unwrap();
            let end = start + text[start..].find("\n\n").unwrap();
            text.replace_range(start..end, "");
            let lateral =
                "lateral = { mass_kg_m = 22740.0, frequency_hz = 0.060, damping_ratio = 0.005 }\n";
            text = text
                .replace(lateral, "")
                .replace("\"quasi-steady\"", "\"LN21-5200\"");
        }
        let text = text
            .replace("speeds = 56", "speeds = 3")
            .replace("speeds_m_s = [20.0, 35.0]", "speeds_m_s = []");
        fs::write(&file, text).unwrap();
        let (code, said, error) =
            aerodeck(folder.path(), &["buffeting", "wind.toml", "--no-figures"]);
        assert_eq!(code, 3, "{said}{error}");
        let page = fs::read_to_string(folder.path().join("buffeting.html")).unwrap();
        assert!(page.contains("required 60 m/s"), "no verdict on the page");
        flowing(&said)
    };
    let said = judged(true);
    assert!(
        said.starts_with("Synthetic box girder: ✗ NOT MET, required 60 m/s"),
        "{said}"
    );
    // a table alone has no interval
    let said = judged(false);
    assert!(
        said.starts_with(
            "Synthetic box girder: ? CANNOT BE JUDGED, required 60 m/s: flutter onset 70.0 m/s"
        ),
        "{said}"
    );
}

/// A table is the answer of the frequency domain; the time domain says what it takes instead and how far off that is.
#[test]
fn buffeting_takes_a_table() {
    let folder = TempDir::new().unwrap();
    let lateral =
        "lateral = { mass_kg_m = 22740.0, frequency_hz = 0.060, damping_ratio = 0.005 }\n";
    write(&folder, lateral, "");
    let file = folder.path().join("wind.toml");
    let text = fs::read_to_string(&file).unwrap();
    let text = text
        .replace("\"quasi-steady\"", "\"LN21-5200\"")
        .replace("speeds = 56", "speeds = 3")
        .replace("speeds_m_s = [20.0, 35.0]", "speeds_m_s = [35.0]");
    fs::write(&file, text).unwrap();
    let said = flowing(&succeeds(
        folder.path(),
        &["buffeting", "wind.toml", "--no-figures"],
    ));
    for words in [
        "self-excited forces: LN21-5200",
        "it takes a model (continuous Laguerre, L = 5",
        "whose RMS in the frequency domain differs from that of the table: y +",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
}

/// The gusts that a run leaves behind drive the same run again.
#[test]
fn gusts_of_a_file_give_the_same_run() {
    let folder = TempDir::new().unwrap();
    write(&folder, "duration_s = 300.0", "duration_s = 60.0");
    let run = |folder: &TempDir| -> Value {
        let text = succeeds(folder.path(), &["quasi-steady", "wind.toml", "--json"]);
        serde_json::from_str(&text).unwrap()
    };
    let first = run(&folder);
    let with_file = fs::read_to_string(folder.path().join("wind.toml"))
        .unwrap()
        .replace(
            "step_s = 0.1\nseed = 1",
            "step_s = 0.1\ngusts = \"gusts.csv\"",
        );
    fs::write(folder.path().join("wind.toml"), with_file).unwrap();
    let second = run(&folder);
    let last = |v: &Value| {
        let rows = v["simulation"]["nonlinear"].as_array().unwrap();
        rows[rows.len() - 1][0].as_f64().unwrap()
    };
    assert!((last(&first) - last(&second)).abs() < 1e-9 * last(&first).abs().max(1.0));

    // the same with the mean wind left in them
    let name = folder.path().join("gusts.csv");
    let mut whole = String::new();
    for line in fs::read_to_string(&name).unwrap().lines() {
        let cells: Vec<&str> = line.split(',').collect();
        match cells[..] {
            [time, u, w] if !line.contains("_s") => {
                let u: f64 = u.parse().unwrap();
                whole += &format!("{time},{},{w}\n", u + 20.0);
            }
            _ => whole += &format!("{line}\n"),
        }
    }
    fs::write(&name, whole).unwrap();
    let expected = "gusts.csv: column u_m_s: expected gusts without the mean wind of";
    refused(folder.path(), &["quasi-steady", "wind.toml"], &[expected]);
}

#[test]
fn buffeting_compares_both_domains() {
    let folder = TempDir::new().unwrap();
    write(&folder, "speeds = 56", "speeds = 12");
    let text = succeeds(folder.path(), &["buffeting", "wind.toml", "--json"]);
    let json: Value = serde_json::from_str(&text).unwrap();
    let results = &json["buffeting"];
    let responses = results["responses"].as_array().unwrap();
    assert!(responses.len() > 6);
    let time = results["time"].as_array().unwrap();
    assert_eq!(time.len(), 2);
    for comparison in time
        .iter()
        .flat_map(|t| t["comparison"].as_array().unwrap())
    {
        // four records only: the standard error itself is known to 40 %
        assert!(
            comparison["deviations"].as_f64().unwrap().abs() < 8.0,
            "{comparison}"
        );
    }
    for name in [
        "buffeting.svg",
        "buffeting_spectra_20.svg",
        "buffeting.json",
    ] {
        assert!(listing(folder.path()).contains(&name.to_owned()), "{name}");
    }
}

#[test]
fn wrong_wind_files_are_refused_with_their_line() {
    let folder = TempDir::new().unwrap();
    let cases = [
        (
            "length_m = 20.0, intensity = 0.05",
            "length_m = -20.0, intensity = 0.05",
            "turbulence.vertical.spectrum.length_m: expected a positive number, found -20",
        ),
        ("intensity = 0.05", "intensity = 5", "not per cent"),
        ("kind = \"von_karman\"", "kind = \"von_karmann\"", "line "),
        (
            "kind = \"kaimal\"",
            "kind = \"general\", a = 1, b = 10.2, c = 1, d = 1.6667",
            "so that the spectrum integrates to the variance",
        ),
        ("schema = 1", "schema = 7", "schema: expected 1, found 7"),
        (
            "source = \"synthetic box girder\"",
            "source = \"no_such.csv\"",
            "no_such.csv",
        ),
        (
            "source = \"synthetic box girder\"",
            "source = \"wing\"",
            "one of the embedded tables flat plate",
        ),
        (
            "aerodynamics = \"quasi-steady\"",
            "aerodynamics = \"magic\"",
            "`quasi-steady`, `flat plate`",
        ),
        ("speeds = 56", "speeds = 1", "a number from 2 to 10000"),
        (
            "torsion = 0.2 }",
            "torsion = 0.2 }\narms_from = \"LN21-5200\"",
            "`arms` or `arms_from`",
        ),
        ("[time]", "[tmie]", "line "),
        (
            "records = 32",
            "records = 1",
            "time.plan.records: expected a number from 2 to 100000, found 1",
        ),
        (
            "seed = 1 }",
            "seed = 1, step_s = 0 }",
            "time.plan.step_s: expected a positive number, found 0",
        ),
    ];
    for (old, new, expected) in cases {
        write(&folder, old, new);
        refused(folder.path(), &["buffeting", "wind.toml"], &[expected]);
    }
}

/// A static table with a mistake is refused with file and line, an angle outside it by its value.
#[test]
fn wrong_static_tables_are_refused() {
    use aerodeck::files::coefficients::embedded;
    use aerodeck::files::coefficients::write_coefficients;
    let folder = TempDir::new().unwrap();
    let mut bytes = Vec::new();
    let table = embedded::coefficients("synthetic box girder").unwrap();
    write_coefficients(&table, &mut bytes).unwrap();
    let good = String::from_utf8(bytes).unwrap();
    write(
        &folder,
        "source = \"synthetic box girder\"",
        "source = \"deck.csv\"",
    );
    let table = folder.path().join("deck.csv");
    fs::write(&table, good.replacen("\n-8,", "\nNaN,", 1)).unwrap();
    refused(
        folder.path(),
        &["quasi-steady", "wind.toml"],
        &["deck.csv: line 13: expected finite numbers, found NaN"],
    );
    // without the rows above 2 degrees a gust soon leaves the table
    let short: Vec<&str> = good.lines().take(18).collect();
    fs::write(&table, short.join("\n")).unwrap();
    let (code, said, _) = aerodeck(folder.path(), &["quasi-steady", "wind.toml"]);
    assert_eq!(code, 1);
    let said = flowing(&said);
    for expected in [
        "FAILED nonlinear run",
        "an angle of attack from -16 to 2 deg",
        "wrote ./quasi_steady.json",
    ] {
        assert!(said.contains(expected), "{said}");
    }
    assert!(!folder.path().join("quasi_steady_run.csv").exists());
}

/// A trained model of every kind brings its section and is stepped; the forces of gusts are those of the plate, and the part of the
/// response inside the tested range is told.
#[test]
fn a_trained_model_of_every_kind_buffets() {
    let folder = TempDir::new().unwrap();
    let gust = "spectrum = { shape = { kind = \"von_karman\" }, length_m = 2.0, intensity = 0.08 }";
    let wind = format!(
        "schema = 1\nname = \"model\"\naerodynamics = \"model.json\"\n[speeds]\nspeed_min_m_s = 10\nspeed_max_m_s = 30\nspeeds = 5\n\
         [turbulence.vertical]\n{gust}\nadmittance = {{ kind = \"sears\" }}\n[time]\nspeeds_m_s = [20]\nplan = {{ records = 32 }}\n"
    );
    fs::write(folder.path().join("wind.toml"), wind).unwrap();
    for kind in ["continuous_laguerre", "rational", "discrete_laguerre"] {
        let models = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/models");
        let model = format!("{models}/{kind}.json");
        fs::copy(model, folder.path().join("model.json")).unwrap();
        let text = succeeds(folder.path(), &["buffeting", "wind.toml", "--force"]);
        assert!(
            text.contains("variance inside the tested range of K"),
            "{kind}: {text}"
        );
        let text = succeeds(
            folder.path(),
            &["buffeting", "wind.toml", "--json", "--force"],
        );
        let json: Value = serde_json::from_str(&text).unwrap();
        let compared = json["buffeting"]["time"][0]["comparison"].as_array();
        let compared = compared.unwrap();
        assert_eq!(compared.len(), 2);
        for c in compared {
            let deviations = c["deviations"].as_f64().unwrap();
            assert!(deviations.abs() < 3.5, "{kind}: {c}");
        }
    }
}

/// Jones's plate on this section flutters at 76.68 m/s: below, every speed is answered; above, every speed is named.
#[test]
fn buffeting_answers_stable_speeds_and_names_the_others() {
    let folder = TempDir::new().unwrap();
    let lateral =
        "lateral = { mass_kg_m = 22740.0, frequency_hz = 0.060, damping_ratio = 0.005 }\n";
    write(&folder, lateral, "");
    let file = folder.path().join("wind.toml");
    let text = fs::read_to_string(&file)
        .unwrap()
        .replace("\"quasi-steady\"", "\"flat plate (Jones)\"")
        .replace("speed_max_m_s = 60.0", "speed_max_m_s = 120.0")
        .replace("speeds_m_s = [20.0, 35.0]", "speeds_m_s = [20.0, 110.0]");
    fs::write(&file, text).unwrap();
    let text = succeeds(folder.path(), &["buffeting", "wind.toml"]);
    let answered: Vec<f64> = text
        .lines()
        .filter_map(|line| {
            let words: Vec<&str> = line.split_whitespace().collect();
            (words.len() == 5).then(|| words[0].parse().ok()).flatten()
        })
        .collect();
    assert!(answered.len() > 5, "{text}");
    assert!(answered.iter().all(|speed| *speed < 76.68), "{text}");
    let said = flowing(&text);
    let mut before: Vec<&str> = said.split(" m/s: the section is unstable").collect();
    before.pop();
    let named: Vec<f64> = before
        .iter()
        .flat_map(|words| words.rsplit("at ").next().unwrap().split(", "))
        .map(|speed| speed.parse().unwrap())
        .collect();
    assert!(
        named.contains(&110.0) && named.iter().all(|speed| *speed > 76.68),
        "{text}"
    );
    let page = fs::read_to_string(folder.path().join("buffeting.html")).unwrap();
    assert!(page.contains("No response at ") && page.contains(" 110.00"));
    assert!(text.contains("time domain at 20 m/s"), "{text}");
    assert!(!text.contains("time domain at 110 m/s"), "{text}");
    // a step that holds no mode takes nothing of the frequency domain with it
    let coarse = fs::read_to_string(&file).unwrap();
    fs::write(
        &file,
        coarse.replace("seed = 1 }", "seed = 1, step_s = 5.0 }"),
    )
    .unwrap();
    let text = flowing(&succeeds(folder.path(), &["buffeting", "wind.toml"]));
    let why = "at 20.00 m/s: no time domain: time step of the turbulence: expected at most";
    assert!(text.contains(why) && text.contains("RMS y"), "{text}");
}
