//! Confidence interval of a probability from counted samples.

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
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle == low || middle == high {
            break;
        }
        if incomplete_beta(middle, a, b) < probability {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Regularised incomplete beta function by its continued fraction (Lentz's method).
fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    if x > (a + 1.0) / (a + b + 2.0) {
        // the fraction converges fast on this side only
        return 1.0 - incomplete_beta(1.0 - x, b, a);
    }
    let log_factor =
        libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b) + a * x.ln() + b * (-x).ln_1p();
    let safe = |v: f64| if v.abs() < 1e-300 { 1e-300 } else { v };
    let mut c = 1.0;
    let mut d = 1.0 / safe(1.0 - (a + b) * x / (a + 1.0));
    let mut fraction = d;
    for m in 1..100_000 {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        d = 1.0 / safe(1.0 + even * d);
        c = safe(1.0 + even / c);
        fraction *= d * c;
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        d = 1.0 / safe(1.0 + odd * d);
        c = safe(1.0 + odd / c);
        let change = d * c;
        fraction *= change;
        if (change - 1.0).abs() < 1e-15 {
            break;
        }
    }
    log_factor.exp() * fraction / a
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
