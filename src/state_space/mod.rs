//! Linear systems in state space, their poles, frequency responses and exact discretisation.

mod discretize;
mod francis;
mod poles;
mod roots;
pub mod rows;

pub use discretize::{StepMatrices, c2d, matrix_exponential};
pub use poles::{balance, eigenvalues, eigenvector};
pub use roots::{boundary, golden_section, root};

use crate::error::{Error, Result};
use nalgebra::{Complex, ComplexField, DMatrix};

/// Time basis of a continuous system.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Continuous;

/// Time basis of a sampled system.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Discrete {
    /// Sampling step, in the time unit of the system (s, or dimensionless `Δs`).
    pub step: f64,
}

/// `ẋ = A x + B u` or `x(k+1) = A x(k) + B u(k)`, with `y = C x + D u`.
///
/// The time basis is part of the type, so that a sampled system cannot be used as a continuous one.
#[derive(Debug, Clone, PartialEq)]
pub struct StateSpace<T> {
    /// State matrix, n×n.
    pub a: DMatrix<f64>,
    /// Input matrix, n×m.
    pub b: DMatrix<f64>,
    /// Output matrix, p×n.
    pub c: DMatrix<f64>,
    /// Feed-through, p×m.
    pub d: DMatrix<f64>,
    /// Time basis.
    pub time: T,
}

impl<T> StateSpace<T> {
    /// Checks the shapes once; everything downstream relies on them.
    ///
    /// # Errors
    /// [`Error::Numerical`] with the sizes that do not fit, or when an entry is not finite.
    pub fn new(
        a: DMatrix<f64>,
        b: DMatrix<f64>,
        c: DMatrix<f64>,
        d: DMatrix<f64>,
        time: T,
    ) -> Result<Self> {
        let n = a.nrows();
        if a.ncols() != n || b.nrows() != n || c.ncols() != n || d.shape() != (c.nrows(), b.ncols())
        {
            let shape = |m: &DMatrix<f64>| format!("{}x{}", m.nrows(), m.ncols());
            return Err(Error::Numerical(format!(
                "state space: A is {}, B {}, C {}, D {}; A must be square and B, C, D fit it",
                shape(&a),
                shape(&b),
                shape(&c),
                shape(&d)
            )));
        }
        if ![&a, &b, &c, &d]
            .iter()
            .all(|m| m.iter().all(|x| x.is_finite()))
        {
            return Err(Error::Numerical(
                "state space: a matrix entry is not finite".into(),
            ));
        }
        Ok(Self { a, b, c, d, time })
    }

    /// `C (λI − A)⁻¹ B + D` at the complex point `λ`.
    fn response_at(&self, lambda: Complex<f64>) -> Result<DMatrix<Complex<f64>>> {
        let resolvent = DMatrix::<Complex<f64>>::identity(self.a.nrows(), self.a.nrows()) * lambda
            - complex(&self.a);
        let x = resolvent.lu().solve(&complex(&self.b)).ok_or_else(|| {
            Error::Numerical(format!(
                "frequency response: {lambda} is a pole of the system"
            ))
        })?;
        Ok(complex(&self.c) * x + complex(&self.d))
    }
}

impl StateSpace<Continuous> {
    /// Step matrices for the step `h`; exact for inputs that run on a straight line over it.
    pub fn c2d(&self, h: f64) -> Result<StepMatrices> {
        c2d(&self.a, &self.b, h)
    }

    /// Poles, in the inverse time unit.
    pub fn poles(&self) -> Result<Vec<Complex<f64>>> {
        eigenvalues(&self.a)
    }

    /// `C (iωI − A)⁻¹ B + D`, p×m.
    ///
    /// # Errors
    /// [`Error::Numerical`] when `iω` is a pole.
    pub fn freqresp(&self, omega: f64) -> Result<DMatrix<Complex<f64>>> {
        self.response_at(Complex::new(0.0, omega))
    }
}

impl StateSpace<Discrete> {
    /// Poles in continuous time, `ln z/h`. A pole at the origin has died out after one step and is left out: no finite rate
    /// describes it.
    pub fn poles(&self) -> Result<Vec<Complex<f64>>> {
        let finite = eigenvalues(&self.a)?
            .into_iter()
            .filter(|z| z.norm() > f64::MIN_POSITIVE);
        Ok(finite.map(|z| z.ln() / self.time.step).collect())
    }

    /// `C (e^{iωh}I − A)⁻¹ B + D`, p×m.
    ///
    /// # Errors
    /// [`Error::Numerical`] when `e^{iωh}` is a pole.
    pub fn freqresp(&self, omega: f64) -> Result<DMatrix<Complex<f64>>> {
        self.response_at(Complex::new(0.0, omega * self.time.step).exp())
    }
}

/// `[0 I; M⁻¹K M⁻¹R]`, 2n×2n: the state matrix of `[q, q̇]` with `M q̈ = K q + R q̇`.
pub fn first_order<T: ComplexField>(
    inverse_mass: &DMatrix<T>,
    on_motion: &DMatrix<T>,
    on_rate: &DMatrix<T>,
) -> DMatrix<T> {
    let n = inverse_mass.nrows();
    let mut a = DMatrix::zeros(2 * n, 2 * n);
    a.view_mut((0, n), (n, n)).fill_with_identity();
    a.view_mut((n, 0), (n, n))
        .copy_from(&(inverse_mass * on_motion));
    a.view_mut((n, n), (n, n))
        .copy_from(&(inverse_mass * on_rate));
    a
}

/// Damping ratio of a continuous-time pole, `−Re λ/|λ|`.
pub fn damping_ratio(pole: Complex<f64>) -> f64 {
    -pole.re / pole.norm()
}

/// A real matrix as a complex one.
pub fn complex(real: &DMatrix<f64>) -> DMatrix<Complex<f64>> {
    real.map(|x| Complex::new(x, 0.0))
}
