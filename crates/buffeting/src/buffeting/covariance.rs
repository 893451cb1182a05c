//! Covariances of all modal coordinates in turbulence, from which follows everything that is linear in them: motion and
//! accelerations along the whole span, section forces.

use super::frequency::FrequencyDomain;
use crate::error::Result;
use aerodeck_core::threads;
use nalgebra::{Complex, DMatrix};
use std::f64::consts::TAU;

/// Half the distance of Gauss's two points, over half the interval.
const GAUSS: f64 = 0.577_350_269_189_625_8;
/// Intervals that are summed together.
const TOGETHER: usize = 32;

impl FrequencyDomain<'_> {
    /// Covariances of the mass-normalised modal coordinates and of those of dampers, of their rates and of their accelerations:
    /// `∫ ω²ʲ Re S_η df`, by two points of Gauss between the frequencies that show every resonance (within 0.1 % of the adaptive
    /// integral of single nodes).
    ///
    /// # Errors
    /// Those of the spectra.
    pub fn modal_covariances(&self) -> Result<[DMatrix<f64>; 3]> {
        let count = self.problem.structure.dofs.len();
        let unit = DMatrix::<Complex<f64>>::identity(count, count);
        let zero =
            || -> [DMatrix<f64>; 3] { std::array::from_fn(|_| DMatrix::zeros(count, count)) };
        let frequencies = self.resolved_hz();
        let intervals: Vec<&[f64]> = frequencies.windows(2).collect();
        let chunks: Vec<_> = intervals.chunks(TOGETHER).collect();
        let sums = threads::each(&chunks, true, |some| {
            let mut sums = zero();
            for ends in *some {
                let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
                for f in [middle - GAUSS * half, middle + GAUSS * half] {
                    let spectrum = spectrum(self, f, &unit)?;
                    let square = (TAU * f).powi(2);
                    for (sum, factor) in sums.iter_mut().zip([1.0, square, square * square]) {
                        *sum += &spectrum * (half * factor);
                    }
                }
            }
            Ok(sums)
        });
        let mut orders = zero();
        // in the order of the frequencies, whatever the number of threads
        for sums in sums {
            for (total, sum) in orders.iter_mut().zip(sums?) {
                *total += sum;
            }
        }
        Ok(orders)
    }
}

/// Root mean square of `Σ row_m η_m`, of its rate and of its acceleration, by the covariances of the coordinates.
pub fn rms_of(covariances: &[DMatrix<f64>; 3], row: &[f64]) -> [f64; 3] {
    covariances.each_ref().map(|covariance| {
        let columns = covariance.column_iter().zip(row);
        let sum = columns.map(|(column, b)| {
            let each = column.iter().zip(row);
            b * each.map(|(c, a)| a * c).sum::<f64>()
        });
        sum.sum::<f64>().max(0.0).sqrt()
    })
}

/// Real part of the one-sided spectra of the modal coordinates: with `w_n` the answer of all modes to a gust at node `n`,
/// `Σ_nn' w_nᴴ C_nn' w_n'`, in one pass along the span.
fn spectrum(
    domain: &FrequencyDomain<'_>,
    frequency: f64,
    unit: &DMatrix<Complex<f64>>,
) -> Result<DMatrix<f64>> {
    let count = unit.nrows();
    let (problem, speed) = (domain.problem, domain.speed_m_s);
    let parts = problem.parts_of_rows(frequency, speed, unit)?;
    let mut total = DMatrix::zeros(count, count);
    for gust in problem.gusts_at(frequency, speed) {
        let answers = &problem.gust_forces[gust.component as usize] * &parts;
        let nodes = answers.nrows();
        // real parts above, imaginary ones below, so that one product adds both
        let mut own = DMatrix::zeros(2 * nodes, count);
        let mut with = DMatrix::zeros(2 * nodes, count);
        for m in 0..count {
            let mut before = Complex::<f64>::default();
            for n in 0..nodes {
                let z = Complex::new(answers[(n, 2 * m)], answers[(n, 2 * m + 1)]) * gust.sizes[n];
                if n > 0 {
                    before *= gust.gaps[n - 1];
                }
                let half = before + 0.5 * z;
                (own[(n, m)], own[(nodes + n, m)]) = (z.re, z.im);
                (with[(n, m)], with[(nodes + n, m)]) = (half.re, half.im);
                before += z;
            }
        }
        let one_way = own.tr_mul(&with);
        total += &one_way + one_way.transpose();
    }
    Ok(total)
}
