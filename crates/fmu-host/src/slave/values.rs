//! Values and derivatives of variables by value reference.

use super::{Slave, find};
use crate::description::{Value, VariableType};
use crate::error::{Error, Result, ensure};
use crate::library::{Component, Fmi2Functions, Int, ValueReference};
use crate::log::text;
use std::ffi::CString;

/// A function of FMI 2.0 that reads values of one type.
type Reader<T> = unsafe extern "C" fn(Component, *const ValueReference, usize, *mut T) -> Int;
/// One that sets them.
type Writer<T> = unsafe extern "C" fn(Component, *const ValueReference, usize, *const T) -> Int;

impl Slave {
    fn read<T>(
        &self,
        suffix: &str,
        references: &[u32],
        values: &mut [T],
        function: fn(&Fmi2Functions) -> Reader<T>,
    ) -> Result<()> {
        // SAFETY: the component lives, and the slices have the length that is passed
        self.good_two(suffix, |f, c| unsafe {
            function(f)(
                c,
                references.as_ptr(),
                references.len(),
                values.as_mut_ptr(),
            )
        })
    }

    fn write<T>(
        &self,
        suffix: &str,
        references: &[u32],
        values: &[T],
        function: fn(&Fmi2Functions) -> Writer<T>,
    ) -> Result<()> {
        // SAFETY: the component lives, and the slices have the length that is passed
        self.good_two(suffix, |f, c| unsafe {
            function(f)(c, references.as_ptr(), references.len(), values.as_ptr())
        })
    }

    /// `fmi2GetReal`.
    pub fn get_real(&self, references: &[u32]) -> Result<Vec<f64>> {
        let mut values = vec![0.0; references.len()];
        self.read_real(references, &mut values)?;
        Ok(values)
    }

    /// As [`Slave::get_real`] into a slice of the same length.
    ///
    /// # Errors
    /// [`Error::Input`] when the lengths differ.
    pub fn read_real(&self, references: &[u32], values: &mut [f64]) -> Result<()> {
        same_length(references, values.len())?;
        if self.three().is_some() {
            values.copy_from_slice(&self.numbers(references)?);
            return Ok(());
        }
        self.read("GetReal", references, values, |f| f.get_real)
    }

    /// Value of the variable of that name, whatever its type.
    ///
    /// # Errors
    /// [`Error::Input`] for a name that is not there.
    pub fn get(&self, name: &str) -> Result<Value> {
        let v = find(self.model_description(), name)?;
        self.get_by_reference(v.kind, v.value_reference)
    }

    /// Value of a variable of that type: `fmi2GetInteger`, `fmi2GetBoolean`, `fmi2GetString`.
    pub(crate) fn get_by_reference(&self, kind: VariableType, reference: u32) -> Result<Value> {
        let one = &[reference];
        let is_fmi3 = self.three().is_some();
        Ok(match kind {
            VariableType::Real => Value::Real(self.get_real(one)?[0]),
            VariableType::Integer | VariableType::Enumeration if is_fmi3 => {
                Value::Integer(self.numbers(one)?[0] as i32)
            }
            VariableType::Integer | VariableType::Enumeration => {
                let mut value = [0];
                self.read("GetInteger", one, &mut value, |f| f.get_integer)?;
                Value::Integer(value[0])
            }
            VariableType::Boolean if is_fmi3 => Value::Boolean(self.numbers(one)?[0] != 0.0),
            VariableType::Boolean => {
                let mut value = [0];
                self.read("GetBoolean", one, &mut value, |f| f.get_boolean)?;
                Value::Boolean(value[0] != 0)
            }
            VariableType::String => Value::String(match self.three() {
                Some(three) => self.text_at(three, reference)?,
                None => {
                    let mut value = [std::ptr::null()];
                    self.read("GetString", one, &mut value, |f| f.get_string)?;
                    // SAFETY: a string of the FMU, copied before the next call, which may free it
                    unsafe { text(value[0]) }
                }
            }),
        })
    }

    /// `fmi2SetReal`.
    ///
    /// # Errors
    /// [`Error::Input`] when the lengths differ.
    pub fn set_real(&mut self, references: &[u32], values: &[f64]) -> Result<()> {
        same_length(references, values.len())?;
        if self.three().is_some() {
            return self.set_numbers(references, values);
        }
        self.write("SetReal", references, values, |f| f.set_real)
    }

    /// Sets the variable of that name; a whole number also sets a Real.
    ///
    /// # Errors
    /// [`Error::Input`] for a name that is not there, a value of another type, and a text with a zero byte.
    pub fn set(&mut self, name: &str, value: &Value) -> Result<()> {
        let v = find(self.model_description(), name)?;
        let (kind, reference) = (v.kind, v.value_reference);
        let one = &[reference];
        let is_fmi3 = self.three().is_some();
        match (kind, value) {
            (VariableType::Real, Value::Real(v)) => self.set_real(one, &[*v]),
            (VariableType::Real, Value::Integer(v)) => self.set_real(one, &[f64::from(*v)]),
            (VariableType::Integer | VariableType::Enumeration, Value::Integer(v)) => match is_fmi3
            {
                true => self.set_numbers(one, &[f64::from(*v)]),
                false => self.write("SetInteger", one, &[*v], |f| f.set_integer),
            },
            (VariableType::Boolean, Value::Boolean(v)) => match is_fmi3 {
                true => self.set_numbers(one, &[f64::from(u8::from(*v))]),
                false => self.write("SetBoolean", one, &[Int::from(*v)], |f| f.set_boolean),
            },
            (VariableType::String, Value::String(v)) => {
                let wrong = |_| Error::input("fmi2SetString", "text without a zero byte", v);
                let owned = CString::new(v.as_str()).map_err(wrong)?;
                match self.three() {
                    Some(three) => self.set_text(three, reference, owned.as_ptr()),
                    None => self.write("SetString", one, &[owned.as_ptr()], |f| f.set_string),
                }
            }
            _ => Err(Error::input(
                format!("variable `{name}`"),
                format!("a value of type {kind:?}"),
                format!("`{value}`"),
            )),
        }
    }

    /// `fmi2GetDirectionalDerivative`: change of the unknowns along `seed`, the changes of the knowns.
    pub fn directional_derivative(
        &self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
    ) -> Result<Vec<f64>> {
        same_length(knowns, seed.len())?;
        if let Some(three) = self.three() {
            return self.derivative_of_three(three, unknowns, knowns, seed);
        }
        let mut values = vec![0.0; unknowns.len()];
        // SAFETY: the component lives, and the slices have the length that is passed
        self.good_two("GetDirectionalDerivative", |f, c| unsafe {
            (f.get_directional_derivative)(
                c,
                unknowns.as_ptr(),
                unknowns.len(),
                knowns.as_ptr(),
                knowns.len(),
                seed.as_ptr(),
                values.as_mut_ptr(),
            )
        })?;
        Ok(values)
    }

    /// `fmi2GetRealOutputDerivatives` of the first order.
    pub(crate) fn output_derivatives(&self, references: &[u32]) -> Result<Vec<f64>> {
        if let Some(three) = self.three() {
            return self.output_derivatives_of_three(three, references);
        }
        let orders = vec![1; references.len()];
        let mut values = vec![0.0; references.len()];
        // SAFETY: the component lives, and the slices have the length that is passed
        self.good_two("GetRealOutputDerivatives", |f, c| unsafe {
            (f.get_real_output_derivatives)(
                c,
                references.as_ptr(),
                references.len(),
                orders.as_ptr(),
                values.as_mut_ptr(),
            )
        })?;
        Ok(values)
    }
}

fn same_length(references: &[u32], values: usize) -> Result<()> {
    let expected = format_args!("{} of them, one for each reference", references.len());
    ensure(references.len() == values, "values", expected, values)
}
