//! Cross-validation across speeds and across frequencies of motion.

use crate::error::Result;
use crate::identification::{CellFit, Grid};
use crate::signal::mean;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

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

/// Squared relative errors of transfer functions, by the places of force and motion among the degrees of freedom.
type Errors = BTreeMap<(usize, usize), f64>;

/// Errors of a cell fold by fold: across speeds, across frequencies; none where there was nothing to leave out.
pub(super) type HeldOut = [Vec<Errors>; 2];

/// Stretches that are left out together: those of each speed, those of each frequency.
pub(super) fn folds(grid: &Grid) -> [Vec<Vec<usize>>; 2] {
    let stretches = grid.pass.stretches.iter().enumerate();
    let frequencies = stretches.clone().map(|(s, of)| (of.frequency_hz, s));
    let speeds = stretches.map(|(s, of)| (of.mean_speed_m_s, s));
    let known = frequencies.filter_map(|(hertz, s)| Some((hertz?, s)));
    [groups(speeds.collect()), groups(known.collect())]
}

/// Errors of all numbers of filters of one value of the axis across speeds and across frequencies, fold by fold; `None` where a
/// fit without a fold fails or nothing can be left out.
pub(super) fn validate(
    folds: &[Vec<Vec<usize>>; 2],
    grid: &Grid,
    value: usize,
) -> Vec<Option<HeldOut>> {
    let [speeds, frequencies] = folds.each_ref().map(|folds| {
        let mut of_filters = vec![Some(Vec::new()); grid.filters_max];
        for fold in folds.iter().filter(|_| folds.len() > 1) {
            let fits = grid.fits(value, &|s| !fold.contains(&s));
            for (errors, fit) in of_filters.iter_mut().zip(fits) {
                match (errors.as_mut(), held_out(grid, value, fold, &fit)) {
                    (Some(list), Some(error)) => list.push(error),
                    _ => *errors = None,
                }
            }
        }
        of_filters
    });
    let some = |parts: &HeldOut| parts.iter().any(|p| !p.is_empty());
    let pairs = speeds.into_iter().zip(frequencies);
    pairs.map(|(s, f)| Some([s?, f?]).filter(some)).collect()
}

/// Mean squared relative error of each transfer function, by force and motion, in the stretches left out.
fn held_out(grid: &Grid, value: usize, fold: &[usize], fit: &Result<CellFit>) -> Option<Errors> {
    let fit = fit.as_ref().ok()?;
    let mut sums: BTreeMap<(usize, usize), (f64, f64)> = BTreeMap::new();
    for &stretch in fold {
        let Some(&j) = grid.pass.stretches[stretch].set.first() else {
            continue;
        };
        for (i, (residual, total)) in grid.residuals(stretch, value, fit)?.into_iter().enumerate() {
            let sum = sums.entry((i, j)).or_insert((0.0, 0.0));
            *sum = (sum.0 + residual, sum.1 + total);
        }
    }
    sums.retain(|_, (_, total)| *total > 0.0);
    let ratio = |(entry, (residual, total))| (entry, residual / total);
    (!sums.is_empty()).then(|| sums.into_iter().map(ratio).collect())
}

/// Transfer functions that no cell predicts better than a force of zero would, across speeds and across frequencies.
pub(super) fn unpredicted<'a>(
    cells: impl Iterator<Item = &'a HeldOut>,
) -> [BTreeSet<(usize, usize)>; 2] {
    let mut least = [Errors::new(), Errors::new()];
    for cell in cells {
        for (least, folds) in least.iter_mut().zip(cell) {
            let entries: BTreeSet<_> = folds.iter().flat_map(Errors::keys).copied().collect();
            for entry in entries {
                let all = folds.iter().filter_map(|e| e.get(&entry));
                let all: Vec<f64> = all.copied().collect();
                let least = least.entry(entry).or_insert(f64::INFINITY);
                *least = least.min(mean(&all));
            }
        }
    }
    least.map(|mut least| {
        least.retain(|_, error| *error >= 1.0);
        least.into_keys().collect()
    })
}

/// Errors of a cell over the transfer functions that are not left out.
pub(super) fn combine(
    cell: &HeldOut,
    left_out: &[BTreeSet<(usize, usize)>; 2],
) -> Option<CrossValidation> {
    let of_fold = |errors: &Errors, left_out: &BTreeSet<(usize, usize)>| {
        let kept = errors.iter().filter(|(entry, _)| !left_out.contains(entry));
        let kept: Vec<f64> = kept.map(|(_, error)| *error).collect();
        // of a fold with nothing else all
        let all = || errors.values().copied().collect::<Vec<_>>();
        mean(&if kept.is_empty() { all() } else { kept })
    };
    let parts: [Vec<f64>; 2] = std::array::from_fn(|p| {
        let folds = cell[p].iter();
        folds.map(|errors| of_fold(errors, &left_out[p])).collect()
    });
    let used = || parts.iter().filter(|part| !part.is_empty());
    let count = used().count() as f64;
    let square = used().map(|e| mean(e)).sum::<f64>() / count;
    let of_mean = |e: &Vec<f64>| {
        let (m, n) = (mean(e), e.len() as f64);
        e.iter().map(|x| (x - m).powi(2)).sum::<f64>() / (n - 1.0) / n
    };
    let variance: f64 = used().map(of_mean).sum();
    let root = |part: &Vec<f64>| (!part.is_empty()).then(|| mean(part).sqrt());
    (count > 0.0).then(|| CrossValidation {
        across_speeds: root(&parts[0]),
        across_frequencies: root(&parts[1]),
        score: square.sqrt(),
        standard_error_of_square: variance.sqrt() / count,
    })
}

/// Indices of stretches of one value, by rising value.
fn groups(mut known: Vec<(f64, usize)>) -> Vec<Vec<usize>> {
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
        let speeds = groups(vec![(8.0, 0), (8.1, 1), (4.0, 2), (4.0, 3)]);
        assert_eq!(speeds, [vec![2, 3], vec![0, 1]]);
        let frequencies = groups(vec![(0.5, 0), (1.0, 1), (0.51, 2), (1.01, 3)]);
        assert_eq!(frequencies, [vec![0, 2], vec![1, 3]]);
    }

    #[test]
    fn scores_are_means_of_squares() {
        let of = |error: f64| Errors::from([((0, 0), error)]);
        let part = |errors: [f64; 2]| errors.map(of).to_vec();
        let none = [BTreeSet::new(), BTreeSet::new()];
        let both = combine(&[part([0.01, 0.03]), part([0.04, 0.04])], &none).unwrap();
        assert!((both.across_speeds.unwrap() - 0.02_f64.sqrt()).abs() < 1e-15);
        assert!((both.score - 0.03_f64.sqrt()).abs() < 1e-15);
        // 0.01 is the standard error of 0.01 and 0.03; the other part has none; half of both
        assert!((both.standard_error_of_square - 0.005).abs() < 1e-15);
        assert!(combine(&[Vec::new(), Vec::new()], &none).is_none());
    }

    /// What is worse than nothing in every cell across speeds is left out there, and there alone; a fold of it alone keeps it.
    #[test]
    fn what_no_cell_predicts_decides_nothing() {
        let of = |good: f64, bad: f64| Errors::from([((0, 0), good), ((1, 1), bad)]);
        let alone = Errors::from([((1, 1), 3.0)]);
        let cell = |bad| [vec![of(0.01, bad), alone.clone()], vec![of(0.01, 0.5)]];
        let cells = [cell(1.5), cell(7.0)];
        let left_out = unpredicted(cells.iter());
        assert_eq!(left_out, [BTreeSet::from([(1, 1)]), BTreeSet::new()]);
        let errors = combine(&cells[0], &left_out).unwrap();
        assert!((errors.across_speeds.unwrap() - 1.505_f64.sqrt()).abs() < 1e-15);
        assert!((errors.across_frequencies.unwrap() - 0.255_f64.sqrt()).abs() < 1e-15);
    }
}
