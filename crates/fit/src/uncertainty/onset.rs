//! Interval of an onset: by its gradient, and by solving it anew for other weights of the blocks or drawn parameters.
//!
//! For a simple eigenvalue `λ` of the state matrix `A(V, θ)` with right and left vectors `v`, `u`,
//! `dλ = uᴴ dA v / uᴴ v` (Murthy & Haftka, "Derivatives of eigenvalues and eigenvectors of a general complex matrix",
//! IJNME 26, 1988). At the onset `Re λ = 0`, so `dV_F/dθ = −Re(∂λ/∂θ)/Re(∂λ/∂V)`.

use super::coefficients::CoefficientUncertainty;
use super::draws::ModelDraws;
use super::statistics::{SampledOnsets, two_sided_quantile};
use crate::aeroelastic::{CoupledSection, CoupledSystem};
use crate::error::{Error, Result};
use crate::flutter::{BetweenSpeeds, Onset, OnsetSearch, find_onset};
use crate::numbered::numbered;
use crate::section::Structure;
use crate::signal::random_stream;
use crate::state_space::{ValueAt, complex, eigenvector, secant};
use crate::units::ReducedFrequencyRange;
use nalgebra::{Complex, DMatrix, DVector};
use rand_distr::{Distribution, Exp1, StandardNormal};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Confidence of every interval.
pub(crate) const CONFIDENCE: f64 = 0.95;
/// Seed of the resamplings, of which each replicate draws from a stream of its own.
const SEED: u64 = 1;
/// Relative step of the difference of state matrices.
const STEP: f64 = 1e-6;
/// Secant steps to a zero of the growth rate.
const MAX_STEPS: usize = 40;
/// Relative size of the last secant step.
const TOLERANCE: f64 = 1e-10;
/// An onset this far from the estimate, relatively, is looked for afresh.
const REACH: f64 = 0.5;

/// Onset with its standard error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OnsetError {
    /// Onset speed, m/s.
    pub speed_m_s: f64,
    /// Standard error of the scatter of the data, by the gradient, m/s.
    pub standard_error_m_s: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: f64,
    /// Where the scatter between mean speeds in it is from; none where it holds none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub between_speeds: Option<BetweenSpeeds>,
}

/// Speed (m/s) and circular frequency of an onset.
pub(super) fn speed_and_omega(onset: &Onset) -> [f64; 2] {
    [onset.at.speed_m_s, TAU * onset.at.frequency_hz]
}

/// Standard error of the onset at a speed and circular frequency by the delta method, `√(gᵀ C g)` with the gradient `g` of its speed.
///
/// `degrees_of_freedom` stands in where the estimate no longer knows its data.
pub(crate) fn onset_error(
    estimate: &CoefficientUncertainty,
    structure: &Structure,
    at: [f64; 2],
    degrees_of_freedom: Option<f64>,
) -> Result<OnsetError> {
    let gradient = onset_gradient(estimate, structure, at)?;
    let known = estimate.degrees_of_freedom(&gradient);
    Ok(OnsetError {
        speed_m_s: at[0],
        standard_error_m_s: estimate.standard_error(&gradient)?,
        degrees_of_freedom: known.or(degrees_of_freedom).unwrap_or(1.0),
        between_speeds: estimate.speeds.as_ref().map(|s| s.source),
    })
}

impl OnsetError {
    /// Half the width of the interval, m/s: Student's quantile times the standard error.
    pub(crate) fn half_width_m_s(&self) -> f64 {
        two_sided_quantile(CONFIDENCE, self.degrees_of_freedom) * self.standard_error_m_s
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

/// Draws parameters and solves the onset anew for each draw, in parallel. Searched poles move the transfer function
/// along its slope (see [`ModelDraws`]). An onset that is not near the estimate is looked for in `search`, with the reduced frequencies
/// in which the model was `tested`. The answer does not depend on the number of threads. `None` for blocks of an estimate that no longer knows its data, and where no draw has an onset.
pub(crate) fn resample_onset(
    estimate: &CoefficientUncertainty,
    structure: &Structure,
    onset: &Onset,
    resampling: Resampling,
    replicates: usize,
    search: &OnsetSearch,
    tested: Option<ReducedFrequencyRange>,
) -> Result<Option<ResampledOnset>> {
    let draws = ModelDraws::new(estimate)?;
    let near = speed_and_omega(onset);
    let onset_of = |r: usize| -> Result<Option<Option<f64>>> {
        let Some(values) = drawn(estimate, &draws, resampling, r)? else {
            return Ok(None);
        };
        // a draw that makes no model, or none that can be coupled, has no onset
        let section = draws.model_at(&values);
        let section = section.and_then(|m| CoupledSection::with_model(structure, &m));
        let found = section.and_then(|s| followed(&s, near, search, tested));
        Ok(Some(found.ok().flatten().map(|[speed, _]| speed)))
    };
    let found = numbered(replicates, &|_, _| (), onset_of)?;
    let found: Option<Vec<Option<f64>>> = found.into_iter().collect();
    let onsets = found.map(SampledOnsets::from);
    let onsets = onsets.filter(|o| !o.speeds_m_s.is_empty());
    Ok(onsets.map(|onsets| ResampledOnset {
        resampling,
        replicates,
        without_onset: onsets.without_onset,
        mean_m_s: onsets.mean_m_s,
        standard_deviation_m_s: onsets.standard_deviation_m_s,
        low_m_s: onsets.interval_m_s[0],
        high_m_s: onsets.interval_m_s[1],
    }))
}

/// Parameters of one replicate; `None` for blocks of an estimate that no longer knows its data.
fn drawn(
    estimate: &CoefficientUncertainty,
    draws: &ModelDraws<'_>,
    resampling: Resampling,
    replicate: usize,
) -> Result<Option<Vec<f64>>> {
    let mut random = random_stream(SEED, replicate as u64);
    if resampling == Resampling::Normal {
        return Ok(Some(draws.parameters(&mut random)));
    }
    let Some(design) = &estimate.data else {
        return Ok(None);
    };
    // exact for coefficients, one Gauss–Newton step for searched poles, along what active constraints leave free
    let weights = (0..estimate.blocks.len()).map(|_| Exp1.sample(&mut random));
    let step = design.reweighted(&weights.collect::<Vec<f64>>())?;
    let mut values = estimate.moved_by(&step);
    for column in design.effects.iter().flat_map(|e| e.columns.column_iter()) {
        let z: f64 = StandardNormal.sample(&mut random);
        for (value, change) in values.iter_mut().zip(column.iter()) {
            *value += z * change;
        }
    }
    Ok(Some(values))
}

/// The section with the model that the parameters make.
///
/// # Errors
/// Parameters that make no model, or a model that cannot be coupled.
fn section_at(
    structure: &Structure,
    estimate: &CoefficientUncertainty,
    values: &[f64],
) -> Result<CoupledSection> {
    CoupledSection::with_model(structure, &estimate.model_at(values)?)
}

/// Gradient of the onset speed (m/s) with respect to the parameters.
///
/// # Errors
/// [`Error::Numerical`] when the growth rate does not cross zero with speed.
pub(crate) fn onset_gradient(
    estimate: &CoefficientUncertainty,
    structure: &Structure,
    [speed_m_s, omega]: [f64; 2],
) -> Result<Vec<f64>> {
    let values = estimate.values();
    let section = section_at(structure, estimate, &values)?;
    let start = Complex::new(0.0, omega);
    let lambda = nearest(&section.at(speed_m_s)?, start)?;
    let h = STEP * speed_m_s;
    let ahead = nearest(&section.at(speed_m_s + h)?, lambda)?;
    let behind = nearest(&section.at(speed_m_s - h)?, lambda)?;
    let with_speed = (ahead.re - behind.re) / (2.0 * h);
    if with_speed == 0.0 {
        let what = "onset sensitivity: the growth rate does not change with wind speed";
        return Err(Error::Numerical(what.into()));
    }
    let here = section.at(speed_m_s)?;
    let mu = here.matrix_eigenvalue(lambda);
    let right = eigenvector(&here.a, mu)?;
    let left = eigenvector(&here.a.transpose(), mu)?;
    // the transposed matrix has the conjugate of the left vector, so no conjugation here
    let unit = complex(&DMatrix::identity(right.len(), right.len()));
    let scale = bilinear(&left, &unit, &right);
    let matrix_at = |p: usize, step: f64| -> Result<DMatrix<f64>> {
        let mut moved = values.clone();
        moved[p] += step;
        let section = section_at(structure, estimate, &moved)?;
        Ok(section.at(speed_m_s)?.a)
    };
    let slope = |p: usize| {
        let step = STEP * values[p].abs().max(1e-2);
        let change = (matrix_at(p, step)? - matrix_at(p, -step)?) / (2.0 * step);
        let change = bilinear(&left, &complex(&change), &right) / scale;
        // of the continuous-time eigenvalue
        let change = here.step_s.map_or(change, |step_s| change / (mu * step_s));
        Ok(-change.re / with_speed)
    };
    (0..values.len()).map(slope).collect()
}

/// `xᵀ m y`.
fn bilinear(
    x: &DVector<Complex<f64>>,
    m: &DMatrix<Complex<f64>>,
    y: &DVector<Complex<f64>>,
) -> Complex<f64> {
    x.iter().zip((m * y).iter()).map(|(a, b)| a * b).sum()
}

/// The eigenvalue nearest to `target`, rad/s.
fn nearest(system: &CoupledSystem, target: Complex<f64>) -> Result<Complex<f64>> {
    let distance = |z: &Complex<f64>| (z - target).norm();
    let all = system.eigenvalues()?.into_iter();
    let nearest = all.min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.ok_or_else(|| Error::Numerical("onset: no eigenvalues".into()))
}

/// Speed (m/s) and circular frequency of the onset that is followed from those of another, or else of the one that a search finds;
/// `None` where that has none.
pub(super) fn followed(
    section: &CoupledSection,
    [speed_m_s, omega]: [f64; 2],
    search: &OnsetSearch,
    tested: Option<ReducedFrequencyRange>,
) -> Result<Option<[f64; 2]>> {
    if let Ok(Some(speed)) = onset_nearby(section, speed_m_s, omega) {
        return Ok(Some([speed, omega]));
    }
    let found = find_onset("", section, search, tested)?;
    let other = found.onset().map(|o| &o.at);
    Ok(other.map(|at| [at.speed_m_s, TAU * at.frequency_hz]))
}

/// Onset speed near a known one: the zero of the growth rate of the same eigenvalue, by secants. `None` when it does not
/// settle or ends up far away.
fn onset_nearby(section: &CoupledSection, speed_m_s: f64, omega: f64) -> Result<Option<f64>> {
    let mut followed = Complex::new(0.0, omega);
    let mut growth = |speed: f64| -> Result<Option<f64>> {
        if (speed / speed_m_s - 1.0).abs() >= REACH {
            return Ok(None);
        }
        followed = nearest(&section.at(speed)?, followed)?;
        Ok(Some(followed.re))
    };
    let Some(start) = growth(speed_m_s)? else {
        return Ok(None);
    };
    let (start, beside) = (ValueAt::new(speed_m_s, start), speed_m_s * 1.001);
    secant(start, beside, [f64::INFINITY, TOLERANCE], MAX_STEPS, growth)
}
