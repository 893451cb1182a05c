//! The cells of a selection: fit, error on unseen data, onset, verdict.

use super::folds::{CrossValidation, HeldOut, combine, folds, unpredicted, validate};
use crate::error::Result;
use crate::flutter::OnsetSearch;
use crate::identification::Grid;
use crate::numbered::{OnDone, numbered};
use crate::section::{Dof, Structure};
use crate::signal::extremes;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// One number of filters with one pole or decay factor.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Cell {
    /// Number of filters `L`.
    pub filters: usize,
    /// Pole `p` or decay factor `α`.
    pub value: f64,
    /// Relative error of the fit to the data it was fitted to (root mean square over the transfer functions).
    pub residual: Option<f64>,
    /// Error on what was left out.
    pub cross_validation: Option<CrossValidation>,
    /// Largest single term over the norm of the fit.
    pub cancellation: Option<f64>,
    /// Flutter onset, m/s.
    pub onset_m_s: Option<f64>,
    /// Reasons against the model; empty for one that may be used.
    pub rejected: Vec<String>,
}

impl Cell {
    /// Its error on data left out; NaN without one.
    fn score(&self) -> f64 {
        self.cross_validation.map_or(f64::NAN, |v| v.score)
    }
}

/// All cells and the recommended one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Selection {
    /// `p` or `α`.
    pub symbol: String,
    /// Values along the axis.
    pub values: Vec<f64>,
    /// Greatest number of filters.
    pub filters_max: usize,
    /// Cells, all numbers of filters of the first value first.
    pub cells: Vec<Cell>,
    /// For each number of filters the cell that fits best, as a free search of the parameter would find it: indices.
    pub free: Vec<Option<usize>>,
    /// Transfer functions that no cell predicts better than a force of zero: they are not in the errors on data left out.
    pub unpredicted: Vec<String>,
    /// The recommended model; `None` when every cell is refused.
    pub recommended: Option<Recommendation>,
    /// The choice in words.
    pub reason: String,
}

/// Judges every cell with a suspended section, in parallel over the values of the axis.
///
/// `search` says where to look for onsets.
///
/// # Errors
/// None at present: cells that cannot be fitted are refused with their reason.
pub fn select(
    grid: &Grid,
    structure: &Structure,
    search: &OnsetSearch,
    progress: OnDone<'_>,
) -> Result<Selection> {
    let folds = folds(grid);
    let cells = numbered(grid.values().len(), progress, |value| {
        let fits = grid.fits(value, &|_| true).into_iter().zip(1..);
        let of_value = fits.zip(validate(&folds, grid, value));
        let cell = |((fit, filters), held_out): (_, Option<HeldOut>)| {
            let mut cell = Cell {
                filters,
                value: grid.values()[value],
                ..Cell::default()
            };
            cell.judge(fit, structure, search, grid.tested);
            if cell.residual.is_some() && held_out.is_none() {
                cell.rejected
                    .push("the records without one speed or frequency do not determine it".into());
            }
            // what no cell predicts is not known yet
            (cell, held_out)
        };
        Ok(of_value.map(cell).collect::<Vec<_>>())
    })?;
    let (mut cells, held_out): (Vec<Cell>, Vec<Option<HeldOut>>) =
        cells.into_iter().flatten().unzip();
    let left_out = unpredicted(held_out.iter().flatten());
    for (cell, held_out) in cells.iter_mut().zip(&held_out) {
        let errors = held_out.as_ref();
        cell.cross_validation = errors.and_then(|errors| combine(errors, &left_out));
    }
    let filters_max = grid.filters_max;
    let closest = |l: usize| {
        let places = (0..grid.values().len()).map(|v| v * filters_max + l);
        let fitted = places.filter_map(|at| Some((at, cells[at].residual?)));
        fitted.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(at, _)| at)
    };
    let free = (0..filters_max).map(closest).collect();
    let mut selection = Selection {
        symbol: grid.symbol().to_owned(),
        values: grid.values().to_vec(),
        filters_max,
        cells,
        free,
        unpredicted: in_words(&left_out, &grid.dofs),
        recommended: None,
        reason: String::new(),
    };
    (selection.recommended, selection.reason) = recommend(&selection);
    Ok(selection)
}

/// Transfer functions across speeds and across frequencies in words.
fn in_words(left_out: &[BTreeSet<(usize, usize)>; 2], dofs: &[Dof]) -> Vec<String> {
    let parts = left_out.iter().zip(["speeds", "frequencies"]);
    let each = parts.flat_map(|(entries, what)| entries.iter().map(move |entry| (entry, what)));
    each.map(|((i, j), what)| {
        let (force, motion) = (dofs[*i].name(), dofs[*j].name());
        format!("the {force} force by {motion} motion from the records of other {what}")
    })
    .collect()
}

/// The recommended model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Recommendation {
    /// Place among the cells.
    pub cell: usize,
    /// Number of filters `L`.
    pub filters: usize,
    /// Pole `p` or decay factor `α`.
    pub value: f64,
    /// Its error on data left out.
    pub score: f64,
    /// Its onset, m/s.
    pub onset_m_s: Option<f64>,
    /// Least and greatest onset of the models within one standard error of the least error, m/s; `None` where none of them flutters.
    pub onsets_within_m_s: Option<[f64; 2]>,
    /// Onset of the table of the deck by itself, m/s; `None` where it has none.
    pub table_onset_m_s: Option<f64>,
    /// How far the onset of the model lies above it, percent; `None` where not both have one.
    pub above_table_percent: Option<f64>,
}

/// Part of the onset of the best model by which a simpler one may miss it: what a model is for is its onset, and errors of forces
/// that scatter as much allowed onsets 14 % too high.
const KEPT_ONSET: f64 = 0.01;
/// Percent by which the onset of a model may differ from that of its table; three filters fitted to LN21-5800 keep to 2.2 %.
const LIKE_TABLE: f64 = 5.0;

impl Selection {
    /// Takes the onset of the table by itself, m/s, beside that of the recommended model; a table that has none says nothing of models.
    pub fn put_beside(&mut self, table_m_s: f64) {
        if let Some(found) = &mut self.recommended {
            found.table_onset_m_s = Some(table_m_s);
            let percent = found.onset_m_s.map(|own| 100.0 * (own / table_m_s - 1.0));
            found.above_table_percent = percent;
            let said = found.beside_table();
            self.reason.extend(said.map(|said| format!(" {said}")));
        }
    }
}

impl Recommendation {
    /// What the onset of the table by itself says of that of the model.
    pub fn beside_table(&self) -> Option<String> {
        let own = self.table_onset_m_s?;
        let (Some(percent), Some(model)) = (self.above_table_percent, self.onset_m_s) else {
            return Some(format!(
                "The table by itself has its onset at {own:.2} m/s, the recommended model none: the recommendation is doubtful."
            ));
        };
        let doubt = match percent.abs() <= LIKE_TABLE {
            true => "",
            false => ": the recommendation is doubtful",
        };
        let side = if percent < 0.0 { "below" } else { "above" };
        Some(format!(
            "The table by itself has its onset at {own:.2} m/s, the recommended model {:.1} % {side} it, at {model:.2} m/s{doubt}.",
            percent.abs()
        ))
    }
}

/// The fewest filters whose error on data left out is within one standard error of the least (the rule of Breiman,
/// Friedman, Olshen & Stone, *Classification and Regression Trees*, 1984, section 3.4.3) and that keep the onset of the best model,
/// among the cells without a reason against them; for that number of filters the best value.
fn recommend(selection: &Selection) -> (Option<Recommendation>, String) {
    let may_be_used = |c: &&Cell| c.rejected.is_empty() && c.cross_validation.is_some();
    let usable = selection.cells.iter().filter(may_be_used);
    let by_score = |a: &&Cell, b: &&Cell| a.score().total_cmp(&b.score());
    let Some(best) = usable.clone().min_by(by_score) else {
        let most = most_common_reason(selection);
        let reason = format!(
            "No model can be recommended: every cell is refused, most often because {most}."
        );
        return (None, reason);
    };
    let scatter = best.cross_validation.map(|v| v.standard_error_of_square);
    let limit = best.score() * best.score() + scatter.unwrap_or_default();
    let within: Vec<&Cell> = usable.filter(|c| c.score() * c.score() <= limit).collect();
    let fewest = |a: &&Cell, b: &&Cell| a.filters.cmp(&b.filters).then(by_score(a, b));
    let keeps_onset = |cell: &&Cell| match (cell.onset_m_s, best.onset_m_s) {
        (Some(own), Some(of_best)) => (own / of_best - 1.0).abs() <= KEPT_ONSET,
        (own, of_best) => own.is_none() == of_best.is_none(),
    };
    let alike = within.iter().copied().filter(keeps_onset);
    let chosen = alike.min_by(fewest).unwrap_or(best);
    let (low, high) = extremes(within.iter().filter_map(|c| c.onset_m_s));
    let mut places = selection.cells.iter();
    let recommended = Recommendation {
        cell: places.position(|c| std::ptr::eq(c, chosen)).unwrap_or(0),
        filters: chosen.filters,
        value: chosen.value,
        score: chosen.score(),
        onset_m_s: chosen.onset_m_s,
        onsets_within_m_s: (low <= high).then_some([low, high]),
        table_onset_m_s: None,
        above_table_percent: None,
    };
    let mut reason = explain(selection, chosen, best);
    reason.push_str(&onsets_in_words(&within));
    for name in &selection.unpredicted {
        reason.push_str(&format!(
            " No model predicts {name} better than a force of zero: it does not count in the errors."
        ));
    }
    reason.push_str(&why_not_others(selection, recommended.cell));
    (Some(recommended), reason)
}

/// How far the choice among models that are as good moves the onset; nothing for a single one.
fn onsets_in_words(within: &[&Cell]) -> String {
    let onsets = within.iter().filter_map(|c| c.onset_m_s);
    let (low, high) = extremes(onsets.clone());
    let none = match within.len() - onsets.count() {
        0 => String::new(),
        all if all == within.len() => return String::new(),
        some => format!(", {some} of them none"),
    };
    if within.len() < 2 {
        return String::new();
    }
    let all = within.len();
    format!(
        " The {all} models within one standard error have onsets from {low:.3} to {high:.3} m/s{none}."
    )
}

/// Why `chosen` and not `best`.
fn explain(selection: &Selection, chosen: &Cell, best: &Cell) -> String {
    let symbol = &selection.symbol;
    let (own, error) = (name(chosen, symbol), percent(chosen.score()));
    let why = if std::ptr::eq(chosen, best) {
        format!("its error on data left out, {error}, is the least of all models that may be used")
    } else {
        format!(
            "the fewest filters whose error on data left out, {error}, is within one standard error of the least ({} with {}) and {}",
            percent(best.score()),
            name(best, symbol),
            match best.onset_m_s {
                Some(_) => format!("whose onset is that of the best to {}", percent(KEPT_ONSET)),
                None => "that, like the best, have no onset".to_owned(),
            }
        )
    };
    let onset = chosen.onset_m_s.map(|v| format!("; onset {v:.3} m/s"));
    format!("{own}: {why}{}.", onset.unwrap_or_default())
}

/// What speaks for a wider grid, and what fits better but is refused.
fn why_not_others(selection: &Selection, chosen: usize) -> String {
    let symbol = &selection.symbol;
    let mut reason = String::new();
    let (along, values) = (chosen / selection.filters_max, selection.values.len());
    if values > 1 && (along == 0 || along + 1 == values) {
        reason.push_str(&format!(
            " {symbol} lies at the edge of the grid: widen it to see whether the error falls further."
        ));
    }
    // what a free search would have taken for each number of filters
    let free = selection.free.iter().flatten();
    let free = free.map(|at| &selection.cells[*at]);
    for refused in free.filter(|c| !c.rejected.is_empty()) {
        let residual = refused.residual.map(|r| format!("to {}", percent(r)));
        reason.push_str(&format!(
            " {} fits the records {}, but is refused: {}.",
            name(refused, symbol),
            residual.as_deref().unwrap_or("closely"),
            refused.rejected.join("; ")
        ));
    }
    reason
}

fn most_common_reason(selection: &Selection) -> String {
    // reasons differ in their numbers: the first words tell the kind
    let kind = |r: &str| r.chars().take(16).collect::<String>();
    let all: Vec<&String> = selection.cells.iter().flat_map(|c| &c.rejected).collect();
    let count = |r: &str| all.iter().filter(|o| kind(o) == kind(r)).count();
    let most = all.iter().max_by_key(|r| count(r));
    most.map_or("nothing could be left out", |r| r.as_str())
        .to_owned()
}

fn name(cell: &Cell, symbol: &str) -> String {
    format!("L = {}, {symbol} = {:.3}", cell.filters, cell.value)
}

fn percent(x: f64) -> String {
    format!("{:.2} %", 100.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A simpler model that predicts as well is taken where it flutters at the same speed.
    #[test]
    fn a_simpler_model_keeps_the_onset() {
        let cell = |filters, score, onset_m_s| Cell {
            filters,
            value: 0.5,
            cross_validation: Some(CrossValidation {
                score,
                standard_error_of_square: 0.1,
                across_speeds: None,
                across_frequencies: None,
            }),
            onset_m_s,
            ..Cell::default()
        };
        let chosen = |simple: Option<f64>, best: Option<f64>| {
            let cells = vec![cell(1, 0.3, simple), cell(2, 0.2, best)];
            let mut selection = Selection {
                symbol: "p".into(),
                values: vec![0.5],
                filters_max: 2,
                cells,
                free: Vec::new(),
                unpredicted: Vec::new(),
                recommended: None,
                reason: String::new(),
            };
            (selection.recommended, selection.reason) = recommend(&selection);
            selection.put_beside(37.0);
            if simple.is_none() && best.is_none() {
                let said = "20.00 % with L = 2, p = 0.500) and that, like the best, have no onset. The table by itself has its onset at 37.00 m/s, the \
                            recommended model none: the recommendation is doubtful.";
                assert!(selection.reason.contains(said), "{}", selection.reason);
            }
            selection.recommended.unwrap().filters
        };
        assert_eq!(chosen(Some(37.3), Some(37.0)), 1);
        assert_eq!(chosen(Some(37.7), Some(37.0)), 2);
        assert_eq!(chosen(Some(36.2), Some(37.0)), 2);
        assert_eq!(chosen(None, None), 1);
        assert_eq!(chosen(None, Some(37.0)), 2);
        assert_eq!(chosen(Some(37.0), None), 2);
    }
}
