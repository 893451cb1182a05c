//! Dimensionless forces of the virtual tunnel: from test points of a table, or as the response of a model; and the forces that a model
//! predicts for the motion of a record (thesis, 3.7 and 3.8).

use super::records::Record;
use super::tunnel_plan::UnitMotion;
use crate::aerodynamics::derivatives::{
    Derivative, DerivativePoint, DerivativeTable, Extrapolation, InterpolatedTable, Part,
};
use crate::aerodynamics::{Transfer, TransferMatrix};
use crate::error::{Result, ensure, positive};
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
fn response(
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

/// Self-excited forces (N/m, N·m/m; one vector per force, one number per sample) that `model` predicts for the motion of
/// `record`: the exact linear response, summed over the motions, by Fourier transform of the motion padded with zeros.
///
/// The motion counts as zero before the record. For the discrete model this is the recursion (2.33) to rounding where its
/// step is that of the record, and an ideal resampling of it elsewhere.
///
/// # Errors
/// [`Error::Input`](crate::error::Error::Input) for a record of other degrees of freedom or without a positive width, speed or sampling frequency.
pub fn predicted_forces(model: &dyn Transfer, record: &Record) -> Result<Vec<Vec<f64>>> {
    let h = &record.header;
    let place = |what: &str| format!("record {}: {what}", h.name);
    let (own, found) = (Dof::names(model.dofs()), Dof::names(&h.dofs));
    let expected = format_args!("those of the model, {own}");
    ensure(found == own, place("dofs"), expected, &found)?;
    let width = positive(place("width_m"), h.width_m)?;
    let speed = positive(place("mean_speed_m_s"), h.mean_speed_m_s)?;
    let sampling = positive(place("sampling_hz"), h.sampling_hz)?;
    let density = positive(place("air_density_kg_m3"), h.air_density_kg_m3)?;
    let samples = record.motion.first().map_or(0, Vec::len);
    let expected = format_args!("{samples} samples in every channel");
    for found in record.motion.iter().map(Vec::len) {
        ensure(found == samples, place("motion"), expected, found)?;
    }
    let dimensionless = |(d, m): (&Dof, &Vec<f64>)| -> Vec<f64> {
        m.iter().map(|x| d.motion_scale(width) * x).collect()
    };
    let channels = h.dofs.iter().zip(&record.motion);
    let motion: Vec<_> = channels.map(dimensionless).collect();
    let mut forces = response(model, &motion, sampling, width / speed)?;
    for (d, force) in h.dofs.iter().zip(&mut forces) {
        let scale = 0.5 * density * speed * speed * d.force_scale(width);
        force.iter_mut().for_each(|f| *f *= scale);
    }
    Ok(forces)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::{DiscreteLaguerre, RationalModel, Realizable, Realization};
    use crate::section::Dof;
    use crate::wind_tunnel::TunnelPlan;
    use nalgebra::{DMatrix, DVector};

    fn jones_records() -> Vec<Record> {
        let plan = TunnelPlan {
            speeds_m_s: vec![8.17],
            frequencies_hz: vec![0.5, 2.0],
            ..TunnelPlan::default()
        };
        let jones = RationalModel::jones_flat_plate();
        plan.records_from_model(&jones, "Jones", 0.5).unwrap()
    }

    /// Both motions at once: the sum of the forces of the single ones.
    #[test]
    fn a_model_predicts_its_own_records() {
        let parts = jones_records();
        let mut both = parts[0].clone();
        both.motion[1].clone_from(&parts[1].motion[1]);
        let found = predicted_forces(&RationalModel::jones_flat_plate(), &both).unwrap();
        for (i, found) in found.iter().enumerate() {
            let size = found.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
            for (k, f) in found.iter().enumerate() {
                let sum = parts[0].force[i][k] + parts[1].force[i][k];
                // rounding of the transforms
                assert!((f - sum).abs() < 1e-10 * size, "{i} {k}");
            }
        }
    }

    /// The recursion (2.33) of the realisation, sample by sample.
    #[test]
    fn the_discrete_model_is_its_recursion() {
        let record = &jones_records()[1];
        let coefficients =
            (0..2).map(|j| DMatrix::from_fn(2, 3, |i, l| 1.0 + i as f64 - 0.4 * (l * j) as f64));
        let model = DiscreteLaguerre::shared(
            Dof::TWO.to_vec(),
            0.6,
            8.17 / 0.5 / 200.0,
            coefficients.collect(),
            vec![0.0; 2],
        );
        let found = predicted_forces(&model, record).unwrap();
        let Realization::Discrete(d) = model.realize() else {
            panic!("discrete");
        };
        let pressure = 0.5 * 1.19 * 8.17 * 8.17;
        let mut state = DVector::zeros(6);
        let size = found[1].iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        for (k, force) in found[1].iter().enumerate() {
            let r = DVector::from_vec(vec![record.motion[0][k] / 0.5, record.motion[1][k]]);
            state = &d.a * state + &d.b * r;
            let moment = pressure * 0.25 * (&d.c * &state)[1];
            assert!((force - moment).abs() < 1e-10 * size, "{k}");
        }
    }

    #[test]
    fn records_of_other_motions_are_refused() {
        let mut record = jones_records().remove(0);
        record.motion[1].pop();
        let jones = RationalModel::jones_flat_plate();
        let message = |r: &Record| predicted_forces(&jones, r).unwrap_err().to_string();
        assert!(message(&record).contains("16000") || message(&record).contains("samples"));
        record.header.dofs.reverse();
        assert!(message(&record).contains("those of the model"));
    }
}
