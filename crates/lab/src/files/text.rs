//! Text files, whose encoding is UTF-8.

use crate::error::{Error, Result};
use std::path::Path;

/// The text of a file.
///
/// # Errors
/// [`Error::Io`] when it cannot be read; [`Error::Input`] with file and line for bytes that are no UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    String::from_utf8(bytes).map_err(|e| {
        let (at, bytes) = (e.utf8_error().valid_up_to(), e.as_bytes());
        let line = 1 + bytes[..at].iter().filter(|b| **b == b'\n').count();
        let found = format!("the byte 0x{:02x} (Latin-1?)", bytes[at]);
        Error::input(format!("line {line}"), "text in UTF-8", found).in_file(path)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_encodings_are_refused_with_their_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("study.toml");
        std::fs::write(&path, b"schema = 1\nname = \"caf\xe9\"\n").unwrap();
        let said = read_text(&path).unwrap_err().to_string();
        let expected = "study.toml: line 2: expected text in UTF-8, found the byte 0xe9 (Latin-1?)";
        assert!(said.ends_with(expected), "{said}");
    }
}
