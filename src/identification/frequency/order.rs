//! The number of filters of a fit to a table.

use super::fit_linear;
use super::joint::{Joint, by_noise};
use crate::error::Result;
use crate::identification::basis::Basis;
use crate::identification::dissipative::FitRequirements;
use crate::identification::form::{Form, LEAST_CHOSEN, MOST_CHOSEN};
use crate::identification::frequency_options::FrequencyFit;
use crate::identification::order::{HeldOut, fewest, folds};
use crate::identification::report::{FittedTable, OrderReport};
use crate::identification::samples::{Entry, Row};
use crate::section::Dof;
use crate::units::ReducedFrequencyRange;

/// The fit with the number of filters that is best on what it has not seen, and the account of all that were tried: from
/// three up to what the tables determine. With transfer functions of their own filters or poles there is no common number
/// to choose, and it is three.
///
/// # Errors
/// What a fit with three filters refuses.
pub(super) fn fit_chosen(
    entries: &[Entry],
    dofs: &[Dof],
    fit: &FrequencyFit,
    tested: ReducedFrequencyRange,
) -> Result<(FittedTable, Form, Vec<OrderReport>)> {
    let with = |filters: usize| {
        let form = fit.form.with_filters(filters).unwrap_or_default();
        FrequencyFit {
            form,
            ..fit.clone()
        }
    };
    let first = with(LEAST_CHOSEN);
    let mut fits = vec![(fit_linear(entries, dofs, &first, tested)?, first)];
    let folds = table_folds(entries);
    if folds.is_empty() || !fit.own.is_empty() || fit.form.pole_per_transfer_function() {
        let (fitted, first) = fits.swap_remove(0);
        return Ok((fitted, first.form, Vec::new()));
    }
    let rows = entries.iter().map(|e| e.rows.len()).min().unwrap_or(0);
    for filters in LEAST_CHOSEN + 1..=MOST_CHOSEN {
        let more = with(filters);
        // two rows to judge each coefficient by
        if 2 * (filters + more.form.feed_through().count()) > rows {
            break;
        }
        let Ok(fitted) = fit_linear(entries, dofs, &more, tested) else {
            break;
        };
        fits.push((fitted, more));
    }
    let mut orders = Vec::new();
    for (fitted, tried) in &fits {
        orders.push(OrderReport {
            filters: tried.form.filters(),
            objective: fitted.search.first().map_or(0.0, |s| s.chosen.objective),
            left_out: left_out(entries, dofs, (tried, tested), &folds, fitted),
        });
    }
    let (fitted, tried) = fits.swap_remove(fewest(&orders));
    Ok((fitted, tried.form, orders))
}

/// Rows of every entry that are left out together. Frequencies of motion follow from `K V`, or from `K` where the speed of a
/// test is not known.
fn table_folds(entries: &[Entry]) -> Vec<Vec<(usize, usize)>> {
    let mut places = Vec::new();
    let mut tests = Vec::new();
    for (e, entry) in entries.iter().enumerate() {
        for (r, row) in entry.rows.iter().enumerate() {
            places.push((e, r));
            let speed = row.mean_speed_m_s;
            tests.push((speed, Some(row.k * speed.unwrap_or(1.0))));
        }
    }
    let of = |fold: Vec<usize>| fold.into_iter().map(|at| places[at]).collect();
    folds(&tests).into_iter().map(of).collect()
}

/// Error of a fit with its poles on rows that it has not seen; `None` where what is left does not determine it.
fn left_out(
    entries: &[Entry],
    dofs: &[Dof],
    (fit, tested): (&FrequencyFit, ReducedFrequencyRange),
    folds: &[Vec<(usize, usize)>],
    fitted: &FittedTable,
) -> Option<f64> {
    let poles: Vec<Vec<f64>> = fitted.reports.iter().map(|r| r.poles.clone()).collect();
    let shares = by_noise(entries, &fit.form, &poles).ok()?;
    let mut errors = HeldOut::default();
    for fold in folds {
        let mut out = entries.to_vec();
        let mut kept = entries.to_vec();
        for (e, entry) in entries.iter().enumerate() {
            let is_out = |r: usize| fold.contains(&(e, r));
            let part = |wanted: bool| -> Vec<Row> {
                let rows = entry.rows.iter().enumerate();
                let some = rows.filter(|(r, _)| is_out(*r) == wanted);
                some.map(|(_, row)| row.clone()).collect()
            };
            out[e].rows = part(true);
            kept[e].rows = part(false);
        }
        let joint = Joint {
            entries: &kept,
            form: &fit.form,
            shares: shares.clone(),
            wishes: FitRequirements {
                dofs: dofs.to_vec(),
                k_max: tested.max.full_width(),
                constraints: fit.constraints,
                limits: Vec::new(),
            },
        };
        let held = joint.sampled(&poles).ok()?;
        for (e, unseen) in out.iter().enumerate() {
            let basis = Basis::new(&fit.form, &poles[e]).ok()?;
            let residuals = unseen.weighted_residuals(&basis, held.coefficients(e), 1.0);
            errors.add(e, residuals.map(|r| r * r).sum(), unseen.total());
        }
    }
    errors.score()
}
