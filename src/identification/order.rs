//! How many filters: the error on what a fit has not seen.
//!
//! One mean speed or one frequency of motion is left out at a time, but not the lowest and highest frequency: beyond the
//! tested range no number of filters is right. Transfer functions scatter differently: each counts by the ratio of its
//! errors, so that the score is the geometric mean over them, as in the search of poles under constraints.

use super::report::{LEAST_NOISE, OrderReport};
use std::collections::BTreeMap;

/// Mean speeds or frequencies less than this ratio apart are one.
const SAME: f64 = 1.05;
/// Of scores that are no more than this above the least the one with the fewest filters is taken: less than what another
/// table of the same deck would change.
const NO_WORSE: f64 = 1.02;

/// What is left out together: places of tests with their mean speed and frequency of motion.
pub(crate) fn folds(tests: &[(Option<f64>, Option<f64>)]) -> Vec<Vec<usize>> {
    let speeds = groups(tests.iter().map(|t| t.0));
    let mut frequencies = groups(tests.iter().map(|t| t.1));
    if frequencies.len() > 3 {
        frequencies.pop();
        frequencies.remove(0);
    }
    let several = |g: Vec<Vec<usize>>| if g.len() > 1 { g } else { Vec::new() };
    [several(speeds), several(frequencies)].concat()
}

/// Places of one value, by rising value.
fn groups(values: impl Iterator<Item = Option<f64>>) -> Vec<Vec<usize>> {
    let mut known: Vec<(f64, usize)> = values
        .enumerate()
        .filter_map(|(at, value)| Some((value?, at)))
        .collect();
    known.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut groups: Vec<(f64, Vec<usize>)> = Vec::new();
    for (x, at) in known {
        match groups.last_mut() {
            Some((first, members)) if x < *first * SAME => members.push(at),
            _ => groups.push((x, vec![at])),
        }
    }
    groups.into_iter().map(|(_, members)| members).collect()
}

/// Errors of one number of filters on what was left out.
#[derive(Debug, Default)]
pub(crate) struct HeldOut {
    /// Sums of the squares of residuals and of data for each transfer function, fold by fold.
    sums: BTreeMap<usize, Vec<(f64, f64)>>,
}

impl HeldOut {
    /// Adds what one fold says of a transfer function.
    pub(crate) fn add(&mut self, entry: usize, residual: f64, total: f64) {
        if total > 0.0 {
            self.sums.entry(entry).or_default().push((residual, total));
        }
    }

    /// Geometric mean over the transfer functions of their relative errors; `None` where nothing could be left out.
    pub(crate) fn score(&self) -> Option<f64> {
        let mut logarithms = 0.0;
        for folds in self.sums.values() {
            let sum = |part: fn(&(f64, f64)) -> f64| folds.iter().map(part).sum::<f64>();
            let relative = sum(|f| f.0) / sum(|f| f.1);
            logarithms += (relative + LEAST_NOISE * LEAST_NOISE).ln();
        }
        let score = (0.5 * logarithms / self.sums.len() as f64).exp();
        score.is_finite().then_some(score)
    }
}

/// Which of the numbers of filters is taken; the first where none was scored.
pub(crate) fn fewest(orders: &[OrderReport]) -> usize {
    let scored = |o: &OrderReport| o.left_out.unwrap_or(f64::INFINITY);
    let least = orders.iter().map(scored).fold(f64::INFINITY, f64::min);
    let good = orders.iter().position(|o| scored(o) <= NO_WORSE * least);
    good.unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folds_are_speeds_and_inner_frequencies() {
        let tests: Vec<_> = [8.0, 8.1, 4.0, 4.0]
            .iter()
            .flat_map(|v| [0.5, 1.0, 1.5, 2.0].map(|f| (Some(*v), Some(f))))
            .collect();
        let found = folds(&tests);
        let expected = [
            (8..16).collect::<Vec<_>>(),
            (0..8).collect(),
            vec![1, 5, 9, 13],
            vec![2, 6, 10, 14],
        ];
        assert_eq!(found, expected);
        assert!(folds(&[(None, None), (Some(8.0), Some(1.0))]).is_empty());
    }

    #[test]
    fn the_fewest_of_equally_good_numbers_is_taken() {
        let order = |filters, left_out| OrderReport {
            filters,
            objective: 0.1,
            left_out,
        };
        let orders = [
            order(3, Some(0.2)),
            order(4, Some(0.101)),
            order(5, Some(0.1)),
            order(6, None),
        ];
        assert_eq!(fewest(&orders), 1);
        assert_eq!(fewest(&orders[3..]), 0);
        let mut errors = HeldOut::default();
        assert_eq!(errors.score(), None);
        errors.add(0, 0.04, 1.0);
        errors.add(1, 0.01, 4.0);
        // 0.2 and 0.05, each with the noise that any measurement has
        let expected = ((0.04_f64 + 1e-4) * (0.0025 + 1e-4)).powf(0.25);
        assert!((errors.score().unwrap() - expected).abs() < 1e-15);
    }
}
