//! Linear systems in state space, their poles and exact discretisation.

mod discretize;
mod francis;
mod poles;
mod roots;
pub mod rows;

pub use discretize::{StepMatrices, c2d, step_matrix};
pub use poles::{balance, eigenvalues};
pub use poles::{eigenvector, write_eigenvalues};
pub use roots::golden_section;
pub use roots::{ValueAt, boundary, root, secant};

use nalgebra::{Complex, ComplexField, DMatrix};

/// A complex number.
pub(crate) type Complex64 = Complex<f64>;

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
/// use aerodeck::state_space::{Damping, eigenvalues};
/// use nalgebra::DMatrix;
///
/// // ẍ + 0.2 ẋ + x = 0
/// let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -1.0, -0.2]);
/// let mode = Damping::from_pole(eigenvalues(&a)?[0]);
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
    /// Of a pole in continuous time, in the inverse time unit; exact.
    pub fn from_pole(pole: Complex<f64>) -> Self {
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
