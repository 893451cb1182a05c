//! The vocabulary of every command.

pub(super) use super::answer::Answer;
pub(super) use super::common::{
    StudyArgs, folder_of, in_input, motion_columns, speed_or, spelt, warn,
};
pub(super) use super::interrupt::Temporary;
pub(super) use super::output::{OutputDir, Written, list};
pub(super) use super::progress::Progress;
pub(super) use super::text_table::TextTable;
pub(super) use crate::error::{Error, Result, counted, ensure};
pub(super) use crate::files::text::{csv_cell, file_name, read_text};
pub(super) use crate::flutter::{FlutterSearch, OnsetMethod};
pub(super) use crate::fmu::package::{Export, Label, Runtime};
pub(super) use crate::plausibility::{Finding, sentences};
pub(super) use crate::report::{
    DerivativePlot, Figure, PageSection, PlottedSeries, SectionsPage, TimePanel, rendered,
    time_history_figure,
};
pub(super) use crate::section::Dof;
pub(super) use crate::selection::Recommendation;
pub(super) use crate::study::bridge::BridgeStudy;
pub(super) use crate::study::{FlutterStudy, Study, WindStudy, attempt, derivative_lines};
pub(super) use crate::trained_model::TrainedModel;
pub(super) use crate::verdict::Verdict;
