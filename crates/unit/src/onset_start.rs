//! An onset that has been searched for, as a start for those of parameters nearby.

use crate::aeroelastic::CoupledSection;
use crate::error::{Result, finite, positive};
use crate::flutter::{FlutterSearch, Onset, OnsetSearch, find_onset, smallest_damping};
use crate::units::ReducedFrequencyRange;
use serde::{Deserialize, Serialize};

/// Speeds below the onset, as parts of it, at which the damping of all modes is compared with that of the search.
pub(super) const COMPARED_AT: [f64; 2] = [0.6, 0.85];

/// The onset of what is simulated: that of [`find_onset`] in the `tested` range. A section that grows already where it enters that
/// range does so from where the model itself says, tested or not.
///
/// # Errors
/// As [`find_onset`].
pub fn simulated_onset(
    model: &str,
    section: &CoupledSection,
    search: &OnsetSearch,
    tested: Option<ReducedFrequencyRange>,
) -> Result<FlutterSearch> {
    let found = find_onset(model, section, search, tested)?;
    let FlutterSearch::UnstableAtOrBelow(start) = &found else {
        return Ok(found);
    };
    let mut own = find_onset(model, section, search, None)?;
    if let FlutterSearch::Onset(onset) = &mut own {
        onset.in_tested_range = Some(false);
        onset.warnings.push(format!(
            "the onset of this model lies outside the tested range: {}",
            start.explain()
        ));
    }
    Ok(own)
}

/// A point next to the onset from which its search can start: wind speed, frequency, and the damping of all modes below it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OnsetStart {
    /// Wind speed, m/s.
    pub speed_m_s: f64,
    /// Frequency of the motion there, Hz.
    pub frequency_hz: f64,
    /// Smallest damping ratio of all modes at 0.6 and 0.85 of the speed.
    pub damping_below: [f64; 2],
}

impl OnsetStart {
    /// That of an onset of `section` of which there is nothing more to say; `None` where there is: it has to be searched for each
    /// time.
    pub fn from_onset(onset: &Onset, section: &CoupledSection) -> Option<Self> {
        let plain = onset.warnings.is_empty() && onset.spurious_speeds_m_s.is_empty();
        let (speed, hertz) = (onset.at.speed_m_s, onset.at.frequency_hz);
        Self::at(speed, hertz, section).ok().filter(|_| plain)
    }

    /// The start at a speed, m/s, and a frequency, Hz.
    pub(super) fn at(speed_m_s: f64, frequency_hz: f64, section: &CoupledSection) -> Result<Self> {
        let below = |part: f64| smallest_damping(section, part * speed_m_s);
        Ok(Self {
            speed_m_s,
            frequency_hz,
            damping_below: [below(COMPARED_AT[0])?, below(COMPARED_AT[1])?],
        })
    }

    pub(super) fn check(&self) -> Result<()> {
        positive("speed_m_s", self.speed_m_s)?;
        positive("frequency_hz", self.frequency_hz)?;
        let mut damping = self.damping_below.into_iter();
        damping.try_for_each(|d| finite("damping_below", d).map(drop))
    }
}
