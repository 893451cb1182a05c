//! A baseline in Python: one process that waits for its rounds.

use crate::entry::{Script, Threads};
use crate::python;
use serde_json::Value;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use tempfile::NamedTempFile;

/// A script that has read its argument.
pub(crate) struct Running {
    /// Name and versions.
    pub(crate) name: String,
    /// Largest resident memory of its process so far.
    pub(crate) peak_mib: f64,
    tolerance: f64,
    share: f64,
    /// What it found last.
    answer: Vec<f64>,
    child: Child,
    ask: Option<ChildStdin>,
    said: BufReader<ChildStdout>,
    _argument: NamedTempFile,
}

impl Running {
    pub(crate) fn start(script: &Script, threads: Threads) -> Result<Self, String> {
        let said = |e: std::io::Error| format!("{}: {e}", script.file);
        let python = interpreter()?;
        let mut argument = NamedTempFile::new().map_err(said)?;
        write!(argument, "{}", (script.argument)()).map_err(said)?;
        let mut command = Command::new(python);
        command
            .arg(folder().join("harness.py"))
            .arg(folder().join(script.file))
            .arg(argument.path())
            .args(script.packages)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped());
        if threads == Threads::One {
            for library in ["OMP", "OPENBLAS", "MKL"] {
                command.env(format!("{library}_NUM_THREADS"), "1");
            }
        }
        let mut child = command.spawn().map_err(said)?;
        let pipes = child.stdin.take().zip(child.stdout.take());
        let (ask, output) = pipes.ok_or("a process without pipes")?;
        let mut running = Self {
            name: script.name.to_owned(),
            peak_mib: 0.0,
            tolerance: script.tolerance,
            share: script.share,
            answer: vec![],
            child,
            ask: Some(ask),
            said: BufReader::new(output),
            _argument: argument,
        };
        let versions = running.line()?;
        let versions: Vec<_> = versions.as_array().into_iter().flatten().collect();
        let versions: Vec<_> = versions.iter().filter_map(|v| v.as_str()).collect();
        running.name = format!("{} ({})", script.name, versions.join(", "));
        Ok(running)
    }

    fn line(&mut self) -> Result<Value, String> {
        let mut line = String::new();
        self.said.read_line(&mut line).map_err(|e| e.to_string())?;
        serde_json::from_str(&line).map_err(|e| format!("{} said `{line}`: {e}", self.name))
    }

    /// Seconds of the whole work.
    pub(crate) fn round(&mut self) -> Result<f64, String> {
        let ask = self.ask.as_mut().ok_or("it has ended")?;
        writeln!(ask).map_err(|e| e.to_string())?;
        let line = self.line()?;
        let number = |key: &str| line[key].as_f64().ok_or(format!("no {key} in {line}"));
        self.peak_mib = number("peak_mib")?;
        let answer = line["answer"].as_array().into_iter().flatten();
        self.answer = answer.map(|x| x.as_f64().unwrap_or(f64::NAN)).collect();
        Ok(number("seconds")? / self.share)
    }

    /// Whether it found the same numbers, where it finds any.
    pub(crate) fn agrees(&self, ours: &[f64]) -> Result<(), String> {
        if self.answer.is_empty() {
            return Ok(());
        }
        if ours.len() != self.answer.len() {
            let lengths = (ours.len(), self.answer.len());
            return Err(format!("{}: {lengths:?} numbers to compare", self.name));
        }
        for (a, b) in ours.iter().zip(&self.answer) {
            let same = (a.is_nan() && b.is_nan()) || (a / b - 1.0).abs() <= self.tolerance;
            if !same {
                return Err(format!("{} found {b}, not {a}", self.name));
            }
        }
        Ok(())
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // its loop ends with its input
        drop(self.ask.take());
        let _ = self.child.wait();
    }
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/ledger/baselines")
}

/// The environment of the tests, with what the baselines need besides.
fn interpreter() -> Result<PathBuf, String> {
    let python = python::interpreter()?;
    let output = Command::new(&python)
        .args([
            "-m",
            "pip",
            "install",
            "--disable-pip-version-check",
            "--no-input",
        ])
        .args(["--quiet", "--only-binary=:all:", "-r"])
        .arg(folder().join("requirements.txt"))
        .output()
        .map_err(|e| e.to_string())?;
    if output.status.success() {
        Ok(python)
    } else {
        Err(String::from_utf8_lossy(&output.stderr).into_owned())
    }
}
