//! The smallest damping ratio at the present wind, which importers may read at every step.

use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::flutter::LeastDamping;

/// What is known of it; made anew, as [`Default`] is, where the system is.
#[derive(Debug, Default)]
pub(super) struct PresentDamping {
    least: Option<LeastDamping>,
    last: Option<KnownDamping>,
}

/// A wind speed, m/s, and the smallest damping ratio there.
#[derive(Debug, Clone, Copy)]
struct KnownDamping {
    wind_m_s: f64,
    ratio: f64,
}

impl PresentDamping {
    /// The ratio of `section`, the same at every call, at a wind speed, m/s.
    ///
    /// # Errors
    /// Where the eigenvalues are not found.
    pub(super) fn at(&mut self, section: &CoupledSection, wind_m_s: f64) -> Result<f64> {
        if let Some(known) = self.last.filter(|known| known.wind_m_s == wind_m_s) {
            return Ok(known.ratio);
        }
        let least = self.least.get_or_insert_with(|| LeastDamping::new(section));
        let ratio = least.at(section, wind_m_s)?;
        self.last = Some(KnownDamping { wind_m_s, ratio });
        Ok(ratio)
    }
}
