//! Samples of a transfer matrix, sorted by entry and weighted, and the linear fit to them.

use super::basis::{Basis, index_of};
use super::constrained::{LinearProblem, LinearSolution};
use super::entry_report::EntryReport;
use super::options::{FrequencyFit, FrequencyWeights, limits_by_entry};
use crate::aerodynamics::Transfer;
use crate::aerodynamics::derivatives::{Part, TransferSample};
use crate::error::{Result, ensure, positive};
use crate::section::Dof;
use crate::units::ReducedFrequency;
use nalgebra::Complex;

/// Real and imaginary part belong to one test point when their `K` agree within this fraction: each derivative of a
/// measured table has its own.
const PAIRING_TOLERANCE: f64 = 0.05;

/// Both parts of every entry of `model` at the reduced frequencies `ks`.
pub fn sample_model(model: &dyn Transfer, ks: &[ReducedFrequency]) -> Result<Vec<TransferSample>> {
    let dofs = model.dofs();
    let mut samples = Vec::with_capacity(2 * ks.len() * dofs.len() * dofs.len());
    for &k in ks {
        let g = model.transfer(k)?;
        for (i, &force) in dofs.iter().enumerate() {
            for (j, &motion) in dofs.iter().enumerate() {
                let z = g[(i, j)];
                for (part, value) in [(Part::Real, z.re), (Part::Imaginary, z.im)] {
                    samples.push(TransferSample {
                        force,
                        motion,
                        part,
                        k,
                        value,
                        mean_speed_m_s: None,
                    });
                }
            }
        }
    }
    Ok(samples)
}

/// What a sample of a part sees of a value.
pub(crate) fn part_of(value: Complex<f64>, part: Part) -> f64 {
    match part {
        Part::Real => value.re,
        Part::Imaginary => value.im,
    }
}

/// All samples of one entry.
#[derive(Debug, Clone)]
pub(crate) struct EntrySamples {
    pub force: Dof,
    pub motion: Dof,
    pub rows: Vec<EntrySample>,
    /// Weight of the entry where it shares something with others.
    pub weight: f64,
    /// Factor of the ridge on its filters.
    pub ridge: f64,
    /// Value and slope at K → 0, where they are given.
    pub limit: [Option<f64>; 2],
}

/// One sample: value and weight, and the magnitude of `G` at its point.
#[derive(Debug, Clone)]
pub(crate) struct EntrySample {
    pub k: f64,
    pub part: Part,
    pub value: f64,
    pub weight: f64,
    pub magnitude: f64,
    /// Mean speed of the test, m/s, where it is known.
    pub mean_speed_m_s: Option<f64>,
}

impl EntrySample {
    /// The part of complex columns that the sample sees.
    pub(crate) fn seen<'a>(&self, columns: &'a [Complex<f64>]) -> impl Iterator<Item = f64> + 'a {
        let part = self.part;
        columns.iter().map(move |z| part_of(*z, part))
    }
}

impl EntrySamples {
    /// Name for messages.
    pub(crate) fn name(&self) -> String {
        format!(
            "samples of the {} force due to {} motion",
            self.force.name(),
            self.motion.name()
        )
    }

    /// Weighted sum of squares of the samples.
    pub(crate) fn total(&self) -> f64 {
        self.rows.iter().map(|r| (r.weight * r.value).powi(2)).sum()
    }

    /// Weighted least squares for the coefficients of `basis`, with the ridge and the limits of the entry.
    ///
    /// # Errors
    /// Fewer samples than columns, columns they do not determine, limits that the basis cannot meet.
    pub(crate) fn fit(&self, basis: &Basis) -> Result<LinearSolution> {
        let feed = basis.feed().count();
        let ridge = (0..basis.len()).map(|c| if c < feed { 0.0 } else { self.ridge });
        let mut problem = LinearProblem {
            ridge: ridge.collect(),
            ..LinearProblem::default()
        };
        for row in &self.rows {
            let columns = basis.columns(Complex::new(0.0, row.k));
            let weighted = row.seen(&columns).map(|x| row.weight * x).collect();
            problem.rows.push(weighted);
            problem.right.push(row.weight * row.value);
        }
        let limits = basis.at_zero().into_iter().zip(self.limit);
        let stated = limits.filter_map(|(functional, target)| Some((functional, target?)));
        problem.constraints = stated.collect();
        problem.solve(&self.name(), &|c| basis.names()[c].clone())
    }

    /// Weighted residuals of given coefficients times the share of the entry.
    pub(crate) fn weighted_residuals<'a>(
        &'a self,
        basis: &Basis,
        coefficients: &[f64],
        share: f64,
    ) -> impl Iterator<Item = f64> + 'a {
        let residuals = self.residuals(basis, coefficients).into_iter();
        let rows = residuals.zip(&self.rows);
        rows.map(move |(r, row)| r * row.weight * share)
    }

    /// Account of coefficients that leave these unweighted residuals of a fit, but for the coefficients themselves.
    pub(super) fn report(
        &self,
        residuals: &[f64],
        poles: &[f64],
        fit: &LinearSolution,
    ) -> EntryReport {
        let sum: f64 = residuals.iter().map(|r| r * r).sum();
        let total: f64 = self.rows.iter().map(|r| r.value * r.value).sum();
        let rows = residuals.iter().zip(&self.rows);
        let sized = rows.filter(|(_, row)| row.magnitude > 0.0);
        let relative = sized.map(|(r, row)| r.abs() / row.magnitude);
        let worst = relative.fold(0.0, f64::max);
        let rms = if total > 0.0 {
            (sum / total).sqrt()
        } else {
            0.0
        };
        EntryReport {
            force: self.force,
            motion: self.motion,
            relative_rms: Some(rms),
            worst_relative: Some(worst),
            poles: poles.to_vec(),
            coefficients: Vec::new(),
            covariance: Vec::new(),
            condition: fit.factor.condition(fit.unknowns),
            cancellation: fit.cancellation,
        }
    }

    /// Residuals of given coefficients, unweighted, in the order of the rows.
    pub(crate) fn residuals(&self, basis: &Basis, coefficients: &[f64]) -> Vec<f64> {
        let residual = |row: &EntrySample| {
            let columns = basis.columns(Complex::new(0.0, row.k));
            let terms = row.seen(&columns).zip(coefficients);
            row.value - terms.map(|(x, c)| x * c).sum::<f64>()
        };
        self.rows.iter().map(residual).collect()
    }
}

/// Samples by entry, row by row of the matrix, with their weights; the second value says what had to be assumed.
///
/// # Errors
/// [`Error::Input`](crate::error::Error::Input) for a sample that is not finite, whose `K` is not positive, or an entry without any.
pub(crate) fn sort_by_entry(
    samples: &[TransferSample],
    dofs: &[Dof],
    weights: FrequencyWeights,
) -> Result<(Vec<EntrySamples>, Vec<String>)> {
    let pairs = dofs.iter().flat_map(|f| dofs.iter().map(move |m| (*f, *m)));
    let empty = |(force, motion)| EntrySamples {
        force,
        motion,
        rows: Vec::new(),
        weight: 1.0,
        ridge: 0.0,
        limit: [None; 2],
    };
    let mut entries: Vec<EntrySamples> = pairs.map(empty).collect();
    for (at, s) in samples.iter().enumerate() {
        let place = format!("sample {at}");
        let i = index_of(dofs, s.force, &place)?;
        let j = index_of(dofs, s.motion, &place)?;
        let k = positive(format!("{place}: K"), s.k.full_width())?;
        ensure(s.value.is_finite(), place, "a finite value", s.value)?;
        entries[i * dofs.len() + j].rows.push(EntrySample {
            k,
            part: s.part,
            value: s.value,
            weight: 1.0,
            magnitude: s.value.abs(),
            mean_speed_m_s: s.mean_speed_m_s,
        });
    }
    let mut notes = Vec::new();
    for entry in &mut entries {
        ensure(!entry.rows.is_empty(), entry.name(), "at least one", "none")?;
        let unpaired = pair(&mut entry.rows);
        if unpaired > 0 && weights == FrequencyWeights::Relative {
            notes.push(format!(
                "{}: {unpaired} have no other part at the same K; their weight is relative to their own size",
                entry.name()
            ));
        }
        weigh(&mut entry.rows, weights);
    }
    Ok((entries, notes))
}

/// Gives the entries what `fit` says of single ones: weights, ridge, limits.
///
/// # Errors
/// [`Error::Input`](crate::error::Error::Input) for weights of another shape and limits of degrees of freedom that are not there.
pub(crate) fn state_requirements(
    entries: &mut [EntrySamples],
    dofs: &[Dof],
    fit: &FrequencyFit,
) -> Result<()> {
    let n = dofs.len();
    for (at, entry) in entries.iter_mut().enumerate() {
        entry.weight = fit.entry_weight(n, at / n, at % n)?;
        entry.ridge = fit.regularization;
    }
    let limits = limits_by_entry(dofs, &fit.limits)?;
    for (entry, limit) in entries.iter_mut().zip(limits) {
        entry.limit = limit;
    }
    Ok(())
}

/// Sets the magnitude of `G` from the nearest sample of the other part; returns how many have none.
fn pair(rows: &mut [EntrySample]) -> usize {
    let nearest = |row: &EntrySample| {
        let others = rows.iter().filter(|other| other.part != row.part);
        let apart = others.map(|other| ((other.k / row.k).ln().abs(), other.value));
        let nearest = apart.min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.filter(|(distance, _)| *distance < PAIRING_TOLERANCE)
    };
    let others: Vec<Option<(f64, f64)>> = rows.iter().map(nearest).collect();
    let mut unpaired = 0;
    for (row, other) in rows.iter_mut().zip(others) {
        match other {
            Some((_, value)) => row.magnitude = row.value.hypot(value),
            None => unpaired += 1,
        }
    }
    unpaired
}

fn weigh(rows: &mut [EntrySample], weights: FrequencyWeights) {
    // a part that happens to pass through zero must not get an infinite weight
    let floor = 1e-3 * rows.iter().map(|r| r.magnitude).fold(0.0, f64::max);
    for row in rows {
        row.weight = match weights {
            FrequencyWeights::None => 1.0,
            FrequencyWeights::Derivatives => row.k.powi(-2),
            FrequencyWeights::Relative if floor > 0.0 => 1.0 / row.magnitude.max(floor),
            FrequencyWeights::Relative => 1.0,
        };
    }
}

/// What brings data of this sum of squares to a sum of one; one where there are none.
pub(crate) fn unit_scale(total: f64) -> f64 {
    match total > 0.0 {
        true => total.sqrt().recip(),
        false => 1.0,
    }
}

/// What the weighted residuals of each entry are multiplied with where entries share something: its weight over its
/// weighted size.
pub(super) fn shares(entries: &[&EntrySamples]) -> Vec<f64> {
    let share = |entry: &&EntrySamples| match entry.total() * entries.len() as f64 {
        total if total > 0.0 => entry.weight / total.sqrt(),
        _ => entry.weight,
    };
    entries.iter().map(share).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::FlatPlate;

    #[test]
    fn weights_are_those_of_the_formulae() {
        let ks = [0.1, 0.5].map(ReducedFrequency::from_full_width);
        let samples = sample_model(&FlatPlate::default(), &ks).unwrap();
        assert_eq!(samples.len(), 16);
        let g = FlatPlate::default().transfer(ks[1]).unwrap();
        for (weights, expected) in [
            (FrequencyWeights::None, 1.0),
            (FrequencyWeights::Derivatives, 4.0),
            (FrequencyWeights::Relative, 1.0 / g[(0, 1)].norm()),
        ] {
            let (entries, notes) = sort_by_entry(&samples, &Dof::TWO, weights).unwrap();
            assert!(notes.is_empty());
            let row = entries[1].rows.iter().find(|r| r.k == 0.5).unwrap();
            assert!((row.weight / expected - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn missing_entries_and_bad_numbers_are_named() {
        let ks = [0.1, 0.5].map(ReducedFrequency::from_full_width);
        let mut samples = sample_model(&FlatPlate::default(), &ks).unwrap();
        let message = |s: &[TransferSample]| {
            sort_by_entry(s, &Dof::TWO, FrequencyWeights::None)
                .unwrap_err()
                .to_string()
        };
        samples[3].value = f64::NAN;
        assert_eq!(
            message(&samples),
            "sample 3: expected a finite value, found NaN"
        );
        samples.retain(|s| s.motion == Dof::Vertical);
        assert!(message(&samples).contains("vertical force due to torsion motion"));
    }
}
