//! Inertia in still air against the rig; exchanged channels; records that are too short; drift of cells.

use super::*;
use crate::error::Error;

fn made() -> VirtualCampaign {
    campaign(&short(VirtualCampaignPlan::default()))
}

fn everywhere(raw: &mut RawCampaign, change: impl Fn(&mut super::super::super::RawRecording)) {
    for run in &mut raw.runs {
        change(&mut run.in_wind);
        change(run.still_air.as_mut().unwrap());
    }
}

#[test]
fn a_stated_mass_is_compared_with_still_air() {
    let mut raw = made().raw;
    let mass = raw.rig.model_mass_kg.unwrap();
    // the virtual campaign: 2 kg/m on 2.68 m
    assert!((mass - 5.36).abs() < 1e-12);
    assert!(
        done(&raw, &ProcessingOptions::default())
            .report
            .warnings()
            .is_empty()
    );
    raw.rig.model_mass_kg = Some(1.1 * mass);
    let warnings = done(&raw, &ProcessingOptions::default()).report.doubts();
    assert!(
        warnings.len() == 1
            && warnings[0].contains("still air shows 5.36")
            && warnings[0].contains("`rig.model_mass_kg` states 5.89"),
        "{warnings:?}"
    );
    raw.rig.model_mass_kg = Some(2.0 * mass);
    let message = refused(&raw);
    assert!(
        message.contains("still air, vertical motion: expected about the 10.7200 kg")
            && message.contains("0.500"),
        "{message}"
    );
    raw.rig.model_mass_kg = None;
    raw.rig.model_inertia_kg_m2 = Some(1.0);
    let message = refused(&raw);
    assert!(
        message.contains(
            "torsion motion: expected about the 1.0000 kg·m² that `rig.model_inertia_kg_m2`"
        ),
        "{message}"
    );
}

/// Nothing is stated, but there is one model: a run in another unit cannot be of it.
#[test]
fn runs_of_one_model_show_one_inertia() {
    let mut plan = short(VirtualCampaignPlan::default());
    plan.tunnel.speeds_m_s = vec![6.0, 10.0];
    let mut raw = campaign(&plan).raw;
    (raw.rig.model_mass_kg, raw.rig.model_inertia_kg_m2) = (None, None);
    let of_last = |raw: &mut RawCampaign, factor: f64| {
        let run = raw.runs.last_mut().unwrap();
        for recording in [Some(&mut run.in_wind), run.still_air.as_mut()] {
            let cells = recording.unwrap().cells.iter_mut().flatten();
            cells.flatten().for_each(|x| *x *= factor);
        }
    };
    let quiet = done(&raw, &ProcessingOptions::default()).report.warnings();
    assert!(quiet.is_empty(), "{quiet:?}");
    of_last(&mut raw, 1.1);
    let warnings = done(&raw, &ProcessingOptions::default()).report.doubts();
    assert!(
        warnings.len() == 1 && warnings[0].contains("another inertia in torsion motion"),
        "{warnings:?}"
    );
    of_last(&mut raw, 1e-3);
    let message = refused(&raw);
    assert!(
        message.starts_with("runs, still air, torsion motion: expected the inertia of one model"),
        "{message}"
    );
}

/// Zeros pass for a model without mass.
#[test]
fn still_air_without_a_force_is_refused() {
    let mut raw = made().raw;
    for run in &mut raw.runs {
        let cells = run.still_air.as_mut().unwrap().cells.iter_mut();
        cells.flatten().for_each(|x| x.fill(0.0));
    }
    let message = refused(&raw);
    assert!(
        message.contains(
            "vertical motion: expected about the 5.3600 kg that `rig.model_mass_kg` states, found no force"
        ),
        "{message}"
    );
}

/// The lag is a property of the wiring: 15 ms more in one run are no scatter.
#[test]
fn a_run_of_another_lag_is_refused_unless_the_lag_is_stated() {
    let mut raw = made().raw;
    let late = |raw: &mut RawCampaign, samples: usize| {
        let run = raw.runs.last_mut().unwrap();
        for recording in [Some(&mut run.in_wind), run.still_air.as_mut()] {
            for x in recording.unwrap().cells.iter_mut().flatten() {
                x.rotate_right(samples);
                let first = x[samples];
                x[..samples].fill(first);
            }
        }
    };
    late(&mut raw, 3);
    let message = refused(&raw);
    assert!(message.contains("of phase off at 2.000 Hz"), "{message}");
    let stated = ProcessingOptions {
        lag_s: Some(0.0),
        ..ProcessingOptions::default()
    };
    let warnings = done(&raw, &stated).report.doubts();
    assert!(
        warnings
            .iter()
            .any(|w| w.contains("15.0") && w.contains("10.8°") && w.contains("wrong by as much")),
        "{warnings:?}"
    );
}

/// As when `near.fx` is mapped from the column of `near.fy`.
#[test]
fn a_channel_taken_twice_shows_in_the_mass() {
    let mut raw = made().raw;
    everywhere(&mut raw, |r| r.cells[0][0] = r.cells[0][1].clone());
    let message = refused(&raw);
    assert!(
        message.contains(
            "missing, taken twice, or in another unit, or the motion or the sampling rate is"
        ),
        "{message}"
    );
}

#[test]
fn exchanged_motions_show_in_the_inertia() {
    let mut raw = made().raw;
    raw.rig.model_mass_kg = None;
    raw.rig.model_inertia_kg_m2 = None;
    everywhere(&mut raw, |r| r.motion.swap(0, 2));
    let Err(Error::Several(errors)) = process(&raw, &ProcessingOptions::default(), &|_, _| {})
    else {
        panic!("both runs are wrong");
    };
    for error in errors {
        let message = error.to_string();
        assert!(message.contains("exchanged"), "{message}");
    }
}

/// Heave and rotation at 8 m/s, a run for each frequency; the centre of gravity is 1 cm below the axis. A damper of `damping` N·s/m
/// at the heaving model.
fn one_frequency_each(frequencies_hz: &[f64], damping: f64) -> RawCampaign {
    let of = |f: &f64| {
        let mut plan = short(VirtualCampaignPlan::default());
        plan.tunnel.frequencies_hz = vec![*f];
        let mut raw = campaign(&plan).raw;
        raw.runs
            .iter_mut()
            .for_each(|run| run.name += &format!(" {f} Hz"));
        raw
    };
    let mut all: Vec<_> = frequencies_hz.iter().map(of).collect();
    let mut raw = all.remove(0);
    raw.runs
        .extend(all.into_iter().flat_map(|other| other.runs));
    everywhere(&mut raw, |r| {
        let y = r.motion[0].clone();
        let rate = y.windows(3).map(|y| 0.5 * (y[2] - y[0]) * r.sampling_hz);
        let lift = r.cells[0][0][1..].iter_mut();
        lift.zip(rate)
            .for_each(|(lift, rate)| *lift -= damping * rate);
    });
    raw
}

/// The frequency of each file tells neither the weight from the inertia nor damping from a lag: all files together do.
#[test]
fn runs_of_one_frequency_each_are_judged_together() {
    // a damping force of 3 % of the inertia at 1.5 Hz
    let mut raw = one_frequency_each(
        &[0.5, 1.1, 2.0],
        0.03 * 5.36 * 2.0 * std::f64::consts::PI * 1.5,
    );
    for stated in [true, false] {
        if !stated {
            (raw.rig.model_mass_kg, raw.rig.model_inertia_kg_m2) = (None, None);
        }
        let report = done(&raw, &ProcessingOptions::default()).report;
        assert!(
            report.warnings().is_empty() && report.doubts().is_empty(),
            "{report:?}"
        );
        // the ramps in the steady part: 5e-6 s as with all frequencies in one file
        assert!(report.lag_s.abs() < 1e-5, "{}", report.lag_s);
        for run in &report.runs {
            let found = run.still_air.as_ref().unwrap();
            let truth = if run.dof == Dof::Torsion {
                0.040_232 * 2.68
            } else {
                5.36
            };
            assert!((found.inertia / truth - 1.0).abs() < 2e-3, "{found:?}");
        }
    }
    let run = raw.runs.last_mut().unwrap();
    for recording in [Some(&mut run.in_wind), run.still_air.as_mut()] {
        let cells = recording.unwrap().cells.iter_mut().flatten();
        cells.flatten().for_each(|x| *x *= 2.0);
    }
    assert!(refused(&raw).contains("the inertia of one model in all of them"));
}

/// Of one frequency in all, nothing is judged that it does not tell, and the lag has no error.
#[test]
fn one_frequency_alone_tells_no_lag_from_damping() {
    let raw = one_frequency_each(&[0.5], 0.3);
    let report = done(&raw, &ProcessingOptions::default()).report;
    let said = report.warnings();
    assert_eq!(report.lag_standard_error_s, None);
    assert!(
        said.iter().any(|w| w.contains("cannot tell a lag")
            && w.contains("were it damping, the lag would be 0")),
        "{said:?}"
    );
    assert!(
        said.iter().any(|w| w.contains("cannot tell the weight")),
        "{said:?}"
    );
    // by more than 2° of phase it is a doubt
    let damped = one_frequency_each(&[2.0], 7.0);
    let doubts = done(&damped, &ProcessingOptions::default()).report.doubts();
    assert!(
        doubts.iter().any(|d| d.contains("cannot tell a lag")),
        "{doubts:?}"
    );
    // what a rotation measured nose-down would show as well
    let low = one_frequency_each(&[0.25], 0.0);
    let doubts = done(&low, &ProcessingOptions::default()).report.doubts();
    assert!(
        doubts.iter().any(|d| d.contains("cannot tell the weight")),
        "{doubts:?}"
    );
}

#[test]
fn a_record_shorter_than_its_periods_is_refused() {
    let mut raw = made().raw;
    // 8 s of rest, ramps of 4 s and a first frequency of 0.5 Hz: 9 s end in the first period
    everywhere(&mut raw, |r| {
        let cells = r.cells.iter_mut().flatten();
        r.motion
            .iter_mut()
            .chain(cells)
            .for_each(|x| x.truncate(1800));
        r.wind_speed_m_s.truncate(1800);
    });
    let message = refused(&raw);
    assert!(
        message.contains("in wind: expected a record of at least 2 whole periods of the vertical motion, found 0 in 1800 samples (9.000 s)"),
        "{message}"
    );
}

/// Drift of a lift channel that turns with the model is a drag in step with the rotation.
#[test]
fn drift_is_removed_in_the_axes_of_the_cells() {
    let plan = |drift_n: f64| {
        let mut plan = short(VirtualCampaignPlan::default());
        plan.disturbances.drift_n = drift_n;
        plan
    };
    let drag = |drift_n: f64| {
        let made = campaign(&plan(drift_n));
        let options = ProcessingOptions {
            dofs: Some(Dof::THREE.to_vec()),
            ..ProcessingOptions::default()
        };
        let processed = done(&made.raw, &options);
        let torsion = processed
            .records
            .iter()
            .find(|r| r.header.name.contains("torsion"));
        torsion.unwrap().force[1]
            .iter()
            .fold(0.0_f64, |m, x| m.max(x.abs()))
    };
    // the flat plate has no drag: 10 N of drift on 1° are 0.17 N, 0.07 N/m of the 2.68 m; what is left is the degree of the polynomial
    let (without, with) = (drag(0.0), drag(10.0));
    assert!(without < 1e-3, "{without}");
    assert!(with < 5e-3, "{with}");
}

#[test]
fn without_still_air_the_forces_are_those_of_the_wind() {
    let made = made();
    let mut raw = made.raw.clone();
    for (run, truth) in raw.runs.iter_mut().zip(&made.records) {
        run.still_air = None;
        let length = raw.rig.model_length_m;
        let of = |row: usize, sign: f64| -> Vec<f64> {
            truth.force[row].iter().map(|f| sign * length * f).collect()
        };
        let zero = vec![0.0; truth.force[0].len()];
        run.in_wind.cells = vec![[
            zero.clone(),
            of(0, 1.0),
            zero.clone(),
            zero.clone(),
            zero.clone(),
            of(1, -1.0),
        ]];
    }
    raw.rig.cells.truncate(1);
    raw.rig.cells[0].axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    raw.rig.cells[0].position_m = [0.0; 3];
    raw.rig.cells[0].turns_with_model = false;
    let processed = done(&raw, &ProcessingOptions::default());
    for force in 0..2 {
        assert!(worst(&processed, &made.records, force) < 1e-3);
    }
    assert!(
        processed
            .report
            .runs
            .iter()
            .all(|r| r.alignment.is_none() && r.warnings.is_empty())
    );
    // forces that were not measured are not those of the records
    raw.forces = Some(vec![Dof::Vertical]);
    raw.runs.truncate(1);
    let processed = done(&raw, &ProcessingOptions::default());
    assert_eq!(processed.records[0].header.dofs, [Dof::Vertical]);
}

/// Cells stated 4 cm off gave moments, and by these an onset, that are wrong by a fifth; a sensor of rotation that feels heave likewise.
#[test]
fn still_air_shows_the_centre_of_mass_and_each_motion() {
    let doubts = |raw: &RawCampaign| done(raw, &ProcessingOptions::default()).report.doubts();
    let mut raw = made().raw;
    assert_eq!(doubts(&raw), [""; 0]);
    let mut off = raw.clone();
    off.rig
        .cells
        .iter_mut()
        .for_each(|c| c.position_m[0] += 0.04);
    let said = doubts(&off);
    assert!(
        said.len() == 1
            && said[0].contains("vertical-8.00: still air shows the centre of mass 44.0 mm (8.8 % of the width) downwind of the axis")
            && said[0].contains("rotation shows it 4.0 mm downwind of it: `position_m`"),
        "{said:?}"
    );
    // the runs of heave alone: what is stated tells, or that nothing is
    off.runs.truncate(1);
    assert!(doubts(&off)[0].contains("`rig.centre_of_mass_m` states 4.0 mm"));
    off.rig.centre_of_mass_m = None;
    assert!(doubts(&off)[0].contains("does not state it"));
    off.rig.centre_of_mass_m = Some([0.044, -0.01, 0.0]);
    assert_eq!(doubts(&off), [""; 0]);
    // by 13 % of the heave over the width
    let feel = |raw: &mut RawCampaign, run: usize, motion: usize, driven: usize, part: f64| {
        let run = &mut raw.runs[run];
        for r in [&mut run.in_wind, run.still_air.as_mut().unwrap()] {
            let own = r.motion[driven].clone();
            r.motion[motion]
                .iter_mut()
                .zip(own)
                .for_each(|(x, y)| *x += part * y);
        }
    };
    let mut heave = raw.clone();
    feel(&mut heave, 0, 2, 0, -0.26);
    let said = doubts(&heave);
    assert!(
        said.len() == 1
            && said[0].contains(
                "vertical-8.00: the torsion channel tells of 13 % of the vertical motion"
            ),
        "{said:?}"
    );
    // without a run of rotation nothing tells what such a motion adds to the moment
    heave.runs.truncate(1);
    let alone = done(&heave, &ProcessingOptions::default()).report;
    let body = alone.runs[0].still_air.as_ref().unwrap();
    assert!(body.centre_of_mass_m.is_none() && alone.doubts().is_empty());
    feel(&mut raw, 1, 0, 2, 0.08);
    let said = doubts(&raw);
    assert!(
        said.len() == 1
            && said[0]
                .contains("torsion-8.00: the vertical channel tells of 16 % of the torsion motion"),
        "{said:?}"
    );
}
