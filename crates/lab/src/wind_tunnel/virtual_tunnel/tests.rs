//! The records against closed forms, an integration in time, and each other.

use super::super::tunnel_plan::ramped_sine;
use super::*;
use crate::aerodynamics::derivatives::{Derivative, Part};
use crate::aerodynamics::{RationalModel, Realizable, Realization};
use crate::files::derivatives::{TABLE_3_2_FREQUENCIES_HZ, embedded};
use crate::units::ReducedFrequency;
use nalgebra::{Complex, DMatrix, DVector};

/// Real and imaginary part of force `i` over motion `j` in the second half of the steady part of a segment, both
/// dimensionless: least squares on sine and cosine.
fn measured(record: &Record, i: usize, j: usize, segment: usize) -> Complex<f64> {
    let header = &record.header;
    let s = header.segments[segment];
    let omega = TAU * s.frequency_hz;
    let middle = 0.5 * (s.start_s + s.end_s);
    let first = (middle * header.sampling_hz).ceil() as usize;
    let last = ((s.end_s - 4.0) * header.sampling_hz) as usize;
    let basis = DMatrix::from_fn(last - first, 2, |r, c| {
        let phase = omega * ((first + r) as f64 / header.sampling_hz - s.start_s);
        if c == 0 { phase.sin() } else { phase.cos() }
    });
    let phasor = |samples: &[f64]| {
        let x = basis
            .clone()
            .svd(true, true)
            .solve(&DVector::from_column_slice(&samples[first..last]), 0.0);
        let x = x.unwrap();
        Complex::new(x[0], x[1])
    };
    let pressure = 0.5 * header.air_density_kg_m3 * header.mean_speed_m_s.powi(2);
    let force = phasor(&record.force[i]) / (pressure * header.dofs[i].force_scale(header.width_m));
    let motion = phasor(&record.motion[j]) * header.dofs[j].motion_scale(header.width_m);
    force / motion
}

#[test]
fn the_default_plan_is_table_3_2() {
    let plan = TunnelPlan::default();
    let table = embedded::deck("LN21-5200").unwrap();
    let records = plan.records_from_table(&table, &Dof::THREE).unwrap();
    assert_eq!(records.len(), 6);
    let peak = |x: &[f64]| x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let amplitudes = [0.010, 0.020, 1_f64.to_radians()];
    for (i, record) in records.iter().enumerate() {
        let moving = i % 3;
        assert!(
            record
                .motion
                .iter()
                .chain(&record.force)
                .all(|c| c.len() == 43_200)
        );
        for (j, channel) in record.motion.iter().enumerate() {
            if j == moving {
                // The highest frequency has 80 samples per period: the peak is met to 1 − cos(π/80).
                assert!((peak(channel) / amplitudes[j] - 1.0).abs() < 1e-3);
            } else {
                assert_eq!(peak(channel), 0.0);
            }
        }
        assert!(record.force.iter().all(|f| peak(&f[..1600]) == 0.0));
        assert_eq!(record.header.segments.len(), 8);
        assert!(record.header.licence.contains("juelpb"));
    }
    assert_eq!(records[0].header.name, "LN21-5200-vertical-8.18");
    assert_eq!(records[5].header.name, "LN21-5200-torsion-10.94");
}

#[test]
fn frequencies_from_a_table_are_within_a_per_cent_of_those_driven() {
    for name in embedded::names() {
        let table = embedded::deck(name).unwrap();
        for record in TunnelPlan::default()
            .records_from_table(&table, &Dof::TWO)
            .unwrap()
        {
            for (s, f) in record.header.segments.iter().zip(TABLE_3_2_FREQUENCIES_HZ) {
                assert!(
                    (s.frequency_hz / f - 1.0).abs() < 0.01,
                    "{name} {f}: {}",
                    s.frequency_hz
                );
            }
        }
    }
}

#[test]
fn the_records_of_a_table_hold_its_derivatives() {
    let table = embedded::deck("LN21-5200").unwrap();
    let records = TunnelPlan::default()
        .records_from_table(&table, &Dof::THREE)
        .unwrap();
    for (r, record) in records.iter().enumerate() {
        let (group, j) = (table.at_speed_group(r / 3).unwrap(), r % 3);
        let header = &record.header;
        for (segment, s) in header.segments.iter().enumerate() {
            let k =
                ReducedFrequency::from_hertz(s.frequency_hz, header.width_m, header.mean_speed_m_s);
            for (i, force) in Dof::THREE.into_iter().enumerate() {
                let g = measured(record, i, j, segment);
                for (part, found) in [(Part::Real, g.re), (Part::Imaginary, g.im)] {
                    let derivative = Derivative::from_entry(force, Dof::THREE[j], part);
                    let point = group.points(derivative)[segment];
                    assert!((k.v_hat() / point.v_hat - 1.0).abs() < 1e-12);
                    let found = found * point.v_hat * point.v_hat;
                    // Rounding of the phasors, relative to the larger part of the pair.
                    let tolerance = 1e-10 * g.norm() * point.v_hat * point.v_hat;
                    assert!(
                        (found - point.value).abs() < tolerance,
                        "{derivative}: {found} {}",
                        point.value
                    );
                }
            }
        }
    }
}

#[test]
fn the_steady_response_of_a_model_is_its_transfer_matrix() {
    let jones = RationalModel::jones_flat_plate();
    let records = TunnelPlan::default()
        .records_from_model(&jones, "Jones", 0.5)
        .unwrap();
    assert_eq!(records.len(), 4);
    for (r, record) in records.iter().enumerate() {
        for (segment, s) in record.header.segments.iter().enumerate() {
            let k = ReducedFrequency::from_hertz(s.frequency_hz, 0.5, record.header.mean_speed_m_s);
            let g = jones.transfer(k).unwrap();
            for i in 0..2 {
                let found = measured(record, i, r % 2, segment);
                // 13 s after the start the slow lag has e^(−0.091·4·13/0.5) = 8e-5 of the ramp's transient left.
                let error = (found - g[(i, r % 2)]).norm() / g[(i, r % 2)].norm();
                assert!(error < 1e-5, "{i} {r} {segment}: {error}");
            }
        }
    }
}

#[test]
fn table_and_model_give_the_same_steady_forces() {
    let jones = RationalModel::jones_flat_plate();
    let plan = TunnelPlan::default();
    let table = crate::aerodynamics::derivatives::DerivativeTable::sampled(
        "Jones",
        &jones,
        0.5,
        &[4.0, 8.17],
        &plan.frequencies_hz,
    )
    .unwrap();
    let by_points = plan.records_from_table(&table, &Dof::TWO).unwrap();
    let plan = TunnelPlan {
        speeds_m_s: vec![4.0, 8.17],
        ..plan
    };
    let by_response = plan.records_from_model(&jones, "Jones", 0.5).unwrap();
    for (a, b) in by_points.iter().zip(&by_response) {
        assert_eq!(a.header.name, b.header.name);
        for (x, y) in a.force.iter().zip(&b.force) {
            let scale = y.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            let error_from_to = |from: usize, to: usize| {
                let pairs = x[from..to].iter().zip(&y[from..to]);
                pairs.fold(0.0_f64, |m, (x, y)| m.max((x - y).abs())) / scale
            };
            for segment in 0..8 {
                // The last five seconds before the ramp down.
                let end = 1600 + 5200 * (segment + 1) - 800;
                let error = error_from_to(end - 1000, end);
                assert!(error < 1e-5, "{}: {error}", a.header.name);
            }
        }
    }
}

/// Force of the Jones plate due to one motion by integration in time (Runge–Kutta, four stages): the second path
/// to the Fourier transform. Unit dimensionless motion; `h` is one sample.
fn integrated(jones: &RationalModel, j: usize, plan: &TunnelPlan, speed: f64) -> Vec<[f64; 2]> {
    let Realization::Continuous(c) = jones.realize() else {
        panic!("continuous")
    };
    let (scale, h) = (0.5 / speed, 1.0 / plan.sampling_hz);
    let motion = |t: f64| {
        let t = t - plan.still_s;
        let index = ((t / plan.segment_s).max(0.0) as usize).min(7);
        let omega = TAU * plan.frequencies_hz[index];
        let from_start = t - index as f64 * plan.segment_s;
        ramped_sine(from_start, omega, plan.segment_s, plan.ramp_s)
    };
    let rate = |x: &DVector<f64>, t: f64| (&c.a * x + c.b.column(j) * motion(t)[0]) / scale;
    let mut x = DVector::zeros(c.a.nrows());
    let mut forces = Vec::new();
    for i in 0..43_200 {
        let t = f64::from(i) * h;
        let [r, velocity, _] = motion(t);
        let acceleration = (motion(t + 1e-4)[1] - motion(t - 1e-4)[1]) / 2e-4;
        let q = &c.c * &x
            + c.e0.column(j) * r
            + c.e1.column(j) * (scale * velocity)
            + c.e2.column(j) * (scale * scale * acceleration);
        forces.push([q[0], q[1]]);
        let k1 = rate(&x, t);
        let k2 = rate(&(&x + &k1 * (h / 2.0)), t + h / 2.0);
        let k3 = rate(&(&x + &k2 * (h / 2.0)), t + h / 2.0);
        let k4 = rate(&(&x + &k3 * h), t + h);
        x += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0);
    }
    forces
}

#[test]
fn the_whole_response_is_that_of_an_integration_in_time() {
    let jones = RationalModel::jones_flat_plate();
    let plan = TunnelPlan {
        speeds_m_s: vec![8.17],
        ..TunnelPlan::default()
    };
    let records = plan.records_from_model(&jones, "Jones", 0.5).unwrap();
    let pressure = 0.5 * plan.air_density_kg_m3 * 8.17 * 8.17;
    for (j, record) in records.iter().enumerate() {
        let amplitude = [0.010 / 0.5, 1_f64.to_radians()][j];
        let expected = integrated(&jones, j, &plan, 8.17);
        for (i, force) in record.force.iter().enumerate() {
            let factor = pressure * [0.5, 0.25][i] * amplitude;
            let scale = force.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            for (sample, (f, e)) in force.iter().zip(&expected).enumerate() {
                // Runge–Kutta: (0.6·16·0.005)⁴/120 ≈ 5e-8; the difference quotient of the added mass: 4e-8.
                let error = (f - factor * e[i]).abs() / scale;
                assert!(
                    error < 1e-6,
                    "motion {j} force {i} sample {sample}: {error}"
                );
            }
        }
    }
}

#[test]
fn noise_has_the_stated_level_and_seed() {
    let clean = TunnelPlan {
        speeds_m_s: vec![8.17],
        ..TunnelPlan::default()
    };
    let noisy = TunnelPlan {
        noise_fraction: 0.05,
        seed: 7,
        ..clean.clone()
    };
    let make = |plan: &TunnelPlan| {
        plan.records_from_model(&RationalModel::jones_flat_plate(), "Jones", 0.5)
            .unwrap()
    };
    let (without, with) = (make(&clean), make(&noisy));
    assert_eq!(with, make(&noisy));
    assert_ne!(with, make(&TunnelPlan { seed: 8, ..noisy }));
    let mut drawn = Vec::new();
    for (a, b) in without.iter().zip(&with) {
        assert_eq!(a.motion, b.motion);
        for (x, y) in a.force.iter().zip(&b.force) {
            let noise: Vec<f64> = x.iter().zip(y).map(|(x, y)| y - x).collect();
            let n = noise.len() as f64;
            let power = noise.iter().map(|e| e * e).sum::<f64>();
            let ratio = (power / x.iter().map(|x| x * x).sum::<f64>()).sqrt();
            // Standard deviation of the estimate: 0.05/√(2n) = 1.7e-4.
            assert!((ratio - 0.05).abs() < 1e-3, "{ratio}");
            // White: correlation of neighbours and mean vanish to 1/√n = 0.005.
            let neighbours = noise.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / power;
            let mean = noise.iter().sum::<f64>() / n / (power / n).sqrt();
            assert!(neighbours.abs() < 0.02 && mean.abs() < 0.02);
            drawn.push(noise[0] / (power / n).sqrt());
        }
    }
    assert!(
        drawn.windows(2).all(|w| w[0] != w[1]),
        "every force has its own noise"
    );
}

#[test]
fn impossible_plans_are_refused() {
    let complaint = |change: fn(&mut TunnelPlan)| {
        let mut plan = TunnelPlan::default();
        change(&mut plan);
        plan.validate().unwrap_err().to_string()
    };
    assert_eq!(
        complaint(|p| p.frequencies_hz.clear()),
        "frequencies_hz: expected at least one number, found none"
    );
    assert_eq!(
        complaint(|p| p.speeds_m_s[1] = -4.0),
        "speeds_m_s: expected a positive number, found -4"
    );
    assert_eq!(
        complaint(|p| p.frequencies_hz[7] = 50.0),
        "frequencies_hz: expected at most a fifth of sampling_hz (40 Hz), found 50"
    );
    assert_eq!(
        complaint(|p| p.ramp_s = 14.0),
        "ramp_s: expected at most half of segment_s (26 s), found 14"
    );
    assert_eq!(
        complaint(|p| p.noise_fraction = -0.1),
        "noise_fraction: expected zero or a positive number, found -0.1"
    );
    let unknown = serde_json::from_str::<TunnelPlan>(r#"{"sampling": 100}"#).unwrap_err();
    assert!(unknown.to_string().contains("unknown field `sampling`"));
    let plan: TunnelPlan = serde_json::from_str(r#"{"seed": 3}"#).unwrap();
    assert_eq!(
        plan,
        TunnelPlan {
            seed: 3,
            ..TunnelPlan::default()
        }
    );
}

/// A table without mean speeds, and one whose derivatives have points of their own, give records that say what was
/// assumed; the dimensionless forces are those of the table.
#[test]
fn tables_without_speeds_or_common_points_say_what_was_assumed() {
    let records = |change: fn(&str) -> String| {
        let mut text = Vec::new();
        let deck = embedded::deck("LN21-5200").unwrap();
        crate::files::derivatives::write_csv(&deck, &mut text).unwrap();
        let text: String = std::str::from_utf8(&text)
            .unwrap()
            .lines()
            .map(change)
            .collect();
        let table = crate::files::derivatives::parse_csv(&text).unwrap();
        TunnelPlan::default()
            .records_from_table(&table, &Dof::TWO)
            .unwrap()
    };
    let made = records(|line| match line.split(',').collect::<Vec<_>>()[..] {
        // Without speeds all points are one series, which has to be monotone: the first speed only.
        [d, n, _, v, x] if n.parse().is_ok_and(|n: usize| n <= 8) => {
            format!("{d},{n},,{v},{x}\n")
        }
        [_, n, ..] if n.parse::<usize>().is_ok() => String::new(),
        _ => format!("{line}\n"),
    });
    assert_eq!(made.len(), 2);
    for record in &made {
        assert_eq!(record.header.mean_speed_m_s, 8.17);
        let source = &record.header.source;
        assert!(source.contains("no mean wind speeds"), "{source}");
        assert_eq!(record.header.segments.len(), 8);
    }
    let made = records(|line| match line.split(',').collect::<Vec<_>>()[..] {
        ["A1", "3", speed, _, x] => format!("A1,3,{speed},4.5,{x}\n"),
        _ => format!("{line}\n"),
    });
    let interpolated = |r: &&Record| r.header.source.contains("the others interpolated");
    // heave at the first speed alone is concerned
    assert_eq!(made.iter().filter(interpolated).count(), 1);
}
