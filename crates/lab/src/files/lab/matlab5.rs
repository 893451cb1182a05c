//! MATLAB files of versions 5 to 7 by `matrw`, behind a shim.
//!
//! `matrw` wants the header text that MATLAB writes and refuses that of others, panics on corrupt files, and converts
//! no integers; all three are seen to here.

use super::channels::{Attribute, ChannelSet, NUMBERS_AT_MOST, check_count, no_group};
use super::guarded;
use crate::error::{Error, Result, ensure};
use matrw::{MatVariable, MatlabType};
use std::io::Read;
use std::ops::Range;

/// What `matrw` looks for.
const HEADER: &[u8] = b"MATLAB 5.0 MAT-file, ";
/// Why a variable is left out that `matrw` cannot read.
const UNREADABLE: &str = "corrupt, or of a kind that is not known";
/// Type of a compressed element.
const COMPRESSED: u32 = 15;
/// Type of a variable, and two of its classes.
const MATRIX: u32 = 14;
const CELL: u32 = 1;
const STRUCT: u32 = 2;
/// Structs within structs within structs.
const DEPTH_AT_MOST: usize = 32;
/// Length of the header; version and byte order are its last four bytes.
const HEADER_BYTES: usize = 128;
/// The name of a variable stands within this many bytes of it.
const NAME_WITHIN: u64 = 4096;

/// Reads the bytes of a file.
///
/// # Errors
/// [`Error::Input`] for a file that is no MATLAB file, truncated or corrupt, or lacks the struct `group`.
pub(super) fn parse(bytes: Vec<u8>, group: Option<&str>) -> Result<ChannelSet> {
    let expected = "a MATLAB file of version 5 to 7 (saving it with `-v7.3`, or as CSV, may help)";
    let corrupt = || Error::input("", expected, "a part that cannot be read");
    let file = variables(bytes)?;
    let any = file.is_empty() || file.iter().any(|(_, value)| value.is_some());
    ensure(any, "", expected, "no variable that can be read")?;
    guarded(|| channels(&file, group)).ok_or_else(corrupt)?
}

/// Size and numbers (first index fastest) of one real array in the bytes of a file.
///
/// # Errors
/// [`Error::Input`] for a file that is no MATLAB file, truncated or corrupt, or lacks the array.
pub(crate) fn matlab_array(bytes: Vec<u8>, name: &str) -> Result<(Vec<usize>, Vec<f64>)> {
    let expected = "a real array of this name in a MATLAB file of version 5 to 7";
    let missing = || Error::input(name, expected, "none");
    let file = variables(bytes)?;
    let variable = file.iter().find(|(own, _)| own == name);
    let value = variable.and_then(|(_, value)| value.as_ref());
    let Some(MatVariable::NumericArray(array)) = value.map(uncompressed) else {
        return Err(missing());
    };
    check_count(name, count(&MatVariable::NumericArray(array.clone())))?;
    match numbers(array.numeric_type()) {
        Ok(values) if !array.is_complex() => Ok((array.dim.clone(), values)),
        _ => Err(missing()),
    }
}

/// Reads each variable by itself, so that one that cannot be read costs only itself: its name, and `None` where `matrw` cannot.
fn variables(mut bytes: Vec<u8>) -> Result<Vec<(String, Option<MatVariable>)>> {
    let elements = check_elements(&bytes)?;
    bytes[..HEADER.len()].copy_from_slice(HEADER);
    let header = bytes[..HEADER_BYTES].to_vec();
    let little = header[126] == b'I';
    let mut read = Vec::with_capacity(elements.len());
    for Range { start, end } in elements {
        let own = &bytes[start..end];
        let own = &MatlabElement { bytes: own, little }.inflated(NAME_WITHIN);
        let name = MatlabElement { bytes: own, little }.name();
        let name = name.and_then(|at| String::from_utf8(own[at].to_vec()).ok());
        let name = name.unwrap_or_else(|| format!("byte {start}"));
        // the header takes the place of what has been read: nothing is copied
        bytes[start - HEADER_BYTES..start].copy_from_slice(&header);
        let alone = |bytes: &[u8]| {
            let file = guarded(|| matrw::load_matfile_from_u8(bytes))?.ok()?;
            file.into_iter().next().map(|(_, value)| value)
        };
        let value = alone(&bytes[start - HEADER_BYTES..end]).or_else(|| {
            let bytes = &bytes[start..end];
            let bytes = &MatlabElement { bytes, little }.inflated(u64::MAX);
            let named = MatlabElement { bytes, little }.with_long_names(DEPTH_AT_MOST)?;
            alone(&[&header[..], &named].concat())
        });
        read.push((name, value));
    }
    Ok(read)
}

/// Refuses compressed elements that become more than a recording can be, without keeping what they become.
fn check_inflated(place: &str, packed: &[u8], before: u64) -> Result<u64> {
    let at_most = NUMBERS_AT_MOST * size_of::<f64>() as u64;
    let mut stream = flate2::read::ZlibDecoder::new(packed).take(at_most + 1 - before.min(at_most));
    // what is corrupt is said by the reader proper
    let inflated = std::io::copy(&mut stream, &mut std::io::sink()).unwrap_or(0);
    let all = before + inflated;
    let expected =
        format_args!("compressed variables of at most {at_most} bytes (cut the recording)");
    ensure(all <= at_most, place, expected, "more").map(|()| all)
}

/// Where the elements lie, checked so that a truncated one is named as such, and what compressed ones become.
fn check_elements(bytes: &[u8]) -> Result<Vec<Range<usize>>> {
    let version = bytes.get(124..HEADER_BYTES);
    let little = match version {
        Some([0, 1, b'I', b'M']) => true,
        Some([1, 0, b'M', b'I']) => false,
        _ => {
            let expected = "a MATLAB file of version 5 to 7 (save it with `-v7`)";
            let found = match bytes.len() {
                few if few < HEADER_BYTES => format!("{few} bytes"),
                _ => "another header".to_owned(),
            };
            return Err(Error::input("header", expected, found));
        }
    };
    let word = |at: usize| MatlabElement { bytes, little }.word(at);
    let mut elements = Vec::new();
    let (mut at, mut inflated) = (HEADER_BYTES, 0);
    while at < bytes.len() {
        let size = word(at + 4).map(|size| size as usize);
        match size {
            Some(size) if size <= bytes.len() - at - 8 => {
                if word(at) == Some(COMPRESSED) {
                    let packed = &bytes[at + 8..at + 8 + size];
                    inflated = check_inflated(&format!("byte {at}"), packed, inflated)?;
                }
                elements.push(at..at + 8 + size);
                at += 8 + size;
            }
            _ => {
                let expected = size.map_or("an element".to_owned(), |size| format!("{size} bytes"));
                let left = bytes.len() - at;
                let found = format!("the end of the file after {left} (truncated?)");
                return Err(Error::input(format!("byte {at}"), expected, found));
            }
        }
    }
    Ok(elements)
}

/// An element: a tag of eight bytes, then what it tags.
struct MatlabElement<'a> {
    bytes: &'a [u8],
    little: bool,
}

impl MatlabElement<'_> {
    fn word(&self, at: usize) -> Option<u32> {
        let four: [u8; 4] = self.bytes.get(at..at + 4)?.try_into().ok()?;
        Some(match self.little {
            true => u32::from_le_bytes(four),
            false => u32::from_be_bytes(four),
        })
    }

    /// Where the part with its tag at `at` has its data; those of up to four bytes may stand in the tag.
    fn data(&self, at: usize) -> Option<Range<usize>> {
        let data = match self.word(at)? >> 16 {
            0 => at + 8..at + 8 + self.word(at + 4)? as usize,
            short => at + 4..at + 4 + short as usize,
        };
        (data.end <= self.bytes.len()).then_some(data)
    }

    /// The first bytes of what is in it, without compression.
    fn inflated(&self, at_most: u64) -> Vec<u8> {
        let mut inner = Vec::new();
        if self.word(0) == Some(COMPRESSED) {
            // behind what is corrupt there is nothing to find
            let _ = flate2::read::ZlibDecoder::new(&self.bytes[8..])
                .take(at_most)
                .read_to_end(&mut inner);
        } else {
            inner.extend(self.bytes.iter().take(at_most as usize));
        }
        inner
    }

    /// The name of the variable, behind its flags and its size.
    fn name(&self) -> Option<Range<usize>> {
        let size = self.data(self.data(8)?.end.next_multiple_of(8))?;
        self.data(size.end.next_multiple_of(8))
    }

    /// The element with the names of all fields behind their tag: SciPy puts those of up to four bytes into it, where `matrw`
    /// does not find them.
    fn with_long_names(&self, depth: usize) -> Option<Vec<u8>> {
        let class = self.data(8).and_then(|flags| self.word(flags.start));
        let is_struct = class? & 0xff == STRUCT;
        if self.word(0) != Some(MATRIX) || !(is_struct || class? & 0xff == CELL) {
            return Some(self.bytes.to_vec());
        }
        let word = |x: usize| match self.little {
            true => (x as u32).to_le_bytes(),
            false => (x as u32).to_be_bytes(),
        };
        let mut at = self.name()?.end.next_multiple_of(8);
        let mut out = self.bytes.get(..at)?.to_vec();
        if is_struct {
            let names = self.data(at + 8)?;
            out.extend(self.bytes.get(at..at + 8)?);
            out.extend([word(1), word(names.len())].concat());
            out.extend(&self.bytes[names.clone()]);
            out.resize(out.len().next_multiple_of(8), 0);
            at = names.end.next_multiple_of(8);
        }
        while at < self.bytes.len() {
            let bytes = &self.bytes[at..self.data(at)?.end];
            let little = self.little;
            out.extend(MatlabElement { bytes, little }.with_long_names(depth.checked_sub(1)?)?);
            at += bytes.len();
        }
        let size = word(out.len() - 8);
        out[4..8].copy_from_slice(&size);
        Some(out)
    }
}

fn channels(file: &[(String, Option<MatVariable>)], group: Option<&str>) -> Result<ChannelSet> {
    let mut set = ChannelSet::default();
    let mut readable = Vec::new();
    for (name, value) in file {
        match value {
            Some(value) => readable.push((name, value)),
            None if Some(&name[..]) == group => {
                let found = format!("`{name}` ({UNREADABLE})");
                return Err(Error::input("group", "a struct that can be read", found));
            }
            None => set.leave_out(name, UNREADABLE),
        }
    }
    check_count("", readable.iter().map(|(_, v)| count(v)).sum())?;
    let Some(group) = group else {
        for (name, variable) in readable {
            push(&mut set, name, variable);
        }
        return Ok(set);
    };
    let found = readable.iter().find(|(name, _)| *name == group);
    let Some(MatVariable::Structure(inner)) = found.map(|(_, v)| uncompressed(v)) else {
        let is_struct = |v: &MatVariable| matches!(uncompressed(v), MatVariable::Structure(_));
        let structs = readable.iter().filter(|(_, v)| is_struct(v));
        let structs: Vec<String> = structs.map(|(name, _)| (*name).clone()).collect();
        return Err(no_group(group, &structs));
    };
    for name in inner.fieldnames() {
        if let Some(field) = inner.get(&name) {
            push(&mut set, &name, field);
        }
    }
    Ok(set)
}

/// Numbers in a variable and all that is in it.
fn count(variable: &MatVariable) -> u64 {
    match variable {
        MatVariable::Compressed(inner) => count(&inner.value),
        MatVariable::NumericArray(array) => array.dim.iter().map(|n| *n as u64).product(),
        MatVariable::Structure(inner) => {
            let fields = inner.fieldnames();
            fields.iter().filter_map(|f| inner.get(f)).map(count).sum()
        }
        MatVariable::StructureArray(array) => array.value.iter().map(count).sum(),
        MatVariable::CellArray(array) => array.value.iter().map(count).sum(),
        _ => 0,
    }
}

fn uncompressed(variable: &MatVariable) -> &MatVariable {
    match variable {
        MatVariable::Compressed(inner) => uncompressed(&inner.value),
        other => other,
    }
}

fn push(set: &mut ChannelSet, name: &str, variable: &MatVariable) {
    match variable {
        MatVariable::Compressed(inner) => push(set, name, &inner.value),
        MatVariable::NumericArray(array) if array.is_complex() => {
            set.leave_out(name, "complex numbers");
        }
        MatVariable::NumericArray(array) => match numbers(array.numeric_type()) {
            Ok(values) => set.push_array(name, &array.dim, true, values, &[]),
            Err(text) => {
                let text = Attribute::Text(text);
                set.attributes.insert(name.to_owned(), text);
                set.leave_out(name, "text");
            }
        },
        MatVariable::Structure(inner) => {
            for field in inner.fieldnames() {
                if let Some(value) = inner.get(&field) {
                    push(set, &format!("{name}.{field}"), value);
                }
            }
        }
        MatVariable::StructureArray(array) => {
            for (i, value) in array.value.iter().enumerate() {
                push(set, &format!("{name}[{}]", i + 1), value);
            }
        }
        MatVariable::CellArray(array) => {
            for (i, value) in array.value.iter().enumerate() {
                push(set, &format!("{name}{{{}}}", i + 1), value);
            }
        }
        _ => set.leave_out(name, "neither numbers nor struct nor cell"),
    }
}

/// All numeric types as doubles, or the text that stands there; 64-bit integers beyond 2⁵³ are rounded.
fn numbers(values: &MatlabType) -> std::result::Result<Vec<f64>, String> {
    fn wide<T: Copy + Into<f64>>(values: &[T]) -> Vec<f64> {
        values.iter().map(|x| (*x).into()).collect()
    }
    Ok(match values {
        MatlabType::U8(v) => wide(v),
        MatlabType::I8(v) => wide(v),
        MatlabType::U16(v) => wide(v),
        MatlabType::I16(v) => wide(v),
        MatlabType::U32(v) => wide(v),
        MatlabType::I32(v) => wide(v),
        MatlabType::U64(v) => v.iter().map(|x| *x as f64).collect(),
        MatlabType::I64(v) => v.iter().map(|x| *x as f64).collect(),
        MatlabType::F32(v) => wide(v),
        MatlabType::F64(v) => v.clone(),
        MatlabType::BOOL(v) => v.iter().map(|x| f64::from(u8::from(*x))).collect(),
        MatlabType::UTF8(v) | MatlabType::UTF16(v) => return Err(v.iter().collect()),
    })
}
