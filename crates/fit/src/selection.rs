//! How many filters, and with which pole or decay factor: a grid of fits, judged by data they have not seen.
//!
//! The thesis (section 3.5.3, Figures 3.18 and 3.19) reads three metrics of one record over a grid of `L` and `α`. More
//! filters always fit the same records better, so here the choice follows the error on what was left out: one mean speed
//! or one frequency of motion at a time. Models that only fit well by chance are refused: those that flutter where
//! nothing was tested, those whose terms cancel, and discrete ones whose closed loop is unstable. See [`Selection`].

mod cells;
mod folds;
mod guards;
mod metrics;

pub use cells::{Cell, Recommendation, Selection, select};
pub use folds::CrossValidation;
pub use metrics::{CellMetrics, MetricGrid, metric_grid};

#[cfg(test)]
mod tests;
