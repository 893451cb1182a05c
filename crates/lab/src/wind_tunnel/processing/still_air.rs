//! The still-air recording: brought into step with the one in wind, and subtracted from it.
//!
//! The two motions are the same but for when recording began. Their delay is that of the largest cross-correlation, refined by
//! the slope of the phase of the cross-spectrum (`crate::signal::delay`): whole samples would not do, since inertia is many
//! times the self-excited force and half a sample turns it by 2° at 2.5 Hz and 200 Hz. Then every channel in still air is moved
//! by Lagrange interpolation, which keeps the phase.
//!
//! Inertia, and what gravity does to the turning model, leave with the subtraction: `F_se = F_wind − F_still`, sample by sample,
//! after both are in global axes, about the centre of rotation and in step. The mass of the air that moves with the model in
//! still air leaves with it: the derivatives are those of wind against still air, as in every such test.

use super::signals::{HarmonicSegment, SectionSignals};
use crate::error::{Error, Result, ensure};
use crate::section::Dof;
use crate::signal::{delay, delayed, fit_sine, mean_and_deviation, root_mean_square};
use crate::wind_tunnel::RawRecording;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Motions that are less alike than this are not the same run.
const ALIKE: f64 = 0.9;

/// Part of a sample that counts as none.
const ROUNDING: f64 = 1e-6;

/// How the still-air recording stood against the one in wind.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Alignment {
    /// By how much the still-air recording was late, s.
    pub offset_s: f64,
    /// The same in samples.
    pub offset_samples: f64,
    /// The same by a parabola through the correlation alone, samples.
    pub parabolic_samples: f64,
    /// Correlation of the aligned motions over what both recordings cover.
    pub correlation: f64,
    /// Amplitude of the motion in wind over that in still air.
    pub amplitude_ratio: f64,
}

/// Moves `still_air` into step with `in_wind` by their motions in `dof`: the recording, as long as the one in wind, samples of that which
/// both cover, and what was found.
///
/// # Errors
/// [`Error::Input`] when the motions are not alike, naming `run`.
pub(crate) fn align(
    run: &str,
    in_wind: &RawRecording,
    still_air: &RawRecording,
    dof: Dof,
) -> Result<(RawRecording, Range<usize>, Alignment)> {
    let of = |r: &RawRecording| from_rest(&r.motion[super::index(dof)]);
    let (reference, compared) = (of(in_wind), of(still_air));
    let place = || format!("run {run}, still air, {} motion", dof.name());
    let (late, parabolic_samples) = delay(&reference, &compared).ok_or_else(|| {
        let expected = "the motion of the recording in wind";
        Error::input(place(), expected, "one that is nowhere like it")
    })?;
    let count = in_wind.sample_count();
    let moved_still = still_air.map(|x| moved(x, late, count));
    // an offset of rounding costs no sample
    let first = (-late - ROUNDING).ceil().max(0.0) as usize;
    let end = still_air.sample_count() as f64 - late + ROUNDING;
    let end = end.floor().max(0.0) as usize;
    let covered = first.min(count)..end.min(count);
    let aligned_motion = moved(&compared, late, count);
    let inside = |x: &[f64]| x[covered.clone()].to_vec();
    let (a, b) = (inside(&reference), inside(&aligned_motion));
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(p, q)| p * q).sum::<f64>();
    // over what both cover: a recording that ends early is alike, and reported as short where it matters
    let correlation = dot(&a, &b) / (dot(&a, &a) * dot(&b, &b)).sqrt();
    let alike = correlation.is_finite() && correlation >= ALIKE;
    let expected =
        format_args!("the motion of the recording in wind, correlation at least {ALIKE}");
    let found = format_args!("correlation {correlation:.3}");
    ensure(alike, place(), expected, found)?;
    let alignment = Alignment {
        offset_s: late / in_wind.sampling_hz,
        offset_samples: late,
        parabolic_samples,
        correlation,
        amplitude_ratio: dot(&a, &b) / dot(&b, &b),
    };
    Ok((moved_still, covered, alignment))
}

/// The signal earlier by `samples`, cut or held to `count` samples.
fn moved(x: &[f64], samples: f64, count: usize) -> Vec<f64> {
    let mut x = x.to_vec();
    let last = x[x.len() - 1];
    x.resize(x.len().max(count), last);
    let mut y = delayed(&x, -samples);
    y.truncate(count);
    y
}

/// The motion counted from where the model rests: the middle of its motion is where it is most often.
pub(crate) fn from_rest(x: &[f64]) -> Vec<f64> {
    let rest = crate::signal::median(x);
    x.iter().map(|v| v - rest).collect()
}

/// What the subtraction took.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct RemovedInertia {
    /// RMS of what was subtracted: N, N, N·m.
    pub removed_rms: [f64; 3],
    /// RMS of what is left.
    pub left_rms: [f64; 3],
    /// Greatest difference of the motion in still air from that in wind, over the segments: of the complex amplitude, relative.
    #[serde(default)]
    pub motion_mismatch: f64,
    /// What of the inertia is left for that, over the force that is left, of the degree of freedom that moves: the greatest of the segments.
    #[serde(default)]
    pub left_in_force: f64,
}

/// How far still air moved otherwise than wind, and what that leaves of the inertia in the force, `dof` of both; where no segment is
/// harmonic by standard deviations.
pub(crate) fn mismatch(
    in_wind: &SectionSignals,
    still_air: &SectionSignals,
    segments: &[HarmonicSegment],
    dof: usize,
) -> Result<RemovedInertia> {
    let mut found = RemovedInertia::default();
    let mut enter = |mismatch: f64, removed: f64, left: f64| {
        found.motion_mismatch = found.motion_mismatch.max(mismatch);
        if left > 0.0 {
            found.left_in_force = found.left_in_force.max(mismatch * removed / left);
        }
    };
    for at in segments {
        let (rate, frequency_hz) = (in_wind.sampling_hz, at.segment.frequency_hz);
        let of = |signals: &[Vec<f64>; 3]| {
            let fit = fit_sine(&signals[dof], at.plateau.range(), rate, frequency_hz);
            fit.map(|fit| fit.fundamental())
        };
        let motion = of(&still_air.motion)? / of(&in_wind.motion)?;
        let (wind, still) = (of(&in_wind.force)?, of(&still_air.force)?);
        enter((motion - 1.0).norm(), still.norm(), (wind - still).norm());
    }
    if segments.is_empty() {
        // about the means: where a gauge stands is no motion
        let deviation = |x: &[f64]| mean_and_deviation(x.iter().copied()).1;
        let apart = |a: &[Vec<f64>; 3], b: &[Vec<f64>; 3]| {
            let difference: Vec<f64> = a[dof].iter().zip(&b[dof]).map(|(a, b)| a - b).collect();
            deviation(&difference)
        };
        let moved = deviation(&in_wind.motion[dof]);
        if moved > 0.0 {
            let removed = deviation(&still_air.force[dof]);
            let mismatch = apart(&in_wind.motion, &still_air.motion) / moved;
            enter(mismatch, removed, apart(&in_wind.force, &still_air.force));
        }
    }
    Ok(found)
}

/// `in_wind − still_air`.
pub(crate) fn subtract(
    in_wind: &mut SectionSignals,
    still_air: &SectionSignals,
    mismatch: RemovedInertia,
) -> RemovedInertia {
    for (wind, still) in in_wind.force.iter_mut().zip(&still_air.force) {
        wind.iter_mut().zip(still).for_each(|(w, s)| *w -= s);
    }
    let rms = |s: &SectionSignals| s.force.each_ref().map(|f| root_mean_square(f));
    RemovedInertia {
        removed_rms: rms(still_air),
        left_rms: rms(in_wind),
        ..mismatch
    }
}
