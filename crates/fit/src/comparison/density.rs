//! Metric of the distributions of values, and the density of a sample by diffusion (Botev, Grotowski and Kroese 2010, Ann.
//! Statist. 38(5)).
//!
//! The density is a Gaussian kernel estimate with reflection at the ends of the range, which in the cosine basis is the
//! multiplication of the k-th coefficient by `exp(−k²π²t/2)`, `√t` being the bandwidth as a part of the range.
//! The bandwidth is the solution of the paper's fixed-point equation `t = ξ γ⁽⁵⁾(t)`, which assumes no normal
//! reference. It is not below the distance of the values that differ.

use super::{Metric, SignalPair};
use crate::error::{Error, Result, ensure};
use crate::signal::{Complex64, Fourier, extremes, largest_magnitude, mean_and_deviation};
use serde::Serialize;
use std::f64::consts::PI;

/// What [`probability_density`] found, in standard deviations or in the unit of the signals.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DensityDetails {
    /// Value at the first point of the densities.
    pub first: f64,
    /// Distance of the points.
    pub step: f64,
    /// Density of the reference; times `step` it sums up to 1.
    pub reference: Vec<f64>,
    /// Density of the compared signal.
    pub compared: Vec<f64>,
    /// Bandwidths of reference and compared signal.
    pub bandwidths: [f64; 2],
}

/// Probability density metric, the Bhattacharyya coefficient `M_pdf = Σ √(p₁p₂) h`.
///
/// Densities by diffusion (Botev, Grotowski and Kroese 2010) on 4096 points over the common range of both
/// signals, from the smallest to the largest value of either. With `standard_score` those of the standard scores (mean removed,
/// divided by the standard deviation), so that only the shape of the distribution counts.
///
/// # Errors
/// [`Error::Input`] if a signal is constant.
pub fn probability_density(
    pair: &SignalPair<'_>,
    standard_score: bool,
) -> Result<Metric<DensityDetails>> {
    let first = values("reference signal", pair.reference, standard_score)?;
    let second = values("compared signal", pair.compared, standard_score)?;
    let (low, high) = extremes(first.iter().chain(&second).copied());
    let step = (high - low) / POINTS as f64;
    let [(reference, own), (compared, other)] = [&first, &second].map(|x| density(x, [low, high]));
    let both = reference.iter().zip(&compared);
    let overlap: f64 = both.map(|(p, q)| (p * q).sqrt() * step).sum();
    Ok(Metric {
        value: overlap.min(1.0),
        details: DensityDetails {
            first: low + 0.5 * step,
            step,
            bandwidths: [own, other],
            reference,
            compared,
        },
    })
}

/// The values themselves or their standard scores.
fn values(place: &str, signal: &[f64], standard_score: bool) -> Result<Vec<f64>> {
    let (mean, deviation) = mean_and_deviation(signal.iter().copied());
    let largest = largest_magnitude(signal);
    // The deviation of a constant is the rounding error of its mean.
    ensure(
        deviation > 1e-12 * largest,
        place,
        "a signal that varies",
        format_args!("{mean} throughout"),
    )?;
    if !deviation.is_finite() {
        return Err(Error::Numerical(format!(
            "{place}: the variance is too large for double precision"
        )));
    }
    Ok(match standard_score {
        true => signal.iter().map(|x| (x - mean) / deviation).collect(),
        false => signal.to_vec(),
    })
}

/// Points of the grid.
const POINTS: usize = 4096;

/// Highest derivative in the fixed-point equation, as in the paper.
const STAGES: i32 = 7;

/// Least bandwidth, in `range/n` of `n` values that differ: neighbours of a sinusoid are up to `π range/n` apart.
const SPACINGS: f64 = 2.0;

/// Density of a sample within `low..=high`, `low < high`, at the centres of [`POINTS`] equal cells, per unit of the sample, so that its sum
/// times the cell width is 1; and the bandwidth, the standard deviation of the kernel in the unit of the sample.
fn density(sample: &[f64], [low, high]: [f64; 2]) -> (Vec<f64>, f64) {
    let range = high - low;
    let mut histogram = vec![0.0; POINTS];
    for x in sample {
        let cell = ((x - low) / range * POINTS as f64) as usize;
        histogram[cell.min(POINTS - 1)] += 1.0 / sample.len() as f64;
    }
    let mut coefficients = cosine_transform(&histogram);
    let count = distinct(sample) as f64;
    let (least, greatest) = extremes(sample.iter().copied());
    // values of a signal without randomness are no sample: a kernel below their distance shows each of them
    let spacing = SPACINGS * (greatest - least) / (range * count);
    let time = diffusion_time(&coefficients, count).max(spacing.powi(2));
    for (k, a) in coefficients.iter_mut().enumerate() {
        *a *= (-0.5 * time * (PI * k as f64).powi(2)).exp();
    }
    // Truncated ringing of a sample with gaps may leave tiny negative values.
    let cell = range / POINTS as f64;
    let values = cosine_sum(&coefficients).into_iter();
    let values = values.map(|p| (p / cell).max(0.0)).collect();
    (values, time.sqrt() * range)
}

/// Values nearer to each other than this part of the range are one: periods of a signal repeat to within the rounding of its time,
/// `2π f t ε` or 1e-13 for a thousand periods, and files of a few more digits than needed hold nothing that is nearer. It is far below the
/// `range/n` of samples that differ, and a sample in which some do lie as near by chance loses one of its count.
const SAME_VALUE: f64 = 1e-9;

/// Values that are not each other's repetition.
fn distinct(sample: &[f64]) -> usize {
    let mut sorted = sample.to_vec();
    sorted.sort_by(f64::total_cmp);
    let ends = sorted.last().zip(sorted.first());
    let range = ends.map_or(0.0, |(b, a)| b - a);
    // from the first of a run, so that steps below the tolerance do not add up to one value
    sorted.dedup_by(|next, kept| *next - *kept <= SAME_VALUE * range);
    sorted.len()
}

/// `a_0 = Σ p_j`, `a_k = 2 Σ p_j cos(πk(j + ½)/n)`.
fn cosine_transform(p: &[f64]) -> Vec<f64> {
    let n = p.len();
    let spectrum = Fourier::new(2 * n).spectrum(p.iter().chain(p.iter().rev()).copied());
    let turned = |(k, z): (usize, &Complex64)| {
        (z * Complex64::from_polar(1.0, -PI * k as f64 / (2 * n) as f64)).re
    };
    let mut coefficients: Vec<f64> = spectrum[..n].iter().enumerate().map(turned).collect();
    coefficients[0] *= 0.5;
    coefficients
}

/// Inverse of [`cosine_transform`]: `p_j = Σ a_k cos(πk(j + ½)/n)/n`.
fn cosine_sum(a: &[f64]) -> Vec<f64> {
    let n = a.len();
    let mut buffer = vec![Complex64::default(); 2 * n];
    for (k, (z, &value)) in buffer.iter_mut().zip(a).enumerate() {
        *z = Complex64::from_polar(value, PI * k as f64 / (2 * n) as f64);
    }
    let sums = Fourier::new(2 * n).sums(buffer);
    sums[..n].iter().map(|x| x / n as f64).collect()
}

/// `‖f⁽ˢ⁾‖²` of the density smoothed for `time`, on a range of 1:
/// `2 π^(2s) Σ k^(2s) (a_k/2)² exp(−k²π²t)`.
fn squared_norm(a: &[f64], derivative: i32, time: f64) -> f64 {
    let term = |(k, a): (usize, &f64)| {
        let k2 = (k * k) as f64;
        k2.powi(derivative) * (0.5 * a).powi(2) * (-k2 * PI * PI * time).exp()
    };
    let sum: f64 = a.iter().enumerate().skip(1).map(term).sum();
    2.0 * PI.powi(2 * derivative) * sum
}

/// `t − ξγ⁽ˡ⁾(t)` of the paper for `count` observations.
fn fixed_point_defect(a: &[f64], count: f64, time: f64) -> f64 {
    let mut norm = squared_norm(a, STAGES, time);
    for s in (2..STAGES).rev() {
        let odd_product: f64 = (1..=s).map(|k| f64::from(2 * k - 1)).product();
        let kernel = odd_product / (2.0 * PI).sqrt();
        let factor = (1.0 + 0.5_f64.powf(f64::from(s) + 0.5)) / 3.0;
        let stage_time = (2.0 * factor * kernel / (count * norm)).powf(2.0 / f64::from(3 + 2 * s));
        norm = squared_norm(a, s, stage_time);
    }
    time - (2.0 * count * PI.sqrt() * norm).powf(-0.4)
}

/// Smallest solution of the fixed-point equation up to 0.1; without one the rule `0.28 n^(−2/5)` of the paper.
fn diffusion_time(a: &[f64], count: f64) -> f64 {
    const LARGEST: f64 = 0.1;
    const BISECTIONS: usize = 60;
    let positive = |time: f64| fixed_point_defect(a, count, time) > 0.0;
    let mut high = 1e-12 + 1e-5 * (count.clamp(50.0, 1050.0) - 50.0);
    while !positive(high) {
        if high >= LARGEST {
            return 0.28 * count.powf(-0.4);
        }
        high = (2.0 * high).min(LARGEST);
    }
    let mut low = 0.0;
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        match positive(middle) {
            true => high = middle,
            false => low = middle,
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::{assert_abs_diff_eq, assert_relative_eq};
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};
    use std::f64::consts::TAU;

    fn normal(count: usize, seed: u64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        (0..count)
            .map(|_| StandardNormal.sample(&mut random))
            .collect()
    }

    /// Quantiles of the logistic distribution, a sample without randomness.
    fn logistic(count: usize) -> Vec<f64> {
        (0..count)
            .map(|k| (k as f64 + 0.5) / count as f64)
            .map(|u| (u / (1.0 - u)).ln())
            .collect()
    }

    #[test]
    fn harmonics_of_any_amplitude_and_phase_are_alike() {
        let wave = |a: f64, shift: usize| -> Vec<f64> {
            (0..4000)
                .map(|k| a * (TAU * ((k + shift) % 400) as f64 / 400.0).cos())
                .collect()
        };
        let (x1, x2) = (wave(1.0, 0), wave(1.7, 37));
        let pair = SignalPair::new(&x1, &x2, 0.01).unwrap();
        let metric = probability_density(&pair, true).unwrap();
        // Values at the edge of a cell fall to either side by rounding.
        assert_abs_diff_eq!(metric.value, 1.0, epsilon = 1e-3);
    }

    /// A cosine against itself a little later, 20 periods of 50 samples as they are computed: they repeat to within rounding only. The
    /// density of 1000 values that are all taken for different would be twenty spikes wide of the other's.
    #[test]
    fn periods_that_repeat_to_within_rounding_are_one() {
        let wave = |phase: f64| -> Vec<f64> {
            let at = |k: u32| (2.0 * TAU * 0.01 * f64::from(k) - phase).cos();
            (0..1000).map(at).collect()
        };
        let (x1, x2) = (wave(0.0), wave(0.3));
        // twice in a period, but for its ends
        assert_eq!(distinct(&x1), 26);
        assert_eq!(distinct(&x2), 50);
        let pair = SignalPair::new(&x1, &x2, 0.01).unwrap();
        for standard_score in [true, false] {
            let metric = probability_density(&pair, standard_score).unwrap();
            assert_abs_diff_eq!(metric.value, 1.0, epsilon = 0.02);
        }
        // numbers that differ stay as many as they are
        assert!(distinct(&normal(20_000, 1)) > 19_990);
    }

    /// Sinusoids whose samples never repeat, 13 % in size and 0.6° in phase apart: their shapes are the same, and the overlap of their
    /// densities `1/(π√(a² − x²))` is 0.811 (quadrature).
    #[test]
    fn sinusoids_that_do_not_repeat_are_no_combs() {
        let wave = |a: f64, phase: f64| -> Vec<f64> {
            let at = |k: u32| a * (TAU * 0.8 * 0.005 * f64::from(k) * 1.000_37 + phase).cos();
            (0..5000).map(at).collect()
        };
        let (x1, x2) = (wave(1.0, 0.0), wave(1.13, 0.6_f64.to_radians()));
        let pair = SignalPair::new(&x1, &x2, 0.005).unwrap();
        let scored = probability_density(&pair, true).unwrap();
        assert!(scored.value > 0.99, "{}", scored.value);
        let plain = probability_density(&pair, false).unwrap();
        assert_abs_diff_eq!(plain.value, 0.811, epsilon = 0.01);
    }

    #[test]
    fn overlap_of_shifted_normals_is_the_closed_form() {
        // ∫ √(N(0,1) N(d,1)) = exp(−d²/8)
        let (x1, mut x2) = (normal(20_000, 1), normal(20_000, 2));
        x2.iter_mut().for_each(|x| *x += 1.5);
        let pair = SignalPair::new(&x1, &x2, 0.01).unwrap();
        let metric = probability_density(&pair, false).unwrap();
        // Scatter of the estimate for 20 000 samples.
        assert_abs_diff_eq!(metric.value, (-1.5_f64.powi(2) / 8.0).exp(), epsilon = 5e-3);
        let scored = probability_density(&pair, true).unwrap();
        assert!(scored.value > 0.998, "{}", scored.value);
    }

    #[test]
    fn densities_are_those_of_the_distribution() {
        let x = logistic(2000);
        let pair = SignalPair::new(&x, &x, 0.01).unwrap();
        let metric = probability_density(&pair, false).unwrap();
        assert_abs_diff_eq!(metric.value, 1.0, epsilon = 1e-12);
        let d = &metric.details;
        assert_abs_diff_eq!(
            d.reference.iter().sum::<f64>() * d.step,
            1.0,
            epsilon = 1e-9
        );
        for (k, p) in d.reference.iter().enumerate() {
            let e = (-(d.first + k as f64 * d.step)).exp();
            // Bias h²f″/2 with h = 0.397 and |f″| ≤ 1/8.
            assert_abs_diff_eq!(*p, e / (1.0 + e).powi(2), epsilon = 1e-2);
        }
    }

    #[test]
    fn constants_are_refused() {
        let (x, y) = ([0.1; 8], normal(8, 3));
        let pair = SignalPair::new(&x, &y, 0.01).unwrap();
        assert!(probability_density(&pair, true).is_err());
    }

    #[test]
    fn values_are_the_sum_of_reflected_kernels() {
        let sample = logistic(300);
        let [low, high] = [sample[0], sample[299]];
        let (values, h) = density(&sample, [low, high]);
        let kernel = |x: f64| (-0.5 * (x / h).powi(2)).exp() / (h * (2.0 * PI).sqrt());
        let cell = (high - low) / POINTS as f64;
        for k in [0, 100, 2047, 4000] {
            let x = low + (k as f64 + 0.5) * cell;
            let sum: f64 = sample
                .iter()
                .map(|s| kernel(x - s) + kernel(x - 2.0 * low + s) + kernel(x - 2.0 * high + s))
                .sum();
            // The sample is moved to the centres of cells, 0.0007 wide of a bandwidth of 0.5.
            assert_relative_eq!(values[k], sum / 300.0, max_relative = 2e-3);
        }
        assert_abs_diff_eq!(values.iter().sum::<f64>() * cell, 1.0, epsilon = 1e-12);
    }

    #[test]
    fn bandwidth_agrees_with_another_implementation_and_with_the_optimum() {
        let bandwidth = |n: usize| {
            let sample = logistic(n);
            density(&sample, [sample[0], sample[n - 1]]).1
        };
        // KDEpy 1.1.12 (PyPI), improved_sheather_jones of this sample, 0.1608866, times 2: its bandwidth is a part
        // of its grid, twice as wide as the sample, but is scaled by the range of the sample. Its grid has 1024
        // points.
        assert_relative_eq!(bandwidth(5000), 2.0 * 0.160_886_6, max_relative = 2e-3);
        // Asymptotic optimum (2√π n ‖f″‖²)^(−1/5), for the logistic density ‖f″‖² = 1/42; the estimate of ‖f″‖ is
        // smoothed, so the bandwidth lies a little above.
        let optimum = (2.0 * PI.sqrt() * 200_000.0 / 42.0).powf(-0.2);
        assert_relative_eq!(bandwidth(200_000), optimum, max_relative = 0.03);
    }
}
