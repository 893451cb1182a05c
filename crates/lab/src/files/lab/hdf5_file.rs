//! HDF5, and MATLAB v7.3, which is HDF5 with MATLAB's dimensions reversed, by `hdf5-pure`.

use super::channels::{Attribute, ChannelSet, check_count, no_group};
use super::guarded;
use crate::error::{Error, Result};
use hdf5_pure::{AttrValue, DType, Dataset, File, FormatError, Group};
use std::collections::HashMap;

/// First bytes; a user block of 512 bytes or a multiple by a power of two may stand before them.
const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";
/// Deflate packs at most this many bytes into one.
const PACKED_AT_MOST: u64 = 1032;
/// Groups within groups within groups.
const DEPTH_AT_MOST: usize = 8;
/// Bytes of an entry of a symbol table: name, address, kind, and 20 that do not matter here.
const ENTRY: usize = 40;
/// Where MATLAB keeps what its cells point to.
const REFERENCES: &str = "#refs#";

/// Whether the bytes are an HDF5 file.
pub(super) fn is_hdf5(bytes: &[u8]) -> bool {
    let blocks = std::iter::once(0).chain((9..20).map(|power| 1_usize << power));
    blocks
        .map_while(|at| bytes.get(at..))
        .any(|rest| rest.starts_with(SIGNATURE))
}

/// Reads the bytes of a file; `separator` stands between the names of groups and datasets.
///
/// # Errors
/// [`Error::Input`] for a file that is truncated or corrupt, or lacks the `group`.
pub(super) fn parse(bytes: Vec<u8>, group: Option<&str>, separator: &str) -> Result<ChannelSet> {
    guarded(|| read(bytes, group, separator)).unwrap_or_else(|| Err(corrupt("", "a part")))
}

fn corrupt(place: &str, found: impl std::fmt::Display) -> Error {
    Error::input(
        place,
        "an HDF5 file that is neither truncated nor corrupt, nor newer than this reader (`libver=\"v110\"` may help)",
        format!("one that cannot be read ({found})"),
    )
}

/// Whether the object is intact, but of a kind that `hdf5-pure` does not know.
fn is_unknown(error: &hdf5_pure::Error) -> bool {
    use FormatError as F;
    let hdf5_pure::Error::Format(error) = error else {
        return false;
    };
    matches!(
        error,
        F::UnsupportedVirtualLayout
            | F::UnsupportedExternalStorage
            | F::UnsupportedFilter(_)
            | F::UnsupportedZfp(_)
            | F::InvalidLayoutVersion(5..=8)
    )
}

/// Takes the soft links, which have no address, out of symbol tables, where `hdf5-pure` takes them for objects; their number.
fn drop_soft_links(bytes: &mut [u8]) -> usize {
    let mut dropped = 0;
    let tables: Vec<usize> = memchr::memmem::find_iter(bytes, b"SNOD\x01").collect();
    for at in tables {
        let Some((head, rest)) = bytes[at..].split_first_chunk_mut::<8>() else {
            continue;
        };
        let count = u16::from_le_bytes([head[6], head[7]]);
        let Some(table) = rest.get_mut(..ENTRY * usize::from(count)) else {
            continue;
        };
        let mut kept = 0;
        for entry in 0..count {
            let from = ENTRY * usize::from(entry);
            if table[from + 8..from + 16] != [0xff; 8] || table[from + 16] != 2 {
                table.copy_within(from..from + ENTRY, ENTRY * usize::from(kept));
                kept += 1;
            }
        }
        head[6..].copy_from_slice(&u16::to_le_bytes(kept));
        dropped += usize::from(count - kept);
    }
    dropped
}

fn read(mut bytes: Vec<u8>, group: Option<&str>, separator: &str) -> Result<ChannelSet> {
    let length = bytes.len() as u64;
    let links = drop_soft_links(&mut bytes);
    let file = File::from_bytes(bytes).map_err(|e| corrupt("", e))?;
    let root = file.root();
    let mut reader = Hdf5Reader {
        set: ChannelSet::default(),
        numbers: 0,
        bytes_at_most: length.saturating_mul(PACKED_AT_MOST),
        separator: separator.to_owned(),
    };
    if links > 0 {
        let name = crate::error::counted(links, "soft link");
        reader.set.leave_out(name, "take what they point to");
    }
    let Some(wanted) = group else {
        reader.take_group(&root, "", 0)?;
        return Ok(reader.set);
    };
    let by_path = || root.group(&wanted.replace('.', "/"));
    let Ok(inner) = root.group(wanted).or_else(|_| by_path()) else {
        let groups = root.groups().map_err(|e| corrupt("", e))?;
        return Err(no_group(wanted, &groups));
    };
    // what holds for the whole file holds for the group, unless it says otherwise
    reader.take_attributes(&root, "");
    reader.take_group(&inner, "", 0)?;
    Ok(reader.set)
}

struct Hdf5Reader {
    set: ChannelSet,
    /// Numbers taken so far.
    numbers: u64,
    bytes_at_most: u64,
    separator: String,
}

impl Hdf5Reader {
    fn take_group(&mut self, group: &Group, prefix: &str, depth: usize) -> Result<()> {
        self.take_attributes(group, prefix);
        for name in group.datasets().map_err(|e| corrupt(prefix, e))? {
            let path = format!("{prefix}{name}");
            let dataset = group.dataset(&name).map_err(|e| corrupt(&path, e))?;
            self.take_dataset(&dataset, &path)?;
        }
        for name in group.groups().map_err(|e| corrupt(prefix, e))? {
            if name == REFERENCES {
                continue;
            }
            let path = format!("{prefix}{name}");
            if depth == DEPTH_AT_MOST {
                self.set.leave_out(path, "too deep");
                continue;
            }
            let inner = group.group(&name).map_err(|e| corrupt(&path, e))?;
            self.take_group(&inner, &format!("{path}{}", self.separator), depth + 1)?;
        }
        Ok(())
    }

    fn take_attributes(&mut self, group: &Group, prefix: &str) {
        // attributes of kinds that the reader does not know are of no use here
        for (name, value) in group.attrs().unwrap_or_default() {
            if let Some(value) = attribute(&value) {
                self.set.attributes.insert(format!("{prefix}{name}"), value);
            }
        }
    }

    fn take_dataset(&mut self, dataset: &Dataset, path: &str) -> Result<()> {
        let unknown = |e| format!("of a kind that is not known: {e}");
        if let Some(e) = dataset.chunk_shape().err().filter(is_unknown) {
            self.set.leave_out(path, unknown(e));
            return Ok(());
        }
        let shape = dataset.shape().map_err(|e| corrupt(path, e))?;
        self.check_size(dataset, &shape, path)?;
        let kind = dataset.dtype().map_err(|e| corrupt(path, e))?;
        if !is_number(&kind) {
            match dataset.read_string().ok().as_deref() {
                Some([text]) => self.take_text(path, text.clone()),
                _ => self.set.leave_out(path, kind.to_string()),
            }
            return Ok(());
        }
        let values = match dataset.read_f64() {
            Err(e) if is_unknown(&e) => {
                self.set.leave_out(path, unknown(e));
                return Ok(());
            }
            read => read.map_err(|e| corrupt(path, e))?,
        };
        let shape: Vec<usize> = shape.iter().map(|n| *n as usize).collect();
        let (count, read) = (shape.iter().product::<usize>(), values.len());
        if read != count {
            return Err(corrupt(path, format!("{read} of {count} numbers")));
        }
        let attributes = dataset.attrs().unwrap_or_default();
        let class = attributes.get("MATLAB_class").and_then(AttrValue::as_str);
        if class == Some("char") {
            let codes = values.iter().map(|x| *x as u16);
            let text = char::decode_utf16(codes).map(|c| c.unwrap_or('?'));
            self.take_text(path, text.collect());
            return Ok(());
        }
        let units = units(&attributes);
        self.set.push_array(path, &shape, false, values, &units);
        Ok(())
    }

    fn take_text(&mut self, path: &str, text: String) {
        let text = Attribute::Text(text);
        self.set.attributes.insert(path.to_owned(), text);
    }

    /// Refuses a dataset that states more numbers than the file can hold, before room is made for them.
    fn check_size(&mut self, dataset: &Dataset, shape: &[u64], path: &str) -> Result<()> {
        let product = |sides: &[u64], each: u64| {
            let mut sides = sides.iter();
            sides.try_fold(each, |n, side| n.checked_mul(*side))
        };
        let size = dataset.element_size().map_err(|e| corrupt(path, e))?;
        let chunk = dataset.chunk_shape().map_err(|e| corrupt(path, e))?;
        let chunk = product(&chunk.unwrap_or_default(), 1);
        check_count(path, chunk.unwrap_or(u64::MAX))?;
        let count = product(shape, 1).unwrap_or(u64::MAX);
        self.numbers = self.numbers.saturating_add(count);
        check_count(path, self.numbers)?;
        match product(shape, size) {
            Some(bytes) if bytes <= self.bytes_at_most => Ok(()),
            _ => Err(corrupt(path, format!("a dataset of {shape:?} numbers"))),
        }
    }
}

fn is_number(kind: &DType) -> bool {
    !matches!(
        kind,
        DType::String
            | DType::Compound(_)
            | DType::Array(..)
            | DType::VariableLengthString
            | DType::ObjectReference
            | DType::Other(_)
    )
}

/// The units that a dataset states: none, one for all columns, or one per column.
fn units(attributes: &HashMap<String, AttrValue>) -> Vec<String> {
    let mut attributes = attributes.iter();
    let named = |name: &str| ["unit", "units"].contains(&name.to_lowercase().as_str());
    let stated = attributes.find(|(name, _)| named(name)).map(|(_, v)| v);
    let one = stated.and_then(|v| Some(vec![v.as_str()?.to_owned()]));
    let all = || stated.and_then(|v| Some(v.as_strings()?.to_vec()));
    one.or_else(all).unwrap_or_default()
}

fn attribute(value: &AttrValue) -> Option<Attribute> {
    let number = || {
        let integer = value.as_i64().map(|x| x as f64);
        value.as_f64().or(integer).map(Attribute::Number)
    };
    let text = || value.as_str().map(|t| Attribute::Text(t.to_owned()));
    number().or_else(text)
}
