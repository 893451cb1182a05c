//! Training in full: three motions, filters of single transfer functions, static terms, memory.

use crate::aerodynamics::laguerre::{DiscreteTerm, impulse_response};
use crate::aerodynamics::{DiscreteLaguerre, LaguerreModel, RationalModel, Transfer};
use crate::files::derivatives::embedded;
use crate::identification::sources;
use crate::identification::testing::{records, records_alone, table_alone};
use crate::identification::{
    DiscreteFit, FitReport, Fitted, Form, FrequencyFit, OwnDecay, OwnFilters, PoleSearch,
    StaticTerm, TimeFit, fit_discrete, fit_records, fit_table,
};
use crate::section::Dof;
use crate::trained_model::Model;
use crate::units::ReducedFrequency;
use crate::wind_tunnel::{Record, TunnelPlan};
use nalgebra::{Complex, DMatrix, DVector};

const ALPHA: f64 = 0.6;

fn at(k: f64) -> ReducedFrequency {
    ReducedFrequency::from_full_width(k)
}

/// Largest difference of two models over several `K`, each entry relative to its own largest value over them.
pub(super) fn distance(a: &dyn Transfer, b: &dyn Transfer, ks: &[f64]) -> f64 {
    let of =
        |m: &dyn Transfer| -> Vec<_> { ks.iter().map(|k| m.transfer(at(*k)).unwrap()).collect() };
    let (a, b) = (of(a), of(b));
    let entries = 0..a[0].len();
    entries
        .map(|e| {
            let size = b.iter().map(|g| g[e].norm()).fold(0.0, f64::max);
            let pairs = a.iter().zip(&b);
            pairs.map(|(x, y)| (x[e] - y[e]).norm()).fold(0.0, f64::max) / size
        })
        .fold(0.0, f64::max)
}

fn three_by_three() -> Fitted {
    let deck = embedded::deck("LN21-5200").unwrap();
    let fit = FrequencyFit {
        poles: PoleSearch::fixed(&[0.5]),
        ..table_alone()
    };
    fit_table(&deck.samples(&Dof::THREE), &Dof::THREE, &fit).unwrap()
}

/// The 18 derivatives as three motions: what the records of a model of nine transfer functions say of it, and what the
/// fits to records and to the table say of the deck.
#[test]
fn three_motions_give_nine_transfer_functions() {
    let Fitted { model, report } = three_by_three();
    assert_eq!(report.entries.len(), 9);
    let fit = TimeFit {
        poles: PoleSearch::fixed(&[0.5]),
        ..records_alone()
    };
    let all = records(&model, &[10.9], 0.0, 1);
    assert_eq!(all.len(), 3);
    let Fitted {
        model: again,
        report,
    } = fit_records(&sources(&all), &fit, &|_, _| ()).unwrap();
    assert_eq!(report.entries.len(), 9);
    // what the low-pass leaves of the images above half the sampling frequency
    let error = distance(&again, &model, &[0.1, 0.3, 0.7]);
    assert!(error < 1e-4, "{error}");

    let deck = embedded::deck("LN21-5200").unwrap();
    let all = TunnelPlan::default()
        .records_from_table(&deck, &Dof::THREE)
        .unwrap();
    let in_time = fit_records(&sources(&all), &fit, &|_, _| ()).unwrap().model;
    // measured scatter between the two speeds is weighted by segment here and by point there
    let error = distance(&in_time, &model, &[0.15, 0.3, 0.6, 0.9]);
    assert!(error < 0.1, "{error}");
}

/// `9L` coefficients of the discrete model from three motions, against complex least squares on the eight values of `G`
/// (unweighted records of equal amplitude weight every frequency alike).
#[test]
fn nine_l_coefficients_match_a_fit_in_the_frequency_domain() {
    let deck = embedded::deck("LN21-5200").unwrap();
    let group = deck.at_speed_group(0).unwrap();
    let all = TunnelPlan::default()
        .records_from_table(&deck, &Dof::THREE)
        .unwrap();
    let fit = DiscreteFit::default();
    let Fitted { model, report } = fit_discrete(&sources(&all[..3]), &fit, &|_, _| ()).unwrap();
    let count: usize = report.entries.iter().map(|e| e.coefficients.len()).sum();
    assert_eq!(count, 27);
    let Model::DiscreteLaguerre(discrete) = &model else {
        panic!("not discrete");
    };
    let samples = group.samples(&Dof::THREE);
    for (i, force) in Dof::THREE.into_iter().enumerate() {
        for (j, motion) in Dof::THREE.into_iter().enumerate() {
            let entry: Vec<_> = samples
                .iter()
                .filter(|s| (s.force, s.motion) == (force, motion))
                .collect();
            let design = DMatrix::from_fn(entry.len(), 3, |row, l| {
                let back = Complex::new(0.0, -entry[row].k.full_width() * discrete.delta_s).exp();
                let root = ALPHA.sqrt();
                let pass = (-back + root) / (-back * root + 1.0);
                let filter = (1.0 - ALPHA).sqrt() / (-back * root + 1.0) * pass.powi(l as i32);
                match entry[row].part {
                    crate::aerodynamics::derivatives::Part::Real => filter.re,
                    crate::aerodynamics::derivatives::Part::Imaginary => filter.im,
                }
            });
            let values = DVector::from_iterator(entry.len(), entry.iter().map(|s| s.value));
            let c = design.clone().svd(true, true).solve(&values, 0.0).unwrap();
            let found = discrete.terms[j].coefficients.row(i).transpose();
            // the ramps at the ends of a segment are not of one frequency
            let (fitted, other) = (&design * &c, &design * &found);
            let error = (&fitted - &other).norm() / values.norm();
            assert!(error < 0.02, "{force:?} {motion:?}: {error}");
        }
    }
}

/// Two forces, filters shared by all transfer functions but one, which is slower and has two filters instead of three.
fn own_model() -> DiscreteLaguerre {
    let mut model = DiscreteLaguerre::shared(
        Dof::TWO.to_vec(),
        ALPHA,
        8.17 / 0.5 / 200.0,
        vec![
            DMatrix::from_row_slice(2, 3, &[-3.6, -6.3, -2.7, -0.9, -1.2, -0.4]),
            DMatrix::from_row_slice(2, 3, &[4.8, 5.3, 2.4, 0.0, 0.0, 0.0]),
        ],
        vec![0.0; 2],
    );
    model.terms.push(DiscreteTerm {
        input: 1,
        alpha: 0.9,
        coefficients: DMatrix::from_row_slice(2, 2, &[0.0, 0.0, 0.7, -0.3]),
    });
    model
}

/// The recursion in the fit against the transfer function in the records.
#[test]
fn discrete_filters_of_one_transfer_function_are_recovered() {
    let truth = own_model();
    let fit = DiscreteFit {
        own: vec![OwnDecay {
            force: Dof::Torsion,
            motion: Dof::Torsion,
            filters: Some(2),
            alpha: Some(0.9),
        }],
        ..DiscreteFit::default()
    };
    let parts = records(&truth, &[8.17], 0.0, 1);
    // both at once, one later than the other, so that no rows belong to one transfer function alone
    let mut both = parts[0].clone();
    for i in 0..2 {
        for k in 700..both.motion[i].len() {
            both.motion[i][k] += parts[1].motion[i][k - 700];
            both.force[i][k] += parts[1].force[i][k - 700];
        }
    }
    both.header.segments.clear();
    for all in [parts, vec![both]] {
        let Fitted { model, report } = fit_discrete(&sources(&all), &fit, &|_, _| ()).unwrap();
        let Model::DiscreteLaguerre(model) = model else {
            panic!("not discrete");
        };
        assert_eq!(model.terms.len(), 3);
        for (found, expected) in model.terms.iter().zip(&truth.terms) {
            assert_eq!((found.input, found.alpha), (expected.input, expected.alpha));
            // rounding of the Fourier transforms
            let error = (&found.coefficients - &expected.coefficients).amax();
            assert!(error < 1e-8, "{error}");
        }
        assert!(report.orders.is_empty());
        assert_eq!(report.entries[3].coefficients.len(), 2);
        assert!(
            report.method.contains("of their own for 1"),
            "{}",
            report.method
        );
    }
}

/// A chain of its own for one entry: recovered with its poles stated, and its pole found when it is left out.
#[test]
fn continuous_filters_of_one_transfer_function_are_recovered() {
    let own = |poles| {
        vec![OwnFilters {
            force: Dof::Torsion,
            motion: Dof::Vertical,
            filters: Some(2),
            poles,
        }]
    };
    let form = Form::default();
    let deck = embedded::deck("LN21-5200").unwrap();
    let frequency = FrequencyFit {
        form: form.clone(),
        poles: PoleSearch::fixed(&[0.4]),
        own: own(Some(vec![0.9])),
        ..table_alone()
    };
    let Fitted {
        model: truth,
        report,
    } = fit_table(&deck.samples(&Dof::TWO), &Dof::TWO, &frequency).unwrap();
    let poles: Vec<usize> = report.entries.iter().map(|e| e.poles.len()).collect();
    assert_eq!(poles, [3, 3, 2, 3]);
    let Model::Laguerre(LaguerreModel { terms, .. }) = &truth else {
        panic!("not Laguerre");
    };
    assert_eq!(terms.len(), 3);

    let all = records(&truth, &[8.17, 4.0], 0.0, 1);
    let stated = TimeFit {
        form: form.clone(),
        poles: PoleSearch::fixed(&[0.4]),
        own: own(Some(vec![0.9])),
        ..records_alone()
    };
    let found = fit_records(&sources(&all), &stated, &|_, _| ())
        .unwrap()
        .model;
    // images above half the sampling frequency, as for shared poles
    let error = distance(&found, &truth, &[0.1, 0.3, 0.8]);
    assert!(error < 1e-4, "{error}");
    let searched = TimeFit {
        own: own(None),
        ..stated
    };
    let report = fit_records(&sources(&all), &searched, &|_, _| ())
        .unwrap()
        .report;
    assert_eq!(report.search.len(), 1);
    assert_eq!(report.search[0].entry, Some((Dof::Torsion, Dof::Vertical)));
    let pole = report.search[0].chosen.poles[0];
    assert!((pole / 0.9 - 1.0).abs() < 0.02, "{pole}");
}

/// A constant in the forces: estimated it is reported and harms nothing, removed it is gone, ignored it spoils the fit.
#[test]
fn static_terms_are_estimated_or_removed() {
    let truth = RationalModel::jones_flat_plate();
    let mut all = records(&truth, &[8.17, 4.0], 0.0, 1);
    let constants = [0.03, -0.008];
    for record in &mut all {
        let h = record.header.clone();
        let pressure = 0.5 * h.air_density_kg_m3 * h.mean_speed_m_s.powi(2);
        for (i, c) in constants.iter().enumerate() {
            let offset = pressure * h.dofs[i].force_scale(h.width_m) * c;
            record.force[i].iter_mut().for_each(|f| *f += offset);
        }
    }
    let fitted = |static_term| {
        let fit = TimeFit {
            form: Form::Rational {
                lags: 2,
                added_mass: true,
            },
            poles: PoleSearch::fixed(truth.lags.of_force(0)),
            static_term,
            ..records_alone()
        };
        fit_records(&sources(&all), &fit, &|_, _| ()).unwrap()
    };
    let Fitted { model, report } = fitted(StaticTerm::Estimated);
    assert!(distance(&model, &truth, &[0.1, 0.9]) < 1e-3);
    for (reported, c) in report.static_terms.iter().zip(constants) {
        assert!((reported.value - c).abs() < 1e-6, "{reported:?}");
        assert!(reported.standard_error.unwrap() < 1e-5 && reported.record.is_none());
    }
    let Fitted { model, report } = fitted(StaticTerm::Removed);
    assert!(distance(&model, &truth, &[0.1, 0.9]) < 2e-3);
    assert_eq!(report.static_terms.len(), 8);
    // the motions start and end at rest: their own mean is small
    assert!((report.static_terms[0].value - constants[0]).abs() < 1e-4);
    let Fitted { model, report } = fitted(StaticTerm::None);
    assert!(report.static_terms.is_empty());
    assert!(report.entries.iter().any(|e| e.relative_rms.unwrap() > 0.1));
    assert!(distance(&model, &truth, &[0.1, 0.9]) > 1e-2);
}

/// A record cut shortly before its motion: the warning names record, memory and rest.
#[test]
fn too_little_rest_before_the_motion_is_said() {
    let whole = records(&RationalModel::jones_flat_plate(), &[8.17], 0.0, 1);
    let discrete = |all: &[Record]| {
        let fit = DiscreteFit::default();
        fit_discrete(&sources(all), &fit, &|_, _| ())
            .unwrap()
            .report
    };
    let continuous = |all: &[Record], discard_s| {
        let fit = TimeFit {
            poles: PoleSearch::fixed(&[0.3]),
            discard_s,
            ..records_alone()
        };
        fit_records(&sources(all), &fit, &|_, _| ()).unwrap().report
    };
    let remembered = |r: &FitReport| r.notes.iter().any(|n| n.contains("the filters remember"));
    let report = discrete(&whole);
    assert_eq!(report.memory.len(), 2);
    // section 3.3: "the memory is about M = 40" with these filters
    let g = impulse_response(ALPHA, 3, 200);
    let memory = 1 + (0..200).rev().find(|k| g.column(*k).amax() > 0.01).unwrap();
    assert_eq!(report.memory[0].memory_samples, memory);
    assert_eq!(memory, 36);
    // "all the imposed motions start after 8 s"; the ramp takes its time to pass 1 %
    let available = report.memory[0].available_samples;
    assert!((1600..1800).contains(&available), "{available}");
    assert!(!remembered(&report) && !remembered(&continuous(&whole, 0.0)));

    let mut cut = whole;
    let late = &mut cut[1];
    for channel in late.motion.iter_mut().chain(&mut late.force) {
        channel.drain(..available - 5);
    }
    cut[1].header.segments.clear();
    let report = discrete(&cut);
    // the rest counts from the new first value, which the ramp has already moved a little
    let left = report.memory[1].available_samples;
    assert!((5..memory).contains(&left), "{left}");
    let note = format!("record test-torsion-8.17: the filters remember {memory} samples");
    assert!(
        report.notes.iter().any(|n| n.starts_with(&note)),
        "{:?}",
        report.notes
    );
    assert!(remembered(&continuous(&cut, 0.0)));
    assert!(!remembered(&continuous(&cut, 4.0)));
}
