//! Metric of non-stationary content.

use super::amplitude::{DistanceDetails, content_metric};
use super::morlet::{LevelGroup, Morlet, RowBuffer, WaveletParameters};
use super::scalogram::{Moments, Scalogram};
use super::surrogates::{gamma_cumulative, gamma_fit, phase_randomised};
use super::{Metric, SignalPair};
use crate::error::{Error, Result, ensure, non_negative};
use crate::signal::{Complex64, mean_and_deviation};
use aerodeck_core::threads;
use serde::Serialize;

/// Parameters of [`stationarity`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StationarityParameters {
    /// Transform; default [`WaveletParameters::default`]. Time grows with levels times surrogates.
    pub wavelet: WaveletParameters,
    /// Number of surrogates of each signal; default 200.
    pub surrogate_count: usize,
    /// Level of the test: a signal is stationary if its statistic lies below this quantile; default 0.95.
    pub confidence: f64,
    /// Standard deviations above the mean of the surrogates' scalograms that non-stationary content has to reach,
    /// `g`; default 2.
    pub threshold_deviations: f64,
    /// Seed of the surrogates, default 1; both signals use it, so that equal signals pass the same test.
    pub seed: u64,
}

impl Default for StationarityParameters {
    fn default() -> Self {
        Self {
            wavelet: WaveletParameters::default(),
            surrogate_count: 200,
            confidence: 0.95,
            threshold_deviations: 2.0,
            seed: 1,
        }
    }
}

/// Test of one signal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StationarityTest {
    /// Statistic Θ of the signal over the standard deviation of those of its surrogates.
    pub statistic: f64,
    /// Its probability under the gamma distribution fitted to the surrogates.
    pub probability: f64,
    /// Whether the probability is below the level of the test.
    pub stationary: bool,
}

/// What [`stationarity`] found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StationarityDetails {
    /// Test of the reference.
    pub reference: StationarityTest,
    /// Test of the compared signal.
    pub compared: StationarityTest,
    /// Norms of the non-stationary content, if both signals have some.
    pub content: Option<DistanceDetails>,
}

/// Stationarity metric `M_s`: 1 if both signals are stationary, 0 if one is; if neither is, the wavelet metric of
/// their non-stationary content, `exp(−‖F₁ − F₂‖_F/‖F₁‖_F)` inside the cone of influence.
///
/// Test (after Borgnat et al. 2010, IEEE Trans. Signal Process. 58(7)): with the scalogram `S = |W|²`, its local
/// spectra `G(f, t)` and global spectrum `H(f)` of unit area, `Θ = var_t[Σ (G − H) log₁₀(G/H) Δf] ·
/// (1 + var_t[Σ |log₁₀(S/S̄)| Δf])`, compared with the Θ of phase-randomised surrogates through a gamma
/// distribution. All samples enter Θ, the ends of the record weigh alike on signal and surrogates.
/// Content `F`: `|W|` where `S` exceeds, at its frequency, the largest over time of mean + g standard deviations of
/// the surrogates' scalograms; both 0 gives 1, one 0 gives 0.
///
/// Memory: sums over the levels, 40 bytes per sample and surrogate.
///
/// # Errors
/// [`Error::Input`] for unusable parameters, a record too short for the cone, or a signal whose surrogates do not
/// scatter (a constant, or all power at one Fourier frequency).
pub fn stationarity(
    pair: &SignalPair<'_>,
    parameters: &StationarityParameters,
) -> Result<Metric<StationarityDetails>> {
    check(parameters)?;
    let plan = Morlet::new(&parameters.wavelet, pair.sample_count(), pair.time_step_s())?;
    let signals =
        [pair.reference, pair.compared].map(|signal| Surrogates::new(&plan, signal, parameters));
    let reference = signals[0].test("reference signal", parameters)?;
    let compared = signals[1].test("compared signal", parameters)?;
    let (value, content) = match (reference.stationary, compared.stationary) {
        (true, true) => (1.0, None),
        (false, false) => {
            let metric = of_contents(&plan, &signals)?;
            (metric.value, Some(metric.details))
        }
        _ => (0.0, None),
    };
    Ok(Metric {
        value,
        details: StationarityDetails {
            reference,
            compared,
            content,
        },
    })
}

fn check(parameters: &StationarityParameters) -> Result<()> {
    let count = parameters.surrogate_count;
    ensure(count >= 2, "number of surrogates", "at least 2", count)?;
    let confidence = parameters.confidence;
    ensure(
        confidence > 0.0 && confidence < 1.0,
        "confidence of the stationarity test",
        "a number between 0 and 1",
        confidence,
    )?;
    let threshold = parameters.threshold_deviations;
    non_negative("threshold of non-stationary content", threshold).map(drop)
}

/// Surrogates that one thread takes at a time.
const CHUNK: usize = 16;

/// What the transforms of a signal and of its surrogates give.
struct Surrogates<'a> {
    signal: &'a [f64],
    /// Statistic Θ of the signal.
    own: f64,
    /// Those of the surrogates.
    others: Vec<f64>,
    /// Largest over time of mean + g standard deviations of the surrogates' scalograms, at each level.
    thresholds: Vec<f64>,
}

impl<'a> Surrogates<'a> {
    fn new(plan: &Morlet, signal: &'a [f64], parameters: &StationarityParameters) -> Self {
        let drawn = phase_randomised(signal, parameters.surrogate_count, parameters.seed);
        let mut own = Scalogram::new(signal.to_vec());
        let mut others: Vec<Scalogram> = drawn.into_iter().map(Scalogram::new).collect();
        let mut thresholds = Vec::with_capacity(plan.level_count());
        for group in plan.groups() {
            let kernels = threads::numbered(group.levels.len(), true, |level| {
                group.kernel(group.levels.start + level)
            });
            own.advance(&group, &kernels, &mut RowBuffer::default(), |_, _| ());
            let chunks = threads::in_parts(&mut others, CHUNK, |_, chunk| {
                let mut moments = vec![Moments::new(signal.len()); kernels.len()];
                let mut buffer = RowBuffer::default();
                for other in chunk {
                    let add = |at: usize, power: &[f64]| moments[at].add(power);
                    other.advance(&group, &kernels, &mut buffer, add);
                }
                moments
            });
            let mut chunks = chunks.into_iter();
            let mut moments = chunks.next().unwrap_or_default();
            for chunk in chunks {
                let each = moments.iter_mut().zip(&chunk);
                each.for_each(|(all, more)| all.merge(more));
            }
            let threshold = |m: &Moments| m.threshold(parameters.threshold_deviations);
            thresholds.extend(moments.iter().map(threshold));
        }
        let step = plan.frequency_step_hz();
        Self {
            signal,
            own: own.statistic(step),
            others: others.iter().map(|s| s.statistic(step)).collect(),
            thresholds,
        }
    }

    fn test(&self, place: &str, parameters: &StationarityParameters) -> Result<StationarityTest> {
        let (_, deviation) = mean_and_deviation(self.others.iter().copied());
        let scaled: Vec<f64> = self.others.iter().map(|x| x / deviation).collect();
        let Some([shape, scale]) = gamma_fit(&scaled) else {
            return Err(Error::input(
                place,
                "a signal with power at several frequencies",
                "one whose phase-randomised surrogates are all alike",
            ));
        };
        let statistic = self.own / deviation;
        let probability = gamma_cumulative(shape, scale, statistic);
        Ok(StationarityTest {
            statistic,
            probability,
            stationary: probability < parameters.confidence,
        })
    }

    /// `|W|` inside the cone where it stands out of the surrogates, else 0; level after level.
    fn content(&self, plan: &Morlet, group: &LevelGroup<'_>) -> Vec<f64> {
        let (spectrum, mut buffer) = (group.spectrum(self.signal), RowBuffer::default());
        let mut content = Vec::new();
        for level in group.levels.clone() {
            let (inside, threshold) = (plan.inside(level), self.thresholds[level]);
            if !inside.is_empty() {
                let row = group.row(&group.kernel(level), &spectrum, &mut buffer);
                let stands_out = |w: &Complex64| w.norm_sqr() > threshold;
                let modulus = |w: &Complex64| if stands_out(w) { w.norm() } else { 0.0 };
                content.extend(row[inside].iter().map(modulus));
            }
        }
        content
    }
}

/// The wavelet metric of the non-stationary content.
fn of_contents(plan: &Morlet, signals: &[Surrogates<'_>; 2]) -> Result<Metric<DistanceDetails>> {
    let groups = plan.by_groups(|group| {
        let [first, second] = signals.each_ref().map(|s| s.content(plan, &group));
        let pairs = first.into_iter().zip(second);
        pairs.filter(|p| *p != (0.0, 0.0)).collect::<Vec<_>>()
    });
    content_metric(groups.iter().flatten().copied())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::random_stream;
    use approx::assert_relative_eq;
    use rand_distr::{Distribution, StandardNormal};

    const COUNT: usize = 1024;

    fn parameters() -> StationarityParameters {
        StationarityParameters {
            wavelet: WaveletParameters {
                level_count: 20,
                frequency_min_hz: 2.0,
                frequency_max_hz: 20.0,
                ..WaveletParameters::default()
            },
            surrogate_count: 40,
            ..StationarityParameters::default()
        }
    }

    fn noise(stream: u64) -> Vec<f64> {
        let mut random = random_stream(99, stream);
        (0..COUNT)
            .map(|_| StandardNormal.sample(&mut random))
            .collect()
    }

    /// Noise of which a burst at 8 Hz stands out.
    fn burst(amplitude: f64, stream: u64) -> Vec<f64> {
        let mut x = noise(stream);
        for (k, value) in x.iter_mut().enumerate() {
            let t = (k as f64 - 512.0) * 0.01;
            *value += amplitude * (-t * t / 0.5).exp() * (std::f64::consts::TAU * 8.0 * t).cos();
        }
        x
    }

    fn metric(x1: &[f64], x2: &[f64]) -> Metric<StationarityDetails> {
        let pair = SignalPair::new(x1, x2, 0.01).unwrap();
        stationarity(&pair, &parameters()).unwrap()
    }

    #[test]
    fn noise_is_stationary_and_bursts_are_not() {
        let both = metric(&noise(1), &noise(2));
        assert!(both.details.reference.stationary && both.details.compared.stationary);
        assert_eq!(both.value, 1.0);
        let one = metric(&noise(1), &burst(12.0, 2));
        assert!(!one.details.compared.stationary);
        assert_eq!(one.value, 0.0);
    }

    #[test]
    fn content_of_bursts_is_compared() {
        let x = burst(12.0, 3);
        let twice: Vec<f64> = x.iter().map(|v| 2.0 * v).collect();
        let metric = metric(&x, &twice);
        let content = metric.details.content.unwrap();
        assert!(content.reference_norm > 0.0);
        // The same surrogates twice as large, so the same content twice as large.
        assert_relative_eq!(metric.value, (-1.0_f64).exp(), max_relative = 1e-12);
    }

    #[test]
    fn statistic_is_the_sum_of_the_definition() {
        let p = parameters();
        let plan = Morlet::new(&p.wavelet, COUNT, 0.01).unwrap();
        let mut signal = Scalogram::new(burst(3.0, 4));
        let mut scalogram: Vec<Vec<f64>> = Vec::new();
        for group in plan.groups() {
            let kernels: Vec<_> = group.levels.clone().map(|l| group.kernel(l)).collect();
            signal.advance(&group, &kernels, &mut RowBuffer::default(), |_, power| {
                scalogram.push(power.to_vec())
            });
        }
        let df = 18.0 / 19.0;
        let mean: Vec<f64> = scalogram
            .iter()
            .map(|row| row.iter().sum::<f64>() / COUNT as f64)
            .collect();
        let area = mean.iter().sum::<f64>() * df;
        let at = |t: usize| {
            let local = scalogram.iter().map(|row| row[t]).sum::<f64>() * df;
            let mut sums = (0.0, 0.0);
            for (row, m) in scalogram.iter().zip(&mean) {
                let (g, h) = (row[t] / local, m / area);
                sums.0 += (g - h) * (g / h).log10() * df;
                sums.1 += (row[t] / m).log10().abs() * df;
            }
            sums
        };
        let (kl, lsd): (Vec<f64>, Vec<f64>) = (0..COUNT).map(at).unzip();
        let variance = |x: &[f64]| mean_and_deviation(x.iter().copied()).1.powi(2);
        assert_relative_eq!(
            signal.statistic(df),
            variance(&kl) * (1.0 + variance(&lsd)),
            max_relative = 1e-10
        );
    }
}
