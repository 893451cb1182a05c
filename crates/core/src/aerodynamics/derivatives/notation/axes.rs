//! Which way heave and lift point.

use crate::aerodynamics::derivatives::Derivative;
use crate::section::Dof;
use serde::{Deserialize, Serialize};

/// Which way heave and lift point. Rotation and moment are nose-up (windward edge up), sway and drag downwind in both.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Axes {
    /// Heave and lift positive up. The crate's own.
    #[default]
    HeaveUp,
    /// Heave `h` and lift positive down.
    HeaveDown,
}

impl Axes {
    /// Both.
    pub const ALL: [Self; 2] = [Self::HeaveUp, Self::HeaveDown];

    /// The word for it in commands and studies.
    pub fn name(self) -> &'static str {
        match self {
            Self::HeaveUp => "heave_up",
            Self::HeaveDown => "heave_down",
        }
    }

    /// The axes in words, as in the header of files.
    pub fn words(self) -> &'static str {
        match self {
            Self::HeaveUp => {
                "heave and lift up, rotation and moment nose-up, sway and drag downwind"
            }
            Self::HeaveDown => {
                "heave and lift down, rotation and moment nose-up, sway and drag downwind"
            }
        }
    }

    /// −1 for a derivative that changes its sign when heave and lift are turned round: those that couple heave or lift
    /// with something else.
    pub fn sign(self, derivative: Derivative) -> f64 {
        let couples =
            (derivative.force() == Dof::Vertical) != (derivative.motion() == Dof::Vertical);
        if self == Self::HeaveDown && couples {
            -1.0
        } else {
            1.0
        }
    }
}

read_by_name!(
    /// Reads the word, or the axes in words.
    Axes,
    "axes",
    |text: &str| Self::ALL.into_iter().find(|a| a.name() == text || a.words() == text),
    "heave_up or heave_down"
);
