//! Reading and setting variables.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::life::{check_count, places};
use crate::fmi2::guard::{Named, array, array_mut, guarded};
use crate::fmi2::types::{fmi2Component, fmi2Status, fmi2String, fmi2ValueReference};
use crate::instance::DataType;
use crate::lifecycle::Call;
use crate::refusal::Refusal;

/// Reads real variables, and the time.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFloat64(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    values: *mut f64,
    nValues: usize,
) -> fmi2Status {
    // SAFETY: handle and arrays are valid by the contract of the interface
    unsafe {
        guarded(c, Call::GetReal.by("GetFloat64"), |component| {
            let references = array(vr, nvr, "valueReferences")?;
            let values = array_mut(values, nValues, "values")?;
            let time = component.groups.time();
            if !references.contains(&time) {
                let places = component.groups.places(references)?;
                check_count("values", places.len(), values.len())?;
                return component.instance.reals(&places, values);
            }
            let mut rest = values;
            for reference in references {
                let own = [*reference];
                let of = if *reference == time {
                    None
                } else {
                    Some(component.groups.places(&own)?)
                };
                let count = of.as_ref().map_or(1, |of| of.len());
                let Some((now, behind)) = std::mem::take(&mut rest).split_at_mut_checked(count)
                else {
                    return check_count("values", nvr, nValues);
                };
                match of {
                    Some(places) => component.instance.reals(&places, now)?,
                    None => now[0] = component.instance.time_s(),
                }
                rest = behind;
            }
            check_count("values", nValues - rest.len(), nValues)
        })
    }
}

/// Sets real variables: all of them or, when one is refused, none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFloat64(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    values: *const f64,
    nValues: usize,
) -> fmi2Status {
    // SAFETY: handle and arrays are valid by the contract of the interface
    unsafe {
        guarded(c, Call::SetReal.by("SetFloat64"), |component| {
            let references = array(vr, nvr, "valueReferences")?;
            let values = array(values, nValues, "values")?;
            let places = component.groups.places(references)?;
            check_count("values", places.len(), values.len())?;
            component.instance.set_reals(&places, values)
        })
    }
}

/// Reads integer variables.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetInt32(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    values: *mut i32,
    nValues: usize,
) -> fmi2Status {
    // SAFETY: handle and arrays are valid by the contract of the interface
    unsafe {
        guarded(c, Call::GetInteger.by("GetInt32"), |component| {
            let places = places(component, vr, nvr, "valueReferences")?;
            check_count("values", places.len(), nValues)?;
            for (place, value) in places.iter().zip(array_mut(values, nValues, "values")?) {
                *value = component.instance.integer(*place)?;
            }
            Ok(())
        })
    }
}

/// Reads truth variables.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetBoolean(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    values: *mut bool,
    nValues: usize,
) -> fmi2Status {
    // SAFETY: handle and arrays are valid by the contract of the interface
    unsafe {
        guarded(c, Call::GetBoolean.by("GetBoolean"), |component| {
            let places = places(component, vr, nvr, "valueReferences")?;
            check_count("values", places.len(), nValues)?;
            // what the importer has there need not be a truth value yet
            for (place, value) in
                places
                    .iter()
                    .zip(array_mut(values.cast::<u8>(), nValues, "values")?)
            {
                *value = u8::from(component.instance.boolean(*place)?);
            }
            Ok(())
        })
    }
}

/// Reads texts; they live as long as the instance.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetString(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    values: *mut fmi2String,
    nValues: usize,
) -> fmi2Status {
    // SAFETY: handle and arrays are valid by the contract of the interface
    unsafe {
        guarded(c, Call::GetString.by("GetString"), |component| {
            let mut found = Vec::new();
            for reference in array(vr, nvr, "valueReferences")? {
                if let Some(names) = component.groups.names_at(*reference) {
                    found.extend(names.of.iter().map(|name| name.as_ptr()));
                    continue;
                }
                for place in component.groups.places(&[*reference])?.iter() {
                    let place = component.instance.text_place(*place)?;
                    found.push(component.texts[place].as_ptr());
                }
            }
            check_count("values", found.len(), nValues)?;
            array_mut(values, nValues, "values")?.copy_from_slice(&found);
            Ok(())
        })
    }
}

/// # Safety
/// `vr` is NULL or points to `nvr` references.
unsafe fn none_to_set(
    c: fmi2Component,
    call: Named<'_>,
    of_type: DataType,
    vr: *const fmi2ValueReference,
    nvr: usize,
) -> fmi2Status {
    // SAFETY: by the contract of this function
    unsafe {
        guarded(c, call, |component| {
            let places = places(component, vr, nvr, "valueReferences")?;
            component.instance.refuse_to_set(&places, of_type)
        })
    }
}

/// # Safety
/// As [`guarded`].
unsafe fn none_of_type(c: fmi2Component, call: Call, name: &str, nvr: usize) -> fmi2Status {
    // SAFETY: by the contract of this function
    unsafe {
        guarded(c, call.by(name), |_| match nvr {
            0 => Ok(()),
            found => Err(Refusal::error(format!(
                "there are no variables of this type, found {found} references"
            ))),
        })
    }
}

/// Functions that set variables of a type of which none may be set.
macro_rules! none_to_set {
    ($($name:ident, $short:literal, $call:ident, $data:ident, $type:ty;)*) => {$(
        /// There are none to set.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            c: fmi2Component,
            vr: *const fmi2ValueReference,
            nvr: usize,
            _values: *const $type,
            _nValues: usize,
        ) -> fmi2Status {
            // SAFETY: by the contract of the interface
            unsafe { none_to_set(c, Call::$call.by($short), DataType::$data, vr, nvr) }
        }
    )*};
}

none_to_set! {
    fmi3SetInt32, "SetInt32", SetInteger, Integer, i32;
    fmi3SetBoolean, "SetBoolean", SetBoolean, Boolean, bool;
    fmi3SetString, "SetString", SetString, String, fmi2String;
}

/// Functions for types of which there are no variables.
macro_rules! none_of_type {
    ($($get:ident, $set:ident, $short_get:literal, $short_set:literal, $type:ty;)*) => {$(
        /// There are no variables of this type.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $get(
            c: fmi2Component,
            _vr: *const fmi2ValueReference,
            nvr: usize,
            _values: *mut $type,
            _nValues: usize,
        ) -> fmi2Status {
            // SAFETY: by the contract of the interface
            unsafe { none_of_type(c, Call::GetInteger, $short_get, nvr) }
        }
        /// There are no variables of this type.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $set(
            c: fmi2Component,
            _vr: *const fmi2ValueReference,
            nvr: usize,
            _values: *const $type,
            _nValues: usize,
        ) -> fmi2Status {
            // SAFETY: by the contract of the interface
            unsafe { none_of_type(c, Call::SetInteger, $short_set, nvr) }
        }
    )*};
}

none_of_type! {
    fmi3GetFloat32, fmi3SetFloat32, "GetFloat32", "SetFloat32", f32;
    fmi3GetInt8, fmi3SetInt8, "GetInt8", "SetInt8", i8;
    fmi3GetUInt8, fmi3SetUInt8, "GetUInt8", "SetUInt8", u8;
    fmi3GetInt16, fmi3SetInt16, "GetInt16", "SetInt16", i16;
    fmi3GetUInt16, fmi3SetUInt16, "GetUInt16", "SetUInt16", u16;
    fmi3GetUInt32, fmi3SetUInt32, "GetUInt32", "SetUInt32", u32;
    fmi3GetInt64, fmi3SetInt64, "GetInt64", "SetInt64", i64;
}

/// There are no binary variables.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetBinary(
    c: fmi2Component,
    _vr: *const fmi2ValueReference,
    nvr: usize,
    _valueSizes: *mut usize,
    _values: *mut *const u8,
    _nValues: usize,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { none_of_type(c, Call::GetInteger, "GetBinary", nvr) }
}

/// There are no binary variables.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetBinary(
    c: fmi2Component,
    _vr: *const fmi2ValueReference,
    nvr: usize,
    _valueSizes: *const usize,
    _values: *const *const u8,
    _nValues: usize,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { none_of_type(c, Call::SetInteger, "SetBinary", nvr) }
}

/// There are no clocks.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetClock(
    c: fmi2Component,
    _vr: *const fmi2ValueReference,
    nvr: usize,
    _values: *mut bool,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { none_of_type(c, Call::GetInteger, "GetClock", nvr) }
}

/// There are no clocks.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetClock(
    c: fmi2Component,
    _vr: *const fmi2ValueReference,
    nvr: usize,
    _values: *const bool,
) -> fmi2Status {
    // SAFETY: by the contract of the interface
    unsafe { none_of_type(c, Call::SetInteger, "SetClock", nvr) }
}
