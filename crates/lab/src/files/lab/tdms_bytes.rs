//! Numbers, texts, samples and properties out of the bytes of a TDMS file, in either byte order.

use super::channels::Attribute;
use crate::error::{Error, Result};

/// Type codes.
pub(super) const STRING: u32 = 0x20;
const COMPLEX_SINGLE: u32 = 0x0008_000c;
const COMPLEX_DOUBLE: u32 = 0x0010_000d;
const BOOLEAN: u32 = 0x21;
const TIME_STAMP: u32 = 0x44;

/// A place in the bytes of a file.
#[derive(Debug, Clone)]
pub(super) struct Bytes<'a> {
    pub data: &'a [u8],
    pub at: usize,
    pub big_endian: bool,
}

impl<'a> Bytes<'a> {
    /// The next `count` bytes.
    pub(crate) fn take(&mut self, count: usize) -> Result<&'a [u8]> {
        let end = self.at.checked_add(count);
        let taken = end.and_then(|end| self.data.get(self.at..end));
        let Some(taken) = taken else {
            let found = format!(
                "the end of the file after {}",
                self.data.len().saturating_sub(self.at)
            );
            return Err(Error::input(
                format!("byte {}", self.at),
                format!("{count} bytes"),
                found,
            ));
        };
        self.at += count;
        Ok(taken)
    }

    /// `N` bytes, the least significant first.
    pub(crate) fn little<const N: usize>(&mut self) -> Result<[u8; N]> {
        let mut bytes = [0; N];
        bytes.copy_from_slice(self.take(N)?);
        if self.big_endian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    pub(crate) fn u32(&mut self) -> Result<u32> {
        Ok(u32::from_le_bytes(self.little()?))
    }

    pub(crate) fn u64(&mut self) -> Result<u64> {
        Ok(u64::from_le_bytes(self.little()?))
    }

    /// A text with its length in front.
    pub(crate) fn text(&mut self) -> Result<String> {
        let length = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.take(length)?).into_owned())
    }
}

/// Why samples of a kind are left out; `None` for numbers.
pub(super) fn no_number(kind: u32) -> Option<&'static str> {
    match kind {
        STRING => Some("text"),
        TIME_STAMP => Some("time stamps"),
        COMPLEX_SINGLE | COMPLEX_DOUBLE => Some("complex numbers"),
        _ => None,
    }
}

/// Bytes per sample.
pub(super) fn size_of(kind: u32, path: &str) -> Result<usize> {
    match kind {
        1 | 5 | BOOLEAN => Ok(1),
        2 | 6 => Ok(2),
        3 | 7 | 9 | 0x19 => Ok(4),
        4 | 8 | 10 | 0x1a | COMPLEX_SINGLE => Ok(8),
        TIME_STAMP | COMPLEX_DOUBLE => Ok(16),
        other => Err(Error::input(
            path,
            "samples that are numbers",
            format!("type {other:#x}"),
        )),
    }
}

/// One sample of a channel.
pub(super) fn sample(bytes: &mut Bytes<'_>, kind: u32) -> Result<f64> {
    Ok(match kind {
        1 => i8::from_le_bytes(bytes.little()?).into(),
        2 => i16::from_le_bytes(bytes.little()?).into(),
        3 => i32::from_le_bytes(bytes.little()?).into(),
        4 => i64::from_le_bytes(bytes.little()?) as f64,
        5 | BOOLEAN => u8::from_le_bytes(bytes.little()?).into(),
        6 => u16::from_le_bytes(bytes.little()?).into(),
        7 => u32::from_le_bytes(bytes.little()?).into(),
        8 => u64::from_le_bytes(bytes.little()?) as f64,
        9 | 0x19 => f32::from_le_bytes(bytes.little()?).into(),
        // every other kind was refused before
        _ => f64::from_le_bytes(bytes.little()?),
    })
}

/// A property; `None` for one that is of no use here.
pub(super) fn property(bytes: &mut Bytes<'_>) -> Result<Option<Attribute>> {
    match bytes.u32()? {
        STRING => Ok(Some(Attribute::Text(bytes.text()?))),
        kind => {
            let size = size_of(kind, &format!("byte {}, property", bytes.at))?;
            if no_number(kind).is_some() {
                return bytes.take(size).map(|_| None);
            }
            Ok(Some(Attribute::Number(sample(bytes, kind)?)))
        }
    }
}
