//! An uncertainty with the data that it knows, for another process. Files leave the data out.

use super::coefficients::CoefficientUncertainty;
use super::design::Design;
use super::speed_scatter::Effect;
use crate::units::ReducedFrequencyRange;
use serde::{Deserialize, Serialize};

/// An estimate of the coefficients with the data that it was made from.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct UncertaintyWithData {
    estimates: CoefficientUncertainty,
    design: Option<Design>,
    tested: Option<ReducedFrequencyRange>,
    effects: Vec<Effect>,
}

impl From<CoefficientUncertainty> for UncertaintyWithData {
    fn from(mut estimates: CoefficientUncertainty) -> Self {
        Self {
            design: estimates.design.take(),
            tested: estimates.tested.take(),
            effects: std::mem::take(&mut estimates.effects),
            estimates,
        }
    }
}

impl From<UncertaintyWithData> for CoefficientUncertainty {
    fn from(whole: UncertaintyWithData) -> Self {
        Self {
            design: whole.design,
            tested: whole.tested,
            effects: whole.effects,
            ..whole.estimates
        }
    }
}
