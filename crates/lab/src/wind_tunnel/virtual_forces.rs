//! Dimensionless forces of the virtual tunnel: from test points of a table, or as the response of a model.

use super::motion::UnitMotion;
use crate::aerodynamics::derivatives::{
    Derivative, DerivativePoint, DerivativeTable, Extrapolation, InterpolatedTable, Part,
};
use crate::aerodynamics::{Transfer, TransferMatrix};
use crate::error::{Result, ensure};
use crate::section::Dof;
use crate::signal::Fourier;
use crate::units::ReducedFrequency;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Derivatives of one motion at one test point may differ by this fraction in `K` and still be one run.
const SAME_K: f64 = 0.02;

/// One column of `G` at the test points of one speed.
pub(super) struct TransferColumn {
    /// Reduced frequency of each point.
    pub k: Vec<ReducedFrequency>,
    /// `G` of each row, then point.
    pub g: Vec<Vec<Complex<f64>>>,
    /// Whether derivatives were tested at different points and all but one were interpolated.
    pub interpolated: bool,
}

impl TransferColumn {
    /// The column of `motion` from a table of one speed group.
    ///
    /// # Errors
    /// [`Error::Input`](crate::error::Error::Input) when derivatives of the column were tested in ranges of `K` that share no test point.
    pub(crate) fn new(group: &DerivativeTable, dofs: &[Dof], motion: Dof) -> Result<Self> {
        let column = |part| {
            dofs.iter()
                .map(move |force| Derivative::from_entry(*force, motion, part))
        };
        let all: Vec<Derivative> = column(Part::Real).chain(column(Part::Imaginary)).collect();
        let reference = group.points(all[0]);
        let same_points = |derivative: &Derivative| {
            let own = group.points(*derivative);
            let same = |(a, b): (&DerivativePoint, &DerivativePoint)| {
                (a.v_hat / b.v_hat - 1.0).abs() < SAME_K
            };
            own.len() == reference.len() && own.iter().zip(reference).all(same)
        };
        if !all.iter().all(same_points) {
            return Self::interpolated(group, dofs, motion);
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
            let at = |p| Derivative::from_entry(*force, motion, p);
            (0..reference.len())
                .map(|i| Complex::new(part(at(Part::Real), i), part(at(Part::Imaginary), i)))
                .collect()
        };
        Ok(Self {
            k: (0..reference.len()).map(mean_k).collect(),
            g: dofs.iter().map(row).collect(),
            interpolated: false,
        })
    }

    /// The same where derivatives have test points of their own: `G` at those of the first derivative that lie in the
    /// range of all.
    fn interpolated(group: &DerivativeTable, dofs: &[Dof], motion: Dof) -> Result<Self> {
        let model = InterpolatedTable::new(group, dofs, Extrapolation::Refuse)?;
        let range = model.tested_range();
        let first = Derivative::from_entry(dofs[0], motion, Part::Real);
        let points = group.points(first).iter().map(DerivativePoint::k);
        let k: Vec<ReducedFrequency> = points.filter(|k| range.contains(*k)).collect();
        ensure(
            !k.is_empty(),
            format_args!("table {}", group.name),
            format_args!("a test point of {first} in the range of all other derivatives"),
            "none: no record can show all of them",
        )?;
        let j = dofs.iter().position(|d| *d == motion).unwrap_or(0);
        let at: Vec<_> = k
            .iter()
            .map(|k| model.transfer(*k))
            .collect::<Result<_>>()?;
        let row = |i: usize| at.iter().map(|g| g[(i, j)]).collect();
        Ok(Self {
            g: (0..dofs.len()).map(row).collect(),
            k,
            interpolated: true,
        })
    }
}

/// Dimensionless force of each row to the unit motion in each column, `[row][column][sample]`.
///
/// `scale_s` is `B/V`. The padding is at least as long as the record, so that what the wake remembers at its end
/// does not come round to its beginning.
pub(super) fn unit_response(
    model: &dyn Transfer,
    unit: &UnitMotion,
    sampling_hz: f64,
    scale_s: f64,
) -> Result<Vec<Vec<Vec<f64>>>> {
    let transforms = Transforms::new(unit.displacement.len());
    let spectrum = transforms.spectrum(&unit.displacement);
    let n = model.dofs().len();
    let mut forces = vec![vec![transforms.nothing(); n]; n];
    transforms.for_each_bin(model, sampling_hz, scale_s, &mut |bin, g| {
        for (i, row) in forces.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                transforms.set(entry, bin, g[(i, j)] * spectrum[bin]);
            }
        }
    })?;
    let in_time = |row: Vec<Vec<_>>| row.into_iter().map(|q| transforms.in_time(q)).collect();
    Ok(forces.into_iter().map(in_time).collect())
}

/// Dimensionless force of each row, `[row][sample]`, to dimensionless motions that were zero before their first sample:
/// the sum over the columns of `model`. `scale_s` is `B/V`.
pub(super) fn response(
    model: &dyn Transfer,
    motion: &[Vec<f64>],
    sampling_hz: f64,
    scale_s: f64,
) -> Result<Vec<Vec<f64>>> {
    let transforms = Transforms::new(motion.first().map_or(0, Vec::len));
    let spectra: Vec<_> = motion.iter().map(|r| transforms.spectrum(r)).collect();
    let mut forces = vec![transforms.nothing(); model.dofs().len()];
    transforms.for_each_bin(model, sampling_hz, scale_s, &mut |bin, g| {
        for (i, force) in forces.iter_mut().enumerate() {
            let q = spectra.iter().enumerate().map(|(j, r)| g[(i, j)] * r[bin]);
            transforms.set(force, bin, q.sum());
        }
    })?;
    Ok(forces.into_iter().map(|q| transforms.in_time(q)).collect())
}

/// Fourier transforms of records of one length, padded with at least as many zeros.
struct Transforms {
    samples: usize,
    fourier: Fourier,
}

impl Transforms {
    fn new(samples: usize) -> Self {
        let fourier = Fourier::new((2 * samples.max(1)).next_power_of_two());
        Self { samples, fourier }
    }

    fn nothing(&self) -> Vec<Complex<f64>> {
        vec![Complex::default(); self.fourier.length()]
    }

    fn spectrum(&self, samples: &[f64]) -> Vec<Complex<f64>> {
        self.fourier.spectrum(samples.iter().copied())
    }

    /// Calls `f` with every bin from zero to half the sampling frequency and `G` there.
    fn for_each_bin(
        &self,
        model: &dyn Transfer,
        sampling_hz: f64,
        scale_s: f64,
        f: &mut dyn FnMut(usize, &TransferMatrix),
    ) -> Result<()> {
        let length = self.fourier.length();
        for bin in 0..=length / 2 {
            let omega = TAU * sampling_hz * bin as f64 / length as f64;
            f(
                bin,
                &model.transfer(ReducedFrequency::from_full_width(omega * scale_s))?,
            );
        }
        Ok(())
    }

    /// Real motions give real forces: the other half of the spectrum is the conjugate.
    fn set(&self, spectrum: &mut [Complex<f64>], bin: usize, q: Complex<f64>) {
        let length = self.fourier.length();
        spectrum[(length - bin) % length] = q.conj();
        spectrum[bin] = q;
    }

    fn in_time(&self, spectrum: Vec<Complex<f64>>) -> Vec<f64> {
        let scale = 1.0 / self.fourier.length() as f64;
        let sums = self.fourier.sums(spectrum).into_iter();
        sums.take(self.samples).map(|x| scale * x).collect()
    }
}
