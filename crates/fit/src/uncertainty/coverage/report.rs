//! What the repetitions of a virtual campaign came to.

use super::plan::CoveragePlan;
use crate::uncertainty::onset::CONFIDENCE;
use crate::uncertainty::statistics::clopper_pearson;
use serde::Serialize;

/// Shares of held truths with which 95 % intervals count as reliable, percent.
const KEPT_PERCENT: std::ops::RangeInclusive<f64> = 93.0..=97.0;
/// Share that they promise.
const PROMISED: f64 = 0.95;

/// How often intervals held the truth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct IntervalCoverage {
    /// Intervals that held it.
    pub inside: usize,
    /// All intervals.
    pub of: usize,
    /// Their ratio, percent.
    pub percent: f64,
}

impl IntervalCoverage {
    pub(in crate::uncertainty) fn count(verdicts: impl Iterator<Item = bool>) -> Self {
        let (inside, of) =
            verdicts.fold((0, 0), |(inside, of), v| (inside + usize::from(v), of + 1));
        Self {
            inside,
            of,
            percent: 100.0 * inside as f64 / (of as f64).max(1.0),
        }
    }

    /// Whether it is not what 95 % intervals promise, by so many repetitions: another share, and one that chance does not explain (the
    /// exact 95 % interval of the count excludes what is promised). `together` intervals of a repetition hold or miss alike, and
    /// count as one.
    fn contradicts(&self, together: usize) -> bool {
        let [inside, of] = [self.inside, self.of].map(|n| (n as f64 / together as f64).round());
        let (low, high) = clopper_pearson(inside as u64, of as u64, CONFIDENCE);
        !KEPT_PERCENT.contains(&self.percent) && !(low..=high).contains(&PROMISED)
    }
}

/// What the repetitions came to; speeds in m/s.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CoverageReport {
    /// What was repeated.
    pub plan: CoveragePlan,
    /// Onset of the truth.
    pub true_onset_m_s: f64,
    /// Onset of the fit to records without noise, minus the truth: what the form of the model cannot follow.
    pub bias_m_s: f64,
    /// Mean of the onsets minus the truth.
    pub mean_error_m_s: f64,
    /// Standard error of that mean.
    pub standard_error_of_mean_m_s: f64,
    /// Standard deviation of the onsets: the scatter from repetition to repetition.
    pub scatter_m_s: f64,
    /// Root mean square of the stated standard errors.
    pub stated_standard_error_m_s: f64,
    /// Mean half width of the stated intervals.
    pub mean_half_width_m_s: f64,
    /// Mean degrees of freedom.
    pub mean_degrees_of_freedom: f64,
    /// Degrees of freedom that the scatter of the stated variances shows, `2 mean²/variance`.
    pub observed_degrees_of_freedom: f64,
    /// Intervals of the onset that hold the true one.
    pub holds_truth: IntervalCoverage,
    /// Intervals of the onset that hold that of the fit without noise: coverage with the bias taken away.
    pub holds_fit_without_noise: IntervalCoverage,
    /// The same as the first for all derivatives at eight `K` over the tested range.
    pub derivatives_hold_truth: IntervalCoverage,
    /// Repetitions in which the speeds differed by more than chance, so that their scatter was counted.
    pub speeds_differ: IntervalCoverage,
    /// Repetitions without an onset.
    pub without_onset: usize,
    /// Warnings about the intervals; empty if they are reliable.
    pub warnings: Vec<String>,
}

impl CoverageReport {
    /// Says where intervals do not hold the truth as often as 95 % promise.
    pub(super) fn judge(&mut self) {
        let biased = self.bias_m_s.abs() > self.scatter_m_s;
        let reason = if biased {
            format!(
                "the form of the model cannot follow the truth (bias {:.3} m/s, scatter {:.3} m/s), and an interval holds \
                 scatter, not bias",
                self.bias_m_s, self.scatter_m_s
            )
        } else {
            "the stated scatter is not that of the repetitions".to_owned()
        };
        let derivatives = self.derivatives_hold_truth;
        let of_each = (derivatives.of / self.holds_truth.of.max(1)).max(1);
        for (what, share, together) in [
            ("the onset", &self.holds_truth, 1),
            ("the derivatives", &derivatives, of_each),
        ] {
            if share.contradicts(together) {
                self.warnings.push(format!(
                    "the 95 % intervals of {what} hold the truth in {:.1} %: {}",
                    share.percent,
                    match (share.percent > 95.0, biased) {
                        (true, true) => "what the form cannot follow counts as scatter",
                        (true, false) => "wider than they need be",
                        (false, _) => &reason,
                    }
                ));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn share(inside: usize, of: usize) -> IntervalCoverage {
        IntervalCoverage::count((0..of).map(|i| i < inside))
    }

    /// What chance explains is no contradiction: 2 of 2 is to be expected of 95 %, as are 18 of 20 (68.3 to 98.8 %, tables); 450 of 500
    /// and all of 500 are not. Derivatives of one repetition say the same once.
    #[test]
    fn few_repetitions_contradict_nothing() {
        for (inside, of, expected) in [
            (2, 2, false),
            (18, 20, false),
            (0, 2, true),
            (450, 500, true),
            (500, 500, true),
        ] {
            assert_eq!(
                share(inside, of).contradicts(1),
                expected,
                "{inside} of {of}"
            );
        }
        assert!(share(128, 128).contradicts(1) && !share(128, 128).contradicts(64));
    }
}
