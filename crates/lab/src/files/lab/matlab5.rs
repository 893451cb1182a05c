//! MATLAB files of versions 5 to 7 by `matrw`, behind a shim.
//!
//! `matrw` wants the header text that MATLAB writes and refuses that of others, panics on corrupt files, and converts
//! no integers; all three are seen to here.

use super::channels::{Attribute, ChannelSet, NUMBERS_AT_MOST, check_count, no_group};
use super::columns::push_array;
use super::guarded::guarded;
use crate::error::{Error, Result, ensure};
use matrw::{MatFile, MatVariable, MatlabType};
use std::io::Read;

/// What `matrw` looks for.
const HEADER: &[u8] = b"MATLAB 5.0 MAT-file, ";
/// Type of a compressed element.
const COMPRESSED: u32 = 15;
/// Length of the header; version and byte order are its last four bytes.
const HEADER_BYTES: usize = 128;

/// Reads the bytes of a file.
///
/// # Errors
/// [`Error::Input`] for a file that is no MATLAB file, truncated or corrupt, or lacks the struct `group`.
pub(super) fn parse(mut bytes: Vec<u8>, group: Option<&str>) -> Result<ChannelSet> {
    check_elements(&bytes)?;
    bytes[..HEADER.len()].copy_from_slice(HEADER);
    let corrupt = |found: String| {
        let expected =
            "a MATLAB file of version 5 to 7 (saving it with `-v7.3`, or as CSV, may help)";
        Error::input("", expected, found)
    };
    let file = guarded(|| matrw::load_matfile_from_u8(&bytes))
        .ok_or_else(|| corrupt("a part that cannot be read".to_owned()))?
        .map_err(|e| corrupt(e.to_string()))?;
    guarded(|| channels(&file, group))
        .ok_or_else(|| corrupt("a part that cannot be read".to_owned()))?
}

/// Size and numbers (first index fastest) of one real array in the bytes of a file.
///
/// # Errors
/// [`Error::Input`] for a file that is no MATLAB file, truncated or corrupt, or lacks the array.
pub(crate) fn matlab_array(mut bytes: Vec<u8>, name: &str) -> Result<(Vec<usize>, Vec<f64>)> {
    check_elements(&bytes)?;
    bytes[..HEADER.len()].copy_from_slice(HEADER);
    let missing = || {
        Error::input(
            name,
            "a real array of this name in a MATLAB file of version 5 to 7",
            "none",
        )
    };
    let file = guarded(|| matrw::load_matfile_from_u8(&bytes)).and_then(std::result::Result::ok);
    let file = file.ok_or_else(missing)?;
    let variable = file
        .iter()
        .find(|(n, _)| *n == name)
        .map(|(_, v)| uncompressed(v));
    let Some(MatVariable::NumericArray(array)) = variable else {
        return Err(missing());
    };
    check_count(name, count(&MatVariable::NumericArray(array.clone())))?;
    match numbers(array.numeric_type()) {
        Ok(values) if !array.is_complex() => Ok((array.dim.clone(), values)),
        _ => Err(missing()),
    }
}

/// Refuses compressed elements that become more than a recording can be, without keeping what they become.
fn check_inflated(place: &str, packed: &[u8], before: u64) -> Result<u64> {
    let at_most = NUMBERS_AT_MOST * size_of::<f64>() as u64;
    let mut stream = flate2::read::ZlibDecoder::new(packed).take(at_most + 1 - before.min(at_most));
    // what is corrupt is said by the reader proper
    let inflated = std::io::copy(&mut stream, &mut std::io::sink()).unwrap_or(0);
    ensure(
        before + inflated <= at_most,
        place,
        format_args!("compressed variables of at most {at_most} bytes (cut the recording)"),
        "more",
    )?;
    Ok(before + inflated)
}

/// Checks that all elements lie in the file, so that a truncated one is named as such, and what compressed ones become.
fn check_elements(bytes: &[u8]) -> Result<()> {
    let version = bytes.get(124..HEADER_BYTES);
    let little = match version {
        Some([0, 1, b'I', b'M']) => true,
        Some([1, 0, b'M', b'I']) => false,
        _ => {
            let expected = "a MATLAB file of version 5 to 7 (save it with `-v7`)";
            let found = if bytes.len() < HEADER_BYTES {
                format!("{} bytes", bytes.len())
            } else {
                "another header".to_owned()
            };
            return Err(Error::input("header", expected, found));
        }
    };
    let word = |at: usize| -> Option<u32> {
        let four: [u8; 4] = bytes.get(at..at + 4)?.try_into().ok()?;
        Some(if little {
            u32::from_le_bytes(four)
        } else {
            u32::from_be_bytes(four)
        })
    };
    let (mut at, mut inflated) = (HEADER_BYTES, 0);
    while at < bytes.len() {
        let size = word(at + 4).map(|size| size as usize);
        match size {
            Some(size) if size <= bytes.len() - at - 8 => {
                if word(at) == Some(COMPRESSED) {
                    let packed = &bytes[at + 8..at + 8 + size];
                    inflated = check_inflated(&format!("byte {at}"), packed, inflated)?;
                }
                at += 8 + size;
            }
            _ => {
                let expected = match size {
                    Some(size) => format!("{size} bytes"),
                    None => "an element".to_owned(),
                };
                let found = format!(
                    "the end of the file after {} (truncated?)",
                    bytes.len() - at
                );
                return Err(Error::input(format!("byte {at}"), expected, found));
            }
        }
    }
    Ok(())
}

fn channels(file: &MatFile, group: Option<&str>) -> Result<ChannelSet> {
    let mut set = ChannelSet::default();
    let numbers = file.iter().map(|(_, v)| count(v)).sum();
    check_count("", numbers)?;
    let Some(group) = group else {
        for (name, variable) in file.iter() {
            push(&mut set, name, variable);
        }
        return Ok(set);
    };
    let found = file.iter().find(|(name, _)| *name == group);
    let Some((_, MatVariable::Structure(inner))) = found.map(|(n, v)| (n, uncompressed(v))) else {
        let is_struct = |v: &MatVariable| matches!(uncompressed(v), MatVariable::Structure(_));
        let structs: Vec<String> = file
            .iter()
            .filter(|(_, v)| is_struct(v))
            .map(|(name, _)| name.clone())
            .collect();
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
            Ok(values) => push_array(set, name, &array.dim, true, values, &[]),
            Err(text) => {
                let text = Attribute::Text(text);
                set.attributes.insert(name.to_owned(), text);
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
