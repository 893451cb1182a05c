//! Broadband motions for training: all frequencies of a band at once.
//!
//! White noise excites every frequency of its band alike, so that the outputs of orthonormal filters are uncorrelated and
//! their coefficients best determined (thesis, section 2.4); a multi-sine puts all its power into chosen frequencies. Both
//! start and end at rest with the ramps of the harmonic motions, and never exceed the amplitude of the plan.

use super::motion::{Timing, TrainingMotion, UnitMotion, window};
use super::records::Record;
use super::virtual_tunnel::TunnelPlan;
use crate::aerodynamics::derivatives::{
    DerivativeTable, Extrapolation, InterpolatedTable, Interpolation,
};
use crate::error::{Result, ensure, positive};
use crate::section::Dof;
use crate::signal::{largest_magnitude, random_stream};
use nalgebra::Complex;
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;

/// Stream of the random numbers that make a motion; the noise of the forces draws from others.
const MOTION_STREAM: u64 = u64::MAX;

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

    /// Checks duration and band against the other keys of a plan.
    pub(super) fn validate(&self, timing: Timing) -> Result<()> {
        let duration = match self {
            Self::Harmonic {} => return Ok(()),
            Self::MultiSine { duration_s } => *duration_s,
            Self::WhiteNoise {
                min_hz,
                max_hz,
                duration_s,
            } => {
                positive("motion.min_hz", *min_hz)?;
                let highest = 0.2 * timing.sampling_hz;
                ensure(
                    *max_hz > *min_hz && *max_hz <= highest,
                    "motion.max_hz",
                    format_args!(
                        "more than min_hz and at most a fifth of sampling_hz ({highest} Hz)"
                    ),
                    max_hz,
                )?;
                *duration_s
            }
        };
        positive("motion.duration_s", duration)?;
        ensure(
            2.0 * timing.ramp_s <= duration,
            "motion.duration_s",
            format_args!("at least two ramps ({} s)", 2.0 * timing.ramp_s),
            duration,
        )
    }
}

impl UnitMotion {
    /// Rest for `still_s`, then the motion, at most 1 in size; all of it `delay_s` later. Not for harmonic motions.
    pub(super) fn broadband(
        motion: &TrainingMotion,
        frequencies_hz: &[f64],
        timing: Timing,
        seed: u64,
    ) -> Self {
        let (lines, duration_s) = Lines::new(motion, frequencies_hz, timing, seed);
        let on_time = lines.samples(duration_s, timing, 0.0);
        let largest = largest_magnitude(&on_time[0]);
        let unit = |x: Vec<f64>| -> Vec<f64> {
            let scale = if largest > 0.0 { 1.0 / largest } else { 1.0 };
            x.into_iter().map(|x| scale * x).collect()
        };
        let [displacement, velocity, acceleration] =
            lines.samples(duration_s, timing, timing.delay_s).map(unit);
        Self {
            segments: Vec::new(),
            segment_of: vec![None; displacement.len()],
            displacement,
            velocity,
            acceleration,
        }
    }
}

impl TunnelPlan {
    /// Broadband records of one speed of a table.
    pub(super) fn interpolated_records(
        &self,
        group: &DerivativeTable,
        dofs: &[Dof],
        speed_m_s: f64,
        delay_s: f64,
    ) -> Result<Vec<Record>> {
        ensure(
            self.interpolate_table,
            "motion",
            "harmonic motions, since a table knows its test points only, or interpolate_table = true to have its \
                 derivatives interpolated",
            self.motion.describe(),
        )?;
        // as the plan's key says
        let by = Interpolation::LinearVHat;
        let model = InterpolatedTable::by(by, group, dofs, Extrapolation::Hold)?;
        let mut records =
            self.records_at_speed(&model, &group.name, group.width_m, speed_m_s, delay_s)?;
        for record in &mut records {
            record.header.source = format!(
                "virtual tunnel: linear response of {}, derivatives interpolated in V̂ and held beyond their points ({})",
                group.name, group.header.source
            );
            record.header.licence = group.header.licence.clone();
        }
        Ok(records)
    }

    /// The motion at unit amplitude; harmonic motions have the given frequencies.
    pub(super) fn unit_motion(&self, frequencies_hz: &[f64], delay_s: f64) -> UnitMotion {
        match &self.motion {
            TrainingMotion::Harmonic {} => UnitMotion::new(frequencies_hz, self.timing(delay_s)),
            motion => UnitMotion::broadband(
                motion,
                &self.frequencies_hz,
                self.timing(delay_s),
                self.seed,
            ),
        }
    }
}

/// A sum of sines: circular frequency (rad/s) and complex amplitude, `Re Σ z e^{iωt}`.
struct Lines(Vec<(f64, Complex<f64>)>);

impl Lines {
    /// The steady motion and its duration.
    fn new(
        motion: &TrainingMotion,
        frequencies_hz: &[f64],
        timing: Timing,
        seed: u64,
    ) -> (Self, f64) {
        let mut random = random_stream(seed, MOTION_STREAM);
        match motion {
            TrainingMotion::Harmonic {} => (Self(Vec::new()), timing.segment_s),
            TrainingMotion::MultiSine { duration_s } => {
                let sine = |f: &f64| {
                    let phase = TAU * random.random::<f64>();
                    (TAU * f, Complex::from_polar(1.0, phase))
                };
                (Self(frequencies_hz.iter().map(sine).collect()), *duration_s)
            }
            TrainingMotion::WhiteNoise {
                min_hz,
                max_hz,
                duration_s,
            } => {
                // independent normal amplitudes at all frequencies that are periodic in the duration
                let bins = (min_hz * duration_s).ceil() as u64..=(max_hz * duration_s) as u64;
                let line = |bin: u64| {
                    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
                    let z = Complex::new(normal(), normal());
                    (TAU * bin as f64 / duration_s, z)
                };
                (Self(bins.map(line).collect()), *duration_s)
            }
        }
    }

    /// Displacement, velocity (1/s) and acceleration (1/s²) of the whole run under its window.
    fn samples(&self, duration_s: f64, timing: Timing, delay_s: f64) -> [Vec<f64>; 3] {
        let count = ((timing.still_s + duration_s) * timing.sampling_hz).round() as usize;
        let start = timing.still_s + delay_s;
        // e^{iωt} from sample to sample by one product
        let turns: Vec<Complex<f64>> = self
            .0
            .iter()
            .map(|(omega, _)| Complex::from_polar(1.0, omega / timing.sampling_hz))
            .collect();
        let first = (start * timing.sampling_hz).ceil() as usize;
        let t_first = first as f64 / timing.sampling_hz - start;
        let mut at: Vec<Complex<f64>> = self
            .0
            .iter()
            .map(|(omega, z)| z * Complex::from_polar(1.0, omega * t_first))
            .collect();
        let mut run: [Vec<f64>; 3] = std::array::from_fn(|_| vec![0.0; first.min(count)]);
        for sample in first..count {
            let t = sample as f64 / timing.sampling_hz - start;
            let (mut x, mut v, mut a) = (0.0, 0.0, 0.0);
            for ((z, turn), (omega, _)) in at.iter_mut().zip(&turns).zip(&self.0) {
                x += z.re;
                v -= omega * z.im;
                a -= omega * omega * z.re;
                *z *= turn;
            }
            let [w, w1, w2] = window(t, duration_s, timing.ramp_s);
            let rates = [w * x, w1 * x + w * v, w2 * x + 2.0 * w1 * v + w * a];
            for (channel, value) in run.iter_mut().zip(rates) {
                channel.push(value);
            }
        }
        run
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Fourier;

    const TIMING: Timing = Timing {
        still_s: 8.0,
        segment_s: 26.0,
        ramp_s: 4.0,
        sampling_hz: 200.0,
        delay_s: 0.0,
    };

    /// Share of the power of a motion between two frequencies, Hz.
    fn power_between(motion: &[f64], low: f64, high: f64) -> f64 {
        let spectrum = Fourier::new(motion.len()).spectrum(motion.iter().copied());
        let half = &spectrum[..motion.len() / 2];
        let frequency = |bin: usize| 200.0 * bin as f64 / motion.len() as f64;
        let all: f64 = half.iter().map(|z| z.norm_sqr()).sum();
        let inside = half
            .iter()
            .enumerate()
            .filter(|(b, _)| (low..=high).contains(&frequency(*b)));
        inside.map(|(_, z)| z.norm_sqr()).sum::<f64>() / all
    }

    fn noise(seed: u64) -> UnitMotion {
        let motion = TrainingMotion::WhiteNoise {
            min_hz: 0.3,
            max_hz: 3.0,
            duration_s: 200.0,
        };
        motion.validate(TIMING).unwrap();
        UnitMotion::broadband(&motion, &[], TIMING, seed)
    }

    #[test]
    fn noise_is_flat_in_its_band_seeded_and_ramped() {
        let unit = noise(1);
        assert_eq!(unit.displacement.len(), 41_600);
        assert!(unit.displacement[..1601].iter().all(|x| *x == 0.0));
        let largest = unit
            .displacement
            .iter()
            .fold(0.0_f64, |m, x| m.max(x.abs()));
        assert_eq!(largest, 1.0);
        // the ramps of 4 s widen the band by about their inverse
        assert!(power_between(&unit.displacement, 0.2, 3.1) > 0.9999);
        // 270 independent lines in either half of the band: their share scatters by 1/sqrt(1080) = 3 %
        let low = power_between(&unit.displacement, 0.3, 1.65);
        assert!((low - 0.5).abs() < 0.1, "{low}");
        assert_eq!(noise(1).displacement, unit.displacement);
        assert_ne!(noise(2).displacement, unit.displacement);
    }

    #[test]
    fn a_multi_sine_moves_at_its_frequencies_at_once() {
        let motion = TrainingMotion::MultiSine { duration_s: 100.0 };
        let unit = UnitMotion::broadband(&motion, &[0.5, 1.1, 2.0], TIMING, 3);
        for f in [0.5, 1.1, 2.0] {
            let share = power_between(&unit.displacement, f - 0.2, f + 0.2);
            // equal amplitudes: a third each
            assert!((share - 1.0 / 3.0).abs() < 1e-3, "{f}: {share}");
        }
    }

    /// Central differences of a sampled motion, (2.5 Hz)⁴ h²/6 off; and a delay of whole samples.
    #[test]
    fn rates_and_delays_are_those_of_the_motion() {
        let motion = TrainingMotion::WhiteNoise {
            min_hz: 0.3,
            max_hz: 2.5,
            duration_s: 60.0,
        };
        let fine = Timing {
            sampling_hz: 2000.0,
            ..TIMING
        };
        let unit = UnitMotion::broadband(&motion, &[], fine, 4);
        let size = |x: &[f64]| x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for (x, rate) in [
            (&unit.displacement, &unit.velocity),
            (&unit.velocity, &unit.acceleration),
        ] {
            let most = 2e-5 * size(rate);
            for k in 1..x.len() - 1 {
                let difference = (x[k + 1] - x[k - 1]) * 1000.0;
                assert!((difference - rate[k]).abs() < most, "{k}");
            }
        }
        let delay_s = 0.03;
        let late = UnitMotion::broadband(&motion, &[], Timing { delay_s, ..fine }, 4);
        for k in 60..unit.displacement.len() {
            // rounding of tens of thousands of products
            assert!((late.displacement[k] - unit.displacement[k - 60]).abs() < 1e-9);
        }
    }

    #[test]
    fn impossible_motions_are_refused() {
        let message = |motion: TrainingMotion| motion.validate(TIMING).unwrap_err().to_string();
        let noise = |min_hz, max_hz, duration_s| TrainingMotion::WhiteNoise {
            min_hz,
            max_hz,
            duration_s,
        };
        assert!(message(noise(0.0, 1.0, 60.0)).starts_with("motion.min_hz"));
        assert!(message(noise(1.0, 1.0, 60.0)).starts_with("motion.max_hz"));
        assert!(message(noise(1.0, 41.0, 60.0)).contains("(40 Hz), found 41"));
        assert!(message(noise(1.0, 2.0, 7.0)).contains("at least two ramps (8 s)"));
        let endless = TrainingMotion::MultiSine {
            duration_s: f64::INFINITY,
        };
        assert!(message(endless).starts_with("motion.duration_s"));
        let text = r#"{ "kind": "harmonic", "duration_s": 60.0 }"#;
        let other = serde_json::from_str::<TrainingMotion>(text).unwrap_err();
        assert!(other.to_string().contains("unknown field `duration_s`"));
    }
}
