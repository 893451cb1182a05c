//! File formats: derivatives, static coefficients, gusts, and TOML files whose complaints name their line.
//!
//! Each format reads and writes value types of the rooms below, which know nothing of files.

pub mod coefficients;
pub mod derivatives;
pub mod gusts;
pub(crate) mod header_csv;
pub(crate) mod toml_lines;
