//! A page of sections with tables and figures: the reports of a laboratory and of the thesis.

use super::page_head::{at_edges, capital, class, doubts, stated};
use super::vocabulary::Figure;
use crate::files::report_block::ReportBlock;
use crate::verdict::{Severity, Verdict};
use askama::Template;

/// The sections of a page of this `key`, as another page takes them up; `None` for other pages.
pub(crate) fn sections_of(page: &str, key: &str) -> Option<String> {
    let (_, own) = page.split_once(&format!("<!-- sections of {key} -->"))?;
    let (own, _) = own.split_once("<!-- end of sections -->")?;
    let mut parts = own.split("<h2 id=\"");
    let first = parts.next().unwrap_or_default().to_owned();
    let rest = parts.filter_map(|part| Some(part.split_once("\">")?.1));
    Some(rest.fold(first, |whole, part| whole + "<h2>" + part))
}

/// A page that loads nothing from elsewhere.
#[derive(Debug, Clone, PartialEq, Default, Template)]
#[template(path = "sections.html")]
pub(crate) struct SectionsPage {
    pub(crate) title: String,
    pub(crate) subtitle: String,
    /// What is required and whether it is met; empty where nothing is judged.
    pub(crate) verdict: Verdict,
    /// The answer, in one line.
    pub(crate) answer: String,
    pub(crate) of: ReportBlock,
    /// Fingerprint of what the page is of, where another page takes it up.
    pub(crate) key: String,
    pub(crate) sections: Vec<PageSection>,
}

/// Text, then a table, then figures; each may be empty.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct PageSection {
    pub(crate) title: String,
    pub(crate) text: Vec<String>,
    /// Heads of its columns, ` | ` between them.
    pub(crate) header: &'static str,
    pub(crate) rows: Vec<Vec<String>>,
    /// With their captions.
    pub(crate) figures: Vec<(String, Figure)>,
}

impl PageSection {
    /// One of a table alone.
    pub(crate) fn table(title: &str, header: &'static str, rows: Vec<Vec<String>>) -> Self {
        Self {
            title: title.to_owned(),
            header,
            rows,
            ..Self::default()
        }
    }
}

const GENERATOR: &str = concat!("aerodeck ", env!("CARGO_PKG_VERSION"));
