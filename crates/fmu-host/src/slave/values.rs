//! Values and derivatives of variables by value reference.

use super::{Slave, find};
use crate::description::{Value, VariableType};
use crate::error::{Error, Result, ensure};
use crate::library::{Int, OwnFunctions};
use std::ffi::CString;

impl Slave {
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
        let OwnFunctions::Two(own) = &self.core.binary.own else {
            values.copy_from_slice(&self.numbers(references)?);
            return Ok(());
        };
        // SAFETY: the component lives, and the slices have the length that is passed
        self.good("GetReal", |_, c| unsafe {
            let (of, to) = (references.as_ptr(), values.as_mut_ptr());
            (own.get_real)(c, of, references.len(), to)
        })
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
        if kind == VariableType::String {
            return self.text_at(reference).map(Value::String);
        }
        let number = match &self.core.binary.own {
            OwnFunctions::Two(own) if kind != VariableType::Real => {
                let (suffix, function) = match kind {
                    VariableType::Boolean => ("GetBoolean", own.get_boolean),
                    _ => ("GetInteger", own.get_integer),
                };
                let mut value = 0;
                // SAFETY: the component lives, and so do reference and value
                self.good(suffix, |_, c| unsafe {
                    function(c, &reference, 1, &mut value)
                })?;
                f64::from(value)
            }
            _ => self.get_real(&[reference])?[0],
        };
        Ok(match kind {
            VariableType::Real => Value::Real(number),
            VariableType::Boolean => Value::Boolean(number != 0.0),
            _ => Value::Integer(number as i32),
        })
    }

    /// `fmi2SetReal`.
    ///
    /// # Errors
    /// [`Error::Input`] when the lengths differ.
    pub fn set_real(&mut self, references: &[u32], values: &[f64]) -> Result<()> {
        same_length(references, values.len())?;
        let OwnFunctions::Two(own) = &self.core.binary.own else {
            return self.set_numbers(references, values);
        };
        // SAFETY: the component lives, and the slices have the length that is passed
        self.good("SetReal", |_, c| unsafe {
            (own.set_real)(c, references.as_ptr(), references.len(), values.as_ptr())
        })
    }

    /// Sets the variable of that name; a whole number also sets a Real.
    ///
    /// # Errors
    /// [`Error::Input`] for a name that is not there, a value of another type, and a text with a zero byte.
    pub fn set(&mut self, name: &str, value: &Value) -> Result<()> {
        let v = find(self.model_description(), name)?;
        let (kind, reference) = (v.kind, v.value_reference);
        let number = match (kind, value) {
            (VariableType::Real, Value::Real(v)) => *v,
            (
                VariableType::Real | VariableType::Integer | VariableType::Enumeration,
                Value::Integer(v),
            ) => f64::from(*v),
            (VariableType::Boolean, Value::Boolean(v)) => f64::from(u8::from(*v)),
            (VariableType::String, Value::String(v)) => {
                let wrong = |_| Error::input("fmi2SetString", "text without a zero byte", v);
                let owned = CString::new(v.as_str()).map_err(wrong)?;
                return self.set_text(reference, owned.as_ptr());
            }
            _ => {
                let place = format!("variable `{name}`");
                let expected = format!("a value of type {kind:?}");
                return Err(Error::input(place, expected, format!("`{value}`")));
            }
        };
        match &self.core.binary.own {
            OwnFunctions::Two(own) if kind != VariableType::Real => {
                let (suffix, function) = match kind {
                    VariableType::Boolean => ("SetBoolean", own.set_boolean),
                    _ => ("SetInteger", own.set_integer),
                };
                // SAFETY: the component lives, and so do reference and value
                self.good(suffix, |_, c| unsafe {
                    function(c, &reference, 1, &(number as Int))
                })
            }
            _ => self.set_real(&[reference], &[number]),
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
        let (of, of_places, of_count) = self.whole(unknowns)?;
        let (along, along_places, along_count) = self.whole(knowns)?;
        let mut seeds = vec![0.0; along_count];
        for (place, seed) in along_places.iter().zip(seed) {
            seeds[*place] = *seed;
        }
        let mut values = vec![0.0; of_count];
        let (seeds, found) = (seeds.as_ptr(), values.as_mut_ptr());
        let (of, n, along, m) = (of.as_ptr(), of.len(), along.as_ptr(), along.len());
        // SAFETY: the component lives, and the arrays have the length that is passed
        self.good("GetDirectionalDerivative", |f, c| unsafe {
            match &f.own {
                OwnFunctions::Two(own) => {
                    (own.get_directional_derivative)(c, of, n, along, m, seeds, found)
                }
                OwnFunctions::Three(own) => (own.get_directional_derivative)(
                    c,
                    of,
                    n,
                    along,
                    m,
                    seeds,
                    along_count,
                    found,
                    of_count,
                ),
            }
        })?;
        Ok(of_places.iter().map(|place| values[*place]).collect())
    }

    /// `fmi2GetRealOutputDerivatives` of the first order.
    pub(crate) fn output_derivatives(&self, references: &[u32]) -> Result<Vec<f64>> {
        let (of, places, count) = self.whole(references)?;
        let (orders, mut values) = (vec![1; of.len()], vec![0.0; count]);
        let (orders, found) = (orders.as_ptr(), values.as_mut_ptr());
        let (of, n) = (of.as_ptr(), of.len());
        let suffix = match self.model_description().is_fmi3() {
            false => "GetRealOutputDerivatives",
            true => "GetOutputDerivatives",
        };
        // SAFETY: the component lives, and the arrays have the length that is passed
        self.good(suffix, |f, c| unsafe {
            match &f.own {
                OwnFunctions::Two(own) => {
                    (own.get_real_output_derivatives)(c, of, n, orders, found)
                }
                OwnFunctions::Three(own) => {
                    (own.get_output_derivatives)(c, of, n, orders, found, count)
                }
            }
        })?;
        Ok(places.iter().map(|place| values[*place]).collect())
    }
}

fn same_length(references: &[u32], values: usize) -> Result<()> {
    let expected = format_args!("{} of them, one for each reference", references.len());
    ensure(references.len() == values, "values", expected, values)
}
