//! The conditions, one by one, as cones in the free numbers of a fit.

use super::conic::Cone;
use super::edge::TestedRangeEnd;
use super::motions::Motions;
use super::report::ConstraintKind;
use crate::identification::affine::{AffineMap, AffineSpace};
use nalgebra::{DMatrix, DVector};
use std::cmp::Ordering;

/// Reduced frequencies at which condition 3 is stated from the start.
const SAMPLES: usize = 40;
/// Highest of them over the highest tested one: beyond, condition 2 is more than what is left of the filters.
const REACH: f64 = 200.0;
/// `δ/2` over the size of `sym Im G/K` at the end of the tested range: covers the filters beyond [`REACH`], `O(REACH⁻²)`.
const FAST_MARGIN: f64 = 1e-3;
/// Margin of the other conditions on the same scale: more than rounding undoes, and than is looked for between two `K`.
const MARGIN: f64 = 1e-6;

/// One matrix `M`, linear in the coefficients, with `−sym M ⪰ margin · I`.
#[derive(Debug, Clone)]
pub(super) struct Condition {
    pub kind: ConstraintKind,
    /// Which motions it holds together.
    pub part: usize,
    /// Reduced frequency, of condition 3.
    pub k: Option<f64>,
    /// Size of the matrix over that of `sym Im G/K` at the end of the tested range.
    pub scale: f64,
    pub margin: f64,
    /// Share of the growth of the tests that is left here: `(K_max/K)²`.
    pub own: f64,
    /// What a transfer function of each distinct basis contributes, over its columns.
    rows: Vec<Vec<f64>>,
}

impl Condition {
    /// All conditions on one part of the motions, condition 3 at `K_max` first.
    pub(super) fn all(motions: &Motions<'_>, k_max: f64, part: usize) -> Vec<Self> {
        let feed = motions.distinct[0].feed();
        let step = REACH.ln() / (SAMPLES as f64 - 1.0);
        let mut all: Vec<Self> = (0..SAMPLES)
            .map(|i| {
                let ratio = (step * i as f64).exp();
                Self::above(k_max * ratio, ratio, motions, part)
            })
            .collect();
        let added_mass = || Self {
            scale: 1.0 / k_max,
            margin: MARGIN,
            ..Self::limit(ConstraintKind::AddedMass, motions, part)
        };
        all.extend(
            feed.e1
                .then(|| Self::limit(ConstraintKind::FastMotion, motions, part)),
        );
        all.extend(feed.e2.then(added_mass));
        all
    }

    /// Condition 3 at one `K`, `ratio` times the highest tested one.
    pub(super) fn above(k: f64, ratio: f64, motions: &Motions<'_>, part: usize) -> Self {
        let kind = ConstraintKind::AboveTestedRange;
        Self {
            k: Some(k),
            // without e₁ the filters alone are left, which fade
            scale: if motions.distinct[0].feed().e1 {
                1.0
            } else {
                ratio.powi(-2)
            },
            margin: MARGIN,
            own: ratio.powi(-2),
            rows: rows(kind, Some(k), motions),
            ..Self::limit(kind, motions, part)
        }
    }

    /// A condition in the limit of fast motion.
    pub(super) fn limit(kind: ConstraintKind, motions: &Motions<'_>, part: usize) -> Self {
        Self {
            kind,
            part,
            k: None,
            scale: 1.0,
            margin: FAST_MARGIN,
            own: 0.0,
            rows: rows(kind, None, motions),
        }
    }

    /// Part by part, condition 3 in the order of `K`, then the others.
    pub(super) fn order(&self, other: &Self) -> Ordering {
        let at = |c: &Self| c.k.unwrap_or(f64::INFINITY);
        let parts = self.part.cmp(&other.part);
        parts.then(at(self).total_cmp(&at(other)))
    }

    /// Symmetric part of `M` in the motions of its part.
    pub(super) fn matrix(&self, motions: &Motions<'_>, coefficients: &[Vec<f64>]) -> DMatrix<f64> {
        let part = &motions.parts[self.part];
        let full = DMatrix::from_fn(part.len(), part.len(), |i, j| {
            let e = part[i] * motions.count + part[j];
            let row = &self.rows[motions.basis_of[e]];
            row.iter()
                .zip(&coefficients[e])
                .map(|(a, c)| a * c)
                .sum::<f64>()
        });
        (&full + full.transpose()) * 0.5
    }

    /// Gradient of `Σ weights ∘ M` with respect to the free numbers.
    pub(super) fn gradient(
        &self,
        motions: &Motions<'_>,
        weights: &DMatrix<f64>,
        entries: &[AffineMap],
    ) -> DVector<f64> {
        let n = motions.count;
        let width = entries.iter().map(AffineMap::end).max().unwrap_or(0);
        let mut gradient = DVector::zeros(width);
        for (e, entry) in entries.iter().enumerate() {
            let weight = weights[(e / n, e % n)];
            if weight != 0.0 {
                entry.add_gradient(&self.rows[motions.basis_of[e]], weight, &mut gradient);
            }
        }
        gradient
    }

    /// `M ⪯ own growth − margin` in the free numbers from the start on.
    pub(super) fn cone(
        &self,
        motions: &Motions<'_>,
        entries: &[AffineMap],
        start: &[Vec<f64>],
        edge: &TestedRangeEnd,
        equalities: &AffineSpace,
    ) -> Cone {
        let n = motions.count;
        let held = &motions.parts[self.part];
        let size = held.len();
        let floor = DMatrix::identity(size, size) * (self.margin * self.scale * edge.size);
        let room = &edge.own * self.own - floor - self.matrix(motions, start);
        let gradient = |i: usize, j: usize| {
            let mut weights = DMatrix::zeros(n, n);
            weights[(held[i], held[j])] += 0.5;
            weights[(held[j], held[i])] += 0.5;
            let mut gradient = self.gradient(motions, &weights, entries);
            equalities.project(&mut gradient);
            gradient
        };
        if size == 1 {
            return Cone::half_space(gradient(0, 0), room[(0, 0)]);
        }
        Cone::matrix(
            [gradient(0, 0), gradient(1, 1), gradient(0, 1)],
            [room[(0, 0)], room[(1, 1)], room[(0, 1)]],
        )
    }
}

fn rows(kind: ConstraintKind, k: Option<f64>, motions: &Motions<'_>) -> Vec<Vec<f64>> {
    let distinct = motions.distinct.iter();
    distinct.map(|basis| kind.row(k, basis)).collect()
}
