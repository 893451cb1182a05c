//! Reading and setting variables, by value reference; what is computed is computed when first asked for.

use super::Instance;
use super::layout::{DataType, Source};
use super::memory::Memory;
use super::section::OnsetCard;
use super::sensitivity::check_finite;
use crate::lifecycle::State;
use crate::refusal::{CallResult, Refusal};
use crate::response::wind_at_rest;
use crate::variables::Role;

impl Instance {
    /// Values of real variables.
    ///
    /// # Errors
    /// A reference that is none, of another type, or not readable now; a value that cannot be computed.
    #[inline(always)]
    pub fn reals(&mut self, references: &[u32], values: &mut [f64]) -> CallResult<()> {
        let read = self.read_cached(references, values);
        if read == references.len() {
            return Ok(());
        }
        self.read_rest(&references[read..], &mut values[read..])
    }

    /// Reads real variables up to the first that needs work; returns how many.
    #[inline]
    fn read_cached(&self, references: &[u32], values: &mut [f64]) -> usize {
        // ahead of its release a section is not yet where its initial values put it
        if self.now.memory.state != State::StepComplete {
            return 0;
        }
        let (memory, current) = (&self.now.memory, self.outputs_current);
        let mut read = 0;
        for (reference, value) in references.iter().zip(values) {
            let Some(cached) = self.layout.read_fast(*reference, memory, current) else {
                break;
            };
            *value = cached;
            read += 1;
        }
        read
    }

    /// Reads one that needs work, after which others may need none.
    #[inline(never)]
    fn read_rest(&mut self, mut references: &[u32], mut values: &mut [f64]) -> CallResult<()> {
        if self.now.memory.state == State::StepComplete && !self.outputs_current {
            self.outputs_current = self.unit.repeat_outputs(&mut self.now.memory);
            let read = self.read_cached(references, values);
            (references, values) = (&references[read..], &mut values[read..]);
        }
        while let ([reference, others @ ..], [value, rest @ ..]) = (references, values) {
            *value = self.number(*reference, DataType::Real)?;
            let read = self.read_cached(others, rest);
            (references, values) = (&others[read..], &mut rest[read..]);
        }
        Ok(())
    }

    /// Value of an integer variable.
    pub(crate) fn integer(&mut self, reference: u32) -> CallResult<i32> {
        Ok(self.number(reference, DataType::Integer)? as i32)
    }

    /// Value of a truth variable.
    pub fn boolean(&mut self, reference: u32) -> CallResult<bool> {
        Ok(self.number(reference, DataType::Boolean)? != 0.0)
    }

    /// Index in the table of a text that may be read now.
    pub(crate) fn text_index(&self, reference: u32) -> CallResult<usize> {
        Ok(self.readable(reference, DataType::String)?.0)
    }

    pub(super) fn number(&mut self, reference: u32, wanted: DataType) -> CallResult<f64> {
        let (index, access) = self.readable(reference, wanted)?;
        let now = &mut self.now;
        match access.source {
            Source::Response => {
                let unit = self.unit.prepared(&now.resources, &mut now.memory)?;
                // what is part of the state needs no output equation
                if let Some(entry) = self.layout.state_index(index) {
                    return state_number(&now.memory, entry);
                }
                if !self.outputs_current {
                    unit.outputs(&mut now.memory)?;
                    self.outputs_current = true;
                }
            }
            Source::Status => {
                let Role::Computed(number) = now.resources.table.variables()[index].role else {
                    return Ok(0.0);
                };
                let unit = self.unit.prepared(&now.resources, &mut now.memory)?;
                return Ok(unit.present(now, number));
            }
            Source::State => {
                self.unit.prepared(&now.resources, &mut now.memory)?;
                let entry = self.layout.state_index(index);
                return entry.map_or(Ok(0.0), |entry| state_number(&now.memory, entry));
            }
            Source::Rate => return self.rate_at(index),
            Source::Calculated => match self.unit.prepared(&now.resources, &mut now.memory) {
                Ok(unit) => unit.calculate(now),
                Err(why) => {
                    let calculated = self.unit.calculated();
                    if let Some(numbers) = calculated.filter(|numbers| !numbers.are_known()) {
                        numbers.enter(OnsetCard::unknown(&why), &mut now.memory);
                        numbers.tell(now);
                    }
                }
            },
            _ => {}
        }
        Ok(self.now.memory.values[index])
    }

    /// Sets real variables: all of them or, when one is refused, none.
    ///
    /// # Errors
    /// An error for a reference that is none, of another type or not settable now, and for a value that is not finite;
    /// a discard for a value outside the limits of its variable.
    pub fn set_reals(&mut self, references: &[u32], values: &[f64]) -> CallResult<()> {
        let wind_speed = self.layout.wind_speed;
        // a wind that rounding has taken below zero is at rest
        let stored = |index, value| match index == wind_speed {
            true => wind_at_rest(value, 0.0),
            false => value,
        };
        for (reference, value) in references.iter().zip(values) {
            let (index, access) = self.writable(*reference, DataType::Real)?;
            self.check_value(index, access, stored(index, *value))?;
        }
        for (reference, value) in references.iter().zip(values) {
            let index = *reference as usize;
            let value = stored(index, *value);
            let before = std::mem::replace(&mut self.now.memory.values[index], value);
            let changed = before.to_bits() != value.to_bits();
            let (source, memory) = (self.layout.access[index].source, &mut self.now.memory);
            let before = changed.then_some(before);
            if self.unit.value_set(memory, index, source, before) || changed {
                self.outputs_current = false;
            }
        }
        Ok(())
    }

    /// Refuses to set variables of a type that has none to set.
    ///
    /// # Errors
    /// For every reference.
    pub(crate) fn refuse_to_set(&self, references: &[u32], of_type: DataType) -> CallResult<()> {
        for reference in references {
            self.writable(*reference, of_type)?;
        }
        Ok(())
    }

    /// Sets first rates of inputs, per second: all of them or none.
    ///
    /// # Errors
    /// A reference that is no input, another order than one, a rate that is not finite.
    pub fn set_input_rates(
        &mut self,
        references: &[u32],
        orders: &[i32],
        rates: &[f64],
    ) -> CallResult<()> {
        for ((reference, order), rate) in references.iter().zip(orders).zip(rates) {
            self.input_index(*reference)?;
            check_order(*order)?;
            if !rate.is_finite() {
                return Err(Refusal::error(format!(
                    "rate of value reference {reference}: expected a finite number, found {rate}"
                )));
            }
        }
        for (reference, rate) in references.iter().zip(rates) {
            let index = self.input_index(*reference)?;
            self.now.memory.input_rates[index] = *rate;
            self.unit.input_rate_set(&mut self.now.memory, index);
        }
        Ok(())
    }

    /// Index among the inputs.
    pub(super) fn input_index(&self, reference: u32) -> CallResult<usize> {
        let (index, _) = self.typed(reference, DataType::Real)?;
        let mut inputs = self.unit.inputs().iter();
        inputs.position(|input| *input == index).ok_or_else(|| {
            let name = &self.table().variables()[index].name;
            Refusal::error(format!("`{name}` is no input"))
        })
    }
}

/// A number of the state, which may have overflowed at the release or in the hands of an importer that integrates.
fn state_number(memory: &Memory, entry: usize) -> CallResult<f64> {
    let number = memory.system.number(entry);
    check_finite(&[number]).map(|()| number)
}

/// Rates are known to the first order.
pub(super) fn check_order(order: i32) -> CallResult<()> {
    if order == 1 {
        Ok(())
    } else {
        Err(Refusal::call(format!(
            "order of the derivative: expected 1, found {order}"
        )))
    }
}
