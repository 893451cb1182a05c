//! The band of a motion that is not a series of sines: where its power lies, from averaged periodograms in bounded memory
//! (Welch 1967).

use super::slices::Slice;
use nalgebra::Complex;
use rustfft::{Fft, FftPlanner};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Samples of a periodogram: 41 s at 200 Hz, a resolution of 0.05 Hz.
const BLOCK: usize = 8192;
/// Part of the power that is left out at either end of the band.
const LEFT_OUT: f64 = 0.01;

/// Power of the dimensionless motion over frequency, all inputs together.
pub(super) struct BandEstimate {
    waiting: Vec<Vec<f64>>,
    power: Vec<f64>,
    transform: Arc<dyn Fft<f64>>,
}

impl BandEstimate {
    pub fn new(inputs: usize) -> Self {
        Self {
            waiting: vec![Vec::with_capacity(2 * BLOCK); inputs],
            power: vec![0.0; BLOCK / 2],
            transform: FftPlanner::new().plan_fft_forward(BLOCK),
        }
    }

    pub fn take(&mut self, slice: &Slice<'_>) {
        for (waiting, motion) in self.waiting.iter_mut().zip(&slice.motion) {
            waiting.extend_from_slice(motion);
        }
        while self.waiting.first().is_some_and(|w| w.len() >= BLOCK) {
            self.add_block();
            for waiting in &mut self.waiting {
                waiting.drain(..BLOCK / 2);
            }
        }
    }

    /// Lower and upper end of the band, radians a sample; `None` for a motion that never moves.
    pub fn band(mut self) -> Option<(f64, f64)> {
        // what no whole block has held with its full weight; a short record is nothing else
        self.add_block();
        let total: f64 = self.power.iter().sum();
        if !(total > 0.0 && total.is_finite()) {
            return None;
        }
        let mut sum = 0.0;
        let cumulative: Vec<f64> = self
            .power
            .iter()
            .map(|p| {
                sum += p / total;
                sum
            })
            .collect();
        let at = |part: f64| {
            let bin = cumulative.iter().position(|c| *c >= part);
            TAU * bin.unwrap_or(BLOCK / 2 - 1).max(1) as f64 / BLOCK as f64
        };
        Some((at(LEFT_OUT), at(1.0 - LEFT_OUT)))
    }

    /// Adds the periodogram of the first samples that wait, without their mean, under a Hann window; a short record is
    /// padded with zeros.
    fn add_block(&mut self) {
        for waiting in &self.waiting {
            let samples = &waiting[..waiting.len().min(BLOCK)];
            let mean = samples.iter().sum::<f64>() / samples.len().max(1) as f64;
            let step = TAU / samples.len().max(1) as f64;
            let windowed = samples
                .iter()
                .enumerate()
                .map(|(k, x)| (x - mean) * (0.5 - 0.5 * (step * k as f64).cos()));
            let mut spectrum: Vec<Complex<f64>> = windowed.map(Complex::from).collect();
            spectrum.resize(BLOCK, Complex::default());
            self.transform.process(&mut spectrum);
            for (power, z) in self.power.iter_mut().zip(&spectrum) {
                *power += z.norm_sqr();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn band(motion: &[f64]) -> Option<(f64, f64)> {
        let mut estimate = BandEstimate::new(1);
        for (i, part) in motion.chunks(1000).enumerate() {
            estimate.take(&Slice {
                motion: vec![part],
                force: Vec::new(),
                first: 1000 * i,
            });
        }
        estimate.band()
    }

    /// Two sines of equal size are the ends of the band, to the resolution of the window (two bins); a mean does not count.
    #[test]
    fn the_ends_are_where_the_power_is() {
        let (low, high) = (TAU * 0.3 / 200.0, TAU * 2.5 / 200.0);
        let bin = TAU / BLOCK as f64;
        for (samples, resolution) in [(40_000, 2.0), (3_000, 6.0)] {
            let sines =
                (0..samples).map(|k| 7.0 + (low * k as f64).sin() + (high * k as f64).sin());
            let (a, b) = band(&sines.collect::<Vec<_>>()).unwrap();
            assert!((a - low).abs() < resolution * bin, "{a} {low}");
            assert!((b - high).abs() < resolution * bin, "{b} {high}");
        }
        assert_eq!(band(&[0.0; 20_000]), None);
        assert_eq!(band(&[]), None);
    }
}
