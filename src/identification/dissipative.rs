//! Fits whose models take energy out of fast motion.
//!
//! Above the tested range nothing but the form of the model says what the forces are, and least squares lets them feed
//! energy into motions there: every simulation in slow wind, where `K = ωB/V` is large, then grows. In the dimensionless
//! form `q = G r`, `r = (y/B, x/B, θ)`, a motion `φ cos(ωt)` gains energy in proportion to `φᵀ Im G(K) φ`, so that a fit is asked for
//!
//! 1. added mass that is a mass: `e₂ = e₂ᵀ`, `−e₂ ⪰ 0`;
//! 2. damping in the limit of fast motion: `−(e₁ + e₁ᵀ) ⪰ δI`;
//! 3. damping of every real mode shape above the tested range: `−sym Im G(K)/K ⪰ 0` at 40 `K` from `K_max` to `200 K_max`.
//!
//! A deck whose tests end with growth (a bluff one) keeps it: where `sym Im G/K` of heave and torsion at `K_max` has a
//! positive part `P` in the fit that the data alone give, condition 3 reads `P (K_max/K)² − sym Im G(K)/K ⪰ 0`, since a
//! fit damped from `K_max` on would be damped at the end of the tested range too, on the unsafe side.
//!
//! This is less than passivity, which a flat plate does not have either. All conditions are convex in the
//! coefficients. For given poles the fit minimises the sum over the transfer functions of weighted squared residuals, each
//! relative to the weighted data of its own — the objective of the search of poles — by cutting planes: whatever mode
//! shape `v` a solution feeds gives the linear inequality `vᵀ(…)v ≤ 0` for the next.

mod edge;
mod equations;
mod least_distance;
mod report;
mod tangent;

use super::basis::Basis;
use crate::error::{Error, Result};
use crate::section::Dof;
use edge::TestedRangeEnd;
pub use equations::Constraints;
pub(crate) use equations::FitRequirements;
use equations::{Equation, equations, satisfy};
use least_distance::{Inequality, shortest};
use nalgebra::{DMatrix, DVector, SymmetricEigen};

pub use report::{ActiveConstraint, ConstraintCost, ConstraintKind, ConstraintReport, OnsetEffect};
use tangent::take_away;
pub(crate) use tangent::{LinearEntry, Tangent};

/// Reduced frequencies at which condition 3 is stated.
const SAMPLES: usize = 40;
/// Highest of them over the highest tested one: beyond, condition 2 is more than what is left of the filters.
const REACH: f64 = 200.0;
/// `δ/2` over the size of `sym Im G/K` at the end of the tested range: covers the filters beyond [`REACH`], `O(REACH⁻²)`.
const FAST_MARGIN: f64 = 1e-3;
/// Margin of the other conditions on the same scale: a thousand times [`TOLERANCE`], so that no rounding undoes them.
const MARGIN: f64 = 1e-6;
/// Violation, on the same scale, at which no further plane is cut.
const TOLERANCE: f64 = 1e-9;
/// A condition is held by what comes closer than this to its bound: a curved one is followed by planes at [`TOLERANCE`].
const ACTIVE: f64 = 1e-7;
/// Rounds of cutting planes; a few are the rule.
const ROUNDS: usize = 200;

/// One matrix `M`, linear in the coefficients, with `−sym M ⪰ margin · I`.
#[derive(Debug, Clone, Copy)]
struct Condition {
    kind: ConstraintKind,
    /// Reduced frequency, of condition 3.
    k: Option<f64>,
    /// Size of the matrix over that of `sym Im G/K` at the end of the tested range.
    scale: f64,
    margin: f64,
    /// Share of the growth of the tests that is left here: `(K_max/K)²`.
    own: f64,
}

/// The conditions on one model with given poles.
pub(crate) struct Dissipation {
    n: usize,
    dofs: Vec<Dof>,
    conditions: Vec<Condition>,
    /// Which list of rows belongs to a transfer function, row by row.
    rows_of: Vec<usize>,
    /// For each distinct basis and condition: what a transfer function contributes, as a row over its columns.
    rows: Vec<Vec<Vec<f64>>>,
    equations: Vec<Equation>,
}

/// The fit under the conditions.
pub(crate) struct Solution {
    /// The free numbers; without constraints they are zero.
    pub free: DVector<f64>,
    /// Of every transfer function, row by row.
    pub coefficients: Vec<Vec<f64>>,
    /// What holds it.
    pub active: Vec<ActiveConstraint>,
    pub tangent: Tangent,
}

/// A plane that cuts off what feeds one motion.
struct Cut {
    condition: usize,
    plane: Inequality,
}

impl Dissipation {
    /// For the bases of all transfer functions, row by row.
    pub(crate) fn new(bases: &[Basis], wishes: &FitRequirements) -> Self {
        let k_max = wishes.k_max;
        let n = bases.len().isqrt();
        let feed = bases[0].feed();
        let column = |order: usize| feed.orders().position(|o| o == order);
        let step = REACH.ln() / (SAMPLES as f64 - 1.0);
        let fast = column(1).is_some();
        let dissipative = wishes.constraints == Constraints::Dissipative;
        let samples = if dissipative { SAMPLES } else { 0 };
        let mut conditions: Vec<Condition> = (0..samples)
            .map(|i| {
                let ratio = (step * i as f64).exp();
                Condition {
                    kind: ConstraintKind::AboveTestedRange,
                    k: Some(k_max * ratio),
                    // without e₁ the filters alone are left, which fade
                    scale: if fast { 1.0 } else { ratio.powi(-2) },
                    margin: MARGIN,
                    own: ratio.powi(-2),
                }
            })
            .collect();
        let limits = [
            (ConstraintKind::FastMotion, column(1), 1.0, FAST_MARGIN),
            (ConstraintKind::AddedMass, column(2), 1.0 / k_max, MARGIN),
        ];
        for (kind, column, scale, margin) in limits {
            conditions.extend(column.filter(|_| dissipative).map(|_| Condition {
                kind,
                k: None,
                scale,
                margin,
                own: 0.0,
            }));
        }
        let mut distinct: Vec<&Basis> = Vec::new();
        let mut rows_of = Vec::with_capacity(bases.len());
        for basis in bases {
            let known = distinct.iter().position(|d| d.same_columns(basis));
            rows_of.push(known.unwrap_or(distinct.len()));
            if known.is_none() {
                distinct.push(basis);
            }
        }
        let rows = distinct
            .iter()
            .map(|basis| conditions.iter().map(|c| c.kind.row(c.k, basis)).collect())
            .collect();
        Self {
            n,
            dofs: wishes.dofs.clone(),
            conditions,
            rows_of,
            rows,
            equations: equations(bases, n, wishes),
        }
    }

    fn row(&self, condition: usize, entry: usize) -> &[f64] {
        &self.rows[self.rows_of[entry]][condition]
    }

    /// Symmetric part of the matrix of a condition, n×n.
    fn matrix(&self, condition: usize, coefficients: &[Vec<f64>]) -> DMatrix<f64> {
        let full = DMatrix::from_fn(self.n, self.n, |i, j| {
            let e = i * self.n + j;
            let row = self.row(condition, e);
            row.iter()
                .zip(&coefficients[e])
                .map(|(a, c)| a * c)
                .sum::<f64>()
        });
        (&full + full.transpose()) * 0.5
    }

    /// The least of the joint objective under the conditions; `None` when least squares alone satisfy them.
    pub(crate) fn solve(&self, entries: &[LinearEntry]) -> Result<Option<Solution>> {
        let width = entries.iter().map(LinearEntry::end).max().unwrap_or(0);
        let alone: Vec<Vec<f64>> = entries.iter().map(|e| e.values.clone()).collect();
        let edge = match self.conditions.first() {
            Some(_) => TestedRangeEnd::new(self.matrix(0, &alone), &self.dofs),
            None => TestedRangeEnd::nothing(self.n),
        };
        let (equalities, start) = satisfy(&self.equations, entries, width)?;
        let mut u = start.clone();
        let mut cuts: Vec<Cut> = Vec::new();
        let at_start: Vec<Vec<f64>> = entries.iter().map(|e| e.coefficients(&start)).collect();
        for _ in 0..ROUNDS {
            let coefficients: Vec<Vec<f64>> = entries.iter().map(|e| e.coefficients(&u)).collect();
            let fed = self.fed(&coefficients, &edge);
            if fed.is_empty() {
                if cuts.is_empty() && start.amax() == 0.0 {
                    return Ok(None);
                }
                return Ok(Some(self.solution(
                    entries,
                    (u, coefficients),
                    &edge,
                    &cuts,
                    equalities,
                )));
            }
            for (condition, direction) in fed {
                let plane = self.plane(
                    (condition, &direction),
                    entries,
                    (&at_start, &edge),
                    &equalities,
                );
                cuts.push(Cut { condition, plane });
            }
            let planes: Vec<Inequality> = cuts.iter().map(|c| c.plane.clone()).collect();
            let (moved, held) = shortest(&planes, width)?;
            u = &start + moved;
            let mut at = 0;
            cuts.retain(|_| {
                at += 1;
                held.contains(&(at - 1))
            });
        }
        Err(Error::Numerical(format!(
            "dissipative fit: not reached after {ROUNDS} rounds of cutting planes; `constraints = \"none\"` fits without"
        )))
    }

    /// Conditions that do not hold and the mode shapes that are fed; of neighbouring reduced frequencies only the worst.
    fn fed(&self, coefficients: &[Vec<f64>], edge: &TestedRangeEnd) -> Vec<(usize, DVector<f64>)> {
        let eigen: Vec<_> = (0..self.conditions.len())
            .map(|c| self.excesses(c, coefficients, edge))
            .collect();
        let worst = |c: usize| eigen[c].0.max();
        let sampled = |c: usize| c < eigen.len() && self.conditions[c].k.is_some();
        let mut found = Vec::new();
        for (c, (excesses, directions)) in eigen.iter().enumerate() {
            let beside = [c.wrapping_sub(1), c + 1];
            let worse = |o: &usize| sampled(*o) && sampled(c) && worst(*o) > worst(c);
            if beside.iter().any(worse) {
                continue;
            }
            for (m, excess) in excesses.iter().enumerate() {
                if *excess > TOLERANCE {
                    found.push((c, directions.column(m).into_owned()));
                }
            }
        }
        found
    }

    /// Eigenvalues of a condition's matrix beyond what it may have, over its scale, and eigenvectors.
    fn excesses(
        &self,
        condition: usize,
        coefficients: &[Vec<f64>],
        edge: &TestedRangeEnd,
    ) -> (DVector<f64>, DMatrix<f64>) {
        let Condition {
            scale, margin, own, ..
        } = self.conditions[condition];
        let beyond = self.matrix(condition, coefficients) - &edge.own * own;
        let matrix = beyond / (edge.size * scale);
        let eigen = SymmetricEigen::new(matrix);
        (eigen.eigenvalues.add_scalar(margin), eigen.eigenvectors)
    }

    /// Gradient of `vᵀ M v` with respect to the free numbers.
    fn gradient(&self, condition: usize, v: &[f64], entries: &[LinearEntry]) -> DVector<f64> {
        let width = entries.iter().map(LinearEntry::end).max().unwrap_or(0);
        let mut gradient = DVector::zeros(width);
        for (e, entry) in entries.iter().enumerate() {
            let weight = v[e / self.n] * v[e % self.n];
            for (c, x) in self.row(condition, e).iter().enumerate() {
                for (m, s) in entry.spread.row(c).iter().enumerate() {
                    gradient[entry.at + m] += weight * x * s;
                }
            }
        }
        gradient
    }

    /// The plane `vᵀ M v ≤ own growth − margin`, in the free numbers from the start on.
    fn plane(
        &self,
        (condition, v): (usize, &DVector<f64>),
        entries: &[LinearEntry],
        (start, edge): (&[Vec<f64>], &TestedRangeEnd),
        equalities: &[DVector<f64>],
    ) -> Inequality {
        let mut gradient = self.gradient(condition, v.as_slice(), entries);
        take_away(&mut gradient, equalities);
        let Condition {
            scale, margin, own, ..
        } = self.conditions[condition];
        let allowed = v.dot(&(&edge.own * v)) * own - margin * scale * edge.size;
        Inequality {
            gradient,
            bound: allowed - v.dot(&(self.matrix(condition, start) * v)),
        }
    }

    fn solution(
        &self,
        entries: &[LinearEntry],
        (free, coefficients): (DVector<f64>, Vec<Vec<f64>>),
        edge: &TestedRangeEnd,
        cuts: &[Cut],
        equalities: Vec<DVector<f64>>,
    ) -> Solution {
        let alone: Vec<Vec<f64>> = entries.iter().map(|e| e.values.clone()).collect();
        let account = |e: &Equation| e.account(self.n, &alone, &coefficients);
        let mut active: Vec<_> = self.equations.iter().map(account).collect();
        let mut gradients = equalities;
        for (c, condition) in self.conditions.iter().enumerate() {
            if !cuts.iter().any(|cut| cut.condition == c) {
                continue;
            }
            let (excesses, directions) = self.excesses(c, &coefficients, edge);
            for (m, excess) in excesses.iter().enumerate() {
                let v = directions.column(m).into_owned();
                if *excess > -ACTIVE {
                    gradients.push(self.gradient(c, v.as_slice(), entries));
                    let value = |x: &[Vec<f64>]| v.dot(&(self.matrix(c, x) * &v));
                    active.push(ActiveConstraint {
                        kind: condition.kind,
                        k: condition.k,
                        entry: None,
                        direction: v.iter().copied().collect(),
                        alone: value(&alone),
                        held: value(&coefficients),
                    });
                }
            }
        }
        Solution {
            free,
            coefficients,
            active,
            tangent: Tangent::new(gradients.into_iter()),
        }
    }
}
