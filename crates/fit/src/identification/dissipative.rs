//! Fits whose models take energy out of fast motion.
//!
//! Above the tested range nothing but the form of the model says what the forces are, and least squares lets them feed
//! energy into motions there: every simulation in slow wind, where `K = ωB/V` is large, then grows. In the dimensionless
//! form `q = G r`, `r = (y/B, x/B, θ)`, a motion `φ cos(ωt)` gains energy in proportion to `φᵀ Im G(K) φ`, so that a fit is asked for
//!
//! 1. added mass that is a mass: `e₂ = e₂ᵀ`, `−e₂ ⪰ 0`;
//! 2. damping in the limit of fast motion: `−(e₁ + e₁ᵀ) ⪰ δI`;
//! 3. damping of every real mode shape above the tested range: `−sym Im G(K)/K ⪰ 0` for `K ≥ K_max`.
//!
//! The inequalities hold for heave and torsion together, and for sway by itself ([`Dissipation::parts`]). A deck whose tests end with
//! growth (a bluff one) keeps it: where `sym Im G/K` at `K_max` has a positive part `P` in the fit that the data alone give,
//! condition 3 reads `P (K_max/K)² − sym Im G(K)/K ⪰ 0`, since a fit damped from `K_max` on would be damped at the end of the
//! tested range too, on the unsafe side.
//!
//! This is less than passivity, which a flat plate does not have either. All conditions are convex in the
//! coefficients. For given poles the fit minimises the sum over the transfer functions of weighted squared residuals, each
//! relative to the weighted data of its own — the objective of the search of poles. Condition 3 is stated at 40 `K` from
//! `K_max` to `200 K_max`, and then at every `K` at which the answer still breaks it ([`everywhere`]), until there is none.

mod condition;
mod conic;
mod edge;
mod equations;
mod everywhere;
mod report;

use super::affine::{AffineMap, AffineSpace};
use super::basis::Basis;
use crate::error::{Error, Result, ensure};
use condition::{Condition, Dissipation};
use conic::shortest;
pub use equations::Constraints;
pub(crate) use equations::FitRequirements;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

pub use report::{ActiveConstraint, ConstraintCost, ConstraintKind, ConstraintReport};

/// Violation, on the scale of the condition, at which a fit without constraints breaks it.
const TOLERANCE: f64 = 1e-9;
/// A condition is held by what comes closer than this to its bound.
const ACTIVE: f64 = 1e-7;
/// Part of the gradient of a condition that rounding leaves where its limit changes as it does itself.
pub(crate) const NOTHING_HELD: f64 = 1e-6;
/// Part of a gradient outside those of other constraints below which it adds no direction.
pub(crate) const SAME_DIRECTION: f64 = 1e-8;
/// Part of an equation outside the others below which it repeats them.
const RANK_TOLERANCE: f64 = 1e-10;
/// Relative difference to which a repeated equation has to agree with the others.
const AGREEMENT: f64 = 1e-8;
/// Times that further `K` are stated; two or three are the rule.
const ROUNDS: usize = 30;

/// The fit under the conditions.
pub(crate) struct Solution {
    /// The free numbers; without constraints they are zero.
    pub free: DVector<f64>,
    /// Of every transfer function, row by row.
    pub coefficients: Vec<Vec<f64>>,
    /// What holds it.
    pub active: Vec<ActiveConstraint>,
    /// The free numbers that satisfy all of it.
    pub space: AffineSpace,
}

/// The least of the joint objective of transfer functions under what is asked of them; `None` when least squares alone satisfy it.
/// Condition 3 holds `everywhere`, at every `K ≥ K_max`, or, for the search of poles, at the `K` that are stated first.
///
/// # Errors
/// Limits at K → 0 that the columns cannot meet, and conditions that no coefficients satisfy.
pub(crate) fn constrained(
    entries: &[AffineMap],
    bases: &[Basis],
    requirements: &FitRequirements,
    everywhere: bool,
) -> Result<Option<Solution>> {
    Dissipation::new(bases, requirements, entries).solve(everywhere)
}

impl Dissipation<'_> {
    fn solve(mut self, everywhere: bool) -> Result<Option<Solution>> {
        let equalities = self.satisfied()?;
        let start = &equalities.start;
        let at = |free: &DVector<f64>| -> Vec<Vec<f64>> {
            self.entries.iter().map(|e| e.coefficients(free)).collect()
        };
        let at_start = at(start);
        let mut conditions = std::mem::take(&mut self.conditions);
        let (mut free, mut coefficients) = (start.clone(), at_start.clone());
        let mut holds = vec![false; conditions.len()];
        let broken = |s: &Condition| self.excesses(s, &at_start).0.max() > TOLERANCE;
        let mut more = match conditions.iter().any(broken) {
            true => None,
            false => Some(self.broken_between(&at_start, everywhere)),
        };
        for _ in 0..=ROUNDS {
            if more.as_ref().is_some_and(Vec::is_empty) {
                if free.amax() == 0.0 {
                    return Ok(None);
                }
                let held = conditions.iter().zip(holds).filter(|(_, held)| *held);
                let mut held: Vec<&Condition> = held.map(|(s, _)| s).collect();
                held.sort_by(|a, b| a.order(b));
                return Ok(Some(self.solution(free, coefficients, &held, equalities)));
            }
            conditions.extend(more.into_iter().flatten());
            let cone = |s: &Condition| self.cone(s, &at_start, &equalities);
            let cones: Vec<_> = conditions.iter().map(cone).collect();
            let (further, holding) = shortest(&cones, self.width)?;
            (free, holds) = (start + further, holding);
            coefficients = at(&free);
            more = Some(self.broken_between(&coefficients, everywhere));
        }
        Err(Error::Numerical(format!(
            "dissipative fit: damping for every K not reached after {ROUNDS} rounds; `constraints = \"none\"` fits without"
        )))
    }

    /// The free numbers that satisfy the equations.
    fn satisfied(&self) -> Result<AffineSpace> {
        let mut space = AffineSpace::whole(self.width);
        let n = self.count;
        for (equation, wanted) in &self.equations {
            let mut gradient = DVector::zeros(self.width);
            for (e, (entry, basis)) in self.entries.iter().zip(self.bases).enumerate() {
                if equation.weight(e / n, e % n) != 0.0 {
                    let row = equation.gradient(e / n, e % n, basis);
                    entry.add_gradient(&row, 1.0, &mut gradient);
                }
            }
            let target = wanted - equation.value_in(self.bases, &self.alone);
            if !space.hold(&gradient, target, RANK_TOLERANCE) {
                let short = target - gradient.dot(&space.start);
                ensure(
                    short.abs() <= AGREEMENT * wanted.abs().max(gradient.norm()),
                    "limits",
                    "limits at K → 0 that the columns of the model can meet",
                    "a feed-through is missing, or one limit repeats another",
                )?;
            }
        }
        Ok(space)
    }

    /// Condition 3 where it is broken although it is not stated there.
    fn broken_between(&self, coefficients: &[Vec<f64>], everywhere: bool) -> Vec<Condition> {
        let of_part = |part| {
            let ks = self.broken_at(part, coefficients).into_iter();
            ks.map(move |k| self.above(k, k / self.k_max, part))
        };
        let parts = 0..self.edges.len();
        parts.filter(|_| everywhere).flat_map(of_part).collect()
    }

    /// Eigenvalues of a condition's matrix beyond what it may have, over its scale, and eigenvectors.
    fn excesses(
        &self,
        condition: &Condition,
        coefficients: &[Vec<f64>],
    ) -> (DVector<f64>, DMatrix<f64>) {
        let edge = &self.edges[condition.part];
        let beyond = self.matrix(condition, coefficients) - &edge.own * condition.own;
        let eigen = SymmetricEigen::new(beyond / (edge.size * condition.scale));
        let excesses = eigen.eigenvalues.add_scalar(condition.margin);
        (excesses, eigen.eigenvectors)
    }

    fn solution(
        &self,
        free: DVector<f64>,
        coefficients: Vec<Vec<f64>>,
        held: &[&Condition],
        mut space: AffineSpace,
    ) -> Solution {
        let account = |(equation, _): &(ActiveConstraint, f64)| ActiveConstraint {
            alone: equation.value_in(self.bases, &self.alone),
            held: equation.value_in(self.bases, &coefficients),
            ..equation.clone()
        };
        let mut active: Vec<_> = self.equations.iter().map(account).collect();
        for s in held {
            let (excesses, directions) = self.excesses(s, &coefficients);
            for (excess, direction) in excesses.iter().zip(directions.column_iter()) {
                if *excess <= -ACTIVE {
                    continue;
                }
                let constraint = self.active_constraint(s, &direction.into_owned(), &coefficients);
                if let Some(gradient) = self.free_gradient(s, &constraint) {
                    space.hold(&gradient, gradient.dot(&free), SAME_DIRECTION);
                }
                active.push(constraint);
            }
        }
        Solution {
            free,
            coefficients,
            active,
            space,
        }
    }

    /// The constraint that a condition is in one direction of its motions.
    fn active_constraint(
        &self,
        condition: &Condition,
        direction: &DVector<f64>,
        coefficients: &[Vec<f64>],
    ) -> ActiveConstraint {
        let (n, own) = (self.count, condition.own);
        let (part, edge) = (&self.parts[condition.part], &self.edges[condition.part]);
        let value = |x: &[Vec<f64>]| direction.dot(&(self.matrix(condition, x) * direction));
        let follows = (own > 0.0).then(|| edge.change(direction)).flatten();
        // over all motions, of which the others are still
        let place = |i: usize| part.iter().position(|motion| *motion == i);
        let weight = |w: &DMatrix<f64>, i, j| match (place(i), place(j)) {
            (Some(a), Some(b)) => w[(a, b)] * own,
            _ => 0.0,
        };
        let whole = (0..n).map(|i| place(i).map_or(0.0, |a| direction[a]));
        ActiveConstraint {
            kind: condition.kind,
            k: condition.k,
            entry: None,
            direction: whole.collect(),
            alone: value(&self.alone),
            held: value(coefficients),
            limit: follows.map(|w| (self.k_max, DMatrix::from_fn(n, n, |i, j| weight(&w, i, j)))),
        }
    }

    /// Its gradient in the free numbers; none where it holds nothing but the growth that the tests end with.
    fn free_gradient(
        &self,
        condition: &Condition,
        constraint: &ActiveConstraint,
    ) -> Option<DVector<f64>> {
        let v = DVector::from_column_slice(&constraint.direction);
        let held = self.gradient(condition, &(&v * v.transpose()));
        let Some((_, weights)) = &constraint.limit else {
            return Some(held);
        };
        let follows = self.above(self.k_max, 1.0, condition.part);
        let norm = held.norm();
        let free = held - self.gradient(&follows, weights);
        (free.norm() > NOTHING_HELD * norm).then_some(free)
    }
}
