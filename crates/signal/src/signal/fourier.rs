//! Discrete Fourier transforms of real signals.

use rustfft::num_complex::Complex64;
use rustfft::{Fft, FftPlanner};
use std::sync::{Arc, OnceLock};

/// Transforms of one length `N`, there and back; each is planned when it is first asked for.
pub struct Fourier {
    length: usize,
    forward: OnceLock<Arc<dyn Fft<f64>>>,
    inverse: OnceLock<Arc<dyn Fft<f64>>>,
}

impl Fourier {
    /// For signals of at most `length` samples.
    pub fn new(length: usize) -> Self {
        Self {
            length,
            forward: OnceLock::new(),
            inverse: OnceLock::new(),
        }
    }

    /// `N`.
    pub fn length(&self) -> usize {
        self.length
    }

    /// Replaces `x_k` by `X_n = Σ_k x_k exp(−2πi kn/N)`.
    pub fn forward(&self, values: &mut [Complex64]) {
        let plan = || FftPlanner::new().plan_fft_forward(self.length);
        self.forward.get_or_init(plan).process(values);
    }

    /// Replaces `X_n` by `Σ_n X_n exp(2πi kn/N)`, which is `N x_k`, in memory that the caller keeps from one transform to the next.
    pub fn inverse_in(&self, values: &mut [Complex64], scratch: &mut Vec<Complex64>) {
        let plan = || FftPlanner::new().plan_fft_inverse(self.length);
        let plan = self.inverse.get_or_init(plan);
        scratch.resize(plan.get_inplace_scratch_len(), Complex64::default());
        plan.process_with_scratch(values, scratch);
    }

    /// The spectrum of a signal; a shorter one is followed by zeros.
    pub fn spectrum(&self, signal: impl IntoIterator<Item = f64>) -> Vec<Complex64> {
        let mut spectrum: Vec<Complex64> = signal.into_iter().map(Complex64::from).collect();
        spectrum.resize(self.length, Complex64::default());
        self.forward(&mut spectrum);
        spectrum
    }

    /// A real signal times `N` from its spectrum.
    pub fn sums(&self, mut spectrum: Vec<Complex64>) -> Vec<f64> {
        self.inverse_in(&mut spectrum, &mut Vec::new());
        spectrum.iter().map(|z| z.re).collect()
    }
}
