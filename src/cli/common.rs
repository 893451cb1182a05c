//! Arguments that several commands share.

use super::answer::plain;
use crate::error::{Error, Result};
use crate::files::text::read_text;
use crate::files::toml_lines::with_line;
use crate::plausibility::sentences;
use crate::section::Dof;
use crate::study::{Study, study_findings};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use serde::de::value::Error as NotOne;
use serde::de::{DeserializeOwned, IntoDeserializer};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether this process is the program, whose standard error is ours.
static IS_PROGRAM: AtomicBool = AtomicBool::new(false);

/// Says that this process is the program.
pub(crate) fn is_program() {
    IS_PROGRAM.store(true, Ordering::Relaxed);
}

/// Reports implausible values of a file at once, since they may cause a later failure; another program finds them in the answer.
pub(crate) fn warn(file: &Path, warnings: &[String]) {
    if !IS_PROGRAM.load(Ordering::Relaxed) {
        return;
    }
    for warning in warnings {
        // standard error may be closed
        let line = plain(&format!("warning: {}: {warning}", file.display()));
        let _ = writeln!(std::io::stderr(), "{line}");
    }
}

/// The words of an argument, each a value of `T` as files spell it.
pub(crate) fn spelt<T>(words: impl Into<PossibleValuesParser>) -> impl TypedValueParser<Value = T>
where
    T: DeserializeOwned + Clone + Send + Sync + 'static,
{
    let value = |word: String| T::deserialize(IntoDeserializer::<NotOne>::into_deserializer(word));
    words.into().try_map(value)
}

/// A speed, or what is said where there is none.
pub(crate) fn speed_or(otherwise: &str, speed_m_s: Option<f64>) -> String {
    speed_m_s.map_or(otherwise.to_owned(), |v| format!("{v:.3} m/s"))
}

/// The folder of a file.
pub(crate) fn folder_of(file: &Path) -> &Path {
    let parent = file.parent().filter(|p| !p.as_os_str().is_empty());
    parent.unwrap_or(Path::new("."))
}

/// Columns of the motion of degrees of freedom: `vertical_m`, `torsion_rad`; `what` and the units stand behind the name.
pub(crate) fn motion_columns<'a>(
    dofs: &'a [Dof],
    what: &'a str,
    linear: &'a str,
    angular: &'a str,
) -> impl Iterator<Item = String> + 'a {
    dofs.iter().map(move |d| {
        let unit = if *d == Dof::Torsion { angular } else { linear };
        format!("{}{what}_{unit}", d.name())
    })
}

/// A study file and the folder of its results.
#[derive(clap::Args)]
pub(crate) struct StudyArgs {
    /// The study file; `-` reads standard input.
    pub study: PathBuf,
    /// Another value for a key of the study, such as `section.torsion.frequency_hz=4.5`; of several `[[model]]` the first one's. May be
    /// given several times.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Folder of the results; by default the folder of the study file.
    #[arg(long)]
    pub out: Option<PathBuf>,
}

impl StudyArgs {
    /// Reads the study.
    pub(crate) fn read(&self) -> Result<Study> {
        self.read_with_text().map(|(study, _)| study)
    }

    /// Reads the study and keeps its text.
    pub(crate) fn read_with_text(&self) -> Result<(Study, String)> {
        let text = if self.is_stdin() {
            std::io::read_to_string(std::io::stdin()).map_err(|e| Error::io(&self.study, e))?
        } else {
            read_text(&self.study)?
        };
        let text = with_values(text, &self.set)?;
        let directory = self.study.parent().unwrap_or(Path::new(""));
        let study = Study::from_toml(&text, directory.to_path_buf());
        let study = study.map_err(|e| in_input(&self.study, &self.set, e))?;
        warn(&self.study, &sentences(&study_findings(&study)));
        Ok((study, text))
    }

    fn is_stdin(&self) -> bool {
        self.study == Path::new("-")
    }

    /// The file of the study; none when it came otherwise, or was changed.
    pub(crate) fn file(&self) -> Option<&Path> {
        (!self.is_stdin() && self.set.is_empty()).then_some(&self.study)
    }

    /// Folder of the results.
    pub(crate) fn directory(&self) -> PathBuf {
        self.out.clone().unwrap_or_else(|| self.beside())
    }

    /// Folder of the study file.
    pub(crate) fn beside(&self) -> PathBuf {
        folder_of(&self.study).to_path_buf()
    }
}

/// The error with file and line of what a command works on, where it names none; of a file in which something was set, with what
/// was set: then no line is where it was.
pub(crate) fn in_input(file: &Path, set: &[String], error: Error) -> Error {
    let mut input = match error {
        Error::Input(input) => input,
        Error::Several(all) => {
            let each = all.into_iter().map(|e| in_input(file, set, e));
            return Error::Several(each.collect());
        }
        other => return other,
    };
    if input.file.is_some() || input.place.to_string().starts_with("--") {
        return Error::Input(input);
    }
    let mut name = file.as_os_str().to_owned();
    for one in set {
        name.push(format!(" --set {one}"));
    }
    let unchanged = set.is_empty() && input.place.line.is_none();
    let error = match unchanged.then(|| read_text(file)) {
        Some(Ok(text)) => with_line(&text, Error::Input(input)),
        _ => {
            input.place.line = input.place.line.filter(|_| set.is_empty());
            Error::Input(input)
        }
    };
    error.in_file(Path::new(&name))
}

/// The text with other values, each `key=value` with a value as TOML has it; a bare word counts as text.
///
/// # Errors
/// [`Error::Input`] naming what cannot be set.
fn with_values(text: String, set: &[String]) -> Result<String> {
    if set.is_empty() {
        return Ok(text);
    }
    let broken =
        |expected: &str, found: &str| Error::input("--set", expected, format!("`{found}`"));
    // what is wrong before is said with its line by the reader of the study
    let Ok(mut root) = toml::from_str::<toml::Table>(&text) else {
        return Ok(text);
    };
    for one in set {
        let (key, value) = one
            .split_once('=')
            .ok_or_else(|| broken("KEY=VALUE", one))?;
        let value = value.trim();
        let parsed = toml::from_str::<toml::Table>(&format!("x = {value}"));
        let value = match parsed.ok().and_then(|mut t| t.remove("x")) {
            // no key is a date but as text, of which shells take the quotes
            Some(value) if !value.is_datetime() => value,
            _ => toml::Value::String(value.to_owned()),
        };
        let mut parts: Vec<&str> = key.trim().split('.').collect();
        let last = parts.pop().unwrap_or_default();
        let mut at = &mut root;
        for part in parts {
            let next = at.entry(part);
            let next = next.or_insert_with(|| toml::Value::Table(toml::Table::new()));
            at = match next {
                toml::Value::Table(table) => table,
                // of a list, such as the models, its first entry
                toml::Value::Array(list) => match list.first_mut() {
                    Some(toml::Value::Table(table)) => table,
                    _ => return Err(broken("a key of a table", key)),
                },
                _ => return Err(broken("a key of a table", key)),
            };
        }
        at.insert(last.to_owned(), value);
    }
    toml::to_string(&root).map_err(|e| Error::Numerical(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::with_values;

    #[test]
    fn values_are_set_by_their_keys() {
        let text = "name = \"a\"\n[section]\nwidth_m = 1.0\n[[model]]\nname = \"m\"\n".to_owned();
        let set = [
            "section.width_m=2.5",
            "name=other deck",
            "flutter.speeds=7",
            "model.name=n",
            "report.date=2026-11-26",
        ];
        let changed = with_values(text.clone(), &set.map(str::to_owned)).unwrap();
        let table: toml::Table = toml::from_str(&changed).unwrap();
        assert_eq!(table["section"]["width_m"].as_float(), Some(2.5));
        assert_eq!(table["name"].as_str(), Some("other deck"));
        assert_eq!(table["flutter"]["speeds"].as_integer(), Some(7));
        assert_eq!(table["model"][0]["name"].as_str(), Some("n"));
        assert_eq!(table["report"]["date"].as_str(), Some("2026-11-26"));
        for wrong in ["nonsense", "name.x=1"] {
            assert!(with_values(text.clone(), &[wrong.to_owned()]).is_err());
        }
        assert_eq!(with_values(text.clone(), &[]).unwrap(), text);
    }
}
