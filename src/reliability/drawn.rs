//! The model whose coefficients are drawn, and the factor of their covariance.
//!
//! The covariance of a fit holds all its parameters, searched poles among them: with a pole the coefficients move
//! together, and drawn at fixed poles they would be another model. The model is therefore followed along its slope with
//! respect to the poles, in chains of filters that span it ([`crate::uncertainty::LinearModel`]): a linear function of
//! the parameters, of which standard errors speak as well.

use super::coefficients;
use super::plan::MonteCarloPlan;
use super::scatter::{CovarianceFactor, factor_of, from_file};
use crate::aerodynamics::Transfer;
use crate::error::{Error, Result};
use crate::trained_model::{Model, TrainedModel};
use crate::uncertainty::{CoefficientUncertainty, SEARCHED_POLES};
use nalgebra::DMatrix;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// A model whose transfer matrix differs by more than this, relatively, is another one.
const SAME_MODEL: f64 = 1e-6;

/// The part of `<model>.uncertainty.json` that is drawn from.
#[derive(Deserialize)]
struct Saved {
    coefficients: CoefficientUncertainty,
}

/// The assumption stated in the report of a fit.
#[derive(Deserialize)]
struct Stated {
    #[serde(default)]
    covariance_assumption: String,
}

/// The model in the form in which its draws are linear, and the factor of the covariance that the plan names.
///
/// # Errors
/// [`Error::Input`] naming the file that does not fit the model.
pub(super) fn drawn_model(
    plan: &MonteCarloPlan,
    trained: &TrainedModel,
) -> Result<(Model, Option<CovarianceFactor>)> {
    let Some(path) = &plan.aerodynamics.covariance else {
        return Ok((trained.model.clone(), None));
    };
    let path = plan.directory.join(path);
    let text = std::fs::read_to_string(&path).map_err(|e| Error::io(&path, e))?;
    if let Some((file, saved)) = all_parameters(&path, &text)? {
        let (model, factor) = follow(&saved, trained).map_err(|e| e.in_file(&file))?;
        return Ok((model, Some(factor)));
    }
    let (_, names) = coefficients::of(&trained.model);
    let factor = from_file(&path, &text, &names)?;
    Ok((trained.model.clone(), Some(factor)))
}

/// The covariance of all parameters, from the file itself or from the one beside a report.
fn all_parameters(path: &Path, text: &str) -> Result<Option<(PathBuf, CoefficientUncertainty)>> {
    let json = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("json"));
    if !json {
        return Ok(None);
    }
    if let Ok(saved) = serde_json::from_str::<Saved>(text) {
        return Ok(Some((path.to_owned(), saved.coefficients)));
    }
    let beside = path.with_extension("uncertainty.json");
    if let Ok(text) = std::fs::read_to_string(&beside) {
        let saved: Saved = serde_json::from_str(&text).map_err(|e| {
            let place = format!("{}, line {}", beside.display(), e.line());
            Error::input(place, "the uncertainty of a model", e.to_string())
        })?;
        return Ok(Some((beside, saved.coefficients)));
    }
    match serde_json::from_str::<Stated>(text) {
        Ok(stated) if stated.covariance_assumption.contains(SEARCHED_POLES) => Err(Error::input(
            path.display().to_string(),
            format!(
                "{} beside it: coefficients move with the searched poles, whose covariance is there",
                beside.display()
            ),
            "none",
        )),
        _ => Ok(None),
    }
}

/// The linear model of an estimate, and the factor of its coefficients' covariance.
fn follow(
    estimate: &CoefficientUncertainty,
    trained: &TrainedModel,
) -> Result<(Model, CovarianceFactor)> {
    let values = estimate.values();
    let linear = estimate.linear()?;
    let at = |values: &[f64]| match &linear {
        Some(linear) => linear.model_at(values),
        None => estimate.model_at(values),
    };
    let model = at(&values)?;
    let k = trained.tested_range.min;
    let other = || {
        Error::input(
            "covariance",
            format!("that of the training of {}", trained.name),
            "that of another model",
        )
    };
    if model.dofs() != trained.model.dofs() {
        return Err(other());
    }
    let (own, expected) = (model.transfer(k)?, trained.model.transfer(k)?);
    if (own - &expected).norm() > SAME_MODEL * expected.norm() {
        return Err(other());
    }
    let (base, _) = coefficients::of(&model);
    let mut slopes = DMatrix::zeros(base.len(), values.len());
    for p in 0..values.len() {
        let mut moved = values.clone();
        // the model is linear in its parameters: any step is exact
        moved[p] += 1.0;
        let (there, _) = coefficients::of(&at(&moved)?);
        for (row, (a, b)) in there.iter().zip(&base).enumerate() {
            slopes[(row, p)] = a - b;
        }
    }
    let factor = CovarianceFactor {
        places: (0..base.len()).collect(),
        factor: slopes * factor_of(estimate.covariance.clone())?,
    };
    Ok((model, factor))
}
