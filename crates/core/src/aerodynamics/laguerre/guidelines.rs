//! Guidelines for the parameters of Laguerre filters (thesis, section 2.5.1): bounds of the decay factor, and the memory
//! of a chain of filters.

use super::{FilterBank, discrete_filter_matrices};
use crate::error::Result;
use crate::state_space::c2d;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// A filter has died out when its impulse response stays below this for good (2.37); the squares of all samples of one
/// response add up to one.
pub(super) const MEMORY_LIMIT: f64 = 0.01;

/// Memory is counted up to here: longer than any record.
const LONGEST_MEMORY: usize = 10_000_000;

/// Lower bound of `α` for signals up to `f_max` sampled at `f_s` (2.36), both in Hz: the cut-off of the filters is then
/// not above `f_max`.
pub fn alpha_lower_bound(f_max_hz: f64, sampling_hz: f64) -> f64 {
    let c = (TAU * f_max_hz / sampling_hz).cos();
    (2.0 - c - (c * c - 4.0 * c + 3.0).sqrt()).powi(2)
}

/// Memory `M` of `count` discrete filters, samples: from there on `|g_l[k]| ≤ 0.01` for every one of them.
pub fn discrete_memory(alpha: f64, count: usize) -> usize {
    let (a, b) = discrete_filter_matrices(alpha, count);
    let root = alpha.sqrt();
    // the responses spread over about this many samples and only decay behind them
    let spread = count as f64 * (1.0 + root) / (1.0 - root);
    last_above(&a, b, spread)
}

impl FilterBank {
    /// Memory of the chain in steps of `delta_s` (dimensionless time): from there on `|λ_l(s)| √Δs ≤ 0.01` for every filter,
    /// the measure of `discrete_memory` for continuous filters.
    pub fn memory(&self, delta_s: f64) -> Result<usize> {
        let (a, b) = self.matrices();
        let drive = DMatrix::from_column_slice(b.len(), 1, b.as_slice());
        let phi = c2d(&a, &drive, delta_s)?.phi;
        let slowest = self.poles().iter().copied().fold(f64::INFINITY, f64::min);
        let spread = 2.0 * self.count() as f64 / (slowest * delta_s);
        Ok(last_above(&phi, b * delta_s.sqrt(), spread))
    }
}

/// Number of the first state `x(k)`, `x(k+1) = A x(k)`, from which on none exceeds [`MEMORY_LIMIT`]; behind `spread` the
/// states only decay.
fn last_above(a: &DMatrix<f64>, mut x: DVector<f64>, spread: f64) -> usize {
    let mut memory = 0;
    for k in 0..LONGEST_MEMORY {
        let largest = x.amax();
        if largest > MEMORY_LIMIT {
            memory = k + 1;
        } else if k as f64 > spread && largest < 0.1 * MEMORY_LIMIT {
            return memory;
        }
        x = a * x;
    }
    LONGEST_MEMORY
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::laguerre::impulse_response;

    /// Section 2.5: bounds of (2.36); at α = 0.889 the last of four filters has decayed to 0.0096 at sample 176.
    #[test]
    fn bounds_of_the_first_order_example() {
        assert!((alpha_lower_bound(3.0, 200.0) - 0.8283).abs() < 5e-5);
        assert!((alpha_lower_bound(2.5, 200.0) - 0.8547).abs() < 5e-5);
        let g = impulse_response(0.889, 4, 400);
        assert!((g[(3, 176)].abs() - 0.0096).abs() < 5e-5, "{}", g[(3, 176)]);
        assert!((176..400).all(|k| g[(3, k)].abs() <= 0.01));
    }

    /// The definition, looked up in a long response.
    #[test]
    fn memory_is_where_the_responses_stay_small() {
        for (alpha, count) in [(0.05, 1), (0.6, 3), (0.889, 4), (0.97, 8)] {
            let g = impulse_response(alpha, count, 5_000);
            let last = (0..5_000)
                .rev()
                .find(|&k| g.column(k).amax() > 0.01)
                .unwrap();
            assert_eq!(discrete_memory(alpha, count), last + 1);
        }
    }

    /// One filter is `√(2p) e^(−ps)`; and slow discrete filters are sampled continuous ones, `√α = e^(−pΔs)`.
    #[test]
    fn continuous_memory_has_the_measure_of_the_discrete_one() {
        let (p, step) = (0.3_f64, 0.0817_f64);
        let closed = ((2.0 * p * step).sqrt() / MEMORY_LIMIT).ln() / (p * step);
        let bank = |count| FilterBank::laguerre(p, count).unwrap();
        assert_eq!(bank(1).memory(step).unwrap(), closed.ceil() as usize);
        let (fine, alpha) = (1e-3, (-2.0 * p * 1e-3_f64).exp());
        let (c, d) = (bank(3).memory(fine).unwrap(), discrete_memory(alpha, 3));
        assert!(c.abs_diff(d) <= 5, "{c} {d}");
    }
}
