use super::*;
use crate::aerodynamics::{FlatPlate, Transfer};
use crate::files::derivatives::embedded;
use crate::identification::sources;
use crate::identification::testing::{onset_m_s, records};
use crate::units::ReducedFrequency;
use crate::wind_tunnel::TunnelPlan;

/// The thesis's formulation on flat-plate records (8.17 m/s, α = 0.6), computed independently with NumPy.
#[test]
fn thesis_formulation_on_the_flat_plate() {
    let all = records(&FlatPlate::default(), &[8.17], 0.0, 1);
    for (filters, expected) in [(3, 37.68), (5, 38.90)] {
        let fit = DiscreteFit {
            filters,
            ..DiscreteFit::default()
        };
        let Fitted { model, report } = fit_discrete(&sources(&all), &fit, &|_, _| ()).unwrap();
        assert!((onset_m_s(&model) - expected).abs() < 0.1);
        let guideline = report.alpha_guideline.unwrap();
        assert!((guideline.lower_bound - 0.8547).abs() < 5e-5);
        assert!((guideline.sampling_hz - 200.0).abs() < 1e-9);
        assert!(report.notes.iter().any(|n| n.contains("4.5 % below")));
        assert!(
            report
                .notes
                .iter()
                .any(|n| n.contains("below the guideline (2.36)"))
        );
    }
}

/// Records that a discrete model made itself give it back, static term included.
#[test]
fn discrete_model_is_recovered() {
    let mut all = records(&FlatPlate::default(), &[8.17], 0.0, 1);
    let (c, alpha, static_lift) = ([[1.2, -0.7], [0.4, 0.3]], 0.6_f64, 0.05);
    for (j, record) in all.iter_mut().enumerate() {
        let h = record.header.clone();
        let q = 0.5 * h.air_density_kg_m3 * h.mean_speed_m_s.powi(2);
        let (root, gain) = (alpha.sqrt(), (1.0 - alpha).sqrt());
        let (mut x0, mut x1) = (0.0, 0.0);
        for k in 0..record.motion[j].len() {
            let v = record.motion[j][k] * h.dofs[j].motion_scale(h.width_m);
            let new = root * x0 + gain * v;
            x1 = root * x1 + root * new - x0;
            x0 = new;
            let lift = c[j][0] * x0 + c[j][1] * x1 + static_lift;
            record.force[0][k] = q * h.dofs[0].force_scale(h.width_m) * lift;
            record.force[1][k] = 0.0;
        }
    }
    let fit = DiscreteFit {
        filters: 2,
        ..DiscreteFit::default()
    };
    let model = fit_discrete(&sources(&all), &fit, &|_, _| ())
        .unwrap()
        .model;
    let Model::DiscreteLaguerre(model) = model else {
        panic!("not discrete");
    };
    for (j, c) in c.iter().enumerate() {
        for (l, expected) in c.iter().enumerate() {
            assert!((model.terms[j].coefficients[(0, l)] - expected).abs() < 1e-10);
        }
    }
    assert!((model.static_term[0] - static_lift).abs() < 1e-12);
    assert!(model.static_term[1].abs() < 1e-12);
}

/// A record of half the speed, resampled to the Δs of the faster one, fits the same model: the transfer matrix depends on
/// K only.
#[test]
fn speeds_are_stacked_at_one_step() {
    let fit = DiscreteFit {
        filters: 5,
        ..DiscreteFit::default()
    };
    let both = records(&FlatPlate::default(), &[8.0, 5.3], 0.0, 1);
    let Fitted { model, report } = fit_discrete(&sources(&both), &fit, &|_, _| ()).unwrap();
    let Model::DiscreteLaguerre(discrete) = &model else {
        panic!("not discrete");
    };
    assert!((discrete.delta_s - 8.0 / 0.5 / 200.0).abs() < 1e-15);
    let samples = 2.0 * 43_200.0 * (1.0 + 5.3 / 8.0);
    assert!((report.samples as f64 / samples - 1.0).abs() < 1e-3);
    // moment due to rotation at K = 0.5: five filters fit it within 5 %, from either speed
    let k = ReducedFrequency::from_full_width(0.5);
    let exact = FlatPlate::default().transfer(k).unwrap()[(1, 1)];
    let found = model.transfer(k).unwrap()[(1, 1)];
    assert!(
        (found - exact).norm() < 0.05 * exact.norm(),
        "{found} {exact}"
    );
}

#[test]
fn impossible_options_are_refused() {
    let all = records(&FlatPlate::default(), &[8.17], 0.0, 1);
    for (filters, alpha, expected) in [
        (0, 0.6, "filters: expected at least 1, found 0"),
        (3, 1.0, "alpha: expected 0 < alpha < 1, found 1"),
        (3, f64::NAN, "alpha: expected 0 < alpha < 1, found NaN"),
    ] {
        let fit = DiscreteFit {
            filters,
            alpha,
            ..DiscreteFit::default()
        };
        let error = fit_discrete(&sources(&all), &fit, &|_, _| ()).unwrap_err();
        assert_eq!(error.to_string(), expected);
    }
}

/// The thesis's headline: its own deck and formulation on the records of either test speed (NumPy: 37.87 and 38.78 m/s).
#[test]
fn thesis_formulation_on_ln21_5200() {
    let table = embedded::deck("LN21-5200").unwrap();
    let all = TunnelPlan::default()
        .records_from_table(&table, &Dof::TWO)
        .unwrap();
    for (pair, expected) in all.chunks(2).zip([37.87, 38.78]) {
        let fit = DiscreteFit::default();
        let model = fit_discrete(&sources(pair), &fit, &|_, _| ())
            .unwrap()
            .model;
        let onset = onset_m_s(&model);
        assert!((onset - expected).abs() < 0.15, "{onset} for {expected}");
    }
}
