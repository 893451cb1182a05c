//! Whose report it is: the block `[report]` of a study and of a bridge file.

use serde::{Deserialize, Serialize};

/// What stands at the edges of every printed page.
///
/// ```
/// use aerodeck_lab::files::report_block::ReportBlock;
///
/// let of: ReportBlock = toml::from_str("project = \"Strait crossing\"\nrevision = \"B\"")?;
/// assert_eq!(of.revision.as_deref(), Some("B"));
/// # Ok::<(), toml::de::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ReportBlock {
    /// What the analysis is for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub project: Option<String>,
    /// Who answers for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub author: Option<String>,
    /// Revision of the document.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub revision: Option<String>,
    /// Date of the document as it is to be printed; left out, the day of the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub date: Option<String>,
}

impl ReportBlock {
    /// Whether nothing is stated.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The same, of a day where it states none.
    #[must_use]
    pub fn dated(&self, day: Option<&str>) -> Self {
        let day = self.date.clone().or(day.map(str::to_owned));
        Self {
            date: day,
            ..self.clone()
        }
    }
}
