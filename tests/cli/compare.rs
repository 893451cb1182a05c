//! The comparisons on the embedded decks from the command line.

use crate::command::{aerodeck, flowing, listing, refused, succeeds};
use serde_json::Value;
use tempfile::TempDir;

#[test]
fn models_are_compared_in_both_domains() {
    let folder = TempDir::new().unwrap();
    let text = succeeds(folder.path(), &["compare", "models", "--out", "m"]);
    for word in [
        "rational functions, one lag",
        "within ±15 % at",
        "M_phi",
        "thesis 3.5.5: rotation",
        "models_transfer.svg",
    ] {
        assert!(text.contains(word), "`{word}` is not in:\n{text}");
    }
    let files = listing(folder.path());
    for name in [
        "m/models_metrics.csv",
        "m/models_transfer.csv",
        "m/models_transfer.svg",
        "m/models_derivatives.svg",
        "m/models_metrics_vertical.svg",
        "m/models_metrics_torsion.svg",
        "m/models_history_vertical_0.5_hz.svg",
        "m/models_history_torsion_2.0_hz.svg",
    ] {
        assert!(
            files.iter().any(|f| f == name),
            "{name} is not in {files:?}"
        );
    }
    let table = std::fs::read_to_string(folder.path().join("m/models_transfer.csv")).unwrap();
    // four transfer functions, three models, eight test points
    assert_eq!(table.lines().count(), 1 + 4 * 3 * 8);
}

#[test]
fn decks_are_compared_with_the_model_of_one() {
    let folder = TempDir::new().unwrap();
    let arguments = [
        "--json",
        "compare",
        "decks",
        "--decks",
        "LN21-5200,LN21-5800",
        "--trained-on",
        "LN21-5200",
        "--lateral",
        "--out",
        "d",
    ];
    let answer: Value = serde_json::from_str(&succeeds(folder.path(), &arguments)).unwrap();
    let results = &answer["comparison"];
    // two decks, two speeds, three motions, three forces, eight frequencies
    assert_eq!(results["scores"].as_array().unwrap().len(), 2 * 2 * 9 * 8);
    assert_eq!(results["decks"][1]["trained_on"][0], "LN21-5200");
    assert!(listing(folder.path()).contains(&"d/decks_lateral.svg".to_owned()));
    refused(
        folder.path(),
        &["compare", "decks", "--decks", "my.csv"],
        &["LN21-6100, found `my.csv`"],
    );
    refused(
        folder.path(),
        &["compare", "models", "--alpha", "1.5"],
        &["alpha", "1.5"],
    );
    for (flag, place) in [("--speed", "speed_m_s"), ("--noise", "noise_fraction")] {
        refused(
            folder.path(),
            &["compare", "decks", flag, "-3"],
            &[place, "positive number", "-3"],
        );
    }
}

/// A cosine and the same 20 ms late and a tenth larger: what each metric sees is known in closed form.
#[test]
fn signals_of_a_file_are_compared_by_all_metrics() {
    let folder = TempDir::new().unwrap();
    let mut text = String::from("measured,predicted,other\n");
    for k in 0..4000 {
        let t = f64::from(k) * 0.01;
        let x = |t: f64| (std::f64::consts::TAU * t).cos() + 0.3 * (17.0 * t).sin();
        text.push_str(&format!("{},{},1\n", x(t), 1.1 * x(t - 0.02)));
    }
    std::fs::write(folder.path().join("f.csv"), text).unwrap();
    let arguments = |compared: &'static str| {
        let fixed = [
            "--json",
            "compare",
            "signals",
            "f.csv",
            "--reference",
            "measured",
        ];
        let rest = [
            "--compared",
            compared,
            "--sampling-hz",
            "100",
            "--to-hz",
            "4",
            "--levels",
            "24",
        ];
        [&fixed[..], &rest[..]].concat()
    };
    let answer: Value =
        serde_json::from_str(&succeeds(folder.path(), &arguments("predicted"))).unwrap();
    let value = |symbol: &str| {
        let lines = answer["metrics"].as_array().unwrap();
        let line = lines.iter().find(|l| l["symbol"] == symbol).unwrap();
        line["value"].as_f64().unwrap()
    };
    assert_eq!(answer["metrics"].as_array().unwrap().len(), 10);
    // 20 ms against the second that brings the metric to 1/e; a tenth of the power and of the peak
    assert!((value("M_phi") - (-0.02_f64).exp()).abs() < 1e-3);
    assert!((value("M_rms") - (-0.1_f64).exp()).abs() < 1e-3);
    assert!((value("M_p") - (-0.1_f64).exp()).abs() < 1e-2);
    // the same shape of the distribution; both stationary; nothing coupled
    assert!(value("M_pdf") > 0.95);
    assert_eq!((value("M_s"), value("M_b")), (1.0, 1.0));
    for (option, wrong) in [("--levels", "0"), ("--to-hz", "0.1"), ("--from-hz", "0")] {
        let mut impossible = arguments("predicted");
        match impossible.iter_mut().skip_while(|a| **a != option).nth(1) {
            Some(value) => *value = wrong,
            None => impossible.extend([option, wrong]),
        }
        refused(folder.path(), &impossible, &[option, "found"]);
    }
    std::fs::write(folder.path().join("u.csv"), "a [N],b [kN]\n1,2\n").unwrap();
    let units = [
        "compare",
        "signals",
        "u.csv",
        "--reference",
        "a",
        "--compared",
        "b",
    ];
    refused(
        folder.path(),
        &units,
        &["a channel in N, as `a`", "`b` in kN"],
    );
    refused(
        folder.path(),
        &arguments("forecast"),
        &["the channels measured, predicted, other"],
    );
    // a part of a period: the farther away, the larger its correlation
    let x = |k: i32, late: f64| (0.5 + 0.004 * (f64::from(k) - late)).sin();
    let rows = (0..200).map(|k| format!("{},{}\n", x(k, 0.0), x(k, 40.0)));
    let part = format!("measured,predicted\n{}", rows.collect::<String>());
    std::fs::write(folder.path().join("p.csv"), part).unwrap();
    let mut of_part = arguments("predicted");
    of_part[3] = "p.csv";
    let said = flowing(&aerodeck(folder.path(), &of_part[1..]).1);
    assert!(
        said.contains("none: record: expected a correlation that is largest at some lag"),
        "{said}"
    );
    let text = std::fs::read_to_string(folder.path().join("f.csv")).unwrap();
    let twice = text.replacen("other", "predicted", 1);
    std::fs::write(folder.path().join("f.csv"), twice).unwrap();
    let said = &["expected one channel `predicted`, found 2 of that name"];
    refused(folder.path(), &arguments("predicted"), said);
    // the time column says the rate, and contradicts another
    let rows: String = (0..100)
        .map(|k| format!("{},{},{}\n", 0.01 * f64::from(k), k % 7, k % 5))
        .collect();
    let timed = format!("time_s,measured,predicted\n{rows}");
    let path = folder.path().join("f.csv");
    std::fs::write(&path, &timed).unwrap();
    let mut other = arguments("predicted");
    other[9] = "200";
    let said = &[
        "f.csv: sampling frequency: expected the 200 Hz of --sampling-hz, found 100.0000 Hz by its time column",
    ];
    refused(folder.path(), &other, said);
    std::fs::write(&path, timed.replace("\n0.5,", "\n0.505,")).unwrap();
    refused(
        folder.path(),
        &arguments("predicted"),
        &["`time_s`, sample 50"],
    );
    let falling = timed.replace("\n0,", "\n9,").replace("\n0.", "\n-0.");
    std::fs::write(&path, falling).unwrap();
    let said = &["`time_s`: expected a time that rises, found from 9 to -0.99"];
    refused(folder.path(), &arguments("predicted"), said);
    // a step of 1 without a unit is one of seconds or of milliseconds, unless the rate is stated
    let counted: String = (0..100)
        .map(|k| format!("{k},{},{}\n", k % 7, k % 5))
        .collect();
    std::fs::write(&path, format!("t,measured,predicted\n{counted}")).unwrap();
    let said = &[
        "f.csv: `t`: expected a unit, as in `t [s]`",
        "found steps of 1",
    ];
    std::fs::write(
        folder.path().join("g.csv"),
        format!("time_ms,measured,predicted\n{counted}"),
    )
    .unwrap();
    let mut unstated: Vec<&str> =
        [&arguments("predicted")[..8], &arguments("predicted")[10..]].concat();
    refused(folder.path(), &unstated, said);
    (unstated[3], unstated[9]) = ("g.csv", "400");
    succeeds(folder.path(), &unstated);
    for [hz, to_hz] in [["1", "0.4"], ["1000", "400"]] {
        let mut stated = arguments("predicted");
        (stated[9], stated[11]) = (hz, to_hz);
        succeeds(folder.path(), &stated);
    }
}
