//! The wind along the span in a bridge file.

use crate::bridge::MOST_WIND_FACTOR;
use crate::error::{Result, ensure, finite, non_negative};
use serde::{Deserialize, Serialize};

/// Wind along the span.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WindBlock {
    /// Wind speed at places along the girder over the wind speed of the bridge, linear between; left out, 1 everywhere.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub profile: Vec<ProfilePoint>,
}

/// A point of the wind profile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProfilePoint {
    /// Place along the girder, m.
    pub along_m: f64,
    /// Wind speed there over that of the bridge.
    pub factor: f64,
}

impl WindBlock {
    /// The factor at a place along the girder.
    pub fn factor(&self, along_m: f64) -> f64 {
        let points = &self.profile;
        let after = points.partition_point(|p| p.along_m <= along_m);
        match (after.checked_sub(1).map(|i| points[i]), points.get(after)) {
            (Some(a), Some(b)) => {
                a.factor + (b.factor - a.factor) * (along_m - a.along_m) / (b.along_m - a.along_m)
            }
            (Some(end), None) => end.factor,
            (None, Some(end)) => end.factor,
            (None, None) => 1.0,
        }
    }

    /// Checks the profile.
    pub(super) fn validate(&self) -> Result<()> {
        let points = &self.profile;
        for (i, point) in points.iter().enumerate() {
            let place = format!("wind.profile[{i}]");
            finite(format!("{place}.along_m"), point.along_m)?;
            non_negative(format!("{place}.factor"), point.factor)?;
            let expected = format_args!(
                "at most {MOST_WIND_FACTOR} times the wind speed of the bridge (a factor, not per cent)"
            );
            let (fits, key) = (point.factor <= MOST_WIND_FACTOR, format!("{place}.factor"));
            ensure(fits, key, expected, point.factor)?;
            if let Some(before) = points[..i].last() {
                let expected = format_args!("a place beyond {} m", before.along_m);
                let rises = point.along_m > before.along_m;
                ensure(rises, place, expected, point.along_m)?;
            }
        }
        let blows = points.is_empty() || points.iter().any(|p| p.factor != 0.0);
        let expected = "wind somewhere along the bridge";
        ensure(blows, "wind.profile", expected, "zero everywhere")
    }
}
