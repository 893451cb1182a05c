//! A page of sections with tables and figures: the reports of a laboratory and of the thesis.

use crate::error::{Error, Result};
use askama::Template;

/// A page that loads nothing from elsewhere.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct SectionsPage {
    pub(crate) title: String,
    pub(crate) subtitle: String,
    /// The answer, in one line.
    pub(crate) answer: String,
    pub(crate) sections: Vec<PageSection>,
}

/// Text, then a table, then figures; each may be empty.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct PageSection {
    pub(crate) title: String,
    pub(crate) text: Vec<String>,
    pub(crate) header: Vec<&'static str>,
    pub(crate) rows: Vec<Vec<String>>,
    /// Caption and SVG.
    pub(crate) figures: Vec<(String, String)>,
}

#[derive(Template)]
#[template(path = "sections.html")]
struct SectionsTemplate<'a> {
    page: &'a SectionsPage,
    generator: &'static str,
}

/// The page as HTML text; the same content always gives the same bytes.
pub(crate) fn sections_page(page: &SectionsPage) -> Result<String> {
    let generator = concat!("aerodeck ", env!("CARGO_PKG_VERSION"));
    SectionsTemplate { page, generator }
        .render()
        .map_err(|e| Error::Numerical(format!("report: {e}")))
}
