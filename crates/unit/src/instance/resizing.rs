//! A unit of forces with another number of strips.

use super::{Instance, State};
use crate::error::Result;
use std::collections::HashMap;

impl Instance {
    /// The same with so many strips, or as many as were exported; those beyond them are like the last. What has been set stays where there
    /// still is such a variable.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for what has no strips to count, and for too many.
    pub(crate) fn resized(&self, strips: Option<usize>) -> Result<Self> {
        let mut resized = Self::new(self.resources.with_strips(strips)?)?;
        resized.interface = self.interface;
        let variables = self.table().variables().iter();
        let values = variables.zip(&self.memory.values);
        let old: HashMap<&str, f64> = values.map(|(v, x)| (v.name.as_str(), *x)).collect();
        for index in 0..resized.table().variables().len() {
            let name = resized.table().variables()[index].name.as_str();
            if let Some(value) = old.get(name)
                && resized.layout.access[index]
                    .settable
                    .contains(State::Instantiated)
            {
                resized.memory.values[index] = *value;
            }
        }
        Ok(resized)
    }

    /// Whether it has another number of strips than was exported.
    pub(crate) fn is_resized(&self) -> bool {
        self.resources.exported_force.is_some()
    }
}
