//! Step and output matrices, kept per wind speed and step size.

use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::state_space::{StepMatrices, c2d};

/// Pairs of wind speed and step size that are remembered. Importers whose step jitters in the last bits come back to a
/// handful of values; a wind speed that never repeats needs no more.
const CAPACITY: usize = 32;

/// Rows are padded to whole groups of this many, so that the inner loop has a fixed length.
const LANES: usize = 4;

/// A matrix stored for `y = W v`, in groups of rows.
#[derive(Debug, Clone)]
pub(super) struct Packed {
    rows: usize,
    columns: usize,
    /// For each group of `LANES` rows, the columns one after the other.
    data: Vec<[f64; LANES]>,
}

impl Packed {
    fn new(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> f64) -> Self {
        let data = (0..rows.div_ceil(LANES))
            .flat_map(|group| (0..columns).map(move |j| (group, j)))
            .map(|(group, j)| {
                std::array::from_fn(|lane| {
                    let i = group * LANES + lane;
                    if i < rows { entry(i, j) } else { 0.0 }
                })
            })
            .collect();
        Self {
            rows,
            columns,
            data,
        }
    }
}

/// Sums that run side by side, so that no addition waits for the one before it.
const PARTIAL_SUMS: usize = 4;

/// `y = W v` over the first `v.len()` columns, which may be fewer than `W` has.
pub(super) fn apply(w: &Packed, v: &[f64], y: &mut [f64]) {
    let y = &mut y[..w.rows];
    for (out, columns) in y.chunks_mut(LANES).zip(w.data.chunks_exact(w.columns)) {
        let columns = &columns[..v.len()];
        let mut sums = [[0.0; LANES]; PARTIAL_SUMS];
        let four_columns = columns.chunks_exact(PARTIAL_SUMS);
        let four_values = v.chunks_exact(PARTIAL_SUMS);
        let rest = four_columns.remainder().iter().zip(four_values.remainder());
        for (four, x) in four_columns.zip(four_values) {
            for part in 0..PARTIAL_SUMS {
                for lane in 0..LANES {
                    sums[part][lane] += four[part][lane] * x[part];
                }
            }
        }
        for (part, (column, x)) in rest.enumerate() {
            for lane in 0..LANES {
                sums[part][lane] += column[lane] * x;
            }
        }
        for (lane, y) in out.iter_mut().enumerate() {
            *y = (sums[0][lane] + sums[1][lane]) + (sums[2][lane] + sums[3][lane]);
        }
    }
}

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
    outputs: Recent<u64>,
}

impl StepCache {
    /// Step of the whole continuous system.
    pub(super) fn full_system(
        &mut self,
        section: &CoupledSection,
        speed: f64,
        step: f64,
    ) -> Result<&Packed> {
        self.steps.get((speed.to_bits(), step.to_bits()), || {
            Ok(pack(&section.continuous_at(speed)?.c2d(step)?))
        })
    }

    /// Step of the structure alone under a given force, for the sampled model.
    pub(super) fn structure(&mut self, section: &CoupledSection, step: f64) -> Result<&Packed> {
        self.steps.get((0, step.to_bits()), || {
            let (a, b) = section.structure_alone();
            Ok(pack(&c2d(&a, &b, step)?))
        })
    }

    pub(super) fn output_rows(&mut self, section: &CoupledSection, speed: f64) -> Result<&Packed> {
        self.outputs.get(speed.to_bits(), || {
            let (c, d) = section.output_matrices(speed)?;
            let (n, states) = (section.structure().dofs.len(), section.states());
            Ok(Packed::new(2 * n, states + n, |i, j| {
                if j < states {
                    c[(2 * n + i, j)]
                } else {
                    d[(2 * n + i, j - states)]
                }
            }))
        })
    }
}

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
