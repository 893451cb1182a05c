//! Plans of virtual campaigns as TOML files.

use super::plan::VirtualCampaignPlan;
use crate::error::{Error, Result};
use crate::files::toml_lines;
use std::path::Path;

impl VirtualCampaignPlan {
    /// Reads and checks a plan; what it does not state is as in [`VirtualCampaignPlan::default`].
    ///
    /// # Errors
    /// [`Error::Io`] when it cannot be read; [`Error::Input`] with file and line for everything that is wrong in it.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        toml_lines::read(path.as_ref(), |text, _| Self::from_toml(text))
    }

    /// Reads and checks the text of a plan.
    ///
    /// # Errors
    /// [`Error::Input`] with line and key for everything that is wrong in it.
    pub fn from_toml(text: &str) -> Result<Self> {
        toml_lines::parse("a plan of a virtual campaign", text, |plan: &mut Self| {
            plan.validate()
        })
    }

    /// The plan as the text of a file.
    ///
    /// # Errors
    /// [`Error::Numerical`] when it cannot be written as TOML.
    pub fn to_toml(&self) -> Result<String> {
        toml::to_string(self).map_err(|e| Error::Numerical(e.to_string()))
    }
}
