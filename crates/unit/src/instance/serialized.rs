//! A saved state as bytes: little-endian, versioned, tied to one export by its identity.
//!
//! ```text
//! magic "AERODECK" · version u32 · identity 16 bytes · number of values, inputs, states, lagging gusts u32 each
//! state code u8 · experiment u8 (bit 0: set up, bit 1: with a stop time) · start, stop, time f64
//! values f64… · input rates f64… · section state f64… · lagging gusts f64… · phase f64 · last wind f64 (-1 for none)
//! digest of all bytes before, 16 bytes
//! ```

use super::memory::{Memory, RunTimes};
use crate::error::{Error, Result};
use crate::lifecycle::State;
use uuid::Uuid;

const MAGIC: &[u8; 8] = b"AERODECK";
const VERSION: u32 = 3;
/// Stands for no last wind.
const NO_WIND: f64 = -1.0;
const HEADER: usize = 8 + 4 + 16 + 4 * 4 + 2;
const DIGEST: usize = 16;

/// Length in bytes of every saved state of an instance with this memory.
pub(super) fn length(memory: &Memory) -> usize {
    // start, stop, time, phase, last wind
    HEADER + 8 * (5 + counts(memory).iter().sum::<usize>()) + DIGEST
}

/// Tells damaged bytes from whole ones: a changed digit would go unnoticed otherwise.
fn digest(bytes: &[u8], guid: &Uuid) -> [u8; DIGEST] {
    Uuid::new_v5(guid, bytes).into_bytes()
}

fn counts(memory: &Memory) -> [usize; 4] {
    [
        memory.values.len(),
        memory.input_rates.len(),
        memory.system.values.len(),
        memory.system.gusts.len(),
    ]
}

/// The bytes of a saved state.
pub(super) fn write(memory: &Memory, guid: &Uuid) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(length(memory));
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&VERSION.to_le_bytes());
    bytes.extend_from_slice(guid.as_bytes());
    for count in counts(memory) {
        bytes.extend_from_slice(&(count as u32).to_le_bytes());
    }
    bytes.push(memory.state as u8);
    let (set_up, stop) = match memory.experiment {
        None => (0, None),
        Some(e) => (1 + 2 * u8::from(e.stop.is_some()), e.stop),
    };
    bytes.push(set_up);
    let start = memory.experiment.map_or(0.0, |e| e.start);
    let numbers = [start, stop.unwrap_or(0.0), memory.time]
        .into_iter()
        .chain(memory.values.iter().copied())
        .chain(memory.input_rates.iter().copied())
        .chain(memory.system.all())
        .chain([
            memory.system.phase,
            memory.system.last_wind_m_s.unwrap_or(NO_WIND),
        ]);
    for number in numbers {
        bytes.extend_from_slice(&number.to_le_bytes());
    }
    let digest = digest(&bytes, guid);
    bytes.extend_from_slice(&digest);
    bytes
}

/// Reads a saved state that fits `like`, an instance of the same export. Bytes come from files: everything is checked
/// but the limits of single variables.
pub(super) fn read(bytes: &[u8], guid: &Uuid, like: &Memory) -> Result<Memory> {
    let mut reader = Reader { bytes };
    reader.demand("magic", MAGIC)?;
    let version = u32::from_le_bytes(reader.take("version")?);
    if version != VERSION {
        return Err(refused("version", VERSION.to_string(), version.to_string()));
    }
    let found = Uuid::from_bytes(reader.take("identity")?);
    if found != *guid {
        return Err(refused("identity", guid.to_string(), found.to_string()));
    }
    for (place, count) in ["values", "inputs", "states", "lagging gusts"]
        .into_iter()
        .zip(counts(like))
    {
        let found = u32::from_le_bytes(reader.take(place)?);
        if found as usize != count {
            return Err(refused(place, count.to_string(), found.to_string()));
        }
    }
    let [state] = reader.take("state")?;
    let state = State::from_code(state)
        .ok_or_else(|| refused("state", "the code of a state", state.to_string()))?;
    let [set_up] = reader.take("experiment")?;
    let [start, stop, time] = [reader.number()?, reader.number()?, reader.number()?];
    let memory = Memory {
        state,
        experiment: experiment(set_up, start, stop)?,
        time,
        values: reader.numbers(like.values.len())?,
        input_rates: reader.numbers(like.input_rates.len())?,
        system: crate::response::SectionState {
            values: reader.numbers(like.system.values.len())?,
            gusts: reader.numbers(like.system.gusts.len())?,
            phase: reader.number()?,
            last_wind_m_s: Some(reader.number()?).filter(|wind| *wind >= 0.0),
        },
    };
    if !(0.0..1.0).contains(&memory.system.phase) {
        let found = memory.system.phase.to_string();
        return Err(refused("phase", "a number in [0, 1)", found));
    }
    let expected = digest(&bytes[..bytes.len() - reader.bytes.len()], guid);
    if reader.take("digest")? != expected {
        return Err(refused("digest", "that of the bytes before", "another"));
    }
    reader.demand("end", &[])?;
    Ok(memory)
}

fn experiment(code: u8, start: f64, stop: f64) -> Result<Option<RunTimes>> {
    match code {
        0 => Ok(None),
        1 => Ok(Some(RunTimes { start, stop: None })),
        3 => Ok(Some(RunTimes {
            start,
            stop: Some(stop),
        })),
        other => Err(refused("experiment", "0, 1 or 3", other.to_string())),
    }
}

fn refused(place: &str, expected: impl Into<String>, found: impl Into<String>) -> Error {
    Error::input(format!("serialised state: {place}"), expected, found)
}

struct Reader<'a> {
    bytes: &'a [u8],
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self, place: &str) -> Result<[u8; N]> {
        let Some((head, rest)) = self.bytes.split_first_chunk::<N>() else {
            let found = format!("only {} more", self.bytes.len());
            return Err(refused(place, format!("{N} more bytes"), found));
        };
        self.bytes = rest;
        Ok(*head)
    }

    /// The given bytes; no bytes stand for the end.
    fn demand(&mut self, place: &str, expected: &[u8]) -> Result<()> {
        if expected.is_empty() {
            return if self.bytes.is_empty() {
                Ok(())
            } else {
                let found = format!("{} more", self.bytes.len());
                Err(refused(place, "no more bytes", found))
            };
        }
        match self.bytes.strip_prefix(expected) {
            Some(rest) => {
                self.bytes = rest;
                Ok(())
            }
            None => Err(refused(
                place,
                String::from_utf8_lossy(expected),
                "other bytes",
            )),
        }
    }

    fn number(&mut self) -> Result<f64> {
        let number = f64::from_le_bytes(self.take("numbers")?);
        if number.is_finite() {
            Ok(number)
        } else {
            Err(refused("numbers", "finite numbers", number.to_string()))
        }
    }

    fn numbers(&mut self, count: usize) -> Result<Vec<f64>> {
        (0..count).map(|_| self.number()).collect()
    }
}
