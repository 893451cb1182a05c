//! Linear systems in state space, their poles, frequency responses and exact discretisation.

mod discretize;
mod francis;
mod poles;
mod roots;
pub mod rows;

pub use discretize::{StepMatrices, c2d, step_matrix};
pub use poles::{RepeatedEigenvalues, eigenvector};
pub use poles::{balance, eigenvalues};
pub use roots::golden_section;
pub use roots::{ValueAt, boundary, root, secant};

use crate::error::{Error, Result};
use nalgebra::{Complex, ComplexField, DMatrix};

/// Time basis of a continuous system.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::state_space::{Continuous, StateSpace};
/// use nalgebra::DMatrix;
///
/// // ẍ + 0.2 ẋ + x = u
/// let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -1.0, -0.2]);
/// let b = DMatrix::from_row_slice(2, 1, &[0.0, 1.0]);
/// let c = DMatrix::from_row_slice(1, 2, &[1.0, 0.0]);
/// let oscillator = StateSpace::new(a, b, c.clone(), DMatrix::zeros(1, 1), Continuous)?;
/// assert!((oscillator.freqresp(0.0)?[(0, 0)].re - 1.0).abs() < 1e-12);
/// # Ok::<(), aerodeck::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Continuous;

/// Time basis of a sampled system.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::state_space::{Continuous, Discrete, StateSpace};
/// use nalgebra::DMatrix;
///
/// // ẍ + 0.2 ẋ + x = u
/// let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -1.0, -0.2]);
/// let b = DMatrix::from_row_slice(2, 1, &[0.0, 1.0]);
/// let c = DMatrix::from_row_slice(1, 2, &[1.0, 0.0]);
/// let oscillator = StateSpace::new(a, b, c.clone(), DMatrix::zeros(1, 1), Continuous)?;
/// let step = oscillator.c2d(0.5)?;
/// let sampled = StateSpace::new(step.phi, step.gamma_0, c, DMatrix::zeros(1, 1), Discrete { step: 0.5 })?;
/// assert!(sampled.poles()?.iter().all(|z| z.norm() < 1.0));
/// # Ok::<(), aerodeck::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Discrete {
    /// Sampling step, in the time unit of the system (s, or dimensionless `Δs`).
    pub step: f64,
}

/// `ẋ = A x + B u` or `x(k+1) = A x(k) + B u(k)`, with `y = C x + D u`.
///
/// The time basis is part of the type, so that a sampled system cannot be used as a continuous one.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::state_space::{Continuous, StateSpace};
/// use nalgebra::DMatrix;
///
/// // ẍ + 0.2 ẋ + x = u
/// let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -1.0, -0.2]);
/// let b = DMatrix::from_row_slice(2, 1, &[0.0, 1.0]);
/// let c = DMatrix::from_row_slice(1, 2, &[1.0, 0.0]);
/// let oscillator = StateSpace::new(a, b, c.clone(), DMatrix::zeros(1, 1), Continuous)?;
/// for pole in oscillator.poles()? {
///     assert!((pole.norm() - 1.0).abs() < 1e-12 && (pole.re + 0.1).abs() < 1e-12);
/// }
/// # Ok::<(), aerodeck::Error>(())
/// ```
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
    /// Step matrices for the step `h`: exact when the inputs run on a straight line over it.
    ///
    /// # Errors
    /// [`Error::Numerical`] when the step is not finite or so long that no digit would be right.
    pub fn c2d(&self, h: f64) -> Result<StepMatrices> {
        c2d(&self.a, &self.b, h)
    }

    /// Poles: the eigenvalues of `A`, in the inverse time unit. Exact when they are distinct, to rounding times the condition
    /// of `A`; a pole repeated n times is known to the n-th root of that.
    ///
    /// # Errors
    /// [`Error::Numerical`] when the iteration for them does not end.
    pub fn poles(&self) -> Result<Vec<Complex<f64>>> {
        eigenvalues(&self.a)
    }

    /// Natural frequency and damping ratio of every pole; exact when the poles are.
    ///
    /// # Errors
    /// As for [`poles`](Self::poles).
    pub fn damp(&self) -> Result<Vec<Damping>> {
        Ok(self.poles()?.into_iter().map(Damping::from_pole).collect())
    }

    /// `C (iωI − A)⁻¹ B + D`, p×m: exact when the transients have died out, to rounding times the condition of `iωI − A`.
    ///
    /// # Errors
    /// [`Error::Numerical`] when `iω` is a pole.
    pub fn freqresp(&self, omega: f64) -> Result<DMatrix<Complex<f64>>> {
        self.response_at(Complex::new(0.0, omega))
    }
}

impl StateSpace<Discrete> {
    /// Poles: the eigenvalues of `A`, in the z-plane; exact when they are distinct, as those of a continuous system.
    ///
    /// # Errors
    /// [`Error::Numerical`] when the iteration for them does not end.
    pub fn poles(&self) -> Result<Vec<Complex<f64>>> {
        eigenvalues(&self.a)
    }

    /// Natural frequency and damping ratio of the rates `ln z/h`: exact when the motion between two samples holds no frequency
    /// above half the sampling frequency. A pole at the origin has died out after one step and is left out: no finite rate
    /// describes it.
    ///
    /// # Errors
    /// As for [`poles`](Self::poles).
    pub fn damp(&self) -> Result<Vec<Damping>> {
        let poles = self.poles()?.into_iter();
        let finite = poles.filter(|z| z.norm() > f64::MIN_POSITIVE);
        Ok(finite
            .map(|z| Damping::from_pole(z.ln() / self.time.step))
            .collect())
    }

    /// `C (e^{iωh}I − A)⁻¹ B + D`, p×m: exact at the samples when the transients have died out.
    ///
    /// # Errors
    /// [`Error::Numerical`] when `e^{iωh}` is a pole.
    pub fn freqresp(&self, omega: f64) -> Result<DMatrix<Complex<f64>>> {
        self.response_at(Complex::new(0.0, omega * self.time.step).exp())
    }
}

/// `ẋ = A x + B u`.
#[derive(Debug, Clone)]
pub struct StateEquation {
    /// State matrix, n×n.
    pub a: DMatrix<f64>,
    /// Input matrix, n×m.
    pub b: DMatrix<f64>,
}

/// One pole as a table of damping has it.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::state_space::{Continuous, StateSpace};
/// use nalgebra::DMatrix;
///
/// // ẍ + 0.2 ẋ + x = u
/// let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -1.0, -0.2]);
/// let b = DMatrix::from_row_slice(2, 1, &[0.0, 1.0]);
/// let c = DMatrix::from_row_slice(1, 2, &[1.0, 0.0]);
/// let oscillator = StateSpace::new(a, b, c.clone(), DMatrix::zeros(1, 1), Continuous)?;
/// let mode = oscillator.damp()?[0];
/// assert!((mode.natural_frequency - 1.0).abs() < 1e-12 && (mode.damping_ratio - 0.1).abs() < 1e-12);
/// # Ok::<(), aerodeck::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damping {
    /// The pole `λ` in continuous time, in the inverse time unit.
    pub pole: Complex<f64>,
    /// `|λ|`, rad per time unit.
    pub natural_frequency: f64,
    /// `−Re λ/|λ|`; negative when the motion grows.
    pub damping_ratio: f64,
}

impl Damping {
    fn from_pole(pole: Complex<f64>) -> Self {
        Self {
            pole,
            natural_frequency: pole.norm(),
            damping_ratio: damping_ratio(pole),
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// `ẍ + 2ζω₀ẋ + ω₀²x = u`, continuous and sampled with its input held: the damping table has the closed form for both, and
    /// holding changes nothing of the answer to a constant input.
    #[test]
    fn a_sampled_oscillator_has_the_damping_of_the_continuous_one() {
        let (frequency, ratio, h) = (3.0, 0.02, 0.1);
        let a = DMatrix::from_row_slice(
            2,
            2,
            &[0.0, 1.0, -frequency * frequency, -2.0 * ratio * frequency],
        );
        let b = DMatrix::from_row_slice(2, 1, &[0.0, 1.0]);
        let c = DMatrix::from_row_slice(1, 2, &[1.0, 0.0]);
        let d = DMatrix::zeros(1, 1);
        let continuous = StateSpace::new(a, b, c.clone(), d.clone(), Continuous).unwrap();
        let held = continuous.c2d(h).unwrap();
        let discrete = StateSpace::new(held.phi, held.gamma_0, c, d, Discrete { step: h }).unwrap();
        for modes in [continuous.damp().unwrap(), discrete.damp().unwrap()] {
            assert_eq!(modes.len(), 2);
            for mode in modes {
                assert!((mode.natural_frequency / frequency - 1.0).abs() < 1e-12);
                assert!((mode.damping_ratio / ratio - 1.0).abs() < 1e-12);
            }
        }
        for z in discrete.poles().unwrap() {
            assert!((z.norm() - (-ratio * frequency * h).exp()).abs() < 1e-14);
        }
        let static_gain = 1.0 / (frequency * frequency);
        for gain in [continuous.freqresp(0.0), discrete.freqresp(0.0)] {
            assert!((gain.unwrap()[0].re / static_gain - 1.0).abs() < 1e-12);
        }
    }
}
