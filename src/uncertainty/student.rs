//! Quantiles of Student's t distribution: few independent blocks make wide intervals.

use crate::state_space::boundary;
use libm::lgamma;
use std::convert::Infallible;

/// `t` with `P(|T| ≤ t) = confidence` for `degrees_of_freedom > 0` (not necessarily whole).
pub(crate) fn two_sided_quantile(confidence: f64, degrees_of_freedom: f64) -> f64 {
    let nu = degrees_of_freedom.max(0.5);
    let inside = |t: f64| 1.0 - incomplete_beta(nu / (nu + t * t), 0.5 * nu, 0.5);
    let (low, mut high) = (0.0, 2.0);
    while inside(high) < confidence && high < 1e12 {
        high *= 2.0;
    }
    let Ok((low, high)) = boundary(low, high, 0.0, |t| {
        Ok::<_, Infallible>(inside(t) < confidence)
    });
    0.5 * (low + high)
}

/// Regularised incomplete beta function `I_x(a, b)` (DLMF 8.17.22), by the continued fraction on the side where it
/// converges.
pub(crate) fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if x >= 1.0 {
        return 1.0;
    }
    let front = (lgamma(a + b) - lgamma(a) - lgamma(b) + a * x.ln() + b * (1.0 - x).ln()).exp();
    if x < (a + 1.0) / (a + b + 2.0) {
        front * beta_fraction(x, a, b) / a
    } else {
        1.0 - front * beta_fraction(1.0 - x, b, a) / b
    }
}

/// `1/(1 + d₁/(1 + d₂/(1 + …)))` by the recurrences of Lentz.
fn beta_fraction(x: f64, a: f64, b: f64) -> f64 {
    const TERMS: u32 = 10_000;
    let mut c = 1.0;
    let mut d = 1.0 / (1.0 - (a + b) * x / (a + 1.0));
    let mut value = d;
    for m in 1..TERMS {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        d = 1.0 / (1.0 + even * d);
        c = 1.0 + even / c;
        value *= c * d;
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        d = 1.0 / (1.0 + odd * d);
        c = 1.0 + odd / c;
        value *= c * d;
        if (c * d - 1.0).abs() < 4.0 * f64::EPSILON {
            break;
        }
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables of the distribution (three decimals), and closed forms: tan(0.475π) for one degree of freedom,
    /// `√(2/(1/0.95² − 1))` for two.
    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (nu, expected) in [(3.0, 3.182), (5.0, 2.571), (10.0, 2.228), (30.0, 2.042)] {
            assert!(
                (two_sided_quantile(0.95, nu) - expected).abs() < 5e-4,
                "{nu}"
            );
        }
        let one = (0.475 * std::f64::consts::PI).tan();
        let two = (2.0 / (0.95_f64.powi(-2) - 1.0)).sqrt();
        assert!((two_sided_quantile(0.95, 1.0) / one - 1.0).abs() < 1e-10);
        assert!((two_sided_quantile(0.95, 2.0) / two - 1.0).abs() < 1e-10);
        // the normal distribution at last
        assert!((two_sided_quantile(0.95, 1e7) - 1.959_964).abs() < 1e-5);
    }
}
