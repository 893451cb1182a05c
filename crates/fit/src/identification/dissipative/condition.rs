//! The conditions on a model with given poles, one by one, as cones in the free numbers of its fit.

use super::conic::Cone;
use super::edge::TestedRangeEnd;
use super::equations::{Constraints, FitRequirements, equations};
use super::report::{ActiveConstraint, ConstraintKind};
use crate::identification::affine::{AffineMap, AffineSpace};
use crate::identification::basis::Basis;
use crate::section::Dof;
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
    /// Part by part, condition 3 in the order of `K`, then the others.
    pub(super) fn order(&self, other: &Self) -> Ordering {
        let at = |c: &Self| c.k.unwrap_or(f64::INFINITY);
        let parts = self.part.cmp(&other.part);
        parts.then(at(self).total_cmp(&at(other)))
    }
}

/// A fit at given poles and all that it is held to.
pub(crate) struct Dissipation<'a> {
    /// Of the transfer functions, row by row.
    pub(super) bases: &'a [Basis],
    /// Their coefficients over the free numbers.
    pub(super) entries: &'a [AffineMap],
    /// Their coefficients by the data alone.
    pub(super) alone: Vec<Vec<f64>>,
    /// Number of free numbers.
    pub(super) width: usize,
    pub(super) k_max: f64,
    /// Number of motions.
    pub(super) count: usize,
    /// Those that conditions hold together: heave and torsion; sway by itself. Shapes that mix sway with the others are fed
    /// energy by quasi-steady theory itself (`[[2C_D, C_D′ − C_L], [2C_L, C_L′ + C_D]]` is indefinite at small drag), and nothing
    /// grows for it: frequencies of sway are far from the others', or its mass is.
    pub(super) parts: Vec<Vec<usize>>,
    /// Which of `distinct` the basis of a transfer function is, row by row.
    pub(super) basis_of: Vec<usize>,
    pub(super) distinct: Vec<&'a Basis>,
    pub(super) conditions: Vec<Condition>,
    /// The end of the tested range for every part, from the fit that the data alone give; none without conditions.
    pub(super) edges: Vec<TestedRangeEnd>,
    pub(super) equations: Vec<(ActiveConstraint, f64)>,
}

impl<'a> Dissipation<'a> {
    /// For the bases and coefficients of all transfer functions, row by row.
    pub(super) fn new(
        bases: &'a [Basis],
        requirements: &FitRequirements,
        entries: &'a [AffineMap],
    ) -> Self {
        let (mut distinct, mut basis_of) = (Vec::<&Basis>::new(), Vec::new());
        for basis in bases {
            let known = distinct.iter().position(|d| d.same_columns(basis));
            basis_of.push(known.unwrap_or(distinct.len()));
            if known.is_none() {
                distinct.push(basis);
            }
        }
        let dofs = &requirements.dofs;
        let (sway, deck) = (0..dofs.len()).partition(|i| dofs[*i] == Dof::Lateral);
        let parts: [Vec<usize>; 2] = [deck, sway];
        let count = bases.len().isqrt();
        let mut fit = Self {
            bases,
            entries,
            alone: entries.iter().map(|e| e.values.clone()).collect(),
            width: entries.iter().map(AffineMap::end).max().unwrap_or(0),
            k_max: requirements.k_max,
            count,
            parts: parts.into_iter().filter(|p| !p.is_empty()).collect(),
            basis_of,
            distinct,
            conditions: Vec::new(),
            edges: Vec::new(),
            equations: equations(bases, count, requirements),
        };
        if requirements.constraints == Constraints::Dissipative {
            for part in 0..fit.parts.len() {
                let own = fit.all(part);
                let edge = TestedRangeEnd::new(fit.matrix(&own[0], &fit.alone));
                fit.edges.push(edge);
                fit.conditions.extend(own);
            }
        }
        fit
    }

    /// All conditions on one part of the motions, condition 3 at `K_max` first.
    fn all(&self, part: usize) -> Vec<Condition> {
        let feed = self.distinct[0].feed();
        let step = REACH.ln() / (SAMPLES as f64 - 1.0);
        let at = |i| {
            let ratio = (step * i as f64).exp();
            self.above(self.k_max * ratio, ratio, part)
        };
        let mut all: Vec<Condition> = (0..SAMPLES).map(at).collect();
        let fast = || self.limit(ConstraintKind::FastMotion, None, part);
        let added_mass = || Condition {
            scale: 1.0 / self.k_max,
            margin: MARGIN,
            ..self.limit(ConstraintKind::AddedMass, None, part)
        };
        all.extend(feed.e1.then(fast));
        all.extend(feed.e2.then(added_mass));
        all
    }

    /// Condition 3 at one `K`, `ratio` times the highest tested one.
    pub(super) fn above(&self, k: f64, ratio: f64, part: usize) -> Condition {
        let fading = ratio.powi(-2);
        Condition {
            // without e₁ the filters alone are left, which fade
            scale: match self.distinct[0].feed().e1 {
                true => 1.0,
                false => fading,
            },
            margin: MARGIN,
            own: fading,
            ..self.limit(ConstraintKind::AboveTestedRange, Some(k), part)
        }
    }

    /// A condition in the limit of fast motion, or what is common to those at a `K`.
    pub(super) fn limit(&self, kind: ConstraintKind, k: Option<f64>, part: usize) -> Condition {
        let rows = self.distinct.iter().map(|basis| kind.row(k, basis));
        Condition {
            kind,
            part,
            k,
            scale: 1.0,
            margin: FAST_MARGIN,
            own: 0.0,
            rows: rows.collect(),
        }
    }

    /// Symmetric part of the matrix of a condition in the motions of its part.
    pub(super) fn matrix(&self, condition: &Condition, coefficients: &[Vec<f64>]) -> DMatrix<f64> {
        let part = &self.parts[condition.part];
        let full = DMatrix::from_fn(part.len(), part.len(), |i, j| {
            let e = part[i] * self.count + part[j];
            let row = condition.rows[self.basis_of[e]].iter();
            row.zip(&coefficients[e]).map(|(a, c)| a * c).sum::<f64>()
        });
        (&full + full.transpose()) * 0.5
    }

    /// Gradient of `Σ weights ∘ M` with respect to the free numbers.
    pub(super) fn gradient(&self, condition: &Condition, weights: &DMatrix<f64>) -> DVector<f64> {
        let mut gradient = DVector::zeros(self.width);
        for (e, entry) in self.entries.iter().enumerate() {
            let weight = weights[(e / self.count, e % self.count)];
            if weight != 0.0 {
                let row = &condition.rows[self.basis_of[e]];
                entry.add_gradient(row, weight, &mut gradient);
            }
        }
        gradient
    }

    /// `M ⪯ own growth − margin` in the free numbers from the start on.
    pub(super) fn cone(
        &self,
        condition: &Condition,
        start: &[Vec<f64>],
        equalities: &AffineSpace,
    ) -> Cone {
        let (held, edge) = (&self.parts[condition.part], &self.edges[condition.part]);
        let size = held.len();
        let floor =
            DMatrix::identity(size, size) * (condition.margin * condition.scale * edge.size);
        let room = &edge.own * condition.own - floor - self.matrix(condition, start);
        let gradient = |i: usize, j: usize| {
            let mut weights = DMatrix::zeros(self.count, self.count);
            weights[(held[i], held[j])] += 0.5;
            weights[(held[j], held[i])] += 0.5;
            let mut gradient = self.gradient(condition, &weights);
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
