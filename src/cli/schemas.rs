//! `--json-schema`: the JSON Schema of what `--json` prints.

use super::answer::Answer;
use crate::error::{Error, Result};

/// Commands, without the name of the program, and their schemas; `tests/cli/schemas.rs` makes these files of outputs.
const SCHEMAS: [(&str, &str); 18] = [
    (
        "bridge buffeting",
        include_str!("../../docs/schema/bridge-buffeting.json"),
    ),
    (
        "bridge flutter",
        include_str!("../../docs/schema/bridge-flutter.json"),
    ),
    (
        "buffeting",
        include_str!("../../docs/schema/buffeting.json"),
    ),
    (
        "campaign check",
        include_str!("../../docs/schema/campaign-check.json"),
    ),
    (
        "compare signals",
        include_str!("../../docs/schema/compare-signals.json"),
    ),
    ("coverage", include_str!("../../docs/schema/coverage.json")),
    (
        "derivatives show",
        include_str!("../../docs/schema/derivatives-show.json"),
    ),
    ("flutter", include_str!("../../docs/schema/flutter.json")),
    (
        "fmu check",
        include_str!("../../docs/schema/fmu-check.json"),
    ),
    (
        "fmu export",
        include_str!("../../docs/schema/fmu-export.json"),
    ),
    (
        "monte-carlo",
        include_str!("../../docs/schema/monte-carlo.json"),
    ),
    ("process", include_str!("../../docs/schema/process.json")),
    (
        "quasi-steady",
        include_str!("../../docs/schema/quasi-steady.json"),
    ),
    ("select", include_str!("../../docs/schema/select.json")),
    ("simulate", include_str!("../../docs/schema/simulate.json")),
    ("study", include_str!("../../docs/schema/study.json")),
    ("train", include_str!("../../docs/schema/train.json")),
    ("validate", include_str!("../../docs/schema/validate.json")),
];

/// The schema that a command line asks for by `--json-schema`; none where it does not.
///
/// # Errors
/// [`Error::Input`] for a command without a schema.
pub(super) fn asked(arguments: &[String]) -> Result<Option<Answer>> {
    if !arguments.iter().any(|a| a == "--json-schema") {
        return Ok(None);
    }
    let words = arguments.iter().filter(|a| !a.starts_with('-'));
    let line: Vec<&str> = words.map(String::as_str).collect();
    let line = match line.join(" ") {
        demo if demo == "demo" => "study".to_owned(),
        line => line,
    };
    let is_meant = |name: &str| line == name || line.starts_with(&format!("{name} "));
    let Some((_, text)) = SCHEMAS.iter().find(|(name, _)| is_meant(name)) else {
        let all = SCHEMAS.map(|(name, _)| name).join(", ");
        let expected = format!("one of the commands that have one: {all}");
        return Err(Error::input("--json-schema", expected, format!("`{line}`")));
    };
    let value: serde_json::Value =
        serde_json::from_str(text).map_err(|e| Error::Numerical(e.to_string()))?;
    Ok(Some(Answer::new((*text).to_owned(), &value)?.verbatim()))
}
