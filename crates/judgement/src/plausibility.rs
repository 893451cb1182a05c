//! Whether what is given looks like what it is said to be: sections, tables, modes, coefficients, records.
//!
//! A number beyond the limits of the field is not wrong, but most often it stands in another unit, axis or notation. Nothing is
//! refused or changed here: every oddity is a [`Finding`] with its place, its reason and what the number would be if it was meant
//! otherwise. Whoever gives an answer shows the findings of what the answer rests on; none of them may vanish on the way.

mod bridge;
mod coefficients;
mod limits;
mod model;
mod section;
mod table;

pub use bridge::{is_same_mode, of_bridge, of_modes, of_modes_left_out, of_profile, of_turbulence};
pub use coefficients::of_coefficients;
pub use limits::{
    DECK_WIDTH, Limits, MODEL_LENGTH, MODEL_WIDTH, MOTION_FREQUENCY, SAMPLING, WIND_SPEED, beyond,
    ratio_hint, significant,
};
pub use model::{of_model, of_trained};
pub use section::{WIDEST_MODEL_M, of_required_speed, of_section, unusual_air};
pub use table::of_table;

use serde::{Deserialize, Serialize};
use std::fmt;

/// Something given that is possible but implausible.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// Key, mode, run or column: `section.width_m`, `mode 3`.
    pub place: String,
    /// The number found there; `None` where several are meant.
    pub value: Option<f64>,
    /// What was probably mistaken.
    pub kind: FindingKind,
    /// How much it weighs.
    pub severity: FindingSeverity,
    /// Why it is odd.
    pub text: String,
    /// What it would be if it was meant otherwise: `in rad/s it would be 0.13 Hz`.
    pub otherwise: Option<String>,
}

/// What was probably mistaken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FindingKind {
    /// The unit of a number, or a factor as between semi-chord and width.
    Unit,
    /// Signs, notation or argument of a table.
    Convention,
    /// Directions of a finite-element model.
    Axes,
    /// The same thing given twice.
    Duplicate,
    /// Two statements that cannot both be true.
    Contradiction,
}

/// How much a finding weighs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FindingSeverity {
    /// Rare, or on the safe side: worth a look.
    Note,
    /// An answer that rests on it cannot be relied on before it is cleared.
    Doubt,
}

impl Finding {
    /// A doubt about what stands at `place`.
    pub fn doubt(kind: FindingKind, place: impl Into<String>, text: impl Into<String>) -> Self {
        Self {
            place: place.into(),
            value: None,
            kind,
            severity: FindingSeverity::Doubt,
            text: text.into(),
            otherwise: None,
        }
    }

    /// A doubt about the unit of a number.
    pub fn unit(place: impl Into<String>, value: f64, text: impl Into<String>) -> Self {
        Self::doubt(FindingKind::Unit, place, text).with_value(value)
    }

    /// The same of a number.
    #[must_use]
    pub fn with_value(mut self, value: f64) -> Self {
        self.value = Some(value);
        self
    }

    /// The same with what it would be otherwise.
    #[must_use]
    pub fn otherwise(mut self, meant: impl Into<Option<String>>) -> Self {
        self.otherwise = meant.into();
        self
    }

    /// The same as no more than a note.
    #[must_use]
    pub fn into_note(self) -> Self {
        self.into_note_if(true)
    }

    /// The same, where that is so no more than as a note.
    pub(crate) fn into_note_if(mut self, minor: bool) -> Self {
        if minor {
            self.severity = FindingSeverity::Note;
        }
        self
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.place)?;
        if let Some(value) = self.value {
            write!(f, " = {value}")?;
        }
        write!(f, ": {}", self.text)?;
        if let Some(otherwise) = &self.otherwise {
            write!(f, "; {otherwise}")?;
        }
        Ok(())
    }
}

/// The findings as sentences.
pub fn sentences(findings: &[Finding]) -> Vec<String> {
    findings.iter().map(ToString::to_string).collect()
}
