//! What a plan of the virtual tunnel must be, and what of it was likely meant otherwise.

use super::TunnelPlan;
use crate::error::{Error, Result, ensure, non_negative, positive};
use crate::plausibility::{Finding, MOTION_FREQUENCY, SAMPLING, WIND_SPEED, beyond, unusual_air};

/// Faster than any load cell of a wind tunnel is read, Hz.
const MOST_HERTZ: f64 = 1e5;
/// Samples of one record at most: a hundred times those of Table 3.2, in some 500 MB.
const MOST_SAMPLES: f64 = 1e7;
/// Frequencies of motion, and wind speeds, at most.
const MOST_TESTS: usize = 1000;

impl TunnelPlan {
    /// Checks that the plan can be carried out.
    pub fn validate(&self) -> Result<()> {
        for (key, list) in [
            ("frequencies_hz", &self.frequencies_hz),
            ("speeds_m_s", &self.speeds_m_s),
        ] {
            ensure(!list.is_empty(), key, "at least one number", "none")?;
            ensure(
                list.len() <= MOST_TESTS,
                key,
                format_args!("at most {MOST_TESTS} numbers"),
                list.len(),
            )?;
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
        self.motion.validate(self.timing(0.0))?;
        ensure(
            2.0 * self.ramp_s <= self.segment_s,
            "ramp_s",
            format_args!("at most half of segment_s ({} s)", self.segment_s),
            self.ramp_s,
        )?;
        self.check_sampling(&self.frequencies_hz)
    }

    /// Numbers that were likely meant in another unit; the plan can be carried out all the same.
    pub fn findings(&self) -> Vec<Finding> {
        let frequencies = self.frequencies_hz.iter();
        let speeds = self.speeds_m_s.iter();
        frequencies
            .map(|f| beyond("tunnel.frequencies_hz", *f, &MOTION_FREQUENCY))
            .chain(speeds.map(|v| beyond("tunnel.speeds_m_s", *v, &WIND_SPEED)))
            .chain([beyond("tunnel.sampling_hz", self.sampling_hz, &SAMPLING)])
            .chain([unusual_air(
                "tunnel.air_density_kg_m3",
                self.air_density_kg_m3,
            )])
            .flatten()
            .collect()
    }

    /// Refuses plans that no tunnel carries out and no memory holds.
    fn check_size(&self) -> Result<()> {
        positive("sampling_hz", self.sampling_hz)?;
        ensure(
            self.sampling_hz <= MOST_HERTZ,
            "sampling_hz",
            format_args!("at most {MOST_HERTZ} Hz"),
            self.sampling_hz,
        )?;
        let seconds = self.still_s + self.segment_s * self.frequencies_hz.len() as f64;
        let samples = self.sampling_hz * seconds;
        ensure(
            samples <= MOST_SAMPLES,
            "segment_s",
            format_args!("records of at most {MOST_SAMPLES:e} samples"),
            format_args!("{samples:e}: {seconds} s at {} Hz", self.sampling_hz),
        )
    }

    /// A fifth of the sampling frequency leaves room for the ramps' side bands.
    pub(super) fn check_sampling(&self, frequencies_hz: &[f64]) -> Result<()> {
        let limit = 0.2 * self.sampling_hz;
        match frequencies_hz.iter().find(|f| **f > limit) {
            None => Ok(()),
            Some(f) => {
                let expected = format!("at most a fifth of sampling_hz ({limit} Hz)");
                Err(Error::input("frequencies_hz", expected, f.to_string()))
            }
        }
    }
}
