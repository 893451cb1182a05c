//! Discrete Fourier transforms of real signals.

use rustfft::num_complex::Complex64;
use rustfft::{Fft, FftPlanner};
use std::sync::Arc;

/// Transforms of one length `N`, there and back.
pub(crate) struct Fourier {
    length: usize,
    pub(crate) forward: Arc<dyn Fft<f64>>,
    pub(crate) inverse: Arc<dyn Fft<f64>>,
}

impl Fourier {
    /// For signals of at most `length` samples.
    pub(crate) fn new(length: usize) -> Self {
        let mut planner = FftPlanner::new();
        Self {
            length,
            forward: planner.plan_fft_forward(length),
            inverse: planner.plan_fft_inverse(length),
        }
    }

    /// `N`.
    pub(crate) fn length(&self) -> usize {
        self.length
    }

    /// `X_n = Σ_k x_k exp(−2πi kn/N)`; a shorter signal is followed by zeros.
    pub(crate) fn spectrum(&self, signal: impl IntoIterator<Item = f64>) -> Vec<Complex64> {
        let mut spectrum: Vec<Complex64> = signal.into_iter().map(Complex64::from).collect();
        spectrum.resize(self.length, Complex64::default());
        self.forward.process(&mut spectrum);
        spectrum
    }

    /// Real part of `Σ_n X_n exp(2πi kn/N)`: a signal times `N` from its spectrum.
    pub(crate) fn sums(&self, mut spectrum: Vec<Complex64>) -> Vec<f64> {
        self.inverse.process(&mut spectrum);
        spectrum.iter().map(|z| z.re).collect()
    }
}
