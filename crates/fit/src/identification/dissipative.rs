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
//! The inequalities hold for heave and torsion together, and for sway by itself ([`Motions`]). A deck whose tests end with
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
mod motions;
mod report;

use super::affine::{AffineMap, AffineSpace};
use super::basis::Basis;
use crate::error::{Error, Result};
use condition::Condition;
use conic::shortest;
use edge::TestedRangeEnd;
pub use equations::Constraints;
pub(crate) use equations::FitRequirements;
use equations::{equations, satisfy};
use motions::Motions;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use report::GrowthLimit;

pub use report::{ActiveConstraint, ConstraintCost, ConstraintKind, ConstraintReport};

/// Violation, on the scale of the condition, at which a fit without constraints breaks it.
const TOLERANCE: f64 = 1e-9;
/// A condition is held by what comes closer than this to its bound.
const ACTIVE: f64 = 1e-7;
/// Part of the gradient of a condition that rounding leaves where its limit changes as it does itself.
pub(crate) const NOTHING_HELD: f64 = 1e-6;
/// Part of a gradient outside those of other constraints below which it adds no direction.
pub(crate) const SAME_DIRECTION: f64 = 1e-8;
/// Times that further `K` are stated; two or three are the rule.
const ROUNDS: usize = 30;

/// Where condition 3 is to hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Strictness {
    /// At the `K` that are stated first: for the search of poles.
    Sampled,
    /// At every `K ≥ K_max`.
    Everywhere,
}

/// The conditions on one model with given poles.
pub(crate) struct Dissipation<'a> {
    bases: &'a [Basis],
    k_max: f64,
    motions: Motions<'a>,
    conditions: Vec<Condition>,
    equations: Vec<(ActiveConstraint, f64)>,
}

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

impl<'a> Dissipation<'a> {
    /// For the bases of all transfer functions, row by row.
    pub(crate) fn new(bases: &'a [Basis], requirements: &FitRequirements) -> Self {
        let motions = Motions::new(bases, &requirements.dofs);
        let mut conditions = Vec::new();
        if requirements.constraints == Constraints::Dissipative {
            for part in 0..motions.parts.len() {
                conditions.extend(Condition::all(&motions, requirements.k_max, part));
            }
        }
        Self {
            equations: equations(bases, motions.count, requirements),
            k_max: requirements.k_max,
            bases,
            motions,
            conditions,
        }
    }

    /// The end of the tested range for every part, from the fit that the data alone give.
    fn edges(&self, alone: &[Vec<f64>]) -> Vec<TestedRangeEnd> {
        let first = |part: usize| self.conditions.iter().find(|s| s.part == part);
        (0..self.motions.parts.len())
            .filter_map(first)
            .map(|s| TestedRangeEnd::new(s.matrix(&self.motions, alone)))
            .collect()
    }

    /// The least of the joint objective under the conditions; `None` when least squares alone satisfy them.
    ///
    /// # Errors
    /// Limits at K → 0 that the columns cannot meet, and conditions that no coefficients satisfy.
    pub(crate) fn solve(
        &self,
        entries: &[AffineMap],
        strictness: Strictness,
    ) -> Result<Option<Solution>> {
        let width = entries.iter().map(AffineMap::end).max().unwrap_or(0);
        let alone: Vec<Vec<f64>> = entries.iter().map(|e| e.values.clone()).collect();
        let edges = self.edges(&alone);
        let equalities = satisfy(&self.equations, self.bases, entries, width)?;
        let start = &equalities.start;
        let at_start: Vec<Vec<f64>> = entries.iter().map(|e| e.coefficients(start)).collect();
        let mut conditions = self.conditions.clone();
        let (mut free, mut coefficients) = (start.clone(), at_start.clone());
        let mut holds = vec![false; conditions.len()];
        let broken = |s: &Condition| self.excesses(s, &at_start, &edges).0.max() > TOLERANCE;
        let mut more = match conditions.iter().any(broken) {
            true => None,
            false => Some(self.broken_between(&at_start, &edges, strictness)),
        };
        for _ in 0..=ROUNDS {
            if more.as_ref().is_some_and(Vec::is_empty) {
                if free.amax() == 0.0 {
                    return Ok(None);
                }
                let held = held(&conditions, &holds);
                let solution = self.solution(entries, free, coefficients, &edges, held, equalities);
                return Ok(Some(solution));
            }
            conditions.extend(more.into_iter().flatten());
            let cone = |s: &Condition| {
                let edge = &edges[s.part];
                s.cone(&self.motions, entries, &at_start, edge, &equalities)
            };
            let cones: Vec<_> = conditions.iter().map(cone).collect();
            let (further, holding) = shortest(&cones, width)?;
            (free, holds) = (start + further, holding);
            coefficients = entries.iter().map(|e| e.coefficients(&free)).collect();
            more = Some(self.broken_between(&coefficients, &edges, strictness));
        }
        Err(Error::Numerical(format!(
            "dissipative fit: damping for every K not reached after {ROUNDS} rounds; `constraints = \"none\"` fits without"
        )))
    }

    /// Condition 3 where it is broken although it is not stated there.
    fn broken_between(
        &self,
        coefficients: &[Vec<f64>],
        edges: &[TestedRangeEnd],
        strictness: Strictness,
    ) -> Vec<Condition> {
        if strictness == Strictness::Sampled {
            return Vec::new();
        }
        let mut all = Vec::new();
        for (part, edge) in edges.iter().enumerate() {
            let ks = self.broken_at(part, coefficients, edge).into_iter();
            all.extend(ks.map(|k| Condition::above(k, k / self.k_max, &self.motions, part)));
        }
        all
    }

    /// Eigenvalues of a condition's matrix beyond what it may have, over its scale, and eigenvectors.
    fn excesses(
        &self,
        condition: &Condition,
        coefficients: &[Vec<f64>],
        edges: &[TestedRangeEnd],
    ) -> (DVector<f64>, DMatrix<f64>) {
        let edge = &edges[condition.part];
        let beyond = condition.matrix(&self.motions, coefficients) - &edge.own * condition.own;
        let eigen = SymmetricEigen::new(beyond / (edge.size * condition.scale));
        let excesses = eigen.eigenvalues.add_scalar(condition.margin);
        (excesses, eigen.eigenvectors)
    }

    fn solution(
        &self,
        entries: &[AffineMap],
        free: DVector<f64>,
        coefficients: Vec<Vec<f64>>,
        edges: &[TestedRangeEnd],
        held: Vec<&Condition>,
        mut space: AffineSpace,
    ) -> Solution {
        let alone: Vec<Vec<f64>> = entries.iter().map(|e| e.values.clone()).collect();
        let account = |(equation, _): &(ActiveConstraint, f64)| ActiveConstraint {
            alone: equation.value_in(self.bases, &alone),
            held: equation.value_in(self.bases, &coefficients),
            ..equation.clone()
        };
        let mut active: Vec<_> = self.equations.iter().map(account).collect();
        for s in held {
            let (excesses, directions) = self.excesses(s, &coefficients, edges);
            for (m, excess) in excesses.iter().enumerate() {
                if *excess <= -ACTIVE {
                    continue;
                }
                let direction = directions.column(m).into_owned();
                let constraint =
                    self.active_constraint(s, &direction, edges, &alone, &coefficients);
                if let Some(gradient) = self.free_gradient(s, &constraint, entries) {
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
        edges: &[TestedRangeEnd],
        alone: &[Vec<f64>],
        coefficients: &[Vec<f64>],
    ) -> ActiveConstraint {
        let (part, own) = (condition.part, condition.own);
        let value =
            |x: &[Vec<f64>]| direction.dot(&(condition.matrix(&self.motions, x) * direction));
        let follows = (own > 0.0).then(|| edges[part].change(direction)).flatten();
        ActiveConstraint {
            kind: condition.kind,
            k: condition.k,
            entry: None,
            direction: self.motions.whole(part, direction.as_slice()).data.into(),
            alone: value(alone),
            held: value(coefficients),
            limit: follows.map(|weights| GrowthLimit {
                k_max: self.k_max,
                weights: self.motions.whole_matrix(part, &(weights * own)),
            }),
        }
    }

    /// Its gradient in the free numbers; none where it holds nothing but the growth that the tests end with.
    fn free_gradient(
        &self,
        condition: &Condition,
        constraint: &ActiveConstraint,
        entries: &[AffineMap],
    ) -> Option<DVector<f64>> {
        let v = DVector::from_column_slice(&constraint.direction);
        let held = condition.gradient(&self.motions, &(&v * v.transpose()), entries);
        let Some(limit) = &constraint.limit else {
            return Some(held);
        };
        let follows = Condition::above(self.k_max, 1.0, &self.motions, condition.part);
        let norm = held.norm();
        let free = held - follows.gradient(&self.motions, &limit.weights, entries);
        (free.norm() > NOTHING_HELD * norm).then_some(free)
    }
}

/// The conditions that hold something, in their order.
fn held<'a>(conditions: &'a [Condition], holds: &[bool]) -> Vec<&'a Condition> {
    let pairs = conditions.iter().zip(holds);
    let mut held: Vec<&Condition> = pairs.filter_map(|(s, held)| held.then_some(s)).collect();
    held.sort_by(|a, b| a.order(b));
    held
}
