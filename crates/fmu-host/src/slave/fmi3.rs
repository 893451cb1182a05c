//! What differs in FMI 3.0: values are those of whole arrays.
//!
//! References are places in the list of variables, where each element of an array is one.

use super::Slave;
use crate::description::ArrayElement;
use crate::error::{Error, Result};
use crate::library::{OwnFunctions, Text};
use crate::log::text;
use crate::reading_fmi3::NUMERIC;
use std::collections::HashMap;

impl Slave {
    pub(super) fn set_numbers(&mut self, places: &[u32], values: &[f64]) -> Result<()> {
        let elements = self.elements(places)?;
        let wanted = || places.iter().zip(&elements);
        let array = |place: u32, e: &ArrayElement| {
            let first = place as usize - e.element;
            first..first + e.size
        };
        if self.begun && elements.iter().any(|e| e.size > places.len()) {
            // the other elements stay as they are, wherever a restored state has put them
            for (place, e) in wanted() {
                let all = array(*place, e);
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
        for (place, e) in wanted() {
            let all = array(*place, e);
            if all.start == done {
                continue;
            }
            done = all.start;
            self.set_array(*e, &self.kept[all])?;
        }
        Ok(())
    }

    /// Where variables stand.
    fn elements(&self, places: &[u32]) -> Result<Vec<ArrayElement>> {
        let all = &self.core.binary.description.elements;
        let element = |place: &u32| {
            all.get(*place as usize).copied().ok_or_else(|| {
                let expected = format!("a place below {}", all.len());
                Error::input("variable", expected, place.to_string())
            })
        };
        places.iter().map(element).collect()
    }

    /// Arrays that hold some elements, as one call reads them: their references, the place of each element among all their values, and
    /// how many these are. In FMI 2.0 each is a variable of its own.
    pub(super) fn whole(&self, places: &[u32]) -> Result<(Vec<u32>, Vec<usize>, usize)> {
        if !self.model_description().is_fmi3() {
            return Ok((places.to_vec(), (0..places.len()).collect(), places.len()));
        }
        let (mut references, mut count) = (Vec::new(), 0);
        let mut begins: HashMap<u32, usize> = HashMap::new();
        let mut all = Vec::with_capacity(places.len());
        for e in self.elements(places)? {
            let begin = *begins.entry(e.reference).or_insert_with(|| {
                references.push(e.reference);
                count += e.size;
                count - e.size
            });
            all.push(begin + e.element);
        }
        Ok((references, all, count))
    }

    /// Numbers of any types.
    pub(super) fn numbers(&self, places: &[u32]) -> Result<Vec<f64>> {
        let (elements, mut values) = (self.elements(places)?, vec![0.0; places.len()]);
        for (function, (name, _)) in NUMERIC.iter().enumerate() {
            let of_type = |i: &usize| elements[*i].function == Some(function);
            let chosen: Vec<usize> = (0..places.len()).filter(of_type).collect();
            if chosen.is_empty() {
                continue;
            }
            let own: Vec<u32> = chosen.iter().map(|i| places[*i]).collect();
            let (references, own, count) = self.whole(&own)?;
            let mut bytes = vec![0_u64; count];
            let (of, to) = (references.as_ptr(), bytes.as_mut_ptr().cast());
            // SAFETY: the component lives; eight bytes are enough for every type
            self.good(&format!("Get{name}"), |f, c| unsafe {
                (f.getters[function])(c, of, references.len(), to, count)
            })?;
            let numbers = read_numbers(function, &bytes);
            for (at, place) in chosen.iter().zip(own) {
                values[*at] = numbers[place];
            }
        }
        Ok(values)
    }

    fn set_array(&self, element: ArrayElement, values: &[f64]) -> Result<()> {
        let Some(function) = element.function else {
            return Err(Error::input("variable", "a number", "a string"));
        };
        let bytes = written_numbers(function, values);
        let from = bytes.as_ptr().cast();
        // SAFETY: the component lives, and the array has the length that is passed
        self.good(&format!("Set{}", NUMERIC[function].0), |f, c| unsafe {
            (f.setters[function])(c, &element.reference, 1, from, values.len())
        })
    }

    /// A string, in either version.
    pub(super) fn text_at(&self, place: u32) -> Result<String> {
        let (references, places, count) = self.whole(&[place])?;
        let mut values: Vec<Text> = vec![std::ptr::null(); count];
        let (of, n, to) = (references.as_ptr(), references.len(), values.as_mut_ptr());
        // SAFETY: the component lives, and the arrays have the length that is passed
        self.good("GetString", |f, c| unsafe {
            match &f.own {
                OwnFunctions::Two(own) => (own.get_string)(c, of, n, to),
                OwnFunctions::Three(own) => (own.get_string)(c, of, n, to, count),
            }
        })?;
        // SAFETY: a string of the FMU, copied before the next call, which may free it
        Ok(unsafe { text(values[places[0]]) })
    }

    /// Sets a string that is no element of an array.
    pub(super) fn set_text(&self, place: u32, value: Text) -> Result<()> {
        let (references, ..) = self.whole(&[place])?;
        let of = references.as_ptr();
        // SAFETY: the component lives, and the arrays have the length that is passed
        self.good("SetString", |f, c| unsafe {
            match &f.own {
                OwnFunctions::Two(own) => (own.set_string)(c, of, 1, &value),
                OwnFunctions::Three(own) => (own.set_string)(c, of, 1, &value, 1),
            }
        })
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
