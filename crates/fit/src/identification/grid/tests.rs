//! Cells of a grid against fits of their own.

use super::*;
use crate::aerodynamics::{FlatPlate, Transfer};
use crate::identification::sources;
use crate::identification::testing::{records, records_alone};
use crate::identification::{DiscreteFit, Fitted, PoleSearch, fit_discrete, fit_records};
use crate::units::ReducedFrequency;

fn differ(a: &Model, b: &Model) -> f64 {
    [0.1, 0.4, 1.1]
        .map(|k| {
            let k = ReducedFrequency::from_full_width(k);
            let (a, b) = (a.transfer(k).unwrap(), b.transfer(k).unwrap());
            (&a - &b).norm() / b.norm()
        })
        .into_iter()
        .fold(0.0, f64::max)
}

/// Every cell of the discrete grid is the fit with that number of filters and that decay factor: the same rows, one
/// factorisation against one per cell.
#[test]
fn discrete_cells_are_single_fits() {
    let made = records(&FlatPlate::default(), &[8.17, 4.0], 0.02, 3);
    let sources = sources(&made);
    let alphas = [0.5, 0.8];
    let axis = GridAxis::Discrete(alphas.to_vec(), TimeWeights::None);
    let grid = Grid::new(&sources, axis, 4, &|_, _| ()).unwrap();
    for (a, alpha) in alphas.into_iter().enumerate() {
        for (l, cell) in grid.fits(a, &|_| true).into_iter().enumerate() {
            let fit = DiscreteFit {
                filters: l + 1,
                alpha,
                ..DiscreteFit::default()
            };
            let Fitted { model, report } = fit_discrete(&sources, &fit, &|_, _| ()).unwrap();
            let cell = cell.unwrap();
            // rounding times the condition of four filters
            assert!(differ(&cell.model, &model) < 1e-8, "{alpha} {l}");
            let objective = report.orders[l].objective;
            assert!((cell.objective / objective - 1.0).abs() < 1e-8);
        }
    }
}

/// The continuous grid takes every fifth row of low-passed signals; with every row it would be the fit itself.
#[test]
fn continuous_cells_are_single_fits_but_for_thinning() {
    let made = records(&FlatPlate::default(), &[8.17, 4.0], 0.0, 3);
    let sources = sources(&made);
    let axis = GridAxis::Continuous(vec![0.3], Box::new(records_alone()));
    let grid = Grid::new(&sources, axis, 3, &|_, _| ()).unwrap();
    let cell = grid.fits(0, &|_| true).pop().unwrap().unwrap();
    let fit = TimeFit {
        form: Form::laguerre(3),
        poles: PoleSearch::fixed(&[0.3]),
        ..records_alone()
    };
    let Fitted { model, report } = fit_records(&sources, &fit, &|_, _| ()).unwrap();
    assert!(differ(&cell.model, &model) < 1e-3);
    let objective = report.orders[2].objective;
    assert!((cell.objective / objective - 1.0).abs() < 1e-2);
    // residuals of all stretches together are those of the fit
    let sums = (0..grid.pass.stretches.len()).filter_map(|s| grid.residuals(s, 0, &cell));
    let (residual, total) = sums
        .flatten()
        .fold((0.0, 0.0), |t, s| (t.0 + s.0, t.1 + s.1));
    assert!((residual / total).sqrt() < 2.0 * objective);
}

/// A fit without the low speed is the fit to the records of the high one: by least squares alone, since constraints know the
/// whole tested range.
#[test]
fn leaving_stretches_out_is_a_fit_to_the_others() {
    let made = records(&FlatPlate::default(), &[8.17, 4.0], 0.02, 3);
    let axis = || GridAxis::Continuous(vec![0.3], Box::new(records_alone()));
    let both = Grid::new(&sources(&made), axis(), 2, &|_, _| ()).unwrap();
    let high = Grid::new(&sources(&made[..2]), axis(), 2, &|_, _| ()).unwrap();
    let keep = |s: usize| both.pass.stretches[s].mean_speed_m_s > 8.0;
    let a = both.fits(0, &keep).pop().unwrap().unwrap();
    let b = high.fits(0, &|_| true).pop().unwrap().unwrap();
    assert!(differ(&a.model, &b.model) < 1e-9);
}

#[test]
fn more_filters_than_any_data_support_are_refused() {
    for many in [101, 100_000, usize::MAX] {
        let axis = GridAxis::Discrete(vec![0.6], TimeWeights::None);
        let error = Grid::new(&[], axis, many, &|_, _| ())
            .map(|_| ())
            .unwrap_err();
        assert!(error.to_string().contains("at most 100"), "{error}");
    }
}
