//! The discrete Laguerre model of the thesis (2.16, 2.33, 4.2): filters advancing by one `Δs`, no feed-through.

use crate::aerodynamics::{AerodynamicModel, DiscreteRealization, Realization, TransferMatrix};
use crate::error::{Error, Result, positive};
use crate::section::Dof;
use crate::units::ReducedFrequency;
use nalgebra::{Complex, DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Discrete Laguerre model, one bank of `L` filters a motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DiscreteLaguerre {
    /// Degrees of freedom of rows and columns.
    pub dofs: Vec<Dof>,
    /// Decay factor `0 < α < 1`; it belongs to one `Δs`.
    pub alpha: f64,
    /// Step in dimensionless time, `Δs = VΔt/B`.
    pub delta_s: f64,
    /// `c`, one n×L matrix a motion: `coefficients[j][(i, l)]` is filter `l` of motion `j` in force `i`.
    #[serde(with = "crate::state_space::rows::list")]
    pub coefficients: Vec<DMatrix<f64>>,
    /// Static term of each force (the constant of 2.23), dimensionless; a deviation from equilibrium leaves it out.
    pub static_term: Vec<f64>,
}

/// `A_L` (L×L) and `B_L` (L) of equation (4.2): `S(k+1) = A_L S(k) + B_L v(k+1)`.
pub fn discrete_filter_matrices(alpha: f64, count: usize) -> (DMatrix<f64>, DVector<f64>) {
    let root = alpha.sqrt();
    // (2.33) read as x_l[k] = √α x_l[k−1] + √α x_{l−1}[k] − x_{l−1}[k−1]
    let mut a = DMatrix::zeros(count, count);
    let mut b = DVector::zeros(count);
    for l in 0..count {
        if l == 0 {
            b[0] = (1.0 - alpha).sqrt();
        } else {
            for j in 0..l {
                a[(l, j)] = root * a[(l - 1, j)];
            }
            a[(l, l - 1)] -= 1.0;
            b[l] = root * b[l - 1];
        }
        a[(l, l)] += root;
    }
    (a, b)
}

/// Impulse responses `g_0[k] … g_{L−1}[k]` for `k = 0 … samples−1`, as an L×samples matrix.
pub fn impulse_response(alpha: f64, count: usize, samples: usize) -> DMatrix<f64> {
    let (a, mut state) = discrete_filter_matrices(alpha, count);
    let mut g = DMatrix::zeros(count, samples);
    for k in 0..samples {
        g.column_mut(k).copy_from(&state);
        state = &a * state;
    }
    g
}

/// Lower bound of `α` for signals up to `f_max` sampled at `f_s` (guideline 2.36), both in Hz.
pub fn alpha_lower_bound(f_max_hz: f64, sampling_hz: f64) -> f64 {
    let c = (TAU * f_max_hz / sampling_hz).cos();
    (2.0 - c - (c * c - 4.0 * c + 3.0).sqrt()).powi(2)
}

impl DiscreteLaguerre {
    /// Number of filters `L`.
    pub fn filters(&self) -> usize {
        self.coefficients.first().map_or(0, DMatrix::ncols)
    }

    /// Checks ranges and shapes.
    ///
    /// # Errors
    /// [`Error::Input`] naming the field that does not fit.
    pub fn validate(&self) -> Result<()> {
        let place = |field: &str| format!("discrete Laguerre model: {field}");
        if !(self.alpha > 0.0 && self.alpha < 1.0) {
            return Err(Error::input(
                place("alpha"),
                "0 < alpha < 1",
                self.alpha.to_string(),
            ));
        }
        positive(&place("delta_s"), self.delta_s)?;
        let (n, filters) = (self.dofs.len(), self.filters());
        let fits = |m: &DMatrix<f64>| m.shape() == (n, filters) && m.iter().all(|x| x.is_finite());
        if self.coefficients.len() != n || filters == 0 || !self.coefficients.iter().all(fits) {
            return Err(Error::input(
                place("coefficients"),
                format!("{n} finite matrices of {n} rows and one width, at least one filter"),
                "another shape or a number that is not finite",
            ));
        }
        if self.static_term.len() != n || !self.static_term.iter().all(|x| x.is_finite()) {
            return Err(Error::input(
                place("static_term"),
                format!("{n} finite numbers"),
                format!("{:?}", self.static_term),
            ));
        }
        Ok(())
    }
}

impl AerodynamicModel for DiscreteLaguerre {
    fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    /// `G_0 = √(1−α)/(1 − √α z⁻¹)`, `G_l = G_{l−1} (√α − z⁻¹)/(1 − √α z⁻¹)` at `z = e^{iKΔs}` (2.17).
    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        let back = Complex::new(0.0, -k.full_width() * self.delta_s).exp();
        let root = self.alpha.sqrt();
        let denominator = -back * root + 1.0;
        let n = self.dofs.len();
        let mut g = DMatrix::zeros(n, n);
        let mut filter = denominator.inv() * (1.0 - self.alpha).sqrt();
        for l in 0..self.filters() {
            for (j, c) in self.coefficients.iter().enumerate() {
                for i in 0..n {
                    g[(i, j)] += filter * c[(i, l)];
                }
            }
            filter *= (-back + root) / denominator;
        }
        Ok(g)
    }

    /// Two (three) banks, one a motion: the four banks of the thesis repeat the same states.
    fn realize(&self) -> Option<Realization> {
        let (n, filters) = (self.dofs.len(), self.filters());
        let (chain, drive) = discrete_filter_matrices(self.alpha, filters);
        let mut a = DMatrix::zeros(n * filters, n * filters);
        let mut b = DMatrix::zeros(n * filters, n);
        let mut c = DMatrix::zeros(n, n * filters);
        for j in 0..n {
            let at = j * filters;
            a.view_mut((at, at), (filters, filters)).copy_from(&chain);
            b.view_mut((at, j), (filters, 1)).copy_from(&drive);
            c.view_mut((0, at), (n, filters))
                .copy_from(&self.coefficients[j]);
        }
        Some(Realization::Discrete(DiscreteRealization {
            a,
            b,
            c,
            delta_s: self.delta_s,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matrices_are_those_of_equation_4_2() {
        let (a, b) = discrete_filter_matrices(0.6, 3);
        let r = 0.6_f64.sqrt();
        let expected = [r, 0.0, 0.0, -0.4, r, 0.0, -0.4 * r, -0.4, r];
        for (i, e) in expected.iter().enumerate() {
            assert!((a[(i / 3, i % 3)] - e).abs() < 1e-15);
        }
        assert!((b[0] - 0.4_f64.sqrt()).abs() < 1e-15);
        assert!((b[2] - 0.4_f64.sqrt() * 0.6).abs() < 1e-15);
    }

    /// Section 2.5: at α = 0.889 the last of four filters has decayed to 0.0096 at sample 176; bounds of (2.36).
    #[test]
    fn memory_and_alpha_guidelines() {
        let g = impulse_response(0.889, 4, 400);
        assert!((g[(3, 176)].abs() - 0.0096).abs() < 5e-5, "{}", g[(3, 176)]);
        assert!((176..400).all(|k| g[(3, k)].abs() <= 0.01));
        assert!((alpha_lower_bound(3.0, 200.0) - 0.8283).abs() < 5e-5);
        assert!((alpha_lower_bound(2.5, 200.0) - 0.8547).abs() < 5e-5);
    }

    #[test]
    fn realisation_and_closed_form_agree() {
        let model = DiscreteLaguerre {
            dofs: Dof::TWO.to_vec(),
            alpha: 0.6,
            delta_s: 0.08,
            coefficients: (0..2)
                .map(|j| DMatrix::from_fn(2, 3, |i, l| 1.0 + i as f64 - 0.5 * l as f64 * j as f64))
                .collect(),
            static_term: vec![0.0; 2],
        };
        model.validate().unwrap();
        let realization = model.realize().unwrap();
        for k in [0.1, 0.7, 1.4] {
            let k = ReducedFrequency::from_full_width(k);
            let difference = model.transfer(k).unwrap() - realization.transfer(k).unwrap();
            assert!(difference.iter().all(|z| z.norm() < 1e-12));
        }
    }
}
