//! What active constraints are called, what they cost and what they change.

use crate::flutter::MovedOnset;
use crate::identification::basis::Basis;
use crate::identification::entry_report::EntryReport;
use crate::section::Dof;
use crate::trained_model::Model;
use nalgebra::{Complex, DMatrix};
use serde::{Deserialize, Serialize};

/// Share of the square of a mode shape that makes it the motion of one degree of freedom.
const ONE_MOTION: f64 = 0.95;

/// What a constraint holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ConstraintKind {
    /// `−vᵀ Im G(K)/K v ≥ 0`, or no more than the growth with which the tests end, at one `K` above the tested range.
    AboveTestedRange,
    /// `−vᵀ e₁ v ≥ δ/2`.
    FastMotion,
    /// `−vᵀ e₂ v ≥ 0`.
    AddedMass,
    /// `e₂ = e₂ᵀ` for one pair of motions.
    SymmetricAddedMass,
    /// `G(0)` of one transfer function, as it was asked for.
    ValueAtZero,
    /// `dG/d(iK)` of one transfer function at 0, as it was asked for.
    SlopeAtZero,
}

/// A constraint that holds a fit back.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ActiveConstraint {
    /// What it holds.
    pub kind: ConstraintKind,
    /// Reduced frequency `K`, where it is one of a reduced frequency.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub k: Option<f64>,
    /// Row and column of the transfer function, where it is one of a transfer function (for symmetry, one of the pair).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub entry: Option<(usize, usize)>,
    /// Mode shape `v` of unit length in the order of the degrees of freedom, positive `y/B`, `x/B`, `θ`; else zero.
    pub direction: Vec<f64>,
    /// The quadratic form that the data alone would give (the difference of the pair, for symmetry), dimensionless.
    pub alone: f64,
    /// The same in the fit.
    pub held: f64,
    /// What its limit follows, where that is the growth with which the tests end.
    /// `K_max` and the `W`, symmetric, over all degrees of freedom, with which `Σ W ∘ Im G(K_max)/K_max` changes by as much as the limit.
    #[serde(skip)]
    pub(crate) limit: Option<(f64, DMatrix<f64>)>,
}

/// What constraints cost one transfer function.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ConstraintCost {
    /// Force (row of `G`).
    pub force: Dof,
    /// Motion (column of `G`).
    pub motion: Dof,
    /// Relative root mean square of the residuals without constraints, as in [`EntryReport::relative_rms`].
    pub without: Option<f64>,
    /// The same with them.
    pub with: Option<f64>,
}

/// Account of the constraints that hold a fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ConstraintReport {
    /// The constraints, one by one.
    pub active: Vec<ActiveConstraint>,
    /// The same in sentences.
    pub sentences: Vec<String>,
    /// What they cost, one account per transfer function, row by row.
    pub costs: Vec<ConstraintCost>,
    /// What they do to the onset; filled in where the section is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub onset: Option<MovedOnset>,
    /// The model that the data alone would give.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unconstrained: Option<Box<Model>>,
}

impl ConstraintKind {
    /// What a transfer function contributes, as a row over its columns.
    pub(super) fn row(self, k: Option<f64>, basis: &Basis) -> Vec<f64> {
        let unit = |order: usize| {
            let one = basis.feed().orders().position(|o| o == order);
            let each = (0..basis.len()).map(|c| f64::from(u8::from(Some(c) == one)));
            each.collect()
        };
        match (self, k) {
            (Self::AboveTestedRange, Some(k)) => {
                let columns = basis.columns(Complex::new(0.0, k));
                columns.iter().map(|z| z.im / k).collect()
            }
            (Self::AboveTestedRange | Self::FastMotion, _) => unit(1),
            (Self::AddedMass | Self::SymmetricAddedMass, _) => unit(2),
            (Self::ValueAtZero, _) => basis.at_zero()[0].clone(),
            (Self::SlopeAtZero, _) => basis.at_zero()[1].clone(),
        }
    }
}

impl ActiveConstraint {
    /// Gradient of what it holds with respect to the coefficients of entry `(i, j)`.
    pub(crate) fn gradient(&self, i: usize, j: usize, basis: &Basis) -> Vec<f64> {
        let row = self.kind.row(self.k, basis);
        let weight = self.weight(i, j);
        row.into_iter().map(|x| weight * x).collect()
    }

    /// The same of what it holds beyond its limit, where that follows the data.
    pub(crate) fn gradient_beyond_limit(&self, i: usize, j: usize, basis: &Basis) -> Vec<f64> {
        let mut gradient = self.gradient(i, j, basis);
        if let Some((k_max, weights)) = &self.limit {
            let row = ConstraintKind::AboveTestedRange.row(Some(*k_max), basis);
            for (to, x) in gradient.iter_mut().zip(row) {
                *to -= weights[(i, j)] * x;
            }
        }
        gradient
    }

    /// What the row of entry `(i, j)` is multiplied with.
    pub(super) fn weight(&self, i: usize, j: usize) -> f64 {
        match self.entry {
            Some(entry) if entry == (i, j) => 1.0,
            Some(entry) if entry == (j, i) && self.kind == ConstraintKind::SymmetricAddedMass => {
                -1.0
            }
            Some(_) => 0.0,
            None => self.direction[i] * self.direction[j],
        }
    }

    /// What it would hold in another model, from its bases and coefficients, row by row.
    pub(super) fn value_in(&self, bases: &[Basis], coefficients: &[Vec<f64>]) -> f64 {
        let n = self.direction.len();
        let part = |(e, (basis, values)): (usize, (&Basis, &Vec<f64>))| -> f64 {
            let gradient = self.gradient(e / n, e % n, basis);
            gradient.iter().zip(values).map(|(g, v)| g * v).sum()
        };
        bases.iter().zip(coefficients).enumerate().map(part).sum()
    }

    /// Whose motion it is.
    fn whose(&self, dofs: &[Dof]) -> String {
        let direction = || self.direction.iter();
        if let Some(i) = direction().position(|v| v * v > ONE_MOTION) {
            return dofs[i].name().to_owned();
        }
        let larger = |a: f64, v: &f64| if v.abs() > a.abs() { *v } else { a };
        let sign = direction().fold(0.0, larger).signum();
        let parts = direction().zip(dofs).filter(|(v, _)| v.abs() > 0.05);
        let parts = parts.map(|(v, d)| format!("{:.2} {}", v * sign, d.name()));
        format!("coupled ({})", parts.collect::<Vec<_>>().join(", "))
    }
}

impl ConstraintReport {
    /// The account of a fit beside the one without constraints.
    pub(crate) fn new(
        mut active: Vec<ActiveConstraint>,
        dofs: &[Dof],
        alone: &[EntryReport],
        bases: &[Basis],
        with: &[EntryReport],
        unconstrained: Model,
    ) -> Self {
        let values: Vec<Vec<f64>> = alone.iter().map(EntryReport::values).collect();
        for constraint in &mut active {
            constraint.alone = constraint.value_in(bases, &values);
        }
        let cost = |(a, b): (&EntryReport, &EntryReport)| ConstraintCost {
            force: b.force,
            motion: b.motion,
            without: a.relative_rms,
            with: b.relative_rms,
        };
        Self {
            sentences: sentences(&active, dofs),
            active,
            costs: alone.iter().zip(with).map(cost).collect(),
            onset: None,
            unconstrained: Some(Box::new(unconstrained)),
        }
    }

    /// Largest rise of a residual, in percentage points, and where.
    pub fn dearest(&self) -> Option<(&ConstraintCost, f64)> {
        let costs = self.costs.iter();
        let rises = costs.filter_map(|c| Some((c, 100.0 * (c.with? - c.without?))));
        rises.max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// One sentence a constraint; neighbouring reduced frequencies of one motion share theirs.
fn sentences(active: &[ActiveConstraint], dofs: &[Dof]) -> Vec<String> {
    let share = |a: &ActiveConstraint, b: &ActiveConstraint| {
        [a.kind, b.kind] == [ConstraintKind::AboveTestedRange; 2] && a.whose(dofs) == b.whose(dofs)
    };
    let runs = active.chunk_by(share);
    runs.map(|run| sentence(run, dofs)).collect()
}

fn sentence(run: &[ActiveConstraint], dofs: &[Dof]) -> String {
    let first = &run[0];
    let whose = first.whose(dofs);
    // what the data alone would give at the worst of the run
    let worst = run.iter().map(|c| c.alone).fold(f64::MIN, f64::max);
    let would = |what: &str, symbol: &str| match worst > 0.0 {
        true => format!("the data alone would make it negative ({symbol} {worst:+.3})"),
        false => format!(
            "the data alone give {what} there ({symbol} {worst:+.3}), but not with the other constraints"
        ),
    };
    let (i, j) = first.entry.unwrap_or_default();
    let (force, motion) = (dofs[i].name(), dofs[j].name());
    let at_zero = |what: &str| {
        format!(
            "{what} of the {force} force due to {motion} motion at K → 0 is {:.4} as stated: the data alone would make it {:.4}",
            first.held, first.alone
        )
    };
    match first.kind {
        ConstraintKind::AboveTestedRange => format!(
            "{whose} damping at {}: {}",
            place_and_limit(run),
            would("damping", "Im G/K")
        ),
        ConstraintKind::FastMotion => format!(
            "{whose} damping in the limit of fast motion is held at a thousandth of what was tested: {}",
            would("damping", "e1")
        ),
        ConstraintKind::AddedMass => format!(
            "added mass of the {whose} motion is held at zero: {}",
            would("a mass", "e2")
        ),
        ConstraintKind::SymmetricAddedMass => format!(
            "added mass that couples {motion} and {force} motion is symmetric: the data alone would make its two numbers differ \
             (e2 by {:+.3})",
            first.alone
        ),
        ConstraintKind::ValueAtZero => at_zero("the value"),
        ConstraintKind::SlopeAtZero => at_zero("the slope"),
    }
}

/// The reduced frequencies of a run of constraints, and at what they hold the damping.
fn place_and_limit(run: &[ActiveConstraint]) -> String {
    let ks: Vec<f64> = run.iter().filter_map(|c| c.k).collect();
    let (low, high) = (ks[0], ks[ks.len() - 1]);
    let place = match low < high {
        true => format!("K = {low:.3} to {high:.3}"),
        false => format!("K = {low:.3}"),
    };
    let own = run.iter().map(|c| c.held).fold(0.0, f64::max);
    match own > 0.0 {
        true => format!(
            "{place} is held at the growth with which the tests end, fading with K² (Im G/K {own:+.3} there)"
        ),
        false => format!("{place} is held at zero"),
    }
}
