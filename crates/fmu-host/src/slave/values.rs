//! Values and derivatives of variables by value reference.

use super::Slave;
use crate::error::{Error, Result};
use crate::library::{Component, Fmi2Functions, Int, Text, ValueReference};
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
        if let Some(three) = self.three() {
            values.copy_from_slice(&three.numbers(references)?);
            return Ok(());
        }
        self.read("GetReal", references, values, |f| f.get_real)
    }

    /// `fmi2GetInteger`.
    pub(crate) fn get_integer(&self, references: &[u32]) -> Result<Vec<i32>> {
        if let Some(three) = self.three() {
            let numbers = three.numbers(references)?;
            return Ok(numbers.into_iter().map(|v| v as i32).collect());
        }
        let mut values = vec![0; references.len()];
        self.read("GetInteger", references, &mut values, |f| f.get_integer)?;
        Ok(values)
    }

    /// `fmi2GetBoolean`.
    pub(crate) fn get_boolean(&self, references: &[u32]) -> Result<Vec<bool>> {
        if let Some(three) = self.three() {
            let numbers = three.numbers(references)?;
            return Ok(numbers.into_iter().map(|v| v != 0.0).collect());
        }
        let mut values: Vec<Int> = vec![0; references.len()];
        self.read("GetBoolean", references, &mut values, |f| f.get_boolean)?;
        Ok(values.into_iter().map(|v| v != 0).collect())
    }

    /// `fmi2GetString`.
    pub(crate) fn get_string(&self, references: &[u32]) -> Result<Vec<String>> {
        if let Some(three) = self.three() {
            return three.texts(references);
        }
        let mut values: Vec<Text> = vec![std::ptr::null(); references.len()];
        self.read("GetString", references, &mut values, |f| f.get_string)?;
        // SAFETY: strings of the FMU, copied before the next call, which may free them
        Ok(values.into_iter().map(|v| unsafe { text(v) }).collect())
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

    /// `fmi2SetInteger`.
    pub(crate) fn set_integer(&mut self, references: &[u32], values: &[i32]) -> Result<()> {
        same_length(references, values.len())?;
        if self.three().is_some() {
            let numbers: Vec<f64> = values.iter().map(|v| f64::from(*v)).collect();
            return self.set_numbers(references, &numbers);
        }
        self.write("SetInteger", references, values, |f| f.set_integer)
    }

    /// `fmi2SetBoolean`.
    pub(crate) fn set_boolean(&mut self, references: &[u32], values: &[bool]) -> Result<()> {
        same_length(references, values.len())?;
        if self.three().is_some() {
            let numbers: Vec<f64> = values.iter().map(|v| f64::from(u8::from(*v))).collect();
            return self.set_numbers(references, &numbers);
        }
        let values: Vec<Int> = values.iter().map(|v| Int::from(*v)).collect();
        self.write("SetBoolean", references, &values, |f| f.set_boolean)
    }

    /// `fmi2SetString`.
    ///
    /// # Errors
    /// [`Error::Input`] when the lengths differ, and for a text with a zero byte.
    pub(crate) fn set_string(&mut self, references: &[u32], values: &[&str]) -> Result<()> {
        same_length(references, values.len())?;
        let wrong = |text: &str| Error::input("fmi2SetString", "text without a zero byte", text);
        let owned = values
            .iter()
            .map(|v| CString::new(*v).map_err(|_| wrong(v)));
        let owned: Vec<CString> = owned.collect::<Result<_>>()?;
        let values: Vec<Text> = owned.iter().map(|v| v.as_ptr()).collect();
        match self.three() {
            Some(three) => three.set_texts(references, &values),
            None => self.write("SetString", references, &values, |f| f.set_string),
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
            return three.directional_derivative(unknowns, knowns, seed);
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

    /// `fmi2GetRealOutputDerivatives` of the given orders.
    pub(crate) fn output_derivatives(
        &self,
        references: &[u32],
        orders: &[i32],
    ) -> Result<Vec<f64>> {
        same_length(references, orders.len())?;
        if let Some(three) = self.three() {
            return three.output_derivatives(references, orders);
        }
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
    if references.len() == values {
        Ok(())
    } else {
        Err(Error::input(
            "values",
            format!("{} of them, one for each reference", references.len()),
            values.to_string(),
        ))
    }
}
