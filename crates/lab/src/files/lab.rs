//! Laboratory files of any kind as one set of channels.
//!
//! | file | read by | names of channels |
//! |---|---|---|
//! | CSV (`.csv`, `.txt`, `.dat`, `.tsv`) | this crate | those of the header row, else `column[1]` … |
//! | MATLAB v5 to v7 (`.mat`) | `matrw` | `variable`, `struct.field`, `struct[2].field`, `cell{1}` |
//! | MATLAB v7.3 (`.mat`) | `hdf5-pure` | likewise (no cells) |
//! | HDF5 (`.h5`, `.hdf5`) | `hdf5-pure` | `group/dataset` |
//! | NI TDMS (`.tdms`) | this crate | `group/channel` |
//!
//! A matrix gives one channel per column, `name[3]`, counted from 1; time runs along its longer side. A single number
//! or text is an attribute, not a channel. With a group (of HDF5 or TDMS, or a MATLAB struct) only what is in it is
//! read, under names without the group.

mod channels;
mod csv_file;
mod guarded;
mod hdf5_file;
mod matlab5;
mod tdms;
mod tdms_bytes;

pub use channels::ChannelSet;
pub(crate) use channels::{Attribute, Channel};
pub(crate) use guarded::guarded;
pub(crate) use matlab5::matlab_array;

use crate::error::{Error, Result, ensure};
use std::path::Path;

/// Bytes of one file at most.
const BYTES_AT_MOST: u64 = 2 << 30;

impl ChannelSet {
    /// Reads a file of any known kind, or one `group` of it.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Input`] with the file for one that is truncated or corrupt, of an unknown kind, or
    /// without the group.
    pub fn read(path: impl AsRef<Path>, group: Option<&str>) -> Result<Self> {
        let path = path.as_ref();
        let about = std::fs::metadata(path).map_err(|e| Error::io(path, e))?;
        let length = about.len();
        let expected = format_args!("a file of at most {BYTES_AT_MOST} bytes");
        ensure(length <= BYTES_AT_MOST, "", expected, length).map_err(|e| e.in_file(path))?;
        let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
        let mut set =
            Self::parse(bytes, &extension.to_lowercase(), group).map_err(|e| e.in_file(path))?;
        set.find_sampling();
        Ok(set)
    }

    /// The kind is told by the first bytes; CSV, which has none of its own, by the end of the name.
    fn parse(bytes: Vec<u8>, extension: &str, group: Option<&str>) -> Result<Self> {
        let is_mat = extension == "mat";
        let any = !bytes.is_empty();
        ensure(any, "", "a file with samples", "an empty file")?;
        if hdf5_file::is_hdf5(&bytes) {
            hdf5_file::parse(bytes, group, if is_mat { "." } else { "/" })
        } else if bytes.starts_with(b"TDSm") {
            tdms::parse(&bytes, group)
        } else if is_mat {
            matlab5::parse(bytes, group)
        } else if ["csv", "txt", "dat", "tsv", "asc"].contains(&extension) {
            csv_file::parse(&bytes, group)
        } else {
            let expected = "a CSV (.csv, .txt, .dat, .tsv), MATLAB (.mat), HDF5 or TDMS file";
            Err(Error::input("", expected, "something else"))
        }
    }
}

#[cfg(test)]
mod tests;
