//! Stretches or segments of records as independent blocks, with working variances.
//!
//! A segment is cut into stretches much longer than the memory of turbulence, so that noise is independent from one
//! to the next. What the model cannot follow is not: it repeats through the whole segment. The sum of the squares of
//! the segments' contributions to the errors is then more than that of the stretches', and whole segments are the
//! blocks.
//!
//! The working variances only tell how the small-sample correction shares its weight; the covariance is unbiased to
//! first order whatever they are. They follow a power of the motion's frequency, as the spectrum of turbulence or
//! white noise does, with a level of its own for every record, fitted to the residuals in the span of the columns.

use super::design::{Block, Design};
use crate::error::Result;
use crate::identification::samples::unit_scale;
use crate::identification::time::pass::Stretch;
use nalgebra::DMatrix;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Steepest spectrum believed: steeper ones come from chance or from lack of fit.
const STEEPEST: f64 = 4.0;

/// Contributions of segments may exceed those of their stretches by this factor before whole segments are the blocks;
/// by chance alone it stays below (its scatter is about 0.15 with 32 segments).
const COHERENT: f64 = 1.5;

/// The sandwich over stretches, or over segments where residuals repeat through them; and which, in words. The forces of
/// every stretch are stacked, each relative to its size over all stretches, as the search of poles weighs them.
pub(super) fn sandwich(
    mut parts: Vec<StretchRows<'_>>,
    tangent: DMatrix<f64>,
) -> Result<(Design, String)> {
    weigh(&mut parts);
    let mut stretches: BTreeMap<(usize, usize), Vec<StretchRows<'_>>> = BTreeMap::new();
    for part in parts {
        let stretch = stretches.entry((part.of.record, part.of.stretch));
        stretch.or_default().push(part);
    }
    // the blocks, the key of the segment of each, and the names of the segments
    let (mut blocks, mut segments, mut names) = (Vec::new(), Vec::new(), Vec::new());
    let mut keys: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for members in stretches.into_values() {
        let (of, rate) = (members[0].of, members[0].rate);
        let of_segment = match of.frequency_hz {
            Some(f) => format!("{}, {f:.2} Hz", members[0].name),
            None => format!("{}, stretch {}", members[0].name, of.stretch + 1),
        };
        let name = match of.frequency_hz {
            Some(_) => format!("{of_segment}, stretch {}", of.stretch + 1),
            None => of_segment.clone(),
        };
        let key = keys.entry((of.record, of.segment.unwrap_or(of.stretch)));
        segments.push(*key.or_insert_with(|| {
            names.push(of_segment);
            names.len() - 1
        }));
        let of_forces: Vec<Block> = members.into_iter().map(|part| part.block).collect();
        blocks.push(Block {
            speed_m_s: Some(of.mean_speed_m_s),
            k: of.frequency_hz.map(|f| TAU * f / rate),
            ..Block::joined(name, &of_forces)
        });
    }
    let fine = Design::new(blocks, tangent.clone())?;
    let ratio = fine.coherence(&segments);
    let either = "residuals may be correlated in any way within a block and between its forces; sandwich of the blocks \
                  with the small-sample correction CR2";
    if ratio <= COHERENT {
        let text = format!(
            "{either}; blocks are stretches of segments, since nothing repeats through whole segments (ratio {ratio:.2})"
        );
        return Ok((fine, text));
    }
    let text = format!(
        "{either}; blocks are whole segments, since residuals repeat through them (ratio {ratio:.2}): what the model \
         cannot follow counts as scatter from segment to segment"
    );
    Ok((Design::new(fine.merged(&segments, names), tangent)?, text))
}

/// Rows of one force in one stretch of a record.
pub(super) struct StretchRows<'a> {
    pub of: &'a Stretch,
    /// Name of the record, and its `V/B`, 1/s.
    pub name: &'a str,
    pub rate: f64,
    pub force: usize,
    /// Weighted as the force is in that stretch; its variance is still to be set.
    pub block: Block,
    /// Sum of squares of the data, weighted as well.
    pub total: f64,
}

/// Gives the rows of all parts their weight and their working variance: equations of one group share their scale.
fn weigh<'a>(parts: &mut [StretchRows<'a>]) {
    // inputs that moved, and force: equations that share their scale
    let mut groups: BTreeMap<(&'a [usize], usize), Vec<usize>> = BTreeMap::new();
    for (at, part) in parts.iter().enumerate() {
        let group = groups.entry((&part.of.set, part.force));
        group.or_default().push(at);
    }
    for members in groups.values() {
        let own: Vec<&StretchRows<'_>> = members.iter().map(|&m| &parts[m]).collect();
        let total: f64 = own.iter().map(|part| part.total).sum();
        let scale = unit_scale(total);
        for (&m, variance) in members.iter().zip(working_variances(&own)) {
            let block = &mut parts[m].block;
            block.rows *= scale;
            block.residual *= scale;
            // forces that are zero throughout tell nothing of the errors of the others
            let told = f64::from(u8::from(total > 0.0));
            block.variance.fill(told * variance * scale * scale);
        }
    }
}

/// Weighted variance of one row in each part: `w² e^(a + γ ln f)`, with a level `a` a record and one `γ`, by least
/// squares on the logarithms.
fn working_variances(parts: &[&StretchRows<'_>]) -> Vec<f64> {
    let squares = parts.iter().map(|p| p.block.residual.norm_squared());
    let floor = 1e-12 * squares.fold(0.0, f64::max);
    if floor <= 0.0 {
        // a fit without residuals has no scale; only relative sizes matter
        return vec![1.0; parts.len()];
    }
    let point = |p: &&StretchRows<'_>| {
        let (hz, residual) = (p.of.frequency_hz.unwrap_or(1.0), &p.block.residual);
        let mean_square = residual.norm_squared().max(floor) / residual.len() as f64;
        let weight = p.of.weights[p.force];
        (p.of.record, hz.ln(), (mean_square / weight.powi(2)).ln())
    };
    let points: Vec<(usize, f64, f64)> = parts.iter().map(point).collect();
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
    let slope = match squares > 0.0 {
        true => (products / squares).clamp(-STEEPEST, STEEPEST),
        false => 0.0,
    };
    let variance = |((record, x, _), part): (&(usize, f64, f64), &&StretchRows<'_>)| {
        let (mx, my) = mean(record);
        part.of.weights[part.force].powi(2) * (my + slope * (x - mx)).exp()
    };
    points.iter().zip(parts).map(variance).collect()
}
