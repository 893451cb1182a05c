//! What a Monte Carlo analysis gives.

use super::plan::MonteCarloPlan;
use super::scatter::DrawnForces;
use crate::flutter::{SweepOutcome, SweptOnset};
use crate::plausibility::Finding;
use crate::signal::mean_and_deviation;
use crate::uncertainty::statistics::{clopper_pearson, sample_quantile};
use crate::verdict::Verdict;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Failed samples that are named one by one; of more, their number is given.
const NAMED_FAILURES: usize = 20;
/// Bins of the histogram at most.
const MAX_BINS: f64 = 60.0;

/// Distribution of the onset speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MonteCarloResult {
    /// Name of the model.
    pub model: String,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Samples asked for.
    pub samples: usize,
    /// Samples with an onset up to the highest speed.
    pub onsets: usize,
    /// Samples that grow at the lowest speed that could be judged: their onset lies there or below. They fail.
    pub unstable_at_or_below: usize,
    /// Highest of those speeds, m/s.
    pub unstable_up_to_m_s: Option<f64>,
    /// Samples without one, as far as they could be judged.
    pub stable: usize,
    /// Of these, samples with a mode that leaves the tested range of the model below the highest speed: an onset may lie
    /// beyond.
    pub not_judged: usize,
    /// Lowest speed at which one of them does, m/s.
    pub judged_up_to_m_s: Option<f64>,
    /// Samples without an answer, mostly for impossible values.
    pub failed: usize,
    /// The first of them, with the reason.
    pub failures: Vec<FailedSample>,
    /// Onsets outside the tested range of the model: extrapolations.
    pub outside_tested_range: usize,
    /// Samples whose model loses damping below the onset, outside the tested range.
    pub with_spurious_crossings: usize,
    /// Samples that needed the search by eigenvalues.
    pub searched_in_full: usize,
    /// Highest speed searched, m/s.
    pub speed_max_m_s: f64,
    /// Onset of the model itself, m/s; `null` when it has none.
    pub nominal_m_s: Option<f64>,
    /// Whether the onset of the model itself lies at that speed or below.
    pub nominal_or_below: bool,
    /// Mean of the onsets, m/s; of the samples with one (`onsets` of `samples`), the others are left out.
    pub mean_m_s: Option<f64>,
    /// Standard deviation of the onsets, m/s; of the same samples.
    pub standard_deviation_m_s: Option<f64>,
    /// Quantiles of the onset speed; samples without onset count as above the highest speed, those that grow at the
    /// lowest speed that could be judged with that speed; those that failed may flutter anywhere.
    pub quantiles: Vec<Quantile>,
    /// Onsets counted in bins of equal width.
    pub histogram: Histogram,
    /// Probability of an onset below the design speed.
    pub design: Option<DesignCheck>,
    /// How the coefficients of the force model were drawn; none where they are not random.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drawn_forces: Option<DrawnForces>,
    /// What is odd about the distributions: their means as a section, and against that of the model.
    #[serde(default)]
    pub findings: Vec<Finding>,
    /// What the model itself can say of that speed; of whoever holds it with its fit, and so none as [`summarise`](super::summarise) leaves it.
    pub verdict: Option<Verdict>,
}

impl MonteCarloResult {
    /// Of which samples mean and standard deviation are, where not of all.
    pub fn averaged_in_words(&self) -> Option<String> {
        let (some, all) = (self.onsets, self.samples);
        let others = (some < all).then(|| all - some)?;
        Some(format!(
            "of the {some} of {all} samples with an onset up to {:.3} m/s; the other {others} are in neither",
            self.speed_max_m_s
        ))
    }

    /// How many samples have an onset, and what became of the others.
    pub fn counts_in_words(&self) -> String {
        let found = self.onsets + self.unstable_at_or_below;
        let mut words = format!("{found} with an onset up to {:.3} m/s", self.speed_max_m_s);
        for (count, what) in [
            (self.stable - self.not_judged, "without"),
            (self.not_judged, "not judged so far"),
            (self.failed, "failed"),
        ] {
            if count > 0 {
                words.push_str(&format!(", {count} {what}"));
            }
        }
        words
    }
}

/// A sample without an answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FailedSample {
    /// Its number, from 0.
    pub sample: usize,
    /// Why.
    pub reason: String,
}

/// One quantile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Quantile {
    /// Probability of an onset at or below the speed.
    pub probability: f64,
    /// m/s; `null` above the highest speed searched, where it depends on samples that failed or could not be judged so far, and where
    /// the samples are too few to tell.
    pub speed_m_s: Option<f64>,
    /// Ends between which it lies whatever becomes of those samples, m/s; `null` above the highest speed searched, and where the
    /// samples are too few to tell.
    #[serde(default)]
    pub ends_m_s: [Option<f64>; 2],
    /// Whether the quantile is that of samples whose onset lies there or below.
    pub or_below: bool,
    /// Whether fewer than one sample is expected beyond it: samples as few do not tell where it lies.
    #[serde(default)]
    pub too_few_samples: bool,
}

/// Counts in bins of equal width.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Histogram {
    /// Lower end of the first bin, m/s.
    pub from_m_s: f64,
    /// Width of a bin, m/s.
    pub width_m_s: f64,
    /// Onsets in each bin.
    pub counts: Vec<u64>,
}

/// Probability of an onset below the design speed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DesignCheck {
    /// Design speed, m/s.
    pub speed_m_s: f64,
    /// Samples with an onset below it.
    pub below: u64,
    /// Samples that grow at the lowest speed that could be judged, which is not below the design speed, samples that
    /// could not be judged up to it, and those that failed: not counted as safe.
    pub undecided: u64,
    /// Part of all samples that have an onset below the design speed, or may have.
    pub probability: f64,
    /// Lower end of the exact (Clopper–Pearson) confidence interval, of the samples known to lie below.
    pub lower: f64,
    /// Upper end, with the undecided ones.
    pub upper: f64,
    /// Level of the interval, two-sided.
    pub confidence: f64,
}

/// Answers of some samples, to be put together with those of others.
#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    pub(super) onsets: Vec<f64>,
    /// Speeds at which samples grow that could not be judged below.
    pub(super) starts: Vec<f64>,
    /// Speeds up to which samples without an onset could be judged.
    pub(super) stable: Vec<f64>,
    pub(super) failed: usize,
    pub(super) failures: Vec<FailedSample>,
    pub(super) outside: usize,
    pub(super) spurious: usize,
    pub(super) in_full: usize,
}

impl Tally {
    /// Answers of parts that follow one another.
    pub(super) fn joined(parts: Vec<Self>) -> Self {
        let onsets: usize = parts.iter().map(|t| t.onsets.len()).sum();
        let mut parts = parts.into_iter();
        let mut all = parts.next().unwrap_or_default();
        all.onsets.reserve_exact(onsets - all.onsets.len());
        for part in parts {
            all.add(part);
        }
        all
    }

    /// Samples that were drawn.
    pub(super) fn len(&self) -> usize {
        self.onsets.len() + self.starts.len() + self.stable.len() + self.failed
    }

    pub(super) fn onset(&mut self, onset: &SweptOnset) {
        self.onsets.push(onset.speed_m_s);
        self.outside += usize::from(!onset.in_tested_range);
        self.spurious += usize::from(onset.spurious > 0);
    }

    /// A sample whose onset lies at the speed of `start` or below.
    pub(super) fn unstable(&mut self, start: &SweptOnset) {
        self.starts.push(start.speed_m_s);
        self.outside += usize::from(!start.in_tested_range);
    }

    pub(super) fn failure(&mut self, sample: usize, reason: String) {
        self.failed += 1;
        if self.failures.len() < NAMED_FAILURES {
            self.failures.push(FailedSample { sample, reason });
        }
    }

    /// Adds a later run.
    fn add(&mut self, later: Self) {
        self.onsets.extend(later.onsets);
        self.starts.extend(later.starts);
        self.stable.extend(later.stable);
        self.failed += later.failed;
        let room = NAMED_FAILURES - self.failures.len().min(NAMED_FAILURES);
        self.failures.extend(later.failures.into_iter().take(room));
        self.outside += later.outside;
        self.spurious += later.spurious;
        self.in_full += later.in_full;
    }

    pub(super) fn summarise(
        mut self,
        plan: &MonteCarloPlan,
        speed_max_m_s: f64,
        model: &str,
        nominal: SweepOutcome,
    ) -> MonteCarloResult {
        self.onsets.sort_unstable_by(f64::total_cmp);
        self.starts.sort_unstable_by(f64::total_cmp);
        let nominal_or_below = matches!(nominal, SweepOutcome::UnstableAtOrBelow(_));
        let nominal_m_s = nominal.onset().map(|at| at.speed_m_s);
        let drawn = self.len();
        let open = || self.stable.iter().copied().filter(|v| *v < speed_max_m_s);
        let unsafe_speeds = joined(&self.onsets, self.starts.iter().copied());
        // an onset of a sample that was not judged to the end may lie anywhere beyond, of one that failed anywhere
        let failed = std::iter::repeat_n(0.0, self.failed);
        let earliest = joined(&unsafe_speeds, open().chain(failed));
        let (mean, deviation) = mean_and_deviation(self.onsets.iter().copied());
        let quantile = |&probability: &f64| {
            let told = tells(drawn, probability);
            let of = |sorted: &[f64]| sample_quantile(sorted, drawn, probability);
            let ends_m_s = [&earliest, &unsafe_speeds].map(|s| of(s).filter(|_| told));
            // known to lie there or below where it is that of a sample that grows at the lowest speed
            let place = (probability * (drawn.max(1) - 1) as f64).floor() as usize;
            let mut around = unsafe_speeds.iter().skip(place).take(2);
            let start = |v: &f64| self.starts.binary_search_by(|s| s.total_cmp(v)).is_ok();
            Quantile {
                probability,
                speed_m_s: ends_m_s[1].filter(|v| ends_m_s[0] == Some(*v)),
                ends_m_s,
                or_below: told && around.any(start),
                too_few_samples: !told,
            }
        };
        let design_speed = plan.design_speed_m_s.filter(|_| drawn > 0);
        MonteCarloResult {
            model: model.to_owned(),
            seed: plan.seed,
            samples: plan.samples,
            onsets: self.onsets.len(),
            unstable_at_or_below: self.starts.len(),
            unstable_up_to_m_s: self.starts.last().copied(),
            stable: self.stable.len(),
            not_judged: open().count(),
            judged_up_to_m_s: open().reduce(f64::min),
            failed: self.failed,
            outside_tested_range: self.outside,
            with_spurious_crossings: self.spurious,
            searched_in_full: self.in_full,
            speed_max_m_s,
            nominal_m_s,
            nominal_or_below,
            mean_m_s: Some(mean).filter(|_| !self.onsets.is_empty()),
            standard_deviation_m_s: Some(deviation).filter(|_| self.onsets.len() > 1),
            quantiles: plan.quantiles.iter().map(quantile).collect(),
            histogram: histogram(&self.onsets),
            drawn_forces: None,
            findings: Vec::new(),
            verdict: None,
            design: design_speed.map(|speed| design(&self, speed, plan.confidence)),
            failures: self.failures,
        }
    }
}

/// Sorted speeds and others among them; the sorted ones themselves where there are no others, as mostly.
fn joined(sorted: &[f64], others: impl Iterator<Item = f64>) -> Cow<'_, [f64]> {
    let mut others = others.peekable();
    if others.peek().is_none() {
        return Cow::Borrowed(sorted);
    }
    let mut all: Vec<f64> = sorted.iter().copied().chain(others).collect();
    all.sort_unstable_by(f64::total_cmp);
    Cow::Owned(all)
}

/// Whether samples tell a quantile: one of them at least is expected beyond it, for otherwise it is the outermost sample, whatever
/// the probability.
fn tells(drawn: usize, probability: f64) -> bool {
    // 1 − p is rounded: 10 samples tell 0.9
    let one = 1.0 - 1e-9;
    probability.min(1.0 - probability) * drawn as f64 >= one
}

/// Bins of Freedman and Diaconis's width.
fn histogram(sorted: &[f64]) -> Histogram {
    let (Some(low), Some(high)) = (sorted.first(), sorted.last()) else {
        return Histogram::default();
    };
    let range = high - low;
    if range <= 1e-9 * high {
        return Histogram {
            from_m_s: *low,
            width_m_s: range,
            counts: vec![sorted.len() as u64],
        };
    }
    let n = sorted.len();
    let quartiles = sorted[3 * (n - 1) / 4] - sorted[(n - 1) / 4];
    let wished = 2.0 * quartiles / (n as f64).cbrt();
    let bins = (range / wished).ceil().clamp(1.0, MAX_BINS);
    let width = range / bins;
    let mut counts = vec![0; bins as usize];
    for v in sorted {
        let bin = ((v - low) / width) as usize;
        let last = counts.len() - 1;
        counts[bin.min(last)] += 1;
    }
    Histogram {
        from_m_s: *low,
        width_m_s: width,
        counts,
    }
}

fn design(tally: &Tally, speed_m_s: f64, confidence: f64) -> DesignCheck {
    let drawn = tally.len() as u64;
    let known = |sorted: &[f64]| sorted.partition_point(|v| *v < speed_m_s) as u64;
    // at or below a speed that is not above the design speed
    let starts = tally.starts.partition_point(|v| *v <= speed_m_s) as u64;
    let below = known(&tally.onsets) + starts;
    let open = tally.stable.iter().filter(|v| **v < speed_m_s);
    let not_known = open.count() + tally.failed;
    let undecided = tally.starts.len() as u64 - starts + not_known as u64;
    let (lower, _) = clopper_pearson(below, drawn, confidence);
    let (_, upper) = clopper_pearson(below + undecided, drawn, confidence);
    DesignCheck {
        speed_m_s,
        below,
        undecided,
        probability: (below + undecided) as f64 / drawn as f64,
        lower,
        upper,
        confidence,
    }
}
