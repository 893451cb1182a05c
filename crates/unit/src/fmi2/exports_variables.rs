//! Reading and setting variables.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::guard::{array, array_mut, guarded};
use super::types::{
    fmi2Boolean, fmi2Component, fmi2Integer, fmi2Real, fmi2Status, fmi2String, fmi2ValueReference,
};
use crate::instance::DataType;
use crate::lifecycle::Call;

/// Reads real variables.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: handle and arrays are valid by the contract of the interface
    unsafe {
        guarded(c, Call::GetReal, |component| {
            let references = array(vr, nvr, "vr")?;
            let values = array_mut(value, nvr, "value")?;
            component.instance.reals(references, values)
        })
    }
}

/// Reads integer variables.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetInteger(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2Integer,
) -> fmi2Status {
    // SAFETY: handle and arrays are valid by the contract of the interface
    unsafe {
        guarded(c, Call::GetInteger, |component| {
            let references = array(vr, nvr, "vr")?;
            for (reference, value) in references.iter().zip(array_mut(value, nvr, "value")?) {
                *value = component.instance.integer(*reference)?;
            }
            Ok(())
        })
    }
}

/// Reads truth variables.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBoolean(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2Boolean,
) -> fmi2Status {
    // SAFETY: handle and arrays are valid by the contract of the interface
    unsafe {
        guarded(c, Call::GetBoolean, |component| {
            let references = array(vr, nvr, "vr")?;
            for (reference, value) in references.iter().zip(array_mut(value, nvr, "value")?) {
                *value = fmi2Boolean::from(component.instance.boolean(*reference)?);
            }
            Ok(())
        })
    }
}

/// Reads texts; they live as long as the instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetString(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2String,
) -> fmi2Status {
    // SAFETY: handle and arrays are valid by the contract of the interface
    unsafe {
        guarded(c, Call::GetString, |component| {
            let references = array(vr, nvr, "vr")?;
            for (reference, value) in references.iter().zip(array_mut(value, nvr, "value")?) {
                let place = component.instance.text_place(*reference)?;
                *value = component.texts[place].as_ptr();
            }
            Ok(())
        })
    }
}

/// Sets real variables: all of them or, when one is refused, none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *const fmi2Real,
) -> fmi2Status {
    // SAFETY: handle and arrays are valid by the contract of the interface
    unsafe {
        guarded(c, Call::SetReal, |component| {
            let references = array(vr, nvr, "vr")?;
            let values = array(value, nvr, "value")?;
            component.instance.set_reals(references, values)
        })
    }
}

/// Sets integer variables: there are none to set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetInteger(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    _value: *const fmi2Integer,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { set_none(c, Call::SetInteger, DataType::Integer, vr, nvr) }
}

/// Sets truth variables: there are none to set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetBoolean(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    _value: *const fmi2Boolean,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { set_none(c, Call::SetBoolean, DataType::Boolean, vr, nvr) }
}

/// Sets texts: there are none to set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetString(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    _value: *const fmi2String,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { set_none(c, Call::SetString, DataType::String, vr, nvr) }
}

/// # Safety
/// As [`guarded`]; `vr` points to `nvr` references.
unsafe fn set_none(
    c: fmi2Component,
    call: Call,
    of_type: DataType,
    vr: *const fmi2ValueReference,
    nvr: usize,
) -> fmi2Status {
    // SAFETY: by the contract of this function
    unsafe {
        guarded(c, call, |component| {
            let references = array(vr, nvr, "vr")?;
            component.instance.refuse_to_set(references, of_type)
        })
    }
}
