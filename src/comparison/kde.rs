//! Probability density of a sample by diffusion (Botev, Grotowski and Kroese 2010, Ann. Statist. 38(5)).
//!
//! A Gaussian kernel estimate with reflection at the ends of the range, which in the cosine basis is the
//! multiplication of the k-th coefficient by `exp(−k²π²t/2)`, `√t` being the bandwidth as a part of the range.
//! The bandwidth is the solution of the paper's fixed-point equation `t = ξ γ⁽⁵⁾(t)`, which assumes no normal
//! reference.

use rustfft::FftPlanner;
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;

/// Points of the grid.
pub(super) const POINTS: usize = 4096;

/// Highest derivative in the fixed-point equation, as in the paper.
const STAGES: i32 = 7;

/// Density estimate at the centres of [`POINTS`] equal cells of a range.
pub(super) struct Density {
    /// Per unit of the sample; their sum times the cell width is 1.
    pub(super) values: Vec<f64>,
    /// Standard deviation of the kernel, in the unit of the sample.
    pub(super) bandwidth: f64,
}

impl Density {
    /// Of a sample within `low..=high`, `low < high`.
    pub(super) fn new(sample: &[f64], [low, high]: [f64; 2]) -> Self {
        let range = high - low;
        let mut histogram = vec![0.0; POINTS];
        for x in sample {
            let cell = ((x - low) / range * POINTS as f64) as usize;
            histogram[cell.min(POINTS - 1)] += 1.0 / sample.len() as f64;
        }
        let mut coefficients = cosine_transform(&histogram);
        let time = diffusion_time(&coefficients, distinct(sample) as f64);
        for (k, a) in coefficients.iter_mut().enumerate() {
            *a *= (-0.5 * time * (PI * k as f64).powi(2)).exp();
        }
        // Truncated ringing of a sample with gaps may leave tiny negative values.
        let cell = range / POINTS as f64;
        let values = cosine_sum(&coefficients)
            .into_iter()
            .map(|p| (p / cell).max(0.0))
            .collect();
        Self {
            values,
            bandwidth: time.sqrt() * range,
        }
    }
}

fn distinct(sample: &[f64]) -> usize {
    let mut sorted = sample.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    sorted.len()
}

/// `a_0 = Σ p_j`, `a_k = 2 Σ p_j cos(πk(j + ½)/n)`.
fn cosine_transform(p: &[f64]) -> Vec<f64> {
    let n = p.len();
    let mut buffer: Vec<Complex64> = p
        .iter()
        .chain(p.iter().rev())
        .map(|&x| Complex64::from(x))
        .collect();
    FftPlanner::new()
        .plan_fft_forward(2 * n)
        .process(&mut buffer);
    let mut coefficients: Vec<f64> = buffer[..n]
        .iter()
        .enumerate()
        .map(|(k, z)| (z * Complex64::from_polar(1.0, -PI * k as f64 / (2 * n) as f64)).re)
        .collect();
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
    FftPlanner::new()
        .plan_fft_inverse(2 * n)
        .process(&mut buffer);
    buffer[..n].iter().map(|z| z.re / n as f64).collect()
}

/// `‖f⁽ˢ⁾‖²` of the density smoothed for `time`, on a range of 1:
/// `2 π^(2s) Σ k^(2s) (a_k/2)² exp(−k²π²t)`.
fn squared_norm(a: &[f64], derivative: i32, time: f64) -> f64 {
    let sum: f64 = a
        .iter()
        .enumerate()
        .skip(1)
        .map(|(k, a)| {
            let k2 = (k * k) as f64;
            k2.powi(derivative) * (0.5 * a).powi(2) * (-k2 * PI * PI * time).exp()
        })
        .sum();
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
        if positive(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::{assert_abs_diff_eq, assert_relative_eq};

    /// Quantiles of the logistic distribution, a sample without randomness.
    fn logistic(count: usize) -> Vec<f64> {
        (0..count)
            .map(|k| (k as f64 + 0.5) / count as f64)
            .map(|u| (u / (1.0 - u)).ln())
            .collect()
    }

    #[test]
    fn values_are_the_sum_of_reflected_kernels() {
        let sample = logistic(300);
        let [low, high] = [sample[0], sample[299]];
        let density = Density::new(&sample, [low, high]);
        let h = density.bandwidth;
        let kernel = |x: f64| (-0.5 * (x / h).powi(2)).exp() / (h * (2.0 * PI).sqrt());
        let cell = (high - low) / POINTS as f64;
        for k in [0, 100, 2047, 4000] {
            let x = low + (k as f64 + 0.5) * cell;
            let sum: f64 = sample
                .iter()
                .map(|s| kernel(x - s) + kernel(x - 2.0 * low + s) + kernel(x - 2.0 * high + s))
                .sum();
            // The sample is moved to the centres of cells, 0.0007 wide of a bandwidth of 0.5.
            assert_relative_eq!(density.values[k], sum / 300.0, max_relative = 2e-3);
        }
        assert_abs_diff_eq!(
            density.values.iter().sum::<f64>() * cell,
            1.0,
            epsilon = 1e-12
        );
    }

    #[test]
    fn bandwidth_agrees_with_another_implementation_and_with_the_optimum() {
        let bandwidth = |n: usize| {
            let sample = logistic(n);
            Density::new(&sample, [sample[0], sample[n - 1]]).bandwidth
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
