//! What the scatter of the data leaves open of the onset, as an archive carries it.

use crate::error::{Error, Result, ensure};
use crate::flutter::OnsetInterval;
use serde::{Deserialize, Serialize};

/// The file in `resources/`; an archive without it says nothing of the interval.
pub const BOUNDS_FILE: &str = "onset_interval.json";

/// 95 % interval of the onset speed of the section as it was exported.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OnsetBounds {
    /// Lower end, m/s.
    pub low_m_s: f64,
    /// Upper end, m/s.
    pub high_m_s: f64,
    /// Why the speed is no result, where the data leave it that far open.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub undetermined: Option<String>,
}

impl OnsetBounds {
    /// Those of an interval that is a statement of probability, also of one that leaves nearly everything open; `None` for any other.
    pub fn from_interval(interval: &OnsetInterval) -> Option<Self> {
        let error = interval.by_error()?;
        Some(Self {
            low_m_s: error.low_m_s.max(0.0),
            high_m_s: error.high_m_s,
            undetermined: interval.reason().map(str::to_owned),
        })
    }

    /// Reads and checks the file.
    ///
    /// # Errors
    /// [`Error::Input`] for text that is not such a file, and for ends that are no interval of speeds.
    pub fn from_json(text: &str) -> Result<Self> {
        let bounds: Self = serde_json::from_str(text)
            .map_err(|e| Error::json("an interval of the onset speed", &e))?;
        bounds.check()?;
        Ok(bounds)
    }

    /// Whether the ends are an interval of speeds.
    pub(super) fn check(&self) -> Result<()> {
        let Self {
            low_m_s, high_m_s, ..
        } = self;
        ensure(
            *low_m_s >= 0.0 && low_m_s <= high_m_s && high_m_s.is_finite(),
            "low_m_s, high_m_s",
            "0 <= low_m_s <= high_m_s",
            format_args!("{low_m_s}, {high_m_s}"),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_interval_is_refused() {
        let read = |low: &str, high: &str| {
            OnsetBounds::from_json(&format!("{{\"low_m_s\": {low}, \"high_m_s\": {high}}}"))
        };
        assert_eq!(read("36.5", "37").unwrap().high_m_s, 37.0);
        for (low, high) in [("38", "37"), ("-1", "37"), ("1", "1e999"), ("\"a\"", "1")] {
            assert!(read(low, high).is_err(), "{low}, {high}");
        }
    }
}
