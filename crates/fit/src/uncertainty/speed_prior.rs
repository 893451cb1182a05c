//! What measured decks say of the scatter between mean speeds, before the deck at hand is looked at.
//!
//! Two speeds tell a variance with one or two degrees of freedom, one speed tells nothing. But girders resemble each
//! other in how much another run at another speed changes their forces: the ratio `φ` of the variance between speeds to what
//! independent test runs would give is drawn from one distribution for all of them, a scaled inverse chi-square
//! (inverse gamma) one, `φ = ν₀ τ²/χ²(ν₀)`. A ratio `r` that is estimated with `ν` degrees of freedom follows `φ χ²(ν)/ν`, so that over
//! the decks `r/τ²` follows `F(ν, ν₀)`; the mean of `ln r` over the measured decks gives `τ²`, and the estimate of a deck becomes
//! `(ν₀ τ² + ν r)/(ν₀ + ν)` with `ν₀ + ν` degrees of freedom (Smyth, "Linear models and empirical Bayes methods for assessing
//! differential expression in microarray experiments", *Stat. Appl. Genet. Mol. Biol.* 3, 2004).

use super::statistics::incomplete_beta;
use crate::signal::mean;
use statrs::function::gamma::digamma;

/// Test points at each speed and motion of the measured decks: `φ − 1` goes with their number, since it is measured against the
/// variance of the mean over them.
pub(super) const POINTS_OF_A_SPEED: f64 = 8.0;
/// Degrees of freedom of each measured ratio: two motions, two speeds.
const MEASURED_FREEDOM: f64 = 2.0;
/// `ν₀`. The likelihood of the measured ratios grows with it without end: they scatter no more than chance. At this value it is 1.8
/// below its limit, between the one-sided bounds of 95 and 97.5 %: as few as these decks hardly allow, so that a deck unlike them
/// soon counts by its own tests.
const PRIOR_FREEDOM: f64 = 6.0;

/// What the embedded measured decks show: a row of ratios and a row of standard deviations between speeds, in per cent of the transfer
/// functions (in phase: hundredths of a radian), each of lift and moment in size and in phase, of dissipative Laguerre models (L = 3)
/// fitted to the tables of heave and rotation. The test `ratios_are_those_of_the_embedded_decks` computes them anew.
pub(super) const MEASURED: [[[f64; 4]; 2]; 5] = [
    [[9.64, 3.08, 3.59, 3.97], [3.33, 2.02, 0.59, 0.95]],
    [[6.48, 1.34, 0.84, 1.38], [1.41, 1.01, 0.31, 0.40]],
    [[5.18, 1.21, 2.34, 2.35], [3.02, 2.30, 1.32, 1.69]],
    [[6.13, 1.09, 2.03, 2.33], [5.76, 2.74, 1.23, 1.39]],
    [[1.16, 2.16, 2.63, 3.01], [16.15, 71.34, 6.70, 6.54]],
];
/// Their names.
pub(super) const MEASURED_DECKS: [&str; 5] = [
    "LN20-5500",
    "LN21-5200",
    "LN21-5500",
    "LN21-5800",
    "LN21-6100",
];

/// Distribution of the ratio of the variance between speeds to that of independent test runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SpeedPrior {
    /// Its scale `τ²`.
    pub ratio: f64,
    /// Its degrees of freedom `ν₀`.
    pub degrees_of_freedom: f64,
    /// Geometric means of the standard deviations between speeds over the measured decks, relative to the transfer functions: lift in
    /// size and in phase, moment in size and in phase. A ratio to the scatter of runs says nothing where runs hardly scatter (long
    /// records, a table without noise): with tests at one speed no force is taken to scatter less than this.
    pub least: [f64; 4],
}

impl SpeedPrior {
    /// By the measured decks, one of them left out where it is the deck at hand.
    pub(super) fn measured(without: Option<&str>) -> Self {
        let decks = || MEASURED_DECKS.into_iter().zip(MEASURED);
        let others = || decks().filter(|(name, _)| Some(*name) != without);
        let ratios: Vec<f64> = others().flat_map(|(_, [ratios, _])| ratios).collect();
        let least = [0, 1, 2, 3].map(|column| {
            let logs = others().map(|(_, [_, percent])| percent[column].ln());
            0.01 * mean(&logs.collect::<Vec<_>>()).exp()
        });
        Self {
            least,
            ..Self::from_ratios(&ratios, MEASURED_FREEDOM)
        }
    }

    /// From ratios that were estimated with `freedom` degrees of freedom each.
    fn from_ratios(ratios: &[f64], freedom: f64) -> Self {
        let logs: f64 = ratios.iter().map(|r| r.ln()).sum();
        // mean of ln χ²(ν)/ν
        let bias = |nu: f64| digamma(0.5 * nu) - (0.5 * nu).ln();
        let mean = logs / ratios.len() as f64;
        Self {
            ratio: (mean - bias(freedom) + bias(PRIOR_FREEDOM)).exp(),
            degrees_of_freedom: PRIOR_FREEDOM,
            least: [0.0; 4],
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

    /// The same for a deck whose ratios are `mean` on average, with `freedom` degrees of freedom together: the prior counts by the
    /// probability that a measured deck would scatter as much or more, so that one that scatters far more counts by its own tests.
    pub(super) fn for_deck(self, mean: f64, freedom: f64) -> Self {
        let (nu, own) = (freedom, self.degrees_of_freedom);
        let x = nu * mean / (nu * mean + own * self.ratio);
        let more = 1.0 - incomplete_beta(x, 0.5 * nu, 0.5 * own);
        Self {
            degrees_of_freedom: own * more,
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
            ..self
        }
    }

    /// The same for a force whose variance between speeds, over that of its blocks, is not taken to be below `beyond`.
    pub(super) fn at_least(self, beyond: f64) -> Self {
        Self {
            ratio: self.ratio.max(1.0 + beyond),
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantiles of `τ² F(2, ν₀)` in closed form, `τ² ν₀/2 ((1 − u)^(−2/ν₀) − 1)`, at 20 000 evenly spaced probabilities give back the
    /// scale that they were made with.
    #[test]
    fn logarithms_give_the_scale() {
        let (scale, nu) = (3.0, PRIOR_FREEDOM);
        let quantile = |i: usize| {
            let u = (i as f64 + 0.5) / 20_000.0;
            scale * 0.5 * nu * ((1.0 - u).powf(-2.0 / nu) - 1.0)
        };
        let ratios: Vec<f64> = (0..20_000).map(quantile).collect();
        let found = SpeedPrior::from_ratios(&ratios, 2.0);
        // the ends of the distribution are missing between the probabilities
        assert!((found.ratio / scale - 1.0).abs() < 1e-3, "{found:?}");
    }

    /// Density of `τ² F(2, ν₀)`: `(1 + 2r/(ν₀ τ²))^(−(ν₀ + 2)/2)/τ²`; its greatest likelihood over `τ²` at `ν₀ = 6` and in the limit, where `τ²`
    /// is the mean. One-sided 95 and 97.5 % of `χ²(1)/2` are 1.353 and 1.921.
    #[test]
    fn degrees_of_freedom_are_the_fewest_of_the_measured_decks() {
        let ratios: Vec<f64> = MEASURED.iter().flat_map(|[r, _]| *r).collect();
        let greatest = |nu: f64| {
            let at = |scale: f64| -> f64 {
                let one =
                    |r: &f64| -0.5 * (nu + 2.0) * (2.0 * r / (nu * scale)).ln_1p() - scale.ln();
                ratios.iter().map(one).sum()
            };
            let scales = (0..4000).map(|i| 1.0 + 0.001 * f64::from(i));
            scales.map(at).fold(f64::NEG_INFINITY, f64::max)
        };
        let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
        let limit = -(ratios.len() as f64) * (mean.ln() + 1.0);
        let below = limit - greatest(PRIOR_FREEDOM);
        assert!((1.353..1.921).contains(&below), "{below}");
        assert!(greatest(1e5) > greatest(100.0) && greatest(100.0) > greatest(20.0));
    }

    /// SciPy: `6 f.sf(100, 8, 6)/0.05`.
    #[test]
    fn a_deck_far_outside_counts_by_its_own_tests() {
        let prior = SpeedPrior::measured(None);
        // SciPy: 6 f.sf(1, 8, 6) and 6 f.sf(100, 8, 6)
        let like = prior.for_deck(prior.ratio, 8.0);
        assert!((like.degrees_of_freedom / 3.088_560_039 - 1.0).abs() < 1e-6);
        let far = prior.for_deck(100.0 * prior.ratio, 8.0);
        assert!(
            (far.degrees_of_freedom / 4.867_859_845e-5 - 1.0).abs() < 1e-6,
            "{far:?}"
        );
        assert!((far.after(500.0, 2.0).ratio / 500.0 - 1.0).abs() < 1e-3);
    }

    /// SciPy: `exp(mean(log r) − digamma(1) + digamma(3) − log(3))`.
    #[test]
    fn the_prior_of_the_measured_decks() {
        let all = SpeedPrior::measured(None);
        assert!((all.ratio - 3.737).abs() < 1e-3, "{all:?}");
        for name in MEASURED_DECKS {
            let without = SpeedPrior::measured(Some(name));
            assert!((2.5..4.5).contains(&without.ratio), "{name}: {without:?}");
        }
    }
}
