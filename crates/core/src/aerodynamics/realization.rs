//! State-space realisations of `G` in dimensionless time `s = Vt/B`.

use super::TransferMatrix;
use crate::error::{Error, Result};
use crate::state_space::complex;
use crate::units::ReducedFrequency;
use nalgebra::{Complex, DMatrix};

/// A realisation: continuous in `s`, or advancing by a fixed `Δs`.
#[derive(Debug, Clone, PartialEq)]
pub enum Realization {
    /// Feed-through and filters, continuous in `s`.
    Continuous(ContinuousRealization),
    /// Filters sampled every `Δs`.
    Discrete(DiscreteRealization),
}

impl Realization {
    /// Number of aerodynamic states.
    pub fn states(&self) -> usize {
        match self {
            Self::Continuous(c) => c.a.nrows(),
            Self::Discrete(d) => d.a.nrows(),
        }
    }

    /// Transfer matrix of the realisation, the second path to `G(K)`.
    ///
    /// # Errors
    /// [`Error::Numerical`] when `iK` is a pole.
    pub fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        match self {
            Self::Continuous(c) => c.transfer(k),
            Self::Discrete(d) => d.transfer(k),
        }
    }
}

/// `x' = A x + B r`, `q = e₀ r + e₁ r' + e₂ r'' + C x`, with `' = d/ds`.
#[derive(Debug, Clone, PartialEq)]
pub struct ContinuousRealization {
    /// Filter matrix, N×N.
    pub a: DMatrix<f64>,
    /// Input matrix, N×n.
    pub b: DMatrix<f64>,
    /// Output matrix, n×N.
    pub c: DMatrix<f64>,
    /// Feed-through of the motion, n×n.
    pub e0: DMatrix<f64>,
    /// Feed-through of its rate, n×n.
    pub e1: DMatrix<f64>,
    /// Feed-through of its acceleration (added mass), n×n.
    pub e2: DMatrix<f64>,
}

impl ContinuousRealization {
    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        let p = Complex::new(0.0, k.full_width());
        let feed = complex(&self.e0) + complex(&self.e1) * p + complex(&self.e2) * (p * p);
        if self.a.is_empty() {
            return Ok(feed);
        }
        let n = self.a.nrows();
        let x = (DMatrix::identity(n, n) * p - complex(&self.a))
            .lu()
            .solve(&complex(&self.b))
            .ok_or_else(|| Error::Numerical(format!("aerodynamic transfer: {p} is a pole")))?;
        Ok(feed + complex(&self.c) * x)
    }
}

/// `S(k+1) = A S(k) + B r(k+1)`, `q(k) = C S(k)`, one step every `Δs` (equations 4.1 of the thesis).
///
/// The motion enters at the new sample: the filters have a direct path (`g_l[0] ≠ 0`).
#[derive(Debug, Clone, PartialEq)]
pub struct DiscreteRealization {
    /// Filter matrix, N×N.
    pub a: DMatrix<f64>,
    /// Input matrix, N×n.
    pub b: DMatrix<f64>,
    /// Output matrix, n×N.
    pub c: DMatrix<f64>,
    /// Step in dimensionless time, `Δs = VΔt/B`.
    pub delta_s: f64,
}

impl DiscreteRealization {
    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        let back = Complex::new(0.0, -k.full_width() * self.delta_s).exp();
        let n = self.a.nrows();
        let s = (DMatrix::identity(n, n) - complex(&self.a) * back)
            .lu()
            .solve(&complex(&self.b))
            .ok_or_else(|| Error::Numerical("aerodynamic transfer: a pole on the circle".into()))?;
        Ok(complex(&self.c) * s)
    }
}
