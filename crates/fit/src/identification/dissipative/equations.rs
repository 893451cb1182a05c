//! Equations that coefficients have to satisfy besides: symmetric added mass, limits at K → 0.

use super::report::{ActiveConstraint, ConstraintKind};

use crate::error::{Result, ensure};
use crate::identification::affine::{AffineMap, AffineSpace};
use crate::identification::basis::Basis;
use crate::identification::form::{LEAST_CHOSEN, MOST_CHOSEN};
use crate::section::Dof;
use nalgebra::DVector;
use serde::{Deserialize, Serialize};

/// Part of an equation outside the others below which it repeats them.
const RANK_TOLERANCE: f64 = 1e-10;
/// Relative difference to which a repeated equation has to agree with the others.
const AGREEMENT: f64 = 1e-8;

/// What a fitted model has to be besides close to the data.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Constraints {
    /// It takes energy out of every real mode shape above the tested range, and its added mass is a mass.
    #[default]
    Dissipative,
    /// Nothing: least squares alone.
    None,
}

impl Constraints {
    /// Most filters of a fit that leaves their number to the data: only conditions keep more than the fewest from growing where
    /// nothing was tested.
    pub(crate) fn most_filters(self) -> usize {
        match self {
            Self::Dissipative => MOST_CHOSEN,
            Self::None => LEAST_CHOSEN,
        }
    }
}

/// What is asked of a fit besides.
#[derive(Debug, Clone)]
pub(crate) struct FitRequirements {
    /// Degrees of freedom, in the order of rows and columns.
    pub dofs: Vec<Dof>,
    /// Highest tested reduced frequency.
    pub k_max: f64,
    pub constraints: Constraints,
    /// Value and slope at K → 0 of every transfer function, row by row; empty for none.
    pub limits: Vec<[Option<f64>; 2]>,
}

impl FitRequirements {
    /// Whether anything is asked.
    pub(crate) fn any(&self) -> bool {
        self.constraints == Constraints::Dissipative || !self.limits.is_empty()
    }
}

/// One equation: the sum of rows over the coefficients of transfer functions is `target`.
#[derive(Debug, Clone)]
pub(super) struct Equation {
    kind: ConstraintKind,
    /// Row and column of the transfer function that it names.
    entry: (usize, usize),
    rows: Vec<(usize, Vec<f64>)>,
    target: f64,
}

/// The equations of a model with given bases, row by row.
pub(super) fn equations(
    bases: &[Basis],
    n: usize,
    requirements: &FitRequirements,
) -> Vec<Equation> {
    let mut all = Vec::new();
    if requirements.constraints == Constraints::Dissipative && bases[0].feed().e2 {
        let row = |e: usize, sign: f64| {
            let row = ConstraintKind::SymmetricAddedMass.row(None, &bases[e]);
            (e, row.into_iter().map(|x| sign * x).collect())
        };
        for i in 0..n {
            all.extend((0..i).map(|j| Equation {
                kind: ConstraintKind::SymmetricAddedMass,
                entry: (i, j),
                rows: vec![row(i * n + j, 1.0), row(j * n + i, -1.0)],
                target: 0.0,
            }));
        }
    }
    for (e, limits) in requirements.limits.iter().enumerate() {
        for (kind, target) in [ConstraintKind::ValueAtZero, ConstraintKind::SlopeAtZero]
            .into_iter()
            .zip(limits)
        {
            all.extend(target.map(|target| Equation {
                kind,
                entry: (e / n, e % n),
                rows: vec![(e, kind.row(None, &bases[e]))],
                target,
            }));
        }
    }
    all
}

impl Equation {
    fn value(&self, coefficients: &[Vec<f64>]) -> f64 {
        let dot = |(e, row): &(usize, Vec<f64>)| -> f64 {
            row.iter().zip(&coefficients[*e]).map(|(a, c)| a * c).sum()
        };
        self.rows.iter().map(dot).sum()
    }

    fn gradient(&self, entries: &[AffineMap], width: usize) -> DVector<f64> {
        let mut gradient = DVector::zeros(width);
        for (e, row) in &self.rows {
            entries[*e].add_gradient(row, 1.0, &mut gradient);
        }
        gradient
    }

    pub(crate) fn account(
        &self,
        n: usize,
        alone: &[Vec<f64>],
        held: &[Vec<f64>],
    ) -> ActiveConstraint {
        ActiveConstraint {
            kind: self.kind,
            k: None,
            entry: Some(self.entry),
            direction: vec![0.0; n],
            alone: self.value(alone),
            held: self.value(held),
            limit: None,
        }
    }
}

/// The free numbers that satisfy the equations.
///
/// # Errors
/// [`Error::Input`](crate::error::Error::Input) for limits that the columns of the model cannot meet.
pub(super) fn satisfy(
    equations: &[Equation],
    entries: &[AffineMap],
    width: usize,
) -> Result<AffineSpace> {
    let mut space = AffineSpace::whole(width);
    let alone: Vec<Vec<f64>> = entries.iter().map(|e| e.values.clone()).collect();
    for equation in equations {
        let gradient = equation.gradient(entries, width);
        let target = equation.target - equation.value(&alone);
        if !space.hold(&gradient, target, RANK_TOLERANCE) {
            let short = target - gradient.dot(&space.start);
            ensure(
                short.abs() <= AGREEMENT * equation.target.abs().max(gradient.norm()),
                "limits",
                "limits at K → 0 that the columns of the model can meet",
                "a feed-through is missing, or one limit repeats another",
            )?;
        }
    }
    Ok(space)
}
