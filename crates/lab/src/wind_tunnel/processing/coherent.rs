//! What of a force follows the motion, and what drifts: one robust regression over a whole recording.
//!
//! `f(t) ≈ Σ_j b_j T_j(t) + Σ_s w_s(t) [α_s x + β_s ẋ]` with Chebyshev polynomials over the recording, the motion and its rate,
//! and `w_s` one in segment s and zero elsewhere. Without segments the motion has one pair for all. The pair is equation (1.14)
//! at the frequency of the segment; drift and motion are fitted together, so that neither takes what is the other's.

use super::signals::HarmonicSegment;
use crate::error::{Error, Result};
use crate::signal::largest_magnitude;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Regressors of one recording.
pub(crate) struct Regressors {
    degree: usize,
    count: usize,
    motion: Vec<f64>,
    rate: Vec<f64>,
    /// Samples of each segment.
    pub stretches: Vec<Range<usize>>,
}

/// The two parts of a force.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Parts {
    /// Follows the motion.
    pub coherent: Vec<f64>,
    /// Drifts.
    pub drift: Vec<f64>,
}

impl Regressors {
    /// For a motion of any scale.
    pub(crate) fn new(
        motion: &[f64],
        sampling_hz: f64,
        segments: &[HarmonicSegment],
        degree: usize,
    ) -> Self {
        let scaled = |x: Vec<f64>| {
            let size = largest_magnitude(&x);
            let factor = if size > 0.0 { 1.0 / size } else { 0.0 };
            x.into_iter().map(|v| v * factor).collect::<Vec<f64>>()
        };
        let count = motion.len();
        let stretches = segments.iter().map(|s| s.range(sampling_hz, count));
        let mut stretches: Vec<Range<usize>> = stretches.collect();
        if stretches.is_empty() {
            stretches.push(0..count);
        }
        Self {
            degree,
            count,
            motion: scaled(motion.to_vec()),
            rate: scaled(crate::signal::rate(motion, sampling_hz)),
            stretches,
        }
    }

    /// Least squares over the samples that are no `outliers`.
    pub(crate) fn fit(&self, force: &[f64], outliers: &[bool]) -> Result<Parts> {
        let smooth = self.degree + 1;
        let unknowns = smooth + 2 * self.stretches.len();
        let mut gram = DMatrix::<f64>::zeros(unknowns, unknowns);
        let mut moments = DVector::<f64>::zeros(unknowns);
        let mut entries: Vec<(usize, f64)> = Vec::with_capacity(unknowns);
        for k in (0..self.count).filter(|k| !outliers[*k]) {
            self.row(k, &mut entries);
            for (n, (i, a)) in entries.iter().enumerate() {
                // the lower triangle, which is all that the factorisation reads
                for (j, b) in &entries[..=n] {
                    gram[(*i, *j)] += a * b;
                }
                moments[*i] += a * force[k];
            }
        }
        // a segment without motion, or with no sample left, leaves its pair at zero
        for i in 0..unknowns {
            if gram[(i, i)] < 1e-9 {
                gram[(i, i)] += 1.0;
            }
        }
        let solution: DVector<f64> =
            gram.cholesky().map(|c| c.solve(&moments)).ok_or_else(|| {
                Error::Numerical("drift: too few samples to tell it from the motion".into())
            })?;
        let mut parts = Parts {
            coherent: vec![0.0; self.count],
            drift: vec![0.0; self.count],
        };
        for k in 0..self.count {
            self.row(k, &mut entries);
            for (i, a) in &entries {
                let part = match *i < smooth {
                    true => &mut parts.drift,
                    false => &mut parts.coherent,
                };
                part[k] += a * solution[*i];
            }
        }
        Ok(parts)
    }

    fn row(&self, k: usize, entries: &mut Vec<(usize, f64)>) {
        entries.clear();
        let t = 2.0 * k as f64 / (self.count.max(2) - 1) as f64 - 1.0;
        let (mut chebyshev, mut next) = (1.0, t);
        for j in 0..=self.degree {
            entries.push((j, chebyshev));
            (chebyshev, next) = (next, 2.0 * t * next - chebyshev);
        }
        for (s, range) in self.stretches.iter().enumerate() {
            if range.contains(&k) {
                let at = self.degree + 1 + 2 * s;
                entries.push((at, self.motion[k]));
                entries.push((at + 1, self.rate[k]));
            }
        }
    }
}
