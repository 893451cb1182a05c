//! The fourth-order Butterworth low-pass of the continuous models, exactly discretised.

use crate::error::Result;
use crate::identification::least_squares::BLOCK_ROWS;
use crate::state_space::{StepMatrices, c2d};
use nalgebra::{DMatrix, DVector};
use std::array::from_fn;

/// Order of the low-pass.
pub(super) const ORDER: usize = 4;
/// `s⁴ + 2.61 s³ + 3.41 s² + 2.61 s + 1`: Butterworth of order four, from `s⁰` on; `2.61 = √(4 + 2√2)`, `3.41 = 2 + √2`.
const BUTTERWORTH: [f64; ORDER] = [
    1.0,
    2.613_125_929_752_753,
    3.414_213_562_373_095,
    2.613_125_929_752_753,
];

/// Noise bandwidth of the low-pass over its cut-off, `(π/2n)/sin(π/2n)` with `n = 4`.
pub(crate) const NOISE_BANDWIDTH: f64 = 1.026_172_152_977_031;

/// Low-pass in dimensionless time, `w = (r_f, r_f', r_f'', r_f''')`, with the cut-off `Ω = 2πf_c B/V`.
pub(super) fn low_pass(omega: f64) -> (DMatrix<f64>, DVector<f64>) {
    let mut a = DMatrix::zeros(ORDER, ORDER);
    a.view_mut((0, 1), (ORDER - 1, ORDER - 1))
        .fill_with_identity();
    for (m, c) in BUTTERWORTH.iter().enumerate() {
        a[(ORDER - 1, m)] = -c * omega.powi((ORDER - m) as i32);
    }
    let mut b = DVector::zeros(ORDER);
    b[ORDER - 1] = omega.powi(ORDER as i32);
    (a, b)
}

/// `z[k] = Φ z[k−1] + γ₀ u[k−1] + γ₁ u[k]`, the first-order hold between samples.
pub(super) fn hold(a: &DMatrix<f64>, b: &DVector<f64>, step: f64) -> Result<StepMatrices> {
    let b = DMatrix::from_column_slice(b.len(), 1, b.as_slice());
    let mut hold = c2d(a, &b, step)?;
    hold.gamma_1 /= step;
    hold.gamma_0 -= &hold.gamma_1;
    Ok(hold)
}

/// The low-pass of one channel and what it has put out for the current chunk.
pub(super) struct Filtered {
    state: [f64; ORDER],
    /// Samples of the chunk after the one before it.
    pub input: Vec<f64>,
    /// States at the same instants as `input`, the one before the chunk first.
    pub states: [Vec<f64>; ORDER],
    pub started: bool,
}

impl Filtered {
    pub(super) fn new() -> Self {
        Self {
            state: [0.0; ORDER],
            input: vec![0.0],
            states: from_fn(|_| Vec::with_capacity(BLOCK_ROWS + 1)),
            started: false,
        }
    }

    /// Takes the samples of a chunk; states of the instants after the first are still to come.
    pub(super) fn take(&mut self, samples: &[f64]) {
        let before = self.input[self.input.len() - 1];
        self.input.clear();
        if self.started {
            self.input.push(before);
        } else {
            // as if the first value had always been there
            self.input.push(samples[0]);
            self.state = [samples[0], 0.0, 0.0, 0.0];
            self.started = true;
        }
        self.input.extend_from_slice(samples);
        for (column, x) in self.states.iter_mut().zip(self.state) {
            column.resize(samples.len() + 1, 0.0);
            column[0] = x;
        }
    }
}

/// Step of the low-pass.
pub(super) struct LowPassStep {
    /// Column after column.
    phi: [[f64; ORDER]; ORDER],
    g0: [f64; ORDER],
    g1: [f64; ORDER],
}

impl LowPassStep {
    pub(super) fn new(hold: &StepMatrices) -> Self {
        Self {
            phi: from_fn(|n| from_fn(|m| hold.phi[(m, n)])),
            g0: from_fn(|m| hold.gamma_0[m]),
            g1: from_fn(|m| hold.gamma_1[m]),
        }
    }

    /// The chunk that all channels have taken, some channels side by side: a sample waits for the one before it.
    pub(super) fn advance(&self, channels: Vec<&mut Filtered>) {
        let mut channels = channels.into_iter();
        let arch = pulp::Arch::new();
        loop {
            match [channels.next(), channels.next(), channels.next()] {
                [Some(a), Some(b), Some(c)] => arch.dispatch(SideBySide(self, [a, b, c])),
                [Some(a), Some(b), None] => return arch.dispatch(SideBySide(self, [a, b])),
                [Some(a), ..] => return arch.dispatch(SideBySide(self, [a])),
                _ => return,
            }
        }
    }
}

/// Channels that go through the low-pass together.
struct SideBySide<'a, const N: usize>(&'a LowPassStep, [&'a mut Filtered; N]);

impl<const N: usize> pulp::NullaryFnOnce for SideBySide<'_, N> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self(step, channels) = self;
        let rows = channels.iter().map(|c| c.input.len()).min().unwrap_or(0);
        let mut channels = channels.map(|c| {
            (
                &mut c.state,
                &c.input[..rows],
                c.states.each_mut().map(|s| &mut s[..rows]),
            )
        });
        let mut w = channels.each_ref().map(|(state, ..)| **state);
        for k in 1..rows {
            for (w, (_, input, states)) in w.iter_mut().zip(&mut channels) {
                let mut next: [f64; ORDER] =
                    from_fn(|m| step.g0[m] * input[k - 1] + step.g1[m] * input[k]);
                for (column, w) in step.phi.iter().zip(&*w) {
                    for (next, phi) in next.iter_mut().zip(column) {
                        *next += phi * w;
                    }
                }
                *w = next;
                for (states, next) in states.iter_mut().zip(next) {
                    states[k] = next;
                }
            }
        }
        for ((state, ..), w) in channels.into_iter().zip(w) {
            *state = w;
        }
    }
}
