//! Notation, argument and axes together, and what somebody has said about them.

use super::Notation;
use crate::aerodynamics::derivatives::Derivative;
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::units::{ReducedFrequency, ReducedVelocity};
use serde::{Deserialize, Serialize};
use std::fmt;

/// All that has to be known to read or write a number. The default is the convention of the crate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Convention {
    /// Definition and scaling.
    pub notation: Notation,
    /// What is tabulated over.
    pub argument: Argument,
    /// Direction of heave and lift.
    pub axes: Axes,
}

impl Convention {
    /// The notation with the axes and the argument it is usually printed with.
    pub fn usual(notation: Notation) -> Self {
        let (argument, axes) = match notation {
            Notation::Scanlan => (Argument::VHat, Axes::HeaveUp),
            Notation::Polimi => (Argument::VStar, Axes::HeaveUp),
            Notation::Simiu | Notation::Classical => (Argument::VStar, Axes::HeaveDown),
            Notation::Starossek => (Argument::KSemi, Axes::HeaveDown),
        };
        Self {
            notation,
            argument,
            axes,
        }
    }

    /// Value in this convention over the value in the crate's.
    pub fn factor(&self, derivative: Derivative, k: ReducedFrequency) -> f64 {
        self.axes.sign(derivative) * self.notation.factor(derivative, k)
    }

    /// Symbol of a number for people: `H1*`, `h1*`, `c″_hh`.
    pub fn symbol(&self, derivative: Derivative) -> String {
        super::symbol(self.notation, derivative)
    }
}

impl fmt::Display for Convention {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}, over {}, {}",
            self.notation.title(),
            self.argument.definition(),
            self.axes.words()
        )
    }
}

/// What a file or its user says about the convention: nothing, some of it, or all.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StatedConvention {
    /// Definition and scaling.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub notation: Option<Notation>,
    /// What is tabulated over.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub argument: Option<Argument>,
    /// Direction of heave and lift.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axes: Option<Axes>,
}

impl StatedConvention {
    /// Only the notation.
    pub fn notation(notation: Notation) -> Self {
        Self {
            notation: Some(notation),
            ..Self::default()
        }
    }

    /// Whether nothing is stated.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// For writing: what is not stated is as usual for the notation, the notation itself as in the crate.
    pub fn or_usual(self) -> Convention {
        let usual = Convention::usual(self.notation.unwrap_or_default());
        Convention {
            argument: self.argument.unwrap_or(usual.argument),
            axes: self.axes.unwrap_or(usual.axes),
            ..usual
        }
    }

    /// For reading: `self` is what the user says, `file` what the file says; neither may contradict the other. Axes that
    /// nobody states are those usual for the notation.
    ///
    /// # Errors
    /// [`Error::Input`] for a contradiction, and for a notation or an argument that nobody states.
    pub fn with_file(self, file: Self) -> Result<Convention> {
        let both = self.and_file(file)?;
        let unstated = |what: &str, choices: String| {
            let expected = format!("it stated in the file or on import, one of {choices}");
            Err(Error::input(what, expected, "neither"))
        };
        match (both.notation, both.argument) {
            (None, _) => unstated("notation", Notation::words()),
            (_, None) => unstated("argument", Argument::ALL.map(Argument::name).join(", ")),
            _ => Ok(both.or_usual()),
        }
    }

    /// What either states, of which neither may contradict the other.
    ///
    /// # Errors
    /// [`Error::Input`] for a contradiction.
    pub fn and_file(self, file: Self) -> Result<Self> {
        Ok(Self {
            notation: agree("notation", self.notation, file.notation)?,
            argument: agree("argument", self.argument, file.argument)?,
            axes: agree("axes", self.axes, file.axes)?,
        })
    }
}

impl From<Convention> for StatedConvention {
    fn from(all: Convention) -> Self {
        Self {
            notation: Some(all.notation),
            argument: Some(all.argument),
            axes: Some(all.axes),
        }
    }
}

fn agree<T: PartialEq + fmt::Display>(
    what: &str,
    user: Option<T>,
    file: Option<T>,
) -> Result<Option<T>> {
    match (user, file) {
        (Some(user), Some(file)) if user != file => Err(Error::input(
            what,
            format!("`{user}` as stated on import"),
            format!("`{file}` stated in the file"),
        )),
        (user, file) => Ok(user.or(file)),
    }
}

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

/// Reduced velocity or reduced frequency of a test point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Argument {
    /// `V̂ = V/(ωB)`, as in the NTNU workbooks. The crate's own.
    #[default]
    VHat,
    /// `V* = V/(fB)`.
    VStar,
    /// `K = ωB/V`, full width.
    KFull,
    /// `k = ωb/V`, semi-chord `b = B/2`.
    KSemi,
}

impl Argument {
    /// All arguments.
    pub const ALL: [Self; 4] = [Self::VHat, Self::VStar, Self::KFull, Self::KSemi];

    /// The word for it in commands and studies, and the name of its column.
    pub fn name(self) -> &'static str {
        match self {
            Self::VHat => "v_hat",
            Self::VStar => "v_star",
            Self::KFull => "k_full",
            Self::KSemi => "k_semi",
        }
    }

    /// Name with definition, as it stands in the header of files.
    pub fn definition(self) -> &'static str {
        match self {
            Self::VHat => "v_hat = V/(omega B)",
            Self::VStar => "v_star = V/(f B)",
            Self::KFull => "k_full = omega B/V",
            Self::KSemi => "k_semi = omega b/V, b = B/2",
        }
    }

    /// Its value where the reduced velocity is `V̂`; `V̂` itself is kept bit for bit.
    pub fn at_v_hat(self, v_hat: f64) -> f64 {
        let k = ReducedFrequency::from_v_hat(v_hat);
        match self {
            Self::VHat => v_hat,
            Self::VStar => ReducedVelocity::from(k).v_star(),
            Self::KFull => k.full_width(),
            Self::KSemi => k.semi_chord(),
        }
    }

    /// The reduced velocity `V̂` at which it has this value.
    pub fn to_v_hat(self, value: f64) -> f64 {
        match self {
            Self::VHat => value,
            Self::VStar => ReducedFrequency::from(ReducedVelocity::new(value)).v_hat(),
            Self::KFull => ReducedFrequency::from_full_width(value).v_hat(),
            Self::KSemi => ReducedFrequency::from_semi_chord(value).v_hat(),
        }
    }
}

read_by_name!(
    /// Reads the word, alone or with its definition.
    Argument,
    "argument",
    |text: &str| Self::ALL.into_iter().find(|a| a.name() == text || a.definition() == text),
    format!("one of {}", Self::ALL.map(Self::definition).join("; "))
);
