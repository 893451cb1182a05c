//! Dimensionless forces of the virtual tunnel: from test points of a table, or as the response of a model.

use super::motion::UnitMotion;
use crate::aerodynamics::AerodynamicModel;
use crate::aerodynamics::derivatives::{Derivative, DerivativePoint, DerivativeTable, Part};
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::units::ReducedFrequency;
use nalgebra::Complex;
use rustfft::FftPlanner;
use std::f64::consts::TAU;

/// Derivatives of one motion at one test point may differ by this fraction in `K` and still be one run.
const SAME_K: f64 = 0.02;

/// One column of `G` at the test points of one speed.
pub(super) struct TestPoints {
    /// Reduced frequency of each point.
    pub k: Vec<ReducedFrequency>,
    /// `G` of each row, then point.
    pub g: Vec<Vec<Complex<f64>>>,
}

impl TestPoints {
    /// The column of `motion` from a table of one speed group.
    ///
    /// # Errors
    /// [`Error::Input`] when derivatives of the column were tested at different points.
    pub fn new(group: &DerivativeTable, dofs: &[Dof], motion: Dof) -> Result<Self> {
        let column = |part| {
            dofs.iter()
                .map(move |force| Derivative::of(*force, motion, part))
        };
        let all: Vec<Derivative> = column(Part::Real).chain(column(Part::Imaginary)).collect();
        let reference = group.points(all[0]);
        for derivative in &all {
            let own = group.points(*derivative);
            let same = |(a, b): (&DerivativePoint, &DerivativePoint)| {
                (a.v_hat / b.v_hat - 1.0).abs() < SAME_K
            };
            if own.len() != reference.len() || !own.iter().zip(reference).all(same) {
                return Err(Error::input(
                    format!("table {}, {derivative}", group.name),
                    format!("the test points of {} at the same speed", all[0]),
                    "others: no one run gives both",
                ));
            }
        }
        let mean_k = |i: usize| {
            let sum: f64 = all
                .iter()
                .map(|d| group.points(*d)[i].k().full_width())
                .sum();
            ReducedFrequency::from_full_width(sum / all.len() as f64)
        };
        let part = |d: Derivative, i: usize| {
            let point = group.points(d)[i];
            point.value * point.k().full_width().powi(2)
        };
        let row = |force: &Dof| {
            let at = |p| Derivative::of(*force, motion, p);
            (0..reference.len())
                .map(|i| Complex::new(part(at(Part::Real), i), part(at(Part::Imaginary), i)))
                .collect()
        };
        Ok(Self {
            k: (0..reference.len()).map(mean_k).collect(),
            g: dofs.iter().map(row).collect(),
        })
    }
}

/// Dimensionless force of each row to the unit motion in each column, `[row][column][sample]`.
///
/// `scale_s` is `B/V`. The padding is at least as long as the record, so that what the wake remembers at its end
/// does not come round to its beginning.
///
/// # Errors
/// Those of the model.
pub(super) fn unit_response(
    model: &dyn AerodynamicModel,
    unit: &UnitMotion,
    sampling_hz: f64,
    scale_s: f64,
) -> Result<Vec<Vec<Vec<f64>>>> {
    let samples = unit.displacement.len();
    let length = (2 * samples).next_power_of_two();
    let mut planner = FftPlanner::new();
    let mut spectrum: Vec<Complex<f64>> = unit.displacement.iter().map(|x| (*x).into()).collect();
    spectrum.resize(length, Complex::default());
    planner.plan_fft_forward(length).process(&mut spectrum);
    let n = model.dofs().len();
    let mut forces = vec![vec![vec![Complex::default(); length]; n]; n];
    for bin in 0..=length / 2 {
        let omega = TAU * sampling_hz * bin as f64 / length as f64;
        let g = model.transfer(ReducedFrequency::from_full_width(omega * scale_s))?;
        for (i, row) in forces.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                let q = g[(i, j)] * spectrum[bin];
                // Real motions give real forces: the other half is the conjugate.
                entry[(length - bin) % length] = q.conj();
                entry[bin] = q;
            }
        }
    }
    let inverse = planner.plan_fft_inverse(length);
    let to_time = |mut q: Vec<Complex<f64>>| {
        inverse.process(&mut q);
        q.iter()
            .take(samples)
            .map(|x| x.re / length as f64)
            .collect()
    };
    Ok(forces
        .into_iter()
        .map(|row| row.into_iter().map(to_time).collect())
        .collect())
}
