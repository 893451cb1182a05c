//! Parts of a bridge in whose forces no test stands behind, and the doubt that they leave.

use super::doubt::{Doubt, DoubtKind, Severity};
use super::evidence::FlutterReading;
use super::words::speed;
use serde::{Deserialize, Serialize};

/// Share of a bridge in the wind from which on forces without a test bear on its onset wherever they act: at mid-span 4 % of
/// Langenuen move it by 2.2 m/s, half a 95 % interval and more, at its ends by 0.1.
const BEARS: f64 = 0.05;
/// What other forces may move the onset by before it counts, relative to the onset.
const MOVES_AT_MOST: f64 = 0.01;

/// A part of the girder that was not tested.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UntestedPart {
    /// Which, in words.
    pub part: String,
    /// What its forces are made from, in words.
    pub forces: String,
    /// Its part of what the wind does to all modes, 0 to 1.
    pub share: f64,
}

/// All of them, and what the onset by the models is with other forces there; `None` where there is none in the range searched.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UntestedParts {
    /// The parts.
    pub parts: Vec<UntestedPart>,
    /// With the forces as they are, m/s.
    pub as_it_is_m_s: Option<f64>,
    /// The tested section with the largest share.
    pub tested: String,
    /// With its forces on these parts as well, m/s.
    pub as_tested_m_s: Option<f64>,
    /// With no forces on them, m/s.
    pub in_still_air_m_s: Option<f64>,
}

impl UntestedParts {
    /// The doubt; `clears` tells whether a speed is known to lie above what is required.
    pub(super) fn doubt(&self, first: &FlutterReading, clears: impl Fn(f64) -> bool) -> Doubt {
        let (low, high) = first
            .ends_m_s()
            .or(self.as_it_is_m_s.map(|v| (v, v)))
            .unwrap_or((0.0, 0.0));
        let bears = |other: Option<f64>| match (self.as_it_is_m_s, other) {
            (None, None) => false,
            (None, Some(other)) => !clears(other),
            (Some(_), None) => true,
            (Some(own), Some(other)) => {
                let moved = (other - own).abs();
                // a 95 % interval is four standard errors wide
                let allowed = (MOVES_AT_MOST * own).max(0.25 * (high - low));
                moved > allowed && !clears(low - moved)
            }
        };
        let share: f64 = self.parts.iter().map(|p| p.share).sum();
        let grave = share >= BEARS || bears(self.as_tested_m_s) || bears(self.in_still_air_m_s);
        let severity = match grave {
            true => Severity::Severe,
            false => Severity::Minor,
        };
        let part = |p: &UntestedPart| {
            format!(
                "{} ({:.0} % of what the wind does to the modes) are {}",
                p.part,
                100.0 * p.share,
                p.forces
            )
        };
        let parts: Vec<String> = self.parts.iter().map(part).collect();
        let at = |v: Option<f64>| v.map_or("nowhere".to_owned(), |v| format!("at {}", speed(v)));
        let text = format!(
            "The forces of {}, which no test of this deck confirms; the onset by the models is {}, with the forces of section {} there \
             {}, with none {}",
            parts.join(", those of "),
            at(self.as_it_is_m_s),
            self.tested,
            at(self.as_tested_m_s),
            at(self.in_still_air_m_s)
        );
        let names: Vec<&str> = self.parts.iter().map(|p| p.part.as_str()).collect();
        Doubt::new(severity, DoubtKind::Untested, text)
            .settled_by(format!("measured derivatives of {}", names.join(", ")))
    }
}
