//! Draws of Student's t: errors whose size is itself estimated.

use crate::error::{Error, Result};
use rand::Rng;
use rand_distr::ChiSquared;

/// `√(ν/χ²_ν)`: Gaussian numbers times one of it are multivariate Student's t.
#[derive(Debug, Clone, Copy)]
pub struct StudentScale {
    freedom: f64,
    chi_squared: ChiSquared<f64>,
}

impl StudentScale {
    /// With `freedom` degrees of freedom.
    ///
    /// # Errors
    /// [`Error::Numerical`] for a number that is not positive.
    pub fn new(freedom: f64) -> Result<Self> {
        let chi_squared = ChiSquared::new(freedom).map_err(|e| {
            Error::Numerical(format!("draws with {freedom} degrees of freedom: {e}"))
        })?;
        Ok(Self {
            freedom,
            chi_squared,
        })
    }

    /// One of it.
    pub fn draw(&self, random: &mut impl Rng) -> f64 {
        (self.freedom / random.sample(self.chi_squared)).sqrt()
    }
}
