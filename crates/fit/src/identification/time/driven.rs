//! Which motions of a record are driven, and at which reduced frequencies.

use super::signals::Signals;
use crate::error::Result;
use crate::signal::{Fourier, largest_about_mean, mean};
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use std::f64::consts::TAU;

/// A motion above this part of the greatest is driven as well.
pub(crate) const DRIVEN_TOO: f64 = 0.2;
/// Samples of a periodogram: 41 s at 200 Hz, a resolution of 0.05 Hz.
const PERIODOGRAM: usize = 8192;
/// Part of the power that is left out at either end of the band.
const LEFT_OUT: f64 = 0.01;

/// Of motions over the same time those that are driven: the others follow.
pub(super) fn driven_motions(motions: &[Vec<f64>]) -> Vec<usize> {
    driven(motions.iter().map(|m| largest_about_mean(m)).collect())
}

/// Of motions of these sizes those that are driven: not below [`DRIVEN_TOO`] of the greatest, and not zero.
pub(crate) fn driven(sizes: Vec<f64>) -> Vec<usize> {
    let least = DRIVEN_TOO * sizes.iter().copied().fold(0.0, f64::max);
    let all = sizes.into_iter().enumerate();
    let driven = all.filter(|(_, size)| *size > 0.0 && *size >= least);
    driven.map(|(motion, _)| motion).collect()
}

/// For each motion the band that holds its power, with samples `delta_s` apart in dimensionless time; nothing for one that is not
/// driven.
pub(super) fn driven_bands(
    signals: &Signals,
    delta_s: f64,
) -> Result<Vec<Vec<ReducedFrequencyRange>>> {
    let power = powers(signals)?;
    let size = |power: &Vec<f64>| power.iter().sum::<f64>().sqrt();
    let driven = driven(power.iter().map(size).collect());
    let k = |per_sample: f64| ReducedFrequency::from_full_width(per_sample / delta_s);
    let whole = |(low, high)| ReducedFrequencyRange::between(k(low), k(high));
    let of = |(motion, power): (usize, &Vec<f64>)| {
        let band = band(power).filter(|_| driven.contains(&motion));
        band.map(whole).into_iter().collect()
    };
    Ok(power.iter().enumerate().map(of).collect())
}

/// Lower and upper end of the band that holds a power, radians per sample; `None` where there is none.
fn band(power: &[f64]) -> Option<(f64, f64)> {
    let total: f64 = power.iter().sum();
    if !(total > 0.0 && total.is_finite()) {
        return None;
    }
    let mut sum = 0.0;
    let up_to = |p: &f64| {
        sum += p / total;
        sum
    };
    let cumulative: Vec<f64> = power.iter().map(up_to).collect();
    let at = |part: f64| {
        let bin = cumulative.iter().position(|c| *c >= part);
        TAU * bin.unwrap_or(PERIODOGRAM / 2 - 1).max(1) as f64 / PERIODOGRAM as f64
    };
    Some((at(LEFT_OUT), at(1.0 - LEFT_OUT)))
}

/// Of each motion the sum of the periodograms (Welch 1967) of blocks that overlap by half, without their mean, under a Hann window;
/// the last block is what no whole one has held with its full weight, padded with zeros.
fn powers(signals: &Signals) -> Result<Vec<Vec<f64>>> {
    let transform = Fourier::new(PERIODOGRAM);
    let take = |power: &mut [f64], samples: &[f64]| {
        let mean = mean(samples);
        let step = TAU / samples.len().max(1) as f64;
        let window = |k: i32| 0.5 - 0.5 * (step * f64::from(k)).cos();
        let windowed = samples.iter().zip(0..).map(|(x, k)| (x - mean) * window(k));
        for (power, z) in power.iter_mut().zip(transform.spectrum(windowed)) {
            *power += z.norm_sqr();
        }
    };
    let mut powers = vec![vec![0.0; PERIODOGRAM / 2]; signals.dofs()];
    let mut waiting = vec![Vec::new(); signals.dofs()];
    signals.for_each_block(|block| {
        let of_motions = waiting.iter_mut().zip(&mut powers).zip(&block.channels);
        for ((waiting, power), motion) in of_motions {
            waiting.extend_from_slice(motion);
            while waiting.len() >= PERIODOGRAM {
                take(power, &waiting[..PERIODOGRAM]);
                waiting.drain(..PERIODOGRAM / 2);
            }
        }
        Ok(())
    })?;
    for (power, waiting) in powers.iter_mut().zip(&waiting) {
        take(power, waiting);
    }
    Ok(powers)
}

#[cfg(test)]
mod tests {
    use super::super::signals::Signals;
    use super::*;

    /// Of motions beside forces of zero.
    fn bands_of(motions: &[Vec<f64>]) -> Vec<Option<(f64, f64)>> {
        let mut writer = Signals::new(motions.len());
        let value = |c: usize, k: usize| motions.get(c).map_or(0.0, |m| m[k]);
        writer.extend(motions[0].len(), value).unwrap();
        let driven = driven_bands(&writer.finish().unwrap(), 1.0).unwrap();
        let ends = |range: &ReducedFrequencyRange| (range.min.full_width(), range.max.full_width());
        driven.iter().map(|all| all.first().map(ends)).collect()
    }

    /// Two sines of equal size are the ends of the band, to the resolution of the window (two bins); a mean does not count.
    #[test]
    fn the_ends_are_where_the_power_is() {
        let (low, high) = (TAU * 0.3 / 200.0, TAU * 2.5 / 200.0);
        let bin = TAU / PERIODOGRAM as f64;
        for (samples, resolution) in [(40_000, 2.0), (3_000, 6.0)] {
            let sines =
                (0..samples).map(|k| 7.0 + (low * k as f64).sin() + (high * k as f64).sin());
            let (a, b) = bands_of(&[sines.collect()])[0].unwrap();
            assert!((a - low).abs() < resolution * bin, "{a} {low}");
            assert!((b - high).abs() < resolution * bin, "{b} {high}");
        }
        assert_eq!(bands_of(&[vec![0.0; 20_000]]), [None]);
        assert_eq!(bands_of(&[Vec::new()]), [None]);
    }
    /// Two motions in bands of their own, and a third that follows the first.
    #[test]
    fn each_motion_has_its_own_band() {
        let sine = |size: f64, w: f64| (0..40_000).map(|k| size * (w * k as f64).sin()).collect();
        let bands = bands_of(&[sine(1.0, 0.02), sine(0.5, 0.1), sine(0.05, 0.02)]);
        let [Some((_, slow)), Some((fast, _)), None] = bands[..] else {
            panic!("{bands:?}");
        };
        assert!(slow < 0.03 && fast > 0.09, "{slow} {fast}");
        let motions: [Vec<f64>; 3] = [sine(1.0, 0.02), sine(0.5, 0.1), sine(0.05, 0.02)];
        assert_eq!(driven_motions(&motions), [0, 1]);
        assert!(driven_motions(&[vec![0.0; 10]]).is_empty());
    }
}
