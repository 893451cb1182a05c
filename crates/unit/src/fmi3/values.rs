//! Reading and setting variables.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::life::{check_count, indices};
use crate::fmi2::guard::{array, array_mut, exported};
use crate::fmi2::types::{fmi2String, fmi2ValueReference};
use crate::instance::DataType;
use crate::lifecycle::Call;
use crate::refusal::{CallResult, Refusal};

exported! {
    /// Reads real variables, and the time.
    fmi3GetFloat64(
        vr: *const fmi2ValueReference, nvr: usize, values: *mut f64, nValues: usize
    ) Call::GetReal => |component| {
        let references = array(vr, nvr, "valueReferences")?;
        let values = array_mut(values, nValues, "values")?;
        let time = component.groups.time();
        if !references.contains(&time) {
            let indices = component.groups.indices(references)?;
            check_count("values", indices.len(), values.len())?;
            return component.instance.reals(&indices, values);
        }
        let mut rest = values;
        for reference in references {
            let own = [*reference];
            let of = if *reference == time {
                None
            } else {
                Some(component.groups.indices(&own)?)
            };
            let count = of.as_ref().map_or(1, |of| of.len());
            let Some((now, behind)) = std::mem::take(&mut rest).split_at_mut_checked(count)
            else {
                return check_count("values", nvr, nValues);
            };
            match of {
                Some(indices) => component.instance.reals(&indices, now)?,
                None => now[0] = component.instance.time_s(),
            }
            rest = behind;
        }
        check_count("values", nValues - rest.len(), nValues)
    };
    /// Sets real variables: all of them or, when one is refused, none.
    fmi3SetFloat64(
        vr: *const fmi2ValueReference, nvr: usize, values: *const f64, nValues: usize
    ) Call::SetReal => |component| {
        let references = array(vr, nvr, "valueReferences")?;
        let values = array(values, nValues, "values")?;
        let indices = component.groups.indices(references)?;
        check_count("values", indices.len(), values.len())?;
        component.instance.set_reals(&indices, values)
    };
    /// Reads integer variables.
    fmi3GetInt32(
        vr: *const fmi2ValueReference, nvr: usize, values: *mut i32, nValues: usize
    ) Call::GetInteger => |component| {
        let indices = indices(component, vr, nvr, "valueReferences")?;
        check_count("values", indices.len(), nValues)?;
        for (index, value) in indices.iter().zip(array_mut(values, nValues, "values")?) {
            *value = component.instance.integer(*index)?;
        }
        Ok(())
    };
    /// Reads truth variables.
    fmi3GetBoolean(
        vr: *const fmi2ValueReference, nvr: usize, values: *mut bool, nValues: usize
    ) Call::GetBoolean => |component| {
        let indices = indices(component, vr, nvr, "valueReferences")?;
        check_count("values", indices.len(), nValues)?;
        // what the importer has there need not be a truth value yet
        let values = array_mut(values.cast::<u8>(), nValues, "values")?;
        for (index, value) in indices.iter().zip(values) {
            *value = u8::from(component.instance.boolean(*index)?);
        }
        Ok(())
    };
    /// Reads texts; they live as long as the instance.
    fmi3GetString(
        vr: *const fmi2ValueReference, nvr: usize, values: *mut fmi2String, nValues: usize
    ) Call::GetString => |component| {
        let mut found = Vec::new();
        for reference in array(vr, nvr, "valueReferences")? {
            if let Some(names) = component.groups.names_at(*reference) {
                found.extend(names.of.iter().map(|name| name.as_ptr()));
                continue;
            }
            for index in component.groups.indices(&[*reference])?.iter() {
                let index = component.instance.text_index(*index)?;
                found.push(component.texts[index].as_ptr());
            }
        }
        check_count("values", found.len(), nValues)?;
        array_mut(values, nValues, "values")?.copy_from_slice(&found);
        Ok(())
    };
    /// There are none to set.
    fmi3SetInt32(
        vr: *const fmi2ValueReference, nvr: usize, _values: *const i32, _nValues: usize
    ) Call::SetInteger => |component| {
        let indices = indices(component, vr, nvr, "valueReferences")?;
        component.instance.refuse_to_set(&indices, DataType::Integer)
    };
    /// There are none to set.
    fmi3SetBoolean(
        vr: *const fmi2ValueReference, nvr: usize, _values: *const bool, _nValues: usize
    ) Call::SetBoolean => |component| {
        let indices = indices(component, vr, nvr, "valueReferences")?;
        component.instance.refuse_to_set(&indices, DataType::Boolean)
    };
    /// There are none to set.
    fmi3SetString(
        vr: *const fmi2ValueReference, nvr: usize, _values: *const fmi2String, _nValues: usize
    ) Call::SetString => |component| {
        let indices = indices(component, vr, nvr, "valueReferences")?;
        component.instance.refuse_to_set(&indices, DataType::String)
    };
    /// There are no binary variables.
    fmi3GetBinary(
        _vr: *const fmi2ValueReference, nvr: usize, _sizes: *mut usize, _values: *mut *const u8, _nValues: usize
    ) Call::GetInteger => |_| none_of_type(nvr);
    /// There are no binary variables.
    fmi3SetBinary(
        _vr: *const fmi2ValueReference, nvr: usize, _sizes: *const usize, _values: *const *const u8, _nValues: usize
    ) Call::SetInteger => |_| none_of_type(nvr);
    /// There are no clocks.
    fmi3GetClock(_vr: *const fmi2ValueReference, nvr: usize, _values: *mut bool) Call::GetInteger =>
        |_| none_of_type(nvr);
    /// There are no clocks.
    fmi3SetClock(_vr: *const fmi2ValueReference, nvr: usize, _values: *const bool) Call::SetInteger =>
        |_| none_of_type(nvr);
}

/// Accepts no references.
fn none_of_type(references: usize) -> CallResult<()> {
    match references {
        0 => Ok(()),
        found => Err(Refusal::error(format!(
            "there are no variables of this type, found {found} references"
        ))),
    }
}

/// Functions for types of which there are no variables.
macro_rules! none_of_type {
    ($($get:ident, $set:ident, $type:ty;)*) => {
        exported! {$(
            /// There are no variables of this type.
            $get(
                _vr: *const fmi2ValueReference, nvr: usize, _values: *mut $type, _nValues: usize
            ) Call::GetInteger => |_| none_of_type(nvr);
            /// There are no variables of this type.
            $set(
                _vr: *const fmi2ValueReference, nvr: usize, _values: *const $type, _nValues: usize
            ) Call::SetInteger => |_| none_of_type(nvr);
        )*}
    };
}

none_of_type! {
    fmi3GetFloat32, fmi3SetFloat32, f32;
    fmi3GetInt8, fmi3SetInt8, i8;
    fmi3GetUInt8, fmi3SetUInt8, u8;
    fmi3GetInt16, fmi3SetInt16, i16;
    fmi3GetUInt16, fmi3SetUInt16, u16;
    fmi3GetUInt32, fmi3SetUInt32, u32;
    fmi3GetInt64, fmi3SetInt64, i64;
}
