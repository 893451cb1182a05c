//! Broadband motions for training: all frequencies of a band at once.
//!
//! White noise excites every frequency of its band alike, so that the outputs of orthonormal filters are uncorrelated and
//! their coefficients best determined (thesis, section 2.4); a multi-sine puts all its power into chosen frequencies. Both
//! start and end at rest with the ramps of the harmonic motions, and never exceed the amplitude of the plan.

use super::records::Record;
use super::tunnel_plan::{TrainingMotion, TunnelPlan, UnitMotion, window};
use crate::aerodynamics::derivatives::{
    DerivativeTable, Extrapolation, InterpolatedTable, Interpolation,
};
use crate::error::{Result, ensure};
use crate::section::Dof;
use crate::signal::{largest_magnitude, random_stream};
use nalgebra::Complex;
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;

/// Stream of the random numbers that make a motion; the noise of the forces draws from others.
const MOTION_STREAM: u64 = u64::MAX;

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

    /// The motion at unit amplitude, `delay_s` late: harmonic motions of the given frequencies; of broadband ones rest, then a motion
    /// of at most 1 in size.
    pub(super) fn unit_motion(&self, frequencies_hz: &[f64], delay_s: f64) -> UnitMotion {
        let Some(duration_s) = self.motion.duration_s() else {
            return UnitMotion::harmonic(frequencies_hz, self, delay_s);
        };
        let lines = self.lines();
        let on_time = self.run_of_lines(&lines, duration_s, 0.0);
        let largest = largest_magnitude(&on_time[0]);
        let scale = if largest > 0.0 { 1.0 / largest } else { 1.0 };
        let mut run = self.run_of_lines(&lines, duration_s, delay_s);
        run.iter_mut().flatten().for_each(|x| *x *= scale);
        let [displacement, velocity, acceleration] = run;
        UnitMotion {
            segments: Vec::new(),
            segment_of: vec![None; displacement.len()],
            displacement,
            velocity,
            acceleration,
        }
    }

    /// The steady motion as a sum of sines: circular frequency (rad/s) and complex amplitude, `Re Σ z e^{iωt}`; none of harmonic motions.
    fn lines(&self) -> Vec<(f64, Complex<f64>)> {
        let mut random = random_stream(self.seed, MOTION_STREAM);
        match self.motion {
            TrainingMotion::Harmonic {} => Vec::new(),
            TrainingMotion::MultiSine { .. } => {
                let sine = |f: &f64| {
                    let phase = TAU * random.random::<f64>();
                    (TAU * f, Complex::from_polar(1.0, phase))
                };
                self.frequencies_hz.iter().map(sine).collect()
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
                bins.map(line).collect()
            }
        }
    }

    /// Displacement, velocity (1/s) and acceleration (1/s²) of the whole run under its window.
    fn run_of_lines(
        &self,
        lines: &[(f64, Complex<f64>)],
        duration_s: f64,
        delay_s: f64,
    ) -> [Vec<f64>; 3] {
        let rate = self.sampling_hz;
        let count = ((self.still_s + duration_s) * rate).round() as usize;
        let start = self.still_s + delay_s;
        let first = (start * rate).ceil() as usize;
        let t_first = first as f64 / rate - start;
        // e^{iωt} from sample to sample by one product
        let line = |(omega, z): &(f64, Complex<f64>)| {
            let at = z * Complex::from_polar(1.0, omega * t_first);
            (*omega, at, Complex::from_polar(1.0, omega / rate))
        };
        let mut lines: Vec<_> = lines.iter().map(line).collect();
        let mut run: [Vec<f64>; 3] = std::array::from_fn(|_| vec![0.0; first.min(count)]);
        for sample in first..count {
            let t = sample as f64 / rate - start;
            let (mut x, mut v, mut a) = (0.0, 0.0, 0.0);
            for (omega, z, turn) in &mut lines {
                x += z.re;
                v -= *omega * z.im;
                a -= *omega * *omega * z.re;
                *z *= *turn;
            }
            let [w, w1, w2] = window(t, duration_s, self.ramp_s);
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

    /// Rest of 8 s, ramps of 4 s, 200 Hz.
    fn plan(motion: TrainingMotion, seed: u64) -> TunnelPlan {
        TunnelPlan {
            motion,
            seed,
            ..TunnelPlan::default()
        }
    }

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
        let plan = plan(motion, seed);
        plan.check_motion().unwrap();
        plan.unit_motion(&[], 0.0)
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
        let mut plan = plan(motion, 3);
        plan.frequencies_hz = vec![0.5, 1.1, 2.0];
        let unit = plan.unit_motion(&[], 0.0);
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
        let fine = TunnelPlan {
            sampling_hz: 2000.0,
            ..plan(motion, 4)
        };
        let unit = fine.unit_motion(&[], 0.0);
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
        let late = fine.unit_motion(&[], delay_s);
        for k in 60..unit.displacement.len() {
            // rounding of tens of thousands of products
            assert!((late.displacement[k] - unit.displacement[k - 60]).abs() < 1e-9);
        }
    }

    #[test]
    fn impossible_motions_are_refused() {
        let message = |motion| plan(motion, 1).check_motion().unwrap_err().to_string();
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
