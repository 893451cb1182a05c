//! Distributions and statistics of samples: Student's t (few independent blocks make wide intervals), the normal one, confidence
//! intervals of counted probabilities, quantiles of what was drawn, roots of covariances.

use crate::error::{Error, Result};
use crate::signal::mean_and_deviation;
use crate::state_space::boundary;
use nalgebra::{DMatrix, SymmetricEigen};
use rand::Rng;
use rand_distr::ChiSquared;
use serde::Serialize;
use statrs::function::beta::checked_beta_reg;
use statrs::function::erf::erfc_inv;
use std::convert::Infallible;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// `t` with `P(|T| ≤ t) = confidence` for `degrees_of_freedom > 0` (not necessarily whole).
pub(super) fn two_sided_quantile(confidence: f64, degrees_of_freedom: f64) -> f64 {
    let nu = degrees_of_freedom.max(0.5);
    let inside = |t: f64| 1.0 - incomplete_beta(nu / (nu + t * t), 0.5 * nu, 0.5);
    let (low, mut high) = (0.0, 2.0);
    while inside(high) < confidence && high < 1e12 {
        high *= 2.0;
    }
    let Ok([holds, fails]) = boundary(low, high, 0.0, |t| {
        Ok::<_, Infallible>(inside(t) < confidence)
    });
    0.5 * (holds + fails)
}

/// Regularised incomplete beta function `I_x(a, b)`; no number where it has none.
pub(super) fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    checked_beta_reg(a, b, x).unwrap_or(f64::NAN)
}

/// `Φ(z)`.
pub(super) fn normal_cdf(z: f64) -> f64 {
    0.5 * libm::erfc(-z * FRAC_1_SQRT_2)
}

/// `Φ⁻¹(u)` for `0 < u < 1`.
pub(super) fn normal_quantile(u: f64) -> f64 {
    -SQRT_2 * erfc_inv(2.0 * u)
}

/// Exact (Clopper–Pearson 1934) two-sided interval at the level `confidence` for `count` of `samples`.
pub(super) fn clopper_pearson(count: u64, samples: u64, confidence: f64) -> (f64, f64) {
    let tail = 0.5 * (1.0 - confidence);
    let (k, n) = (count as f64, samples as f64);
    let lower = match count {
        0 => 0.0,
        _ => beta_quantile(tail, k, n - k + 1.0),
    };
    let upper = match count == samples {
        true => 1.0,
        false => beta_quantile(1.0 - tail, k + 1.0, n - k),
    };
    (lower, upper)
}

/// `x` with `I_x(a, b) = probability`, by bisection.
fn beta_quantile(probability: f64, a: f64, b: f64) -> f64 {
    let below = |x| Ok::<_, Infallible>(incomplete_beta(x, a, b) < probability);
    let Ok([holds, fails]) = boundary(0.0, 1.0, 0.0, below);
    0.5 * (holds + fails)
}

/// Quantile of `count` values of which the lowest are `sorted`: linear between the order statistics, `(n − 1)p` from the first
/// (Hyndman and Fan's type 7). `None` beyond the sorted ones.
pub fn sample_quantile(sorted: &[f64], count: usize, probability: f64) -> Option<f64> {
    let place = probability * (count.max(1) - 1) as f64;
    let (below, share) = (place.floor() as usize, place.fract());
    match (sorted.get(below), sorted.get(below + 1)) {
        (Some(a), Some(b)) => Some(a + (b - a) * share),
        (Some(a), None) if share == 0.0 => Some(*a),
        _ => None,
    }
}

/// A factor `S` of a covariance, `C = S Sᵀ`, and its least and greatest eigenvalue; `None` without eigenvalues.
pub(super) fn covariance_root(covariance: DMatrix<f64>) -> Option<(DMatrix<f64>, [f64; 2])> {
    if covariance.is_empty() || !covariance.iter().all(|x| x.is_finite()) {
        return None;
    }
    let eigen = SymmetricEigen::try_new(covariance, f64::EPSILON, 10_000)?;
    let ends = [eigen.eigenvalues.min(), eigen.eigenvalues.max()];
    let roots = DMatrix::from_diagonal(&eigen.eigenvalues.map(|x| x.max(0.0).sqrt()));
    Some((eigen.eigenvectors * roots, ends))
}

/// Mean, scatter and interval of the onsets of many samples.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SampledOnsets {
    /// Mean, m/s.
    pub mean_m_s: f64,
    /// Standard deviation, m/s.
    pub standard_deviation_m_s: f64,
    /// 95 % of the samples lie between these, m/s.
    pub interval_m_s: [f64; 2],
    /// Samples without an onset up to the highest wind speed; they are not in the numbers above.
    pub without_onset: usize,
    /// The onset of each sample that has one, m/s, rising.
    #[serde(skip)]
    pub speeds_m_s: Vec<f64>,
}

impl From<Vec<Option<f64>>> for SampledOnsets {
    /// NaN in place of what the onsets are too few for.
    fn from(found: Vec<Option<f64>>) -> Self {
        let mut speeds: Vec<f64> = found.iter().copied().flatten().collect();
        speeds.sort_unstable_by(f64::total_cmp);
        let (mean_m_s, standard_deviation_m_s) = mean_and_deviation(speeds.iter().copied());
        let quantile = |p| sample_quantile(&speeds, speeds.len(), p).unwrap_or(f64::NAN);
        Self {
            mean_m_s,
            standard_deviation_m_s,
            interval_m_s: [0.025, 0.975].map(quantile),
            without_onset: found.len() - speeds.len(),
            speeds_m_s: speeds,
        }
    }
}

/// `√(ν/χ²_ν)`: Gaussian numbers times one of it are multivariate Student's t.
#[derive(Debug, Clone, Copy)]
pub struct StudentScale {
    freedom: f64,
    chi_squared: ChiSquared<f64>,
}

impl StudentScale {
    /// With `freedom` degrees of freedom.
    ///
    /// # Errors
    /// [`Error::Numerical`] for a number that is not positive.
    pub fn new(freedom: f64) -> Result<Self> {
        let failed = |e| Error::Numerical(format!("draws with {freedom} degrees of freedom: {e}"));
        Ok(Self {
            freedom,
            chi_squared: ChiSquared::new(freedom).map_err(failed)?,
        })
    }

    /// One of it.
    pub fn draw(&self, random: &mut impl Rng) -> f64 {
        (self.freedom / random.sample(self.chi_squared)).sqrt()
    }
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

    /// Quantiles of the standard tables to ten digits, and the two functions against each other over the tails.
    #[test]
    fn quantiles_of_the_normal_distribution() {
        for (u, z) in [
            (0.975, 1.959_963_984_540_054),
            (0.95, 1.644_853_626_951_472_2),
            (0.001, -3.090_232_306_167_813),
            (0.5, 0.0),
        ] {
            assert!((normal_quantile(u) - z).abs() < 1e-13, "{u}");
        }
        for z in [-8.0, -5.0, -2.0, -0.3, 0.7, 3.0] {
            assert!((normal_quantile(normal_cdf(z)) - z).abs() < 1e-9, "{z}");
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

    #[test]
    fn samples_without_an_onset_are_in_no_other_number() {
        let onsets = SampledOnsets::from(vec![Some(3.0), None, Some(1.0)]);
        assert_eq!(onsets.speeds_m_s, [1.0, 3.0]);
        assert_eq!((onsets.without_onset, onsets.mean_m_s), (1, 2.0));
        assert!((onsets.interval_m_s[0] - 1.05).abs() < 1e-12);
        assert!(SampledOnsets::from(vec![None]).interval_m_s[1].is_nan());
    }
}
