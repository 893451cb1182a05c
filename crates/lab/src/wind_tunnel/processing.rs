//! From raw runs to records: what a laboratory does between the load cells and the derivatives (thesis, section 3.3).
//!
//! The measured force is `F_tot = F_E + F_G + F_I + F_B + F_Se + F_S` (3.1). In this order, each a function of its own file:
//!
//! 1. `prepare`: lengths, rates, finite numbers, clipping;
//! 2. [`segmentation`]: the test points, from the motion;
//! 3. [`lag`]: force channels behind the motion, from the inertia in still air, and the sign of that inertia;
//! 4. [`drift`] of the cells, in their own axes;
//! 5. [`still_air`] in step with wind;
//! 6. [`cells`]: global axes, about the centre of rotation, summed: clamping `F_E` is gone;
//! 7. [`rest`]: means before the motion: gravity `F_G` and static wind `F_S` are gone;
//! 8. [`still_air`] subtracted: inertia `F_I` and the turning part of gravity are gone;
//! 9. [`spikes`] and drift, by the [`coherent`] regression;
//! 10. [`low_pass`]: noise and buffeting `F_B` above the cut-off are gone, `F_Se` is left;
//! 11. [`rest`] again: what is no motion is set to zero;
//! 12. records per unit length.

mod body;
pub mod cells;
pub mod coherent;
pub mod drift;
pub mod lag;
pub mod low_pass;
mod mass_matrix;
mod options;
mod prepare;
mod report;
pub mod rest;
mod run;
pub mod segmentation;
mod signals;
pub mod spikes;
pub mod still_air;

pub use options::{LowPassOptions, ProcessingOptions, Ramps, SegmentOptions, SpikeOptions};
pub use report::{
    DimensionlessFactors, ProcessingReport, RemovedDrift, RunReport, SignalToNoise, StageLevels,
};
pub use signals::{HarmonicSegment, SectionSignals, index};

use super::{RawCampaign, Record};
use crate::error::{Error, Result, ensure};
use crate::section::Dof;
use prepare::PreparedRun;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Records of a campaign, what was done to get them, and the forces stage by stage.
#[derive(Debug, Clone, PartialEq)]
pub struct Processed {
    /// Self-excited forces, in the order of the runs.
    pub records: Vec<Record>,
    /// What was done.
    pub report: ProcessingReport,
    /// Signals after each stage of [`RunReport::levels`], one list per run, for figures.
    pub stages: Vec<Vec<SectionSignals>>,
}

/// Processes every run of a campaign; `progress` is called with how many runs are done, and how many there are.
///
/// # Errors
/// [`Error::Input`] naming run, recording, channel and sample for what cannot be processed; of several runs all, in their
/// order.
pub fn process(
    campaign: &RawCampaign,
    options: &ProcessingOptions,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Processed> {
    options.validate()?;
    campaign.rig.validate()?;
    let any = !campaign.runs.is_empty();
    ensure(any, "campaign", "at least one run", "none")?;
    let prepared = campaign.runs.par_iter();
    let prepared = prepared.map(|run| PreparedRun::new(run, &campaign.rig, options));
    let mut prepared = all_or_errors(prepared.collect())?;
    let mut judged = Vec::new();
    for dof in Dof::THREE {
        let of_dof = prepared.iter_mut().filter(|p| p.report.dof == dof);
        let mut of_dof: Vec<_> = of_dof.collect();
        judged.extend(prepare::judge_still_air(dof, &campaign.rig, &mut of_dof));
    }
    all_or_errors(judged)?;
    mass_matrix::judge(&campaign.rig, &mut prepared);
    let stated = options.dofs.clone();
    let dofs = stated.unwrap_or_else(|| dofs_of(campaign, &prepared));
    let (lag_s, lag_standard_error_s) = prepare::common_lag(&mut prepared, options);
    let done = AtomicUsize::new(0);
    let process = |p: PreparedRun<'_>| {
        let run = run::process_run(p, campaign, &dofs, lag_s, options)?;
        let done = 1 + done.fetch_add(1, Ordering::Relaxed);
        progress(done, campaign.runs.len());
        Ok(run)
    };
    let processed = prepared.into_par_iter().map(process).collect();
    let (mut records, mut runs, mut stages) = (Vec::new(), Vec::new(), Vec::new());
    for (of_run, run, after_stages) in all_or_errors(processed)? {
        records.extend(of_run);
        runs.push(run);
        stages.push(after_stages);
    }
    let deltas = runs.iter().map(|run: &RunReport| run.dimensionless.delta_s);
    let report = ProcessingReport {
        section: campaign.section.clone(),
        options: options.clone(),
        lag_s,
        lag_standard_error_s,
        common_delta_s: deltas.fold(0.0, f64::max),
        runs,
    };
    Ok(Processed {
        records,
        report,
        stages,
    })
}

/// Heave and rotation, and sway when a run moves it; of these the forces that there are.
fn dofs_of(campaign: &RawCampaign, prepared: &[PreparedRun<'_>]) -> Vec<Dof> {
    let all: &[Dof] = match prepared.iter().any(|p| p.report.dof == Dof::Lateral) {
        true => &Dof::THREE,
        false => &Dof::TWO,
    };
    let measured = |d: &&Dof| campaign.forces.as_ref().is_none_or(|f| f.contains(d));
    all.iter().filter(measured).copied().collect()
}

/// All values, or all errors in their order: what is computed in parallel must not report whichever failed first.
pub(super) fn all_or_errors<T>(results: Vec<Result<T>>) -> Result<Vec<T>> {
    let (mut values, mut errors) = (Vec::with_capacity(results.len()), Vec::new());
    for result in results {
        match result {
            Ok(value) => values.push(value),
            Err(error) => errors.push(error),
        }
    }
    match errors.len() {
        0 => Ok(values),
        1 => Err(errors.remove(0)),
        _ => Err(Error::Several(errors)),
    }
}

#[cfg(test)]
mod tests;
