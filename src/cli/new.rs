//! `aerodeck new`: a commented study to begin with.

mod questions;

use super::answer::Answer;
use super::common::folder_of;
use super::output::{OutputDir, Written, list};
use crate::aerodynamics::derivatives::notation::{Argument, Axes, Notation, StatedConvention};
use crate::error::{Error, Result};
use crate::files::derivatives::{is_table_file, named_sheet};
use crate::study::bridge::new_bridge_text;
use crate::study::{Deck, Study, example_wind_study_text, new_study_text};
use std::ffi::OsStr;
use std::io::{stderr, stdin};
use std::path::{Path, PathBuf};

/// Write a commented study file for an embedded deck, the flat plate or a table of your own; or a file of another kind
///
/// Example: aerodeck new --workbook AerodynamicDerivatives_LN21_5200.xlsx --out my-bridge.toml
/// Example: aerodeck new --interactive
/// Example: aerodeck new --bridge
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct NewArgs {
    /// An embedded deck (see `aerodeck derivatives show --help`) or `flat plate`.
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
    #[command(flatten)]
    instead: Instead,
    /// The file [default: study.toml, bridge.toml, wind.toml, campaign.toml or scatter.toml].
    #[arg(long)]
    out: Option<PathBuf>,
    /// Replace a file that differs.
    #[arg(long)]
    force: bool,
}

/// A file of another kind.
#[derive(clap::Args)]
#[group(multiple = false, conflicts_with_all = ["deck", "workbook", "interactive"])]
struct Instead {
    /// A file of a whole bridge instead, for `aerodeck bridge`.
    #[arg(long)]
    bridge: bool,
    /// A file of wind on a section instead, for `aerodeck buffeting` and `aerodeck quasi-steady`.
    #[arg(long)]
    wind: bool,
    /// A file of raw wind-tunnel runs instead, for `aerodeck campaign` and `aerodeck process`.
    #[arg(long)]
    campaign: bool,
    /// A file of scatter instead, for `aerodeck monte-carlo`.
    #[arg(long)]
    monte_carlo: bool,
}

impl Instead {
    /// Its usual name, its text and what to do with it.
    fn template(&self) -> Option<[&'static str; 3]> {
        match self {
            Self { bridge: true, .. } => Some([
                "bridge.toml",
                new_bridge_text(),
                "state your bridge in it, then run `aerodeck bridge flutter",
            ]),
            Self { wind: true, .. } => Some([
                "wind.toml",
                example_wind_study_text(),
                "state your section and its wind in it, then run `aerodeck buffeting",
            ]),
            Self { campaign: true, .. } => Some([
                "campaign.toml",
                include_str!("new/campaign.toml"),
                "state your rig, channels and files in it, then run `aerodeck campaign check",
            ]),
            Self {
                monte_carlo: true, ..
            } => Some([
                "scatter.toml",
                include_str!("new/monte_carlo.toml"),
                "name your model in it, then run `aerodeck monte-carlo",
            ]),
            _ => None,
        }
    }
}

/// Runs the command.
pub(crate) fn run(args: &NewArgs) -> Result<Answer> {
    if let Some([usual, text, next]) = args.instead.template() {
        return args.template(usual, text, next);
    }
    let path = args.out.clone().unwrap_or_else(|| "study.toml".into());
    let folder = folder_of(&path);
    file_name(&path)?;
    let answers = match args.interactive {
        true => Some(questions::ask(&mut stdin().lock(), &mut stderr())?),
        false => None,
    };
    let named = answers.as_ref().map_or(&args.deck, |a| &a.source);
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
    let text = new_study_text(&source, &convention);
    let text = answers
        .as_ref()
        .map_or(text.clone(), |a| a.stated_in(&text));
    let study = Study::from_toml(&text, folder.to_path_buf())?;
    let deck = Deck::load(&study)?;
    let written = args.leave(&path, &text)?;
    let mut said = format!("{}\n", deck.description());
    for warning in deck.warnings() {
        said.push_str(&format!("warning: deck: {warning}\n"));
    }
    said.push_str(&format!(
        "{}{}run `aerodeck study {}`\n",
        list(&written),
        match args.interactive {
            true => "",
            false => "state your section in it, then ",
        },
        path.display()
    ));
    Answer::new(
        said,
        &serde_json::json!({ "deck": deck.description(), "warnings": deck.warnings(), "files": written }),
    )
}

/// The last part of a path.
fn file_name(path: &Path) -> Result<&OsStr> {
    path.file_name().ok_or_else(|| {
        let found = path.display().to_string();
        Error::input("--out", "the name of a file", found)
    })
}

impl NewArgs {
    /// Writes a file that needs no more than to be edited.
    fn template(&self, usual: &str, text: &str, next: &str) -> Result<Answer> {
        let path = self.out.clone().unwrap_or_else(|| usual.into());
        let written = self.leave(&path, text)?;
        let said = format!("{}{next} {}`\n", list(&written), path.display());
        Answer::new(said, &serde_json::json!({ "files": written }))
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
