//! Stretches of harmonic motion, by the frequency of excitation.
//!
//! Upward passages of the motion through zero, counted when it comes from below −0.3 and goes above 0.3 of its amplitude,
//! give the periods; neighbouring periods that agree within 6 % are one frequency. Between two frequencies the segment ends
//! in the middle of the rest, or half way when there is none. The frequency is then refined by the phases of the two
//! halves of the steady part, and the steady part cut to whole periods.

use super::options::SegmentOptions;
use super::signals::HarmonicSegment;
use crate::error::{Result, ensure};
use crate::section::Dof;
use crate::signal::{largest_about_mean, largest_magnitude, median, plateau, refine_frequency};
use crate::wind_tunnel::{RawRecording, Segment};

/// Passages are counted from and to this part of the amplitude.
const HYSTERESIS: f64 = 0.3;
/// Periods that agree within this fraction belong to one frequency.
const SAME_PERIOD: f64 = 0.06;
/// Below this part of the amplitude the model rests.
const AT_REST: f64 = 0.02;
/// Periods of one frequency at least.
const PERIODS_AT_LEAST: usize = 2;
/// A stated frequency is met within this fraction.
const SAME_FREQUENCY: f64 = 0.05;

/// The degree of freedom that moves most: displacements over the width of the model, rotation in rad.
pub(crate) fn moving_dof(motion: &[Vec<f64>; 3], width_m: f64) -> Option<Dof> {
    let size = |d: Dof| largest_about_mean(&motion[super::index(d)]) * d.motion_scale(width_m);
    let moving = Dof::THREE.into_iter().filter(|d| size(*d) > 0.0);
    moving.max_by(|a, b| size(*a).total_cmp(&size(*b)))
}

/// Whether a motion meets a stated frequency.
pub(super) fn is_near(frequency_hz: f64, stated_hz: f64) -> bool {
    (frequency_hz / stated_hz - 1.0).abs() <= SAME_FREQUENCY
}

/// The harmonic stretches of a motion, in order; empty when it is something else.
pub(crate) fn find_segments(
    motion: &[f64],
    sampling_hz: f64,
    options: &SegmentOptions,
) -> Vec<HarmonicSegment> {
    let amplitude = largest_magnitude(motion);
    let passages = upward_passages(motion, HYSTERESIS * amplitude);
    let groups = groups_of_one_period(&passages);
    let mut found = Vec::new();
    for (i, group) in groups.iter().enumerate() {
        let (first, last) = (group[0], group[group.len() - 1]);
        let period = (last - first) / (group.len() - 1) as f64;
        let quiet = AT_REST * amplitude;
        // a slow motion is quiet about every passage through zero
        let rest = (0.25 * sampling_hz).max(0.25 * period);
        let start = match groups[..i].last().and_then(|g| g.last()) {
            Some(before) => seam(motion, *before, first, quiet),
            None => first_motion(motion, first, quiet, rest, sampling_hz),
        };
        let end = match groups.get(i + 1) {
            Some(after) => seam(motion, last, after[0], quiet),
            None => {
                let reversed: Vec<f64> = motion.iter().rev().copied().collect();
                let last = motion.len() as f64 - 1.0 - last;
                motion.len() - first_motion(&reversed, last, quiet, rest, sampling_hz)
            }
        };
        let rough = sampling_hz / period;
        let full = options.full_amplitude;
        let steady = |f: f64| plateau(motion, start..end, sampling_hz, f, full);
        let refined = steady(rough)
            .and_then(|p| refine_frequency(motion, p.range(), sampling_hz, rough).ok())
            .filter(|f| (f / rough - 1.0).abs() < SAME_PERIOD);
        let Some((frequency_hz, plateau)) = refined.and_then(|f| Some((f, steady(f)?))) else {
            continue;
        };
        let stated = &options.frequencies_hz;
        if stated.is_empty() || stated.iter().any(|f| is_near(frequency_hz, *f)) {
            let segment = Segment {
                frequency_hz,
                start_s: start as f64 / sampling_hz,
                end_s: end as f64 / sampling_hz,
            };
            found.push(HarmonicSegment { segment, plateau });
        }
    }
    found
}

/// Refuses a motion that ends before it has gone through the periods that one test point takes: of such a record nothing can be
/// said, whatever moves.
pub(crate) fn whole_periods(place: &str, recording: &RawRecording, dof: Dof) -> Result<()> {
    let motion = super::still_air::from_rest(&recording.motion[super::index(dof)]);
    let amplitude = largest_magnitude(&motion);
    let passages = upward_passages(&motion, HYSTERESIS * amplitude).len();
    let (periods, samples) = (passages.saturating_sub(1), motion.len());
    let seconds = samples as f64 / recording.sampling_hz;
    let expected = format_args!(
        "a record of at least {PERIODS_AT_LEAST} whole periods of the {} motion",
        dof.name()
    );
    let found = format_args!("{periods} in {samples} samples ({seconds:.3} s)");
    ensure(periods >= PERIODS_AT_LEAST, place, expected, found)
}

/// Places (in samples) at which the motion passes zero upwards between −`level` and `level`.
fn upward_passages(motion: &[f64], level: f64) -> Vec<f64> {
    let mut passages = Vec::new();
    let mut armed = false;
    let mut zero = None;
    for (k, pair) in motion.windows(2).enumerate() {
        if pair[0] <= -level {
            armed = level > 0.0;
        }
        if armed && pair[0] <= 0.0 && pair[1] > 0.0 {
            zero = Some(k as f64 + pair[0] / (pair[0] - pair[1]));
        }
        if armed && pair[1] >= level {
            passages.extend(zero.take());
            armed = false;
        }
    }
    passages
}

/// The passages of each frequency.
fn groups_of_one_period(passages: &[f64]) -> Vec<&[f64]> {
    let mut groups = Vec::new();
    let mut from = 0;
    while from + 1 < passages.len() {
        let mut periods = vec![passages[from + 1] - passages[from]];
        let mut to = from + 1;
        while to + 1 < passages.len() {
            let next = passages[to + 1] - passages[to];
            if (next / median(&periods) - 1.0).abs() > SAME_PERIOD {
                break;
            }
            periods.push(next);
            to += 1;
        }
        if periods.len() >= PERIODS_AT_LEAST {
            groups.push(&passages[from..=to]);
            from = to;
        } else {
            from += 1;
        }
    }
    groups
}

/// Middle of the longest rest between two places, or half way.
fn seam(motion: &[f64], from: f64, to: f64, quiet: f64) -> usize {
    let (from, to) = (from as usize, (to as usize).min(motion.len()));
    let (mut best, mut at) = (from..from, from);
    while at < to {
        let start = at;
        while at < to && motion[at].abs() <= quiet {
            at += 1;
        }
        if at - start > best.len() {
            best = start..at;
        }
        at += 1;
    }
    // a passage through zero is quiet for a few samples only
    if best.len() > 20 {
        (best.start + best.end) / 2
    } else {
        usize::midpoint(from, to)
    }
}

/// First sample of the motion that leads to the passage at `first`: after the last `rest` samples of rest before it, with
/// half a second for the smooth beginning of a ramp; 0 when it never rested.
fn first_motion(motion: &[f64], first: f64, quiet: f64, rest: f64, sampling_hz: f64) -> usize {
    let (rest, ramp) = (rest as usize, (0.5 * sampling_hz) as usize);
    let mut quiet_for = 0;
    for k in (0..(first as usize).min(motion.len())).rev() {
        quiet_for = match motion[k].abs() <= quiet {
            true => quiet_for + 1,
            false => 0,
        };
        if quiet_for == rest {
            return (k + rest).saturating_sub(ramp);
        }
    }
    0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::FlatPlate;
    use crate::wind_tunnel::TunnelPlan;

    #[test]
    fn segments_of_the_tunnel_are_found() {
        let plan = TunnelPlan {
            speeds_m_s: vec![8.0],
            ..TunnelPlan::default()
        };
        let records = plan
            .records_from_model(&FlatPlate::default(), "plate", 0.5)
            .unwrap();
        let truth = &records[0].header.segments;
        let found = find_segments(&records[0].motion[0], 200.0, &SegmentOptions::default());
        assert_eq!(found.len(), truth.len());
        for (found, truth) in found.iter().zip(truth) {
            let s = found.segment;
            // the part of the ramps above 0.99 is not quite harmonic: 4e-5 at 0.25 Hz, where five periods are steady
            assert!(
                (s.frequency_hz / truth.frequency_hz - 1.0).abs() < 1e-4,
                "{s:?}"
            );
            // the rest between two smooth ramps is found to within a part of a second
            assert!((s.start_s - truth.start_s).abs() < 0.7, "{s:?} {truth:?}");
            assert!((s.end_s - truth.end_s).abs() < 0.7, "{s:?} {truth:?}");
            let periods = (found.plateau.samples as f64 * s.frequency_hz / 200.0).round();
            assert_eq!(periods as usize, found.plateau.periods);
            assert!(found.plateau.samples as f64 / 200.0 > 15.0, "{found:?}");
        }
    }

    #[test]
    fn noise_has_no_segments_and_stated_frequencies_are_kept_only() {
        let wild: Vec<f64> = (0..2000_u64)
            .map(|k| ((k * k * 7919) % 1009) as f64 - 504.0)
            .collect();
        assert!(find_segments(&wild, 200.0, &SegmentOptions::default()).is_empty());
        let sine: Vec<f64> = (0..4000).map(|k| (0.05 * f64::from(k)).sin()).collect();
        let stated = |f| SegmentOptions {
            frequencies_hz: vec![f],
            ..SegmentOptions::default()
        };
        assert_eq!(find_segments(&sine, 200.0, &stated(1.59)).len(), 1);
        assert!(find_segments(&sine, 200.0, &stated(1.4)).is_empty());
    }
}
