//! Saving, restoring and serialising the state of an instance.

use super::{FmuComponent, Slave};
use crate::error::{Result, ensure};
use crate::library::StatePointer;
use std::rc::Rc;

/// A saved state of an instance.
pub struct FmuState {
    pointer: StatePointer,
    core: Rc<FmuComponent>,
}

impl Drop for FmuState {
    fn drop(&mut self) {
        if !self.core.fatal.get() {
            // SAFETY: a state of this component, which still lives
            unsafe {
                (self.core.binary.shared.free_fmu_state)(self.core.component, &mut self.pointer);
            }
        }
    }
}

impl Slave {
    /// `fmi2GetFMUstate`.
    pub(crate) fn get_state(&self) -> Result<FmuState> {
        let mut pointer: StatePointer = std::ptr::null_mut();
        // SAFETY: the component lives, and the state is its own
        self.good("GetFMUstate", |f, c| unsafe {
            (f.shared.get_fmu_state)(c, &mut pointer)
        })?;
        Ok(self.state(pointer))
    }

    fn state(&self, pointer: StatePointer) -> FmuState {
        FmuState {
            pointer,
            core: Rc::clone(&self.core),
        }
    }

    /// `fmi2SetFMUstate`, for a state of this instance.
    ///
    /// # Errors
    /// [`Error::Input`] for a state of another instance.
    pub(crate) fn set_state(&mut self, state: &FmuState) -> Result<()> {
        self.own(state)?;
        // SAFETY: the component lives, and the state is its own
        self.good("SetFMUstate", |f, c| unsafe {
            (f.shared.set_fmu_state)(c, state.pointer)
        })
    }

    fn own(&self, state: &FmuState) -> Result<()> {
        let is_own = Rc::ptr_eq(&self.core, &state.core);
        let expected = "a state of this instance";
        ensure(is_own, "FMU state", expected, "one of another")
    }

    /// `fmi2SerializeFMUstate`: the state as bytes.
    ///
    /// # Errors
    /// [`Error::Input`] for a state of another instance.
    pub(crate) fn serialize_state(&self, state: &FmuState) -> Result<Vec<u8>> {
        self.own(state)?;
        let mut size = 0;
        // SAFETY: the component lives, and the state is its own
        self.good("SerializedFMUstateSize", |f, c| unsafe {
            (f.shared.serialized_fmu_state_size)(c, state.pointer, &mut size)
        })?;
        let mut bytes = vec![0; size];
        // SAFETY: the component lives, and the state is its own
        self.good("SerializeFMUstate", |f, c| unsafe {
            (f.shared.serialize_fmu_state)(c, state.pointer, bytes.as_mut_ptr(), size)
        })?;
        Ok(bytes)
    }

    /// `fmi2DeSerializeFMUstate`: bytes of an instance of the same FMU as a state of this one.
    pub(crate) fn deserialize_state(&self, bytes: &[u8]) -> Result<FmuState> {
        let mut pointer: StatePointer = std::ptr::null_mut();
        // SAFETY: the component lives, and the state is its own
        self.good("DeSerializeFMUstate", |f, c| unsafe {
            (f.shared.de_serialize_fmu_state)(c, bytes.as_ptr(), bytes.len(), &mut pointer)
        })?;
        Ok(self.state(pointer))
    }
}
