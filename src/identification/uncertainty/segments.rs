//! Segments of records as independent blocks, with working variances.
//!
//! The working variances only tell how the small-sample correction shares its weight; the covariance is unbiased to
//! first order whatever they are. They follow a power of the motion's frequency, as the spectrum of turbulence or
//! white noise does, with a level of its own for every record, fitted to the residuals in the span of the columns.

use super::design::Block;
use crate::identification::time::slices::Scaled;
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// Steepest spectrum believed: steeper ones come from chance or from lack of fit.
const STEEPEST: f64 = 4.0;

/// Rows of one force in one stretch of a record.
pub(super) struct Part {
    pub record: usize,
    pub stretch: usize,
    /// Inputs that moved, and force: equations that share their scale.
    pub group: (Vec<usize>, usize),
    /// Weight that rows, residual and total already have.
    pub weight: f64,
    pub rows: DMatrix<f64>,
    pub residual: DVector<f64>,
    /// Weighted sum of squares of the data.
    pub total: f64,
}

/// Stacks the forces of every stretch, each relative to its size over all stretches, as the search of poles weighs
/// them.
pub(super) fn gather(records: &[Scaled<'_>], parts: Vec<Part>) -> Vec<Block> {
    let mut groups: BTreeMap<(Vec<usize>, usize), Vec<usize>> = BTreeMap::new();
    for (at, part) in parts.iter().enumerate() {
        groups.entry(part.group.clone()).or_default().push(at);
    }
    let mut scales = vec![1.0; parts.len()];
    let mut variances = vec![1.0; parts.len()];
    for members in groups.values() {
        let total: f64 = members.iter().map(|&m| parts[m].total).sum();
        let scale = if total > 0.0 {
            total.sqrt().recip()
        } else {
            1.0
        };
        let own: Vec<&Part> = members.iter().map(|&m| &parts[m]).collect();
        for (&m, variance) in members.iter().zip(working_variances(records, &own)) {
            scales[m] = scale;
            variances[m] = variance * scale * scale;
        }
    }
    let mut stretches: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
    for (at, part) in parts.iter().enumerate() {
        stretches
            .entry((part.record, part.stretch))
            .or_default()
            .push(at);
    }
    stretches
        .into_iter()
        .map(|((record, stretch), members)| {
            let name = match records[record].segment_hz(stretch) {
                Some(hz) => format!("{}, {hz:.2} Hz", records[record].name()),
                None => format!("{}, stretch {}", records[record].name(), stretch + 1),
            };
            let scaled: Vec<_> = members
                .iter()
                .map(|&m| {
                    let (part, scale) = (&parts[m], scales[m]);
                    (&part.rows * scale, &part.residual * scale, variances[m])
                })
                .collect();
            Block::stacked(name, &scaled)
        })
        .collect()
}

/// Weighted variance of one row in each part: `w² e^(a + γ ln f)`, with a level `a` a record and one `γ`, by least
/// squares on the logarithms.
fn working_variances(records: &[Scaled<'_>], parts: &[&Part]) -> Vec<f64> {
    let floor = 1e-12
        * parts
            .iter()
            .map(|p| p.residual.norm_squared())
            .fold(0.0, f64::max);
    if floor <= 0.0 {
        // a fit without residuals has no scale; only relative sizes matter
        return vec![1.0; parts.len()];
    }
    let points: Vec<(usize, f64, f64)> = parts
        .iter()
        .map(|p| {
            let hz = records[p.record].segment_hz(p.stretch).unwrap_or(1.0);
            let mean_square = p.residual.norm_squared().max(floor) / p.residual.len() as f64;
            (p.record, hz.ln(), (mean_square / p.weight.powi(2)).ln())
        })
        .collect();
    let mut means: BTreeMap<usize, (f64, f64, f64)> = BTreeMap::new();
    for (record, x, y) in &points {
        let sums = means.entry(*record).or_insert((0.0, 0.0, 0.0));
        *sums = (sums.0 + 1.0, sums.1 + x, sums.2 + y);
    }
    let mean = |record: &usize| {
        let (count, x, y) = means[record];
        (x / count, y / count)
    };
    let (mut squares, mut products) = (0.0, 0.0);
    for (record, x, y) in &points {
        let (mx, my) = mean(record);
        squares += (x - mx).powi(2);
        products += (x - mx) * (y - my);
    }
    let slope = if squares > 0.0 {
        (products / squares).clamp(-STEEPEST, STEEPEST)
    } else {
        0.0
    };
    points
        .iter()
        .zip(parts)
        .map(|((record, x, _), part)| {
            let (mx, my) = mean(record);
            part.weight.powi(2) * (my + slope * (x - mx)).exp()
        })
        .collect()
}
