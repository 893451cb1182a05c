//! The guard of every export: a model that grows where it should not is refused.

use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result};
use crate::flutter::{OnsetSearch, UnwantedGrowth, unwanted_growth};
use crate::trained_model::TrainedModel;

/// What becomes of a model that grows below its onset.
///
/// ```
/// use aerodeck::fmu::package::{Export, GrowthPolicy};
///
/// let export = Export::from(GrowthPolicy::Allow);
/// assert_eq!(export.growing, GrowthPolicy::Allow);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GrowthPolicy {
    /// It is not packed.
    Refuse,
    /// It is packed; its documentation and its log say at which speeds it grows.
    Allow,
}

impl GrowthPolicy {
    /// Packs it where that is wanted.
    pub fn allowing(wanted: bool) -> Self {
        match wanted {
            true => Self::Allow,
            false => Self::Refuse,
        }
    }
}

/// Growth below the onset of the section of a model, by extrapolation alone; see `unwanted_growth`.
pub(crate) fn growth_of(model: &TrainedModel) -> Result<UnwantedGrowth> {
    let section = CoupledSection::with_model(&model.section.structure()?, &model.model)?;
    let search = OnsetSearch::up_to(model.experiment.onset_search_limit_m_s);
    unwanted_growth(&section, &search, Some(model.tested_range))
}

/// Refuses a model that grows where it should not, unless that is allowed.
pub(super) fn check(model: &TrainedModel, growing: GrowthPolicy) -> Result<()> {
    if growing == GrowthPolicy::Allow {
        return Ok(());
    }
    let growth = growth_of(model)?;
    if growth.is_none() {
        return Ok(());
    }
    Err(Error::Unstable(format!(
        "{} is not exported: it {}",
        model.name,
        growth.explain()
    )))
}
