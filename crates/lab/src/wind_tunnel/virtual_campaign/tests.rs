//! The recordings against mechanics written out by hand, and the disturbances against what they should be.

use super::*;
use crate::aerodynamics::{RationalModel, Transfer};
use crate::files::derivatives::embedded;
use crate::section::Dof;
use crate::units::ReducedFrequency;
use crate::wind_tunnel::{RawRecording, Rig};
use std::f64::consts::TAU;

/// Short runs at two frequencies.
fn short() -> VirtualCampaignPlan {
    let mut plan = VirtualCampaignPlan::default();
    plan.tunnel.frequencies_hz = vec![0.5, 2.0];
    plan.tunnel.speeds_m_s = vec![8.17];
    plan.tunnel.still_s = 2.0;
    plan.tunnel.segment_s = 8.0;
    plan.tunnel.ramp_s = 2.0;
    plan
}

fn on_jones(plan: &VirtualCampaignPlan) -> VirtualCampaign {
    let jones = RationalModel::jones_flat_plate();
    plan.from_model(&jones, "Jones", 0.5).unwrap()
}

/// Drag, lift and nose-up moment about the centre of rotation, one per sample: turned by the sine and cosine of the
/// rotation, moved by the lever arms in the plane, written out without matrices.
fn section_forces(rig: &Rig, recording: &RawRecording) -> [Vec<f64>; 3] {
    let mut sums = [(); 3].map(|()| vec![0.0; recording.sample_count()]);
    for (cell, channels) in rig.cells.iter().zip(&recording.cells) {
        for i in 0..recording.sample_count() {
            let local: Vec<f64> = channels.iter().map(|c| c[i]).collect();
            let angle = if cell.turns_with_model {
                recording.motion[2].get(i).copied().unwrap_or(0.0)
            } else {
                0.0
            };
            let (sin, cos) = angle.sin_cos();
            let row = |r: usize, v: &[f64]| (0..3).map(|c| cell.axes[r][c] * v[c]).sum::<f64>();
            let turned = |x: f64, y: f64| (cos * x + sin * y, cos * y - sin * x);
            let (fx, fy) = turned(row(0, &local[..3]), row(1, &local[..3]));
            let (px, py) = turned(cell.position_m[0], cell.position_m[1]);
            sums[0][i] += fx;
            sums[1][i] += fy;
            sums[2][i] -= row(2, &local[3..]) + px * fy - py * fx;
        }
    }
    sums
}

fn rms(x: &[f64]) -> f64 {
    (x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64).sqrt()
}

#[test]
fn in_wind_minus_still_air_is_static_and_self_excited_force() {
    let mut plan = short();
    for turns in [true, false] {
        plan.support.cells[0].turns_with_model = turns;
        let table = embedded::deck("LN21-5200").unwrap();
        let made = plan.from_table(&table, &Dof::THREE).unwrap();
        assert_eq!(made.raw.runs.len(), 6);
        assert!(made.raw.licence.contains("juelpb"));
        assert_eq!(made.raw.section, "LN21-5200");
        let length = plan.support.model_length_m;
        for ((run, truth), applied) in made
            .raw
            .runs
            .iter()
            .zip(&made.records)
            .zip(&made.disturbances)
        {
            let wind = section_forces(&made.raw.rig, &run.in_wind);
            let still = section_forces(&made.raw.rig, run.still_air.as_ref().unwrap());
            for (c, row) in [1, 0, 2].into_iter().enumerate() {
                assert!(applied.static_wind[c].abs() > 0.1);
                for i in 0..run.in_wind.sample_count() {
                    let expected = length * truth.force[row][i] + applied.static_wind[c];
                    let found = wind[c][i] - still[c][i];
                    // rounding of forces of about 60 N
                    assert!((found - expected).abs() < 1e-11, "{} {c} {i}", run.name);
                }
            }
            // cells that share unequally under clamping do not look alike
            let means: Vec<f64> = run.in_wind.cells.iter().map(|c| c[2][0]).collect();
            assert_eq!(means, [-12.0, -12.0]);
        }
    }
}

#[test]
fn still_air_is_gravity_and_inertia() {
    let plan = short();
    let made = on_jones(&plan);
    let (length, body) = (plan.support.model_length_m, &plan.model);
    let [cx, cy, _] = body.centre_of_gravity_m;
    let (m, g) = (body.mass_kg_m * length, body.gravity_m_s2);
    let about_pivot = (body.inertia_kg_m2_m + body.mass_kg_m * (cx * cx + cy * cy)) * length;
    let rate = 1.0 / plan.tunnel.sampling_hz;
    for run in &made.raw.runs {
        let [drag, lift, moment] = section_forces(&made.raw.rig, run.still_air.as_ref().unwrap());
        let second = |x: &[f64], i: usize| (x[i + 1] - 2.0 * x[i] + x[i - 1]) / (rate * rate);
        let [y, _, theta] = &run.still_air.as_ref().unwrap().motion;
        let half = |i: usize| 0.5 * theta[i];
        // position of the centre of gravity, from the turn by −θ about z
        let x_c: Vec<f64> = theta.iter().map(|t| cx * t.cos() + cy * t.sin()).collect();
        let y_c: Vec<f64> = (0..y.len())
            .map(|i| y[i] + cy * theta[i].cos() - 2.0 * cx * half(i).sin() * half(i).cos())
            .collect();
        for i in 1..y.len() - 1 {
            let expected = [
                -m * second(&x_c, i),
                -m * (second(&y_c, i) + g),
                m * x_c[i] * g - about_pivot * second(theta, i)
                    // heave accelerates the centre of gravity, which stands off by x_c
                    + m * x_c[i] * second(y, i),
            ];
            for (found, e) in [drag[i], lift[i], moment[i]].into_iter().zip(expected) {
                // second difference of 2 Hz at 200 Hz: (ωh)²/12 = 3.3e-4 of at most 8 N
                assert!((found - e).abs() < 4e-3, "{} {i}: {found} {e}", run.name);
            }
        }
    }
}

#[test]
fn noise_is_that_of_the_sum_about_the_centre_of_rotation() {
    let clean = short();
    let mut noisy = clean.clone();
    noisy.tunnel.noise_fraction = 0.05;
    let (without, with) = (on_jones(&clean), on_jones(&noisy));
    let length = clean.support.model_length_m;
    for (i, run) in with.raw.runs.iter().enumerate() {
        let truth = &with.records[i];
        for (a, b) in [
            (&run.in_wind, &without.raw.runs[i].in_wind),
            (
                run.still_air.as_ref().unwrap(),
                without.raw.runs[i].still_air.as_ref().unwrap(),
            ),
        ] {
            let (a, b) = (
                section_forces(&with.raw.rig, a),
                section_forces(&with.raw.rig, b),
            );
            for (c, row) in [(1, 0), (2, 1)] {
                let noise: Vec<f64> = a[c].iter().zip(&b[c]).map(|(a, b)| a - b).collect();
                let ratio = rms(&noise) / (length * rms(&truth.force[row]));
                // 3600 samples: 0.05/√7200 = 6e-4
                assert!((ratio - 0.05).abs() < 2.5e-3, "{ratio}");
                assert!((with.disturbances[i].noise[c] / rms(&noise) - 1.0).abs() < 0.05);
                let neighbours: f64 = noise.windows(2).map(|w| w[0] * w[1]).sum();
                // white: 1/√3600
                assert!((neighbours / (noise.len() as f64 * rms(&noise).powi(2))).abs() < 0.06);
            }
        }
        // nothing else differs
        assert_eq!(run.in_wind.motion, without.raw.runs[i].in_wind.motion);
    }
    assert_eq!(with, on_jones(&noisy));
    noisy.tunnel.seed += 1;
    assert_ne!(with, on_jones(&noisy));
}

/// Phase (rad) of `signal` at `frequency_hz` over the steady part of the second segment of [`short`].
fn phase(signal: &[f64], frequency_hz: f64) -> f64 {
    let (from, to) = (2500, 3100);
    let mean = signal[from..to].iter().sum::<f64>() / (to - from) as f64;
    let (mut re, mut im) = (0.0, 0.0);
    for (i, x) in signal.iter().enumerate().take(to).skip(from) {
        let (sin, cos) = (TAU * frequency_hz * i as f64 / 200.0).sin_cos();
        re += (x - mean) * cos;
        im -= (x - mean) * sin;
    }
    im.atan2(re)
}

#[test]
fn lag_and_offset_are_those_of_the_plan() {
    let mut plan = short();
    plan.disturbances.force_lag_s = 0.0017;
    plan.disturbances.still_air_offset_s = 0.0123;
    let (made, plain) = (on_jones(&plan), on_jones(&short()));
    let lateness = |late: &[f64], early: &[f64]| {
        let difference = (phase(early, 2.0) - phase(late, 2.0)).rem_euclid(TAU);
        difference / (TAU * 2.0)
    };
    let (run, plain) = (&made.raw.runs[0], &plain.raw.runs[0]);
    let y = |r: &RawRecording| r.motion[0].clone();
    // six periods of a steady sine: rounding only
    assert!(
        (lateness(&y(run.still_air.as_ref().unwrap()), &y(&run.in_wind)) - 0.0123).abs() < 1e-9
    );
    assert_eq!(y(&run.in_wind), y(&plain.in_wind));
    let lift = |r: &RawRecording| section_forces(&made.raw.rig, r)[1].clone();
    let still = lateness(
        &lift(run.still_air.as_ref().unwrap()),
        &lift(plain.still_air.as_ref().unwrap()),
    );
    assert!((still - 0.0140).abs() < 1e-9, "{still}");
    // the flow remembers the start, which fades as e^(−0.091·4·t V/B): 1e-5 of the force after 2 s
    let wind = lateness(&lift(&run.in_wind), &lift(&plain.in_wind));
    assert!((wind - 0.0017).abs() < 1e-6, "{wind}");
    // what the truth says is not late
    assert_eq!(made.records, on_jones(&short()).records);
}

#[test]
fn gusts_have_their_intensity_and_length_and_push_as_the_slopes_say() {
    let mut plan = short();
    plan.tunnel.segment_s = 100.0;
    plan.turbulence = Some(TunnelTurbulence {
        intensity_u: 0.05,
        intensity_w: 0.03,
        length_m: 0.4,
    });
    let mut laminar = plan.clone();
    laminar.turbulence = None;
    let (made, without) = (on_jones(&plan), on_jones(&laminar));
    let run = &made.raw.runs[0];
    let u: Vec<f64> = run
        .in_wind
        .wind_speed_m_s
        .iter()
        .map(|v| v / 8.17 - 1.0)
        .collect();
    // 202 s hold about 200·8.17/0.8 = 2000 independent values: 1/√4000 = 1.6 %
    assert!((rms(&u) / 0.05 - 1.0).abs() < 0.06, "{}", rms(&u));
    let apart = |lag: usize| {
        let sum: f64 = u.iter().zip(&u[lag..]).map(|(a, b)| a * b).sum();
        sum / (u.len() - lag) as f64 / 0.0025
    };
    // e^(−V τ/length) at τ = 0.05 s
    let expected = (-8.17_f64 * 0.05 / 0.4).exp();
    assert!((apart(10) - expected).abs() < 0.06, "{}", apart(10));
    let buffeting = |c: usize| -> Vec<f64> {
        let of = |r: &RawRecording| section_forces(&made.raw.rig, r)[c].clone();
        let (a, b) = (of(&run.in_wind), of(&without.raw.runs[0].in_wind));
        a.iter().zip(&b).map(|(a, b)| a - b).collect()
    };
    let area = 0.5 * 1.19 * 8.17 * 8.17 * 0.5 * 2.68;
    // lift: 2 C_L u + (C_L' + C_D) w, independent of each other
    let expected = area * (2.0 * 0.12 * 0.05_f64).hypot(4.48 * 0.03);
    assert!((rms(&buffeting(1)) / expected - 1.0).abs() < 0.06);
    let expected = area * 0.5 * (2.0 * 0.02 * 0.05_f64).hypot(1.1 * 0.03);
    assert!((rms(&buffeting(2)) / expected - 1.0).abs() < 0.06);
    assert_eq!(run.still_air, without.raw.runs[0].still_air);
}

#[test]
fn spike_and_drift_stand_where_the_truth_says() {
    let mut plan = short();
    plan.disturbances.spike = VirtualCampaignPlan::realistic().disturbances.spike;
    let (made, plain) = (on_jones(&plan), on_jones(&short()));
    for (i, run) in made.raw.runs.iter().enumerate() {
        let of = |r| section_forces(&made.raw.rig, r)[1].clone();
        let (a, b) = (of(&run.in_wind), of(&plain.raw.runs[i].in_wind));
        let differing: Vec<usize> = (0..a.len())
            .filter(|k| (a[*k] - b[*k]).abs() > 1e-9)
            .collect();
        let spike = made.disturbances[i].spike.unwrap();
        // 0.06 s at 200 Hz about the middle of the first segment, 6 s
        assert_eq!((spike.first, spike.samples), (1194, 13));
        assert_eq!(differing, (1194..1207).collect::<Vec<_>>());
        let top = 1200;
        assert!(((a[top] - b[top]) / spike.height[1] - 1.0).abs() < 1e-9);
        let lift = &made.records[i].force[0][400..2000];
        let largest = lift.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        assert!((spike.height[1] / (4.0 * 2.68 * largest) - 1.0).abs() < 1e-12);
        assert_eq!(run.still_air, plain.raw.runs[i].still_air);
    }
    let mut plan = short();
    plan.disturbances.drift_n = 0.3;
    let made = on_jones(&plan);
    let mut largest = 0.0_f64;
    for (run, plain) in made.raw.runs.iter().zip(&plain.raw.runs) {
        for (a, b) in run.in_wind.cells.iter().zip(&plain.in_wind.cells) {
            assert_eq!(a[3..], b[3..]);
            for (a, b) in a[..3].iter().zip(&b[..3]) {
                let drift: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
                // slow: no step above that of rise and half wave, (0.3 + 0.15 π)/3600
                assert!(drift.windows(2).all(|w| (w[1] - w[0]).abs() < 2.2e-4));
                largest = drift.iter().fold(largest, |m, x| m.max(x.abs()));
            }
        }
    }
    assert!(largest > 0.1 && largest < 0.45, "{largest}");
}

#[test]
fn the_truth_holds_the_transfer_matrix() {
    let plan = VirtualCampaignPlan::realistic();
    let table = embedded::deck("LN21-5200").unwrap();
    let made = plan.from_table(&table, &Dof::TWO).unwrap();
    // two motions, two speeds, eight frequencies, two forces
    assert_eq!(made.points.len(), 64);
    for point in &made.points {
        let samples = table.samples(&Dof::TWO);
        let of_entry = samples
            .iter()
            .filter(|s| s.force == point.force && s.motion == point.motion);
        let nearest = |part| {
            of_entry
                .clone()
                .filter(|s| s.part == part)
                .min_by(|a, b| {
                    let off = |k: ReducedFrequency| (k.full_width() - point.k).abs();
                    off(a.k).total_cmp(&off(b.k))
                })
                .unwrap()
                .value
        };
        use crate::aerodynamics::derivatives::Part;
        // the points of a column agree in K to rounding of the workbook only
        assert!((nearest(Part::Real) / point.real - 1.0).abs() < 1e-9);
        assert!((nearest(Part::Imaginary) / point.imaginary - 1.0).abs() < 1e-9);
    }
    let jones = RationalModel::jones_flat_plate();
    let made = plan.from_model(&jones, "Jones", 0.5).unwrap();
    assert_eq!(made.points.len(), 64);
    let p = &made.points[1];
    let k = TAU * 0.25 * 0.5 / 8.17;
    assert!((p.k - k).abs() < 1e-15 && p.run == "Jones-vertical-8.17");
    assert_eq!((p.force, p.motion), (Dof::Torsion, Dof::Vertical));
    let g = jones
        .transfer(ReducedFrequency::from_full_width(p.k))
        .unwrap();
    assert_eq!((g[(1, 0)].re, g[(1, 0)].im), (p.real, p.imaginary));
}

#[test]
fn plans_are_checked_and_survive_a_file() {
    let plan = VirtualCampaignPlan {
        turbulence: Some(TunnelTurbulence {
            intensity_u: 0.1,
            intensity_w: 0.05,
            length_m: 0.3,
        }),
        ..VirtualCampaignPlan::realistic()
    };
    let text = toml::to_string(&plan).unwrap();
    assert_eq!(toml::from_str::<VirtualCampaignPlan>(&text).unwrap(), plan);
    let complaint = |change: fn(&mut VirtualCampaignPlan)| {
        let mut plan = VirtualCampaignPlan::default();
        change(&mut plan);
        plan.validate().unwrap_err().to_string()
    };
    assert_eq!(
        complaint(|p| p.support.cells.truncate(1)),
        "support.cells: expected two load cells, found 1"
    );
    assert_eq!(
        complaint(|p| p.model.mass_kg_m = -1.0),
        "model.mass_kg_m: expected zero or a positive number, found -1"
    );
    assert_eq!(
        complaint(|p| p.disturbances.force_lag_s = 3.0),
        "disturbances.force_lag_s: expected at most half of tunnel.still_s and tunnel.ramp_s (2 s), found 3"
    );
    assert_eq!(
        complaint(|p| p.static_wind.lift = f64::NAN),
        "static_wind: expected finite numbers, found NaN"
    );
}
