//! What an exported unit simulates, behind its variables and its life cycle.

use super::calculated::CalculatedNumbers;
use super::layout::Source;
use super::memory::{Memory, Now};
use crate::error::Result;
use crate::refusal::CallResult;
use crate::resources::Resources;
use crate::response::SectionState;
use crate::variables::{ComputedNumber, Role};
use std::fmt::Debug;

/// The system behind an instance. Everything that changes in time stands in the [`Memory`]; a unit holds what follows
/// from it and is made anew when it has changed.
pub(super) trait Unit: Debug + Send {
    /// Indices of the inputs, in the order of their rates; the wind speed comes first.
    fn inputs(&self) -> &[usize];

    /// The state of a new instance.
    fn at_rest(&self) -> SectionState;

    /// The stored value at `index`, of this kind, has been set, and was `before` where it has changed; returns whether outputs change
    /// all the same where it has not.
    fn value_set(
        &mut self,
        memory: &mut Memory,
        index: usize,
        source: Source,
        before: Option<f64>,
    ) -> bool;

    /// Whether states have been set by the unit itself since this was asked last.
    fn has_set_states(&mut self) -> bool {
        false
    }

    /// The importer will integrate it.
    fn will_be_integrated(&mut self) {}

    /// The importer has taken a step of its integration.
    ///
    /// # Errors
    /// A step that the inputs do not allow.
    fn step_taken(&mut self, _now: &mut Now) -> CallResult<()> {
        Ok(())
    }

    /// The rate of the input with this index has been set.
    fn input_rate_set(&mut self, _memory: &mut Memory, _index: usize) {}

    /// The initialisation begins.
    fn begin_initialization(&mut self) {}

    /// Another memory takes the place of the old one: whatever both share stays computed. `same`: whether the parameters are the same,
    /// and the limit of the search.
    fn replace(&mut self, new: &mut Memory, same: [bool; 2]);

    /// What follows from the parameters and, while initialising, the state, made anew where they have changed: the only way
    /// to anything that is computed from them.
    ///
    /// # Errors
    /// When the values give nothing that can be simulated.
    fn prepared(&mut self, resources: &Resources, memory: &mut Memory)
    -> Result<&mut dyn Prepared>;

    /// What is calculated from the parameters, of a unit that has such numbers.
    fn calculated(&mut self) -> Option<&mut CalculatedNumbers> {
        None
    }

    /// Says what a user must know of the parameters and of the present state, each thing once.
    fn watch(&mut self, now: &mut Now);

    /// The last step once more, where nothing has been set since and no input runs on: most steps, without the work that
    /// the others need. Returns whether there may be something to say of it; `None`, with everything as it was, where
    /// the step has to be taken by [`Prepared::advance`].
    fn repeat(&mut self, _memory: &mut Memory, _step: f64) -> Option<bool> {
        None
    }

    /// Writes all outputs into the memory where nothing has been set since a step by [`repeat`](Self::repeat); false where that
    /// needs [`Prepared::outputs`].
    fn repeat_outputs(&mut self, _memory: &mut Memory) -> bool {
        false
    }

    /// Entry of the state of what is simulated that the output at `index` is, if it is one.
    fn state_index(&self, index: usize) -> Option<usize>;
}

/// What a unit computes, with what follows from the parameters as they are, and derivatives of that in time and with respect to inputs,
/// states and parameters.
pub(super) trait Prepared: Unit {
    /// One step of `step` seconds from the time of the memory; returns whether the outputs after it are in the memory.
    /// On an error everything is as it was.
    ///
    /// # Errors
    /// When the step cannot be computed.
    fn advance(&mut self, memory: &mut Memory, step: f64) -> CallResult<bool>;

    /// Writes the rates of the state, per second, where an importer may integrate it.
    ///
    /// # Errors
    /// When they cannot be computed.
    fn state_rates(&mut self, memory: &Memory, rates: &mut [f64]) -> CallResult<()>;

    /// Rate of one state that is nothing else, by its index in [`Role::Filter`], where that needs less than all.
    fn filter_rate(&mut self, _memory: &Memory, _i: usize) -> Option<f64> {
        None
    }

    /// Writes all outputs into the memory.
    ///
    /// # Errors
    /// When they cannot be computed.
    fn outputs(&mut self, memory: &mut Memory) -> CallResult<()>;

    /// Writes what is calculated from the parameters into the memory.
    fn calculate(&mut self, _now: &mut Now) {}

    /// First time derivatives of these outputs, per second.
    ///
    /// # Errors
    /// When they cannot be computed.
    fn output_rates(&mut self, now: &mut Now, outputs: &[Role]) -> CallResult<Vec<f64>>;

    /// Derivatives of these unknowns with respect to the value at `known`.
    ///
    /// # Errors
    /// When they do not exist.
    fn derivatives(
        &mut self,
        now: &mut Now,
        known: usize,
        unknowns: &[Role],
    ) -> CallResult<Vec<f64>>;

    /// One number of the present moment; what cannot be found is zero, with a notice.
    fn present(&mut self, _now: &mut Now, _number: &ComputedNumber) -> f64 {
        0.0
    }
}
