//! What is special about the rational forms: lags of each force, minimum state.

use super::options::Form;
use crate::error::{Error, Result};

impl Form {
    /// Whether every force has poles of its own.
    pub fn poles_per_force(&self) -> bool {
        matches!(self, Self::RationalPerForce { .. })
    }

    /// A rational form in words.
    pub(super) fn describe_rational(&self) -> String {
        let (kind, whose) = match self {
            Self::RationalPerForce { .. } => ("rational functions", " of each force"),
            Self::MinimumState { .. } => ("minimum-state rational functions", ""),
            _ => ("rational functions", ""),
        };
        let count = self.filters();
        let plural = if count == 1 { "" } else { "s" };
        let with = if self.feed_through().e2 {
            "with"
        } else {
            "without"
        };
        format!("{kind}, {count} lag{plural}{whose}, {with} added mass")
    }

    /// Checks the form for a fit to records.
    ///
    /// # Errors
    /// [`Error::Input`] for forms that are fitted to tables only, and those of every form.
    pub(super) fn validate_for_records(&self) -> Result<()> {
        if matches!(
            self,
            Self::RationalPerForce { .. } | Self::MinimumState { .. }
        ) {
            return Err(Error::input(
                "form.kind",
                "laguerre, takenaka_malmquist or rational for a fit to records",
                format!("{}, which is fitted to tables", self.describe()),
            ));
        }
        self.validate()
    }
}
