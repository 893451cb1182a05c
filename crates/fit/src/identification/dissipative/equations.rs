//! Equations that coefficients have to satisfy besides: symmetric added mass, limits at K → 0.

use super::report::{ActiveConstraint, ConstraintKind};
use crate::identification::basis::Basis;
use crate::identification::form::{LEAST_CHOSEN, MOST_CHOSEN};
use crate::section::Dof;
use crate::units::ReducedFrequencyRange;
use serde::{Deserialize, Serialize};

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
    /// Without limits.
    pub(crate) fn new(
        dofs: &[Dof],
        tested: ReducedFrequencyRange,
        constraints: Constraints,
    ) -> Self {
        Self {
            dofs: dofs.to_vec(),
            k_max: tested.max.full_width(),
            constraints,
            limits: Vec::new(),
        }
    }

    /// Whether anything is asked.
    pub(crate) fn any(&self) -> bool {
        self.constraints == Constraints::Dissipative || !self.limits.is_empty()
    }
}

/// The equations of a model with given bases, row by row: what each holds, and at which value.
pub(super) fn equations(
    bases: &[Basis],
    n: usize,
    requirements: &FitRequirements,
) -> Vec<(ActiveConstraint, f64)> {
    let mut all = Vec::new();
    let equation = |kind, i: usize, j: usize| ActiveConstraint {
        kind,
        k: None,
        entry: Some((i, j)),
        direction: vec![0.0; n],
        alone: 0.0,
        held: 0.0,
        limit: None,
    };
    if requirements.constraints == Constraints::Dissipative && bases[0].feed().e2 {
        let kind = ConstraintKind::SymmetricAddedMass;
        for i in 0..n {
            all.extend((0..i).map(|j| (equation(kind, i, j), 0.0)));
        }
    }
    for (e, limits) in requirements.limits.iter().enumerate() {
        let kinds = [ConstraintKind::ValueAtZero, ConstraintKind::SlopeAtZero];
        for (kind, target) in kinds.into_iter().zip(limits) {
            all.extend(target.map(|target| (equation(kind, e / n, e % n), target)));
        }
    }
    all
}
