//! From records and tables to models: regressors, fits, reports.

mod basis;
#[cfg(test)]
mod broadband_tests;
mod constrained;
#[cfg(test)]
mod deck_tests;
mod degenerate;
pub mod derivatives;
mod descent;
mod discrete;
mod dissipative;
mod frequency;
mod frequency_options;
mod grid;
mod least_squares;
mod minimum_state;
mod options;
mod own;
mod rational_forms;
mod records;
mod report;
mod samples;
mod search;
#[cfg(test)]
mod testing;
mod time;
#[cfg(test)]
mod training_tests;
mod uncertainty;

pub use discrete::{DiscreteFit, fit_discrete};
pub use dissipative::{
    ActiveConstraint, ConstraintCost, ConstraintKind, ConstraintReport, Constraints, OnsetEffect,
};
pub use frequency::fit_table;
pub use frequency_options::{FrequencyFit, FrequencyWeights, QuasiSteadyLimit};
pub use grid::{CellFit, Grid, GridAxis, StretchLabel};
pub use least_squares::{Factor, StreamingQr};
pub use options::{FeedThrough, Form, PoleSearch, TimeFit, TimeWeights};
pub use own::{OwnDecay, OwnFilters, StaticTerm};
pub use records::fit_records;
pub use report::{
    AlphaGuideline, CANCELLATION_LIMIT, CONDITION_LIMIT, Coefficient, EntryReport, FitReport,
    MemoryReport, OrderReport, SearchPoint, SearchReport, StaticReport,
};
pub use samples::sample_model;
pub use time::pass::{OnProgress, Progress};
pub use uncertainty::{
    CoefficientUncertainty, Coordinates, ForceScatter, LinearModel, Parameter, SEARCHED_POLES,
    SearchedPole, SpeedScatter, discrete_uncertainty, record_uncertainty, table_uncertainty,
    two_sided_quantile,
};
