//! Where in an input something stands: line, key, column, or a part in words.

use std::fmt;

/// Where something stands, from the outside in: `line 8, torsion.stiffness_n`, `run 3, column time_s`.
///
/// A text becomes a place once, where an error is made: `flutter.speeds[2]` three parts, anything else one part in words.
/// From there on the parts are values that a caller can ask for.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Place {
    /// Line of the file, from 1.
    pub line: Option<u64>,
    /// What is named there, from the outside in.
    pub parts: Vec<PlaceStep>,
}

/// One step of a [`Place`] into an input.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PlaceStep {
    /// A key of a table.
    Key(String),
    /// An entry of the list named before, from 0.
    Index(usize),
    /// A column of a table of rows.
    Column(String),
    /// A run, a channel, a sample, in words.
    Words(String),
    /// What the part before it is about.
    About(String),
}

impl Place {
    /// A line, from 1.
    #[must_use]
    pub fn line(line: impl TryInto<u64>) -> Self {
        Self {
            line: line.try_into().ok(),
            parts: Vec::new(),
        }
    }

    /// A column of what this is a row of.
    #[must_use]
    pub fn column(self, name: impl fmt::Display) -> Self {
        self.and(PlaceStep::Column(name.to_string()))
    }

    /// The key below this one.
    #[must_use]
    pub fn key(&self, key: &str) -> Self {
        self.clone().and(PlaceStep::Key(key.to_owned()))
    }

    /// What it is about, behind it.
    #[must_use]
    pub fn about(self, what: impl fmt::Display) -> Self {
        self.and(PlaceStep::About(what.to_string()))
    }

    /// This place inside another one; lines are counted where they were.
    #[must_use]
    pub fn within(self, outer: impl Into<Self>) -> Self {
        let outer = outer.into();
        let mut parts = outer.parts;
        // lines of two files have no order
        parts.extend(
            self.line
                .map(|line| PlaceStep::Words(format!("line {line}"))),
        );
        parts.extend(self.parts);
        Self {
            line: outer.line,
            parts,
        }
    }

    /// Whether nothing is named.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.line.is_none() && self.parts.is_empty()
    }

    /// The same with at most a line of every text that an input gave.
    pub(super) fn quoted(mut self) -> Self {
        for part in &mut self.parts {
            if let PlaceStep::Key(text)
            | PlaceStep::Column(text)
            | PlaceStep::Words(text)
            | PlaceStep::About(text) = part
            {
                *text = quoted(std::mem::take(text));
            }
        }
        self
    }

    fn and(mut self, part: PlaceStep) -> Self {
        self.parts.push(part);
        self
    }
}

/// Characters of an input that a message shows at most.
const QUOTED_AT_MOST: usize = 300;

/// At most a line of what stood in an input, cut where it is long.
pub(super) fn quoted(text: String) -> String {
    // control characters of an input may not reach a terminal
    let is_short = text.len() <= QUOTED_AT_MOST && !text.contains(char::is_control);
    if is_short {
        return text;
    }
    let line = text.replace(char::is_control, " ");
    match line.char_indices().nth(QUOTED_AT_MOST) {
        None => line,
        Some((end, _)) => format!("{} … ({} characters)", &line[..end], line.chars().count()),
    }
}

/// `torsion.frequency[2]` as its parts; `None` for words.
fn keys(text: &str) -> Option<Vec<PlaceStep>> {
    let mut parts = Vec::new();
    for step in text.split('.') {
        let (name, indices) = step.split_once('[').unwrap_or((step, ""));
        let is_key = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        if name.is_empty() || !name.chars().all(is_key) {
            return None;
        }
        parts.push(PlaceStep::Key(name.to_owned()));
        if let Some(index) = indices.strip_suffix(']') {
            parts.push(PlaceStep::Index(index.parse().ok()?));
        } else if step.contains('[') {
            return None;
        }
    }
    Some(parts)
}

impl From<&str> for Place {
    fn from(text: &str) -> Self {
        let words = || vec![PlaceStep::Words(text.to_owned())];
        Self {
            line: None,
            parts: match text {
                "" => Vec::new(),
                _ => keys(text).unwrap_or_else(words),
            },
        }
    }
}

impl From<String> for Place {
    fn from(text: String) -> Self {
        text.as_str().into()
    }
}

impl From<fmt::Arguments<'_>> for Place {
    fn from(text: fmt::Arguments<'_>) -> Self {
        text.to_string().into()
    }
}

impl From<&String> for Place {
    fn from(text: &String) -> Self {
        text.as_str().into()
    }
}

impl From<&Place> for Place {
    fn from(place: &Place) -> Self {
        place.clone()
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut before: Option<&PlaceStep> = None;
        if let Some(line) = self.line {
            write!(f, "line {line}")?;
        }
        for part in &self.parts {
            let after_key = matches!(before, Some(PlaceStep::Key(_) | PlaceStep::Index(_)));
            let first = before.is_none() && self.line.is_none();
            match part {
                PlaceStep::Key(_) if after_key => f.write_str(".")?,
                PlaceStep::Index(_) | PlaceStep::About(_) => {}
                _ if first => {}
                _ => f.write_str(", ")?,
            }
            match part {
                PlaceStep::Key(text) | PlaceStep::Words(text) => f.write_str(text)?,
                PlaceStep::Index(index) => write!(f, "[{index}]")?,
                PlaceStep::Column(name) => write!(f, "column {name}")?,
                PlaceStep::About(what) => write!(f, " ({what})")?,
            }
            before = Some(part);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said is what was given, whether or not it is taken apart.
    #[test]
    fn a_place_reads_as_it_was_written() {
        for text in [
            "",
            "step",
            "torsion.stiffness_n",
            "sections[2].sway.mass_kg_m",
            "run 3, `pitot`, sample 7",
            "t = 2.000 s",
            "a..b",
            "list[two]",
            "list[2",
        ] {
            assert_eq!(Place::from(text).to_string(), text);
        }
        let place = Place::line(8).column("time_s").within("run 3");
        assert_eq!(place.to_string(), "run 3, line 8, column time_s");
        let place = Place::line(4).about("width_m");
        assert_eq!(place.to_string(), "line 4 (width_m)");
    }

    #[test]
    fn no_escape_of_an_input_reaches_a_terminal() {
        assert_eq!(quoted("a\u{1b}[2Jb\nc".to_owned()), "a [2Jb c");
    }

    #[test]
    fn keys_are_parts_and_words_are_not() {
        let place = Place::from("sections[2].mass").key("unit");
        let key = |k: &str| PlaceStep::Key(k.to_owned());
        let expected = [
            key("sections"),
            PlaceStep::Index(2),
            key("mass"),
            key("unit"),
        ];
        assert_eq!(place.parts, expected);
        let words = Place::from("run 3");
        assert_eq!(words.parts, [PlaceStep::Words("run 3".to_owned())]);
    }
}
