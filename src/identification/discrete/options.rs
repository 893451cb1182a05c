//! What a fit of the discrete model is asked to do.

use crate::error::{Error, Result};
use crate::identification::options::{TimeWeights, number_of_filters};
use crate::identification::own::{OwnDecay, StaticTerm, each_once, place_of};
use crate::section::Dof;
use serde::{Deserialize, Serialize};

/// Fit of the thesis's discrete Laguerre model to records.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DiscreteFit {
    /// Number of filters `L`.
    pub filters: usize,
    /// Decay factor, `0 < α < 1`.
    pub alpha: f64,
    /// Weighting; the thesis has none.
    pub weights: TimeWeights,
    /// What is done about a constant in the forces.
    pub static_term: StaticTerm,
    /// Transfer functions with a number of filters or a decay factor of their own.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub own: Vec<OwnDecay>,
}

impl Default for DiscreteFit {
    /// The thesis's choice: three filters, α = 0.6; the constant of (2.23) is estimated along.
    fn default() -> Self {
        Self {
            filters: 3,
            alpha: 0.6,
            weights: TimeWeights::None,
            static_term: StaticTerm::Estimated,
            own: Vec::new(),
        }
    }
}

impl DiscreteFit {
    /// Checks every value.
    ///
    /// # Errors
    /// [`Error::Input`] naming the key.
    pub fn validate(&self) -> Result<()> {
        each_once(self.own.iter().map(|o| (o.force, o.motion)))?;
        let own = self.own.iter().map(|o| ("own.", o.filters, o.alpha));
        for (key, filters, alpha) in own.chain([("", Some(self.filters), Some(self.alpha))]) {
            if let Some(filters) = filters {
                number_of_filters(&format!("{key}filters"), filters)?;
            }
            if let Some(alpha) = alpha.filter(|a| !(*a > 0.0 && *a < 1.0)) {
                return Err(Error::input(
                    format!("{key}alpha"),
                    "0 < alpha < 1",
                    alpha.to_string(),
                ));
            }
        }
        Ok(())
    }

    /// Decay factor and number of filters of every transfer function, row by row.
    ///
    /// # Errors
    /// [`Error::Input`] for degrees of freedom that the records do not have.
    pub(crate) fn parameters(&self, dofs: &[Dof]) -> Result<Vec<(f64, usize)>> {
        let mut all = vec![(self.alpha, self.filters); dofs.len() * dofs.len()];
        for own in &self.own {
            all[place_of(dofs, own.force, own.motion)?] = (
                own.alpha.unwrap_or(self.alpha),
                own.filters.unwrap_or(self.filters),
            );
        }
        Ok(all)
    }
}
