//! Confidence interval of a probability from counted samples.

use crate::state_space::boundary;
use crate::uncertainty::incomplete_beta;
use std::convert::Infallible;

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
