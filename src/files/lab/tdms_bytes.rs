//! Numbers and texts out of a slice of bytes, in either byte order.

use crate::error::{Error, Result};

/// A place in the bytes of a file.
#[derive(Debug, Clone)]
pub(super) struct Bytes<'a> {
    pub data: &'a [u8],
    pub at: usize,
    pub big_endian: bool,
}

impl<'a> Bytes<'a> {
    /// The next `count` bytes.
    ///
    /// # Errors
    /// [`Error::Input`] with the byte at which the file ends too early.
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
