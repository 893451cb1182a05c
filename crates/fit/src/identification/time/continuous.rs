//! Passes over records with the columns of continuous filters.

use super::filters::ContinuousColumns;
use super::low_pass::NOISE_BANDWIDTH;
use super::pass::{ColumnOrder, Pass, PassPlan, pass_over};
use super::record::{DimensionlessRecord, Records};
use crate::error::{Result, ensure};
use crate::identification::basis::Basis;
use crate::identification::options::TimeFit;
use crate::identification::own::StaticTerm;
use crate::numbered::OnDone;

/// Default cut-off of the low-pass over the sampling frequency.
const CUTOFF_OVER_SAMPLING: f64 = 1.0 / 20.0;

/// What stays the same over all passes of a fit.
pub(crate) struct RecordFit<'a> {
    pub fit: &'a TimeFit,
    pub records: &'a Records,
    pub progress: OnDone<'a>,
}

/// A chain made as long as the longest of a pass (see [`RecordFit::pass`]); its first filters stay what they are.
pub(crate) fn padded(chain: &[f64], longest: usize) -> Vec<f64> {
    let last = chain.last().copied().unwrap_or(1.0);
    let mut padded = chain.to_vec();
    padded.resize(longest, last);
    padded
}

impl RecordFit<'_> {
    /// One pass with the given candidates, a basis for each input, all of one length; `number` of so many passes, with a row every
    /// `stride` samples and every segment cut into `stretches` as in [`PassPlan`].
    pub(crate) fn pass(
        &self,
        bases: &[Vec<Basis>],
        stride: usize,
        stretches: usize,
        number: usize,
        passes: usize,
    ) -> Result<Pass> {
        let constant = self.fit.static_term == StaticTerm::Estimated;
        let plan = PassPlan {
            order: ColumnOrder {
                inputs: self.records.dofs.len(),
                per_input: bases.first().map_or(0, |b| b[0].len()),
                constant,
            },
            weights: self.fit.weights,
            delta_s: None,
            discard_s: self.fit.discard_s,
            stride,
            stretches,
            number: (number, passes),
        };
        pass_over(&self.records.each, &plan, self.progress, |record| {
            self.check_low_pass(record)?;
            ContinuousColumns::new(record, bases, self.cutoff_hz(record), constant)
        })
    }

    /// A cut-off that is stated leaves all frequencies of motion.
    fn check_low_pass(&self, record: &DimensionlessRecord) -> Result<()> {
        let header = &record.header;
        let tested = header.segments.iter().map(|s| s.frequency_hz);
        let highest = tested.fold(0.0, f64::max);
        let stated = self.fit.low_pass_hz.unwrap_or(f64::INFINITY);
        let expected = format_args!(
            "more than the frequencies of motion of record {}, up to {highest} Hz",
            header.name
        );
        ensure(stated > highest, "low_pass_hz", expected, stated)
    }

    /// Cut-off of the low-pass, Hz.
    fn cutoff_hz(&self, record: &DimensionlessRecord) -> f64 {
        let default = CUTOFF_OVER_SAMPLING / record.step_s;
        self.fit.low_pass_hz.unwrap_or(default)
    }

    /// Every how many samples a row is enough: four rows per period of the cut-off still hold what the low-pass lets
    /// through.
    pub(crate) fn thinning(&self) -> usize {
        let stride = |r: &DimensionlessRecord| (0.25 / (self.cutoff_hz(r) * r.step_s)) as usize;
        let strides = self.records.each.iter().map(stride);
        strides.min().unwrap_or(1).max(1)
    }

    /// Variance of the noise before the low-pass over that of the residuals behind it.
    pub(crate) fn noise_ratio(&self) -> f64 {
        let passed = |r: &DimensionlessRecord| 2.0 * NOISE_BANDWIDTH * self.cutoff_hz(r) * r.step_s;
        let all = self.records.each.iter().map(passed);
        1.0 / all.fold(0.0, f64::max).min(1.0)
    }
}
