//! `aerodeck select`: how many filters, with which pole or decay factor.

use super::answer::Answer;
use super::common::StudyArgs;
use super::output::{OutputDir, list};
use super::progress::Progress;
use crate::error::{Error, Result};
use crate::identification::{Grid, GridAxis, TimeFit, TimeWeights};
use crate::report::{Figure, HeatMap, PNG_SCALE, heat_map_figure};
use crate::selection::{
    Cell, CellMetrics, MetricGrid, Selection, SelectionPlan, metric_grid, select,
};
use crate::study::{Deck, RecordSet, Study};
use crate::wind_tunnel::{Record, RecordSource};
use std::fmt::Write as _;

/// Choose the number of filters and their pole (or decay factor) by the error on records left out
///
/// Example: aerodeck select study.toml --filters 8 --values 25
#[derive(clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    #[command(flatten)]
    study: StudyArgs,
    /// Continuous filters over `L` and `p`, or the thesis's discrete ones over `L` and `α`.
    #[arg(long, value_enum, default_value_t = Kind::Continuous)]
    kind: Kind,
    /// Greatest number of filters.
    #[arg(long, default_value_t = 8)]
    filters: usize,
    /// Number of values of the pole or decay factor.
    #[arg(long, default_value_t = 25)]
    values: usize,
    /// Lowest value; by default half the lowest tested K, or α = 0.2.
    #[arg(long)]
    min: Option<f64>,
    /// Highest value; by default twice the highest tested K, or α = 0.98.
    #[arg(long)]
    max: Option<f64>,
    /// Frequency of motion at which forces are compared, Hz.
    #[arg(long, default_value_t = 1.1)]
    frequency: f64,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum Kind {
    Continuous,
    Discrete,
}

/// Runs the command.
pub fn run(args: &Args, progress: &Progress) -> Result<Answer> {
    let study = args.study.read()?;
    let deck = Deck::load(&study)?;
    let made: Vec<Record>;
    let measured: RecordSet;
    let records: Vec<&dyn RecordSource> = if study.deck.records.is_empty() {
        made = deck.virtual_records(&study)?;
        made.iter().map(|r| r as _).collect()
    } else {
        measured = RecordSet::measured(&study)?;
        measured.select(study.deck.speed_groups.as_deref())?
    };
    let axis = axis(args, &study, &records)?;
    let stage = progress.steps("fitting the grid");
    let grid = Grid::new(&records, axis, args.filters, &|p| {
        stage.at(p.records_done as u64, p.records as u64);
    })?;
    drop(stage);
    let plan = SelectionPlan {
        structure: study.section.structure()?,
        search: study.flutter.search(),
    };
    let stage = progress.steps("judging the cells");
    let total = grid.values().len() as u64;
    let selection = select(&grid, &plan, &|done| stage.at(done as u64, total))?;
    drop(stage);
    let stage = progress.stage("comparing forces");
    let metrics = metric_grid(&grid, &records, args.frequency)?;
    drop(stage);
    let mut out = OutputDir::new(&args.study.directory())?;
    for (stem, figure) in figures(&study, &selection, &metrics)? {
        out.write(format!("{stem}.svg"), figure.svg())?;
        out.write(format!("{stem}.png"), figure.png(PNG_SCALE)?)?;
    }
    let written = out.commit()?;
    let mut text = format!("{}\n{}\n\n", study.name, deck.description());
    text.push_str(&account(&selection));
    text.push_str(&list(&written));
    Answer::new(
        text,
        &serde_json::json!({ "selection": selection, "metrics": metrics, "files": written }),
    )
}

/// Values of the pole, logarithmic over the range of the pole searches; or of the decay factor.
fn axis(args: &Args, study: &Study, records: &[&dyn RecordSource]) -> Result<GridAxis> {
    if args.values < 2 {
        return Err(Error::input(
            "--values",
            "at least 2",
            args.values.to_string(),
        ));
    }
    let last = args.values as f64 - 1.0;
    if args.kind == Kind::Discrete {
        let (low, high) = (args.min.unwrap_or(0.2), args.max.unwrap_or(0.98));
        let given = study.models.iter().find_map(|m| m.discrete.as_ref());
        let weights = given.map_or(TimeWeights::None, |d| d.weights);
        let values = (0..args.values).map(|i| low + (high - low) * i as f64 / last);
        return Ok(GridAxis::Discrete(values.collect(), weights));
    }
    let fit = study
        .models
        .iter()
        .find_map(|m| m.records.clone())
        .unwrap_or_default();
    let ks = records.iter().flat_map(|r| {
        let h = r.header();
        let rate = h.mean_speed_m_s / h.width_m;
        h.segments
            .iter()
            .map(move |s| std::f64::consts::TAU * s.frequency_hz / rate)
    });
    let (low, high) = ks.fold((f64::INFINITY, 0.0_f64), |(a, b), k| (a.min(k), b.max(k)));
    let low = args.min.unwrap_or(0.5 * low);
    let high = args.max.unwrap_or(2.0 * high);
    if !(low > 0.0 && high > low && high.is_finite()) {
        return Err(Error::input(
            "--min, --max",
            "two poles, the lower one first (needed for records without segments)",
            format!("{low} and {high}"),
        ));
    }
    let values = (0..args.values).map(|i| low * (high / low).powf(i as f64 / last));
    let fit: TimeFit = fit;
    Ok(GridAxis::Continuous(values.collect(), Box::new(fit)))
}

fn account(selection: &Selection) -> String {
    let mut text = format!(
        "{} cells: {} values of {}, L = 1 to {}\n\nBest fit of each number of filters, as a free search of {} finds it\n",
        selection.cells.len(),
        selection.values.len(),
        selection.symbol,
        selection.filters_max,
        selection.symbol,
    );
    let _ = writeln!(
        text,
        "{:>3} {:>7} {:>9} {:>9} {:>11} {:>11}  verdict",
        "L", selection.symbol, "residual", "left out", "speed out", "freq. out",
    );
    for at in selection.free.iter().flatten() {
        text.push_str(&line(&selection.cells[*at]));
    }
    let _ = writeln!(text, "\nRecommended\n{}", selection.reason);
    if let Some(recommended) = &selection.recommended {
        text.push_str(&line(&selection.cells[recommended.cell]));
    }
    text
}

fn line(cell: &Cell) -> String {
    let percent = |x: Option<f64>| x.map_or("–".to_owned(), |x| format!("{:.2} %", 100.0 * x));
    let cv = cell.cross_validation;
    let onset = cell
        .onset_m_s
        .map_or("no onset".to_owned(), |v| format!("onset {v:.2} m/s"));
    let verdict = if cell.rejected.is_empty() {
        onset
    } else {
        format!("REFUSED: {} ({onset})", cell.rejected.join("; "))
    };
    format!(
        "{:>3} {:>7.3} {:>9} {:>9} {:>11} {:>11}  {verdict}\n",
        cell.filters,
        cell.value,
        percent(cell.residual),
        percent(cv.map(|v| v.score)),
        percent(cv.and_then(|v| v.across_speeds)),
        percent(cv.and_then(|v| v.across_frequencies)),
    )
}

/// Errors and onsets over the grid, and the metrics of the forces.
fn figures(
    study: &Study,
    selection: &Selection,
    metrics: &[MetricGrid],
) -> Result<Vec<(&'static str, Figure)>> {
    let filters = selection.filters_max;
    let map = |title: &str, values: Vec<Option<f64>>, logarithmic: bool| HeatMap {
        title: title.to_owned(),
        x_label: match selection.symbol.as_str() {
            "p" => "Pole p (–)".to_owned(),
            other => format!("Decay factor {other} (–)"),
        },
        x: selection.values.clone(),
        y_label: "Filters L".to_owned(),
        rows: filters,
        values,
        logarithmic,
        refused: selection
            .cells
            .iter()
            .map(|c| !c.rejected.is_empty())
            .collect(),
        chosen: selection
            .recommended
            .as_ref()
            .map(|r| (r.cell / filters, r.cell % filters)),
    };
    let of = |f: &dyn Fn(&Cell) -> Option<f64>| selection.cells.iter().map(f).collect::<Vec<_>>();
    let errors = [
        map("Residual of the fit", of(&|c| c.residual), true),
        map(
            "Error on data left out",
            of(&|c| Some(c.cross_validation?.score)),
            true,
        ),
        map("Flutter onset (m/s)", of(&|c| c.onset_m_s), false),
        map("Largest term over the fit", of(&|c| c.cancellation), true),
    ];
    let mut maps = Vec::new();
    type Pick = fn(&CellMetrics) -> f64;
    let kinds: [(&str, Pick); 3] = [
        ("Phase", |m| m.phase),
        ("Peak", |m| m.peak),
        ("Warped magnitude", |m| m.magnitude_warped),
    ];
    for grid in metrics {
        for (name, pick) in kinds {
            let title = format!(
                "{name} metric: {} force and motion, {:.2} Hz",
                grid.force.name(),
                grid.frequency_hz
            );
            let values = grid.cells.iter().map(|c| c.as_ref().map(pick)).collect();
            maps.push(map(&title, values, false));
        }
    }
    Ok(vec![
        (
            "selection",
            heat_map_figure(&format!("{}: selection", study.name), &errors, 2)?,
        ),
        (
            "selection_metrics",
            heat_map_figure(&format!("{}: metrics of the forces", study.name), &maps, 3)?,
        ),
    ])
}
