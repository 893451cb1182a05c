//! `benches/instructions.json`: what was used when it was last stored.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The file.
#[derive(Serialize, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(crate) struct StoredCounts {
    /// Of the program that was counted: another compiler counts otherwise.
    pub(crate) compiler: String,
    /// Instructions of a unit of each entry, x86-64 with AVX2.
    pub(crate) instructions: BTreeMap<String, StoredFigure>,
    /// Largest resident memory, MiB.
    pub(crate) peak_mib: BTreeMap<String, StoredFigure>,
}

#[derive(Serialize, Deserialize, Default, Clone)]
#[serde(deny_unknown_fields)]
pub(crate) struct StoredFigure {
    pub(crate) value: f64,
    /// Why it rose, where it was meant to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) reason: Option<String>,
}

fn path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/instructions.json")
}

impl StoredCounts {
    /// Empty where there is no file yet.
    pub(crate) fn read() -> Result<Self, String> {
        match std::fs::read_to_string(path()) {
            Ok(text) => {
                serde_json::from_str(&text).map_err(|e| format!("{}: {e}", path().display()))
            }
            Err(_) => Ok(Self::default()),
        }
    }

    pub(crate) fn write(&self) -> Result<(), String> {
        let text = serde_json::to_string_pretty(self).map_err(|e| e.to_string())?;
        std::fs::write(path(), text + "\n").map_err(|e| format!("{}: {e}", path().display()))
    }
}

/// The compiler at hand, in its own words.
pub(crate) fn compiler() -> String {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(rustc).arg("--version").output();
    output.map_or_else(
        |_| "not known".to_owned(),
        |o| String::from_utf8_lossy(&o.stdout).trim().to_owned(),
    )
}
