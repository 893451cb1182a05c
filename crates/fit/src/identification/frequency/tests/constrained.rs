//! Fits with the quasi-steady limit, against the figures of `tests/data/constrained_fit.py` (LAPACK's dgglse and SciPy).

use super::super::*;
use crate::aerodynamics::{FlatPlate, Transfer};
use crate::identification::form::FeedThrough;
use crate::identification::form::PoleSearch;
use crate::identification::testing::{eight_k, table_alone};
use crate::identification::{QuasiSteadyLimit, sample_model};
use crate::units::ReducedFrequency;
use std::f64::consts::PI;

fn samples() -> Vec<TransferSample> {
    sample_model(&FlatPlate::default(), &eight_k(8.17)).unwrap()
}

/// Quasi-steady theory of the thin plate about mid-chord; the slopes in the column of rotation stay free, since those of
/// Theodorsen's function have no limit.
fn quasi_steady() -> Vec<QuasiSteadyLimit> {
    let (y, t) = (Dof::Vertical, Dof::Torsion);
    let limit = |force, motion, value: f64, slope: Option<f64>| QuasiSteadyLimit {
        force,
        motion,
        value: Some(value),
        slope,
    };
    vec![
        limit(y, y, 0.0, Some(-2.0 * PI)),
        limit(y, t, 2.0 * PI, None),
        limit(t, y, 0.0, Some(-PI / 2.0)),
        limit(t, t, PI / 2.0, None),
    ]
}

fn one_lag(poles: PoleSearch) -> FrequencyFit {
    FrequencyFit {
        form: Form::Rational {
            lags: 1,
            added_mass: true,
        },
        poles,
        limits: quasi_steady(),
        ..table_alone()
    }
}

/// Coefficients to the nine printed decimals, searched lag to the eight printed.
#[test]
fn constrained_fit_is_that_of_lapack() {
    let given = one_lag(PoleSearch::fixed(&[0.3]));
    let report = fit_table(&samples(), &Dof::TWO, &given).unwrap().report;
    let printed = [
        [0.0, -3.619493368, -1.438788960, -0.799107582],
        [
            std::f64::consts::TAU,
            2.295174660,
            0.125783994,
            -2.373400715,
        ],
        [0.0, -0.904754748, 0.032879372, -0.199812474],
        [
            std::f64::consts::FRAC_PI_2,
            -0.210958385,
            -0.018508240,
            -0.594120909,
        ],
    ];
    for (entry, expected) in report.entries.iter().zip(printed) {
        for (c, value) in entry.coefficients.iter().zip(expected) {
            assert!((c.value - value).abs() < 2e-9, "{} {}", c.name, c.value);
        }
    }
    let searched = one_lag(PoleSearch::default());
    let report = fit_table(&samples(), &Dof::TWO, &searched).unwrap().report;
    let chosen = &report.search[0].chosen;
    // a minimum is known to the root of the rounding of the objective
    assert!((chosen.poles[0] - 0.237_824_53).abs() < 2e-7, "{chosen:?}");
    assert!(
        (chosen.objective - 0.026_273_357_5).abs() < 1e-9,
        "{chosen:?}"
    );
}

/// Every form meets value and slope exactly: G(0), and the central difference of G along iK, which on the imaginary axis
/// errs by the square of its step and by rounding over it.
#[test]
fn every_form_meets_the_limits() {
    let forms = [
        Form::laguerre(3),
        Form::TakenakaMalmquist {
            filters: 2,
            feed_through: FeedThrough::default(),
            pole_per_transfer_function: true,
        },
        Form::Rational {
            lags: 2,
            added_mass: true,
        },
        Form::RationalPerForce {
            lags: 2,
            added_mass: false,
        },
        Form::MinimumState {
            states: 2,
            added_mass: true,
        },
    ];
    for form in forms {
        let fit = FrequencyFit {
            form,
            limits: quasi_steady(),
            ..table_alone()
        };
        let Fitted { model, report } = fit_table(&samples(), &Dof::TWO, &fit).unwrap();
        let at = |k: f64| {
            model
                .transfer(ReducedFrequency::from_full_width(k))
                .unwrap()
        };
        let step = 1e-4;
        let (zero, near) = (at(0.0), at(step));
        for limit in &fit.limits {
            let i = Dof::TWO.iter().position(|d| *d == limit.force).unwrap();
            let j = Dof::TWO.iter().position(|d| *d == limit.motion).unwrap();
            let value = limit.value.unwrap();
            assert!((zero[(i, j)].re - value).abs() < 1e-12, "{}", report.method);
            if let Some(slope) = limit.slope {
                // G is real on the real axis, so its imaginary part is odd in K: error step²
                let found = near[(i, j)].im / step;
                assert!((found - slope).abs() < 1e-5, "{}: {found}", report.method);
            }
        }
        // limits that are true cost little: the worst entry stays within the 15 % that one lag needs
        for entry in &report.entries {
            assert!(entry.relative_rms.unwrap() < 0.15, "{}", report.method);
        }
    }
}

#[test]
fn impossible_limits_are_refused() {
    let message = |change: &dyn Fn(&mut FrequencyFit)| {
        let mut fit = one_lag(PoleSearch::fixed(&[0.3]));
        change(&mut fit);
        fit_table(&samples(), &Dof::TWO, &fit)
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        message(&|f| f.limits[1].value = None),
        "limits[1]: expected a value, a slope or both, found neither"
    );
    assert_eq!(
        message(&|f| f.limits[1] = f.limits[0]),
        "limits[1]: expected each entry once, found it twice"
    );
    assert_eq!(
        message(&|f| f.limits[1].force = Dof::Lateral),
        "limits[1]: expected vertical or torsion, found lateral"
    );
    let no_feed_through = message(&|f| {
        f.form = Form::Laguerre {
            filters: Some(1),
            feed_through: FeedThrough {
                e0: false,
                e1: false,
                e2: false,
            },
            pole_per_transfer_function: false,
        };
    });
    assert!(
        no_feed_through.contains("limits at K → 0 that the columns of the model can meet"),
        "{no_feed_through}"
    );
    assert!(message(&|f| f.regularization = -1.0).starts_with("regularization"));
    assert_eq!(
        message(&|f| f.entry_weights = Some(vec![vec![1.0, 2.0]])),
        "entry_weights: expected 2 rows of 2 numbers, found rows of [2]"
    );
    let text = r#"{"form": {"kind": "minimum_state", "states": 3}, "regularization": 0.01,
        "limits": [{"force": "vertical", "motion": "torsion", "value": 6.28}]}"#;
    let fit: FrequencyFit = serde_json::from_str(text).unwrap();
    assert_eq!(fit.limits[0].slope, None);
}
