//! `--json-schema`: the JSON Schema of what `--json` prints.

use super::vocabulary::{Answer, Error, Result};

macro_rules! schemas {
    ($($name:literal in $file:literal,)*) => {
        [$(($name, include_str!(concat!("../../docs/schema/", $file, ".json")))),*]
    };
}

/// Commands, without the name of the program, and their schemas; `tests/cli/schemas.rs` makes these files of outputs.
const SCHEMAS: [(&str, &str); 18] = schemas! {
    "bridge buffeting" in "bridge-buffeting",
    "bridge flutter" in "bridge-flutter",
    "buffeting" in "buffeting",
    "campaign check" in "campaign-check",
    "compare signals" in "compare-signals",
    "coverage" in "coverage",
    "derivatives show" in "derivatives-show",
    "flutter" in "flutter",
    "fmu check" in "fmu-check",
    "fmu export" in "fmu-export",
    "monte-carlo" in "monte-carlo",
    "process" in "process",
    "quasi-steady" in "quasi-steady",
    "select" in "select",
    "simulate" in "simulate",
    "study" in "study",
    "train" in "train",
    "validate" in "validate",
};

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
    let line = match line.first() {
        Some(&"demo") if arguments.iter().any(|a| a == "--bridge") => "bridge flutter".to_owned(),
        Some(&"demo") => "study".to_owned(),
        _ => line.join(" "),
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
