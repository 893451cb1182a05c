//! The vocabulary of every figure.

pub(super) use super::axis::Axis;
pub(super) use super::drawing::Drawing;
pub(super) use super::legend::{Entry, PlottedSeries, distinct, entries, index_of, labels_of};
pub(super) use super::panel::{Note, Panel, Series};
pub(super) use super::scene::{Area, Figure, Px, Scene};
pub(super) use super::style::{
    BLACK, COLOURS, GREY, Ink, PALE_GREY, Shape, branch_width, colour, dash, outcome_colour,
};
