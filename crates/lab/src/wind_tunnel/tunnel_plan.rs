//! The plan of the virtual tunnel: what is moved how, what it must be, and what of it was likely meant otherwise.

use crate::error::{Result, ensure, non_negative, positive};
use crate::files::derivatives::TABLE_3_2_FREQUENCIES_HZ;
use crate::plausibility::{Finding, MOTION_FREQUENCY, SAMPLING, WIND_SPEED, beyond, unusual_air};
use serde::{Deserialize, Serialize};

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
