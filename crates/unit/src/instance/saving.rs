//! Saved states of an instance: plain clones of its memory, and the same as bytes.

use super::layout::Source;
use super::memory::Memory;
use super::{Instance, serialized};
use crate::refusal::{CallResult, Refusal};

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
        serialized::length(&self.now.memory)
    }

    /// A snapshot as bytes.
    ///
    /// # Errors
    /// A snapshot of another model.
    pub fn serialize(&self, snapshot: &Memory) -> CallResult<Vec<u8>> {
        self.check_owner(snapshot)?;
        Ok(serialized::write(snapshot))
    }

    /// A snapshot from bytes.
    ///
    /// # Errors
    /// Bytes that are no state of this export, or hold a value outside the limits of its variable.
    pub fn deserialize(&self, bytes: &[u8]) -> CallResult<Memory> {
        let mut memory =
            serialized::read(bytes, &self.fresh).map_err(|e| Refusal::call(e.to_string()))?;
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
