//! From records and tables to models: regressors, fits, reports.

mod basis;
mod frequency;
mod least_squares;
mod options;
mod report;
mod samples;
mod search;
#[cfg(test)]
mod testing;

pub use frequency::fit_table;
pub use least_squares::{Factor, StreamingQr};
pub use options::{
    DiscreteFit, FeedThrough, Form, FrequencyFit, FrequencyWeights, PoleSearch, TimeFit,
    TimeWeights,
};
pub use report::{
    AlphaGuideline, CANCELLATION_LIMIT, CONDITION_LIMIT, Coefficient, EntryReport, FitReport,
    OrderReport, SearchPoint, SearchReport,
};
pub use samples::sample_model;
