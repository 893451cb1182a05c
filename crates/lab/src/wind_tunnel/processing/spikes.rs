//! Spikes: what neither follows the motion nor drifts nor is noise.
//!
//! The residual of the [coherent regression](super::coherent) is looked at twice, as it is and behind the low-pass, where a knock
//! that is low but long stands out of the noise. A sample is an outlier when it exceeds so many robust standard deviations of its
//! segment and a part of the greatest force there. Outliers are removed from the regression, which is repeated until none is added.
//! A knock meets all forces, so an outlier in one is replaced in all, with a guard before and after: by what follows the motion
//! and drifts, so that the filters do not ring.

use super::coherent::{Parts, Regressors};
use super::options::SpikeOptions;
use super::signals::SectionSignals;
use crate::error::Result;
use crate::section::Dof;
use crate::signal::{ButterworthLowPass, largest_magnitude, robust_deviation};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Rounds of regression at most.
const ROUNDS: usize = 8;

/// Nothing below this part of the greatest force that follows the motion is a spike: a force that hardly exists (drag of a
/// heaving model) has residuals of second order only, and no noise to measure them by. The moment counts over the width.
const NEGLIGIBLE: f64 = 1e-2;

/// Why a sample at the limit of its channel is replaced.
pub(super) const CLIPPED: &str = "clipped";

/// A stretch of samples that was replaced.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Replaced {
    /// First sample.
    pub first: usize,
    /// Number of samples, guard included.
    pub samples: usize,
    /// The same place in seconds from the start of the recording.
    pub start_s: f64,
    /// Why.
    pub reason: String,
    /// Greatest residual in the stretch: N, N, N·m.
    pub peak: [f64; 3],
}

/// Finds outliers and replaces them in `signals`, of which `clipped` are known: the parts of each force, and what was replaced.
pub(crate) fn remove_spikes(
    signals: &mut SectionSignals,
    regressors: &Regressors,
    filter: Option<&ButterworthLowPass>,
    options: &SpikeOptions,
    width_m: f64,
    clipped: &[Range<usize>],
) -> Result<([Parts; 3], Vec<Replaced>)> {
    let count = signals.len();
    let guard = (options.guard_s * signals.sampling_hz).round() as usize;
    let edge = filter.map_or(0, ButterworthLowPass::padding);
    let mut reasons = vec![None; count];
    for range in clipped {
        mark(&mut reasons, range.start, range.end, guard, CLIPPED);
    }
    let mut parts = fit_all(signals, regressors, &reasons)?;
    for _ in 0..ROUNDS {
        let mut added = false;
        let scale = |d: usize| Dof::THREE[d].force_scale(width_m) / width_m;
        let size = |d: usize| largest_magnitude(&parts[d].coherent) / scale(d);
        let greatest = (0..parts.len()).map(size).fold(0.0, f64::max);
        for (d, part) in parts.iter().enumerate() {
            let least = NEGLIGIBLE * greatest * scale(d);
            let residual = residual(&signals.force[d], part, &reasons);
            let mut views = vec![residual.clone()];
            if let Some(filter) = filter.filter(|f| count > f.padding()) {
                views.push(filter.zero_phase(&residual)?);
            }
            for view in &views {
                for k in outliers(view, part, regressors, options, least) {
                    // a filter makes up what was before and after, and bends a motion that begins there
                    let inside = (edge..count.saturating_sub(edge)).contains(&k);
                    if inside && reasons[k].is_none() {
                        mark(&mut reasons, k, k + 1, guard, "spike");
                        added = true;
                    }
                }
            }
        }
        if !added {
            break;
        }
        parts = fit_all(signals, regressors, &reasons)?;
    }
    let replaced = replace(signals, &parts, &reasons);
    Ok((parts, replaced))
}

fn mark(
    reasons: &mut [Option<&'static str>],
    from: usize,
    to: usize,
    guard: usize,
    why: &'static str,
) {
    let end = (to + guard).min(reasons.len());
    for reason in &mut reasons[from.saturating_sub(guard)..end] {
        reason.get_or_insert(why);
    }
}

fn fit_all(
    signals: &SectionSignals,
    regressors: &Regressors,
    reasons: &[Option<&'static str>],
) -> Result<[Parts; 3]> {
    let outliers: Vec<bool> = reasons.iter().map(Option::is_some).collect();
    let force = signals.force.each_ref();
    let [lift, drag, moment] = force.map(|f| regressors.fit(f, &outliers));
    Ok([lift?, drag?, moment?])
}

/// What is left of a force; zero where it is already known to be an outlier.
fn residual(force: &[f64], part: &Parts, reasons: &[Option<&'static str>]) -> Vec<f64> {
    let left = |k: usize| match reasons[k] {
        Some(_) => 0.0,
        None => force[k] - part.coherent[k] - part.drift[k],
    };
    (0..force.len()).map(left).collect()
}

/// Samples of `residual` that are too far out, segment by segment and in between.
fn outliers(
    residual: &[f64],
    part: &Parts,
    regressors: &Regressors,
    options: &SpikeOptions,
    least: f64,
) -> Vec<usize> {
    if options.deviations == 0.0 {
        return Vec::new();
    }
    let mut found = Vec::new();
    let mut at = 0;
    let mut stretches = Vec::new();
    for s in &regressors.stretches {
        stretches.push(at..s.start.max(at));
        stretches.push(s.start.max(at)..s.end);
        at = s.end;
    }
    stretches.push(at..residual.len());
    // a rest has no force that follows the motion: what counts there is that of the recording
    let overall = largest_magnitude(&part.coherent);
    for (i, range) in stretches.into_iter().enumerate() {
        if range.is_empty() {
            continue;
        }
        let deviation = robust_deviation(&residual[range.clone()]);
        let follows = match i % 2 {
            1 => largest_magnitude(&part.coherent[range.clone()]),
            _ => overall,
        };
        let limit = (options.deviations * deviation).max(options.least_part * follows);
        let limit = limit.max(least);
        found.extend(range.filter(|k| residual[*k].abs() > limit));
    }
    found
}

fn replace(
    signals: &mut SectionSignals,
    parts: &[Parts; 3],
    reasons: &[Option<&'static str>],
) -> Vec<Replaced> {
    let mut replaced = Vec::new();
    let mut end = 0;
    for stretch in reasons.chunk_by(|a, b| a == b) {
        let first = end;
        end += stretch.len();
        let Some(reason) = stretch[0] else { continue };
        let mut peak = [0.0_f64; 3];
        for at in first..end {
            for d in 0..Dof::THREE.len() {
                let instead = parts[d].coherent[at] + parts[d].drift[at];
                let force = &mut signals.force[d][at];
                peak[d] = peak[d].max((*force - instead).abs());
                *force = instead;
            }
        }
        replaced.push(Replaced {
            first,
            samples: stretch.len(),
            start_s: first as f64 / signals.sampling_hz,
            reason: reason.to_owned(),
            peak,
        });
    }
    replaced
}
