//! Notation, argument and axes together.

use super::{Argument, Axes, Notation};
use crate::aerodynamics::derivatives::Derivative;
use crate::units::ReducedFrequency;
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
