//! Snapshots: plain clones of everything that changes, and the same as bytes.

use super::layout::Source;
use super::memory::Memory;
use super::{Instance, serialized};
use crate::fmu::refusal::{Answer, Refusal};
use uuid::Uuid;

/// A saved state of an instance.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    guid: Uuid,
    memory: Memory,
}

impl Instance {
    /// A copy of everything that changes.
    pub fn snapshot(&self) -> Snapshot {
        Snapshot {
            guid: self.resources.guid,
            memory: self.memory.clone(),
        }
    }

    /// Copies everything that changes into an existing snapshot.
    pub fn snapshot_into(&self, snapshot: &mut Snapshot) {
        snapshot.guid = self.resources.guid;
        snapshot.memory.clone_from(&self.memory);
    }

    /// Goes back to a snapshot.
    ///
    /// # Errors
    /// A snapshot of another model.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Answer<()> {
        self.check_owner(snapshot)?;
        self.replace_memory(snapshot.memory.clone());
        Ok(())
    }

    pub(super) fn check_owner(&self, snapshot: &Snapshot) -> Answer<()> {
        let own = self.resources.guid;
        if snapshot.guid == own {
            Ok(())
        } else {
            Err(Refusal::error(format!(
                "saved state: expected one of the model {own}, found one of {}",
                snapshot.guid
            )))
        }
    }

    /// Whatever the parameters of both memories share stays computed.
    pub(super) fn replace_memory(&mut self, mut memory: Memory) {
        let same = |source: Source, a: &[f64], b: &[f64]| {
            (0..a.len())
                .filter(|place| self.layout.source(*place) == source)
                .all(|place| a[place].to_bits() == b[place].to_bits())
        };
        let same_section = same(Source::Section, &memory.values, &self.memory.values);
        let same_limit = same(Source::Limit, &memory.values, &self.memory.values);
        if !same_section {
            self.stepper = None;
        }
        self.onset_current &= same_section && same_limit;
        self.growth_known &= same_section && same_limit;
        if self.onset_current {
            for place in 0..memory.values.len() {
                if self.layout.source(place) == Source::Calculated {
                    memory.values[place] = self.memory.values[place];
                }
            }
        }
        self.memory = memory;
        self.release_pending = true;
        self.outputs_current = false;
    }

    /// Length in bytes of a serialised state.
    pub fn serialized_length(&self) -> usize {
        serialized::length(&self.memory)
    }

    /// A snapshot as bytes.
    ///
    /// # Errors
    /// A snapshot of another model.
    pub fn serialize(&self, snapshot: &Snapshot) -> Answer<Vec<u8>> {
        self.check_owner(snapshot)?;
        Ok(serialized::write(&snapshot.memory, &snapshot.guid))
    }

    /// A snapshot from bytes.
    ///
    /// # Errors
    /// Bytes that are no state of this export, or hold a value outside the limits of its variable.
    pub fn deserialize(&self, bytes: &[u8]) -> Answer<Snapshot> {
        let guid = self.resources.guid;
        let mut memory = serialized::read(bytes, &guid, &self.fresh)
            .map_err(|e| Refusal::call(e.to_string()))?;
        for (place, value) in memory.values.iter_mut().enumerate() {
            if self.layout.source(place) == Source::Constant {
                *value = self.fresh.values[place];
            }
            self.check_stored(place, *value)?;
        }
        Ok(Snapshot { guid, memory })
    }
}
