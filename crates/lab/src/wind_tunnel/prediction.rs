//! Forces that a model predicts for the motion of a record (thesis, 3.7 and 3.8).

use super::records::Record;
use super::virtual_forces::response;
use crate::aerodynamics::Transfer;
use crate::error::{Result, ensure, positive};
use crate::section::Dof;

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
