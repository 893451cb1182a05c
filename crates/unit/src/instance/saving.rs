//! Saved states of an instance: plain clones of its memory, and the same as bytes: little-endian, versioned, tied to one export by its
//! identity.
//!
//! ```text
//! magic "AERODECK" · version u32 · identity 16 bytes · number of values, inputs, states, lagging gusts u32 each
//! state code u8 · experiment u8 (bit 0: set up, bit 1: with a stop time) · start, stop, time f64
//! values f64… · input rates f64… · section state f64… · lagging gusts f64… · phase f64 · last wind f64 (-1 for none)
//! digest of all bytes before, 16 bytes
//! ```

use super::Instance;
use super::layout::Source;
use super::memory::Memory;
use crate::error::{Error, Result};
use crate::lifecycle::State;
use crate::refusal::{CallResult, Refusal};
use crate::response::SectionState;
use uuid::Uuid;

impl Instance {
    /// A copy of everything that changes.
    pub fn snapshot(&self) -> Memory {
        self.now.memory.clone()
    }

    /// Goes back to a snapshot.
    ///
    /// # Errors
    /// A snapshot of another model.
    pub fn restore(&mut self, snapshot: &Memory) -> CallResult<()> {
        self.check_owner(snapshot)?;
        self.replace_memory(snapshot.clone());
        Ok(())
    }

    pub(super) fn check_owner(&self, snapshot: &Memory) -> CallResult<()> {
        let own = self.now.resources.guid;
        if snapshot.guid != own {
            return Err(Refusal::error(format!(
                "saved state: expected one of the model {own}, found one of {}",
                snapshot.guid
            )));
        }
        let numbers = [&self.now.memory, snapshot].map(|m| m.values.len());
        if numbers[0] != numbers[1] {
            return Err(Refusal::error(format!(
                "saved state: expected one of as many strips, {} numbers, found {}",
                numbers[0], numbers[1]
            )));
        }
        let of = snapshot.state.interface();
        match of.filter(|of| *of != self.interface) {
            None => Ok(()),
            Some(of) => Err(Refusal::error(format!(
                "saved state: expected one of {}, found one of {}",
                self.interface.name(),
                of.name()
            ))),
        }
    }

    /// Whatever the parameters of both memories share stays computed.
    pub(super) fn replace_memory(&mut self, mut memory: Memory) {
        let (layout, old) = (&self.layout, &self.now.memory);
        let same = [Source::Section, Source::Limit].map(|source| {
            let mut each = old.values.iter().zip(&memory.values).zip(&layout.access);
            each.all(|((a, b), access)| access.source != source || a.to_bits() == b.to_bits())
        });
        self.unit.replace(&mut memory, same);
        self.now.memory = memory;
        self.outputs_current = false;
    }

    /// Length in bytes of a serialised state.
    pub(crate) fn serialized_length(&self) -> usize {
        length(&self.now.memory)
    }

    /// A snapshot as bytes.
    ///
    /// # Errors
    /// A snapshot of another model.
    pub fn serialize(&self, snapshot: &Memory) -> CallResult<Vec<u8>> {
        self.check_owner(snapshot)?;
        Ok(write(snapshot))
    }

    /// A snapshot from bytes.
    ///
    /// # Errors
    /// Bytes that are no state of this export, or hold a value outside the limits of its variable.
    pub fn deserialize(&self, bytes: &[u8]) -> CallResult<Memory> {
        let mut memory = read(bytes, &self.fresh).map_err(|e| Refusal::call(e.to_string()))?;
        for (index, value) in memory.values.iter_mut().enumerate() {
            let access = self.layout.access[index];
            if access.source == Source::Constant {
                *value = self.fresh.values[index];
            }
            let within_limits = self.check_value(index, access, *value);
            within_limits
                .map_err(|why| Refusal::call(format!("serialised state: {}", why.message)))?;
        }
        Ok(memory)
    }
}

const MAGIC: &[u8; 8] = b"AERODECK";
const VERSION: u32 = 3;
/// Stands for no last wind.
const NO_WIND: f64 = -1.0;
const HEADER: usize = 8 + 4 + 16 + 4 * 4 + 2;
const DIGEST: usize = 16;

/// Length in bytes of every saved state of an instance with this memory.
fn length(memory: &Memory) -> usize {
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
fn write(memory: &Memory) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(length(memory));
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&VERSION.to_le_bytes());
    bytes.extend_from_slice(memory.guid.as_bytes());
    for count in counts(memory) {
        bytes.extend_from_slice(&(count as u32).to_le_bytes());
    }
    bytes.push(memory.state as u8);
    let (set_up, stop) = match memory.experiment {
        None => (0, None),
        Some((_, stop)) => (1 + 2 * u8::from(stop.is_some()), stop),
    };
    bytes.push(set_up);
    let start = memory.experiment.map_or(0.0, |(start, _)| start);
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
    let digest = digest(&bytes, &memory.guid);
    bytes.extend_from_slice(&digest);
    bytes
}

/// What stands behind a header that is that of `like`, an instance of the same export.
fn behind_header<'a>(bytes: &'a [u8], like: &Memory) -> Result<&'a [u8]> {
    let rest = bytes.strip_prefix(MAGIC);
    let mut rest =
        rest.ok_or_else(|| refused("magic", String::from_utf8_lossy(MAGIC), "other bytes"))?;
    let version = u32::from_le_bytes(take(&mut rest, "version")?);
    if version != VERSION {
        return Err(refused("version", VERSION.to_string(), version.to_string()));
    }
    let found = Uuid::from_bytes(take(&mut rest, "identity")?);
    if found != like.guid {
        return Err(refused(
            "identity",
            like.guid.to_string(),
            found.to_string(),
        ));
    }
    for (place, count) in ["values", "inputs", "states", "lagging gusts"]
        .into_iter()
        .zip(counts(like))
    {
        let found = u32::from_le_bytes(take(&mut rest, place)?);
        if found as usize != count {
            return Err(refused(place, count.to_string(), found.to_string()));
        }
    }
    Ok(rest)
}

/// Reads a saved state that fits `like`, an instance of the same export. Bytes come from files: everything is checked
/// but the limits of single variables.
fn read(bytes: &[u8], like: &Memory) -> Result<Memory> {
    let mut rest = behind_header(bytes, like)?;
    let [state] = take(&mut rest, "state")?;
    let state = State::from_code(state)
        .ok_or_else(|| refused("state", "the code of a state", state.to_string()))?;
    let [set_up] = take(&mut rest, "experiment")?;
    let [start, stop, time] = [number(&mut rest)?, number(&mut rest)?, number(&mut rest)?];
    let memory = Memory {
        guid: like.guid,
        state,
        experiment: match set_up {
            0 => None,
            1 => Some((start, None)),
            3 => Some((start, Some(stop))),
            other => return Err(refused("experiment", "0, 1 or 3", other.to_string())),
        },
        time,
        values: numbers(&mut rest, like.values.len())?,
        input_rates: numbers(&mut rest, like.input_rates.len())?,
        system: SectionState {
            values: numbers(&mut rest, like.system.values.len())?,
            gusts: numbers(&mut rest, like.system.gusts.len())?,
            phase: number(&mut rest)?,
            last_wind_m_s: Some(number(&mut rest)?).filter(|wind| *wind >= 0.0),
        },
    };
    if !(0.0..1.0).contains(&memory.system.phase) {
        let found = memory.system.phase.to_string();
        return Err(refused("phase", "a number in [0, 1)", found));
    }
    let expected = digest(&bytes[..bytes.len() - rest.len()], &like.guid);
    if take(&mut rest, "digest")? != expected {
        return Err(refused("digest", "that of the bytes before", "another"));
    }
    match rest.len() {
        0 => Ok(memory),
        more => Err(refused("end", "no more bytes", format!("{more} more"))),
    }
}

fn refused(place: &str, expected: impl Into<String>, found: impl Into<String>) -> Error {
    Error::input(format!("serialised state: {place}"), expected, found)
}

/// Takes the first bytes of what is left.
fn take<const N: usize>(rest: &mut &[u8], place: &str) -> Result<[u8; N]> {
    let Some((head, behind)) = rest.split_first_chunk::<N>() else {
        let found = format!("only {} more", rest.len());
        return Err(refused(place, format!("{N} more bytes"), found));
    };
    *rest = behind;
    Ok(*head)
}

fn number(rest: &mut &[u8]) -> Result<f64> {
    let number = f64::from_le_bytes(take(rest, "numbers")?);
    if number.is_finite() {
        Ok(number)
    } else {
        Err(refused("numbers", "finite numbers", number.to_string()))
    }
}

fn numbers(rest: &mut &[u8], count: usize) -> Result<Vec<f64>> {
    (0..count).map(|_| number(rest)).collect()
}
