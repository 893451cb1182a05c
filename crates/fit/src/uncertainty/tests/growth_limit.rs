//! The growth with which the tests of a deck end is known as well as the tests know it, and no better.

use super::*;
use crate::identification::basis::Basis;
use crate::identification::{ActiveConstraint, FitReport};

/// Sway of this deck is fed with energy at the highest tested `K` at one of its speeds.
const DECK: &str = "LN21-5500";

fn form() -> Form {
    Form::laguerre(5)
}

fn fit(constraints: Constraints, poles: PoleSearch) -> (FitReport, CoefficientUncertainty) {
    let samples = embedded::deck(DECK).unwrap().samples(&Dof::THREE);
    let fit = FrequencyFit {
        constraints,
        poles,
        form: form(),
        ..FrequencyFit::default()
    };
    let Fitted { report, .. } = fit_table(&samples, &Dof::THREE, &fit).unwrap();
    let estimate = table_uncertainty(&samples, &Dof::THREE, &fit, &report, None).unwrap();
    (report, estimate)
}

/// Standard error of the quadratic form that a constraint holds.
fn error(estimate: &CoefficientUncertainty, constraint: &ActiveConstraint, basis: &Basis) -> f64 {
    let rows = (0..9).map(|e| constraint.gradient(e / 3, e % 3, basis));
    let mut gradient: Vec<f64> = rows.flatten().collect();
    gradient.resize(estimate.parameters.len(), 0.0);
    estimate.standard_error(&gradient).unwrap()
}

/// Condition 3 holds sway above the tests at the growth that they end with, which fades with `K²`: so does its standard error, and at
/// `K_max` it is of the size that it has in the fit without constraints, of the same poles and the same data.
#[test]
fn the_growth_at_the_end_of_the_tests_is_not_known_exactly() {
    let (found, _) = fit(Constraints::Dissipative, PoleSearch::default());
    let poles = PoleSearch::fixed(&found.entries[0].poles[..1]);
    let (report, held) = fit(Constraints::Dissipative, poles.clone());
    let (_, alone) = fit(Constraints::None, poles);
    let active = &report.constraints.as_ref().unwrap().active;
    let above = active.iter().find(|a| a.limit.is_some()).unwrap();
    let k_max = above.limit.as_ref().unwrap().0;
    let at_end = ActiveConstraint {
        k: Some(k_max),
        ..above.clone()
    };
    let basis = Basis::new(&form(), &report.entries[0].poles).unwrap();
    let fades = (k_max / above.k.unwrap()).powi(2);
    let ends = error(&held, &at_end, &basis);
    let (found, expected) = (error(&held, above, &basis), fades * ends);
    assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    // 0.12 and 0.22: condition 3 beyond the tests tells something of their end, too
    let by_data = error(&alone, &at_end, &basis);
    assert!((0.4..1.0).contains(&(ends / by_data)), "{ends} {by_data}");
    assert!(
        held.assumption.contains("it follows the data"),
        "{}",
        held.assumption
    );
}
