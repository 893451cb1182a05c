//! The shortest vector that satisfies linear inequalities: Lawson & Hanson, *Solving Least Squares Problems*, chapter 23.
//!
//! An active-set method is exact to rounding and gives the same bits for the same problem; an interior-point method
//! leaves its path in the last digits, which a search of poles over many such problems would follow.

use crate::error::{Error, Result};
use nalgebra::{DMatrix, DVector};

/// Residual of a unit vector below which the inequalities contradict each other: a thousand times its rounding error.
const CONTRADICTION: f64 = 1e-12;
/// A gradient of the dual problem below this is zero: a hundred times the rounding error of unit columns.
const DUAL_TOLERANCE: f64 = 1e-14;

/// `gradient · w ≤ bound`.
#[derive(Debug, Clone)]
pub(super) struct Inequality {
    pub gradient: DVector<f64>,
    pub bound: f64,
}

/// The shortest `w` with `gradient · w ≤ bound` for all inequalities, and which of them hold it.
pub(super) fn shortest(
    inequalities: &[Inequality],
    size: usize,
) -> Result<(DVector<f64>, Vec<usize>)> {
    let norms: Vec<f64> = inequalities.iter().map(|i| i.gradient.norm()).collect();
    let distance = |(i, norm): (&Inequality, &f64)| -i.bound / norm;
    let furthest = inequalities
        .iter()
        .zip(&norms)
        .map(distance)
        .fold(0.0, f64::max);
    if furthest.is_nan() || furthest == f64::INFINITY {
        return Err(contradiction());
    }
    if furthest == 0.0 {
        return Ok((DVector::zeros(size), Vec::new()));
    }
    // unit gradients, and distances of the order of one
    let columns = DMatrix::from_fn(size + 1, inequalities.len(), |row, k| {
        if row < size {
            -inequalities[k].gradient[row] / norms[k]
        } else {
            -inequalities[k].bound / (norms[k] * furthest)
        }
    });
    let (residual, held) = non_negative(&columns)?;
    if residual.norm() < CONTRADICTION {
        return Err(contradiction());
    }
    // the vector itself from the equations that hold it: the ratio of two residuals would lose digits
    let gradients = DMatrix::from_fn(size, held.len(), |row, k| -columns[(row, held[k])]);
    let bounds = DVector::from_fn(held.len(), |k, _| -columns[(size, held[k])]);
    let (q, r) = gradients.qr().unpack();
    let along = r
        .transpose()
        .solve_lower_triangular(&bounds)
        .filter(|a| a.iter().all(|x| x.is_finite()))
        .ok_or_else(contradiction)?;
    Ok((q * along * furthest, held))
}

fn contradiction() -> Error {
    Error::Numerical("constraints of the fit that contradict each other".into())
}

/// `min ‖E y − f‖, y ≥ 0` with `f` the last unit vector: the residual and the columns whose `y` is positive (Lawson &
/// Hanson's NNLS).
fn non_negative(e: &DMatrix<f64>) -> Result<(DVector<f64>, Vec<usize>)> {
    let mut f = DVector::zeros(e.nrows());
    f[e.nrows() - 1] = 1.0;
    let mut y = DVector::zeros(e.ncols());
    let mut positive: Vec<usize> = Vec::new();
    for _ in 0..10 * (e.ncols() + e.nrows()) {
        let residual = e * &y - &f;
        let slope = -(e.transpose() * &residual);
        let steepest = (0..e.ncols())
            .filter(|k| !positive.contains(k) && slope[*k] > DUAL_TOLERANCE)
            .max_by(|a, b| slope[*a].total_cmp(&slope[*b]));
        let Some(next) = steepest else {
            return Ok((residual, positive));
        };
        positive.push(next);
        loop {
            let trial = least_squares(e, &positive, &f)?;
            if trial[positive.len() - 1] <= 0.0 && y[next] == 0.0 {
                // rounding made a column look useful that is none
                positive.pop();
                return Ok((residual, positive));
            }
            if trial.iter().all(|x| *x > 0.0) {
                y.fill(0.0);
                positive
                    .iter()
                    .zip(trial.iter())
                    .for_each(|(&k, x)| y[k] = *x);
                break;
            }
            let step = positive
                .iter()
                .zip(trial.iter())
                .filter(|(_, x)| **x <= 0.0)
                .map(|(&k, x)| y[k] / (y[k] - x))
                .fold(1.0, f64::min);
            for (&k, x) in positive.iter().zip(trial.iter()) {
                y[k] += step * (x - y[k]);
                if y[k] <= f64::EPSILON * x.abs() {
                    y[k] = 0.0;
                }
            }
            positive.retain(|&k| y[k] > 0.0);
        }
    }
    Err(Error::Numerical(
        "constraints of the fit: no active set was found".into(),
    ))
}

fn least_squares(e: &DMatrix<f64>, columns: &[usize], f: &DVector<f64>) -> Result<DVector<f64>> {
    let (q, r) = e.select_columns(columns).qr().unpack();
    r.solve_upper_triangular(&(q.transpose() * f))
        .ok_or_else(contradiction)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inequality(gradient: &[f64], bound: f64) -> Inequality {
        Inequality {
            gradient: DVector::from_column_slice(gradient),
            bound,
        }
    }

    /// A corner, an edge and an inequality that does not bind, by hand.
    #[test]
    fn shortest_vectors_are_those_of_geometry() {
        let x = inequality(&[-2.0, 0.0], -2.0);
        let y = inequality(&[0.0, -1.0], -2.0);
        let sum = inequality(&[-1.0, -1.0], -1.0);
        let (w, held) = shortest(&[x.clone(), y.clone(), sum.clone()], 2).unwrap();
        assert!((w - DVector::from_vec(vec![1.0, 2.0])).amax() < 1e-15);
        assert_eq!(held.len(), 2);
        let (w, held) = shortest(std::slice::from_ref(&sum), 2).unwrap();
        assert!((w - DVector::from_vec(vec![0.5, 0.5])).amax() < 1e-15);
        assert_eq!(held, [0]);
        let (w, held) = shortest(&[inequality(&[1.0, 0.0], 3.0)], 2).unwrap();
        assert!(w.amax() == 0.0 && held.is_empty());
        // 1e-7 in size: as exact as at one
        let tiny = [
            inequality(&[-2.0, 0.0], -2e-7),
            inequality(&[0.0, -1.0], -2e-7),
        ];
        let (w, _) = shortest(&tiny, 2).unwrap();
        assert!((w - DVector::from_vec(vec![1e-7, 2e-7])).amax() < 1e-21);
    }

    #[test]
    fn contradictions_are_refused() {
        let both = [
            inequality(&[1.0, 0.0], -1.0),
            inequality(&[-1.0, 0.0], -1.0),
        ];
        assert!(shortest(&both, 2).is_err());
        assert!(shortest(&[inequality(&[0.0, 0.0], -1.0)], 2).is_err());
    }
}
