//! Lags of each force, minimum state, weights of entries, regularisation; degenerate lags are said.

use super::super::*;
use crate::aerodynamics::{
    FlatPlate, Lags, MinimumStateModel, RationalModel, Realizable, Transfer,
};
use crate::files::derivatives::embedded;
use crate::identification::form::PoleSearch;
use crate::identification::testing::{eight_k, onset_m_s, records_alone, table_alone};
use crate::identification::{TimeFit, sample_model};
use crate::trained_model::Model;
use crate::units::ReducedFrequency;

fn flat_plate() -> Vec<TransferSample> {
    sample_model(&FlatPlate::default(), &eight_k(8.17)).unwrap()
}

fn jones_samples() -> Vec<TransferSample> {
    let ks: Vec<_> = (1..=16)
        .map(|i| ReducedFrequency::from_full_width(0.1 * f64::from(i)))
        .collect();
    sample_model(&RationalModel::jones_flat_plate(), &ks).unwrap()
}

fn with(form: Form) -> FrequencyFit {
    FrequencyFit {
        form,
        ..table_alone()
    }
}

fn shared(lags: usize) -> Form {
    Form::Rational {
        lags,
        added_mass: true,
    }
}

fn per_force(lags: usize) -> Form {
    Form::RationalPerForce {
        lags,
        added_mass: true,
    }
}

fn minimum_state(states: usize) -> Form {
    Form::MinimumState {
        states,
        added_mass: true,
    }
}

/// Every rational form recovers Jones's function from samples of it: lags and transfer matrix to 1e-9, also outside the
/// samples.
#[test]
fn jones_is_recovered_exactly_by_every_form() {
    let jones = RationalModel::jones_flat_plate();
    let samples = jones_samples();
    for form in [shared(2), per_force(2), minimum_state(2)] {
        let Fitted { model, report } = fit_table(&samples, &Dof::TWO, &with(form)).unwrap();
        let found = match &model {
            Model::Rational(m) => [m.lags.of_force(0), m.lags.of_force(1)].concat(),
            Model::MinimumState(m) => m.lags.clone(),
            _ => panic!("not rational"),
        };
        for (d, expected) in found.iter().zip([0.091, 0.6].iter().cycle()) {
            assert!((d / expected - 1.0).abs() < 1e-9, "{}: {d}", report.method);
        }
        for k in [0.01, 0.3, 2.5].map(ReducedFrequency::from_full_width) {
            let expected = jones.transfer(k).unwrap();
            let error = (model.transfer(k).unwrap() - &expected).camax();
            assert!(
                error < 1e-9 * expected.camax(),
                "{}: {error:e}",
                report.method
            );
        }
        assert!(report.notes.is_empty(), "{:?}", report.notes);
    }
    // and with the true lags given, coefficient by coefficient
    let given = FrequencyFit {
        poles: PoleSearch::fixed(&[0.091, 0.6]),
        ..with(shared(2))
    };
    let Model::Rational(found) = fit_table(&samples, &Dof::TWO, &given).unwrap().model else {
        panic!("not rational");
    };
    for (a, b) in [
        (&found.a1, &jones.a1),
        (&found.a2, &jones.a2),
        (&found.a3, &jones.a3),
        (&found.lag_terms[0], &jones.lag_terms[0]),
        (&found.lag_terms[1], &jones.lag_terms[1]),
    ] {
        assert!((a - b).amax() < 1e-9);
    }
}

/// A force that has its own lags is fitted at least as well as with common ones, and every force is searched by name.
#[test]
fn own_lags_fit_at_least_as_well() {
    let table = embedded::deck("LN21-5200").unwrap();
    let samples = table.samples(&Dof::TWO);
    let Fitted { model, report: own } =
        fit_table(&samples, &Dof::TWO, &with(per_force(1))).unwrap();
    let common = fit_table(&samples, &Dof::TWO, &with(shared(1)))
        .unwrap()
        .report;
    let forces: Vec<_> = own.search.iter().map(|s| s.force).collect();
    assert_eq!(forces, [Some(Dof::Vertical), Some(Dof::Torsion)]);
    // objectives of two rows are mean squares over two entries each
    let squares: f64 = own.search.iter().map(|s| s.chosen.objective.powi(2)).sum();
    assert!((squares / 2.0).sqrt() <= common.search[0].chosen.objective * (1.0 + 1e-9));
    let Model::Rational(model) = model else {
        panic!("not rational");
    };
    assert!(matches!(&model.lags, Lags::PerForce(rows) if rows.len() == 2));
    assert_eq!(model.realize().states(), 2);
    let given = FrequencyFit {
        poles: PoleSearch::fixed(&[0.3, 0.6]),
        ..with(per_force(1))
    };
    let Model::Rational(model) = fit_table(&samples, &Dof::TWO, &given).unwrap().model else {
        panic!("not rational");
    };
    assert_eq!(model.lags, Lags::PerForce(vec![vec![0.3], vec![0.6]]));
}

/// Two states on the flat plate give its onset (39.468 m/s) as well as two lags with four states do (39.456), and three
/// degrees of freedom take no more states.
#[test]
fn minimum_state_on_the_flat_plate() {
    let Fitted { model, report } =
        fit_table(&flat_plate(), &Dof::TWO, &with(minimum_state(2))).unwrap();
    assert_eq!(model.realize().states(), 2);
    assert!(
        (onset_m_s(&model) - 39.456).abs() < 0.03,
        "{}",
        onset_m_s(&model)
    );
    for entry in &report.entries {
        assert!(entry.relative_rms.unwrap() < 0.01);
        assert_eq!(entry.coefficients.len(), 5);
    }
    let table = embedded::deck("LN20-5500").unwrap();
    let wide = with(minimum_state(3));
    let model = fit_table(&table.samples(&Dof::THREE), &Dof::THREE, &wide)
        .unwrap()
        .model;
    assert_eq!(model.realize().states(), 3);
}

/// A minimum-state function with unequal directions is found again from its samples.
#[test]
fn minimum_state_recovers_itself() {
    let roger = RationalModel::jones_flat_plate();
    let truth = MinimumStateModel {
        dofs: roger.dofs.clone(),
        a1: roger.a1.clone(),
        a2: roger.a2.clone(),
        a3: roger.a3.clone(),
        lags: vec![0.15, 0.7],
        d: nalgebra::DMatrix::from_row_slice(2, 2, &[1.0, -0.5, 0.1, 0.6]),
        e: nalgebra::DMatrix::from_row_slice(2, 2, &[0.3, 1.0, -1.2, 0.4]),
    };
    let ks: Vec<_> = (1..=12)
        .map(|i| ReducedFrequency::from_full_width(0.12 * f64::from(i)))
        .collect();
    let samples = sample_model(&truth, &ks).unwrap();
    let model = fit_table(&samples, &Dof::TWO, &with(minimum_state(2)))
        .unwrap()
        .model;
    for k in [0.02, 0.5, 2.0].map(ReducedFrequency::from_full_width) {
        let expected = truth.transfer(k).unwrap();
        let error = (model.transfer(k).unwrap() - &expected).camax();
        assert!(error < 1e-8 * expected.camax(), "{error:e}");
    }
}

/// With all weight on one entry the shared lag is the one that entry has alone.
#[test]
fn weights_of_entries_move_shared_lags() {
    let table = embedded::deck("LN21-5200").unwrap();
    let samples = table.samples(&Dof::TWO);
    let lag = |weights: Option<Vec<Vec<f64>>>| {
        let fit = FrequencyFit {
            entry_weights: weights,
            ..with(shared(1))
        };
        let report = fit_table(&samples, &Dof::TWO, &fit).unwrap().report;
        report.search[0].chosen.poles[0]
    };
    let only = lag(Some(vec![vec![0.0, 0.0], vec![0.0, 1.0]]));
    let alone = FrequencyFit {
        form: Form::TakenakaMalmquist {
            filters: 1,
            feed_through: crate::identification::FeedThrough::default(),
            pole_per_transfer_function: true,
        },
        ..table_alone()
    };
    let report = fit_table(&samples, &Dof::TWO, &alone).unwrap().report;
    let expected = report.search[3].chosen.poles[0];
    assert!((only / expected - 1.0).abs() < 1e-6, "{only} {expected}");
    assert!((lag(None) / expected - 1.0).abs() > 0.01);
    let equal = lag(Some(vec![vec![2.0; 2]; 2]));
    assert!((equal / lag(None) - 1.0).abs() < 1e-6);
}

/// Nearly equal lags of LN21-5500 have huge coefficients that cancel, which is said; a ridge makes them small again at
/// little cost.
#[test]
fn degenerate_lags_are_said_and_a_ridge_holds_them() {
    let table = embedded::deck("LN21-5500").unwrap();
    let samples = table.samples(&Dof::TWO);
    let fit = |regularization: f64| FrequencyFit {
        poles: PoleSearch::fixed(&[0.5, 0.505]),
        regularization,
        ..with(shared(2))
    };
    let largest = |report: &FitReport| {
        let values = report.entries.iter().flat_map(|e| &e.coefficients[3..]);
        values.map(|c| c.value.abs()).fold(0.0, f64::max)
    };
    let said = |report: &FitReport, what: &str| report.notes.iter().any(|n| n.contains(what));
    let free = fit_table(&samples, &Dof::TWO, &fit(0.0)).unwrap().report;
    assert!(said(
        &free,
        "degenerate lags: 0.5000 and 0.5050 are nearly equal"
    ));
    assert!(said(&free, "coefficients cancel"), "{:?}", free.notes);
    let constrained = fit_table(&samples, &Dof::TWO, &fit(0.05)).unwrap().report;
    assert!(
        largest(&constrained) < 0.02 * largest(&free),
        "{} {}",
        largest(&constrained),
        largest(&free)
    );
    assert!(
        said(&constrained, "regularised with 0.05") && !said(&constrained, "coefficients cancel")
    );
    for (a, b) in constrained.entries.iter().zip(&free.entries) {
        assert!(a.relative_rms.unwrap() < b.relative_rms.unwrap() + 0.05);
    }
    let own = FrequencyFit {
        poles: PoleSearch {
            min: Some(1.5),
            max: Some(2.0),
            ..PoleSearch::default()
        },
        ..with(per_force(1))
    };
    let report = fit_table(&samples, &Dof::TWO, &own).unwrap().report;
    assert!(
        report
            .notes
            .iter()
            .any(|n| n.contains("force: the pole") && n.contains("bound")),
        "{:?}",
        report.notes
    );
}

#[test]
fn forms_for_tables_only_say_so() {
    for form in [per_force(1), minimum_state(2)] {
        let fit = TimeFit {
            form,
            ..records_alone()
        };
        let message = fit.validate().unwrap_err().to_string();
        assert!(
            message.starts_with("form.kind: expected laguerre"),
            "{message}"
        );
    }
    let odd = FrequencyFit {
        poles: PoleSearch::fixed(&[0.1, 0.2, 0.3]),
        ..with(per_force(1))
    };
    let message = fit_table(&flat_plate(), &Dof::TWO, &odd).unwrap_err();
    assert_eq!(
        message.to_string(),
        "poles.fixed: expected 1 number, or 2 for the 2 forces, found 3"
    );
}
