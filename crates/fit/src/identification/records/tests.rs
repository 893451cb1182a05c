use super::*;
use crate::aerodynamics::{FlatPlate, RationalModel, Transfer};
use crate::identification::TimeWeights;
use crate::identification::derivatives::{DerivativeOptions, identify_derivatives};
use crate::identification::form::PoleSearch;
use crate::identification::form::{FeedThrough, Form};
use crate::identification::sources;
use crate::identification::testing::{onset_m_s, records, records_alone};
use crate::trained_model::Model;
use crate::units::ReducedFrequency;
use crate::wind_tunnel::{Record, RecordHeader};

fn quiet(_: usize, _: usize) {}

fn jones_fit(weights: TimeWeights) -> TimeFit {
    TimeFit {
        form: Form::Rational {
            lags: 2,
            added_mass: true,
        },
        poles: PoleSearch::fixed(RationalModel::jones_flat_plate().lags.of_force(0)),
        weights,
        ..records_alone()
    }
}

fn assert_jones(model: &Model, tolerance: f64) {
    let jones = RationalModel::jones_flat_plate();
    let Model::Rational(found) = model else {
        panic!("not rational");
    };
    for (a, b) in [
        (&found.a1, &jones.a1),
        (&found.a2, &jones.a2),
        (&found.a3, &jones.a3),
        (&found.lag_terms[1], &jones.lag_terms[1]),
    ] {
        assert!((a - b).amax() < tolerance, "{a} {b}");
    }
}

/// Records of a rational function give back its coefficients, from two speeds without resampling, up to the images that the
/// low-pass leaves.
#[test]
fn rational_function_is_recovered_from_its_records() {
    let jones = RationalModel::jones_flat_plate();
    let all = records(&jones, &[8.17, 4.0], 0.0, 1);
    let k = |f, v| ReducedFrequency::from_hertz(f, 0.5, v).full_width();
    for weights in [
        TimeWeights::None,
        TimeWeights::PerRecord,
        TimeWeights::PerSegment,
    ] {
        let Fitted { model, report } =
            fit_records(&sources(&all), &jones_fit(weights), &quiet).unwrap();
        assert_jones(&model, 1e-3);
        assert!(
            report
                .entries
                .iter()
                .all(|e| e.relative_rms.unwrap() < 2e-3)
        );
        let range = report.tested_range;
        assert!((range.min.full_width() / k(0.25, 8.17) - 1.0).abs() < 1e-12);
        assert!((range.max.full_width() / k(2.5, 4.0) - 1.0).abs() < 1e-12);
    }
    // a motion that is driven in one of the winds alone is not tested at the frequencies of the other
    let fit = fit_records(&sources(&all[..3]), &jones_fit(TimeWeights::None), &quiet).unwrap();
    let range = fit.report.tested_range;
    assert!((range.max.full_width() / k(2.5, 8.17) - 1.0).abs() < 1e-12);
}

/// The sum of the records of the single motions, moving at once, carries the same coefficients.
#[test]
fn simultaneous_motions_are_told_apart() {
    let parts = records(&RationalModel::jones_flat_plate(), &[8.17], 0.0, 1);
    let shift = 700;
    let samples = parts[0].motion[0].len();
    let mut both = parts[0].clone();
    // one motion later than the other, so that they are not in phase all the time
    for i in 0..2 {
        for k in shift..samples {
            both.motion[i][k] += parts[1].motion[i][k - shift];
            both.force[i][k] += parts[1].force[i][k - shift];
        }
    }
    both.header.segments.clear();
    let Fitted { model, report } =
        fit_records(&[&both], &jones_fit(TimeWeights::PerRecord), &quiet).unwrap();
    assert_jones(&model, 4e-3);
    assert!(report.entries.iter().all(|e| e.relative_rms.is_none()));
    // without segments the range is the band of the motion, 0.25 to 2.5 Hz, to the resolution of its spectrum
    let k = |hz| ReducedFrequency::from_hertz(hz, 0.5, 8.17).full_width();
    let range = report.tested_range;
    assert!((range.min.full_width() - k(0.25)).abs() < k(0.05));
    assert!((range.max.full_width() - k(2.5)).abs() < k(0.05));
    let own = TimeFit {
        form: Form::Laguerre {
            filters: Some(1),
            feed_through: FeedThrough::default(),
            pole_per_transfer_function: true,
        },
        ..records_alone()
    };
    let message = fit_records(&[&both], &own, &quiet).unwrap_err().to_string();
    assert!(
        message.contains("move one degree of freedom each"),
        "{message}"
    );
}

/// Forces that a converter held at 0.4 of their peak are no record, to a fit as to derivatives; a channel at rest is no clipping.
#[test]
fn clipped_records_are_refused() {
    let mut all = records(&FlatPlate::default(), &[8.17], 0.01, 1);
    all[0].header.air_density_kg_m3 = 119.0;
    let odd = fit_records(&sources(&all), &records_alone(), &quiet).unwrap();
    let odd = odd.report.notes.iter().any(|n| n.contains("0.7 to 1.6"));
    assert!(odd, "an odd density is a note");
    let peak = all[1].force[0].iter().fold(0.0_f64, |m, f| m.max(f.abs()));
    for force in &mut all[1].force[0] {
        *force = force.clamp(-0.4 * peak, 0.4 * peak);
    }
    let fitted = fit_records(&sources(&all), &records_alone(), &quiet).unwrap_err();
    let options = DerivativeOptions::default();
    let derivatives = identify_derivatives(&sources(&all), &options).unwrap_err();
    for message in [fitted.to_string(), derivatives.to_string()] {
        assert!(
            message.contains("vertical force, sample ") && message.contains("not clipped"),
            "{message}"
        );
    }
}

/// The default model and that of three filters on clean records agree with the same fit to the transfer matrix, and the onset with the exact
/// 39.468 m/s of the flat plate within 0.1 %.
#[test]
fn flat_plate_from_records() {
    let all = records(&FlatPlate::default(), &[8.17], 0.0, 1);
    let calls = std::sync::atomic::AtomicUsize::new(0);
    let count = |done, total| {
        assert!(done <= total && total == 5 * 2);
        calls.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    };
    let default = fit_records(&sources(&all), &TimeFit::default(), &count).unwrap();
    // before and after each record of each pass
    assert_eq!(calls.into_inner(), 2 * 5 * 2);
    assert_eq!(default.report.orders.len(), 5);
    let form = Form::default().with_filters(3).unwrap();
    let three = TimeFit {
        form,
        ..TimeFit::default()
    };
    let Fitted { model, report } = fit_records(&sources(&all), &three, &quiet).unwrap();
    for model in [&default.model, &model] {
        assert!((onset_m_s(model) / 39.468 - 1.0).abs() < 1e-3);
    }
    assert!(report.orders[2].objective < report.orders[0].objective);
    // the table has it at 0.298892
    let pole = report.search[0].chosen.poles[0];
    assert!((pole / 0.299 - 1.0).abs() < 0.05, "{pole}");
    for k in [0.1, 0.3, 0.9].map(ReducedFrequency::from_full_width) {
        let exact = FlatPlate::default().transfer(k).unwrap();
        for (g, e) in model.transfer(k).unwrap().iter().zip(&exact) {
            assert!((g - e).norm() < 0.01 * e.norm(), "{g} {e}");
        }
    }
}

/// Two speeds, force noise of 5 % of its RMS, ten seeds: the onset stays within 0.5 % of the exact one.
#[test]
fn noise_of_five_per_cent() {
    for seed in 0..10 {
        let all = records(&FlatPlate::default(), &[8.17, 4.0], 0.05, seed);
        let model = fit_records(&sources(&all), &TimeFit::default(), &quiet)
            .unwrap()
            .model;
        assert!(
            (onset_m_s(&model) / 39.468 - 1.0).abs() < 5e-3,
            "seed {seed}"
        );
    }
}

/// More coefficients than the tests have numbers are counted, as of a fit to a table.
#[test]
fn too_many_filters_are_counted() {
    let all = records(&FlatPlate::default(), &[8.17], 0.0, 1);
    let fit = TimeFit {
        form: Form::laguerre(40),
        ..TimeFit::default()
    };
    let message = fit_records(&sources(&all), &fit, &quiet)
        .unwrap_err()
        .to_string();
    let said = "records: expected at least 43 numbers for 43 coefficients, found 16";
    assert_eq!(message, said);
}

/// A pole for each transfer function, found in the same passes.
#[test]
fn own_poles_from_records() {
    let all = records(&FlatPlate::default(), &[8.17], 0.0, 1);
    let fit = TimeFit {
        form: Form::Laguerre {
            filters: Some(2),
            feed_through: FeedThrough::default(),
            pole_per_transfer_function: true,
        },
        ..records_alone()
    };
    let Fitted { model, report } = fit_records(&sources(&all), &fit, &quiet).unwrap();
    assert_eq!(report.search.len(), 4);
    assert!((onset_m_s(&model) / 39.468 - 1.0).abs() < 5e-3);
}

/// Samples cut into uneven blocks, as a file reader would hand them over.
struct Chunks(Record);

impl RecordSource for Chunks {
    fn header(&self) -> &RecordHeader {
        &self.0.header
    }

    fn for_each_block(&self, f: &mut dyn FnMut(&[&[f64]]) -> Result<()>) -> Result<()> {
        let mut at = 0;
        let samples = self.0.motion[0].len();
        while at < samples {
            let end = (at + 999).min(samples);
            let channels = self.0.motion.iter().chain(&self.0.force);
            f(&channels.map(|c| &c[at..end]).collect::<Vec<_>>())?;
            at = end;
        }
        Ok(())
    }
}

/// Streaming in blocks changes nothing but the order of the roundings.
#[test]
fn blocks_do_not_matter() {
    let whole = records(&FlatPlate::default(), &[8.17], 0.05, 3);
    let chunks: Vec<Chunks> = whole.iter().cloned().map(Chunks).collect();
    let streams: Vec<&dyn RecordSource> = chunks.iter().map(|p| p as _).collect();
    let fit = TimeFit {
        poles: PoleSearch::fixed(&[0.3]),
        weights: TimeWeights::PerSegment,
        ..records_alone()
    };
    let a = fit_records(&sources(&whole), &fit, &quiet).unwrap().model;
    let b = fit_records(&streams, &fit, &quiet).unwrap().model;
    let k = ReducedFrequency::from_full_width(0.4);
    assert!((a.transfer(k).unwrap() - b.transfer(k).unwrap()).camax() < 1e-10);
}

/// A second of a record counts the same, however often it was sampled: where two speeds contradict each other, the half of the
/// samples of one of them decide no less.
#[test]
fn a_second_counts_the_same_at_every_sampling_rate() {
    let fit = TimeFit {
        poles: PoleSearch::fixed(&[0.3]),
        low_pass_hz: Some(5.0),
        ..records_alone()
    };
    let mut all = records(&FlatPlate::default(), &[8.17], 0.0, 1);
    all.extend(records(&RationalModel::jones_flat_plate(), &[4.0], 0.0, 1));
    let transfer = |all: &[Record]| {
        let model = fit_records(&sources(all), &fit, &quiet).unwrap().model;
        model
            .transfer(ReducedFrequency::from_full_width(0.4))
            .unwrap()
    };
    for force in &mut all[2].force {
        force.iter_mut().for_each(|f| *f *= 1.5);
    }
    let every = transfer(&all);
    all[2].header.sampling_hz *= 0.5;
    for channel in all[2..3]
        .iter_mut()
        .flat_map(|r| r.motion.iter_mut().chain(&mut r.force))
    {
        *channel = channel.iter().copied().step_by(2).collect();
    }
    let moved = (transfer(&all) - &every).camax() / every.camax();
    assert!(moved < 1e-3, "{moved}");
}

#[test]
fn bad_records_are_refused_with_their_place() {
    let good = records(&FlatPlate::default(), &[8.17], 0.0, 1);
    let message = |all: &[Record], fit: &TimeFit| {
        fit_records(&sources(all), fit, &quiet)
            .unwrap_err()
            .to_string()
    };
    let default = TimeFit::default();
    assert_eq!(
        message(&[], &default),
        "records: expected at least one, found none"
    );
    let mut bad = good.clone();
    bad[1].force[0][1234] = f64::NAN;
    assert_eq!(
        message(&bad, &default),
        "record test-torsion-8.17, force, sample 1234: expected a finite number, found NaN"
    );
    let mut short = good.clone();
    let Record {
        header,
        motion,
        force,
    } = &mut short[0];
    for channel in motion.iter_mut().chain(force) {
        channel.truncate(20);
    }
    header.segments.truncate(1);
    (header.segments[0].start_s, header.segments[0].end_s) = (0.0, 0.1);
    assert!(message(&short, &default).contains("record test-vertical-8.17: expected at least"));
    let one = message(&good[..1], &default);
    assert!(one.contains("a torsion motion rich enough"), "{one}");
    let cutoff = TimeFit {
        low_pass_hz: Some(150.0),
        ..records_alone()
    };
    assert!(message(&good, &cutoff).starts_with("low_pass_hz: expected less than half"));
    let low_pass_hz = Some(0.1);
    let cutoff = TimeFit {
        low_pass_hz,
        ..records_alone()
    };
    let said = message(&good, &cutoff);
    let expected =
        "low_pass_hz: expected more than the frequencies of motion of record test-vertical-8.17";
    assert!(
        said.starts_with(expected) && said.ends_with("found 0.1"),
        "{said}"
    );
    let mut other = good.clone();
    other[1].header.mean_speed_m_s = 0.0;
    assert!(message(&other, &default).contains("record test-torsion-8.17: mean_speed_m_s"));
}
