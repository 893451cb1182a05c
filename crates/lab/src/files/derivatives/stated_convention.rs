//! What somebody has said about notation, argument and axes of a table, and about the angle of its tests.

use crate::aerodynamics::derivatives::TableHeader;
use crate::aerodynamics::derivatives::notation::{Argument, Axes, Convention, Notation};
use crate::error::{Error, Result, ensure};
use serde::{Deserialize, Serialize};
use std::fmt;

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

/// Takes the mean angle of the tests that stands under `key`, deg, where the table does not state it itself.
///
/// # Errors
/// [`Error::Input`] for an angle beyond a right angle, and for another than the table states.
pub fn state_angle(header: &mut TableHeader, key: &str, angle_deg: Option<f64>) -> Result<()> {
    let Some(stated) = angle_deg else {
        return Ok(());
    };
    ensure(
        !stated.is_nan() && stated.abs() <= 90.0,
        key,
        "an angle between -90 and 90 degrees",
        stated,
    )?;
    match header.angle_deg.filter(|own| *own != stated) {
        Some(own) => {
            let expected = format!("{own}, which the table states");
            Err(Error::input(key, expected, stated.to_string()))
        }
        None => {
            header.angle_deg = angle_deg;
            Ok(())
        }
    }
}
