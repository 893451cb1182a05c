//! The legend below the panels: rows of samples and names, never over a curve.

use super::font::text_width;
use super::style::{BLACK, Ink, draw_marker};
use super::text::text;
use crate::error::Result;
use kuva::render::color::Color;
use kuva::render::render::{Primitive, Scene};

const SIZE: u32 = 11;
const ROW: f64 = 18.0;
const SAMPLE: f64 = 30.0;
const GAP: f64 = 26.0;

/// A sample of ink and what it stands for.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entry {
    pub(super) label: String,
    pub(super) ink: Ink,
}

impl Entry {
    pub(super) fn new(label: impl Into<String>, ink: Ink) -> Self {
        Self {
            label: label.into(),
            ink,
        }
    }
}

/// An entry for each label, in the ink of its place.
pub(super) fn entries(labels: &[String], ink: impl Fn(usize) -> Result<Ink>) -> Result<Vec<Entry>> {
    let labels = labels.iter().enumerate();
    labels
        .map(|(i, label)| Ok(Entry::new(label, ink(i)?)))
        .collect()
}

/// The entries with their places relative to the upper left corner.
#[derive(Debug)]
pub(super) struct LegendLayout<'a> {
    placed: Vec<(&'a Entry, f64, f64)>,
    pub(super) width: f64,
    pub(super) height: f64,
}

/// Every group starts a new row; one that does not fit into a row of `width` is set in columns of equal width, as many
/// as fit, at least one.
pub(super) fn lay_out(groups: &[Vec<Entry>], width: f64) -> LegendLayout<'_> {
    let mut legend = LegendLayout {
        placed: Vec::new(),
        width: 0.0,
        height: 0.0,
    };
    for group in groups {
        let widths: Vec<f64> = group
            .iter()
            .map(|e| SAMPLE + 8.0 + text_width(&e.label, f64::from(SIZE)) + GAP)
            .collect();
        if widths.iter().sum::<f64>() <= width + GAP {
            legend.add_row(group, &widths);
        } else {
            let cell = widths.iter().copied().fold(0.0, f64::max);
            let columns = (((width + GAP) / cell).floor() as usize).max(1);
            for row in group.chunks(columns) {
                legend.add_row(row, &vec![cell; row.len()]);
            }
        }
    }
    legend
}

impl<'a> LegendLayout<'a> {
    fn add_row(&mut self, entries: &'a [Entry], widths: &[f64]) {
        let mut x = 0.0;
        for (entry, width) in entries.iter().zip(widths) {
            self.placed.push((entry, x, self.height));
            x += width;
        }
        self.width = self.width.max(x - GAP);
        if !entries.is_empty() {
            self.height += ROW;
        }
    }
}

impl LegendLayout<'_> {
    pub(super) fn draw(&self, scene: &mut Scene, (left, top): (f64, f64)) {
        for (entry, x, y) in &self.placed {
            let (x, y) = (left + x, top + y + 0.5 * ROW);
            draw_sample(scene, (x, y), entry.ink);
            scene.add(text(
                (x + SAMPLE + 8.0, y + 0.36 * f64::from(SIZE)),
                &entry.label,
                SIZE,
                BLACK,
            ));
        }
    }
}

fn draw_sample(scene: &mut Scene, (x, y): (f64, f64), ink: Ink) {
    match ink {
        Ink::Line {
            colour,
            dash,
            width,
        } => scene.add(Primitive::Line {
            x1: x,
            y1: y,
            x2: x + SAMPLE,
            y2: y,
            stroke: Color::from(colour),
            stroke_width: width,
            stroke_dasharray: dash.map(str::to_owned),
        }),
        Ink::Dots {
            colour,
            shape,
            radius,
            hollow,
        } => draw_marker(
            scene,
            (x + 0.5 * SAMPLE, y),
            (colour, shape, radius, hollow),
        ),
    }
}
