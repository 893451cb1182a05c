//! Points with a name, and the legend below the panels: rows of samples and names, never over a curve.

use super::font::text_width;
use super::scene::{Px, Scene};
use super::style::{BLACK, Ink};
use crate::error::Result;
use std::collections::HashSet;

const SIZE: u32 = 11;
const ROW: f64 = 18.0;
const SAMPLE: f64 = 30.0;
const GAP: f64 = 26.0;

/// Characters of a line of text beyond which a figure would be wider than a page.
const LONGEST: usize = 110;

/// A line without its middle where it is too long; pages and files have it whole.
pub(super) fn shortened(text: &str) -> String {
    let count = text.chars().count();
    if count <= LONGEST {
        return text.to_owned();
    }
    let first: String = text.chars().take(LONGEST / 2).collect();
    let last: String = text.chars().skip(count - LONGEST / 2).collect();
    // whole words, where there are some
    let first = first.rsplit_once(' ').map_or(&*first, |(words, _)| words);
    let last = last.split_once(' ').map_or(&*last, |(_, words)| words);
    format!("{first} … {last}")
}

/// A sample of ink and what it stands for.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entry {
    pub(super) label: String,
    pub(super) ink: Ink,
}

impl Entry {
    pub(super) fn new(label: impl Into<String>, ink: Ink) -> Self {
        Self {
            label: shortened(&label.into()),
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
    placed: Vec<(&'a Entry, Px)>,
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
        let room = |e: &Entry| SAMPLE + 8.0 + text_width(&e.label, f64::from(SIZE)) + GAP;
        let widths: Vec<f64> = group.iter().map(room).collect();
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
            self.placed.push((entry, Px::new(x, self.height)));
            x += width;
        }
        self.width = self.width.max(x - GAP);
        if !entries.is_empty() {
            self.height += ROW;
        }
    }
}

impl LegendLayout<'_> {
    /// Draws it with its upper left corner at `corner`.
    pub(super) fn draw(&self, scene: &mut Scene, corner: Px) {
        for (entry, place) in &self.placed {
            let middle = corner + *place + Px::new(0.0, 0.5 * ROW);
            match entry.ink.shape {
                None => scene.polyline(&[middle, middle + Px::new(SAMPLE, 0.0)], entry.ink),
                Some(_) => scene.marker(middle + Px::new(0.5 * SAMPLE, 0.0), entry.ink),
            }
            let baseline = Px::new(SAMPLE + 8.0, 0.36 * f64::from(SIZE));
            scene.text(middle + baseline, &entry.label, SIZE, BLACK);
        }
    }
}

/// A named row of points.
#[derive(Debug, Clone, PartialEq)]
pub struct PlottedSeries {
    /// Name in the legend.
    pub label: String,
    /// Abscissa and ordinate.
    pub points: Vec<(f64, f64)>,
}

impl PlottedSeries {
    /// `points` under a name.
    pub fn new(label: impl Into<String>, points: Vec<(f64, f64)>) -> Self {
        Self {
            label: label.into(),
            points,
        }
    }
}

/// The labels, each once, in the order of their first appearance.
pub(super) fn labels_of<'a>(series: impl IntoIterator<Item = &'a PlottedSeries>) -> Vec<String> {
    distinct(series.into_iter().map(|one| &one.label))
}

/// The names, each once, in the order of their first appearance.
pub(super) fn distinct<'a>(all: impl IntoIterator<Item = &'a String>) -> Vec<String> {
    let (all, mut known) = (all.into_iter(), HashSet::new());
    all.filter(|name| known.insert(*name)).cloned().collect()
}

/// Place of a name among `names`; 0 for one that is not there.
pub(super) fn index_of(names: &[String], name: &str) -> usize {
    names.iter().position(|n| n == name).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_line_keeps_both_ends() {
        let name = "a name ".repeat(40);
        let title = shortened(&format!("{name}: modes over wind speed"));
        assert!(title.starts_with("a name a name") && title.ends_with(": modes over wind speed"));
        assert!(
            title.chars().count() <= LONGEST + 3 && title.contains(" … "),
            "{title}"
        );
        let onset = format!(
            "Onset V = 59.00 m/s, {}quasi-steady, synthetic box girder",
            "V/(fB) = 8.083: ".repeat(6)
        );
        let words: Vec<&str> = onset.split(' ').collect();
        let short = shortened(&onset);
        assert!(
            short
                .split(' ')
                .all(|word| word == "…" || words.contains(&word)),
            "{short}"
        );
        assert_eq!(shortened("short"), "short");
    }
}
