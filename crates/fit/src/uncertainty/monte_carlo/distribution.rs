//! Distributions of single parameters, as they stand in the file.

use crate::error::{Error, Result, ensure, finite, positive};
use crate::uncertainty::statistics::{normal_cdf, normal_quantile};
use serde::Deserialize;

/// Probability that must be left between the ends of a truncated distribution.
const SMALLEST_PROBABILITY: f64 = 1e-9;

/// Distribution of one parameter. Mean and scatter are those of the parameter itself (for the lognormal one too); a mean
/// that is left out is the value of the model, and the scatter is either a standard deviation in the unit of the
/// parameter or a coefficient of variation.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Distribution {
    /// Gaussian; a bound that is given truncates it.
    Normal(Gaussian),
    /// The logarithm is Gaussian; a bound that is given truncates it.
    Lognormal(Gaussian),
    /// Every value between two ends is as likely.
    Uniform {
        /// Lower end.
        lower: f64,
        /// Upper end.
        upper: f64,
    },
}

/// A Gaussian or lognormal distribution, in numbers of the parameter itself.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gaussian {
    /// Mean before truncation.
    pub mean: Option<f64>,
    /// Standard deviation before truncation.
    pub standard_deviation: Option<f64>,
    /// Standard deviation over mean, before truncation.
    pub coefficient_of_variation: Option<f64>,
    /// Lower end.
    pub lower: Option<f64>,
    /// Upper end.
    pub upper: Option<f64>,
}

/// A distribution with its numbers worked out: the parameter for a standard normal variable.
pub(super) type Transform = Box<dyn Fn(f64) -> f64 + Send + Sync>;

impl Distribution {
    /// The mean, of a truncated one no further out than its ends; `nominal` is the value of the model.
    pub(super) fn mean(&self, nominal: f64) -> f64 {
        match self {
            Self::Uniform { lower, upper } => 0.5 * (lower + upper),
            Self::Normal(given) | Self::Lognormal(given) => {
                let mean = given.mean.unwrap_or(nominal);
                let mean = given.lower.map_or(mean, |end| mean.max(end));
                given.upper.map_or(mean, |end| mean.min(end))
            }
        }
    }

    /// Works out the numbers; `nominal` is the value of the model, `place` the entry of the file.
    ///
    /// # Errors
    /// [`Error::Input`] for numbers that make no such distribution.
    pub(super) fn resolve(&self, place: &str, nominal: f64) -> Result<Transform> {
        let at = |key: &str| format!("{place}.{key}");
        match self {
            Self::Uniform { lower, upper } => {
                ensure(
                    lower.is_finite() && upper.is_finite() && lower < upper,
                    at("lower"),
                    "a finite number below `upper`",
                    format_args!("{lower} to {upper}"),
                )?;
                let (lower, width) = (*lower, upper - lower);
                Ok(Box::new(move |z| lower + width * normal_cdf(z)))
            }
            Self::Normal(given) => {
                let mean = finite(at("mean"), given.mean.unwrap_or(nominal))?;
                let deviation = given.deviation(place, mean)?;
                gaussian(place, mean, deviation, given.lower, given.upper, false)
            }
            Self::Lognormal(given) => {
                let mean = positive(at("mean"), given.mean.unwrap_or(nominal))?;
                let ratio = given.deviation(place, mean)? / mean;
                let variance = (ratio * ratio).ln_1p();
                let log = |key: &str, end: Option<f64>| {
                    end.map(|x| positive(at(key), x).map(f64::ln)).transpose()
                };
                let (lower, upper) = (log("lower", given.lower)?, log("upper", given.upper)?);
                let (mean, deviation) = (mean.ln() - 0.5 * variance, variance.sqrt());
                gaussian(place, mean, deviation, lower, upper, true)
            }
        }
    }
}

impl Gaussian {
    /// The standard deviation for a mean, in the unit of the parameter.
    fn deviation(&self, place: &str, mean: f64) -> Result<f64> {
        match (self.standard_deviation, self.coefficient_of_variation) {
            (Some(s), None) => positive(format!("{place}.standard_deviation"), s),
            (None, Some(c)) => {
                let key = format!("{place}.coefficient_of_variation");
                positive(&key, c)?;
                positive(&key, c * mean.abs())
            }
            (given, _) => Err(Error::input(
                place,
                "either `standard_deviation` or `coefficient_of_variation`",
                if given.is_some() { "both" } else { "neither" },
            )),
        }
    }
}

/// The transform of a Gaussian, of the logarithm if `exponential`, cut where it has ends.
fn gaussian(
    place: &str,
    mean: f64,
    deviation: f64,
    lower: Option<f64>,
    upper: Option<f64>,
    exponential: bool,
) -> Result<Transform> {
    let scaled = move |z: f64| {
        let x = mean + deviation * z;
        if exponential { x.exp() } else { x }
    };
    if lower.is_none() && upper.is_none() {
        return Ok(Box::new(scaled));
    }
    let standard = |end: f64| (end - mean) / deviation;
    let low = lower.map_or(f64::NEG_INFINITY, standard);
    let high = upper.map_or(f64::INFINITY, standard);
    // in the upper tail the quantiles are taken from the other side, where they hold their digits
    let mirrored = low > 0.0;
    let (a, b) = if mirrored { (-high, -low) } else { (low, high) };
    let (from, to) = (normal_cdf(a), normal_cdf(b));
    let end = |e: Option<f64>| e.map_or("open".to_owned(), |e| e.to_string());
    let key = if lower.is_some() { "lower" } else { "upper" };
    ensure(
        to - from > SMALLEST_PROBABILITY,
        format_args!("{place}.{key}"),
        "bounds between which the distribution has some probability",
        format_args!("{} to {}", end(lower), end(upper)),
    )?;
    let sign = if mirrored { -1.0 } else { 1.0 };
    // the standard normal variable between the ends for an unbounded one
    Ok(Box::new(move |z| {
        let u = from + (to - from) * normal_cdf(sign * z);
        scaled(sign * normal_quantile(u.clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON)))
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Transform {
        let d: Distribution = serde_json::from_str(text).unwrap();
        d.resolve("p", 2.0).unwrap()
    }

    /// Mean and standard deviation over equal steps of probability; closed forms beside them.
    fn moments(t: Transform) -> (f64, f64) {
        const N: usize = 20_000;
        let values: Vec<f64> = (0..N)
            .map(|i| t(normal_quantile((i as f64 + 0.5) / N as f64)))
            .collect();
        let mean = values.iter().sum::<f64>() / N as f64;
        let square = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / N as f64;
        (mean, square.sqrt())
    }

    #[test]
    fn moments_are_those_stated() {
        let (mean, deviation) = moments(parse(
            r#"{"kind":"lognormal","coefficient_of_variation":0.3}"#,
        ));
        // the midpoint rule leaves out a little of the tail
        assert!(
            (mean - 2.0).abs() < 1e-4 && (deviation - 0.6).abs() < 1e-3,
            "{mean} {deviation}"
        );
        let (mean, deviation) = moments(parse(r#"{"kind":"uniform","lower":1.0,"upper":4.0}"#));
        assert!((mean - 2.5).abs() < 1e-12 && (deviation - 3.0 / 12f64.sqrt()).abs() < 1e-6);
        // half a Gaussian: mean μ + σ√(2/π), in both directions
        for (end, sign) in [("lower", 1.0), ("upper", -1.0)] {
            let text = format!(r#"{{"kind":"normal","standard_deviation":0.5,"{end}":2.0}}"#);
            let (mean, _) = moments(parse(&text));
            let expected = 2.0 + sign * 0.5 * (2.0 / std::f64::consts::PI).sqrt();
            assert!((mean - expected).abs() < 1e-4, "{mean}");
        }
    }

    #[test]
    fn truncation_keeps_the_ends_in_either_tail() {
        for (lower, upper) in [(4.0, 4.5), (0.1, 0.4), (1.0, 3.0)] {
            let t = parse(&format!(
                r#"{{"kind":"normal","standard_deviation":0.5,"lower":{lower},"upper":{upper}}}"#
            ));
            let mut last = f64::NEG_INFINITY;
            for z in [-6.0, -2.0, 0.0, 1.0, 6.0] {
                let x = t(z);
                assert!(
                    lower <= x + 1e-9 && x <= upper + 1e-9 && x > last,
                    "{x} at {z}"
                );
                last = x;
            }
        }
    }

    #[test]
    fn nonsense_is_refused_by_key() {
        for (text, said) in [
            (r#"{"kind":"normal"}"#, "found neither"),
            (
                r#"{"kind":"normal","standard_deviation":1.0,"coefficient_of_variation":1.0}"#,
                "found both",
            ),
            (
                r#"{"kind":"normal","standard_deviation":-1.0}"#,
                "p.standard_deviation",
            ),
            (
                r#"{"kind":"lognormal","mean":-1.0,"standard_deviation":1.0}"#,
                "p.mean",
            ),
            (r#"{"kind":"uniform","lower":2.0,"upper":1.0}"#, "p.lower"),
            (
                r#"{"kind":"normal","standard_deviation":0.1,"lower":9.0}"#,
                "some probability",
            ),
        ] {
            let d: Distribution = serde_json::from_str(text).unwrap();
            let message = d.resolve("p", 2.0).err().unwrap().to_string();
            assert!(message.contains(said), "{message}");
        }
    }
}
