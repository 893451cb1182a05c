//! From records and tables to models: regressors, fits, reports.

pub(crate) mod affine;
pub(crate) mod basis;
mod constrained;
mod degenerate;
pub mod derivatives;
pub(crate) mod discrete;
pub(crate) mod dissipative;
mod entry_report;
mod fit;
pub(crate) mod form;
mod frequency;
mod grid;
mod joint;
mod kept_record;
pub(crate) mod least_squares;
mod minimum_state;
pub(crate) mod options;
pub(crate) mod own;
pub(crate) mod records;
pub(crate) mod report;
pub(crate) mod samples;
mod search;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
pub(crate) mod time;

pub use discrete::{DiscreteFit, fit_discrete};
pub use dissipative::{
    ActiveConstraint, ConstraintCost, ConstraintKind, ConstraintReport, Constraints,
};
pub use entry_report::{Coefficient, EntryReport};
pub(crate) use fit::sources;
pub use fit::{FitOptions, fit};
pub use form::{FeedThrough, Form, LEAST_CHOSEN, MOST_CHOSEN, PoleSearch};
pub use frequency::fit_table;
pub use grid::{CellFit, Grid, GridAxis};
pub use kept_record::KeptRecord;
pub use options::{FrequencyFit, FrequencyWeights, QuasiSteadyLimit, TimeFit, TimeWeights};
pub use own::{OwnDecay, OwnFilters, StaticTerm};
pub use records::fit_records;
pub(crate) use report::CANCELLATION_LIMIT;
pub use report::{
    AlphaGuideline, FitReport, Fitted, MemoryReport, OrderReport, SearchPoint, SearchReport,
    StaticReport,
};
pub use samples::sample_model;
