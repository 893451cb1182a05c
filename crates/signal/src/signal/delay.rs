//! By how much one signal is later than another, to a small part of a sample.
//!
//! The whole lag is that of the largest cross-correlation; a parabola through it and its neighbours gives a fraction, and
//! the slope of the phase of the cross-spectrum, `arg X₂X̄₁ = −ωδ` weighted by `ω²|X₁X₂|²`, refines it: for equal signals up to
//! noise this is the maximum-likelihood delay (Knapp & Carter 1976, IEEE Trans. ASSP 24(4), with the noise white).

use super::Complex64;
use super::correlation::{CrossCorrelation, cross_spectrum};
use std::f64::consts::TAU;

/// Bins below this part of the largest of the cross-spectrum carry noise.
const FLOOR: f64 = 1e-4;

/// Refinements of the fraction; each leaves the square of the error of the one before.
const REFINEMENTS: usize = 3;

/// Delay of `compared` against `reference`, samples, and the same by the parabola alone; the shorter signal is continued by zeros, so both should begin and end near zero.
/// `None` when a signal is zero throughout, or nowhere like the other.
pub fn delay(reference: &[f64], compared: &[f64]) -> Option<(f64, f64)> {
    let count = reference.len().max(compared.len());
    let padded = |x: &[f64]| {
        let mut x = x.to_vec();
        x.resize(count, 0.0);
        x
    };
    let (first, second) = (padded(reference), padded(compared));
    let correlation = CrossCorrelation::new(&first, &second);
    let whole = correlation.largest();
    let at = |lag| correlation.at(lag);
    if at(whole) <= 0.0 {
        return None;
    }
    let curvature = at(whole - 1) - 2.0 * at(whole) + at(whole + 1);
    let vertex = match curvature < 0.0 {
        true => 0.5 * (at(whole - 1) - at(whole + 1)) / curvature,
        false => 0.0,
    };
    let parabolic_samples = whole as f64 + vertex.clamp(-0.5, 0.5);
    let samples = by_phase_slope(&first, &second, parabolic_samples);
    Some((samples, parabolic_samples))
}

/// Refines `start` by the slope of the phase of the cross-spectrum.
fn by_phase_slope(reference: &[f64], compared: &[f64], start: f64) -> f64 {
    let cross = cross_spectrum(reference, compared);
    let size = cross.len();
    let half = &cross[..size / 2];
    let largest = half.iter().map(|z| z.norm()).fold(0.0, f64::max);
    let mut delay = start;
    for _ in 0..REFINEMENTS {
        let (mut above, mut below) = (0.0, 0.0);
        for (bin, z) in half.iter().enumerate() {
            let size_here = z.norm();
            if size_here < FLOOR * largest {
                continue;
            }
            let omega = TAU * bin as f64 / size as f64;
            let phase = (z * Complex64::from_polar(1.0, omega * delay)).arg();
            let weight = size_here * size_here;
            above -= weight * omega * phase;
            below += weight * omega * omega;
        }
        if below > 0.0 {
            delay += above / below;
        }
    }
    delay
}

#[cfg(test)]
mod tests {
    use super::*;

    fn burst(t: f64) -> f64 {
        (-((t - 600.0) / 150.0).powi(2)).exp() * (TAU * t / 80.0).sin()
    }

    #[test]
    fn fractions_of_a_sample_are_found() {
        let reference: Vec<f64> = (0..1200).map(|k| burst(f64::from(k))).collect();
        for shift in [0.0, 0.4, -7.3, 61.25] {
            let compared: Vec<f64> = (0..1300).map(|k| burst(f64::from(k) - shift)).collect();
            let (samples, parabolic_samples) = delay(&reference, &compared).unwrap();
            // the burst is band-limited to 1e-12 and ends at e^(−16)
            assert!((samples - shift).abs() < 1e-6, "{samples}");
            assert!((parabolic_samples - shift).abs() < 1e-2);
        }
    }

    #[test]
    fn nothing_alike_is_an_error() {
        assert!(delay(&[0.0; 30], &[1.0; 30]).is_none());
    }
}
