//! Samples of section and coefficients: each a function of the seed and its own number.

use super::distribution::Transform;
use super::plan::{MonteCarloPlan, SectionProperty};
use super::scatter::CovarianceFactor;
use crate::error::{Error, Result};
use crate::section::SectionModel;
use crate::signal::random_stream;
use crate::uncertainty::StudentScale;
use nalgebra::DMatrix;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

/// Draws samples. One stream of the generator per sample, so that neither threads nor their order matter.
pub(super) struct Sampler {
    seed: u64,
    section: SectionModel,
    coefficients: Vec<f64>,
    parameters: Vec<(SectionProperty, Transform)>,
    /// Lower factor of the correlation matrix; `None` when all are independent.
    correlation: Option<DMatrix<f64>>,
    /// Standard deviation of each coefficient over its value, which goes before the covariance.
    relative_scatter: Option<f64>,
    covariance: Option<CovarianceFactor>,
    /// What makes Gaussian draws of a covariance those of Student's t; `None` where it has no degrees of freedom.
    scale: Option<StudentScale>,
}

/// One sample, kept from one to the next so that nothing is allocated anew.
#[derive(Debug, Clone)]
pub(super) struct Sample {
    pub(super) section: SectionModel,
    pub(super) coefficients: Vec<f64>,
    normal: Vec<f64>,
}

impl Sampler {
    /// The sampler of a plan for a section and the coefficients of its force model, with the factor of their covariance.
    pub(super) fn new(
        plan: &MonteCarloPlan,
        section: &SectionModel,
        coefficients: &[f64],
        covariance: Option<CovarianceFactor>,
    ) -> Result<Self> {
        let mut parameters = Vec::with_capacity(plan.parameters.len());
        for (i, random) in plan.parameters.iter().enumerate() {
            let key = format!("parameter[{i}]");
            let nominal = random.name.nominal(&format!("{key}.name"), section)?;
            let place = format!("{key}.distribution");
            parameters.push((random.name, random.distribution.resolve(&place, nominal)?));
        }
        let freedom = covariance.as_ref().and_then(|c| c.draws.degrees_of_freedom);
        Ok(Self {
            seed: plan.seed,
            section: section.clone(),
            coefficients: coefficients.to_vec(),
            correlation: correlation(plan)?,
            parameters,
            relative_scatter: plan.aerodynamics.relative_scatter,
            covariance,
            scale: freedom.map(StudentScale::new).transpose()?,
        })
    }

    /// A sample to be filled by [`Sampler::draw`].
    pub(super) fn empty(&self) -> Sample {
        Sample {
            section: self.section.clone(),
            coefficients: self.coefficients.clone(),
            normal: Vec::new(),
        }
    }

    /// Sample number `index`.
    pub(super) fn draw(&self, index: u64, sample: &mut Sample) {
        let mut random = random_stream(self.seed, index);
        fill(&mut sample.normal, self.parameters.len(), &mut random);
        for (i, (parameter, transform)) in self.parameters.iter().enumerate() {
            let z = match &self.correlation {
                None => sample.normal[i],
                Some(factor) => (0..=i).map(|j| factor[(i, j)] * sample.normal[j]).sum(),
            };
            if let Some(place) = parameter.place(&mut sample.section) {
                *place = transform(z);
            }
        }
        if let Some(scatter) = self.relative_scatter {
            for (value, nominal) in sample.coefficients.iter_mut().zip(&self.coefficients) {
                let z: f64 = random.sample(StandardNormal);
                *value = nominal * (1.0 + scatter * z);
            }
        } else if let Some(covariance) = &self.covariance {
            fill(&mut sample.normal, covariance.factor.ncols(), &mut random);
            if let Some(scale) = &self.scale {
                let by = scale.draw(&mut random);
                sample.normal.iter_mut().for_each(|z| *z *= by);
            }
            for (row, place) in covariance.places.iter().enumerate() {
                let terms = covariance.factor.row(row);
                let change: f64 = terms.iter().zip(&sample.normal).map(|(s, z)| s * z).sum();
                sample.coefficients[*place] = self.coefficients[*place] + change;
            }
        }
    }
}

fn fill(normal: &mut Vec<f64>, count: usize, random: &mut ChaCha8Rng) {
    normal.clear();
    normal.extend((0..count).map(|_| random.sample::<f64, _>(StandardNormal)));
}

/// Lower Cholesky factor of the correlation matrix.
fn correlation(plan: &MonteCarloPlan) -> Result<Option<DMatrix<f64>>> {
    if plan.correlations.is_empty() {
        return Ok(None);
    }
    let n = plan.parameters.len();
    let mut matrix = DMatrix::identity(n, n);
    for c in &plan.correlations {
        let at = |p: SectionProperty| plan.parameters.iter().position(|r| r.name == p);
        if let [Some(i), Some(j)] = c.between.map(at) {
            matrix[(i, j)] = c.coefficient;
            matrix[(j, i)] = c.coefficient;
        }
    }
    let factor = matrix.cholesky().ok_or_else(|| {
        Error::input(
            "correlation",
            "coefficients that go together (a positive definite matrix)",
            "some that contradict each other",
        )
    })?;
    Ok(Some(factor.l()))
}
