//! Interval of an onset: by its gradient, and by re-solving it for other weights of the blocks.

use super::coefficients::CoefficientUncertainty;
use super::sensitivity::{onset_gradient, onset_nearby};
use super::student::two_sided_quantile;
use crate::aerodynamics::Realizable;
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::flutter::{FlutterSearch, Onset, OnsetInterval, OnsetSearch, find_onset};
use crate::section::Structure;
use crate::units::ReducedFrequencyRange;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Exp1, StandardNormal};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Confidence of every interval.
pub(crate) const CONFIDENCE: f64 = 0.95;

/// Onset with its standard error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OnsetError {
    /// Onset speed, m/s.
    pub speed_m_s: f64,
    /// Standard error by the gradient, m/s.
    pub standard_error_m_s: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: f64,
}

/// Standard error of an onset by the delta method, `√(gᵀ C g)` with the gradient `g` of the onset speed.
///
/// `degrees_of_freedom` stands in where the estimate no longer knows its data.
pub(crate) fn onset_error(
    estimate: &CoefficientUncertainty,
    structure: &Structure,
    onset: &Onset,
    degrees_of_freedom: Option<f64>,
) -> Result<OnsetError> {
    let at = (onset.at.speed_m_s, TAU * onset.at.frequency_hz);
    error_at(estimate, structure, at, degrees_of_freedom)
}

/// The same for an onset at a speed and circular frequency.
pub(super) fn error_at(
    estimate: &CoefficientUncertainty,
    structure: &Structure,
    at: (f64, f64),
    degrees_of_freedom: Option<f64>,
) -> Result<OnsetError> {
    let gradient = onset_gradient(estimate, structure, at)?;
    Ok(OnsetError {
        speed_m_s: at.0,
        standard_error_m_s: estimate.standard_error(&gradient)?,
        degrees_of_freedom: estimate
            .degrees_of_freedom(&gradient)
            .or(degrees_of_freedom)
            .unwrap_or(1.0),
    })
}

impl CoefficientUncertainty {
    /// 95 % interval of an onset of the model with these coefficients, on any structure: as far as its data carry.
    ///
    /// # Errors
    /// [`crate::Error::Numerical`] when the onset cannot be followed to nearby coefficients.
    pub fn onset_interval(&self, structure: &Structure, onset: &Onset) -> Result<OnsetInterval> {
        self.interval_knowing(structure, onset, None)
    }

    /// The same with the degrees of freedom of an estimate that no longer knows its data.
    pub(super) fn interval_knowing(
        &self,
        structure: &Structure,
        onset: &Onset,
        degrees_of_freedom: Option<f64>,
    ) -> Result<OnsetInterval> {
        let error = onset_error(self, structure, onset, degrees_of_freedom)?;
        Ok(match self.known_bias() {
            Some(bias) => OnsetInterval::none(format!(
                "{bias} (standard error of the scatter alone {:.3} m/s)",
                error.standard_error_m_s
            )),
            None => error.interval(),
        })
    }
}

impl OnsetError {
    /// Half the width of the interval, m/s: Student's quantile times the standard error.
    pub(crate) fn half_width_m_s(&self) -> f64 {
        two_sided_quantile(CONFIDENCE, self.degrees_of_freedom) * self.standard_error_m_s
    }

    /// The interval for a card.
    pub(crate) fn interval(&self) -> OnsetInterval {
        OnsetInterval::about(
            self.speed_m_s,
            self.half_width_m_s(),
            self.standard_error_m_s,
            self.degrees_of_freedom,
        )
    }
}

/// How parameters are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Resampling {
    /// Block bootstrap: every block counts with a weight drawn from the exponential distribution (Rubin's form, which
    /// never leaves a frequency out), and the fit is solved again from the factors of the blocks.
    Blocks,
    /// Normal draws from the covariance of the parameters.
    Normal,
}

/// Onsets of many resampled fits, each solved anew.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResampledOnset {
    /// How parameters were drawn.
    pub resampling: Resampling,
    /// Number of replicates.
    pub replicates: usize,
    /// Replicates without an onset up to the highest speed, or whose parameters make no model.
    pub without_onset: usize,
    /// Mean of the onsets, m/s.
    pub mean_m_s: f64,
    /// Their standard deviation, m/s.
    pub standard_deviation_m_s: f64,
    /// 2.5 % quantile, m/s.
    pub low_m_s: f64,
    /// 97.5 % quantile, m/s.
    pub high_m_s: f64,
}

/// What a resampling needs besides the estimate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ResamplingPlan {
    /// How parameters are drawn.
    pub resampling: Resampling,
    /// Number of replicates.
    pub replicates: usize,
    /// Seed; each replicate draws from a stream of its own.
    pub seed: u64,
    /// Where to look for an onset that is not near the estimate.
    pub search: OnsetSearch,
    /// Reduced frequencies in which the model was tested.
    pub tested: Option<ReducedFrequencyRange>,
}

/// Draws parameters and solves the onset anew for each draw, in parallel. Searched poles move the transfer function
/// along its slope (see [`super::LinearModel`]). The answer does not depend on the number of
/// threads. `None` for blocks of an estimate that no longer knows its data.
pub(crate) fn resample_onset(
    estimate: &CoefficientUncertainty,
    structure: &Structure,
    onset: &Onset,
    plan: &ResamplingPlan,
) -> Result<Option<ResampledOnset>> {
    let draw = Draw::new(estimate, plan)?;
    let linear = estimate.linear()?;
    let at = (onset.at.speed_m_s, TAU * onset.at.frequency_hz);
    let drawn: Vec<Option<Option<f64>>> = (0..plan.replicates)
        .into_par_iter()
        .map(|r| {
            let Some(values) = draw.parameters(estimate, plan, r)? else {
                return Ok(None);
            };
            let model = match &linear {
                Some(linear) => linear.model_at(&values),
                None => estimate.model_at(&values),
            };
            Ok(Some(
                model.ok().and_then(|m| solve(&m, structure, at, plan)),
            ))
        })
        .collect::<Result<_>>()?;
    if drawn.iter().any(Option::is_none) {
        return Ok(None);
    }
    let mut speeds: Vec<f64> = drawn.iter().filter_map(|d| d.flatten()).collect();
    speeds.sort_by(f64::total_cmp);
    let count = speeds.len() as f64;
    let mean = speeds.iter().sum::<f64>() / count;
    let squares: f64 = speeds.iter().map(|v| (v - mean).powi(2)).sum();
    Ok(Some(ResampledOnset {
        resampling: plan.resampling,
        replicates: plan.replicates,
        without_onset: plan.replicates - speeds.len(),
        mean_m_s: mean,
        standard_deviation_m_s: (squares / (count - 1.0)).sqrt(),
        low_m_s: quantile(&speeds, 0.5 * (1.0 - CONFIDENCE)),
        high_m_s: quantile(&speeds, 0.5 * (1.0 + CONFIDENCE)),
    }))
}

/// Onset of one draw.
fn solve(
    model: &dyn Realizable,
    structure: &Structure,
    at: (f64, f64),
    plan: &ResamplingPlan,
) -> Option<f64> {
    let section = CoupledSection::with_model(structure, model).ok()?;
    if let Ok(Some(speed)) = onset_nearby(&section, at) {
        return Some(speed);
    }
    match find_onset("", &section, &plan.search, plan.tested) {
        Ok(FlutterSearch::Onset(onset)) => Some(onset.at.speed_m_s),
        _ => None,
    }
}

/// What all draws share.
enum Draw {
    Blocks(usize),
    /// Square root of the covariance.
    Normal(nalgebra::DMatrix<f64>),
}

impl Draw {
    fn new(estimate: &CoefficientUncertainty, plan: &ResamplingPlan) -> Result<Self> {
        if plan.resampling == Resampling::Blocks {
            return Ok(Self::Blocks(estimate.blocks.len()));
        }
        let covariance = estimate.covariance.clone();
        let scale = covariance.amax();
        let eigen = nalgebra::SymmetricEigen::try_new(covariance, f64::EPSILON, 10_000)
            .filter(|_| scale.is_finite())
            .ok_or_else(|| {
                crate::Error::Numerical("resampling: the covariance has no root".into())
            })?;
        let root = eigen.eigenvalues.map(|x| x.max(0.0).sqrt());
        let columns = eigen.eigenvectors.column_iter().zip(root.iter());
        let columns: Vec<_> = columns.map(|(c, r)| c * *r).collect();
        Ok(Self::Normal(nalgebra::DMatrix::from_columns(&columns)))
    }

    fn parameters(
        &self,
        estimate: &CoefficientUncertainty,
        plan: &ResamplingPlan,
        replicate: usize,
    ) -> Result<Option<Vec<f64>>> {
        let mut random = ChaCha8Rng::seed_from_u64(plan.seed);
        random.set_stream(replicate as u64);
        match self {
            Self::Blocks(count) => {
                let weights: Vec<f64> = (0..*count).map(|_| Exp1.sample(&mut random)).collect();
                let mut drawn = estimate.reweighted(&weights)?;
                if let Some(values) = &mut drawn {
                    estimate.scatter_speeds(values, &mut || StandardNormal.sample(&mut random));
                }
                Ok(drawn)
            }
            Self::Normal(root) => {
                let normal = nalgebra::DVector::from_fn(root.ncols(), |_, _| {
                    StandardNormal.sample(&mut random)
                });
                let step: nalgebra::DVector<f64> = root * normal;
                let moved = estimate.parameters.iter().zip(step.iter());
                Ok(Some(moved.map(|(p, d)| p.value + d).collect()))
            }
        }
    }
}

/// Quantile of sorted values, linear between them; not a number for none.
fn quantile(sorted: &[f64], part: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else {
        return f64::NAN;
    };
    let at = part * last as f64;
    let low = at.floor() as usize;
    let rest = at - low as f64;
    sorted[low] + rest * (sorted[(low + 1).min(last)] - sorted[low])
}
