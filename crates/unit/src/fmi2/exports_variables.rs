//! Reading and setting variables.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use super::guard::{array, array_mut, exported};
use super::types::{fmi2Boolean, fmi2Integer, fmi2Real, fmi2String, fmi2ValueReference};
use crate::instance::DataType;
use crate::lifecycle::Call;

exported! {
    /// Reads real variables.
    fmi2GetReal(vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2Real) Call::GetReal => |component| {
        let references = array(vr, nvr, "vr")?;
        let values = array_mut(value, nvr, "value")?;
        component.instance.reals(references, values)
    };
    /// Reads integer variables.
    fmi2GetInteger(vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2Integer) Call::GetInteger => |component| {
        let references = array(vr, nvr, "vr")?;
        for (reference, value) in references.iter().zip(array_mut(value, nvr, "value")?) {
            *value = component.instance.integer(*reference)?;
        }
        Ok(())
    };
    /// Reads truth variables.
    fmi2GetBoolean(vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2Boolean) Call::GetBoolean => |component| {
        let references = array(vr, nvr, "vr")?;
        for (reference, value) in references.iter().zip(array_mut(value, nvr, "value")?) {
            *value = fmi2Boolean::from(component.instance.boolean(*reference)?);
        }
        Ok(())
    };
    /// Reads texts; they live as long as the instance.
    fmi2GetString(vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2String) Call::GetString => |component| {
        let references = array(vr, nvr, "vr")?;
        for (reference, value) in references.iter().zip(array_mut(value, nvr, "value")?) {
            let index = component.instance.text_index(*reference)?;
            *value = component.texts[index].as_ptr();
        }
        Ok(())
    };
    /// Sets real variables: all of them or, when one is refused, none.
    fmi2SetReal(vr: *const fmi2ValueReference, nvr: usize, value: *const fmi2Real) Call::SetReal => |component| {
        let references = array(vr, nvr, "vr")?;
        let values = array(value, nvr, "value")?;
        component.instance.set_reals(references, values)
    };
    /// Sets integer variables: there are none to set.
    fmi2SetInteger(vr: *const fmi2ValueReference, nvr: usize, _value: *const fmi2Integer) Call::SetInteger =>
        |component| component.instance.refuse_to_set(array(vr, nvr, "vr")?, DataType::Integer);
    /// Sets truth variables: there are none to set.
    fmi2SetBoolean(vr: *const fmi2ValueReference, nvr: usize, _value: *const fmi2Boolean) Call::SetBoolean =>
        |component| component.instance.refuse_to_set(array(vr, nvr, "vr")?, DataType::Boolean);
    /// Sets texts: there are none to set.
    fmi2SetString(vr: *const fmi2ValueReference, nvr: usize, _value: *const fmi2String) Call::SetString =>
        |component| component.instance.refuse_to_set(array(vr, nvr, "vr")?, DataType::String);
}
