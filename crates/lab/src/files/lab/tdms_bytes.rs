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
            let left = self.data.len().saturating_sub(self.at);
            let (place, expected) = (format!("byte {}", self.at), format!("{count} bytes"));
            let found = format!("the end of the file after {left}");
            return Err(Error::input(place, expected, found));
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

    /// Numbers of `N` bytes each.
    fn numbers<const N: usize>(
        &mut self,
        count: usize,
        to: &mut Vec<f64>,
        number: impl Fn([u8; N]) -> f64,
    ) -> Result<()> {
        let (each, _) = self.take(count.saturating_mul(N))?.as_chunks::<N>();
        to.extend(each.iter().copied().map(|mut bytes| {
            if self.big_endian {
                bytes.reverse();
            }
            number(bytes)
        }));
        Ok(())
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
        other => {
            let found = format!("type {other:#x}");
            Err(Error::input(path, "samples that are numbers", found))
        }
    }
}

/// Takes the next `count` samples of a kind as numbers.
pub(super) fn take_numbers(
    bytes: &mut Bytes<'_>,
    kind: u32,
    count: usize,
    to: &mut Vec<f64>,
) -> Result<()> {
    match kind {
        1 => bytes.numbers(count, to, |b| i8::from_le_bytes(b).into()),
        2 => bytes.numbers(count, to, |b| i16::from_le_bytes(b).into()),
        3 => bytes.numbers(count, to, |b| i32::from_le_bytes(b).into()),
        4 => bytes.numbers(count, to, |b| i64::from_le_bytes(b) as f64),
        5 | BOOLEAN => bytes.numbers(count, to, |b| u8::from_le_bytes(b).into()),
        6 => bytes.numbers(count, to, |b| u16::from_le_bytes(b).into()),
        7 => bytes.numbers(count, to, |b| u32::from_le_bytes(b).into()),
        8 => bytes.numbers(count, to, |b| u64::from_le_bytes(b) as f64),
        9 | 0x19 => bytes.numbers(count, to, |b| f32::from_le_bytes(b).into()),
        // every other kind was refused before
        _ => bytes.numbers(count, to, f64::from_le_bytes),
    }
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
            let mut number = Vec::with_capacity(1);
            take_numbers(bytes, kind, 1, &mut number)?;
            Ok(number.pop().map(Attribute::Number))
        }
    }
}
