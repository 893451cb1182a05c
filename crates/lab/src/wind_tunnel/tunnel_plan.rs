//! The plan of the virtual tunnel: what is moved how, what it must be, and what of it was likely meant otherwise; and the motion of a
//! forced-vibration run by it: rest, then one ramped sine per frequency.

use super::records::Segment;
use crate::error::{Result, ensure, non_negative, positive};
use crate::files::derivatives::TABLE_3_2_FREQUENCIES_HZ;
use crate::plausibility::{Finding, MOTION_FREQUENCY, SAMPLING, WIND_SPEED, beyond, unusual_air};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Faster than any load cell of a wind tunnel is read, Hz.
const MOST_HERTZ: f64 = 1e5;
/// Samples of one record at most: a hundred times those of Table 3.2, in some 500 MB.
const MOST_SAMPLES: f64 = 1e7;
/// Frequencies of motion, and wind speeds, at most.
const MOST_TESTS: usize = 1000;

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

impl TrainingMotion {
    /// The motion in words.
    pub(super) fn describe(&self) -> String {
        match self {
            Self::Harmonic {} => "harmonic motions".into(),
            Self::MultiSine { .. } => "a multi-sine".into(),
            Self::WhiteNoise { min_hz, max_hz, .. } => {
                format!("white noise from {min_hz} to {max_hz} Hz")
            }
        }
    }

    /// How long a broadband motion lasts, ramps included, s.
    pub(super) fn duration_s(&self) -> Option<f64> {
        match self {
            Self::Harmonic {} => None,
            Self::MultiSine { duration_s } | Self::WhiteNoise { duration_s, .. } => {
                Some(*duration_s)
            }
        }
    }
}

/// A series of forced-vibration tests; the default is Table 3.2 of the thesis.
///
/// ```
/// # mod aerodeck { pub use aerodeck_core::*; pub use aerodeck_lab::*; }
/// use aerodeck::files::derivatives::embedded;
/// use aerodeck::section::Dof;
/// use aerodeck::wind_tunnel::TunnelPlan;
///
/// let plan = TunnelPlan { sampling_hz: 50.0, segment_s: 12.0, ..TunnelPlan::default() };
/// let records = plan.records_from_table(&embedded::deck("LN21-5200")?, &Dof::TWO)?;
/// assert_eq!(records.len(), 4); // two motions at the two speeds of the table
/// # Ok::<(), aerodeck::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TunnelPlan {
    /// How the section is moved.
    pub motion: TrainingMotion,
    /// Whether records of broadband motions may be made from a table, its derivatives taken as linear in `V̂` between the
    /// test points of a speed and as constant beyond them.
    pub interpolate_table: bool,
    /// Frequencies of motion in test order, Hz. Records from a table take the frequencies of its points instead.
    pub frequencies_hz: Vec<f64>,
    /// Mean wind speeds, m/s. Records from a table take its speeds instead.
    pub speeds_m_s: Vec<f64>,
    /// Amplitude of heave, m.
    pub vertical_amplitude_m: f64,
    /// Amplitude of sway, m.
    pub lateral_amplitude_m: f64,
    /// Amplitude of rotation, degrees.
    pub torsion_amplitude_deg: f64,
    /// Sampling frequency, Hz.
    pub sampling_hz: f64,
    /// Rest before the first frequency, s.
    pub still_s: f64,
    /// Time at each frequency, ramps included, s.
    pub segment_s: f64,
    /// Ramp at either end of a segment, s.
    pub ramp_s: f64,
    /// Air density, kg/m³.
    pub air_density_kg_m3: f64,
    /// Standard deviation of the noise added to each force, as a fraction of the RMS of that force over the record; 0 for
    /// none.
    pub noise_fraction: f64,
    /// Correlation time of the noise, s: its correlation falls as `e^(−|t|/τ)`; 0 for white noise.
    pub noise_correlation_s: f64,
    /// Seed of the noise and of broadband motions.
    pub seed: u64,
}

impl Default for TunnelPlan {
    fn default() -> Self {
        Self {
            motion: TrainingMotion::Harmonic {},
            interpolate_table: false,
            frequencies_hz: TABLE_3_2_FREQUENCIES_HZ.to_vec(),
            speeds_m_s: vec![8.17, 4.0],
            vertical_amplitude_m: 0.010,
            lateral_amplitude_m: 0.020,
            torsion_amplitude_deg: 1.0,
            sampling_hz: 200.0,
            still_s: 8.0,
            segment_s: 26.0,
            ramp_s: 4.0,
            air_density_kg_m3: 1.19,
            noise_fraction: 0.0,
            noise_correlation_s: 0.0,
            seed: 1,
        }
    }
}

impl TunnelPlan {
    /// Checks that the plan can be carried out.
    pub fn validate(&self) -> Result<()> {
        for (key, list) in [
            ("frequencies_hz", &self.frequencies_hz),
            ("speeds_m_s", &self.speeds_m_s),
        ] {
            ensure(!list.is_empty(), key, "at least one number", "none")?;
            let expected = format_args!("at most {MOST_TESTS} numbers");
            ensure(list.len() <= MOST_TESTS, key, expected, list.len())?;
            list.iter().try_for_each(|x| positive(key, *x).map(drop))?;
        }
        self.check_size()?;
        positive("vertical_amplitude_m", self.vertical_amplitude_m)?;
        positive("lateral_amplitude_m", self.lateral_amplitude_m)?;
        positive("torsion_amplitude_deg", self.torsion_amplitude_deg)?;
        non_negative("still_s", self.still_s)?;
        positive("segment_s", self.segment_s)?;
        positive("ramp_s", self.ramp_s)?;
        positive("air_density_kg_m3", self.air_density_kg_m3)?;
        non_negative("noise_fraction", self.noise_fraction)?;
        non_negative("noise_correlation_s", self.noise_correlation_s)?;
        self.check_motion()?;
        let (ramp, segment) = (self.ramp_s, self.segment_s);
        let expected = format_args!("at most half of segment_s ({segment} s)");
        ensure(2.0 * ramp <= segment, "ramp_s", expected, ramp)?;
        self.check_sampling(&self.frequencies_hz)
    }

    /// Numbers that were likely meant in another unit; the plan can be carried out all the same.
    pub fn findings(&self) -> Vec<Finding> {
        let frequency = |f: &f64| beyond("tunnel.frequencies_hz", *f, &MOTION_FREQUENCY);
        let speed = |v: &f64| beyond("tunnel.speeds_m_s", *v, &WIND_SPEED);
        let sampling = beyond("tunnel.sampling_hz", self.sampling_hz, &SAMPLING);
        let air = unusual_air("tunnel.air_density_kg_m3", self.air_density_kg_m3);
        let frequencies = self.frequencies_hz.iter().filter_map(frequency);
        let speeds = self.speeds_m_s.iter().filter_map(speed);
        let stated = frequencies.chain(speeds);
        stated.chain(sampling).chain(air).collect()
    }

    /// Refuses plans that no tunnel carries out and no memory holds.
    fn check_size(&self) -> Result<()> {
        positive("sampling_hz", self.sampling_hz)?;
        let (rate, expected) = (self.sampling_hz, format_args!("at most {MOST_HERTZ} Hz"));
        ensure(rate <= MOST_HERTZ, "sampling_hz", expected, rate)?;
        let seconds = self.still_s + self.segment_s * self.frequencies_hz.len() as f64;
        let samples = rate * seconds;
        let expected = format_args!("records of at most {MOST_SAMPLES:e} samples");
        let found = format_args!("{samples:e}: {seconds} s at {rate} Hz");
        ensure(samples <= MOST_SAMPLES, "segment_s", expected, found)
    }

    /// Checks duration and band of the motion against the other keys.
    pub(super) fn check_motion(&self) -> Result<()> {
        let Some(duration) = self.motion.duration_s() else {
            return Ok(());
        };
        if let TrainingMotion::WhiteNoise { min_hz, max_hz, .. } = self.motion {
            positive("motion.min_hz", min_hz)?;
            let highest = 0.2 * self.sampling_hz;
            let fits = max_hz > min_hz && max_hz <= highest;
            let expected =
                format_args!("more than min_hz and at most a fifth of sampling_hz ({highest} Hz)");
            ensure(fits, "motion.max_hz", expected, max_hz)?;
        }
        positive("motion.duration_s", duration)?;
        let ramps = 2.0 * self.ramp_s;
        let expected = format_args!("at least two ramps ({ramps} s)");
        ensure(ramps <= duration, "motion.duration_s", expected, duration)
    }

    /// A fifth of the sampling frequency leaves room for the ramps' side bands.
    pub(super) fn check_sampling(&self, frequencies_hz: &[f64]) -> Result<()> {
        let limit = 0.2 * self.sampling_hz;
        let expected = format_args!("at most a fifth of sampling_hz ({limit} Hz)");
        let check = |f: &f64| ensure(*f <= limit, "frequencies_hz", expected, f);
        frequencies_hz.iter().try_for_each(check)
    }
}

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
