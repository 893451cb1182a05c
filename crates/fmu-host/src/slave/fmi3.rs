//! What differs in FMI 3.0: values of whole arrays, and derivatives along them.
//!
//! References are places in the list of variables, where each element of an array is one.

use super::Slave;
use crate::description::ArrayElement;
use crate::error::{Error, Result};
use crate::library::{Fmi3Functions, OwnFunctions, Text};
use crate::log::text;
use crate::reading_fmi3::NUMERIC;
use crate::status::Status;

/// Arrays that hold some elements, as one call reads them.
struct WholeArrays {
    references: Vec<u32>,
    /// Place of each element among all values.
    places: Vec<usize>,
    /// Values of all arrays.
    count: usize,
}

impl Slave {
    /// The functions of an instance of FMI 3.0.
    pub(super) fn three(&self) -> Option<&Fmi3Functions> {
        match &self.functions().own {
            OwnFunctions::Two(_) => None,
            OwnFunctions::Three(own) => Some(own),
        }
    }

    /// `fmi3EnterInitializationMode`, with what FMI 2.0 is told before.
    pub(super) fn initialization_of_three(&self, own: &Fmi3Functions) -> Status {
        let stated = |number: Option<f64>| (u8::from(number.is_some()), number.unwrap_or(0.0));
        let (start_s, stop_s, tolerance) = self.experiment;
        let ((with_tolerance, tolerance), (with_stop, stop)) = (stated(tolerance), stated(stop_s));
        // SAFETY: the component lives; plain values
        self.status(|_, c| unsafe {
            (own.enter_initialization_mode)(c, with_tolerance, tolerance, start_s, with_stop, stop)
        })
    }

    /// A step; one that ends early or asks for the end of the run was not done.
    pub(super) fn step_of_three(&self, own: &Fmi3Functions, time_s: f64, step_s: f64) -> Status {
        let (mut event, mut end, mut early, mut last) = (0, 0, 0, time_s);
        // SAFETY: the component lives; all four outlive the call
        let status = self.status(|_, c| unsafe {
            (own.do_step)(
                c, time_s, step_s, 1, &mut event, &mut end, &mut early, &mut last,
            )
        });
        match status.is_good() && (end != 0 || early != 0) {
            true => Status::Discard,
            false => status,
        }
    }

    pub(super) fn set_numbers(&mut self, places: &[u32], values: &[f64]) -> Result<()> {
        let elements = &self.core.loaded.description.elements;
        let element = |place: u32| elements[place as usize];
        let first = |place: u32| place as usize - element(place).element;
        if self.begun && places.iter().any(|p| element(*p).size > places.len()) {
            // the other elements stay as they are, wherever a restored state has put them
            for place in places {
                let all = first(*place)..first(*place) + element(*place).size;
                let whole: Vec<u32> = all.clone().map(|p| p as u32).collect();
                if let Ok(now) = self.numbers(&whole) {
                    self.kept[all].copy_from_slice(&now);
                }
            }
        }
        for (place, value) in places.iter().zip(values) {
            self.kept[*place as usize] = *value;
        }
        let mut done = usize::MAX;
        for place in places {
            let from = first(*place);
            if from == done {
                continue;
            }
            done = from;
            let now = &self.kept[from..from + element(*place).size];
            self.set_array(element(*place), now)?;
        }
        Ok(())
    }

    fn element(&self, place: u32) -> Result<ArrayElement> {
        let all = &self.core.loaded.description.elements;
        all.get(place as usize).copied().ok_or_else(|| {
            let expected = format!("a place below {}", all.len());
            Error::input("variable", expected, place.to_string())
        })
    }

    fn whole(&self, places: &[u32]) -> Result<WholeArrays> {
        let mut whole = WholeArrays {
            references: Vec::new(),
            places: Vec::with_capacity(places.len()),
            count: 0,
        };
        let mut begins: Vec<(u32, usize)> = Vec::new();
        for place in places {
            let e = self.element(*place)?;
            let known = begins
                .iter()
                .rev()
                .find(|(reference, _)| *reference == e.reference);
            let begin = known.map_or(whole.count, |(_, begin)| *begin);
            if known.is_none() {
                begins.push((e.reference, begin));
                whole.references.push(e.reference);
                whole.count += e.size;
            }
            whole.places.push(begin + e.element);
        }
        Ok(whole)
    }

    /// Numbers of any types.
    pub(super) fn numbers(&self, places: &[u32]) -> Result<Vec<f64>> {
        let mut values = vec![0.0; places.len()];
        for (function, (name, _)) in NUMERIC.iter().enumerate() {
            let of_type = |i: &usize| {
                let element = self.element(places[*i]);
                element.is_ok_and(|e| e.function == Some(function))
            };
            let chosen: Vec<usize> = (0..places.len()).filter(of_type).collect();
            if chosen.is_empty() {
                continue;
            }
            let own: Vec<u32> = chosen.iter().map(|i| places[*i]).collect();
            let whole = self.whole(&own)?;
            let mut bytes = vec![0_u64; whole.count];
            let get = self.functions().getters[function];
            // SAFETY: the component lives; eight bytes are enough for every type
            let status = self.status(|_, c| unsafe {
                let to = bytes.as_mut_ptr().cast();
                get(
                    c,
                    whole.references.as_ptr(),
                    whole.references.len(),
                    to,
                    whole.count,
                )
            });
            self.answered(&format!("Get{name}"), status)?;
            let numbers = read_numbers(function, &bytes);
            for (at, place) in chosen.iter().zip(&whole.places) {
                values[*at] = numbers[*place];
            }
        }
        Ok(values)
    }

    fn set_array(&self, element: ArrayElement, values: &[f64]) -> Result<()> {
        let Some(function) = element.function else {
            return Err(Error::input("variable", "a number", "a string"));
        };
        let bytes = written_numbers(function, values);
        let set = self.functions().setters[function];
        // SAFETY: the component lives, and the array has the length that is passed
        let status = self.status(|_, c| unsafe {
            set(
                c,
                &element.reference,
                1,
                bytes.as_ptr().cast(),
                values.len(),
            )
        });
        self.answered(&format!("Set{}", NUMERIC[function].0), status)
    }

    /// A string.
    pub(super) fn text_at(&self, own: &Fmi3Functions, place: u32) -> Result<String> {
        let whole = self.whole(&[place])?;
        let mut values: Vec<Text> = vec![std::ptr::null(); whole.count];
        // SAFETY: the component lives, and the arrays have the length that is passed
        let status = self.status(|_, c| unsafe {
            let (references, to) = (whole.references.as_ptr(), values.as_mut_ptr());
            (own.get_string)(c, references, whole.references.len(), to, whole.count)
        });
        self.answered("GetString", status)?;
        // SAFETY: a string of the FMU, copied before the next call, which may free it
        Ok(unsafe { text(values[whole.places[0]]) })
    }

    /// Sets a string that is no element of an array.
    pub(super) fn set_text(&self, own: &Fmi3Functions, place: u32, value: Text) -> Result<()> {
        let reference = self.element(place)?.reference;
        // SAFETY: the component lives, and the arrays have the length that is passed
        let status = self.status(|_, c| unsafe { (own.set_string)(c, &reference, 1, &value, 1) });
        self.answered("SetString", status)
    }

    pub(super) fn derivative_of_three(
        &self,
        own: &Fmi3Functions,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
    ) -> Result<Vec<f64>> {
        let (of, along) = (self.whole(unknowns)?, self.whole(knowns)?);
        let mut seeds = vec![0.0; along.count];
        for (place, seed) in along.places.iter().zip(seed) {
            seeds[*place] = *seed;
        }
        let mut values = vec![0.0; of.count];
        // SAFETY: the component lives, and the arrays have the length that is passed
        let status = self.status(|_, c| unsafe {
            (own.get_directional_derivative)(
                c,
                of.references.as_ptr(),
                of.references.len(),
                along.references.as_ptr(),
                along.references.len(),
                seeds.as_ptr(),
                seeds.len(),
                values.as_mut_ptr(),
                of.count,
            )
        });
        self.answered("GetDirectionalDerivative", status)?;
        Ok(of.places.iter().map(|p| values[*p]).collect())
    }

    pub(super) fn output_derivatives_of_three(
        &self,
        own: &Fmi3Functions,
        places: &[u32],
    ) -> Result<Vec<f64>> {
        let whole = self.whole(places)?;
        let orders = vec![1; whole.references.len()];
        let mut values = vec![0.0; whole.count];
        // SAFETY: the component lives, and the arrays have the length that is passed
        let status = self.status(|_, c| unsafe {
            (own.get_output_derivatives)(
                c,
                whole.references.as_ptr(),
                whole.references.len(),
                orders.as_ptr(),
                values.as_mut_ptr(),
                whole.count,
            )
        });
        self.answered("GetOutputDerivatives", status)?;
        Ok(whole.places.iter().map(|p| values[*p]).collect())
    }
}

/// Applies a macro to every type of [`NUMERIC`].
macro_rules! by_type {
    ($function:expr, $apply:ident) => {
        match $function {
            0 => $apply!(f64),
            1 => $apply!(f32),
            2 => $apply!(i8),
            3 => $apply!(u8),
            4 => $apply!(i16),
            5 => $apply!(u16),
            6 => $apply!(i32),
            7 => $apply!(u32),
            8 => $apply!(i64),
            9 => $apply!(u64),
            // a truth value is a byte
            _ => $apply!(u8),
        }
    };
}

/// The first numbers of that type in the memory of as many numbers of eight bytes.
fn read_numbers(function: usize, memory: &[u64]) -> Vec<f64> {
    let bytes: Vec<u8> = memory.iter().flat_map(|word| word.to_ne_bytes()).collect();
    macro_rules! read {
        ($type:ty) => {{
            let each = bytes.chunks_exact(size_of::<$type>()).take(memory.len());
            each.map(|chunk| {
                let mut own = [0; size_of::<$type>()];
                own.copy_from_slice(chunk);
                <$type>::from_ne_bytes(own) as f64
            })
            .collect()
        }};
    }
    by_type!(function, read)
}

fn written_numbers(function: usize, values: &[f64]) -> Vec<u64> {
    let mut bytes: Vec<u8> = Vec::with_capacity(8 * values.len());
    macro_rules! write {
        ($type:ty) => {
            for value in values {
                bytes.extend_from_slice(&(*value as $type).to_ne_bytes());
            }
        };
    }
    by_type!(function, write);
    bytes.resize(8 * values.len(), 0);
    let words = bytes.chunks_exact(8);
    words
        .map(|chunk| {
            let mut word = [0; 8];
            word.copy_from_slice(chunk);
            u64::from_ne_bytes(word)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_every_width_pass_through() {
        for (function, (name, _)) in NUMERIC.iter().enumerate() {
            let values = [1.0, 0.0, 100.0];
            let memory = written_numbers(function, &values);
            assert_eq!(read_numbers(function, &memory), values, "{}", name);
        }
    }
}
