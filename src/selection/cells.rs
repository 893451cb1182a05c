//! The cells of a selection: fit, error on unseen data, onset, verdict.

use super::folds::{CrossValidation, Folds};
use super::guards::judge;
use super::recommend::{Recommendation, recommend};
use crate::error::Result;
use crate::flutter::OnsetSearch;
use crate::identification::Grid;
use crate::section::Structure;
use rayon::prelude::*;
use serde::Serialize;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What a selection needs besides the grid.
#[derive(Debug, Clone)]
pub struct SelectionPlan {
    /// The suspended section.
    pub structure: Structure,
    /// Where to look for onsets.
    pub search: OnsetSearch,
}

/// One number of filters with one pole or decay factor.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
    /// The recommended model; `None` when every cell is refused.
    pub recommended: Option<Recommendation>,
    /// The choice in words.
    pub reason: String,
}

/// Judges every cell, in parallel over the values of the axis.
///
/// `done` is called after each value with the number of those that are through.
///
/// # Errors
/// None at present: cells that cannot be fitted are refused with their reason.
pub fn select(
    grid: &Grid,
    plan: &SelectionPlan,
    done: &(dyn Fn(usize) + Sync),
) -> Result<Selection> {
    let folds = Folds::new(grid.labels());
    let finished = AtomicUsize::new(0);
    let cells: Vec<Cell> = (0..grid.values().len())
        .into_par_iter()
        .flat_map_iter(|value| {
            let cells = cells_of(grid, plan, &folds, value);
            done(1 + finished.fetch_add(1, Ordering::Relaxed));
            cells
        })
        .collect();
    let filters_max = grid.filters_max();
    let free = (0..filters_max)
        .map(|l| {
            (0..grid.values().len())
                .map(|v| v * filters_max + l)
                .filter_map(|at| Some((at, cells[at].residual?)))
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .map(|(at, _)| at)
        })
        .collect();
    let mut selection = Selection {
        symbol: grid.symbol().to_owned(),
        values: grid.values().to_vec(),
        filters_max,
        cells,
        free,
        recommended: None,
        reason: String::new(),
    };
    (selection.recommended, selection.reason) = recommend(&selection);
    Ok(selection)
}

fn cells_of(grid: &Grid, plan: &SelectionPlan, folds: &Folds, value: usize) -> Vec<Cell> {
    let fits = grid.fits(value, &|_| true);
    let validations = folds.validate(grid, value);
    fits.into_iter()
        .zip(validations)
        .enumerate()
        .map(|(l, (fit, cross_validation))| {
            let mut cell = Cell {
                filters: l + 1,
                value: grid.values()[value],
                residual: None,
                cross_validation,
                cancellation: None,
                onset_m_s: None,
                rejected: Vec::new(),
            };
            match fit {
                Ok(fit) => {
                    let verdict = judge(&fit, &plan.structure, &plan.search, grid.tested_range());
                    cell.residual = Some(fit.objective);
                    cell.cancellation = Some(fit.cancellation);
                    cell.onset_m_s = verdict.onset_m_s;
                    cell.rejected = verdict.rejected;
                    if cross_validation.is_none() {
                        cell.rejected.push(
                            "the records without one speed or frequency do not determine it".into(),
                        );
                    }
                }
                Err(error) => cell.rejected.push(format!("it cannot be fitted ({error})")),
            }
            cell
        })
        .collect()
}
