//! Filters on modal coordinates: one bank for each set of poles, or one for all winds of a section.
//!
//! In the wind `r V` the filters of a section run `r` times as fast. A profile of many winds would need as many banks of the
//! same filters, `L` states for every mode each. Their responses differ smoothly: those of Laguerre filters of the geometric
//! mean of the winds, of every pole a few more than before, span them all up to a remainder that falls by the relative width of the
//! range with every filter (winds from 0.9 to 1: 3e-3 with one more, 1.4e-4 with two, 6e-6 with three).

use nalgebra::{Complex, DMatrix, DVector};

/// Remainder over the largest response of a filter up to which one bank stands for those of all winds.
const REMAINDER: f64 = 2e-4;
/// Filters that are added to every pole at most.
const MORE_AT_MOST: usize = 6;
/// Frequencies at which responses are compared, over this range about the poles.
const POINTS: usize = 120;
const REACH: (f64, f64) = (1e-3, 1e2);
/// Poles closer than this, relatively, are one of higher order.
const ONE_POLE: f64 = 1e-9;
/// Singular values below this part of the largest are rounding.
const RANK: f64 = 1e-13;

/// Filters of a section in one wind: `L` for every mode.
#[derive(Debug, Clone)]
pub(super) struct ModalBank {
    /// As the section has them.
    pub(super) a: DMatrix<f64>,
    pub(super) b: DVector<f64>,
    /// How much faster they run in the wind of the bridge.
    pub(super) rate: f64,
    /// What filter `l` of mode `m` does to every mode: column `m`.
    pub(super) outputs: Vec<DMatrix<f64>>,
}

/// As few banks as say the same.
pub(super) fn merged(banks: Vec<ModalBank>) -> Vec<ModalBank> {
    let mut families: Vec<Vec<ModalBank>> = Vec::new();
    for bank in banks {
        let alike = |f: &Vec<ModalBank>| f[0].a == bank.a && f[0].b == bank.b;
        match families.iter().position(alike) {
            Some(known) => families[known].push(bank),
            None => families.push(vec![bank]),
        }
    }
    let one_or_all = |family: Vec<ModalBank>| match common(&family) {
        Some(one) => vec![one],
        None => family,
    };
    families.into_iter().flat_map(one_or_all).collect()
}

/// One bank for filters that differ in their rates alone; `None` where that takes as many states.
fn common(family: &[ModalBank]) -> Option<ModalBank> {
    let (first, filters) = (&family[0], family[0].b.len());
    let poles = poles(&first.a)?;
    let ends =
        |pick: fn(f64, f64) -> f64, from: f64| family.iter().map(|b| b.rate).fold(from, pick);
    let rate = (ends(f64::min, f64::INFINITY) * ends(f64::max, 0.0)).sqrt();
    let slowest = poles.iter().map(|p| p.0).fold(f64::INFINITY, f64::min);
    let fastest = poles.iter().map(|p| p.0).fold(0.0, f64::max);
    let (low, high) = (slowest * rate * REACH.0, fastest * rate * REACH.1);
    let frequencies: Vec<f64> = (0..POINTS)
        .map(|i| low * (high / low).powf(i as f64 / (POINTS - 1) as f64))
        .collect();
    for more in 1..=MORE_AT_MOST {
        let (a, b) = chains(&poles, more);
        if b.len() >= filters * family.len() {
            return None;
        }
        let basis = responses(&a, &b, rate, &frequencies)?;
        let parts = family.iter().map(|bank| {
            let wanted = responses(&bank.a, &bank.b, bank.rate, &frequencies)?;
            parts_of(&wanted, &basis)
        });
        let Some(parts) = parts.collect::<Option<Vec<_>>>() else {
            continue;
        };
        let n = first.outputs[0].nrows();
        let mut outputs = vec![DMatrix::zeros(n, n); b.len()];
        for (bank, parts) in family.iter().zip(&parts) {
            for (j, output) in outputs.iter_mut().enumerate() {
                for (l, old) in bank.outputs.iter().enumerate() {
                    *output += old * parts[(j, l)];
                }
            }
        }
        return Some(ModalBank {
            a,
            b,
            rate,
            outputs,
        });
    }
    None
}

/// The decays of filters that feed one another forwards, and how often each occurs; `None` for others.
fn poles(a: &DMatrix<f64>) -> Option<Vec<(f64, usize)>> {
    let mut found: Vec<(f64, usize)> = Vec::new();
    for i in 0..a.nrows() {
        let pole = -a[(i, i)];
        if pole <= 0.0 || (i + 1..a.ncols()).any(|j| a[(i, j)] != 0.0) {
            return None;
        }
        match found
            .iter_mut()
            .find(|p| (p.0 - pole).abs() <= ONE_POLE * pole)
        {
            Some(known) => known.1 += 1,
            None => found.push((pole, 1)),
        }
    }
    Some(found)
}

/// Laguerre filters of every pole, `more` of each than it occurs.
fn chains(poles: &[(f64, usize)], more: usize) -> (DMatrix<f64>, DVector<f64>) {
    let states: usize = poles.iter().map(|p| p.1 + more).sum();
    let mut a = DMatrix::zeros(states, states);
    let mut b = DVector::zeros(states);
    let mut at = 0;
    for (pole, times) in poles {
        for i in at..at + times + more {
            a[(i, i)] = -pole;
            b[i] = (2.0 * pole).sqrt();
            a.view_mut((i, at), (1, i - at)).fill(-2.0 * pole);
        }
        at += times + more;
    }
    (a, b)
}

/// Responses of the filters (columns), real parts above imaginary ones.
fn responses(
    a: &DMatrix<f64>,
    b: &DVector<f64>,
    rate: f64,
    frequencies: &[f64],
) -> Option<DMatrix<f64>> {
    let mut all = DMatrix::zeros(2 * frequencies.len(), b.len());
    let drive = b.map(|x| Complex::from(rate * x));
    for (row, omega) in frequencies.iter().enumerate() {
        let mut matrix = a.map(|x| Complex::from(-rate * x));
        for i in 0..b.len() {
            matrix[(i, i)] += Complex::new(0.0, *omega);
        }
        let x = matrix.lu().solve(&drive)?;
        for (l, x) in x.iter().enumerate() {
            all[(row, l)] = x.re;
            all[(frequencies.len() + row, l)] = x.im;
        }
    }
    Some(all)
}

/// What of each filter of the basis (rows) makes each wanted one (columns); `None` where more remains than may.
fn parts_of(wanted: &DMatrix<f64>, basis: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let svd = basis.clone().svd(true, true);
    let smallest = RANK * svd.singular_values.max();
    let parts = svd.solve(wanted, smallest).ok()?;
    let left = wanted - basis * &parts;
    let columns = wanted.column_iter().zip(left.column_iter());
    let within = columns
        .into_iter()
        .all(|(w, l)| l.amax() <= REMAINDER * w.amax());
    within.then_some(parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bank(rate: f64, poles: &[(f64, usize)]) -> ModalBank {
        let (a, b) = chains(poles, 0);
        let outputs = (0..b.len()).map(|l| DMatrix::from_element(1, 1, 1.0 / (1.0 + l as f64)));
        ModalBank {
            outputs: outputs.collect(),
            a,
            b,
            rate,
        }
    }

    /// What the banks do to one mode at a frequency, by closed form: `√(2p) (s − p)^l/(s + p)^(l + 1)` for filter `l` of a chain.
    fn force(banks: &[ModalBank], omega: f64) -> Complex<f64> {
        let mut sum = Complex::default();
        for bank in banks {
            let mut order = 0;
            for l in 0..bank.b.len() {
                let p = -bank.a[(l, l)] * bank.rate;
                order = if l > 0 && bank.a[(l, l - 1)] != 0.0 {
                    order + 1
                } else {
                    0
                };
                let s = Complex::new(0.0, omega);
                let scale = bank.b[l] * bank.rate;
                let x = ((s - p) / (s + p)).powu(order) * scale / (s + p);
                sum += x * bank.outputs[l][(0, 0)];
            }
        }
        sum
    }

    #[test]
    fn one_bank_stands_for_all_winds() {
        for poles in [&[(1.6, 3)][..], &[(0.3, 1), (1.1, 1)][..]] {
            let all: Vec<ModalBank> = (0..6)
                .map(|i| bank(0.9 + 0.02 * f64::from(i), poles))
                .collect();
            let one = merged(all.clone());
            assert_eq!(one.len(), 1);
            assert!(one[0].b.len() < all[0].b.len() * all.len() / 2);
            for omega in [0.0, 0.1, 0.7, 1.6, 4.0, 30.0] {
                let (found, expected) = (force(&one, omega), force(&all, omega));
                let size = force(&all, 0.0).norm();
                assert!(
                    (found - expected).norm() < 5e-4 * size,
                    "{omega}: {found} {expected}"
                );
            }
        }
        // two winds far apart are no cheaper together
        let apart = vec![bank(0.2, &[(1.6, 3)]), bank(1.0, &[(1.6, 3)])];
        assert_eq!(merged(apart).len(), 2);
    }
}
