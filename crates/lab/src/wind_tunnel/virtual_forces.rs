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
            let k = all.iter().map(|d| group.points(*d)[i].k().full_width());
            ReducedFrequency::from_full_width(k.sum::<f64>() / all.len() as f64)
        };
        let part = |d: Derivative, i: usize| {
            let point = group.points(d)[i];
            point.value * point.k().full_width().powi(2)
        };
        let row = |force: &Dof| {
            let at = |p| Derivative::from_entry(*force, motion, p);
            let g = |i| Complex::new(part(at(Part::Real), i), part(at(Part::Imaginary), i));
            (0..reference.len()).map(g).collect()
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
        let place = format_args!("table {}", group.name);
        let expected =
            format_args!("a test point of {first} in the range of all other derivatives");
        let found = "none: no record can show all of them";
        ensure(!k.is_empty(), place, expected, found)?;
        let j = dofs.iter().position(|d| *d == motion).unwrap_or(0);
        let at = k.iter().map(|k| model.transfer(*k));
        let at: Vec<_> = at.collect::<Result<_>>()?;
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
    let samples = unit.displacement.len();
    let fourier = padded(samples);
    let spectrum = fourier.spectrum(unit.displacement.iter().copied());
    let n = model.dofs().len();
    let force =
        |g: &TransferMatrix, bin: usize, entry: usize| g[(entry / n, entry % n)] * spectrum[bin];
    let halves = halves(model, fourier.length(), sampling_hz, scale_s, n * n, force)?;
    let mut entries = halves.into_iter().map(|q| in_time(&fourier, q, samples));
    let row = |_| entries.by_ref().take(n).collect();
    Ok((0..n).map(row).collect())
}

/// Dimensionless force of each row, `[row][sample]`, to dimensionless motions that were zero before their first sample:
/// the sum over the columns of `model`. `scale_s` is `B/V`.
pub(super) fn response(
    model: &dyn Transfer,
    motion: &[Vec<f64>],
    sampling_hz: f64,
    scale_s: f64,
) -> Result<Vec<Vec<f64>>> {
    let samples = motion.first().map_or(0, Vec::len);
    let fourier = padded(samples);
    let spectra = motion.iter().map(|r| fourier.spectrum(r.iter().copied()));
    let spectra: Vec<_> = spectra.collect();
    let force = |g: &TransferMatrix, bin: usize, row: usize| {
        let columns = spectra.iter().enumerate();
        columns.map(|(j, r)| g[(row, j)] * r[bin]).sum()
    };
    let rows = model.dofs().len();
    let halves = halves(model, fourier.length(), sampling_hz, scale_s, rows, force)?;
    drop(spectra);
    let forces = halves.into_iter().map(|q| in_time(&fourier, q, samples));
    Ok(forces.collect())
}

/// Transforms of records of so many samples, padded with at least as many zeros.
fn padded(samples: usize) -> Fourier {
    Fourier::new((2 * samples.max(1)).next_power_of_two())
}

/// So many forces at every bin of a transform of this length, from zero to half the sampling frequency, each as `force` makes it of
/// `G`, the bin and its own number. `G` of one bin is kept at a time: matrices of a long record are larger than its forces.
fn halves(
    model: &dyn Transfer,
    length: usize,
    sampling_hz: f64,
    scale_s: f64,
    count: usize,
    force: impl Fn(&TransferMatrix, usize, usize) -> Complex<f64>,
) -> Result<Vec<Vec<Complex<f64>>>> {
    let mut all: Vec<_> = (0..count)
        .map(|_| Vec::with_capacity(length / 2 + 1))
        .collect();
    for bin in 0..=length / 2 {
        let omega = TAU * sampling_hz * bin as f64 / length as f64;
        let g = model.transfer(ReducedFrequency::from_full_width(omega * scale_s))?;
        for (number, half) in all.iter_mut().enumerate() {
            half.push(force(&g, bin, number));
        }
    }
    Ok(all)
}

/// The samples of a force whose spectrum has this half; real motions give real forces: the other half is the conjugate.
fn in_time(fourier: &Fourier, half: Vec<Complex<f64>>, samples: usize) -> Vec<f64> {
    let length = fourier.length();
    let mut spectrum = vec![Complex::default(); length];
    for (bin, q) in half.into_iter().enumerate() {
        spectrum[(length - bin) % length] = q.conj();
        spectrum[bin] = q;
    }
    let scale = 1.0 / length as f64;
    let sums = fourier.sums(spectrum).into_iter();
    sums.take(samples).map(|x| scale * x).collect()
}
