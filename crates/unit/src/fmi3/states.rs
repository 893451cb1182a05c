//! Saved states and derivatives.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::life::{check_count, indices};
use crate::fmi2::guard::{array, array_mut, exported};
use crate::fmi2::types::{fmi2FMUstate, fmi2ValueReference};
use crate::instance::derivatives::{check_derivatives, check_seed};
use crate::lifecycle::Call;

as_in_fmi2! {
    /// Saves the state, into the given one or, where that is NULL, a new one.
    fmi3GetFMUState(state: *mut fmi2FMUstate) => fmi2GetFMUstate(state);
    /// Goes back to a saved state.
    fmi3SetFMUState(state: fmi2FMUstate) => fmi2SetFMUstate(state);
    /// Frees a saved state and sets it to NULL; NULL is ignored.
    fmi3FreeFMUState(state: *mut fmi2FMUstate) => fmi2FreeFMUstate(state);
    /// Length in bytes of a serialised state.
    fmi3SerializedFMUStateSize(
        state: fmi2FMUstate, size: *mut usize
    ) => fmi2SerializedFMUstateSize(state, size);
    /// Writes a saved state as bytes.
    fmi3SerializeFMUState(
        state: fmi2FMUstate, serializedState: *mut u8, size: usize
    ) => fmi2SerializeFMUstate(state, serializedState.cast(), size);
    /// Reads a saved state from bytes into a new one.
    fmi3DeserializeFMUState(
        serializedState: *const u8, size: usize, state: *mut fmi2FMUstate
    ) => fmi2DeSerializeFMUstate(serializedState.cast(), size, state);
}

exported! {
    /// `Σ (∂unknown/∂known) seed`.
    fmi3GetDirectionalDerivative(
        unknowns: *const fmi2ValueReference, nUnknowns: usize, knowns: *const fmi2ValueReference,
        nKnowns: usize, seed: *const f64, nSeed: usize, sensitivity: *mut f64, nSensitivity: usize
    ) Call::GetDirectionalDerivative => |component| {
        let unknowns = indices(component, unknowns, nUnknowns, "unknowns")?;
        let knowns = indices(component, knowns, nKnowns, "knowns")?;
        check_count("seed", knowns.len(), nSeed)?;
        check_count("sensitivity", unknowns.len(), nSensitivity)?;
        component.instance.directional_derivative(
            &unknowns,
            &knowns,
            array(seed, nSeed, "seed")?,
            array_mut(sensitivity, nSensitivity, "sensitivity")?,
        )
    };
    /// `Σ seed (∂unknown/∂known)`, for each known.
    fmi3GetAdjointDerivative(
        unknowns: *const fmi2ValueReference, nUnknowns: usize, knowns: *const fmi2ValueReference,
        nKnowns: usize, seed: *const f64, nSeed: usize, sensitivity: *mut f64, nSensitivity: usize
    ) Call::GetDirectionalDerivative => |component| {
        let unknowns = indices(component, unknowns, nUnknowns, "unknowns")?;
        let knowns = indices(component, knowns, nKnowns, "knowns")?;
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
    };
}
