//! Condition 3 at every `K` above the tested range.
//!
//! A chain of filters `x′ = A x + b r + b₁ r′` answers a motion of frequency `K` with `Im x/K = −(K² + A²)⁻¹ (b + A b₁)`, so that
//! `H = sym Im G/K − P (K_max/K)²` is a rational matrix of `K²`: `sym e₁` plus what has the states of all chains, and `P/K²`. Where
//! it is singular, `K²` is an eigenvalue of its inverse's system matrix `A − B e₁⁻¹ C` (Rosenbrock), which finds every `K` at which an
//! eigenvalue of `H` changes its sign.

use super::condition::Dissipation;
use super::report::ConstraintKind;
use crate::state_space::{eigenvalues, golden_section};
use nalgebra::{DMatrix, SymmetricEigen};

/// Imaginary part of an eigenvalue, relative, that rounding of a double one can leave.
const NEARLY_REAL: f64 = 1e-2;
/// Excess over the size of `sym Im G/K` at the end of the tested range that is rounding.
const ROUNDING: f64 = 1e-12;
/// Width in `ln K` to which the worst `K` is found: its excess is then exact to the square of that.
const WIDTH: f64 = 1e-4;

impl Dissipation<'_> {
    /// The `K` at which the largest eigenvalue of `H` is positive and largest, one for each stretch where it is.
    pub(super) fn broken_at(&self, part: usize, coefficients: &[Vec<f64>]) -> Vec<f64> {
        // largest eigenvalue of H over the size at the end of the tested range
        let edge = &self.edges[part];
        let excess = |k: f64| {
            let condition = self.above(k, k / self.k_max, part);
            let beyond = self.matrix(&condition, coefficients) - &edge.own * condition.own;
            SymmetricEigen::new(beyond / edge.size).eigenvalues.max()
        };
        let Some(mut ks) = self.sign_changes(part, coefficients) else {
            return Vec::new();
        };
        ks.retain(|k| *k > self.k_max);
        ks.push(self.k_max);
        ks.sort_by(f64::total_cmp);
        let between = ks.windows(2).map(|w| (w[0] * w[1]).sqrt());
        let mut all: Vec<f64> = ks.iter().copied().chain(between).collect();
        all.push(ks[ks.len() - 1] * 2.0);
        all.sort_by(f64::total_cmp);
        let values: Vec<f64> = all.iter().map(|k| excess(*k)).collect();
        let mut worst = Vec::new();
        for at in 0..all.len() {
            let low = at.saturating_sub(1);
            let high = (at + 1).min(all.len() - 1);
            if values[at] <= ROUNDING || values[at] < values[low].max(values[high]) {
                continue;
            }
            let ends = all[low].ln()..all[high].ln();
            let mut best = (values[at], all[at]);
            let look = |x: f64| {
                let value = excess(x.exp());
                if value > best.0 {
                    best = (value, x.exp());
                }
                Ok::<_, crate::Error>(-value)
            };
            // an evaluation cannot fail
            let _ = golden_section(ends, look, f64::lt, |width, _, _| width <= WIDTH);
            worst.push(best.1);
        }
        worst
    }

    /// All `K` at which `H` is singular; `None` without `e₁`, whose inverse it takes.
    fn sign_changes(&self, part: usize, coefficients: &[Vec<f64>]) -> Option<Vec<f64>> {
        let (motions, edge) = (&self.parts[part], &self.edges[part]);
        let n = motions.len();
        let fast = self.limit(ConstraintKind::FastMotion, None, part);
        let inverse = self.matrix(&fast, coefficients).try_inverse()?;
        let filters: usize = self.distinct.iter().map(|b| b.poles().len()).sum();
        let states = n * (filters + 1);
        let mut a = DMatrix::zeros(states, states);
        let mut b = DMatrix::zeros(states, n);
        let mut c = DMatrix::zeros(n, states);
        let mut at = 0;
        for (d, basis) in self.distinct.iter().enumerate() {
            let (chain, drive) = basis.filters();
            let squared = &chain * &chain;
            let driven = drive.column(0) + &chain * drive.column(1);
            let feed = basis.feed().count();
            for l in 0..driven.len() {
                for i in 0..n {
                    b[(at + l * n + i, i)] = -driven[l];
                    for m in 0..driven.len() {
                        a[(at + l * n + i, at + m * n + i)] = -squared[(l, m)];
                    }
                    for j in 0..n {
                        for (row, column) in [(i, j), (j, i)] {
                            let e = motions[row] * self.count + motions[column];
                            if self.basis_of[e] == d {
                                c[(i, at + l * n + j)] += 0.5 * coefficients[e][feed + l];
                            }
                        }
                    }
                }
            }
            at += n * driven.len();
        }
        // P/K²
        for i in 0..n {
            b[(at + i, i)] = 1.0;
            for j in 0..n {
                c[(i, at + j)] = -edge.own[(i, j)] * self.k_max * self.k_max;
            }
        }
        let squares = eigenvalues(&(a - b * inverse * c)).ok()?.into_iter();
        let real = squares.filter(|z| z.re > 0.0 && z.im.abs() < NEARLY_REAL * z.re);
        Some(real.map(|z| z.re.sqrt()).collect())
    }
}
