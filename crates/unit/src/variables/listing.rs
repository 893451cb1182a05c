//! The table as a description lists it: all of it, or its real variables for importers that take no others.

use super::{Dependency, StartValue, Variable, VariableTable};

impl VariableTable {
    /// The variables that a description lists, as a table of their own, whose dependencies are indices in it; and their value references:
    /// the indices in the full table, so that one runtime serves both. Where it lists `reals_only`, the others stay in the runtime,
    /// unnamed.
    pub fn listed(&self, reals_only: bool) -> (Self, Vec<usize>) {
        let real = |v: &Variable| matches!(v.value, StartValue::Real(_));
        let references: Vec<usize> = (0..self.variables.len())
            .filter(|&i| self.variables[i].is_listed)
            .filter(|&i| !reals_only || real(&self.variables[i]))
            .collect();
        // ascending, since the references are
        let index = |reference: usize| references.binary_search(&reference).ok();
        let variables = references.iter().map(|&reference| {
            let mut variable = self.variables[reference].clone();
            variable.derivative_of = variable.derivative_of.and_then(index);
            let lists = [
                &mut variable.direct_inputs,
                &mut variable.initial_dependencies,
            ];
            for list in lists {
                let listed = list.iter();
                let listed = listed.filter_map(|d| index(d.on).map(|on| Dependency { on, ..*d }));
                *list = listed.collect();
            }
            variable
        });
        let table = Self {
            variables: variables.collect(),
            onset_bounds: self.onset_bounds.clone(),
        };
        (table, references)
    }
}
