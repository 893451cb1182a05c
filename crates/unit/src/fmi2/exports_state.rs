//! Saved states and directional derivatives.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::guard::{array, array_mut, exported, target};
use super::types::{fmi2Byte, fmi2FMUstate, fmi2Real, fmi2ValueReference};
use crate::instance::Memory;
use crate::lifecycle::Call;
use crate::refusal::{CallResult, Refusal};

/// # Safety
/// NULL, or a saved state made here and not freed.
unsafe fn snapshot<'a>(state: fmi2FMUstate) -> CallResult<&'a mut Memory> {
    // SAFETY: by the contract of this function
    unsafe { target(state.cast::<Memory>(), "FMUstate") }
}

fn handle(snapshot: Memory) -> fmi2FMUstate {
    Box::into_raw(Box::new(snapshot)).cast()
}

exported! {
    /// Saves the state, into the given one or, where that is NULL, a new one.
    fmi2GetFMUstate(FMUstate: *mut fmi2FMUstate) Call::GetFMUstate => |component| {
        let state = target(FMUstate, "FMUstate")?;
        if state.is_null() {
            *state = handle(component.instance.snapshot());
        } else {
            *snapshot(*state)? = component.instance.snapshot();
        }
        Ok(())
    };
    /// Goes back to a saved state.
    fmi2SetFMUstate(FMUstate: fmi2FMUstate) Call::SetFMUstate =>
        |component| component.instance.restore(snapshot(FMUstate)?);
    /// Frees a saved state and sets it to NULL; NULL is ignored.
    fmi2FreeFMUstate(FMUstate: *mut fmi2FMUstate) Call::FreeFMUstate => |_| {
        if let Some(state) = FMUstate.as_mut()
            && !state.is_null()
        {
            drop(Box::from_raw(state.cast::<Memory>()));
            *state = std::ptr::null_mut();
        }
        Ok(())
    };
    /// Length in bytes of a serialised state.
    fmi2SerializedFMUstateSize(FMUstate: fmi2FMUstate, size: *mut usize) Call::SerializedFMUstateSize => |component| {
        snapshot(FMUstate)?;
        *target(size, "size")? = component.instance.serialized_length();
        Ok(())
    };
    /// Writes a saved state as bytes.
    fmi2SerializeFMUstate(
        FMUstate: fmi2FMUstate, serializedState: *mut fmi2Byte, size: usize
    ) Call::SerializeFMUstate => |component| {
        let bytes = component.instance.serialize(snapshot(FMUstate)?)?;
        let room = array_mut(serializedState.cast::<u8>(), size, "serializedState")?;
        let length = bytes.len();
        let room = room.get_mut(..length).ok_or_else(|| {
            Refusal::error(format!(
                "size: expected room for {length} bytes, found {size}"
            ))
        })?;
        room.copy_from_slice(&bytes);
        Ok(())
    };
    /// Reads a saved state from bytes into a new one.
    fmi2DeSerializeFMUstate(
        serializedState: *const fmi2Byte, size: usize, FMUstate: *mut fmi2FMUstate
    ) Call::DeSerializeFMUstate => |component| {
        let bytes = array(serializedState.cast::<u8>(), size, "serializedState")?;
        let state = target(FMUstate, "FMUstate")?;
        *state = handle(component.instance.deserialize(bytes)?);
        Ok(())
    };
    /// `Σ (∂unknown/∂known) dvKnown`.
    fmi2GetDirectionalDerivative(
        vUnknown_ref: *const fmi2ValueReference, nUnknown: usize, vKnown_ref: *const fmi2ValueReference,
        nKnown: usize, dvKnown: *const fmi2Real, dvUnknown: *mut fmi2Real
    ) Call::GetDirectionalDerivative => |component| {
        component.instance.directional_derivative(
            array(vUnknown_ref, nUnknown, "vUnknown_ref")?,
            array(vKnown_ref, nKnown, "vKnown_ref")?,
            array(dvKnown, nKnown, "dvKnown")?,
            array_mut(dvUnknown, nUnknown, "dvUnknown")?,
        )
    };
}
