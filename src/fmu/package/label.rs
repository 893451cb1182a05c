//! What an archive says of its origin.

use crate::error::{Error, Result, ensure};
use chrono::{DateTime, SecondsFormat, Utc};

/// Names, rights and date in the description of an archive. None of it changes the model or its GUID.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Label {
    /// Name of the model to the importer; the trained model's own where it is left out.
    pub name: Option<String>,
    /// Who is responsible.
    pub author: Option<String>,
    /// Whose it is.
    pub copyright: Option<String>,
    /// When it was made, `YYYY-MM-DDThh:mm:ssZ`. Without, equal exports are equal byte for byte.
    pub generated: Option<String>,
}

/// Seconds since 1970 that stand for the present in reproducible builds (reproducible-builds.org).
const EPOCH_VARIABLE: &str = "SOURCE_DATE_EPOCH";

impl Label {
    /// The same with the present time, or with that which the variable `SOURCE_DATE_EPOCH` states.
    ///
    /// # Errors
    /// [`Error::Input`] where the variable holds no number of seconds, and for a blank name.
    pub fn dated(self) -> Result<Self> {
        let blank = self.name.as_deref().is_some_and(|n| n.trim().is_empty());
        ensure(!blank, "name", "a name of the model", "none")?;
        let stated = std::env::var(EPOCH_VARIABLE).ok();
        let time = stated.map(|text| epoch(&text)).transpose()?;
        let time = time.unwrap_or_else(Utc::now);
        Ok(Self {
            generated: Some(time.to_rfc3339_opts(SecondsFormat::Secs, true)),
            ..self
        })
    }
}

fn epoch(text: &str) -> Result<DateTime<Utc>> {
    let seconds = text.trim().parse().ok();
    let time = seconds.and_then(|seconds| DateTime::from_timestamp(seconds, 0));
    time.ok_or_else(|| Error::input(EPOCH_VARIABLE, "seconds since 1970", format!("`{text}`")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_epoch_is_read() {
        let time = |text| epoch(text).map(|t| t.to_rfc3339_opts(SecondsFormat::Secs, true));
        assert_eq!(time("1700000000").unwrap(), "2023-11-14T22:13:20Z");
        let message = time("yesterday").unwrap_err().to_string();
        assert_eq!(
            message,
            "SOURCE_DATE_EPOCH: expected seconds since 1970, found `yesterday`"
        );
    }

    #[test]
    fn a_date_is_one_of_the_standard() {
        let date = Label::default().dated().unwrap().generated.unwrap();
        assert!(
            date.len() == 20 && date.ends_with('Z') && date.contains('T'),
            "{date}"
        );
    }
}
