//! Saved states and derivatives.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::life::{check_count, places};
use crate::fmi2::guard::{array, array_mut, guarded};
use crate::fmi2::types::{fmi2Component, fmi2FMUstate, fmi2Status, fmi2ValueReference};
use crate::fmi2::{
    fmi2DeSerializeFMUstate, fmi2FreeFMUstate, fmi2GetFMUstate, fmi2SerializeFMUstate,
    fmi2SerializedFMUstateSize, fmi2SetFMUstate,
};
use crate::instance::derivatives::{check_derivatives, check_seed};
use crate::lifecycle::Call;

/// Saves the state, into the given one or, where that is NULL, a new one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(c: fmi2Component, state: *mut fmi2FMUstate) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { fmi2GetFMUstate(c, state) }
}

/// Goes back to a saved state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFMUState(c: fmi2Component, state: fmi2FMUstate) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { fmi2SetFMUstate(c, state) }
}

/// Frees a saved state and sets it to NULL; NULL is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeFMUState(
    c: fmi2Component,
    state: *mut fmi2FMUstate,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { fmi2FreeFMUstate(c, state) }
}

/// Length in bytes of a serialised state.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializedFMUStateSize(
    c: fmi2Component,
    state: fmi2FMUstate,
    size: *mut usize,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { fmi2SerializedFMUstateSize(c, state, size) }
}

/// Writes a saved state as bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializeFMUState(
    c: fmi2Component,
    state: fmi2FMUstate,
    serializedState: *mut u8,
    size: usize,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { fmi2SerializeFMUstate(c, state, serializedState.cast(), size) }
}

/// Reads a saved state from bytes into a new one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DeserializeFMUState(
    c: fmi2Component,
    serializedState: *const u8,
    size: usize,
    state: *mut fmi2FMUstate,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { fmi2DeSerializeFMUstate(c, serializedState.cast(), size, state) }
}

/// `Σ (∂unknown/∂known) seed`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetDirectionalDerivative(
    c: fmi2Component,
    unknowns: *const fmi2ValueReference,
    nUnknowns: usize,
    knowns: *const fmi2ValueReference,
    nKnowns: usize,
    seed: *const f64,
    nSeed: usize,
    sensitivity: *mut f64,
    nSensitivity: usize,
) -> fmi2Status {
    // SAFETY: handle and arrays are valid by the contract of the interface
    unsafe {
        guarded(c, Call::GetDirectionalDerivative, |component| {
            let unknowns = places(component, unknowns, nUnknowns, "unknowns")?;
            let knowns = places(component, knowns, nKnowns, "knowns")?;
            check_count("seed", knowns.len(), nSeed)?;
            check_count("sensitivity", unknowns.len(), nSensitivity)?;
            component.instance.directional_derivative(
                &unknowns,
                &knowns,
                array(seed, nSeed, "seed")?,
                array_mut(sensitivity, nSensitivity, "sensitivity")?,
            )
        })
    }
}

/// `Σ seed (∂unknown/∂known)`, for each known.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetAdjointDerivative(
    c: fmi2Component,
    unknowns: *const fmi2ValueReference,
    nUnknowns: usize,
    knowns: *const fmi2ValueReference,
    nKnowns: usize,
    seed: *const f64,
    nSeed: usize,
    sensitivity: *mut f64,
    nSensitivity: usize,
) -> fmi2Status {
    // SAFETY: handle and arrays are valid by the contract of the interface
    unsafe {
        guarded(
            c,
            Call::GetDirectionalDerivative.by("GetAdjointDerivative"),
            |component| {
                let unknowns = places(component, unknowns, nUnknowns, "unknowns")?;
                let knowns = places(component, knowns, nKnowns, "knowns")?;
                check_count("seed", unknowns.len(), nSeed)?;
                check_count("sensitivity", knowns.len(), nSensitivity)?;
                let seed = array(seed, nSeed, "seed")?;
                check_seed(seed)?;
                let mut column = vec![0.0; unknowns.len()];
                let mut found = Vec::with_capacity(knowns.len());
                for known in &knowns {
                    let instance = &mut component.instance;
                    instance.directional_derivative(&unknowns, &[*known], &[1.0], &mut column)?;
                    found.push(seed.iter().zip(&column).map(|(s, x)| s * x).sum());
                }
                check_derivatives(&found)?;
                array_mut(sensitivity, nSensitivity, "sensitivity")?.copy_from_slice(&found);
                Ok(())
            },
        )
    }
}
