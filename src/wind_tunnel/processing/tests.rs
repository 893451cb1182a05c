//! Processing of virtual campaigns against their truth.

use super::*;
use crate::aerodynamics::FlatPlate;
use crate::wind_tunnel::virtual_campaign::{VirtualCampaign, VirtualCampaignPlan};

fn campaign(plan: &VirtualCampaignPlan) -> VirtualCampaign {
    plan.from_model(&FlatPlate::default(), "plate", 0.5).unwrap()
}

fn quiet() -> VirtualCampaignPlan {
    let mut plan = VirtualCampaignPlan::default();
    plan.tunnel.speeds_m_s = vec![8.0];
    plan.tunnel.frequencies_hz = vec![0.5, 1.1, 2.0];
    plan
}

/// Greatest difference over greatest force, records against truth.
fn worst(processed: &Processed, truth: &[crate::wind_tunnel::Record], force: usize) -> f64 {
    let mut worst = 0.0_f64;
    for (ours, truth) in processed.records.iter().zip(truth) {
        let size = truth.force[force].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for (a, b) in ours.force[force].iter().zip(&truth.force[force]) {
            worst = worst.max((a - b).abs() / size);
        }
    }
    worst
}

#[test]
fn a_campaign_without_disturbances_gives_the_truth_back() {
    let made = campaign(&quiet());
    let processed = process(&made.raw, &ProcessingOptions::default(), &|_| {}).unwrap();
    assert_eq!(processed.records.len(), 2);
    for r in &processed.report.runs {
        eprintln!("{:#?}", r);
    }
    for force in 0..2 {
        let w = worst(&processed, &made.truth.records, force);
        eprintln!("worst {force}: {w}");
        assert!(w < 1e-3, "{w}");
    }
}

#[test]
fn lag_offset_and_spike_are_found() {
    let mut plan = VirtualCampaignPlan::realistic();
    plan.tunnel.speeds_m_s = vec![8.0];
    let made = campaign(&plan);
    let processed = process(&made.raw, &ProcessingOptions::default(), &|_| {}).unwrap();
    let d = &plan.disturbances;
    let report = &processed.report;
    eprintln!("lag {} ± {:?}", report.lag_s, report.lag_standard_error_s);
    for (run, applied) in report.runs.iter().zip(&made.truth.disturbances) {
        eprintln!("{:#?} {:#?}", run.alignment, run.still_air);
        eprintln!("{:#?} {:#?}", run.replaced, applied);
        eprintln!("{:#?} {:#?}", run.drift, run.signal_to_noise);
        assert!((run.alignment.offset_s - d.still_air_offset_s).abs() < 1e-6);
    }
    for force in 0..2 {
        eprintln!("worst {force}: {}", worst(&processed, &made.truth.records, force));
    }
}
