//! What is calculated from the parameters, and when it has to be calculated anew.

use super::memory::Memory;
use super::section::OnsetCard;
use crate::variables::{Causality, ComputedNumber, OnsetNumbers, Present, Role, VariableTable};

/// Onset and divergence of a unit, and what follows from them.
#[derive(Debug)]
pub(super) struct CalculatedNumbers {
    /// The variables, with their indices in the table.
    variables: Vec<(usize, &'static ComputedNumber)>,
    /// For the parameters as they are; `None` until they are asked for.
    onset: Option<OnsetNumbers>,
    /// Why the onset of what was exported is no result.
    undetermined: Option<String>,
}

impl CalculatedNumbers {
    pub(super) fn new(table: &VariableTable) -> Self {
        let each = table.variables().iter().enumerate();
        let calculated = each.filter_map(|(index, v)| match v.role {
            Role::Computed(number) if number.causality != Causality::Output => {
                Some((index, number))
            }
            _ => None,
        });
        Self {
            variables: calculated.collect(),
            onset: None,
            undetermined: table.onset_undetermined.clone(),
        }
    }

    pub(super) fn are_known(&self) -> bool {
        self.onset.is_some()
    }

    /// The last ones that were calculated.
    pub(super) fn onset(&self) -> OnsetNumbers {
        self.onset.unwrap_or_default()
    }

    /// A parameter has changed.
    pub(super) fn forget(&mut self) {
        self.onset = None;
    }

    /// The memory is another, with the same parameters or not.
    pub(super) fn carry_over(&mut self, memory: &mut Memory, same: bool) {
        self.onset = self.onset.filter(|_| same);
        if let Some(onset) = self.onset {
            self.write(onset, memory);
        }
    }

    /// Enters the answer of a search.
    pub(super) fn enter(
        &mut self,
        card: OnsetCard,
        memory: &mut Memory,
        notices: &mut Vec<String>,
    ) {
        self.onset = Some(card.numbers);
        self.write(card.numbers, memory);
        notices.extend(card.warnings);
        let undetermined = self.undetermined.take().into_iter();
        notices.extend(undetermined.map(|why| format!("onset_speed as exported: {why}")));
    }

    fn write(&self, onset: OnsetNumbers, memory: &mut Memory) {
        let present = Present {
            onset,
            ..Present::default()
        };
        for (index, number) in &self.variables {
            memory.values[*index] = number.evaluate(&present).value;
        }
    }
}
