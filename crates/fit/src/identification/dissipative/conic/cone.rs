//! One linear matrix inequality as a second-order cone.

use super::second_order::Vector;
use nalgebra::DVector;

/// `bound − rows · w` is in the cone.
#[derive(Debug, Clone)]
pub(crate) struct Cone {
    pub(super) rows: Vec<DVector<f64>>,
    pub(super) bound: Vector,
}

impl Cone {
    /// `gradient · w ≤ bound`.
    pub(crate) fn half_space(gradient: DVector<f64>, bound: f64) -> Self {
        Self {
            rows: vec![gradient],
            bound: [bound, 0.0, 0.0],
        }
    }

    /// `Σ gradients w ⪯ bound` for the entries 11, 22, 12 of symmetric matrices of order two.
    pub(crate) fn matrix(gradients: [DVector<f64>; 3], bound: Vector) -> Self {
        let [one, two, across] = gradients;
        let root = std::f64::consts::FRAC_1_SQRT_2;
        Self {
            bound: [
                (bound[0] + bound[1]) * root,
                (bound[0] - bound[1]) * root,
                bound[2] / root,
            ],
            rows: vec![(&one + &two) * root, (one - two) * root, across / root],
        }
    }

    /// The same inequality with rows of the size of one.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self {
            rows: self.rows.iter().map(|r| r * factor).collect(),
            bound: self.bound.map(|b| b * factor),
        }
    }

    pub(super) fn size(&self) -> f64 {
        self.rows
            .iter()
            .map(DVector::norm_squared)
            .sum::<f64>()
            .sqrt()
    }
}
