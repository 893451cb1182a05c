//! The motion of a forced-vibration run: rest, then one ramped sine per frequency.

use super::records::Segment;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// How the rig moves the section.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum TrainingMotion {
    /// One ramped sine per frequency of the plan, in turn (Table 3.2 of the thesis).
    Harmonic {},
    /// All frequencies of the plan at once with equal amplitudes; their phases follow from the seed.
    MultiSine {
        /// Duration of the motion, ramps included, s.
        #[serde(default = "three_minutes")]
        duration_s: f64,
    },
    /// Gaussian noise whose spectrum is flat from `min_hz` to `max_hz` and zero elsewhere, up to the ramps.
    WhiteNoise {
        /// Lowest frequency, Hz.
        #[serde(default = "quarter")]
        min_hz: f64,
        /// Highest frequency, Hz.
        #[serde(default = "two_and_a_half")]
        max_hz: f64,
        /// Duration of the motion, ramps included, s.
        #[serde(default = "three_minutes")]
        duration_s: f64,
    },
}

impl Default for TrainingMotion {
    fn default() -> Self {
        Self::Harmonic {}
    }
}

fn three_minutes() -> f64 {
    180.0
}

fn quarter() -> f64 {
    0.25
}

fn two_and_a_half() -> f64 {
    2.5
}

/// One stretch of harmonic motion of unit amplitude that begins and ends at rest.
///
/// `w(t) sin(ωt)` with a window `w` that rises from 0 to 1 by the quintic `10u³ − 15u⁴ + 6u⁵`, whose first two
/// derivatives vanish at both ends, and falls likewise: displacement, velocity and acceleration are continuous.
#[derive(Debug, Clone, Copy)]
pub(super) struct RampedSine {
    pub omega_rad_s: f64,
    pub duration_s: f64,
    pub ramp_s: f64,
}

impl RampedSine {
    /// Displacement, velocity (1/s) and acceleration (1/s²) at `t` from the beginning of the stretch.
    pub(crate) fn at(&self, t_s: f64) -> [f64; 3] {
        let [w, w_rate, w_second] = window(t_s, self.duration_s, self.ramp_s);
        let omega = self.omega_rad_s;
        let (sin, cos) = (omega * t_s).sin_cos();
        [
            w * sin,
            w_rate * sin + w * omega * cos,
            w_second * sin + omega * (2.0 * w_rate * cos - w * omega * sin),
        ]
    }
}

/// The window of a stretch of motion, its rate (1/s) and second rate (1/s²) at `t` from the beginning of the stretch.
pub(super) fn window(t_s: f64, duration_s: f64, ramp_s: f64) -> [f64; 3] {
    if t_s <= 0.0 || t_s >= duration_s {
        return [0.0; 3];
    }
    let to_end = duration_s - t_s;
    let (u, sign) = if t_s < to_end {
        (t_s / ramp_s, 1.0)
    } else {
        (to_end / ramp_s, -1.0)
    };
    if u >= 1.0 {
        return [1.0, 0.0, 0.0];
    }
    let rise = u * u * u * (10.0 + u * (6.0 * u - 15.0));
    let slope = 30.0 * u * u * (1.0 - u) * (1.0 - u) / ramp_s;
    let bend = 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / (ramp_s * ramp_s);
    [rise, sign * slope, bend]
}

/// A whole run at unit amplitude.
#[derive(Debug, Clone)]
pub(super) struct UnitMotion {
    pub segments: Vec<Segment>,
    /// Displacement, one per sample.
    pub displacement: Vec<f64>,
    /// Velocity, 1/s.
    pub velocity: Vec<f64>,
    /// Acceleration, 1/s².
    pub acceleration: Vec<f64>,
    /// Segment of each sample; `None` at rest before the first.
    pub segment_of: Vec<Option<usize>>,
}

/// Timing of a run, s and Hz.
#[derive(Debug, Clone, Copy)]
pub(super) struct Timing {
    pub still_s: f64,
    pub segment_s: f64,
    pub ramp_s: f64,
    pub sampling_hz: f64,
    /// The whole motion comes later by this; the segments are stated as without it.
    pub delay_s: f64,
}

impl UnitMotion {
    /// Rest for `still_s`, then `segment_s` at each frequency, all of it `delay_s` later.
    pub(crate) fn new(frequencies_hz: &[f64], timing: Timing) -> Self {
        let start = |i: usize| timing.still_s + i as f64 * timing.segment_s;
        let segments: Vec<Segment> = frequencies_hz
            .iter()
            .enumerate()
            .map(|(i, f)| Segment {
                frequency_hz: *f,
                start_s: start(i),
                end_s: start(i + 1),
            })
            .collect();
        let samples = (start(segments.len()) * timing.sampling_hz).round() as usize;
        let mut motion = Self {
            segments,
            displacement: vec![0.0; samples],
            velocity: vec![0.0; samples],
            acceleration: vec![0.0; samples],
            segment_of: vec![None; samples],
        };
        for sample in 0..samples {
            let t = sample as f64 / timing.sampling_hz - timing.delay_s;
            if t >= timing.still_s {
                let index = ((t - timing.still_s) / timing.segment_s) as usize;
                motion.fill(sample, index.min(frequencies_hz.len() - 1), t, timing);
            }
        }
        motion
    }

    fn fill(&mut self, sample: usize, index: usize, t: f64, timing: Timing) {
        let segment = self.segments[index];
        let sine = RampedSine {
            omega_rad_s: TAU * segment.frequency_hz,
            duration_s: timing.segment_s,
            ramp_s: timing.ramp_s,
        };
        [
            self.displacement[sample],
            self.velocity[sample],
            self.acceleration[sample],
        ] = sine.at(t - segment.start_s);
        self.segment_of[sample] = Some(index);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rates_are_the_derivatives_of_the_displacement() {
        let sine = RampedSine {
            omega_rad_s: TAU * 1.1,
            duration_s: 26.0,
            ramp_s: 4.0,
        };
        let h = 1e-5;
        for i in 0..520 {
            let t = 0.025 + 0.05 * f64::from(i);
            let [x, v, a] = sine.at(t);
            let slope = |i: usize| (sine.at(t + h)[i] - sine.at(t - h)[i]) / (2.0 * h);
            // Central difference: ω³h²/6 ≈ 6e-9, rounding ε/h ≈ 1e-11.
            assert!((v - slope(0)).abs() < 1e-7, "{t}: {x}");
            // The same with one more ω, and a kink of the acceleration where a ramp begins: 30/ramp³·h ≈ 5e-6.
            assert!((a - slope(1)).abs() < 1e-5, "{t}");
        }
        assert_eq!(sine.at(0.0), [0.0; 3]);
        assert_eq!(sine.at(26.0), [0.0; 3]);
        // Between the ramps it is the plain sine.
        let t: f64 = 13.3;
        assert_eq!(sine.at(t)[0], (TAU * 1.1 * t).sin());
    }

    #[test]
    fn neighbouring_segments_meet_at_rest() {
        let timing = Timing {
            still_s: 8.0,
            segment_s: 26.0,
            ramp_s: 4.0,
            sampling_hz: 200.0,
            delay_s: 0.0,
        };
        let motion = UnitMotion::new(&[0.25, 0.8], timing);
        assert_eq!(motion.displacement.len(), 12_000);
        assert!(motion.displacement[..1601].iter().all(|x| *x == 0.0));
        // The ramps are smooth enough that no sample next to the seam has moved by more than 1e-6 of the amplitude.
        assert!(
            motion.displacement[6795..6805]
                .iter()
                .all(|x| x.abs() < 1e-6)
        );
        assert_eq!(motion.segment_of[6799..6801], [Some(0), Some(1)]);
        // A delay of whole samples moves the samples, bit by bit up to the rounding of the time.
        let delay_s = 0.035;
        let later = UnitMotion::new(&[0.25, 0.8], Timing { delay_s, ..timing });
        for (a, b) in motion.displacement.iter().zip(&later.displacement[7..]) {
            assert!((a - b).abs() < 1e-12);
        }
    }
}
