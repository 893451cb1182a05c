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

/// Whether every number beside the diagonal of a square matrix is zero.
pub(crate) fn is_diagonal(m: &DMatrix<f64>) -> bool {
    (0..m.len()).all(|i| i % (m.nrows() + 1) == 0 || m[i] == 0.0)
}

/// Damping ratio of a continuous-time pole, `−Re λ/|λ|`.
pub fn damping_ratio(pole: Complex<f64>) -> f64 {
    -pole.re / pole.norm()
}

/// A real matrix as a complex one.
pub fn complex(real: &DMatrix<f64>) -> DMatrix<Complex<f64>> {
    real.map(|x| Complex::new(x, 0.0))
}
