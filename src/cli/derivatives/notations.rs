//! `aerodeck derivatives notations`: the notations that are understood, with their definitions.

use crate::aerodynamics::derivatives::notation::{Argument, Axes, Notation};
use crate::cli::answer::Answer;
use crate::cli::output::{OutputDir, list};
use crate::error::Result;
use crate::report::{PNG_SCALE, axes_sketch};
use std::fmt::Write as _;
use std::path::PathBuf;

/// List the notations, arguments and axes that are understood; draw the axes
///
/// Example: aerodeck derivatives notations --sketch figures
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct Args {
    /// Folder into which a sketch of the axes is drawn (axes.svg, axes.png).
    #[arg(long)]
    sketch: Option<PathBuf>,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Answer> {
    let mut text = String::from("notation\n");
    for notation in Notation::ALL {
        let _ = writeln!(
            text,
            "  {notation:<10} {}; {}; usually over {}, {}\n             {}",
            notation.title(),
            notation.names(),
            notation.usual_argument(),
            notation.usual_axes(),
            notation.definition()
        );
    }
    text.push_str("argument\n");
    for argument in Argument::ALL {
        let _ = writeln!(text, "  {argument:<10} {}", argument.definition());
    }
    text.push_str("axes\n");
    for axes in Axes::ALL {
        let _ = writeln!(text, "  {axes:<10} {}", axes.words());
    }
    let mut written = Vec::new();
    if let Some(folder) = &args.sketch {
        let figure = axes_sketch();
        let mut out = OutputDir::new(folder)?;
        out.write("axes.svg", figure.svg())?;
        out.write("axes.png", figure.png(PNG_SCALE)?)?;
        written = out.commit()?;
        text.push_str(&list(&written));
    }
    let notations = Notation::ALL.map(|n| {
        serde_json::json!({
            "notation": n,
            "title": n.title(),
            "usual_argument": n.usual_argument(),
            "usual_axes": n.usual_axes(),
            "definition": n.definition(),
        })
    });
    Answer::new(
        text,
        &serde_json::json!({ "notations": notations, "files": written }),
    )
}
