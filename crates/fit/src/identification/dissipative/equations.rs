//! Equations that coefficients have to satisfy besides: symmetric added mass, limits at K → 0.

use super::report::{ActiveConstraint, ConstraintKind};
use super::tangent::{LinearEntry, take_away};
use crate::error::{Result, ensure};
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
pub(super) fn equations(bases: &[Basis], n: usize, wishes: &FitRequirements) -> Vec<Equation> {
    let mut all = Vec::new();
    if wishes.constraints == Constraints::Dissipative && bases[0].feed().e2 {
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
    for (e, limits) in wishes.limits.iter().enumerate() {
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

    fn gradient(&self, entries: &[LinearEntry], width: usize) -> DVector<f64> {
        let mut gradient = DVector::zeros(width);
        for (e, row) in &self.rows {
            let entry = &entries[*e];
            for (c, x) in row.iter().enumerate() {
                for (m, s) in entry.spread.row(c).iter().enumerate() {
                    gradient[entry.at + m] += x * s;
                }
            }
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

/// Orthonormal gradients of the equations, and the shortest free numbers that satisfy them.
///
/// # Errors
/// [`Error::Input`](crate::error::Error::Input) for limits that the columns of the model cannot meet.
pub(super) fn satisfy(
    equations: &[Equation],
    entries: &[LinearEntry],
    width: usize,
) -> Result<(Vec<DVector<f64>>, DVector<f64>)> {
    let mut columns: Vec<DVector<f64>> = Vec::new();
    let mut start = DVector::zeros(width);
    for equation in equations {
        let mut gradient = equation.gradient(entries, width);
        let norm = gradient.norm();
        take_away(&mut gradient, &columns);
        take_away(&mut gradient, &columns);
        let at_start: Vec<Vec<f64>> = entries.iter().map(|e| e.coefficients(&start)).collect();
        let short = equation.target - equation.value(&at_start);
        let left = gradient.norm();
        if left <= RANK_TOLERANCE * norm {
            ensure(
                short.abs() <= AGREEMENT * equation.target.abs().max(norm),
                "limits",
                "limits at K → 0 that the columns of the model can meet",
                "a feed-through is missing, or one limit repeats another",
            )?;
            continue;
        }
        gradient.unscale_mut(left);
        start.axpy(short / left, &gradient, 1.0);
        columns.push(gradient);
    }
    Ok((columns, start))
}
