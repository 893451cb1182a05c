//! Points with a name, as they come from results that have no struct of their own.

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
    let mut names: Vec<String> = Vec::new();
    for name in all {
        if !names.contains(name) {
            names.push(name.clone());
        }
    }
    names
}

/// Place of a name among `names`; 0 for one that is not there.
pub(super) fn index_of(names: &[String], name: &str) -> usize {
    names.iter().position(|n| n == name).unwrap_or(0)
}
