//! The schemas in `docs/schema` are those of what the commands print: every output is valid, and every key of an output has its type.
//! `AERODECK_UPDATE=1` makes them anew.

mod lines;

use crate::command::{aerodeck, succeeds};
use lines::LINES;
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

const SCATTER: &str = "schema = 1\nmodel = \"a/models/laguerre.json\"\nsamples = 300\ndesign_speed_m_s = 36.0\n\
     [aerodynamics]\ncovariance = \"a/fits/laguerre.uncertainty.json\"\n\
     [[parameter]]\nname = \"torsion.damping_ratio\"\ndistribution = { kind = \"lognormal\", coefficient_of_variation = 0.4 }\n";

const GUSTS: &str = "[buffeting]\nspeeds_m_s = [20.0]\n[buffeting.turbulence.vertical]\nspectrum = { shape = { kind = \"von_karman\" }, \
     length_m = 20.0, intensity = 0.05 }\n";

/// What `--json` prints, by the command.
fn outputs(at: &Path) -> BTreeMap<&'static str, Vec<Value>> {
    fs::write(at.join("scatter.toml"), SCATTER).unwrap();
    let template = include_str!("../../src/cli/new/monte_carlo.toml");
    let template = template.replace("\"model.json\"", "\"a/models/laguerre.json\"");
    let few = template.replace("samples = 100000", "samples = 300");
    fs::write(at.join("template.toml"), few).unwrap();
    let wave = |k: usize, lag: f64| (0.1 * k as f64 - lag).sin();
    let rows = (0..400).map(|k| format!("{},{},{}\n", 0.01 * k as f64, wave(k, 0.0), wave(k, 0.3)));
    let signals: String = std::iter::once("time_s,a,b\n".to_owned())
        .chain(rows)
        .collect();
    fs::write(at.join("signals.csv"), signals).unwrap();
    let mut all: BTreeMap<&str, Vec<Value>> = BTreeMap::new();
    for (command, line) in LINES {
        let line = [line, &["--json"]].concat();
        if line.contains(&"alone.json") {
            fs::copy(at.join("a/models/laguerre.json"), at.join("alone.json")).unwrap();
        }
        let (code, printed, said) = aerodeck(at, &line);
        assert!(matches!(code, 0 | 1 | 3), "{line:?}: {said}");
        if command.is_empty() {
            if line == ["new", "--bridge", "--json"] {
                bridges(at);
            } else if line.contains(&"LN21-5200") && line[0] == "new" {
                let study = fs::read_to_string(at.join("study.toml")).unwrap();
                fs::write(at.join("gusts.toml"), study + GUSTS).unwrap();
            }
            continue;
        }
        let value = serde_json::from_str(&printed).unwrap_or_else(|e| panic!("{line:?}: {e}"));
        all.entry(command).or_default().push(value);
    }
    all
}

/// The bridge of the template with few modes, with a requirement, and with all that is commented out.
fn bridges(at: &Path) {
    let text = fs::read_to_string(at.join("bridge.toml")).unwrap();
    let few = text.replace(
        "# select = [1, 2, 3, 23] ",
        "select = [2, 3, 5, 12, 14, 16, 17, 23] ",
    );
    let on = |keys: &[&str]| -> String {
        let line = |line: &str| match keys.iter().any(|key| line.starts_with(key)) {
            true => format!("{}\n", line.replacen("# ", "", 1)),
            false => format!("{line}\n"),
        };
        few.lines().map(line).collect()
    };
    let of_wind = [
        "# static",
        "# [wind]",
        "# profile",
        "# [buff",
        "# nodes",
        "# along",
        "# vertical",
    ];
    fs::write(at.join("required.toml"), on(&["# required"])).unwrap();
    fs::write(at.join("all.toml"), on(&of_wind)).unwrap();
    fs::write(at.join("bridge.toml"), few).unwrap();
}

/// A schema of which all these values are valid. Outputs of other inputs have the same keys, but not all, and null where there is
/// nothing to say: below the `top` no key is required, what is no list and no yes or no may be null, and of what was never anything
/// but null nothing is known.
fn schema(values: &[&Value], top: bool) -> Value {
    let mut types = BTreeSet::new();
    let (mut objects, mut items) = (Vec::new(), Vec::new());
    for value in values {
        types.insert(match value {
            Value::Null => "null",
            Value::Bool(_) => "boolean",
            Value::Number(_) => "number",
            Value::String(_) => "string",
            Value::Array(list) => {
                items.extend(list);
                "array"
            }
            Value::Object(map) => {
                objects.push(map);
                "object"
            }
        });
    }
    let mut made = Map::new();
    if !top && types.iter().any(|t| !matches!(*t, "array" | "boolean")) {
        types.insert("null");
    }
    let types: Vec<&str> = types.into_iter().collect();
    match types[..] {
        ["null"] => (),
        [one] => drop(made.insert("type".into(), json!(one))),
        _ => drop(made.insert("type".into(), json!(types))),
    }
    if !objects.is_empty() {
        let keys: BTreeSet<&String> = objects.iter().flat_map(|map| map.keys()).collect();
        let of = |key: &String| {
            objects
                .iter()
                .filter_map(|map| map.get(key))
                .collect::<Vec<_>>()
        };
        let properties = keys
            .iter()
            .map(|key| ((*key).clone(), schema(&of(key), false)));
        let required = keys
            .iter()
            .filter(|key| objects.iter().all(|map| map.contains_key(**key)));
        made.insert("properties".into(), Value::Object(properties.collect()));
        if top {
            made.insert("required".into(), json!(required.collect::<Vec<_>>()));
        }
    }
    if !items.is_empty() {
        made.insert("items".into(), schema(&items, false));
    }
    Value::Object(made)
}

/// What of a value is not as a schema says, by its path.
fn wrong(schema: &Value, value: &Value, path: &str, found: &mut Vec<String>) {
    let kind = match value {
        Value::Null => "null",
        Value::Bool(_) => "boolean",
        Value::Number(_) => "number",
        Value::String(_) => "string",
        Value::Array(_) => "array",
        Value::Object(_) => "object",
    };
    let types = &schema["type"];
    if !types.is_null()
        && types != kind
        && !types
            .as_array()
            .is_some_and(|all| all.iter().any(|t| t == kind))
    {
        found.push(format!("{path}: {kind} where {types} stands"));
        return;
    }
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                let path = format!("{path}.{key}");
                match schema["properties"].get(key) {
                    Some(schema) => wrong(schema, value, &path, found),
                    None => found.push(format!("{path} is not in it")),
                }
            }
            let required = schema["required"].as_array().into_iter().flatten();
            let missing = required
                .filter_map(Value::as_str)
                .filter(|key| !map.contains_key(*key));
            found.extend(missing.map(|key| format!("{path}.{key} is missing")));
        }
        Value::Array(list) => {
            for item in list {
                match schema.get("items") {
                    Some(schema) => wrong(schema, item, &format!("{path}[]"), found),
                    None => found.push(format!("{path}: items of no type")),
                }
            }
        }
        _ => (),
    }
}

#[test]
fn outputs_are_those_of_the_schemas() {
    let folder = TempDir::new().unwrap();
    let update = std::env::var_os("AERODECK_UPDATE").is_some();
    let mut found = Vec::new();
    for (command, values) in outputs(folder.path()) {
        let file = format!("docs/schema/{}.json", command.replace(' ', "-"));
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(&file);
        let kind = aerodeck::json::format(&command.replace(' ', "-"));
        if update {
            let Value::Object(body) = schema(&values.iter().collect::<Vec<_>>(), true) else {
                unreachable!("an object")
            };
            let mut made = Map::new();
            made.insert(
                "$schema".into(),
                json!("https://json-schema.org/draft/2020-12/schema"),
            );
            made.insert(
                "title".into(),
                json!(format!("What `aerodeck {command} --json` prints")),
            );
            made.extend(body);
            made["properties"]["format"] = json!({ "const": kind, "type": "string" });
            let text = format!("{:#}\n", Value::Object(made));
            fs::write(&path, text).unwrap();
        }
        let stored: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
        assert_eq!(stored["properties"]["format"]["const"], kind, "{file}");
        for value in &values {
            assert_eq!(value["format"], kind, "{file}");
            wrong(&stored, value, &file, &mut found);
        }
    }
    found.dedup();
    assert!(
        found.is_empty(),
        "AERODECK_UPDATE=1 makes schemas anew: {found:#?}"
    );
}

#[test]
fn a_command_prints_its_schema() {
    let folder = TempDir::new().unwrap();
    let printed = succeeds(folder.path(), &["flutter", "--json-schema"]);
    let schema: Value = serde_json::from_str(&printed).unwrap();
    assert_eq!(schema["type"], "object");
    assert!(schema["properties"].as_object().unwrap().len() > 3);
    for (line, kind) in [
        (&["demo", "--out", "x"][..], "aerodeck/study 1"),
        (
            &["demo", "--bridge", "--out", "x"],
            "aerodeck/bridge-flutter 1",
        ),
    ] {
        let printed = succeeds(folder.path(), &[line, &["--json-schema"]].concat());
        let schema: Value = serde_json::from_str(&printed).unwrap();
        assert_eq!(schema["properties"]["format"]["const"], kind);
    }
    let (code, _, said) = aerodeck(folder.path(), &["new", "--json-schema"]);
    assert_eq!(code, 2);
    assert!(said.contains("bridge flutter"), "{said}");
}
