//! Transfer functions with filters of their own: the parameters make the model, and own filters that change nothing
//! change no standard error.

use super::*;
use crate::identification::{OwnFilters, TimeFit, fit_records};
use crate::wind_tunnel::Record;

pub(super) fn own(
    force: Dof,
    motion: Dof,
    filters: impl Into<Option<usize>>,
    poles: Option<&[f64]>,
) -> OwnFilters {
    OwnFilters {
        force,
        motion,
        filters: filters.into(),
        poles: poles.map(<[f64]>::to_vec),
    }
}

/// Other filters, given poles and both, of the first transfer function and of others.
fn kinds() -> Vec<Vec<OwnFilters>> {
    let (y, t) = (Dof::Vertical, Dof::Torsion);
    vec![
        vec![own(t, t, 4, None)],
        vec![own(y, y, None, Some(&[0.3])), own(t, y, 2, None)],
        vec![own(y, t, 4, Some(&[0.5]))],
    ]
}

/// Standard error of the onset.
fn error_of(model: &Model, estimate: &CoefficientUncertainty) -> f64 {
    let k = ReducedFrequency::from_full_width(0.7);
    assert!(estimate.makes(model, k).unwrap());
    let error = onset_error(estimate, &structure(), speed_and_omega(&onset(model)), None).unwrap();
    error.standard_error_m_s
}

#[test]
fn parameters_of_own_filters_make_the_model_of_a_table() {
    let samples = scattered(3);
    let error = |form: Form, poles: Option<&[f64]>, own: Vec<OwnFilters>| {
        let poles = poles.map_or_else(PoleSearch::default, PoleSearch::fixed);
        let fit = FrequencyFit {
            form,
            own,
            ..two_poles(poles)
        };
        let (model, estimate) = fitted(&samples, &fit);
        error_of(&model, &estimate)
    };
    for own in kinds() {
        assert!(error(Form::laguerre(3), None, own).is_normal());
    }
    let (y, t) = (Dof::Vertical, Dof::Torsion);
    let known: Option<&[f64]> = Some(&[0.4]);
    let same = [
        (Some(0.4), vec![own(t, t, 3, known), own(y, t, None, known)]),
        (
            None,
            [y, t]
                .iter()
                .flat_map(|f| [y, t].map(|m| own(*f, m, None, None)))
                .collect(),
        ),
    ];
    for (pole, own) in same {
        let form = match pole {
            Some(_) => Form::laguerre(3),
            None => Form::Laguerre {
                filters: Some(3),
                feed_through: FeedThrough::default(),
                pole_per_transfer_function: true,
            },
        };
        let poles = pole.map(|p| [p]);
        let poles = poles.as_ref().map(<[f64; 1]>::as_slice);
        let (a, b) = (
            error(Form::laguerre(3), poles, own),
            error(form, poles, Vec::new()),
        );
        assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    }
}

#[test]
fn parameters_of_own_filters_make_the_model_of_records() {
    let plan = TunnelPlan {
        noise_fraction: 0.02,
        segment_s: 8.0,
        sampling_hz: 50.0,
        ..TunnelPlan::default()
    };
    let records: Vec<Record> = plan
        .records_from_model(&RationalModel::jones_flat_plate(), "plate", 0.5)
        .unwrap();
    let sources: Vec<&dyn RecordSource> = records.iter().map(|r| r as _).collect();
    let error = |own: Vec<OwnFilters>| {
        let fit = TimeFit {
            form: Form::laguerre(3),
            own,
            ..TimeFit::default()
        };
        let Fitted { model, report } = fit_records(&sources, &fit, &|_, _| ()).unwrap();
        let estimate = record_uncertainty(&sources, &fit, &report, None, &|_, _| ()).unwrap();
        error_of(&model, &estimate)
    };
    for own in kinds() {
        assert!(error(own).is_normal());
    }
}
