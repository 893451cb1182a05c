//! File formats: bridges, derivatives, static coefficients, gusts, the files of laboratories, and TOML whose complaints name their line.
//!
//! Each format reads and writes value types of the rooms below, which know nothing of files.

pub mod bridge;
pub mod coefficients;
pub mod derivatives;
pub mod gusts;
pub(crate) mod header_csv;
pub mod lab;
pub mod report_block;
pub mod text;
pub mod toml_lines;
