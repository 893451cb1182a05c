//! Metrics of amplitude over time and frequency.

use super::amplitude::{DistanceDetails, relative_distance};
use super::morlet::{LevelGroup, Morlet, RowBuffer, WaveletParameters};
use super::{Metric, SignalPair, exponential, zero_signal};
use crate::error::Result;
use serde::Serialize;

/// What [`wavelet_normalised`] found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NormalisedWaveletDetails {
    /// Sample and relative distance `‖F₁ − F₂‖₂/‖F₁‖₂` of its normalised columns.
    pub columns: Vec<(usize, f64)>,
}

/// Wavelet metric `M_w = exp(−‖|W₁| − |W₂|‖_F/‖W₁‖_F)` over the coefficients inside the cone of influence.
///
/// # Errors
/// [`crate::Error::Input`] for unusable parameters, a record too short for the cone, or a zero reference.
pub fn wavelet(
    pair: &SignalPair<'_>,
    parameters: &WaveletParameters,
) -> Result<Metric<DistanceDetails>> {
    let plan = Morlet::new(parameters, pair.sample_count(), pair.time_step_s())?;
    let sums = plan.by_groups(|group| {
        let (mut distance, mut reference) = (0.0, 0.0);
        for_each_inside(&plan, pair, &group, |_, [first, second]| {
            distance += (first - second) * (first - second);
            reference += first * first;
        });
        [distance, reference]
    });
    let norm = |k: usize| sums.iter().map(|s| s[k]).sum::<f64>().sqrt();
    relative_distance(norm(0), norm(1))
}

/// Frequency-normalised wavelet metric `M_wf`: how the content moves in frequency, whatever its amplitude.
///
/// At each sample the moduli of each signal are divided by their own maximum over the frequencies inside the cone;
/// `M_wf = exp(−mean_t ‖F₁ − F₂‖₂/‖F₁‖₂)`, the mean over the samples with any frequency inside the cone.
/// Samples at which the reference has no content are left out of the mean: what is left there of the Fourier transforms, some 1e-16 of
/// the largest modulus, is no content, and none of a measured signal is below 1e-10 of it.
///
/// # Errors
/// [`crate::Error::Input`] for unusable parameters, a record too short for the cone, or a zero reference.
pub fn wavelet_normalised(
    pair: &SignalPair<'_>,
    parameters: &WaveletParameters,
) -> Result<Metric<NormalisedWaveletDetails>> {
    let plan = Morlet::new(parameters, pair.sample_count(), pair.time_step_s())?;
    let largest = columns(
        &plan,
        pair,
        |_, cell, [first, second]| *cell = [cell[0].max(first), cell[1].max(second)],
        |a, b| [a[0].max(b[0]), a[1].max(b[1])],
    );
    let floor: [f64; 2] =
        std::array::from_fn(|k| ROUNDING * largest.iter().fold(0.0, |m: f64, l| m.max(l[k])));
    let sums = columns(
        &plan,
        pair,
        |sample, cell, [first, second]| {
            let [first_largest, second_largest] = largest[sample];
            let first = normalised(first, first_largest, floor[0]);
            let second = normalised(second, second_largest, floor[1]);
            cell[0] += (first - second) * (first - second);
            cell[1] += first * first;
        },
        |a, b| [a[0] + b[0], a[1] + b[1]],
    );
    let known = sums.iter().enumerate().filter(|(_, sum)| sum[1] > 0.0);
    let relative = known.map(|(sample, sum)| (sample, (sum[0] / sum[1]).sqrt()));
    let columns: Vec<(usize, f64)> = relative.collect();
    if columns.is_empty() {
        return Err(zero_signal("reference signal"));
    }
    let mean = columns.iter().map(|(_, d)| d).sum::<f64>() / columns.len() as f64;
    Ok(Metric {
        value: exponential(mean, 1.0)?,
        details: NormalisedWaveletDetails { columns },
    })
}

/// Of the largest modulus of a signal, what may be rounding.
const ROUNDING: f64 = 1e-10;

fn normalised(modulus: f64, largest: f64, floor: f64) -> f64 {
    if largest > floor {
        modulus / largest
    } else {
        0.0
    }
}

/// Calls `visit(sample, [|W₁|, |W₂|])` for the samples inside the cone, level after level.
fn for_each_inside(
    plan: &Morlet,
    pair: &SignalPair<'_>,
    group: &LevelGroup<'_>,
    mut visit: impl FnMut(usize, [f64; 2]),
) {
    let [first, second] = [pair.reference, pair.compared].map(|x| group.spectrum(x));
    let [mut one, mut other] = [RowBuffer::default(), RowBuffer::default()];
    for level in group.levels.clone() {
        let inside = plan.inside(level);
        if inside.is_empty() {
            continue;
        }
        let kernel = group.kernel(level);
        let first = group.row(&kernel, &first, &mut one);
        let second = group.row(&kernel, &second, &mut other);
        for sample in inside {
            visit(sample, [first[sample].norm(), second[sample].norm()]);
        }
    }
}

/// Two numbers per sample, gathered over the levels by `update(sample, numbers, [|W₁|, |W₂|])` from zero
/// on, and merged between groups of levels.
fn columns(
    plan: &Morlet,
    pair: &SignalPair<'_>,
    update: impl Fn(usize, &mut [f64; 2], [f64; 2]) + Sync,
    merge: impl Fn([f64; 2], [f64; 2]) -> [f64; 2],
) -> Vec<[f64; 2]> {
    let groups = plan.by_groups(|group| {
        let mut cells = vec![[0.0; 2]; plan.sample_count()];
        for_each_inside(plan, pair, &group, |sample, moduli| {
            update(sample, &mut cells[sample], moduli);
        });
        cells
    });
    let mut total = vec![[0.0; 2]; plan.sample_count()];
    for group in groups {
        for (sum, cell) in total.iter_mut().zip(group) {
            *sum = merge(*sum, cell);
        }
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;
    use std::f64::consts::{PI, TAU};

    fn parameters() -> WaveletParameters {
        WaveletParameters {
            level_count: 40,
            frequency_min_hz: 1.0,
            frequency_max_hz: 4.0,
            ..WaveletParameters::default()
        }
    }

    fn harmonic(a: f64, frequency_hz: f64, phase_rad: f64) -> Vec<f64> {
        (0..6000)
            .map(|k| a * (TAU * frequency_hz * 0.01 * k as f64 - phase_rad).cos())
            .collect()
    }

    #[test]
    fn harmonics_follow_the_closed_forms() {
        let x1 = harmonic(1.0, 2.0, 0.0);
        // No wavelet reaches an end of the record, where the delay would be seen, nor is it cut off visibly, and
        // no column holds only levels without content.
        let parameters = WaveletParameters {
            frequency_max_hz: 2.0,
            truncation: 6.0,
            cone: 6.0,
            ..parameters()
        };
        for a in [0.3, 1.0, 1.8] {
            let x2 = harmonic(a, 2.0, 0.7);
            let pair = SignalPair::new(&x1, &x2, 0.01).unwrap();
            let expected = (-(1.0 - a).abs()).exp();
            let plain = wavelet(&pair, &parameters).unwrap();
            // What is left is the image frequency −f in the side lobes of the wavelet, cut off at exp(−9).
            assert_abs_diff_eq!(plain.value, expected, epsilon = 1e-4);
            let shape = wavelet_normalised(&pair, &parameters).unwrap();
            assert_abs_diff_eq!(shape.value, 1.0, epsilon = 1e-3);
        }
    }

    #[test]
    fn the_number_of_levels_has_limits() {
        let x = harmonic(1.0, 2.0, 0.0);
        let pair = SignalPair::new(&x, &x, 0.01).unwrap();
        for level_count in [0, 1_000_000_000] {
            let parameters = WaveletParameters {
                level_count,
                ..parameters()
            };
            let said = wavelet(&pair, &parameters).unwrap_err().to_string();
            let expected = "number of wavelet levels: expected 1 to 100000, found";
            assert!(said.starts_with(expected), "{said}");
        }
    }

    #[test]
    fn scaling_leaves_the_normalised_metric_at_one() {
        let x1 = harmonic(1.0, 2.0, 0.0);
        let x2: Vec<f64> = x1.iter().map(|x| -3.0 * x).collect();
        let pair = SignalPair::new(&x1, &x2, 0.01).unwrap();
        let plain = wavelet(&pair, &parameters()).unwrap().value;
        assert_abs_diff_eq!(plain, (-2.0_f64).exp(), epsilon = 1e-13);
        let shape = wavelet_normalised(&pair, &parameters()).unwrap();
        assert_abs_diff_eq!(shape.value, 1.0, epsilon = 1e-12);
        // At 4 Hz the cone is 1.5/√2 = 1.061 s wide.
        assert_eq!(shape.details.columns.first().unwrap().0, 107);
        assert_eq!(shape.details.columns.last().unwrap().0, 5892);
    }

    #[test]
    fn another_frequency_is_seen_by_the_normalised_metric() {
        let (x1, x2) = (harmonic(1.0, 2.0, 0.0), harmonic(1.0, 2.8, 0.0));
        let pair = SignalPair::new(&x1, &x2, 0.01).unwrap();
        assert!(wavelet_normalised(&pair, &parameters()).unwrap().value < 0.4);
    }

    /// Both rest for more than the wavelets are long: the rounding there is no content.
    #[test]
    fn rests_are_left_out() {
        let x: Vec<f64> = (0..6000)
            .map(|k| f64::from((2000..4000).contains(&k)) * (0.04 * PI * f64::from(k)).sin())
            .collect();
        let other: Vec<f64> = x.iter().map(|x| 1.000_000_1 * x).collect();
        let pair = SignalPair::new(&x, &other, 0.01).unwrap();
        let shape = wavelet_normalised(&pair, &parameters()).unwrap();
        assert_abs_diff_eq!(shape.value, 1.0, epsilon = 1e-5);
    }

    #[test]
    fn zero_signals() {
        let (zero, x) = (vec![0.0; 6000], harmonic(1.0, 2.0, 0.0));
        let pair = SignalPair::new(&zero, &x, 0.01).unwrap();
        assert!(wavelet(&pair, &parameters()).is_err());
        assert!(wavelet_normalised(&pair, &parameters()).is_err());
        let pair = SignalPair::new(&x, &zero, 0.01).unwrap();
        let value = wavelet(&pair, &parameters()).unwrap().value;
        assert_abs_diff_eq!(value, (-1.0_f64).exp(), epsilon = 1e-13);
        let value = wavelet_normalised(&pair, &parameters()).unwrap().value;
        assert_abs_diff_eq!(value, (-1.0_f64).exp(), epsilon = 1e-13);
    }
}
