//! `aerodeck derivatives`: tables of derivatives, shown and converted between notations.

use super::figures;
use super::vocabulary::{Answer, Error, OutputDir, Result, ensure, folder_of, sentences};
use crate::aerodynamics::derivatives::notation::{
    Argument, Axes, Convention, ExpressedDerivative, ExpressedPoint, ExpressedTable, Notation,
};
use crate::aerodynamics::derivatives::{DerivativeTable, Missing};
use crate::files::derivatives::{
    ReadOptions, StatedConvention, embedded, file_and_sheet, is_table_file, named_sheet,
    read_table_with, template_bytes, workbook_bytes_in, write_csv_in,
};
use crate::plausibility::of_table;
use crate::report::axes_sketch;
use crate::signal::extremes;
use clap::Subcommand;
use std::ffi::OsStr;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Show tables of aerodynamic derivatives and convert them between notations
#[derive(Subcommand)]
pub(crate) enum Derivatives {
    /// Write a table of derivatives in another notation, argument or axes; the result states them
    ///
    /// Example: aerodeck derivatives convert LN21-5200 polimi.csv --to polimi
    #[command(verbatim_doc_comment)]
    Convert {
        #[command(flatten)]
        table: TableArgs,
        /// The result (.csv, .xlsx).
        out: PathBuf,
    },
    /// Show a table of derivatives: where it comes from, its convention, ranges or all its points
    ///
    /// Example: aerodeck derivatives show LN21-5200 --to polimi
    #[command(verbatim_doc_comment)]
    Show {
        #[command(flatten)]
        table: TableArgs,
        /// Every test point instead of the ranges.
        #[arg(long)]
        points: bool,
    },
    /// List the notations, arguments and axes that are understood; draw the axes
    ///
    /// Example: aerodeck derivatives notations --sketch figures
    #[command(verbatim_doc_comment)]
    Notations {
        /// Folder into which a sketch of the axes is drawn (axes.svg).
        #[arg(long)]
        sketch: Option<PathBuf>,
    },
    /// Write an empty workbook to be filled with a table of derivatives, with instructions
    ///
    /// Example: aerodeck derivatives template table.xlsx --notation polimi
    #[command(verbatim_doc_comment)]
    Template {
        /// The workbook (.xlsx).
        out: PathBuf,
        /// Notation of the columns.
        #[arg(long, default_value = "scanlan")]
        notation: Notation,
        /// Replace a file that is there.
        #[arg(long)]
        force: bool,
    },
}

/// Runs the command.
pub(crate) fn run(command: &Derivatives) -> Result<Answer> {
    match command {
        Derivatives::Convert { table, out } => convert(table, out),
        Derivatives::Show { table, points } => show(table, *points),
        Derivatives::Notations { sketch } => notations(sketch.as_deref()),
        Derivatives::Template {
            out,
            notation,
            force,
        } => template(out, *notation, *force),
    }
}

/// A table and its conventions.
#[derive(clap::Args)]
pub(crate) struct TableArgs {
    /// Table of derivatives (.csv, .xlsx, .xls, .ods), or the name of an embedded deck.
    table: String,
    /// The sheet of a workbook that is meant, where several hold derivatives.
    #[arg(long)]
    sheet: Option<String>,
    /// Notation of the file: scanlan, simiu, classical, polimi, starossek. A CSV file states it itself; what is stated here must
    /// not contradict it.
    #[arg(long, value_name = "NOTATION")]
    from: Option<Notation>,
    /// What the file is tabulated over: v_hat = V/(omega B), v_star = V/(f B), k_full = omega B/V, k_semi = omega b/V.
    #[arg(long, value_name = "ARGUMENT")]
    from_argument: Option<Argument>,
    /// Direction of heave and lift in the file: heave_up, heave_down.
    #[arg(long, value_name = "AXES")]
    from_axes: Option<Axes>,
    /// Notation of the result; by default scanlan.
    #[arg(long, value_name = "NOTATION")]
    to: Option<Notation>,
    /// What the result is tabulated over; by default what is usual for the notation.
    #[arg(long, value_name = "ARGUMENT")]
    to_argument: Option<Argument>,
    /// Direction of heave and lift in the result; by default what is usual for the notation.
    #[arg(long, value_name = "AXES")]
    to_axes: Option<Axes>,
    /// Width of the section model, m; by default what the file states, and for a workbook what follows from the frequencies.
    #[arg(long)]
    width_m: Option<f64>,
    /// What stands for H4*, A4* in a table without them: zero (as when nothing is stated), quasi_steady (K H2*, K A2*).
    #[arg(long, value_name = "HOW")]
    missing: Option<Missing>,
    /// Frequencies of motion of a workbook in test order, Hz, with commas between them; by default those of the NTNU
    /// tests.
    #[arg(long, value_delimiter = ',')]
    frequencies_hz: Vec<f64>,
}

impl TableArgs {
    /// The convention of the result.
    fn target(&self) -> Convention {
        let stated = StatedConvention {
            notation: self.to,
            argument: self.to_argument,
            axes: self.to_axes,
        };
        stated.or_usual()
    }

    /// The table and the convention it was in.
    fn read(&self) -> Result<(DerivativeTable, Convention)> {
        let stated = StatedConvention {
            notation: self.from,
            argument: self.from_argument,
            axes: self.from_axes,
        };
        if is_table_file(&self.table) {
            let options = ReadOptions {
                convention: stated,
                width_m: self.width_m,
                missing: self.missing,
                frequencies_hz: (!self.frequencies_hz.is_empty())
                    .then(|| self.frequencies_hz.clone()),
                ..ReadOptions::default()
            };
            return read_table_with(named_sheet(&self.table, self.sheet.as_deref()), &options);
        }
        let table = embedded::deck_where_files_are_taken(&self.table)?;
        let convention = stated.with_file(Convention::default().into())?;
        Ok((table, convention))
    }
}

/// The name of a file that is to be written, if it ends as one of a known kind.
fn named<'a>(path: &'a Path, endings: &[&str]) -> Result<&'a OsStr> {
    let known = |end: &OsStr| endings.iter().any(|e| end.eq_ignore_ascii_case(e));
    let name = path.file_name();
    let name = name.filter(|_| path.extension().is_some_and(known));
    name.ok_or_else(|| {
        let expected = format!("a file name that ends in .{}", endings.join(" or ."));
        Error::input("out", expected, path.display().to_string())
    })
}

fn convert(args: &TableArgs, result: &Path) -> Result<Answer> {
    let name = named(result, &["csv", "xlsx"])?;
    let (table, from) = args.read()?;
    let to = args.target();
    refuse_own_input(args, result)?;
    let bytes = if named(result, &["xlsx"]).is_ok() {
        workbook_bytes_in(&table, &to)?
    } else {
        let mut bytes = Vec::new();
        write_csv_in(&table, &to, &mut bytes).map_err(|e| Error::io(result, e))?;
        bytes
    };
    let mut out = OutputDir::new(folder_of(result))?;
    out.write(name, bytes)?;
    let (name, count) = (&table.name, table.derivatives().count());
    let mut text = format!("{name}: {count} derivatives\n  from {from}\n  to   {to}\n");
    let warnings = warnings(&table, &from, &mut text);
    let value =
        serde_json::json!({ "table": table.name, "from": from, "to": to, "warnings": warnings });
    out.answer(text, value)
}

/// The table that is read stays as it is.
fn refuse_own_input(args: &TableArgs, result: &Path) -> Result<()> {
    let place = |path: &Path| path.canonicalize().ok();
    let input = place(file_and_sheet(&args.table).0.as_ref());
    let other = input.is_none() || input != place(result);
    let expected = "another file than the table that is read";
    ensure(other, "out", expected, "that, which was left as it is").map_err(|e| e.in_file(result))
}

/// What the reader took for granted and what looks wrong, also as lines of the text.
fn warnings(table: &DerivativeTable, from: &Convention, text: &mut String) -> Vec<String> {
    let found = sentences(&of_table(table, from));
    let warnings = [table.header.notes.clone(), found].concat();
    let lines = warnings.iter();
    text.extend(lines.map(|warning| format!("  warning: {warning}\n")));
    warnings
}

fn show(args: &TableArgs, each_point: bool) -> Result<Answer> {
    let (table, from) = args.read()?;
    let expressed = args.target().express(&table);
    let mut text = head(&table, &from, &expressed.convention);
    let warnings = warnings(&table, &from, &mut text);
    for derivative in &expressed.derivatives {
        let symbol = expressed.convention.symbol(derivative.derivative);
        if each_point {
            let _ = writeln!(text, "  {symbol}");
            for p in &derivative.points {
                let speed = p.mean_speed_m_s.map(|v| format!("{v:8.3} m/s"));
                let speed = speed.unwrap_or_default();
                let _ = writeln!(text, "{speed:>16}{:12.5}{:14.6}", p.argument, p.value);
            }
        } else {
            text.push_str(&ranges(&symbol, derivative, &expressed));
        }
    }
    let value = serde_json::json!({
        "source": table.header.source,
        "licence": table.header.licence,
        "in_file": from,
        "warnings": warnings,
        "table": expressed,
    });
    Answer::new(text, &value)
}

fn head(table: &DerivativeTable, from: &Convention, shown: &Convention) -> String {
    let mut text = format!("{}: {}\n", table.name, table.header.source);
    let speeds = table.speed_groups();
    let range = table.tested_range(table.dofs());
    let _ = write!(text, "  width {:.4} m", table.width_m);
    if !speeds.is_empty() {
        let words: Vec<_> = speeds.iter().map(|v| format!("{v:.2}")).collect();
        let _ = write!(text, ", mean speeds {} m/s", words.join(", "));
    }
    let [low, high] = [range.min, range.max].map(|k| k.full_width());
    let _ = writeln!(text, ", all tested between K = {low:.4} and {high:.4}");
    let _ = writeln!(text, "  in the file: {from}");
    if from != shown {
        let _ = writeln!(text, "  shown:       {shown}");
    }
    text
}

fn ranges(symbol: &str, derivative: &ExpressedDerivative, table: &ExpressedTable) -> String {
    let span = |pick: fn(&ExpressedPoint) -> f64| extremes(derivative.points.iter().map(pick));
    let (from, to) = span(|p| p.argument);
    let (low, high) = span(|p| p.value);
    format!(
        "  {symbol:<6} {:>3} points, {} {from:.3} to {to:.3}, values {low:.4} to {high:.4}\n",
        derivative.points.len(),
        table.convention.argument
    )
}

fn notations(sketch: Option<&Path>) -> Result<Answer> {
    let mut text = String::from("notation\n");
    for notation in Notation::NAMED {
        let usual = Convention::usual(notation);
        let (title, also, names) = (notation.title(), also(notation), notation.names());
        let (argument, axes, definition) = (usual.argument, usual.axes, notation.definition());
        text +=
            &format!("  {notation:<10} {title}{also}; {names}; usually over {argument}, {axes}\n");
        text += &format!("             {definition}\n");
    }
    text.push_str("argument\n");
    for argument in Argument::ALL {
        let _ = writeln!(text, "  {argument:<10} {}", argument.definition());
    }
    text.push_str("axes\n");
    for axes in Axes::ALL {
        let _ = writeln!(text, "  {axes:<10} {}", axes.words());
    }
    let notations = Notation::NAMED.map(|n| {
        serde_json::json!({
            "notation": n,
            "aliases": n.aliases(),
            "title": n.title(),
            "usual_argument": Convention::usual(n).argument,
            "usual_axes": Convention::usual(n).axes,
            "definition": n.definition(),
        })
    });
    let value = serde_json::json!({ "notations": notations, "files": [] });
    let Some(folder) = sketch else {
        return Answer::new(text, &value);
    };
    let mut out = OutputDir::new(folder)?;
    figures::write("axes", &mut out, || Ok(axes_sketch()))?;
    out.answer(text, value)
}

/// Other words for a notation.
fn also(notation: Notation) -> String {
    match notation.aliases() {
        [] => String::new(),
        words => format!(" (also {})", words.join(", ")),
    }
}

fn template(workbook: &Path, notation: Notation, force: bool) -> Result<Answer> {
    let name = named(workbook, &["xlsx"])?;
    let expected = "no file there yet (or --force)";
    let free = force || !workbook.exists();
    ensure(free, "out", expected, "one, which was left as it is")
        .map_err(|e| e.in_file(workbook))?;
    let convention = StatedConvention {
        notation: Some(notation),
        ..StatedConvention::default()
    };
    let convention = convention.or_usual();
    let mut out = OutputDir::new(folder_of(workbook))?;
    out.write(name, template_bytes(&convention)?)?;
    let text = format!("a table to be filled in: {convention}\n");
    out.answer(text, serde_json::json!({ "convention": convention }))
}
