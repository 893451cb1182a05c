//! Step and output matrices, kept per wind speed and step size.

use super::gusts::Gusts;
use super::packed::{Packed, apply};
use super::sampling::Sampling;
use super::values::Inputs;
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::state_space::{StateEquation, StepMatrices, c2d};
use nalgebra::DMatrix;

/// Pairs of wind speed and step size that are remembered. Importers whose step jitters in the last bits come back to a
/// handful of values; a wind speed that never repeats needs no more.
const CAPACITY: usize = 32;

/// Least recently used entries leave first; the one used last is found first.
#[derive(Debug, Clone)]
struct Recent<K> {
    entries: Vec<(K, Packed)>,
}

impl<K: PartialEq + Copy> Recent<K> {
    fn get(&mut self, key: K, make: impl FnOnce() -> Result<Packed>) -> Result<&Packed> {
        match self.entries.iter().position(|(k, _)| *k == key) {
            Some(0) => {}
            Some(at) => self.entries[..=at].rotate_right(1),
            None => {
                let entry = make()?;
                self.entries.truncate(CAPACITY - 1);
                self.entries.insert(0, (key, entry));
            }
        }
        Ok(&self.entries[0].1)
    }
}

impl<K> Default for Recent<K> {
    fn default() -> Self {
        Self {
            entries: Vec::new(),
        }
    }
}

#[derive(Debug, Clone, Default)]
pub(super) struct StepCache {
    steps: Recent<(u64, u64)>,
    in_gusts: Recent<(u64, u64)>,
    samples: Recent<[u64; 3]>,
}

impl StepCache {
    /// Makes the step of the whole continuous system the newest one.
    pub(super) fn full_system(
        &mut self,
        section: &CoupledSection,
        speed: f64,
        step: f64,
    ) -> Result<()> {
        self.steps.get((speed.to_bits(), step.to_bits()), || {
            Ok(pack(&section.continuous_at(speed)?.c2d(step)?))
        })?;
        Ok(())
    }

    /// Step of the whole continuous system with its lagging gusts.
    pub(super) fn in_gusts(
        &mut self,
        section: &CoupledSection,
        gusts: &Gusts,
        speed: f64,
        step: f64,
    ) -> Result<&Packed> {
        self.in_gusts.get((speed.to_bits(), step.to_bits()), || {
            let StateEquation { a, b } = gusts.system(section, speed)?;
            Ok(pack(&c2d(&a, &b, step)?))
        })
    }

    /// Whether the newest step is that of this wind and this size.
    #[inline]
    pub(super) fn is_newest(&self, speed: f64, step: f64) -> bool {
        let newest = self.steps.entries.first();
        newest.is_some_and(|(key, _)| *key == (speed.to_bits(), step.to_bits()))
    }

    /// The step used last.
    #[inline]
    pub(super) fn newest(&self) -> Option<&Packed> {
        self.steps.entries.first().map(|(_, step)| step)
    }

    /// Step of the structure alone under a given force, for the sampled model.
    pub(super) fn structure(&mut self, section: &CoupledSection, step: f64) -> Result<&Packed> {
        self.steps.get((0, step.to_bits()), || {
            let alone = section.structure_alone();
            Ok(pack(&c2d(&alone.a, &alone.b, step)?))
        })
    }

    /// So many samples of a sampled model in a steady wind, from one on: what unit numbers of `[z, w, ẇ]` become.
    pub(super) fn samples(
        &mut self,
        section: &CoupledSection,
        sampling: &mut Sampling,
        wind: f64,
        [step, count]: [f64; 2],
    ) -> Result<&Packed> {
        let key = [wind, step, count].map(f64::to_bits);
        self.samples.get(key, || {
            let alone = section.structure_alone();
            let structure = pack(&c2d(&alone.a, &alone.b, step)?);
            let (states, n) = (section.states(), alone.b.ncols());
            let mut matrix = DMatrix::zeros(states, states + 2 * n);
            for (j, mut column) in matrix.column_iter_mut().enumerate() {
                let mut z = vec![0.0; states + 2 * n];
                z[j] = 1.0;
                let mut external = z.split_off(states);
                for _ in 0..count as usize {
                    let mut operand = [&z[..2 * n], &external].concat();
                    for (w, held) in operand[2 * n..3 * n]
                        .iter_mut()
                        .zip(sampling.force(&z, wind))
                    {
                        *w += held;
                    }
                    apply(&structure, &operand, &mut z[..2 * n]);
                    sampling.sample(&mut z);
                    let (w, rates) = external.split_at_mut(n);
                    w.iter_mut()
                        .zip(rates)
                        .for_each(|(w, rate)| *w += *rate * step);
                }
                column.copy_from_slice(&z);
            }
            Ok(Packed::from_matrix(&matrix))
        })
    }
}

/// Columns of a step: `[Φ, Γ₀, Γ₁]`.
fn pack(s: &StepMatrices) -> Packed {
    let (n, m) = s.gamma_0.shape();
    Packed::new(n, n + 2 * m, |i, j| {
        if j < n {
            s.phi[(i, j)]
        } else if j < n + m {
            s.gamma_0[(i, j - n)]
        } else {
            s.gamma_1[(i, j - n - m)]
        }
    })
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
