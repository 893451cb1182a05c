//! The band of a motion that is not a series of sines: where its power lies, from averaged periodograms (Welch 1967).

use crate::signal::mean;
use nalgebra::Complex;
use rustfft::FftPlanner;
use std::f64::consts::TAU;

/// Samples of a periodogram: 41 s at 200 Hz, a resolution of 0.05 Hz.
const BLOCK: usize = 8192;
/// Part of the power that is left out at either end of the band.
const LEFT_OUT: f64 = 0.01;

/// Lower and upper end of the band that holds the power of all motions together, radians a sample; `None` for motions
/// that never move.
pub(super) fn band(motions: &[Vec<f64>]) -> Option<(f64, f64)> {
    let power = power(motions);
    let total: f64 = power.iter().sum();
    if !(total > 0.0 && total.is_finite()) {
        return None;
    }
    let mut sum = 0.0;
    let cumulative: Vec<f64> = power
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

/// Sum of the periodograms of blocks that overlap by half, without their mean, under a Hann window; the last block is
/// what no whole one has held with its full weight, padded with zeros.
fn power(motions: &[Vec<f64>]) -> Vec<f64> {
    let transform = FftPlanner::new().plan_fft_forward(BLOCK);
    let mut power = vec![0.0; BLOCK / 2];
    let count = motions.first().map_or(0, Vec::len);
    for start in (0..).step_by(BLOCK / 2) {
        for motion in motions {
            let samples = &motion[start..count.min(start + BLOCK)];
            let mean = mean(samples);
            let step = TAU / samples.len().max(1) as f64;
            let windowed = samples
                .iter()
                .enumerate()
                .map(|(k, x)| (x - mean) * (0.5 - 0.5 * (step * k as f64).cos()));
            let mut spectrum: Vec<Complex<f64>> = windowed.map(Complex::from).collect();
            spectrum.resize(BLOCK, Complex::default());
            transform.process(&mut spectrum);
            for (power, z) in power.iter_mut().zip(&spectrum) {
                *power += z.norm_sqr();
            }
        }
        if start + BLOCK > count {
            break;
        }
    }
    power
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two sines of equal size are the ends of the band, to the resolution of the window (two bins); a mean does not count.
    #[test]
    fn the_ends_are_where_the_power_is() {
        let (low, high) = (TAU * 0.3 / 200.0, TAU * 2.5 / 200.0);
        let bin = TAU / BLOCK as f64;
        for (samples, resolution) in [(40_000, 2.0), (3_000, 6.0)] {
            let sines =
                (0..samples).map(|k| 7.0 + (low * k as f64).sin() + (high * k as f64).sin());
            let (a, b) = band(&[sines.collect()]).unwrap();
            assert!((a - low).abs() < resolution * bin, "{a} {low}");
            assert!((b - high).abs() < resolution * bin, "{b} {high}");
        }
        assert_eq!(band(&[vec![0.0; 20_000]]), None);
        assert_eq!(band(&[Vec::new()]), None);
    }
}
