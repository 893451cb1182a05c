//! Onset by every route: routes on one force model agree, and instabilities of one degree of freedom are named.

use crate::command::{aerodeck, refused, succeeds};
use crate::matrix;
use aerodeck::aerodynamics::derivatives::Derivative;
use aerodeck::aerodynamics::derivatives::DerivativePoint;
use aerodeck::aerodynamics::derivatives::DerivativeTable;
use aerodeck::aerodynamics::derivatives::Extrapolation;
use aerodeck::aerodynamics::derivatives::InterpolatedTable;
use aerodeck::aerodynamics::derivatives::Interpolation;
use aerodeck::aerodynamics::derivatives::TableHeader;
use aerodeck::aerodynamics::{FlatPlate, RationalModel, Realizable, Transfer};
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::files::derivatives::write_csv;
use aerodeck::flutter::{
    Instability, OnsetSearch, classify, determinant_onset, divergence_by_eigenvalues,
    divergence_speed, find_onset, pk_curves, pk_onset, quasi_pk_mode,
};
use aerodeck::section::{Dof, SectionModel};
use aerodeck::units::{ReducedFrequency, ReducedFrequencyRange};
use serde_json::Value;
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fs;
use tempfile::TempDir;

const WIDE: ReducedFrequencyRange = ReducedFrequencyRange::between(
    ReducedFrequency::from_full_width(0.02),
    ReducedFrequency::from_full_width(10.0),
);

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{found} instead of {expected} ± {tolerance}"
    );
}

/// Jones's rational function on the IABSE structure: 76.6790 m/s by three routes, and one damping slope.
#[test]
fn three_routes_on_one_force_model() {
    let structure = SectionModel::iabse_1_1a().structure().unwrap();
    let jones = RationalModel::jones_flat_plate();
    let coupled = CoupledSection::new(structure.clone(), jones.realize()).unwrap();
    let search = OnsetSearch {
        speed_max_m_s: 120.0,
        speeds: 100,
    };
    let found = [
        find_onset("", &coupled, &search, None).unwrap(),
        determinant_onset("", &structure, &jones, WIDE, 120.0).unwrap(),
        pk_onset("", &structure, &jones, &search, None).unwrap(),
    ];
    let onsets = found.each_ref().map(|f| f.onset().unwrap().clone());
    for o in &onsets {
        near(o.at.speed_m_s, 76.6790, 5e-5);
        near(o.at.frequency_hz, 0.19319, 5e-6);
        near(o.mode.unwrap().mode_ratio, 0.65745, 5e-6);
        near(o.mode.unwrap().phase_deg, -160.343, 5e-4);
        near(o.at.speed_m_s / onsets[0].at.speed_m_s, 1.0, 1e-10);
        let slope = o.damping_slope_s_m.unwrap() / onsets[0].damping_slope_s_m.unwrap();
        // the slope of the first is a one-sided difference over 1e-5 of the speed
        near(slope, 1.0, 1e-3);
        assert_eq!(o.branch, "torsion");
    }
    let steady = jones
        .transfer(ReducedFrequency::from_full_width(0.0))
        .unwrap();
    let closed = divergence_speed(&structure, &steady).unwrap().unwrap();
    near(closed, 90.466, 5e-4);
    near(
        divergence_by_eigenvalues(&coupled, 120.0).unwrap().unwrap() / closed,
        1.0,
        1e-9,
    );
    assert_eq!(divergence_by_eigenvalues(&coupled, 80.0).unwrap(), None);
}

/// Curves by continuation are the single solutions from still air where those belong to the same branch.
#[test]
fn curves_of_the_iteration_are_its_solutions() {
    let structure = SectionModel::iabse_1_1a().structure().unwrap();
    let plate = FlatPlate {
        rotary_inertia: false,
    };
    let curves = pk_curves("", &structure, &plate, &[15.0, 30.0, 45.0, 60.0, 75.0]).unwrap();
    for (dof, branch) in curves.branches.iter().enumerate() {
        for point in &branch.points {
            if dof == 0 && point.speed_m_s > 70.0 {
                continue;
            }
            let mode = quasi_pk_mode(&structure, &plate, point.speed_m_s, dof).unwrap();
            near(point.frequency_hz, mode.im / TAU, 1e-9);
            near(point.damping_ratio, -mode.re / mode.norm(), 1e-9);
        }
    }
    // computed independently: torsion at 75 m/s 0.19969 Hz, 1.594 %
    let last = curves.branches[1].points.last().unwrap();
    near(last.frequency_hz, 0.19969, 5e-6);
    near(last.damping_ratio, 0.01594, 5e-6);
}

/// A table of zeros but for these derivatives, linear in V̂: `slope (V̂ − zero)`.
fn made_up(lines: &[(Derivative, f64, f64)]) -> InterpolatedTable {
    use Derivative::*;
    let mut points = BTreeMap::new();
    for d in [H1, H2, H3, H4, A1, A2, A3, A4] {
        let line = lines.iter().find(|l| l.0 == d);
        let of_one: Vec<DerivativePoint> = [0.5, 4.0, 20.0]
            .map(|v_hat| DerivativePoint {
                mean_speed_m_s: None,
                v_hat,
                value: line.map_or(0.0, |(_, slope, zero)| slope * (v_hat - zero)),
            })
            .to_vec();
        points.insert(d, of_one);
    }
    let table = DerivativeTable::new("made up", 0.5, TableHeader::default(), points).unwrap();
    let by = Interpolation::LinearVHat;
    InterpolatedTable::by(by, &table, &Dof::TWO, Extrapolation::Hold).unwrap()
}

/// With `A2* > 0` above V̂ = 1.6 torsion flutters alone where `½ρB⁴ A2* = 2ζJ`: in closed form.
#[test]
fn torsional_flutter_is_named() {
    let model = made_up(&[(Derivative::A2, 0.1, 1.6), (Derivative::H1, -1.0, 0.0)]);
    let structure = SectionModel::table_4_1().structure().unwrap();
    let found = determinant_onset("", &structure, &model, model.tested_range(), 100.0).unwrap();
    let onset = found.onset().unwrap();
    let v_hat = 1.6 + 4.0 * 0.003 * 0.6 / (1.19 * 0.0625) / 0.1;
    let speed = v_hat * TAU * 5.0 * 0.5;
    near(onset.at.speed_m_s, speed, 1e-8);
    let mode = classify(&structure, &model, onset, model.tested_range(), 100.0).unwrap();
    assert_eq!(mode.kind, Instability::TorsionalFlutter);
    assert!(mode.kind.single_dof() && mode.participation[1].energy_share > 0.999);
    near(mode.participation[1].alone_m_s.unwrap(), speed, 1e-8);
    near(
        mode.participation[1].direct_damping,
        0.1 * (v_hat - 1.6),
        1e-9,
    );
    assert_eq!(mode.participation[0].alone_m_s, None);
    let search = OnsetSearch {
        speed_max_m_s: 100.0,
        speeds: 100,
    };
    let iterated = pk_onset("", &structure, &model, &search, None).unwrap();
    near(iterated.onset().unwrap().at.speed_m_s, speed, 1e-8);
}

/// Torsion of which the first test, at 7.85 m/s, already grows: a search up to 5 m/s does not answer with that.
#[test]
fn growth_beyond_the_search_is_no_answer() {
    let model = made_up(&[(Derivative::A2, 0.5, 0.1), (Derivative::H1, -1.0, 0.0)]);
    let structure = SectionModel::table_4_1().structure().unwrap();
    let routes = |speed_max_m_s| {
        let search = OnsetSearch {
            speed_max_m_s,
            speeds: 50,
        };
        let range = model.tested_range();
        [
            pk_onset("", &structure, &model, &search, None).unwrap(),
            determinant_onset("", &structure, &model, range, speed_max_m_s).unwrap(),
        ]
    };
    for found in routes(20.0) {
        assert!(
            found
                .critical_speed_m_s()
                .is_some_and(|v| (6.0..10.0).contains(&v))
        );
    }
    for found in routes(5.0) {
        assert_eq!(found.critical_speed_m_s(), None, "{}", found.explain());
        assert!(
            found.explain().contains("not judged"),
            "{}",
            found.explain()
        );
    }
}

/// Likewise heave with `H1* > 0`: `½ρB² H1* = 2ζm`.
#[test]
fn galloping_is_named() {
    let model = made_up(&[(Derivative::H1, 0.5, 1.0), (Derivative::A2, -0.1, 0.0)]);
    let structure = SectionModel::table_4_1().structure().unwrap();
    let found = determinant_onset("", &structure, &model, model.tested_range(), 60.0).unwrap();
    let onset = found.onset().unwrap();
    let v_hat = 1.0 + 4.0 * 0.003 * 15.0 / (1.19 * 0.25) / 0.5;
    near(onset.at.speed_m_s, v_hat * TAU * 2.0 * 0.5, 1e-8);
    let mode = classify(&structure, &model, onset, model.tested_range(), 60.0).unwrap();
    assert_eq!(mode.kind, Instability::Galloping);
}

fn all_routes(deck: &str) -> (TempDir, Value) {
    let folder = TempDir::new().unwrap();
    let study = aerodeck::study::demo_study_text()
        .replace("source = \"LN21-5200\"", &format!("source = \"{deck}\""))
        .replace("speed_groups = [1]", "speed_groups = [2]");
    fs::write(folder.path().join("study.toml"), study).unwrap();
    for command in ["tunnel", "train"] {
        succeeds(folder.path(), &[command, "study.toml"]);
    }
    let said = succeeds(folder.path(), &["flutter", "study.toml", "--all", "--json"]);
    (folder, serde_json::from_str(&said).unwrap())
}

fn route<'a>(json: &'a Value, model: &str, method: &str) -> &'a Value {
    let all = json["routes"]["routes"].as_array().unwrap();
    all.iter()
        .find(|r| r["model"] == model && r["method"] == method)
        .unwrap_or_else(|| panic!("no {model} by {method}"))
}

fn speed(route: &Value) -> f64 {
    route["search"]["onset"]["speed_m_s"].as_f64().unwrap()
}

/// LN21-6100: coupled, but nearly torsional flutter, and the program says so.
#[test]
fn a_deck_close_to_torsional_flutter() {
    let (folder, json) = all_routes("LN21-6100");
    let table = route(&json, "interpolated table", "determinant");
    // modified Akima over ln K, computed with NumPy and SciPy; linear over V̂ 24.69
    near(speed(table), 25.894, 5e-4);
    let interval = &table["search"]["onset"]["interval"];
    assert_eq!(interval["kind"], "spread");
    near(interval["low_m_s"].as_f64().unwrap(), 24.691, 5e-4);
    near(
        speed(route(&json, "interpolated table", "pk_iteration")) / speed(table),
        1.0,
        1e-9,
    );
    assert_eq!(table["mode"]["kind"], "coupled_flutter");
    let torsion = &table["mode"]["participation"][1];
    assert!(torsion["energy_share"].as_f64().unwrap() > 0.8);
    let a2 = torsion["direct_damping"].as_f64().unwrap();
    assert!((-0.2..0.0).contains(&a2), "{a2}");
    assert!(torsion["alone_m_s"].as_f64().unwrap() < 1.5 * speed(table));
    assert!(
        table["warnings"]
            .to_string()
            .contains("nearly a one-degree-of-freedom")
    );
    for model in ["Laguerre", "rational functions"] {
        let by = |method| speed(route(&json, model, method));
        near(by("determinant") / by("eigenvalues"), 1.0, 1e-9);
        near(by("pk_iteration") / by("eigenvalues"), 1.0, 1e-9);
    }
    let text = succeeds(folder.path(), &["flutter", "study.toml", "--all"]);
    for said in [
        "Onset card: Laguerre",
        "Selberg",
        "Rocard",
        "p-k iteration",
        "dζ/dV",
        "quasi-steady limit",
    ] {
        assert!(text.contains(said), "`{said}` is not in: {text}");
    }
    let figure = fs::read_to_string(folder.path().join("routes.svg")).unwrap();
    // the verdict stands above the table, and a requirement makes the exit code
    let required = ["--set", "flutter.required_speed_m_s=80"];
    let run = ["flutter", "study.toml", "--all"];
    let (code, said, error) = aerodeck(folder.path(), &[&run[..], &required].concat());
    assert_eq!(code, 3, "{error}");
    assert!(said.contains("✗ NOT MET, required 80 m/s"), "{said}");
    assert!(figure.contains("flat plate, same structure"));
}

/// On the flat plate the deck is exact; divergence comes after flutter; the quasi-steady plate is far too careful.
#[test]
fn the_flat_plate_as_a_deck() {
    let (_folder, json) = all_routes("flat plate");
    let exact = route(&json, "flat plate (exact)", "determinant");
    near(speed(exact), 39.468, 5e-4);
    assert_eq!(exact["search"]["onset"]["in_tested_range"], Value::Null);
    near(
        speed(route(&json, "flat plate (exact)", "pk_iteration")),
        39.468,
        5e-4,
    );
    near(exact["divergence_m_s"].as_f64().unwrap(), 50.343, 5e-4);
    assert!(exact["quasi_steady_m_s"].as_f64().unwrap() < 20.0);
    near(
        json["routes"]["sanity"]["selberg_m_s"].as_f64().unwrap(),
        38.17,
        5e-3,
    );
}

/// Static coefficients in the study: the thin plate of quasi-steady theory (without its arms), which is not far above
/// the limit of its derivatives.
#[test]
fn static_coefficients_bring_a_row() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let study = aerodeck::study::demo_study_text().replace(
        "[flutter]",
        "[coefficients]\nsource = \"flat plate\"\n\n[flutter]",
    );
    fs::write(at.join("study.toml"), &study).unwrap();
    for command in ["tunnel", "train"] {
        succeeds(at, &[command, "study.toml"]);
    }
    let said = succeeds(at, &["flutter", "study.toml", "--all", "--json"]);
    let json: Value = serde_json::from_str(&said).unwrap();
    let theory = route(&json, "quasi-steady theory", "eigenvalues");
    assert_eq!(theory["low_frequency_limit"], true);
    // slopes 2π and π/2: static divergence as in closed form for the plate, 50.343 m/s, where it is reached
    if let Some(divergence) = theory["divergence_m_s"].as_f64() {
        near(divergence, 50.343, 0.01);
    }
    let plate = route(&json, "flat plate, same structure", "determinant");
    near(plate["divergence_m_s"].as_f64().unwrap(), 50.343, 5e-4);
    fs::write(
        at.join("study.toml"),
        study.replace("source = \"flat plate\"", "source = \"none\""),
    )
    .unwrap();
    refused(at, &["flutter", "study.toml", "--all"], &["none"]);
}

/// A deck whose section grows where its table begins: every route answers, none takes the table with it.
#[test]
fn all_routes_of_a_bluff_deck() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let mut table = Vec::new();
    write_csv(&matrix::bluff_table(), &mut table).unwrap();
    fs::write(at.join("bluff.csv"), table).unwrap();
    let study = aerodeck::study::demo_study_text()
        .replace("source = \"LN21-5200\"", "source = \"bluff.csv\"");
    fs::write(at.join("study.toml"), study).unwrap();
    for command in ["tunnel", "train"] {
        succeeds(at, &[command, "study.toml"]);
    }
    let said = succeeds(at, &["flutter", "study.toml", "--all", "--json"]);
    let json: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(
        json["routes"]["failed"].as_array().unwrap().len(),
        0,
        "{said}"
    );
    let speed = |method: &str| {
        let route = route(&json, "interpolated table", method);
        route["search"]["unstable_at_or_below"]["speed_m_s"]
            .as_f64()
            .unwrap()
    };
    near(speed("pk_iteration") / speed("determinant"), 1.0, 0.01);
    let text = succeeds(at, &["flutter", "study.toml", "--all"]);
    assert!(text.contains("unstable at and below"), "{text}");
}

const PLAN: &str = "schema = 1\nmodel = \"model.json\"\nsamples = 3000\nspeed_max_m_s = 60.0\ndesign_speed_m_s = 35.0\n\
    [aerodynamics]\ncovariance = \"fits/laguerre.json\"\n\
    [[parameter]]\nname = \"torsion.damping_ratio\"\n\
    distribution = { kind = \"lognormal\", coefficient_of_variation = 0.4 }\n";

/// The whole way of the command: the model and the covariance of a fit, a figure, and what is wrong with a line.
#[test]
fn monte_carlo_from_a_trained_model() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    fs::write(at.join("study.toml"), aerodeck::study::demo_study_text()).unwrap();
    for command in ["tunnel", "train"] {
        succeeds(at, &[command, "study.toml"]);
    }
    fs::write(at.join("scatter.toml"), PLAN).unwrap();
    let said = succeeds(at, &["monte-carlo", "scatter.toml", "--json"]);
    let json: Value = serde_json::from_str(&said).unwrap();
    let result = &json["result"];
    near(result["nominal_m_s"].as_f64().unwrap(), 36.920, 0.02);
    near(result["mean_m_s"].as_f64().unwrap(), 37.0, 1.0);
    assert_eq!(result["samples"], 3000);
    assert!(at.join("monte_carlo.svg").exists() && at.join("monte_carlo.json").exists());
    let text = succeeds(at, &["monte-carlo", "scatter.toml", "--seed", "4"]);
    assert!(
        text.contains("Design    onset below 35.000 m/s") && text.contains("seed 4"),
        "{text}"
    );
    let wrong = PLAN.replace("torsion.damping_ratio", "torsion.stiffness_n");
    fs::write(at.join("scatter.toml"), wrong).unwrap();
    refused(
        at,
        &["monte-carlo", "scatter.toml"],
        &["scatter.toml", "line 9", "torsion.stiffness_n"],
    );
    fs::write(
        at.join("scatter.toml"),
        PLAN.replace("fits/laguerre.json", "none.json"),
    )
    .unwrap();
    refused(at, &["monte-carlo", "scatter.toml"], &["none.json"]);
}
