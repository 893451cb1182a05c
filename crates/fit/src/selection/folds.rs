//! Cross-validation across speeds and across frequencies of motion.

use crate::error::Result;
use crate::identification::{CellFit, Grid, StretchLabel};
use crate::signal::mean;
use serde::Serialize;
use std::collections::BTreeMap;

/// Mean speeds or frequencies less than this ratio apart are one.
const SAME: f64 = 1.05;

/// Error of a cell on data it was not fitted to, relative to the data (root mean square).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CrossValidation {
    /// One mean speed left out at a time; `None` with a single speed.
    pub across_speeds: Option<f64>,
    /// One frequency of motion left out at a time; `None` with a single frequency.
    pub across_frequencies: Option<f64>,
    /// Root mean square of both: what cells are compared by.
    pub score: f64,
    /// Standard error of the square of the score, from its scatter over what was left out.
    pub standard_error_of_square: f64,
}

/// Stretches that are left out together.
pub(super) struct Folds {
    speeds: Vec<Vec<usize>>,
    frequencies: Vec<Vec<usize>>,
}

impl Folds {
    pub(crate) fn new(labels: &[StretchLabel]) -> Self {
        Self {
            speeds: groups(labels, |l| Some(l.mean_speed_m_s)),
            frequencies: groups(labels, |l| l.frequency_hz),
        }
    }

    /// All numbers of filters of one value of the axis; `None` where a fit without a fold fails or nothing can be left
    /// out.
    pub(crate) fn validate(&self, grid: &Grid, value: usize) -> Vec<Option<CrossValidation>> {
        // none of a fit that failed, of those that did not perhaps nothing to leave out
        let errors = |folds: &[Vec<usize>]| -> Vec<Option<Option<Vec<f64>>>> {
            let mut of_filters = vec![Some(Vec::new()); grid.filters_max];
            if folds.len() < 2 {
                return vec![Some(None); of_filters.len()];
            }
            for fold in folds {
                let fits = grid.fits(value, &|s| !fold.contains(&s));
                for (errors, fit) in of_filters.iter_mut().zip(fits) {
                    match (errors.as_mut(), held_out(grid, value, fold, &fit)) {
                        (Some(list), Some(error)) => list.push(error),
                        _ => *errors = None,
                    }
                }
            }
            of_filters.into_iter().map(|e| e.map(Some)).collect()
        };
        let pairs = errors(&self.speeds)
            .into_iter()
            .zip(errors(&self.frequencies));
        pairs.map(|(s, f)| combine(s?, f?)).collect()
    }
}

/// Mean squared relative error over the transfer functions in the stretches left out.
fn held_out(grid: &Grid, value: usize, fold: &[usize], fit: &Result<CellFit>) -> Option<f64> {
    let fit = fit.as_ref().ok()?;
    let mut sums: BTreeMap<(usize, usize), (f64, f64)> = BTreeMap::new();
    for &stretch in fold {
        let Some(motion) = grid.motion(stretch) else {
            continue;
        };
        let j = grid.dofs.iter().position(|d| *d == motion)?;
        for (i, (residual, total)) in grid.residuals(stretch, value, fit)?.into_iter().enumerate() {
            let sum = sums.entry((i, j)).or_insert((0.0, 0.0));
            *sum = (sum.0 + residual, sum.1 + total);
        }
    }
    let ratios: Vec<f64> = sums
        .values()
        .filter(|(_, total)| *total > 0.0)
        .map(|(residual, total)| residual / total)
        .collect();
    (!ratios.is_empty()).then(|| mean(&ratios))
}

fn combine(speeds: Option<Vec<f64>>, frequencies: Option<Vec<f64>>) -> Option<CrossValidation> {
    let parts: Vec<&Vec<f64>> = speeds.iter().chain(&frequencies).collect();
    if parts.is_empty() {
        return None;
    }
    let count = parts.len() as f64;
    let square = parts.iter().map(|e| mean(e)).sum::<f64>() / count;
    let variance: f64 = parts
        .iter()
        .map(|e| {
            let (m, n) = (mean(e), e.len() as f64);
            e.iter().map(|x| (x - m).powi(2)).sum::<f64>() / (n - 1.0) / n
        })
        .sum();
    Some(CrossValidation {
        across_speeds: speeds.as_ref().map(|e| mean(e).sqrt()),
        across_frequencies: frequencies.as_ref().map(|e| mean(e).sqrt()),
        score: square.sqrt(),
        standard_error_of_square: variance.sqrt() / count,
    })
}

/// Indices of stretches of one value, by rising value.
fn groups(labels: &[StretchLabel], value: fn(&StretchLabel) -> Option<f64>) -> Vec<Vec<usize>> {
    let mut known: Vec<(f64, usize)> = labels
        .iter()
        .enumerate()
        .filter_map(|(s, label)| Some((value(label)?, s)))
        .collect();
    known.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut groups: Vec<(f64, Vec<usize>)> = Vec::new();
    for (x, s) in known {
        match groups.last_mut() {
            Some((first, members)) if x < *first * SAME => members.push(s),
            _ => groups.push((x, vec![s])),
        }
    }
    groups.into_iter().map(|(_, members)| members).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folds_are_speeds_and_frequencies() {
        let label = |v: f64, f: f64| StretchLabel {
            mean_speed_m_s: v,
            frequency_hz: Some(f),
        };
        let labels = [
            label(8.0, 0.5),
            label(8.1, 1.0),
            label(4.0, 0.51),
            label(4.0, 1.01),
        ];
        let folds = Folds::new(&labels);
        assert_eq!(folds.speeds, [vec![2, 3], vec![0, 1]]);
        assert_eq!(folds.frequencies, [vec![0, 2], vec![1, 3]]);
    }

    #[test]
    fn scores_are_means_of_squares() {
        let both = combine(Some(vec![0.01, 0.03]), Some(vec![0.04, 0.04])).unwrap();
        assert!((both.across_speeds.unwrap() - 0.02_f64.sqrt()).abs() < 1e-15);
        assert!((both.score - 0.03_f64.sqrt()).abs() < 1e-15);
        // 0.01 is the standard error of 0.01 and 0.03; the other part has none; half of both
        assert!((both.standard_error_of_square - 0.005).abs() < 1e-15);
        assert!(combine(None, None).is_none());
    }
}
