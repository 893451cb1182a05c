//! Training with broadband motions.

use super::training::distance;
use crate::aerodynamics::RationalModel;
use crate::files::derivatives::embedded;
use crate::identification::sources;
use crate::identification::testing::{records_alone, table_alone};
use crate::identification::{
    DiscreteFit, Fitted, Form, FrequencyFit, PoleSearch, StaticTerm, TimeFit, fit_discrete,
    fit_records, fit_table,
};
use crate::section::Dof;
use crate::units::ReducedFrequency;
use crate::wind_tunnel::{TrainingMotion, TunnelPlan};

/// White noise and a multi-sine train as sines do; the band is found; noise makes the discrete filters nearly orthogonal.
#[test]
fn broadband_motions_train_models() {
    let truth = RationalModel::jones_flat_plate();
    let plan = |motion| TunnelPlan {
        motion,
        speeds_m_s: vec![8.17],
        ..TunnelPlan::default()
    };
    let noise = |min_hz, max_hz| TrainingMotion::WhiteNoise {
        min_hz,
        max_hz,
        duration_s: 120.0,
    };
    let k = |hz| ReducedFrequency::from_hertz(hz, 0.5, 8.17).full_width();
    for motion in [
        noise(0.25, 2.5),
        TrainingMotion::MultiSine { duration_s: 120.0 },
    ] {
        let all = plan(motion)
            .records_from_model(&truth, "Jones", 0.5)
            .unwrap();
        let fit = TimeFit {
            form: Form::Rational {
                lags: 2,
                added_mass: true,
            },
            poles: PoleSearch::fixed(truth.lags.of_force(0)),
            ..records_alone()
        };
        let Fitted { model, report } = fit_records(&sources(&all), &fit, &|_, _| ()).unwrap();
        let error = distance(&model, &truth, &[0.12, 0.5, 0.9]);
        assert!(error < 1e-3, "{motion:?}: {error}");
        let range = report.tested_range;
        assert!(
            (range.min.full_width() - k(0.25)).abs() < k(0.08),
            "{range:?}"
        );
        assert!(
            (range.max.full_width() - k(2.5)).abs() < k(0.08),
            "{range:?}"
        );
    }
    let condition = |motion| {
        let all = plan(motion)
            .records_from_model(&truth, "Jones", 0.5)
            .unwrap();
        let fit = DiscreteFit {
            static_term: StaticTerm::None,
            ..DiscreteFit::default()
        };
        fit_discrete(&sources(&all), &fit, &|_, _| ())
            .unwrap()
            .report
            .condition
    };
    let (white, sines) = (
        condition(noise(0.01, 40.0)),
        condition(TrainingMotion::Harmonic {}),
    );
    // exactly 1 for noise up to half the sampling frequency; 40 of 100 Hz hold most of the filters' power
    assert!(white < 4.0 && sines > 10.0 * white, "{white} {sines}");
}

/// A table is asked for broadband records only with leave to interpolate it.
#[test]
fn a_table_is_interpolated_only_on_request() {
    let deck = embedded::deck("LN21-5200").unwrap();
    let mut plan = TunnelPlan {
        motion: TrainingMotion::WhiteNoise {
            min_hz: 0.3,
            max_hz: 2.4,
            duration_s: 60.0,
        },
        ..TunnelPlan::default()
    };
    let refused = plan.records_from_table(&deck, &Dof::TWO).unwrap_err();
    assert!(
        refused.to_string().contains("interpolate_table = true"),
        "{refused}"
    );
    plan.interpolate_table = true;
    let all = plan.records_from_table(&deck, &Dof::TWO).unwrap();
    assert_eq!(all.len(), 4);
    assert!(all[0].header.source.contains("interpolated in V̂"));
    assert!(all.iter().all(|r| r.header.segments.is_empty()));
    let fit = TimeFit {
        poles: PoleSearch::fixed(&[0.5]),
        ..records_alone()
    };
    let noise = fit_records(&sources(&all), &fit, &|_, _| ()).unwrap().model;
    let frequency = FrequencyFit {
        poles: PoleSearch::fixed(&[0.5]),
        ..table_alone()
    };
    let table = fit_table(&deck.samples(&Dof::TWO), &Dof::TWO, &frequency)
        .unwrap()
        .model;
    // measured derivatives are no smooth function between their points
    let error = distance(&noise, &table, &[0.2, 0.5, 0.8]);
    assert!(error < 0.15, "{error}");
}
