//! How the coefficients of the force model were drawn, and what of their uncertainty is in no draw.

use super::plan::AerodynamicScatter;
use crate::uncertainty::ModelUncertainty;
use serde::{Deserialize, Serialize};

/// The draws of the force model's coefficients.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct DrawnForces {
    /// Degrees of freedom of the multivariate Student's t distribution; `null` where the draws are Gaussian.
    pub degrees_of_freedom: Option<f64>,
    /// Standard deviation of every coefficient over its value, where each scatters by itself.
    pub relative_scatter: Option<f64>,
    /// What the choice of the model's form leaves open of its onset, m/s (root mean square): known, and in no draw.
    pub form_left_out_m_s: Option<f64>,
}

impl DrawnForces {
    /// Draws by the covariance of a fit, as its file knows it.
    ///
    /// The variances behind a covariance are themselves estimates from few blocks. Student's t with the degrees of freedom of the
    /// onset's variance, one scale for all parameters, gives an onset that is linear in them the distribution of its interval;
    /// those of each force by itself are in no file, and would have to be combined to these anyway.
    pub(super) fn of_fit(saved: &ModelUncertainty) -> Self {
        let onset = saved.onset.as_ref().map(|o| o.speed_m_s);
        let spread = saved.form_spread.as_ref().zip(onset);
        Self {
            degrees_of_freedom: saved.degrees_of_freedom_of_draws(),
            form_left_out_m_s: spread.and_then(|(s, speed)| s.deviation_from_m_s(speed)),
            ..Self::default()
        }
    }

    /// Those of a plan without a covariance; none where the forces are not random.
    pub(super) fn of_plan(scatter: &AerodynamicScatter) -> Option<Self> {
        scatter.relative_scatter.map(|scatter| Self {
            relative_scatter: Some(scatter),
            ..Self::default()
        })
    }

    /// What was drawn, in words.
    pub fn in_words(&self) -> String {
        match (self.relative_scatter, self.degrees_of_freedom) {
            (Some(scatter), _) => format!(
                "every coefficient by itself, Gaussian, standard deviation {} % of its value",
                100.0 * scatter
            ),
            (None, Some(freedom)) => format!(
                "all parameters of the fit together, Student's t with the {freedom:.1} degrees of freedom of its covariance"
            ),
            (None, None) => "by the covariance, Gaussian: its file states no degrees of freedom, and where it is estimated from few \
                             blocks of data the tails are too thin"
                .to_owned(),
        }
    }

    /// What is known to be in no draw, in words.
    pub fn left_out(&self) -> Option<String> {
        let form = self.form_left_out_m_s.filter(|form| *form > 0.0)?;
        Some(format!(
            "the spread of the onset between forms of model that explain the data as well, {form:.3} m/s for the model itself, is in \
             no sample; the interval of its onset holds it"
        ))
    }
}
