//! `aerodeck derivatives show`: what is in a table of derivatives.

use super::TableArgs;
use crate::aerodynamics::derivatives::DerivativeTable;
use crate::aerodynamics::derivatives::notation::{Convention, ExpressedDerivative, ExpressedTable};
use crate::cli::answer::Answer;
use crate::error::Result;
use std::fmt::Write as _;

/// Show a table of derivatives: where it comes from, its convention, ranges or all its points
///
/// Example: aerodeck derivatives show LN21-5200 --to polimi
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub(crate) struct Args {
    #[command(flatten)]
    table: TableArgs,
    /// Every test point instead of the ranges.
    #[arg(long)]
    points: bool,
}

/// Runs the command.
pub fn run(args: &Args) -> Result<Answer> {
    let (table, from) = args.table.read()?;
    let expressed = args.table.target().express(&table);
    let mut text = head(&table, &from, &expressed.convention);
    let warnings: Vec<String> = table
        .header
        .notes
        .iter()
        .cloned()
        .chain(table.hints(&from))
        .collect();
    for warning in &warnings {
        let _ = writeln!(text, "  warning: {warning}");
    }
    for derivative in &expressed.derivatives {
        let symbol = expressed.convention.symbol(derivative.derivative);
        if args.points {
            let _ = writeln!(text, "  {symbol}");
            for p in &derivative.points {
                let speed = p
                    .mean_speed_m_s
                    .map_or_else(String::new, |v| format!("{v:8.3} m/s"));
                let _ = writeln!(text, "{speed:>16}{:12.5}{:14.6}", p.argument, p.value);
            }
        } else {
            text.push_str(&ranges(&symbol, derivative, &expressed));
        }
    }
    Answer::new(
        text,
        &serde_json::json!({
            "source": table.header.source,
            "licence": table.header.licence,
            "in_file": from,
            "warnings": warnings,
            "table": expressed,
        }),
    )
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
    let _ = writeln!(
        text,
        ", all tested between K = {:.4} and {:.4}",
        range.min.full_width(),
        range.max.full_width()
    );
    let _ = writeln!(text, "  in the file: {from}");
    if from != shown {
        let _ = writeln!(text, "  shown:       {shown}");
    }
    text
}

fn ranges(symbol: &str, derivative: &ExpressedDerivative, table: &ExpressedTable) -> String {
    let span = |pick: fn(&crate::aerodynamics::derivatives::notation::ExpressedPoint) -> f64| {
        let values = || derivative.points.iter().map(pick);
        (
            values().fold(f64::INFINITY, f64::min),
            values().fold(f64::NEG_INFINITY, f64::max),
        )
    };
    let (from, to) = span(|p| p.argument);
    let (low, high) = span(|p| p.value);
    format!(
        "  {symbol:<6} {:>3} points, {} {from:.3} to {to:.3}, values {low:.4} to {high:.4}\n",
        derivative.points.len(),
        table.convention.argument
    )
}
