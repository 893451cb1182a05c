//! `aerodeck new`: a commented study to begin with.

use super::text::deck_warnings;
use super::vocabulary::{Answer, Error, OutputDir, Result, Study, Written, folder_of, list};
use crate::aerodynamics::derivatives::notation::{Argument, Axes, Notation};
use crate::files::derivatives::{StatedConvention, is_table_file, named_sheet};
use crate::section::{Rotation, STANDARD_AIR_DENSITY_KG_M3, SectionModel, Translation};
use crate::study::bridge::new_bridge_text;
use crate::study::{Deck, example_wind_study_text, new_study_text};
use clap::ArgGroup;
use std::ffi::OsStr;
use std::io::{BufRead, Write, stderr, stdin};
use std::path::{Path, PathBuf};

/// The flags that ask for a file of another kind, one at most.
const INSTEAD: &str = "instead";

/// Write a commented study file for an embedded deck, the flat plate or a table of your own; or a file of another kind
///
/// Example: aerodeck new --workbook AerodynamicDerivatives_LN21_5200.xlsx --out my-bridge.toml
/// Example: aerodeck new --interactive
/// Example: aerodeck new --bridge
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
#[command(group = ArgGroup::new(INSTEAD).conflicts_with_all(["deck", "workbook", "interactive"]))]
pub(crate) struct NewArgs {
    /// An embedded deck (LN20-5500, LN21-5200, LN21-5500, LN21-5800, LN21-6100) or `flat plate`.
    #[arg(long, default_value = "LN21-5200")]
    deck: String,
    /// A table of derivatives of your own (.xlsx, .xls, .ods, .csv).
    #[arg(long, conflicts_with = "deck")]
    workbook: Option<PathBuf>,
    /// The sheet of the workbook that is meant, where several hold derivatives.
    #[arg(long, requires = "workbook")]
    sheet: Option<String>,
    /// Notation of the table, where it does not state it: scanlan, simiu, classical, polimi, starossek.
    #[arg(long, value_name = "NOTATION", requires = "workbook")]
    from: Option<Notation>,
    /// What the table is tabulated over: v_hat = V/(omega B), v_star = V/(f B), k_full = omega B/V, k_semi = omega b/V.
    #[arg(long, value_name = "ARGUMENT", requires = "workbook")]
    from_argument: Option<Argument>,
    /// Direction of heave and lift in the table: heave_up, heave_down.
    #[arg(long, value_name = "AXES", requires = "workbook")]
    from_axes: Option<Axes>,
    /// Ask for deck and section: five questions.
    #[arg(long, conflicts_with_all = ["deck", "workbook"])]
    interactive: bool,
    /// A file of a whole bridge instead, for `aerodeck bridge`.
    #[arg(long, group = INSTEAD)]
    bridge: bool,
    /// A file of wind on a section instead, for `aerodeck buffeting` and `aerodeck quasi-steady`.
    #[arg(long, group = INSTEAD)]
    wind: bool,
    /// A file of raw wind-tunnel runs instead, for `aerodeck campaign` and `aerodeck process`.
    #[arg(long, group = INSTEAD)]
    campaign: bool,
    /// A file of scatter instead, for `aerodeck monte-carlo`.
    #[arg(long, group = INSTEAD)]
    monte_carlo: bool,
    /// The file [default: study.toml, bridge.toml, wind.toml, campaign.toml or scatter.toml].
    #[arg(long)]
    out: Option<PathBuf>,
    /// Replace a file that differs.
    #[arg(long)]
    force: bool,
}

/// Runs the command.
pub(crate) fn run(args: &NewArgs) -> Result<Answer> {
    if let Some([usual, text, next]) = args.template() {
        let path = args.out.clone().unwrap_or_else(|| usual.into());
        let written = args.leave(&path, text)?;
        let said = format!("{}{next} {}`\n", list(&written), path.display());
        return Answer::new(said, &serde_json::json!({ "files": written }));
    }
    let path = args.out.clone().unwrap_or_else(|| "study.toml".into());
    let folder = folder_of(&path);
    file_name(&path)?;
    let answers = match args.interactive {
        true => Some(ask(&mut stdin().lock(), &mut stderr())?),
        false => None,
    };
    let named = answers.as_ref().map_or(&args.deck, |(source, _)| source);
    let source = match &args.workbook {
        Some(table) => named_sheet(&beside(table, folder)?, args.sheet.as_deref()),
        None if is_table_file(named) => beside(Path::new(named), folder)?,
        None => named.clone(),
    };
    let convention = StatedConvention {
        notation: args.from,
        argument: args.from_argument,
        axes: args.from_axes,
    };
    let mut text = new_study_text(&source, &convention);
    if let Some((_, section)) = &answers {
        text = stated_in(&text, section);
    }
    let study = Study::from_toml(&text, folder.to_path_buf())?;
    let deck = Deck::load(&study)?;
    let written = args.leave(&path, &text)?;
    let mut said = format!("{}\n", deck.description());
    said.push_str(&deck_warnings(&deck));
    said.push_str(&format!(
        "{}{}run `aerodeck study {}`\n",
        list(&written),
        match args.interactive {
            true => "",
            false => "state your section in it, then ",
        },
        path.display()
    ));
    let value = serde_json::json!({ "deck": deck.description(), "warnings": deck.warnings(), "files": written });
    Answer::new(said, &value)
}

/// The last part of a path.
fn file_name(path: &Path) -> Result<&OsStr> {
    path.file_name().ok_or_else(|| {
        let found = path.display().to_string();
        Error::input("--out", "the name of a file", found)
    })
}

impl NewArgs {
    /// Of a file of another kind, which needs no more than to be edited: its usual name, its text, and what is to be done with it.
    fn template(&self) -> Option<[&'static str; 3]> {
        let all = [
            (
                self.bridge,
                "bridge.toml",
                new_bridge_text(),
                "state your bridge in it, then run `aerodeck bridge flutter",
            ),
            (
                self.wind,
                "wind.toml",
                example_wind_study_text(),
                "state your section and its wind in it, then run `aerodeck buffeting",
            ),
            (
                self.campaign,
                "campaign.toml",
                include_str!("new/campaign.toml"),
                "state your rig, channels and files in it, then run `aerodeck campaign check",
            ),
            (
                self.monte_carlo,
                "scatter.toml",
                include_str!("new/monte_carlo.toml"),
                "name your model in it, then run `aerodeck monte-carlo",
            ),
        ];
        let wanted = all.into_iter().find(|(wanted, ..)| *wanted);
        wanted.map(|(_, usual, text, next)| [usual, text, next])
    }

    fn leave(&self, path: &Path, text: &str) -> Result<Vec<Written>> {
        let name = file_name(path)?;
        let mut out = OutputDir::new(folder_of(path))?;
        out.write(name, text)?;
        out.refuse_edited(&name.to_string_lossy(), self.force, "choose another --out")?;
        out.commit()
    }
}

/// The path of a table as the study in `folder` has to name it.
fn beside(table: &Path, folder: &Path) -> Result<String> {
    let full = |path: &Path| path.canonicalize().map_err(|e| Error::io(path, e));
    let table_folder = full(folder_of(table))?;
    std::fs::create_dir_all(folder).map_err(|e| Error::io(folder, e))?;
    let name = Path::new(table.file_name().unwrap_or_default());
    let inside = table_folder.strip_prefix(full(folder)?);
    let path = match inside {
        Ok(below) => below.join(name),
        Err(_) => table_folder.join(name),
    };
    Ok(path.to_string_lossy().replace('\\', "/"))
}

/// What is asked: the question, what its answer is called in messages, and how many numbers it has.
const NUMBERS: [(&str, usize); 4] = [
    ("Width B of the deck, m", 1),
    ("Mass, kg/m, and mass moment of inertia, kg m2/m", 2),
    ("Vertical and torsional natural frequency, Hz", 2),
    ("Damping ratio of both motions, % of critical", 1),
];

/// The text of a new study with this section in place of its example.
fn stated_in(text: &str, section: &SectionModel) -> String {
    let mut is_section = false;
    let line = |line: &str| {
        is_section = match line.strip_prefix('[') {
            Some(table) => table.starts_with("section]"),
            None => is_section,
        };
        let key = line.split(" = ").next().unwrap_or_default();
        match stated(key, section).filter(|_| is_section) {
            Some(stated) => format!("{stated}\n"),
            None => format!("{line}\n"),
        }
    };
    text.lines().map(line).collect()
}

/// The line of a key of the section.
fn stated(key: &str, s: &SectionModel) -> Option<String> {
    let spring = |frequency_hz: Option<f64>, ratio| {
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
            spring(heave.frequency_hz, heave.damping_ratio)
        ),
        "torsion" => format!(
            "torsion = {{ inertia_kg_m2_m = {:?}, {}",
            turn.inertia_kg_m2_m,
            spring(turn.frequency_hz, turn.damping_ratio)
        ),
        _ => return None,
    })
}

/// Asks the five questions, each until it is answered, on `out`: where the derivatives come from (a deck, `flat plate` or a file), and
/// the section.
///
/// # Errors
/// [`Error::Input`] with the question at which the answers end.
fn ask(answers: &mut dyn BufRead, out: &mut dyn Write) -> Result<(String, SectionModel)> {
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
    Ok((source, section))
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
            let (expected, found) = (format!("an answer to: {question}"), "the end of the input");
            return Err(Error::input("--interactive", expected, found));
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
    use super::{ask, stated_in};
    use crate::files::derivatives::StatedConvention;
    use crate::study::{Study, new_study_text};

    #[test]
    fn wrong_answers_are_asked_again_and_missing_ones_refused() {
        let mut said = Vec::new();
        let answers = "LN21-5200\nwide\n31,0\n15\n22740 2.47e6\n0.100, 0.278\n0.35\n";
        let (source, stated) = ask(&mut answers.as_bytes(), &mut said).unwrap();
        assert_eq!(source, "LN21-5200");
        let text = new_study_text(&source, &StatedConvention::default());
        let study = Study::from_toml(&stated_in(&text, &stated), "".into()).unwrap();
        assert_eq!(study.section, stated);
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
