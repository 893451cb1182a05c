//! Five questions whose answers make a study.

use crate::error::{Error, Result};
use crate::section::{Rotation, STANDARD_AIR_DENSITY_KG_M3, SectionModel, Translation};
use std::io::{BufRead, Write};

/// What is asked: the question, what its answer is called in messages, and how many numbers it has.
const NUMBERS: [(&str, usize); 4] = [
    ("Width B of the deck, m", 1),
    ("Mass, kg/m, and mass moment of inertia, kg m2/m", 2),
    ("Vertical and torsional natural frequency, Hz", 2),
    ("Damping ratio of both motions, % of critical", 1),
];

/// Where the derivatives come from, and the section.
pub(super) struct Answers {
    /// A deck, `flat plate` or a file.
    pub(super) source: String,
    section: SectionModel,
}

impl Answers {
    /// The text of a new study with this section in place of its example.
    pub(super) fn stated_in(&self, text: &str) -> String {
        let mut is_section = false;
        let line = |line: &str| {
            is_section = match line.strip_prefix('[') {
                Some(table) => table.starts_with("section]"),
                None => is_section,
            };
            let key = line.split(" = ").next().unwrap_or_default();
            match self.line(key).filter(|_| is_section) {
                Some(stated) => format!("{stated}\n"),
                None => format!("{line}\n"),
            }
        };
        text.lines().map(line).collect()
    }

    fn line(&self, key: &str) -> Option<String> {
        let s = &self.section;
        let stated = |frequency_hz: Option<f64>, ratio| {
            let frequency_hz = frequency_hz.unwrap_or(f64::NAN);
            format!("frequency_hz = {frequency_hz:?}, damping_ratio = {ratio:?} }}")
        };
        let (heave, turn) = (&s.vertical, &s.torsion);
        Some(match key {
            "width_m" => format!("width_m = {:?}                # full width B", s.width_m),
            "air_density_kg_m3" => format!("air_density_kg_m3 = {:?}", s.air_density_kg_m3),
            "vertical" => format!(
                "vertical = {{ mass_kg_m = {:?}, {}",
                heave.mass_kg_m,
                stated(heave.frequency_hz, heave.damping_ratio)
            ),
            "torsion" => format!(
                "torsion = {{ inertia_kg_m2_m = {:?}, {}",
                turn.inertia_kg_m2_m,
                stated(turn.frequency_hz, turn.damping_ratio)
            ),
            _ => return None,
        })
    }
}

/// Asks the five questions, each until it is answered, on `out`.
///
/// # Errors
/// [`Error::Input`] with the question at which the answers end.
pub(super) fn ask(answers: &mut dyn BufRead, out: &mut dyn Write) -> Result<Answers> {
    let source = asked(
        answers,
        out,
        "Derivatives: an embedded deck, \"flat plate\", or your file (.xlsx, .ods, .csv)",
        |answer| match answer {
            "" => Err("an answer".to_owned()),
            name => Ok(name.to_owned()),
        },
    )?;
    let mut all = Vec::new();
    for (question, count) in NUMBERS {
        all.push(asked(answers, out, question, |a| numbers(a, count))?);
    }
    let [width, inertias, frequencies, damping] = &all[..] else {
        return Err(Error::Numerical("questions without answers".to_owned()));
    };
    // a decimal number of per cent, as it is written
    let ratio = (damping[0] * 1e4).round() / 1e6;
    let section = SectionModel::two_dof(
        width[0],
        STANDARD_AIR_DENSITY_KG_M3,
        Translation::new(inertias[0], frequencies[0], ratio),
        Rotation::new(inertias[1], frequencies[1], ratio),
    );
    section.structure()?;
    Ok(Answers { source, section })
}

/// Positive numbers of an answer; otherwise what was expected.
fn numbers(answer: &str, count: usize) -> std::result::Result<Vec<f64>, String> {
    // a decimal comma is one where no space follows
    let parts = answer.split([' ', ';']).map(|p| p.trim_matches(','));
    let parts = parts.filter(|p| !p.is_empty());
    let parsed: Option<Vec<f64>> = parts.map(|p| p.replace(',', ".").parse().ok()).collect();
    match parsed {
        Some(n) if n.len() == count && n.iter().all(|v| *v > 0.0 && v.is_finite()) => Ok(n),
        _ if count == 1 => Err("a positive number".to_owned()),
        _ => Err(format!("{count} positive numbers with a space between")),
    }
}

fn asked<T>(
    answers: &mut dyn BufRead,
    out: &mut dyn Write,
    question: &str,
    read: impl Fn(&str) -> std::result::Result<T, String>,
) -> Result<T> {
    let failed = |e| Error::io("standard input", e);
    loop {
        // who cannot see the question can still answer it
        let _ = write!(out, "{question}: ").and_then(|()| out.flush());
        let mut line = String::new();
        if answers.read_line(&mut line).map_err(failed)? == 0 {
            return Err(Error::input(
                "--interactive",
                format!("an answer to: {question}"),
                "the end of the input",
            ));
        }
        match read(line.trim()) {
            Ok(value) => return Ok(value),
            Err(expected) => {
                let _ = writeln!(out, "  expected {expected}, found `{}`", line.trim());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::ask;
    use crate::aerodynamics::derivatives::notation::StatedConvention;
    use crate::study::{Study, new_study_text};

    #[test]
    fn wrong_answers_are_asked_again_and_missing_ones_refused() {
        let mut said = Vec::new();
        let answers = "LN21-5200\nwide\n31,0\n15\n22740 2.47e6\n0.100, 0.278\n0.35\n";
        let found = ask(&mut answers.as_bytes(), &mut said).unwrap();
        assert_eq!(found.source, "LN21-5200");
        let text = new_study_text(&found.source, &StatedConvention::default());
        let study = Study::from_toml(&found.stated_in(&text), "".into()).unwrap();
        assert_eq!(study.section, found.section);
        let section = study.section;
        assert_eq!(section.torsion.inertia_kg_m2_m, 2.47e6);
        assert_eq!(
            (section.vertical.damping_ratio, section.width_m),
            (0.0035, 31.0)
        );
        let said = String::from_utf8(said).unwrap();
        assert!(said.contains("expected a positive number, found `wide`"));
        assert!(said.contains("expected 2 positive numbers with a space between, found `15`"));
        let error = ask(&mut "LN21-5200\n0.5\n".as_bytes(), &mut Vec::new()).err();
        let error = error.unwrap().to_string();
        assert!(error.contains("an answer to: Mass"), "{error}");
    }
}
