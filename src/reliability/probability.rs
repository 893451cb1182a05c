//! The standard normal distribution, and confidence intervals of counted probabilities.

use crate::state_space::boundary;
use crate::uncertainty::incomplete_beta;
use std::convert::Infallible;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// `Φ(z)`.
pub(super) fn cdf(z: f64) -> f64 {
    0.5 * libm::erfc(-z * FRAC_1_SQRT_2)
}

/// `Φ⁻¹(u)` for `0 < u < 1`: Acklam's rational approximation (1e-9) and two steps of Halley's method on `erfc`.
pub(super) fn quantile(u: f64) -> f64 {
    if u > 0.5 {
        // the upper tail of erfc holds its digits on the other side
        return -quantile(1.0 - u);
    }
    let mut z = start(u);
    for _ in 0..2 {
        let error = cdf(z) - u;
        let step = error * (2.0 * PI).sqrt() * (0.5 * z * z).exp();
        z -= step / (1.0 + 0.5 * z * step);
    }
    z
}

/// P. J. Acklam's approximation for `u ≤ 1/2`.
fn start(u: f64) -> f64 {
    const A: [f64; 6] = [
        -3.969683028665376e1,
        2.209460984245205e2,
        -2.759285104469687e2,
        1.38357751867269e2,
        -3.066479806614716e1,
        2.506628277459239,
    ];
    const B: [f64; 6] = [
        -5.447609879822406e1,
        1.615858368580409e2,
        -1.556989798598866e2,
        6.680131188771972e1,
        -1.328068155288572e1,
        1.0,
    ];
    const C: [f64; 6] = [
        -7.784894002430293e-3,
        -3.223964580411365e-1,
        -2.400758277161838,
        -2.549732539343734,
        4.374664141464968,
        2.938163982698783,
    ];
    const D: [f64; 5] = [
        7.784695709041462e-3,
        3.224671290700398e-1,
        2.445134137142996,
        3.754408661907416,
        1.0,
    ];
    let horner = |c: &[f64], x: f64| c.iter().fold(0.0, |sum, c| sum * x + c);
    if u < 0.02425 {
        let q = (-2.0 * u.ln()).sqrt();
        return horner(&C, q) / horner(&D, q);
    }
    let q = u - 0.5;
    q * horner(&A, q * q) / horner(&B, q * q)
}

/// Exact (Clopper–Pearson 1934) two-sided interval at the level `confidence` for `count` of `samples`.
pub(super) fn clopper_pearson(count: u64, samples: u64, confidence: f64) -> (f64, f64) {
    let tail = 0.5 * (1.0 - confidence);
    let (k, n) = (count as f64, samples as f64);
    let lower = if count == 0 {
        0.0
    } else {
        beta_quantile(tail, k, n - k + 1.0)
    };
    let upper = if count == samples {
        1.0
    } else {
        beta_quantile(1.0 - tail, k + 1.0, n - k)
    };
    (lower, upper)
}

/// `x` with `I_x(a, b) = probability`, by bisection.
fn beta_quantile(probability: f64, a: f64, b: f64) -> f64 {
    let below = |x| Ok::<_, Infallible>(incomplete_beta(x, a, b) < probability);
    let Ok((low, high)) = boundary(0.0, 1.0, 0.0, below);
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantiles of the standard tables to ten digits, and the two functions against each other over the tails.
    #[test]
    fn quantiles() {
        for (u, z) in [
            (0.975, 1.959_963_984_540_054),
            (0.95, 1.644_853_626_951_472_2),
            (0.001, -3.090_232_306_167_813),
            (0.5, 0.0),
        ] {
            assert!((quantile(u) - z).abs() < 1e-13, "{u}");
        }
        for z in [-8.0, -5.0, -2.0, -0.3, 0.7, 3.0] {
            assert!((quantile(cdf(z)) - z).abs() < 1e-9, "{z}");
        }
    }

    /// SciPy: `scipy.stats.beta.ppf` with the same arguments; 0 of n is `1 − tail^(1/n)` in closed form.
    #[test]
    fn tabulated_intervals() {
        let near = |(a, b): (f64, f64), (c, d): (f64, f64)| {
            assert!((a - c).abs() < 1e-10 && (b - d).abs() < 1e-10, "{a} {b}");
        };
        near(
            clopper_pearson(0, 10, 0.95),
            (0.0, 1.0 - 0.025f64.powf(0.1)),
        );
        near(clopper_pearson(10, 10, 0.95), (0.025f64.powf(0.1), 1.0));
        near(
            clopper_pearson(3, 10, 0.95),
            (0.066_739_511_177_734_6, 0.652_452_850_059_997_3),
        );
        near(
            clopper_pearson(100_000, 1_000_000, 0.95),
            (0.099_412_669_866_037_89, 0.100_589_648_187_425_52),
        );
    }
}
