//! Step matrices, kept per wind speed and step size, and what their columns meet.

use super::packed::Packed;
use super::values::Inputs;
use crate::error::Result;
use nalgebra::DMatrix;

/// Matrices that are remembered. Importers whose step jitters in the last bits come back to a handful of values; a wind speed
/// that never repeats needs no more.
const CAPACITY: usize = 32;

/// Step matrices by wind speed, step size and the like. Least recently used ones leave first; the one used last is found first.
#[derive(Debug, Clone, Default)]
pub(super) struct StepCache<const KEYS: usize> {
    entries: Vec<([u64; KEYS], Packed)>,
}

impl<const KEYS: usize> StepCache<KEYS> {
    /// The matrix for a key, made where it is not known; from now on the newest one.
    pub(super) fn get(
        &mut self,
        key: [f64; KEYS],
        make: impl FnOnce() -> Result<DMatrix<f64>>,
    ) -> Result<&Packed> {
        let key = key.map(f64::to_bits);
        match self.entries.iter().position(|(k, _)| *k == key) {
            Some(0) => {}
            Some(at) => self.entries[..=at].rotate_right(1),
            None => {
                let entry = Packed::new(&make()?);
                self.entries.truncate(CAPACITY - 1);
                self.entries.insert(0, (key, entry));
            }
        }
        Ok(&self.entries[0].1)
    }

    /// The matrix used last.
    #[inline]
    pub(super) fn newest(&self) -> Option<&Packed> {
        self.entries.first().map(|(_, step)| step)
    }
}

/// Writes `[z, w, ẇ]`, what the columns of a step meet. Apart, so that steps without a force need no room for it.
#[inline(never)]
pub(super) fn load(operand: &mut [f64], values: &[f64], inputs: &Inputs) {
    let (z, rest) = operand.split_at_mut(values.len());
    let (w, rate) = rest.split_at_mut(inputs.force.len());
    z.copy_from_slice(values);
    w.copy_from_slice(&inputs.force);
    rate.copy_from_slice(&inputs.force_rate);
}

/// Columns of `[Φ, Γ₀, Γ₁]` that meet something other than zero.
pub(super) fn active_columns(inputs: &Inputs, states: usize) -> usize {
    // without a branch for each
    let zero = |v: &[f64]| v.iter().fold(0, |bits, x| bits | (x.to_bits() << 1)) == 0;
    let n = inputs.force.len();
    match (zero(&inputs.force), zero(&inputs.force_rate)) {
        (_, false) => states + 2 * n,
        (false, true) => states + n,
        (true, true) => states,
    }
}
