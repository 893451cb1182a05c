//! Filters on modal coordinates: one bank for each set of poles, or one for all winds of a section.
//!
//! In the wind `r V` the filters of a section run `r` times as fast. A profile of many winds would need as many banks of the
//! same filters, `L` states for every mode each. Their responses differ smoothly: a chain of a few more filters, whose poles lie
//! between those of the slowest and the fastest wind, spans what they do together up to a remainder that falls with every
//! filter. The forces count, not each filter: slow winds, of little pressure, and filters of little force may be spanned less well.

use crate::units::in_equal_ratios;
use nalgebra::{Complex, DMatrix, DVector};

/// Remainder of the forces over the largest of them up to which one bank stands for those of all winds.
const REMAINDER: f64 = 2e-4;
/// Filters that are added to every pole for that at most, and the remainder that may be left with as many or more.
const FEW_MORE: usize = 4;
const MOST_REMAINDER: f64 = 2e-3;
/// Filters that are added to every pole at most.
const MORE_AT_MOST: usize = 8;
/// Forces of a wind below this part of the largest have little to say: no pole of the bank belongs to them.
const LITTLE: f64 = 0.1;
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
    let rates = family.iter().map(|b| b.rate);
    let (lowest, rate) = (
        rates.clone().fold(f64::INFINITY, f64::min),
        rates.fold(0.0, f64::max),
    );
    let slowest = poles.iter().map(|p| p.0).fold(f64::INFINITY, f64::min);
    let fastest = poles.iter().map(|p| p.0).fold(0.0, f64::max);
    let (low, high) = (slowest * lowest * REACH.0, fastest * rate * REACH.1);
    let frequencies: Vec<f64> = in_equal_ratios(low, high, POINTS).collect();
    let of_bank = |bank: &ModalBank| responses(&bank.a, &bank.b, bank.rate, &frequencies);
    let wanted: Vec<_> = family.iter().map(of_bank).collect::<Option<_>>()?;
    let whole = forces(family, &wanted);
    let slow_part = slow_rate(family) / rate;
    for more in 1..=MORE_AT_MOST {
        let (a, b) = chains(&poles, more, slow_part);
        if b.len() >= filters * family.len() {
            return None;
        }
        let basis = responses(&a, &b, rate, &frequencies)?;
        let parts = parts_of(&wanted, &basis)?;
        let left = wanted.iter().zip(&parts).map(|(w, p)| w - &basis * p);
        let left = forces(family, &left.collect::<Vec<_>>());
        let allowed = match more < FEW_MORE {
            true => REMAINDER,
            false => MOST_REMAINDER,
        };
        let mut columns = left.column_iter().zip(whole.column_iter());
        if columns.all(|(left, whole)| left.amax() <= allowed * whole.amax()) {
            let outputs = together(family, &parts);
            return Some(ModalBank {
                a,
                b,
                rate,
                outputs,
            });
        }
    }
    None
}

/// Sizes of the forces on all modes by the motion of each (columns) at each frequency (rows): the sum over the winds, whose filters
/// answer with `responses`.
fn forces(family: &[ModalBank], responses: &[DMatrix<f64>]) -> DMatrix<f64> {
    let (points, n) = (responses[0].nrows() / 2, family[0].outputs[0].ncols());
    let mut sizes = DMatrix::zeros(points, n);
    for (bank, x) in family.iter().zip(responses) {
        for mode in 0..n {
            let column = |i: usize, l: usize| bank.outputs[l][(i, mode)];
            let outputs = DMatrix::from_fn(n, bank.outputs.len(), column);
            let squares = (x * outputs.tr_mul(&outputs)).component_mul(x).column_sum();
            for (i, size) in sizes.column_mut(mode).iter_mut().enumerate() {
                *size += (squares[i] + squares[points + i]).max(0.0).sqrt();
            }
        }
    }
    sizes
}

/// The rate of the slowest wind with more than a [`LITTLE`] force.
fn slow_rate(family: &[ModalBank]) -> f64 {
    let size = |bank: &ModalBank| bank.outputs.iter().map(|o| o.norm()).sum::<f64>();
    let largest = family.iter().map(size).fold(0.0, f64::max);
    let strong = family.iter().filter(|b| size(b) >= LITTLE * largest);
    strong.map(|b| b.rate).fold(f64::INFINITY, f64::min)
}

/// What the filters of the basis do, for those of every wind.
fn together(family: &[ModalBank], parts: &[DMatrix<f64>]) -> Vec<DMatrix<f64>> {
    let n = family[0].outputs[0].nrows();
    let mut outputs = vec![DMatrix::zeros(n, n); parts[0].nrows()];
    for (bank, parts) in family.iter().zip(parts) {
        for (j, output) in outputs.iter_mut().enumerate() {
            for (l, old) in bank.outputs.iter().enumerate() {
                *output += old * parts[(j, l)];
            }
        }
    }
    outputs
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

/// Filters in a chain for every pole, `more` of each than it occurs, at rates from `slow_part` of the pole up to it: what Laguerre
/// filters are where all rates are one.
fn chains(poles: &[(f64, usize)], more: usize, slow_part: f64) -> (DMatrix<f64>, DVector<f64>) {
    let states: usize = poles.iter().map(|p| p.1 + more).sum();
    let mut a = DMatrix::zeros(states, states);
    let mut b = DVector::zeros(states);
    let mut at = 0;
    for (pole, times) in poles {
        let last = at + times + more - 1;
        for i in at..=last {
            let steps = (last - at).max(1) as f64;
            let rate = pole * slow_part.powf((last - i) as f64 / steps);
            b[i] = (2.0 * rate).sqrt();
            a[(i, i)] = -rate;
            for j in at..i {
                a[(i, j)] = -b[i] * b[j];
            }
        }
        at = last + 1;
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

/// What of each filter of the basis (rows) makes each one of every wind (columns), by least squares.
fn parts_of(wanted: &[DMatrix<f64>], basis: &DMatrix<f64>) -> Option<Vec<DMatrix<f64>>> {
    let svd = basis.clone().svd(true, true);
    let smallest = RANK * svd.singular_values.max();
    let parts = wanted.iter().map(|w| svd.solve(w, smallest).ok());
    parts.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bank(rate: f64, poles: &[(f64, usize)]) -> ModalBank {
        let (a, b) = chains(poles, 0, 1.0);
        let outputs = (0..b.len()).map(|l| DMatrix::from_element(1, 1, 1.0 / (1.0 + l as f64)));
        ModalBank {
            outputs: outputs.collect(),
            a,
            b,
            rate,
        }
    }

    /// What the banks do to one mode at a frequency, by closed form: `√(2p)/(s + p)` for a filter, and `(s − p)/(s + p)` for what
    /// it hands on to the next of a chain.
    fn force(banks: &[ModalBank], omega: f64) -> Complex<f64> {
        let s = Complex::new(0.0, omega);
        let mut sum = Complex::default();
        for bank in banks {
            let mut handed_on = Complex::from(1.0);
            for l in 0..bank.b.len() {
                let p = -bank.a[(l, l)] * bank.rate;
                if l > 0 && bank.a[(l, l - 1)] == 0.0 {
                    handed_on = Complex::from(1.0);
                }
                sum += handed_on * (bank.b[l] * bank.rate) / (s + p) * bank.outputs[l][(0, 0)];
                handed_on *= (s - p) / (s + p);
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

    /// The states stay bounded however far a profile reaches: what slow winds do is little.
    #[test]
    fn a_few_more_filters_stand_for_any_profile() {
        for lowest in [0.6, 0.3, 0.1, 0.01] {
            let winds = (0..14).map(|i| lowest + (1.0 - lowest) * f64::from(i) / 13.0);
            let of_wind = |wind: f64| {
                let mut bank = bank(wind, &[(0.84, 3)]);
                bank.outputs.iter_mut().for_each(|o| *o *= wind * wind);
                bank
            };
            let all: Vec<ModalBank> = winds.map(of_wind).collect();
            let one = merged(all.clone());
            assert!(one.len() == 1 && one[0].b.len() <= 8, "{lowest}");
            let size = force(&all, 0.0).norm();
            for omega in [0.0, 0.003, 0.02, 0.1, 0.4, 1.0, 3.0] {
                let off = (force(&one, omega) - force(&all, omega)).norm();
                assert!(off < MOST_REMAINDER * size, "{lowest}, {omega}: {off}");
            }
        }
    }
}
