//! Onsets of samples, and what they amount to.

use super::statistics::sample_quantile;
use crate::signal::mean_and_deviation;
use serde::Serialize;

/// Mean, scatter and interval of the onsets of many samples.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SampledOnsets {
    /// Mean, m/s.
    pub mean_m_s: f64,
    /// Standard deviation, m/s.
    pub standard_deviation_m_s: f64,
    /// 95 % of the samples lie between these, m/s.
    pub interval_m_s: [f64; 2],
    /// Samples without an onset up to the highest wind speed; they are not in the numbers above.
    pub without_onset: usize,
    /// The onset of each sample that has one, m/s, rising.
    #[serde(skip)]
    pub speeds_m_s: Vec<f64>,
}

impl From<Vec<Option<f64>>> for SampledOnsets {
    /// NaN in place of what the onsets are too few for.
    fn from(found: Vec<Option<f64>>) -> Self {
        let mut speeds: Vec<f64> = found.iter().copied().flatten().collect();
        speeds.sort_unstable_by(f64::total_cmp);
        let (mean_m_s, standard_deviation_m_s) = mean_and_deviation(speeds.iter().copied());
        let quantile = |p| sample_quantile(&speeds, speeds.len(), p).unwrap_or(f64::NAN);
        Self {
            mean_m_s,
            standard_deviation_m_s,
            interval_m_s: [0.025, 0.975].map(quantile),
            without_onset: found.len() - speeds.len(),
            speeds_m_s: speeds,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_without_an_onset_are_in_no_other_number() {
        let onsets = SampledOnsets::from(vec![Some(3.0), None, Some(1.0)]);
        assert_eq!(onsets.speeds_m_s, [1.0, 3.0]);
        assert_eq!((onsets.without_onset, onsets.mean_m_s), (1, 2.0));
        assert!((onsets.interval_m_s[0] - 1.05).abs() < 1e-12);
        assert!(SampledOnsets::from(vec![None]).interval_m_s[1].is_nan());
    }
}
