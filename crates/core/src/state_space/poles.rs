//! Eigenvalues of balanced matrices and single eigenvectors.

use super::complex;
use super::francis::{append_eigenvalues, reduce};
use crate::error::{Error, Result};
use nalgebra::{Complex, DMatrix, DVector};

/// Scales rows and columns by powers of two until their norms agree (Parlett & Reinsch 1969): `D⁻¹ A D`.
///
/// Exact in floating point and eigenvalue-preserving; lag states in newtons beside metres otherwise cost digits.
pub fn balance(a: &DMatrix<f64>) -> DMatrix<f64> {
    let mut m = a.clone();
    balance_in_place(&mut m);
    m
}

fn balance_in_place(m: &mut DMatrix<f64>) {
    let n = m.nrows();
    loop {
        let mut balanced = true;
        for i in 0..n {
            let off_diagonal = |values: &mut dyn Iterator<Item = (usize, f64)>| {
                values
                    .filter(|(j, _)| *j != i)
                    .map(|(_, x)| x.abs())
                    .sum::<f64>()
            };
            let column = off_diagonal(&mut m.column(i).iter().copied().enumerate());
            let row = off_diagonal(&mut m.row(i).iter().copied().enumerate());
            if column == 0.0 || row == 0.0 {
                continue;
            }
            let exponent = (0.5 * (row / column).log2()).round() as i32;
            let scale = 2f64.powi(exponent);
            if column * scale + row / scale < 0.95 * (column + row) {
                m.column_mut(i).scale_mut(scale);
                m.row_mut(i).scale_mut(1.0 / scale);
                balanced = false;
            }
        }
        if balanced {
            return;
        }
    }
}

/// All eigenvalues of a square real matrix.
///
/// Repeated poles of an uncoupled filter chain come out on a small ring around their true place
/// (the chain is defective); structural modes are accurate to rounding.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::state_space::eigenvalues;
/// use nalgebra::DMatrix;
///
/// let rotation = DMatrix::from_row_slice(2, 2, &[0.0, -3.0, 3.0, 0.0]);
/// assert!(eigenvalues(&rotation)?.iter().all(|z| (z.norm() - 3.0).abs() < 1e-15));
/// # Ok::<(), aerodeck::Error>(())
/// ```
///
/// # Errors
/// [`Error::Numerical`] when an entry is not finite or the iteration does not converge.
pub fn eigenvalues(a: &DMatrix<f64>) -> Result<Vec<Complex<f64>>> {
    let mut found = Vec::with_capacity(a.nrows());
    if write_eigenvalues(&mut a.clone(), &mut found).is_some() {
        return Ok(found);
    }
    let why = match a.iter().all(|x| x.is_finite()) {
        true => "the QR iteration did not converge",
        false => "a matrix entry is not finite",
    };
    Err(Error::Numerical(format!("eigenvalues: {why}")))
}

/// All eigenvalues of `a`, which is spoilt, instead of what stands in `found`; `None` when an entry is not finite or the iteration
/// does not converge. A list with room for them takes no memory from the system.
pub fn write_eigenvalues(a: &mut DMatrix<f64>, found: &mut Vec<Complex<f64>>) -> Option<()> {
    found.clear();
    if !a.iter().all(|x| x.is_finite()) {
        return None;
    }
    balance_in_place(a);
    reduce(a);
    append_eigenvalues(a, found)
}

/// Eigenvector of `a` for the known eigenvalue `lambda`, by inverse iteration, scaled to unit norm.
///
/// # Errors
/// [`Error::Numerical`] when no vector with a small residual is found.
pub fn eigenvector(a: &DMatrix<f64>, lambda: Complex<f64>) -> Result<DVector<Complex<f64>>> {
    let n = a.nrows();
    let size = a.amax().max(f64::MIN_POSITIVE);
    // a shift off the eigenvalue by rounding keeps the factorisation regular
    let shift = lambda + Complex::new(size, size) * (8.0 * f64::EPSILON);
    let lu = (complex(a) - DMatrix::identity(n, n) * shift).lu();
    let mut v = DVector::from_fn(n, |i, _| Complex::new(1.0, 0.1 * i as f64));
    for _ in 0..3 {
        v = lu.solve(&v).ok_or_else(|| {
            Error::Numerical(format!("eigenvector: the shift {shift} is singular"))
        })?;
        let norm = v.norm();
        if !norm.is_finite() || norm == 0.0 {
            return Err(Error::Numerical(
                "eigenvector: inverse iteration broke down".into(),
            ));
        }
        v.unscale_mut(norm);
    }
    Ok(v)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn badly_scaled_oscillator_keeps_its_poles() {
        // ω = 3, ζ = 0.01, with the second state in units 1e-9 of the first
        let s = 1e9;
        let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0 / s, -9.0 * s, -0.06]);
        for lambda in eigenvalues(&a).unwrap() {
            assert!((lambda.re + 0.03).abs() < 1e-13, "{lambda}");
            assert!((lambda.norm() - 3.0).abs() < 1e-13, "{lambda}");
            let v = eigenvector(&a, lambda).unwrap();
            let residual = complex(&a) * &v - &v * lambda;
            assert!(residual.norm() < 1e-12 * a.amax());
        }
    }

    #[test]
    fn non_finite_is_an_error_not_a_hang() {
        let a = DMatrix::from_row_slice(2, 2, &[0.0, f64::NAN, 1.0, 0.0]);
        assert!(eigenvalues(&a).is_err());
    }
}
