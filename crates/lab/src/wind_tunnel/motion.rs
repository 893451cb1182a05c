//! The motion of a forced-vibration run: rest, then one ramped sine per frequency.

use super::records::Segment;
use super::tunnel_plan::TunnelPlan;
use std::f64::consts::TAU;

/// Displacement, velocity (1/s) and acceleration (1/s²) of a harmonic motion of unit amplitude that begins and ends at rest, at `t` from
/// the beginning of the stretch.
///
/// `w(t) sin(ωt)` with a window `w` that rises from 0 to 1 by the quintic `10u³ − 15u⁴ + 6u⁵`, whose first two
/// derivatives vanish at both ends, and falls likewise: displacement, velocity and acceleration are continuous.
pub(super) fn ramped_sine(t_s: f64, omega: f64, duration_s: f64, ramp_s: f64) -> [f64; 3] {
    let [w, w_rate, w_second] = window(t_s, duration_s, ramp_s);
    let (sin, cos) = (omega * t_s).sin_cos();
    [
        w * sin,
        w_rate * sin + w * omega * cos,
        w_second * sin + omega * (2.0 * w_rate * cos - w * omega * sin),
    ]
}

/// The window of a stretch of motion, its rate (1/s) and second rate (1/s²) at `t` from the beginning of the stretch.
pub(super) fn window(t_s: f64, duration_s: f64, ramp_s: f64) -> [f64; 3] {
    if t_s <= 0.0 || t_s >= duration_s {
        return [0.0; 3];
    }
    let to_end = duration_s - t_s;
    let (u, sign) = match t_s < to_end {
        true => (t_s / ramp_s, 1.0),
        false => (to_end / ramp_s, -1.0),
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

impl UnitMotion {
    /// Rest, then each frequency in turn as the plan has it, all of it `delay_s` later; the segments are stated as without the delay.
    pub(super) fn harmonic(frequencies_hz: &[f64], plan: &TunnelPlan, delay_s: f64) -> Self {
        let start = |i: usize| plan.still_s + i as f64 * plan.segment_s;
        let segment = |(i, f): (usize, &f64)| Segment {
            frequency_hz: *f,
            start_s: start(i),
            end_s: start(i + 1),
        };
        let segments: Vec<Segment> = frequencies_hz.iter().enumerate().map(segment).collect();
        let samples = (start(segments.len()) * plan.sampling_hz).round() as usize;
        let mut motion = Self {
            displacement: vec![0.0; samples],
            velocity: vec![0.0; samples],
            acceleration: vec![0.0; samples],
            segment_of: vec![None; samples],
            segments,
        };
        for sample in 0..samples {
            let t = sample as f64 / plan.sampling_hz - delay_s;
            if t < plan.still_s {
                continue;
            }
            let index = ((t - plan.still_s) / plan.segment_s) as usize;
            let index = index.min(frequencies_hz.len() - 1);
            let Segment {
                frequency_hz,
                start_s,
                ..
            } = motion.segments[index];
            let omega = TAU * frequency_hz;
            [
                motion.displacement[sample],
                motion.velocity[sample],
                motion.acceleration[sample],
            ] = ramped_sine(t - start_s, omega, plan.segment_s, plan.ramp_s);
            motion.segment_of[sample] = Some(index);
        }
        motion
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rates_are_the_derivatives_of_the_displacement() {
        let sine = |t: f64| ramped_sine(t, TAU * 1.1, 26.0, 4.0);
        let h = 1e-5;
        for i in 0..520 {
            let t = 0.025 + 0.05 * f64::from(i);
            let [x, v, a] = sine(t);
            let slope = |i: usize| (sine(t + h)[i] - sine(t - h)[i]) / (2.0 * h);
            // Central difference: ω³h²/6 ≈ 6e-9, rounding ε/h ≈ 1e-11.
            assert!((v - slope(0)).abs() < 1e-7, "{t}: {x}");
            // The same with one more ω, and a kink of the acceleration where a ramp begins: 30/ramp³·h ≈ 5e-6.
            assert!((a - slope(1)).abs() < 1e-5, "{t}");
        }
        assert_eq!(sine(0.0), [0.0; 3]);
        assert_eq!(sine(26.0), [0.0; 3]);
        // Between the ramps it is the plain sine.
        let t: f64 = 13.3;
        assert_eq!(sine(t)[0], (TAU * 1.1 * t).sin());
    }

    #[test]
    fn neighbouring_segments_meet_at_rest() {
        // rest of 8 s, segments of 26 s, ramps of 4 s, 200 Hz
        let plan = TunnelPlan::default();
        let motion = UnitMotion::harmonic(&[0.25, 0.8], &plan, 0.0);
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
        let later = UnitMotion::harmonic(&[0.25, 0.8], &plan, delay_s);
        for (a, b) in motion.displacement.iter().zip(&later.displacement[7..]) {
            assert!((a - b).abs() < 1e-12);
        }
    }
}
