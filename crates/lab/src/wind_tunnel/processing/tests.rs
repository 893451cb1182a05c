//! Processing of virtual campaigns against their truth.

mod bodies;

use super::*;
use crate::aerodynamics::FlatPlate;
use crate::wind_tunnel::virtual_campaign::{VirtualCampaign, VirtualCampaignPlan};

fn campaign(plan: &VirtualCampaignPlan) -> VirtualCampaign {
    plan.from_model(&FlatPlate::default(), "plate", 0.5)
        .unwrap()
}

/// Three frequencies at 8 m/s, heave and rotation.
fn short(mut plan: VirtualCampaignPlan) -> VirtualCampaignPlan {
    plan.tunnel.speeds_m_s = vec![8.0];
    plan.tunnel.frequencies_hz = vec![0.5, 1.1, 2.0];
    plan
}

fn done(raw: &RawCampaign, options: &ProcessingOptions) -> Processed {
    process(raw, options, &|_, _| {}).unwrap()
}

fn refused(raw: &RawCampaign) -> String {
    process(raw, &ProcessingOptions::default(), &|_, _| {})
        .unwrap_err()
        .to_string()
}

/// Greatest difference over greatest force, records against truth.
fn worst(processed: &Processed, truth: &[Record], force: usize) -> f64 {
    let mut worst = 0.0_f64;
    for (ours, truth) in processed.records.iter().zip(truth) {
        let size = truth.force[force]
            .iter()
            .fold(0.0_f64, |m, x| m.max(x.abs()));
        for (a, b) in ours.force[force].iter().zip(&truth.force[force]) {
            worst = worst.max((a - b).abs() / size);
        }
    }
    worst
}

/// Gravity, inertia, clamping, static wind and turning cells, but nothing that measurement adds.
#[test]
fn a_campaign_without_disturbances_gives_the_truth_back() {
    let made = campaign(&short(VirtualCampaignPlan::default()));
    let processed = done(&made.raw, &ProcessingOptions::default());
    assert_eq!(processed.records.len(), 2);
    for force in 0..2 {
        // the low-pass rounds the corners of the ramps, the drift takes a little of them
        assert!(worst(&processed, &made.records, force) < 1e-3);
    }
    for run in &processed.report.runs {
        assert!(run.warnings.is_empty(), "{:?}", run.warnings);
        assert!(run.replaced.is_empty() && run.clipped.is_empty());
        // the plan: lift −0.12, drag 0.08, moment 0.02. A centre of mass off the axis presses outwards by m e θ̇², some 1e-3 N in the mean
        // while the model turns; the polynomials of the cells take 2e-4 N of it for drift, 3e-6 of the pressure on the model
        for (found, stated) in run
            .means
            .static_coefficients
            .iter()
            .zip([-0.12, 0.08, 0.02])
        {
            assert!((found - stated).abs() < 1e-5, "{found}");
        }
        // weight of 2 kg/m × 2.68 m, likewise
        let weight_n = 2.0 * 2.68 * 9.81;
        assert!((run.means.still_air[0] + weight_n).abs() < 1e-3);
        assert_eq!(run.segments.len(), 3);
    }
    let inertia = |i: usize| processed.report.runs[i].still_air.clone().unwrap();
    // the ramps in the steady part are not quite harmonic: 1e-4
    assert!((inertia(0).inertia / (2.0 * 2.68) - 1.0).abs() < 1e-4);
    let about_centre = (0.04 + 2.0 * (0.004_f64.powi(2) + 0.01_f64.powi(2))) * 2.68;
    assert!((inertia(1).inertia / about_centre - 1.0).abs() < 1e-4);
    // gravity turns the model back: centre of gravity 10 mm below the axis
    assert!((inertia(1).stiffness.unwrap() / (2.0 * 2.68 * 9.81 * 0.01) - 1.0).abs() < 5e-3);
    assert!(processed.report.lag_s.abs() < 1e-5);
}

/// Still air with 0.9 of the amplitude (A3* wrong by up to 37 % in a campaign of lower speeds), or by another clock, had a note or none.
#[test]
fn still_air_that_moves_otherwise_is_a_doubt() {
    let doubts = |change: fn(&[f64]) -> Vec<f64>| {
        let mut raw = campaign(&short(VirtualCampaignPlan::default())).raw;
        let still = raw.runs[1].still_air.as_mut().unwrap();
        *still = still.map(change);
        done(&raw, &ProcessingOptions::default()).report.doubts()
    };
    assert!(doubts(<[f64]>::to_vec).is_empty());
    for change in [
        |x: &[f64]| x.iter().map(|v| 0.9 * v).collect(),
        |x: &[f64]| crate::signal::resampled(x, 1.0 + 1e-3),
    ] {
        let said = doubts(change);
        assert!(
            said.iter()
                .any(|d| d.contains("the motion in still air differs by")),
            "{said:?}"
        );
    }
}

/// Sway and drag both measured upwind agree with each other, and with no wind.
#[test]
fn drag_upwind_is_a_doubt() {
    let mut plan = short(VirtualCampaignPlan::realistic());
    plan.static_wind.drag *= -1.0;
    let doubts = done(&campaign(&plan).raw, &ProcessingOptions::default())
        .report
        .doubts();
    let upwind = |d: &&String| d.contains("pushes the model upwind, drag coefficient -0.08");
    assert_eq!(doubts.iter().filter(upwind).count(), 2, "{doubts:?}");
}

#[test]
fn lag_offset_drift_and_spike_are_found() {
    let plan = short(VirtualCampaignPlan::realistic());
    let made = campaign(&plan);
    let processed = done(&made.raw, &ProcessingOptions::default());
    let report = &processed.report;
    let d = &plan.disturbances;
    let error = report.lag_standard_error_s.unwrap();
    assert!(error < 1e-4, "{error}");
    // four standard errors; 5e-6 s is what the ramps in the steady part cost
    assert!((report.lag_s - d.force_lag_s).abs() < 4.0 * error + 5e-6);
    for (run, applied) in report.runs.iter().zip(&made.disturbances) {
        // the motions are without noise: interpolation alone
        let alignment = run.alignment.unwrap();
        assert!((alignment.offset_s - d.still_air_offset_s).abs() < 1e-8);
        assert!((alignment.parabolic_samples - alignment.offset_samples).abs() < 1e-3);
        let spike = applied.spike.unwrap();
        let [found] = &run.replaced[..] else {
            panic!("{:?}", run.replaced);
        };
        assert_eq!(found.reason, "spike");
        // counted from the first covered sample, which is the first here
        assert_eq!(run.cut[0], 0);
        assert!(found.first <= spike.first);
        assert!(found.first + found.samples >= spike.first + spike.samples);
        // the knock, a guard of a tenth of a second on either side, and a period of the low-pass (5.6 Hz) about which it rings
        assert!(found.samples < spike.samples + 2 * 20 + 36, "{found:?}");
        // 5 % of noise is 26 dB, and 7 of 100 Hz are left
        let at = index(run.dof);
        assert!(run.signal_to_noise.before_low_pass_db[at] > 20.0);
        assert!(run.signal_to_noise.after_low_pass_db[at] > 30.0);
        // two recordings of two cells, each with up to 0.3 N of rise and 0.15 N of wave
        for cell in &run.cell_drift {
            assert!(
                cell.range[..3].iter().all(|r| (0.0..0.45).contains(r)),
                "{cell:?}"
            );
            assert!(cell.range[..3].iter().any(|r| *r > 0.05), "{cell:?}");
        }
    }
    for force in 0..2 {
        // what is left of 5 % noise behind the low-pass: 4.5 standard deviations of 1.3 % of an RMS, ⅓ of the greatest force
        assert!(worst(&processed, &made.records, force) < 0.05);
    }
    let text = serde_json::to_string(report).unwrap();
    assert_eq!(
        serde_json::from_str::<ProcessingReport>(&text).unwrap(),
        *report
    );
}

/// Without correction the same campaign is wrong: each stage is needed.
#[test]
fn a_stated_lag_is_taken_and_a_wrong_one_shows() {
    let mut plan = short(VirtualCampaignPlan::default());
    plan.disturbances.force_lag_s = 0.0017;
    let made = campaign(&plan);
    let with = |lag_s| {
        let options = ProcessingOptions {
            lag_s,
            ..ProcessingOptions::default()
        };
        worst(&done(&made.raw, &options), &made.records, 0)
    };
    assert!(with(Some(0.0017)) < 1e-3);
    assert!(with(None) < 1e-3);
    // ωτ = 2π·2·0.0017
    assert!(with(Some(0.0)) > 0.01);
}

#[test]
fn cut_ramps_leave_whole_periods() {
    let made = campaign(&short(VirtualCampaignPlan::default()));
    let mut options = ProcessingOptions::default();
    options.segments.ramps = Ramps::Cut;
    let processed = done(&made.raw, &options);
    assert_eq!(processed.records.len(), 6);
    for record in &processed.records {
        let [segment] = &record.header.segments[..] else {
            panic!("one segment per record");
        };
        let periods = record.force[0].len() as f64 * segment.frequency_hz / 200.0;
        assert!((periods - periods.round()).abs() < 0.01, "{periods}");
    }
}

/// Still air recorded for less long: what both cover is used, and too little is said.
#[test]
fn recordings_of_unequal_length() {
    let mut made = campaign(&short(VirtualCampaignPlan::default()));
    let cut = |raw: &mut RawCampaign, count: usize| {
        let still = raw.runs[0].still_air.as_mut().unwrap();
        still.motion.iter_mut().for_each(|x| x.truncate(count));
        still
            .cells
            .iter_mut()
            .flatten()
            .for_each(|x| x.truncate(count));
        still.wind_speed_m_s.truncate(count);
    };
    let whole = made.raw.runs[0].in_wind.sample_count();
    cut(&mut made.raw, whole - 100);
    let processed = done(&made.raw, &ProcessingOptions::default());
    // 100 samples, and perhaps one more that a shift by part of a sample leaves without a neighbour
    assert!((100..=101).contains(&processed.report.runs[0].cut[1]));
    assert!(processed.report.warnings()[0].contains("only the part that both cover"));
    cut(&mut made.raw, whole - 4000);
    let message = refused(&made.raw);
    assert!(
        message.contains("still air: expected a recording as long as the motion at 2.000 Hz"),
        "{message}"
    );
    made.raw.runs[0].still_air.as_mut().unwrap().motion[0].pop();
    assert!(refused(&made.raw).contains("samples, as the first force channel"));
}

/// Recordings of the steady part alone, still air from 37 samples later on.
#[test]
fn steady_recordings_use_the_periods_that_both_cover() {
    let mut plan = short(VirtualCampaignPlan::default());
    plan.tunnel.frequencies_hz = vec![0.5];
    let mut raw = campaign(&plan).raw;
    for run in &mut raw.runs {
        run.in_wind = run.in_wind.map(|x| x[2400..5600].to_vec());
        run.still_air = run
            .still_air
            .as_ref()
            .map(|r| r.map(|x| x[2437..5637].to_vec()));
    }
    let report = done(&raw, &ProcessingOptions::default()).report;
    // eight periods of 400 samples in wind
    assert_eq!(report.runs[0].segments[0].plateau.periods, 7);
    let said = report.warnings();
    assert!(
        said.iter()
            .any(|w| w.contains("still air covers samples 37 to 3200")),
        "{said:?}"
    );
}

#[test]
fn channels_of_the_wrong_sign_or_place_are_named() {
    let made = campaign(&short(VirtualCampaignPlan::default()));
    let with = |change: &dyn Fn(&mut RawCampaign)| {
        let mut raw = made.raw.clone();
        change(&mut raw);
        refused(&raw)
    };
    fn both(raw: &mut RawCampaign, change: impl Fn(&mut super::super::RawRecording)) {
        for run in &mut raw.runs {
            change(&mut run.in_wind);
            change(run.still_air.as_mut().unwrap());
        }
    }
    // x of the near cell points up: the lift of one cell turned round
    let message = with(&|raw| both(raw, |r| r.cells[1][0].iter_mut().for_each(|x| *x = -*x)));
    assert!(
        message.contains("still air, cell far: expected a vertical force in antiphase"),
        "{message}"
    );
    // the moment of one cell turned round
    let message = with(&|raw| both(raw, |r| r.cells[1][5].iter_mut().for_each(|x| *x = -*x)));
    assert!(
        message.contains("still air, cell far: expected a torsion force in antiphase"),
        "{message}"
    );
    // all of it
    let message = with(&|raw| {
        both(raw, |r| {
            for cell in &mut r.cells {
                cell[0].iter_mut().for_each(|x| *x = -*x);
            }
        });
    });
    assert!(
        message.contains("sum of the cells: expected a vertical force in antiphase"),
        "{message}"
    );
    assert!(message.contains("is reversed"), "{message}");
    // lift and drag exchanged
    let message = with(&|raw| {
        both(raw, |r| {
            for cell in &mut r.cells {
                cell.swap(0, 1);
            }
        });
    });
    assert!(message.contains("exchanged"), "{message}");
    // the motion of the turning run measured nose-down
    let message = with(&|raw| both(raw, |r| r.motion[2].iter_mut().for_each(|x| *x = -*x)));
    assert!(message.contains("torsion force in antiphase"), "{message}");
}

#[test]
fn bad_recordings_name_run_channel_and_sample() {
    let made = campaign(&short(VirtualCampaignPlan::default()));
    let with = |change: &dyn Fn(&mut RawCampaign)| {
        let mut raw = made.raw.clone();
        change(&mut raw);
        refused(&raw)
    };
    let message = with(&|raw| raw.runs[1].in_wind.cells[0][3][812] = f64::NAN);
    assert_eq!(
        message,
        "run plate-torsion-8.00, in wind, cell near, mx, sample 812: expected a finite number, found NaN"
    );
    let message = with(&|raw| raw.runs[0].mean_speed_m_s = 0.0);
    assert!(
        message.contains("run plate-vertical-8.00, mean wind speed: expected a positive number")
    );
    let message = with(&|raw| raw.runs[0].still_air.as_mut().unwrap().sampling_hz = 250.0);
    assert!(
        message.contains("still air: expected the sampling frequency of the recording in wind")
    );
    let message = with(&|raw| {
        let x = &mut raw.runs[0].in_wind.cells[0][0];
        let limit = 0.7 * x.iter().fold(f64::MIN, |m, v| m.max(*v))
            + 0.3 * x.iter().sum::<f64>() / x.len() as f64;
        x.iter_mut().for_each(|v| *v = v.min(limit));
    });
    assert!(message.contains("cell near, fx, sample "), "{message}");
    assert!(
        message.contains("a channel that is not clipped"),
        "{message}"
    );
    let mut options = ProcessingOptions::default();
    options.low_pass.cutoff_hz = Some(120.0);
    let message = process(&made.raw, &options, &|_, _| {})
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("below the Nyquist frequency, 100 Hz at 200 Hz"),
        "{message}"
    );
    let message = with(&|raw| raw.runs.clear());
    assert!(message.contains("at least one run"));
}

/// A knock that drives a channel to its limit for a moment is replaced and said.
#[test]
fn a_short_clip_is_replaced() {
    let mut plan = short(VirtualCampaignPlan::realistic());
    let spike = plan.disturbances.spike.as_mut().unwrap();
    // far above the inertia of the fastest motion, so that only the knock is cut off
    (spike.height, spike.duration_s) = (40.0, 0.2);
    let mut made = campaign(&plan);
    for cell in &mut made.raw.runs[0].in_wind.cells {
        let high = cell[0].iter().fold(f64::MIN, |m, v| m.max(*v));
        let low = cell[0].iter().fold(f64::MAX, |m, v| m.min(*v));
        let limit = high - 0.2 * (high - low);
        cell[0].iter_mut().for_each(|v| *v = v.min(limit));
    }
    let processed = done(&made.raw, &ProcessingOptions::default());
    let run = &processed.report.runs[0];
    assert!(!run.clipped.is_empty());
    assert!(
        run.replaced.iter().any(|r| r.reason == "clipped"),
        "{:?}",
        run.replaced
    );
    let warnings = processed.report.warnings();
    let of_clipping = warnings
        .iter()
        .filter(|w| w.contains("limit of") || w.contains("clipped"));
    let said: Vec<_> = of_clipping.collect();
    let once = |cell: &str| format!("run {}: in wind, cell {cell}, fx: ", run.run);
    assert!(
        said.len() == 2 && said[0].starts_with(&once("near")) && said[1].starts_with(&once("far")),
        "{said:?}"
    );
    assert!(worst(&processed, &made.records, 0) < 0.05);
}
