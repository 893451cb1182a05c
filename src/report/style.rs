//! Colours, dashes and markers.

use crate::error::{Error, Result};
use crate::verdict::Outcome;

/// Text, axes, zero lines.
pub(super) const BLACK: &str = "#222222";
/// Samples in the legend that stand for a line style of any colour.
pub(super) const GREY: &str = "#666666";
pub(super) const GRID: &str = "#e4e4e4";
pub(super) const SHADE: &str = "#8c8c8c";
pub(super) const SHADE_OPACITY: f64 = 0.18;

/// Okabe and Ito's colours without yellow, which is too light for lines on white.
pub(super) const COLOURS: [&str; 7] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000",
];
/// The same two thirds of the way to white, for what is said with reservation.
const PALE_COLOURS: [&str; 7] = [
    "#a6cee4", "#f0c7a6", "#a6ddce", "#edd0e0", "#f6dda6", "#c4e5f7", "#a6a6a6",
];
/// The grey of the legend, as pale.
pub(super) const PALE_GREY: &str = "#c9c9c9";
const DASHES: [Option<&str>; 7] = [
    None,
    Some("7 3"),
    Some("2 3"),
    Some("8 3 2 3"),
    Some("12 4"),
    Some("12 3 2 3 2 3"),
    Some("4 6"),
];

/// Colour of the i-th model, table or series.
///
/// # Errors
/// [`Error::Input`] when more are wanted than can be told apart.
pub(super) fn colour(place: &str, i: usize) -> Result<&'static str> {
    COLOURS.get(i).copied().ok_or_else(|| {
        let expected = format!("at most {} to compare in one figure", COLOURS.len());
        Error::input(place, expected, format!("at least {}", i + 1))
    })
}

/// Colour of what is required, which never stands without the words of the outcome.
pub(super) fn outcome_colour(outcome: &Outcome) -> &'static str {
    match outcome {
        Outcome::Met => "#00694f",
        Outcome::NotMet { .. } => "#a33b00",
        Outcome::CannotBeJudged { .. } => "#7a5c00",
    }
}

/// The pale colour that goes with [`colour`].
pub(super) fn pale(of: &'static str) -> &'static str {
    let i = COLOURS.iter().position(|c| *c == of);
    i.map_or(PALE_GREY, |i| PALE_COLOURS[i])
}

/// Dash pattern of the i-th kind of line; they come round again.
pub(super) fn dash(i: usize) -> Option<&'static str> {
    DASHES[i % DASHES.len()]
}

/// Outline of a marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    Circle,
    Square,
    Diamond,
    Cross,
}

/// How something is drawn, in the panel and in the legend alike: a line through the points, or separate markers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ink {
    pub(super) colour: &'static str,
    /// Width of a line, radius of a marker, px.
    pub(super) size: f64,
    pub(super) dash: Option<&'static str>,
    /// Outline of the markers; `None` for a line.
    pub(super) shape: Option<Shape>,
    /// Of a marker that says "with reservation".
    pub(super) hollow: bool,
}

/// Width of the lines of the i-th branch, px.
pub(super) fn branch_width(i: usize) -> f64 {
    BRANCH_WIDTHS[i.min(BRANCH_WIDTHS.len() - 1)]
}
const BRANCH_WIDTHS: [f64; 3] = [1.1, 2.3, 3.4];

impl Ink {
    /// Line of the i-th model, table or series.
    ///
    /// # Errors
    /// As [`colour`].
    pub(super) fn nth(place: &str, i: usize) -> Result<Self> {
        Ok(Self::line(colour(place, i)?, dash(i)))
    }

    pub(super) fn line(colour: &'static str, dash: Option<&'static str>) -> Self {
        Self::stroke(colour, dash, 1.8)
    }

    /// A line without dashes.
    pub(super) const fn solid(colour: &'static str, width: f64) -> Self {
        Self::stroke(colour, None, width)
    }

    /// A line of a width of its own, px.
    pub(super) const fn stroke(
        colour: &'static str,
        dash: Option<&'static str>,
        width: f64,
    ) -> Self {
        Self {
            colour,
            size: width,
            dash,
            shape: None,
            hollow: false,
        }
    }

    pub(super) fn dots(colour: &'static str, shape: Shape) -> Self {
        Self {
            shape: Some(shape),
            ..Self::solid(colour, 3.2)
        }
    }
}
