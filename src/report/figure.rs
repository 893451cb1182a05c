//! A finished figure: SVG text and files.

use crate::error::{Error, Result};
use std::path::{Path, PathBuf};

/// A drawing as SVG text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    svg: String,
}

impl Figure {
    pub(super) fn from_svg(svg: String) -> Self {
        Self { svg }
    }

    /// The SVG text: one `svg` element with a `viewBox`, ready to stand in a page; its identifiers are its own, so that
    /// several figures in one page do not disturb each other.
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// Writes `stem.svg` into the existing directory `dir`; returns its path.
    ///
    /// # Errors
    /// [`Error::Io`] naming the file.
    pub fn write(&self, dir: impl AsRef<Path>, stem: &str) -> Result<PathBuf> {
        let path = dir.as_ref().join(format!("{stem}.svg"));
        std::fs::write(&path, &self.svg).map_err(|e| Error::io(&path, e))?;
        Ok(path)
    }
}
