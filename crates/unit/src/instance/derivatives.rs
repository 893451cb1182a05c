//! Derivatives: of outputs in time, and of unknowns with respect to inputs, initial values and parameters.

use super::Instance;
use super::layout::{DataType, Source};
use super::values::check_order;
use crate::lifecycle::State;
use crate::refusal::{CallResult, Refusal};
use crate::variables::{Causality, Role};

/// Refuses directions that are none.
pub(crate) fn check_seed(seed: &[f64]) -> CallResult<()> {
    match seed.iter().find(|s| !s.is_finite()) {
        None => Ok(()),
        Some(found) => Err(Refusal::error(format!(
            "seed: expected finite numbers, found {found}"
        ))),
    }
}

/// Refuses derivatives that no number holds.
pub(crate) fn check_derivatives(found: &[f64]) -> CallResult<()> {
    if found.iter().all(|x| x.is_finite()) {
        return Ok(());
    }
    Err(Refusal::discard("derivative: overflow"))
}

impl Instance {
    /// First time derivatives of outputs, per second, with the current input rates.
    ///
    /// # Errors
    /// A reference that is no output, or another order than one.
    pub(crate) fn output_rates(
        &mut self,
        references: &[u32],
        orders: &[i32],
        rates: &mut [f64],
    ) -> CallResult<()> {
        let output = |(reference, order): (&u32, &i32)| {
            let role = self.response_of(*reference)?;
            check_order(*order).map(|()| role)
        };
        let outputs = references.iter().zip(orders).map(output);
        let outputs = outputs.collect::<CallResult<Vec<_>>>()?;
        if outputs.is_empty() {
            return Ok(());
        }
        let now = &mut self.now;
        let unit = self.unit.prepared(&now.resources, &mut now.memory)?;
        let found = unit.output_rates(now, &outputs)?;
        rates.copy_from_slice(&found);
        Ok(())
    }

    /// `Σ (∂unknown/∂known) seed`: outputs and rates of states with respect to inputs and states; while initialising outputs,
    /// states, their rates and calculated parameters with respect to inputs, initial values (exact) and section properties
    /// (central differences).
    ///
    /// # Errors
    /// References that are no such unknowns or knowns in the current state; a derivative that does not exist.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seeds: &[f64],
        results: &mut [f64],
    ) -> CallResult<()> {
        let unknowns = unknowns
            .iter()
            .map(|r| self.unknown(*r))
            .collect::<CallResult<Vec<_>>>()?;
        let knowns = knowns
            .iter()
            .map(|r| self.known(*r))
            .collect::<CallResult<Vec<_>>>()?;
        check_seed(seeds)?;
        let now = &mut self.now;
        let unit = self.unit.prepared(&now.resources, &mut now.memory)?;
        let mut sums = vec![0.0; unknowns.len()];
        for (known, seed) in knowns.into_iter().zip(seeds) {
            let column = unit.derivatives(now, known, &unknowns)?;
            for (sum, derivative) in sums.iter_mut().zip(column) {
                *sum += seed * derivative;
            }
        }
        check_derivatives(&sums)?;
        results.copy_from_slice(&sums);
        Ok(())
    }

    fn response_of(&self, reference: u32) -> CallResult<Role> {
        let (index, access) = self.typed(reference, DataType::Real)?;
        let variable = &self.table().variables()[index];
        let computed = matches!(access.source, Source::Response | Source::Status);
        if computed && variable.causality == Causality::Output {
            Ok(variable.role)
        } else {
            Err(Refusal::error(format!("`{}` is no output", variable.name)))
        }
    }

    fn unknown(&self, reference: u32) -> CallResult<Role> {
        let (index, access) = self.typed(reference, DataType::Real)?;
        let variable = &self.table().variables()[index];
        match access.source {
            Source::Response | Source::Status | Source::State | Source::Rate => Ok(variable.role),
            Source::Calculated if self.now.memory.state == State::Initialization => {
                Ok(variable.role)
            }
            _ => Err(self.refused(index, "unknown")),
        }
    }

    /// Index of a known.
    fn known(&self, reference: u32) -> CallResult<usize> {
        let (index, access) = self.typed(reference, DataType::Real)?;
        let initializing = self.now.memory.state == State::Initialization;
        match access.source {
            Source::Input => Ok(index),
            Source::Section | Source::Turbulence if initializing => Ok(index),
            Source::Release | Source::Limit if initializing => Ok(index),
            Source::Response | Source::State if !initializing && self.is_seen_state(index) => {
                Ok(index)
            }
            _ => Err(self.refused(index, "known")),
        }
    }

    /// Whether it is a state that the description lists.
    fn is_seen_state(&self, index: usize) -> bool {
        self.offers_model_exchange() && self.table().variables()[index].is_state()
    }

    fn refused(&self, index: usize, what: &str) -> Refusal {
        Refusal::error(format!(
            "directional derivative: `{}` is no {what} in the state `{}`",
            self.table().variables()[index].name,
            self.now.memory.state.name()
        ))
    }
}
