//! The number of filters of a fit to records.

use crate::error::Result;
use crate::identification::form::{LEAST_CHOSEN, MOST_CHOSEN};
use crate::identification::grid::{CellFit, Grid, GridAxis};
use crate::identification::options::TimeFit;
use crate::identification::order::{HeldOut, fewest, folds};
use crate::identification::own::StaticTerm;
use crate::identification::report::OrderReport;
use crate::identification::search::Bounds;
use crate::identification::time::pass::OnProgress;
use crate::identification::time::record::Records;
use crate::wind_tunnel::RecordSource;

/// Poles that are tried for each number of filters: the fit searches further with the number that is chosen.
const POLES: usize = 13;

/// The fit with the number of filters that is best on what it has not seen, and the account of all that were tried, from one
/// pass over the records. Where transfer functions have filters or poles of their own, or records move several degrees of
/// freedom at once, there is no common number to choose, or nothing to leave out, and it is three.
///
/// # Errors
/// Records that cannot be read, and bounds of poles without room.
pub(super) fn choose_filters(
    records: &[&dyn RecordSource],
    fit: &TimeFit,
    progress: OnProgress<'_>,
) -> Result<(TimeFit, Vec<OrderReport>)> {
    let with = |filters: usize| TimeFit {
        form: fit.form.with_filters(filters).unwrap_or_default(),
        ..fit.clone()
    };
    let plain = fit.own.is_empty() && !fit.form.pole_per_transfer_function();
    let steady = fit.static_term == StaticTerm::None && fit.limits.is_empty();
    if !plain || !steady {
        return Ok((with(LEAST_CHOSEN), Vec::new()));
    }
    let tested = Records::read(records, StaticTerm::None)?.tested_range()?;
    let bounds = Bounds::resolve(&fit.poles, tested, 1)?;
    let poles = match &fit.poles.fixed {
        Some(fixed) => fixed.clone(),
        None => bounds.grid(1, POLES).concat(),
    };
    let axis = GridAxis::Continuous(poles, Box::new(with(MOST_CHOSEN)));
    let Ok(grid) = Grid::new(records, axis, MOST_CHOSEN, progress) else {
        // what is wrong is said by the fit itself
        return Ok((with(LEAST_CHOSEN), Vec::new()));
    };
    let tests: Vec<_> = grid
        .labels()
        .iter()
        .map(|l| (Some(l.mean_speed_m_s), l.frequency_hz))
        .collect();
    let folds = folds(&tests);
    let all: Vec<_> = (0..grid.values().len())
        .map(|value| grid.fits(value, &|_| true))
        .collect();
    let mut orders = Vec::new();
    for filters in LEAST_CHOSEN..=MOST_CHOSEN {
        let objective = |value: &usize| match &all[*value][filters - 1] {
            Ok(cell) => cell.objective,
            Err(_) => f64::INFINITY,
        };
        let best = (0..all.len()).min_by(|a, b| objective(a).total_cmp(&objective(b)));
        if let Some(value) = best.filter(|v| objective(v).is_finite()) {
            orders.push(OrderReport {
                filters,
                objective: objective(&value),
                left_out: left_out(&grid, (value, filters), &folds),
            });
        }
    }
    if orders.iter().all(|o| o.left_out.is_none()) {
        return Ok((with(LEAST_CHOSEN), Vec::new()));
    }
    let chosen = orders[fewest(&orders)].filters;
    Ok((with(chosen), orders))
}

/// Error on stretches that the fit has not seen; `None` where what is left does not determine it.
fn left_out(grid: &Grid, (value, filters): (usize, usize), folds: &[Vec<usize>]) -> Option<f64> {
    let mut errors = HeldOut::default();
    let n = grid.dofs().len();
    for fold in folds {
        let cell: CellFit = grid.fit(value, filters, &|s| !fold.contains(&s)).ok()?;
        let mut sums = vec![(0.0, 0.0); n * n];
        for &stretch in fold {
            let Some(motion) = grid.motion(stretch) else {
                continue;
            };
            let j = grid.dofs().iter().position(|d| *d == motion)?;
            let each = grid.residuals(stretch, value, &cell)?;
            for (i, (residual, total)) in each.into_iter().enumerate() {
                sums[i * n + j].0 += residual;
                sums[i * n + j].1 += total;
            }
        }
        for (e, (residual, total)) in sums.into_iter().enumerate() {
            errors.add(e, residual, total);
        }
    }
    errors.score()
}
