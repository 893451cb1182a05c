//! Saved states and directional derivatives.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::guard::{array, array_mut, guarded, place};
use super::types::{
    fmi2Byte, fmi2Component, fmi2FMUstate, fmi2Real, fmi2Status, fmi2ValueReference,
};
use crate::instance::Snapshot;
use crate::lifecycle::Call;
use crate::refusal::{CallResult, Refusal};

/// # Safety
/// NULL, or a saved state made here and not freed.
unsafe fn snapshot<'a>(state: fmi2FMUstate) -> CallResult<&'a mut Snapshot> {
    // SAFETY: by the contract of this function
    unsafe { place(state.cast::<Snapshot>(), "FMUstate") }
}

fn handle(snapshot: Snapshot) -> fmi2FMUstate {
    Box::into_raw(Box::new(snapshot)).cast()
}

/// Saves the state, into the given one or, where that is NULL, a new one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(
    c: fmi2Component,
    FMUstate: *mut fmi2FMUstate,
) -> fmi2Status {
    // SAFETY: handles are valid by the contract of the interface
    unsafe {
        guarded(c, Call::GetFMUstate, |component| {
            let state = place(FMUstate, "FMUstate")?;
            if state.is_null() {
                *state = handle(component.instance.snapshot());
            } else {
                component.instance.snapshot_into(snapshot(*state)?);
            }
            Ok(())
        })
    }
}

/// Goes back to a saved state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetFMUstate(c: fmi2Component, FMUstate: fmi2FMUstate) -> fmi2Status {
    // SAFETY: handles are valid by the contract of the interface
    unsafe {
        guarded(c, Call::SetFMUstate, |component| {
            component.instance.restore(snapshot(FMUstate)?)
        })
    }
}

/// Frees a saved state and sets it to NULL; NULL is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(
    c: fmi2Component,
    FMUstate: *mut fmi2FMUstate,
) -> fmi2Status {
    // SAFETY: handles are valid by the contract of the interface
    unsafe {
        guarded(c, Call::FreeFMUstate, |_| {
            if let Some(state) = FMUstate.as_mut()
                && !state.is_null()
            {
                drop(Box::from_raw(state.cast::<Snapshot>()));
                *state = std::ptr::null_mut();
            }
            Ok(())
        })
    }
}

/// Length in bytes of a serialised state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(
    c: fmi2Component,
    FMUstate: fmi2FMUstate,
    size: *mut usize,
) -> fmi2Status {
    // SAFETY: handles and pointers are valid by the contract of the interface
    unsafe {
        guarded(c, Call::SerializedFMUstateSize, |component| {
            snapshot(FMUstate)?;
            *place(size, "size")? = component.instance.serialized_length();
            Ok(())
        })
    }
}

/// Writes a saved state as bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    c: fmi2Component,
    FMUstate: fmi2FMUstate,
    serializedState: *mut fmi2Byte,
    size: usize,
) -> fmi2Status {
    // SAFETY: handles and arrays are valid by the contract of the interface
    unsafe {
        guarded(c, Call::SerializeFMUstate, |component| {
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
        })
    }
}

/// Reads a saved state from bytes into a new one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    c: fmi2Component,
    serializedState: *const fmi2Byte,
    size: usize,
    FMUstate: *mut fmi2FMUstate,
) -> fmi2Status {
    // SAFETY: handles and arrays are valid by the contract of the interface
    unsafe {
        guarded(c, Call::DeSerializeFMUstate, |component| {
            let bytes = array(serializedState.cast::<u8>(), size, "serializedState")?;
            let state = place(FMUstate, "FMUstate")?;
            *state = handle(component.instance.deserialize(bytes)?);
            Ok(())
        })
    }
}

/// `Σ (∂unknown/∂known) dvKnown`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDirectionalDerivative(
    c: fmi2Component,
    vUnknown_ref: *const fmi2ValueReference,
    nUnknown: usize,
    vKnown_ref: *const fmi2ValueReference,
    nKnown: usize,
    dvKnown: *const fmi2Real,
    dvUnknown: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: handle and arrays are valid by the contract of the interface
    unsafe {
        guarded(c, Call::GetDirectionalDerivative, |component| {
            component.instance.directional_derivative(
                array(vUnknown_ref, nUnknown, "vUnknown_ref")?,
                array(vKnown_ref, nKnown, "vKnown_ref")?,
                array(dvKnown, nKnown, "dvKnown")?,
                array_mut(dvUnknown, nUnknown, "dvUnknown")?,
            )
        })
    }
}
