//! What is calculated from the parameters, and when it has to be calculated anew.

use super::layout::Source;
use super::memory::{Memory, Now, starts};
use super::section::OnsetCard;
use crate::variables::{Causality, ComputedNumber, OnsetNumbers, Present, Role, VariableTable};

/// Onset and divergence of a unit, and what follows from them.
#[derive(Debug)]
pub(super) struct CalculatedNumbers {
    /// The variables, with their indices in the table.
    variables: Vec<(usize, &'static ComputedNumber)>,
    /// For the parameters as they are; `None` until they are asked for.
    pub card: Option<OnsetCard>,
    /// Whether its warnings have been told, of these parameters and in this run.
    told: bool,
    /// The same of what the data leave open of what was exported, and that they leave another onset more or less open.
    told_of_interval: [bool; 2],
}

/// What is told of parameters that are not those of the interval.
const OTHER_INTERVAL: &str = "onset_speed_low to onset_speed_high is the interval of what was exported: how far the data leave \
     the onset open with these parameters is not known here";

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
            card: None,
            told: false,
            told_of_interval: [false; 2],
        }
    }

    /// Whether they are there, with all that has to be told of them.
    pub(super) fn are_known(&self) -> bool {
        self.card.is_some() && self.told
    }

    /// The last ones that were calculated.
    pub(super) fn onset(&self) -> OnsetNumbers {
        let card = self.card.as_ref();
        card.map(|card| card.numbers).unwrap_or_default()
    }

    /// Another run begins: who reads its log has not read that of the last.
    pub(super) fn begin_run(&mut self) {
        (self.told, self.told_of_interval) = (false, [false; 2]);
    }

    /// The memory is another, with the same parameters or not.
    pub(super) fn carry_over(&mut self, memory: &mut Memory, same: bool) {
        self.card = self.card.take().filter(|_| same);
        if self.card.is_some() {
            self.write(memory);
        }
    }

    /// Enters the answer of a search.
    pub(super) fn enter(&mut self, card: OnsetCard, memory: &mut Memory) {
        self.card = Some(card);
        self.told = false;
        self.write(memory);
    }

    /// Tells, once, what a reader must know of the numbers.
    pub(super) fn tell(&mut self, now: &mut Now) {
        let (table, notices) = (&now.resources.table, &mut now.notices);
        if std::mem::replace(&mut self.told, true) {
            return;
        }
        notices.extend(
            self.card
                .iter()
                .flat_map(|card| card.warnings.iter().cloned()),
        );
        let Some(bounds) = &table.onset_bounds else {
            return;
        };
        let [exported, other] = &mut self.told_of_interval;
        if !std::mem::replace(exported, true) {
            let undetermined = bounds.undetermined.iter();
            notices.extend(undetermined.map(|why| format!("onset_speed as exported: {why}")));
        }
        if !*other && !is_as_exported(table, &now.memory.values) {
            *other = true;
            notices.push(OTHER_INTERVAL.into());
        }
    }

    fn write(&self, memory: &mut Memory) {
        let present = Present {
            onset: self.onset(),
            ..Present::default()
        };
        for (index, number) in &self.variables {
            memory.values[*index] = number.evaluate(&present).value;
        }
    }
}

/// Whether all that the onset follows from is as exported.
fn is_as_exported(table: &VariableTable, values: &[f64]) -> bool {
    let starts = starts(table);
    let mut each = table.variables().iter().zip(starts.iter().zip(values));
    each.all(|(variable, (start, value))| {
        start.to_bits() == value.to_bits() || Source::from_role(variable.role) != Source::Section
    })
}
