//! What measured decks say of the scatter between mean speeds, before the deck at hand is looked at.
//!
//! Two speeds tell a variance with one or two degrees of freedom, one speed tells nothing. But girders resemble each
//! other in how much another run at another speed changes their forces: the ratio `φ` of the variance between speeds to what
//! independent test runs would give is drawn from one distribution for all of them, a scaled inverse chi-square
//! (inverse gamma) one, `φ = ν₀ τ²/χ²(ν₀)`. A ratio `r` that is estimated with `ν` degrees of freedom follows `φ χ²(ν)/ν`, so that over
//! the decks `r/τ²` follows `F(ν, ν₀)`; the mean and the variance of `ln r` over the measured decks give `τ²` and `ν₀`, and the
//! estimate of a deck becomes `(ν₀ τ² + ν r)/(ν₀ + ν)` with `ν₀ + ν` degrees of freedom (Smyth, "Linear models and empirical Bayes
//! methods for assessing differential expression in microarray experiments", *Stat. Appl. Genet. Mol. Biol.* 3, 2004).

use crate::state_space::boundary;
use statrs::function::gamma::digamma;
use std::convert::Infallible;

/// Test points at each speed and motion of the measured decks: `φ − 1` goes with their number, since it is measured against the
/// variance of the mean over them.
pub(super) const POINTS_OF_A_SPEED: f64 = 8.0;
/// Degrees of freedom of each measured ratio: two motions, two speeds.
const MEASURED_FREEDOM: f64 = 2.0;
/// More degrees of freedom than this are a prior without scatter.
const KNOWN: f64 = 1e4;

/// Ratios of the embedded measured decks: lift and moment, each in size and in phase, of Laguerre models (L = 3) fitted by least
/// squares without constraints. A test computes them anew.
const MEASURED: [(&str, [f64; 4]); 5] = [
    ("LN20-5500", [1.0, 1.0, 1.0, 1.0]),
    ("LN21-5200", [1.0, 1.0, 1.0, 1.0]),
    ("LN21-5500", [1.0, 1.0, 1.0, 1.0]),
    ("LN21-5800", [1.0, 1.0, 1.0, 1.0]),
    ("LN21-6100", [1.0, 1.0, 1.0, 1.0]),
];

/// Distribution of the ratio of the variance between speeds to that of independent test runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SpeedPrior {
    /// Its scale `τ²`.
    pub ratio: f64,
    /// Its degrees of freedom `ν₀`.
    pub degrees_of_freedom: f64,
}

impl SpeedPrior {
    /// By the measured decks, one of them left out where it is the deck at hand.
    pub(super) fn measured(without: Option<&str>) -> Self {
        let decks = MEASURED.iter().filter(|(name, _)| Some(*name) != without);
        let ratios: Vec<f64> = decks.flat_map(|(_, ratios)| *ratios).collect();
        Self::of(&ratios, MEASURED_FREEDOM)
    }

    /// From ratios that were estimated with `freedom` degrees of freedom each.
    fn of(ratios: &[f64], freedom: f64) -> Self {
        let count = ratios.len() as f64;
        let logs: Vec<f64> = ratios.iter().map(|r| r.ln()).collect();
        let mean = logs.iter().sum::<f64>() / count;
        let squares: f64 = logs.iter().map(|x| (x - mean).powi(2)).sum();
        // ln χ²(ν)/ν has the mean ψ(ν/2) − ln(ν/2) and the variance ψ'(ν/2)
        let bias = |nu: f64| digamma(0.5 * nu) - (0.5 * nu).ln();
        let spread = squares / (count - 1.0) - trigamma(0.5 * freedom);
        let wide = |nu: f64| Ok::<_, Infallible>(trigamma(0.5 * nu) > spread);
        let Ok(found) = boundary(1e-2, KNOWN, 0.0, wide);
        let degrees_of_freedom = found.middle();
        Self {
            ratio: (mean - bias(freedom) + bias(degrees_of_freedom)).exp(),
            degrees_of_freedom,
        }
    }

    /// The same for speeds with another number of test points.
    pub(super) fn at_points(self, points: f64) -> Self {
        let beyond = (self.ratio - 1.0) * points / POINTS_OF_A_SPEED;
        Self {
            ratio: 1.0 + beyond.max(0.0),
            ..self
        }
    }

    /// After a ratio was estimated with `freedom` degrees of freedom.
    pub(super) fn after(self, ratio: f64, freedom: f64) -> Self {
        let degrees_of_freedom = self.degrees_of_freedom + freedom;
        let sum = self.degrees_of_freedom * self.ratio + freedom * ratio;
        Self {
            ratio: sum / degrees_of_freedom,
            degrees_of_freedom,
        }
    }
}

/// `ψ'(x)` for `x > 0`: the recurrence up to `x + 10`, then the asymptotic series.
fn trigamma(x: f64) -> f64 {
    let near: f64 = (0..10).map(|i| (x + f64::from(i)).powi(-2)).sum();
    let y = (x + 10.0).recip();
    let even = y * y;
    let series = 1.0 / 6.0 - even * (1.0 / 30.0 - even * (1.0 / 42.0 - even / 30.0));
    near + y + 0.5 * even + y * even * series
}
