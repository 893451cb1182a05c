//! Derivatives of records whose transfer matrix is known.

use super::*;
use crate::aerodynamics::derivatives::{Derivative, Part};
use crate::aerodynamics::{RationalModel, Transfer};
use crate::files::derivatives::embedded;
use crate::section::Dof;
use crate::units::ReducedFrequency;
use crate::wind_tunnel::{Record, TunnelPlan};

fn sources(records: &[Record]) -> Vec<&dyn RecordSource> {
    records.iter().map(|r| r as &dyn RecordSource).collect()
}

fn part(d: Derivative, z: nalgebra::Complex<f64>) -> f64 {
    match d.part() {
        Part::Real => z.re,
        Part::Imaginary => z.im,
    }
}

#[test]
fn a_known_transfer_matrix_comes_back() {
    let plan = TunnelPlan {
        speeds_m_s: vec![8.0, 4.0],
        ..TunnelPlan::default()
    };
    let plate = RationalModel::jones_flat_plate();
    let records = plan.records_from_model(&plate, "plate", 0.5).unwrap();
    let found = identify_derivatives(&sources(&records), &DerivativeOptions::default()).unwrap();
    assert_eq!(found.estimates.len(), 8 * 16);
    let dof = |d| Dof::TWO.iter().position(|x| *x == d).unwrap();
    for e in &found.estimates {
        let k = ReducedFrequency::from_v_hat(e.v_hat);
        let g = plate.transfer(k).unwrap();
        let z = g[(dof(e.derivative.force()), dof(e.derivative.motion()))];
        let truth = part(e.derivative, z) * e.v_hat * e.v_hat;
        // the wake still remembers the ramp, and the top of the ramps is in the steady part: 1e-3 of the entry
        let size = z.norm() * e.v_hat * e.v_hat;
        assert!((e.value - truth).abs() < 2e-3 * size, "{e:?}: {truth}");
    }
    let table = found.table("plate", Default::default()).unwrap();
    assert_eq!(table.speed_groups().len(), 2);
    // run again at the speeds they state, tests are one point with their mean
    let twice = [&records[..], &records[..]].concat();
    let again = identify_derivatives(&sources(&twice), &DerivativeOptions::default()).unwrap();
    assert_eq!(again.estimates.len(), 2 * found.estimates.len());
    assert_eq!(again.points(), found.points());
    assert!(again.contradictions().is_empty());
    // another test of the same point with other forces is named with both runs
    let mut other = records.clone();
    other[0].header.name = "again".to_owned();
    let forces = other[0].force.iter_mut().flatten();
    forces.for_each(|x| *x *= 1.1);
    // no motion is set twice to the last bit
    let motion = other[0].motion.iter_mut().flatten().enumerate();
    motion.for_each(|(i, x)| *x *= 1.0 + 1e-6 * (i % 7) as f64);
    let both = [&records[..], &other[..1]].concat();
    let both = identify_derivatives(&sources(&both), &DerivativeOptions::default()).unwrap();
    let [said] = &both.contradictions()[..] else {
        panic!("{:?}", both.contradictions());
    };
    let names = [records[0].header.name.as_str(), "again"];
    assert!(names.iter().all(|name| said.contains(name)), "{said}");
    // the table says how far the section was turned
    let amplitude = table.header.rotation_amplitude_deg.unwrap();
    assert!(
        (amplitude - plan.torsion_amplitude_deg).abs() < 1e-3,
        "{amplitude}"
    );
}

/// Neighbours within 5 %, the ends are not: one group, whatever the order of the records, and a table.
#[test]
fn three_speeds_close_to_each_other_are_one_group() {
    let plan = TunnelPlan {
        speeds_m_s: vec![8.3, 8.62, 8.0],
        ..TunnelPlan::default()
    };
    let plate = RationalModel::jones_flat_plate();
    let records = plan.records_from_model(&plate, "plate", 0.5).unwrap();
    let found = identify_derivatives(&sources(&records), &DerivativeOptions::default()).unwrap();
    assert_eq!(found.estimates.len(), 8 * 24);
    let groups = found.speed_groups();
    assert_eq!(groups.len(), 1);
    for d in Derivative::ALL {
        let v_hat: Vec<f64> = found.each(d).map(|e| e.v_hat).collect();
        assert!(v_hat.windows(2).all(|w| w[1] < w[0]), "{d}: {v_hat:?}");
    }
    // each heave and its rotation are one test point
    for e in &found.estimates {
        assert!(
            e.run.ends_with(&format!("{:.2}", e.mean_speed_m_s)),
            "{e:?}"
        );
    }
    assert_eq!(
        found
            .table("plate", Default::default())
            .unwrap()
            .speed_groups()
            .len(),
        1
    );
}

#[test]
fn all_eighteen_come_back_from_the_records_of_a_table() {
    let table = embedded::deck("LN21-5200").unwrap();
    let records = TunnelPlan::default()
        .records_from_table(&table, &Dof::THREE)
        .unwrap();
    let found = identify_derivatives(&sources(&records), &DerivativeOptions::default()).unwrap();
    assert_eq!(found.estimates.len(), 18 * 16);
    for d in Derivative::ALL {
        let pair = |part| Derivative::from_entry(d.force(), d.motion(), part);
        let both = |i: usize| {
            let at = |p| table.points(pair(p))[i].value;
            at(Part::Real).hypot(at(Part::Imaginary))
        };
        for (i, (e, truth)) in found.each(d).zip(table.points(d)).enumerate() {
            // the records have the mean K of the derivatives of one motion and the mean speed of the group
            assert!((e.v_hat / truth.v_hat - 1.0).abs() < 0.02);
            let scale = (e.v_hat / truth.v_hat).powi(2);
            assert!(
                (e.value - truth.value * scale).abs() < 2e-3 * both(i) + 0.02 * both(i) * 2.0,
                "{d} {i}: {} {}",
                e.value,
                truth.value
            );
        }
    }
}

/// Scatter over seeds against the mean standard error: noise is white here, 5 % of each force.
#[test]
fn standard_errors_are_the_scatter() {
    let plate = RationalModel::jones_flat_plate();
    let mut sums = std::collections::BTreeMap::<(Derivative, usize), (f64, f64, f64)>::new();
    let seeds = 40;
    for seed in 0..seeds {
        let plan = TunnelPlan {
            speeds_m_s: vec![8.0],
            frequencies_hz: vec![0.5, 2.0],
            noise_fraction: 0.05,
            seed,
            ..TunnelPlan::default()
        };
        let records = plan.records_from_model(&plate, "plate", 0.5).unwrap();
        let found =
            identify_derivatives(&sources(&records), &DerivativeOptions::default()).unwrap();
        for d in found.dofs.clone().iter().flat_map(|f| {
            [Part::Real, Part::Imaginary].map(|p| Derivative::from_entry(*f, Dof::Vertical, p))
        }) {
            for (i, e) in found.each(d).enumerate() {
                let sum = sums.entry((d, i)).or_default();
                sum.0 += e.value;
                sum.1 += e.value * e.value;
                sum.2 += e.standard_error * e.standard_error;
            }
        }
    }
    let n = seeds as f64;
    let mut ratios = Vec::new();
    for (sum, square, stated) in sums.values() {
        let variance = (square - sum * sum / n) / (n - 1.0);
        ratios.push((variance / (stated / n)).sqrt());
    }
    // a standard deviation from 40 samples scatters by 11 %, and the mean of the eight by 4 %
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    assert!((mean - 1.0).abs() < 0.12, "{mean}: {ratios:?}");
    assert!(ratios.iter().all(|r| (0.65..1.4).contains(r)), "{ratios:?}");
}

#[test]
fn records_that_do_not_fit_together_are_refused() {
    let plan = TunnelPlan {
        speeds_m_s: vec![8.0],
        ..TunnelPlan::default()
    };
    let plate = RationalModel::jones_flat_plate();
    let mut records = plan.records_from_model(&plate, "plate", 0.5).unwrap();
    let message = |records: &[Record]| {
        identify_derivatives(&sources(records), &DerivativeOptions::default())
            .unwrap_err()
            .to_string()
    };
    assert!(message(&[]).contains("at least one"));
    records[1].header.width_m = 0.6;
    assert!(message(&records).contains("0.5 m, as in the first record"));
    records[1].header.width_m = 0.5;
    records[1].force[0][77] = f64::NAN;
    assert!(message(&records).contains("sample 77"));
    records[1].force.iter_mut().for_each(|f| f.fill(0.0));
    assert!(message(&records).contains("expected a force, found none"));
}

/// Heave with as much rotation at once says nothing of either; with a run of rotation it says all.
#[test]
fn motions_that_are_driven_at_once_need_a_run_of_one() {
    let plan = TunnelPlan {
        speeds_m_s: vec![8.0],
        ..TunnelPlan::default()
    };
    let plate = RationalModel::jones_flat_plate();
    let records = plan.records_from_model(&plate, "plate", 0.5).unwrap();
    let [heave, rotation] = &records[..] else {
        panic!("two runs");
    };
    let sum = |a: &[Vec<f64>], b: &[Vec<f64>]| -> Vec<Vec<f64>> {
        let of = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| a + b).collect();
        a.iter().zip(b).map(of).collect()
    };
    let mut both = heave.clone();
    both.header.name = "both".to_owned();
    both.motion = sum(&heave.motion, &rotation.motion);
    both.force = sum(&heave.force, &rotation.force);
    let alone = identify_derivatives(&[&both], &DerivativeOptions::default());
    let message = alone.unwrap_err().to_string();
    assert!(
        message.contains("run both at") && message.contains("are not told apart"),
        "{message}"
    );
    let each = identify_derivatives(&sources(&records), &DerivativeOptions::default()).unwrap();
    let joint = identify_derivatives(&[rotation, &both], &DerivativeOptions::default());
    let pairs = |d| {
        joint
            .as_ref()
            .unwrap()
            .each(d)
            .zip(each.each(d))
            .collect::<Vec<_>>()
    };
    for d in Derivative::ALL
        .into_iter()
        .filter(|d| d.motion() != Dof::Lateral)
    {
        for (joint, each) in pairs(d) {
            assert!(
                (joint.value / each.value - 1.0).abs() < 2e-2,
                "{joint:?} {each:?}"
            );
        }
    }
}

/// A record of pure tones, sampled from seldom to often: harmonics beyond half the sampling rate are not fitted.
#[test]
fn few_samples_in_a_period_do_not_spoil_the_derivatives() {
    let plan = TunnelPlan {
        speeds_m_s: vec![8.0],
        ..TunnelPlan::default()
    };
    let plate = RationalModel::jones_flat_plate();
    let mut record = plan
        .records_from_model(&plate, "plate", 0.5)
        .unwrap()
        .remove(0);
    let frequency_hz = 1.0;
    let mut found = |per_period: f64| {
        let phase = |k: u32| std::f64::consts::TAU * f64::from(k) / per_period + 0.4;
        let tone = |size: f64, turn: f64| -> Vec<f64> {
            (0..300).map(|k| size * (phase(k) + turn).sin()).collect()
        };
        record.header.sampling_hz = per_period * frequency_hz;
        record.header.segments = vec![crate::wind_tunnel::Segment {
            frequency_hz,
            start_s: 0.0,
            end_s: 300.0 / per_period,
        }];
        record.motion = vec![tone(0.01, 0.0), tone(0.0, 0.0)];
        record.force = vec![tone(2.0, 0.7), tone(0.5, -0.3)];
        identify_derivatives(&[&record], &DerivativeOptions::default())
    };
    let often = found(40.0).unwrap();
    assert!(often.warnings.is_empty(), "{:?}", often.warnings);
    for per_period in [4.0, 4.7, 5.0, 5.3, 6.0, 6.5, 7.0, 7.7] {
        let seldom = found(per_period).unwrap();
        assert!(seldom.warnings[0].contains("samples in a period"));
        for (a, b) in seldom.estimates.iter().zip(&often.estimates) {
            assert!(
                (a.value / b.value - 1.0).abs() < 1e-6,
                "{per_period}: {a:?} {b:?}"
            );
        }
    }
    let message = found(3.6).unwrap_err().to_string();
    assert!(
        message.contains("at least 4 samples in a period"),
        "{message}"
    );
}
