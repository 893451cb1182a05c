//! A selection in words and figures.

use crate::cli::vocabulary::{Figure, Result, Study, TextTable, counted};
use crate::report::{HeatMap, heat_map_figure};
use crate::selection::{Cell, CellMetrics, MetricGrid, Selection};
use std::fmt::Write as _;

/// The table of cells, the recommendation, and why metrics are missing.
pub(crate) fn text(selection: &Selection, metrics: &[MetricGrid]) -> String {
    let (cells, values) = (selection.cells.len(), selection.values.len());
    let (symbol, most) = (&selection.symbol, selection.filters_max);
    let mut text = format!(
        "{cells} cells: {values} values of {symbol}, L = 1 to {most}\n\nBest fit of each number of filters, as a free search of {symbol} finds it\n"
    );
    let free = selection.free.iter().flatten();
    text.push_str(&table(selection, free.map(|at| &selection.cells[*at])));
    let _ = write!(text, "\nRecommended\n{}\n", selection.reason);
    if let Some(recommended) = &selection.recommended {
        let cell = &selection.cells[recommended.cell];
        text.push_str(&table(selection, std::iter::once(cell)));
    }
    for grid in metrics {
        let mut problems = grid.cells.iter().flatten().flat_map(|m| &m.problem);
        if let Some(problem) = problems.next() {
            let cells = counted(1 + problems.count(), "cell");
            let force = grid.force.name();
            let _ = writeln!(text, "no M_phi of the {force} force in {cells}: {problem}");
        }
    }
    text
}

/// A line per cell; what refuses it stands below its row.
fn table<'a>(selection: &Selection, cells: impl Iterator<Item = &'a Cell>) -> String {
    let symbol = selection.symbol.as_str();
    let errors = ">residual | >left out | >speed out | >freq. out";
    let mut table = TextTable::new(&format!(">L | >{symbol} | {errors} | verdict"));
    for cell in cells {
        table.row(row(cell));
        if !cell.rejected.is_empty() {
            table.sentence([], &cell.rejected.join("; "));
        }
    }
    table.text()
}

fn row(cell: &Cell) -> [String; 7] {
    let percent = |x: Option<f64>| x.map_or("–".to_owned(), |x| format!("{:.2} %", 100.0 * x));
    let cv = cell.cross_validation;
    let onset = cell.onset_m_s.map(|v| format!("onset {v:.3} m/s"));
    let onset = onset.unwrap_or("no onset".to_owned());
    [
        cell.filters.to_string(),
        format!("{:.3}", cell.value),
        percent(cell.residual),
        percent(cv.map(|v| v.score)),
        percent(cv.and_then(|v| v.across_speeds)),
        percent(cv.and_then(|v| v.across_frequencies)),
        match cell.rejected.is_empty() {
            true => onset,
            false => format!("REFUSED ({onset})"),
        },
    ]
}

/// Errors and onsets over the grid, and the metrics of the forces.
pub(crate) fn figures(
    study: &Study,
    selection: &Selection,
    metrics: &[MetricGrid],
) -> Result<Vec<(&'static str, Figure)>> {
    let of = |f: fn(&Cell) -> Option<f64>| selection.cells.iter().map(f).collect();
    let score = |c: &Cell| Some(c.cross_validation?.score);
    let errors = [
        ("Residual of the fit", of(|c| c.residual), true),
        ("Error on data left out", of(score), true),
        ("Flutter onset (m/s)", of(|c| c.onset_m_s), false),
        ("Largest term over the fit", of(|c| c.cancellation), true),
    ]
    .map(|(title, values, logarithmic)| HeatMap {
        logarithmic,
        ..map(selection, title.to_owned(), values)
    });
    let maps = metrics.iter().flat_map(metric_values);
    // a force may have no lag in any cell
    let drawn = maps.filter(|(_, values)| values.iter().any(Option::is_some));
    let metric_maps = drawn.map(|(title, values)| map(selection, title, values));
    let metric_maps: Vec<HeatMap> = metric_maps.collect();
    let draw = |what: &str, maps: &[HeatMap], columns| {
        heat_map_figure(&format!("{}: {what}", study.name), maps, columns)
    };
    let errors = draw("selection", &errors, 2)?;
    let metrics = draw("metrics of the forces", &metric_maps, 3)?;
    Ok(vec![("selection", errors), ("selection_metrics", metrics)])
}

/// The three metrics of every cell, each with its title.
fn metric_values(grid: &MetricGrid) -> [(String, Vec<Option<f64>>); 3] {
    type Pick = fn(&CellMetrics) -> Option<f64>;
    let kinds: [(&str, Pick); 3] = [
        ("Phase", |m| m.phase),
        ("Peak", |m| Some(m.peak)),
        ("Warped magnitude", |m| Some(m.magnitude_warped)),
    ];
    kinds.map(|(name, pick)| {
        let (force, hertz) = (grid.force.name(), grid.frequency_hz);
        let title = format!("{name} metric: {force} force and motion, {hertz:.2} Hz");
        let values = grid.cells.iter().map(|c| pick(c.as_ref()?)).collect();
        (title, values)
    })
}

/// Maps of the metrics of one force over the parameters of a discrete model.
pub(crate) fn parameter_maps(
    alphas: &[f64],
    filters: usize,
    metrics: &MetricGrid,
) -> Result<Figure> {
    let maps = metric_values(metrics).map(|(title, values)| HeatMap {
        title,
        x_label: "Decay factor α (–)".to_owned(),
        x: alphas.to_vec(),
        y_label: "Filters L".to_owned(),
        rows: filters,
        values,
        ..HeatMap::default()
    });
    heat_map_figure("Parameters of the discrete model", &maps, 3)
}

/// A map of one value of every cell.
fn map(selection: &Selection, title: String, values: Vec<Option<f64>>) -> HeatMap {
    let filters = selection.filters_max;
    let cells = selection.cells.iter();
    let chosen = selection.recommended.as_ref();
    HeatMap {
        title,
        x_label: match selection.symbol.as_str() {
            "p" => "Pole p (–)".to_owned(),
            other => format!("Decay factor {other} (–)"),
        },
        x: selection.values.clone(),
        y_label: "Filters L".to_owned(),
        rows: filters,
        values,
        refused: cells.map(|c| !c.rejected.is_empty()).collect(),
        chosen: chosen.map(|r| (r.cell / filters, r.cell % filters)),
        ..HeatMap::default()
    }
}
