//! The vocabulary of every command.

pub(super) use super::answer::Answer;
pub(super) use super::common::{
    StudyArgs, folder_of, in_input, motion_columns, speed_or, spelt, warn,
};
pub(super) use super::interrupt::Temporary;
pub(super) use super::output::{OutputDir, Written, list};
pub(super) use super::progress::Progress;
pub(super) use super::text_table::TextTable;
