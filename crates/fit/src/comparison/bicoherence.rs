//! Metric of quadratic phase coupling.

use super::amplitude::content_metric;
use super::morlet::{Morlet, RowBuffer, WaveletParameters};
use super::{Metric, SignalPair};
use crate::error::{Result, ensure, non_negative, positive};
use crate::signal::{Complex64, mean_and_deviation, random_stream};
use aerodeck_core::threads;
use nalgebra::DMatrix;
use rand::Rng;
use serde::Serialize;
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// Parameters of [`bicoherence`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BicoherenceParameters {
    /// Transform; default [`WaveletParameters::default`] with 120 levels. Time grows with the square of the levels.
    pub wavelet: WaveletParameters,
    /// Half width of the random factor `R` of the biphase, rad per rad; default 10π.
    pub randomisation: f64,
    /// Smallest constant biphase of the surrogates, rad; default 0.2.
    pub smallest_biphase_rad: f64,
    /// Number of surrogates; default 100.
    pub surrogate_count: usize,
    /// Standard deviations above the mean of the surrogates that coupling has to reach; default 2.
    pub threshold_deviations: f64,
    /// Seed of the random factors, default 1; both signals use the same ones.
    pub seed: u64,
}

impl Default for BicoherenceParameters {
    fn default() -> Self {
        Self {
            wavelet: WaveletParameters {
                level_count: 120,
                ..WaveletParameters::default()
            },
            randomisation: 10.0 * PI,
            smallest_biphase_rad: 0.2,
            surrogate_count: 100,
            threshold_deviations: 2.0,
            seed: 1,
        }
    }
}

/// A pair of frequencies coupled in one signal or both.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Coupling {
    /// Lower frequency, Hz.
    pub first_hz: f64,
    /// Higher frequency, Hz; the third is the sum.
    pub second_hz: f64,
    /// Autobispectrum `B` of the reference, 0 if below its threshold (unit of the signals to the sixth).
    pub reference: f64,
    /// The same of the compared signal.
    pub compared: f64,
}

/// What [`bicoherence`] found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BicoherenceDetails {
    /// Coupled pairs of frequencies.
    pub couplings: Vec<Coupling>,
    /// Thresholds of `B` in reference and compared signal.
    pub thresholds: [f64; 2],
}

/// Bicoherence metric `M_b = exp(−‖√B₁ − √B₂‖₂/‖√B₁‖₂)` of the phase-randomised wavelet autobispectra
/// `B(f₁,f₂) = |Σ_t W(f₁,t) W(f₂,t) W*(f₁+f₂,t) e^{iR(t)β(t)} Δt|²`, β the biphase (argument of the triple product).
///
/// `R` is uniform in ±10π at every sample: only products whose biphase stays at zero, coupled quadratically, add
/// up. Surrogates have the moduli of the products and one biphase each, uniform in ±(0.2, π); `B` counts where it
/// exceeds the largest over the plane of `(mean + g · standard deviation)²` of the surrogates' `√B`. The plane is
/// `f₁ ≤ f₂ ≤ f_max/2`; all pairs share the random factors of a surrogate. Samples inside the cone of influence of
/// `f₁` count. No coupling in either signal gives 1, in one of them 0.
///
/// Memory: `W` at all levels up to `f_max/2` and their sums, 96 bytes per level and sample, and 16 bytes per surrogate and sample.
///
/// # Errors
/// [`Error::Input`](crate::error::Error::Input) for unusable parameters or a record too short for the cone at `f_max/2`.
pub fn bicoherence(
    pair: &SignalPair<'_>,
    parameters: &BicoherenceParameters,
) -> Result<Metric<BicoherenceDetails>> {
    let plane = Plane::new(pair, parameters)?;
    let [first, second] =
        [pair.reference, pair.compared].map(|signal| plane.thresholded(signal, parameters));
    let both = plane.cells().zip(first.0.iter().zip(&second.0));
    let coupled = both.filter(|(_, (a, b))| **a > 0.0 || **b > 0.0);
    let coupling = |((i, j), (&reference, &compared)): ((_, _), (&_, &_))| Coupling {
        first_hz: plane.single.frequency_hz(i),
        second_hz: plane.single.frequency_hz(j),
        reference,
        compared,
    };
    let couplings: Vec<Coupling> = coupled.map(coupling).collect();
    let root = |c: &Coupling| (c.reference.sqrt(), c.compared.sqrt());
    Ok(Metric {
        value: content_metric(couplings.iter().map(root))?.value,
        details: BicoherenceDetails {
            couplings,
            thresholds: [first.1, second.1],
        },
    })
}

fn check(parameters: &BicoherenceParameters) -> Result<()> {
    non_negative("randomisation of the biphase", parameters.randomisation)?;
    non_negative("threshold of coupling", parameters.threshold_deviations)?;
    let smallest = positive("smallest biphase, rad", parameters.smallest_biphase_rad)?;
    let below = "a number below π";
    ensure(smallest < PI, "smallest biphase, rad", below, smallest)?;
    let count = parameters.surrogate_count;
    ensure(count >= 2, "number of surrogates", "at least 2", count)
}

/// The plane of frequency pairs and what all pairs share.
struct Plane {
    /// Transform at the frequencies themselves, up to `f_max/2`.
    single: Morlet,
    /// Transform at their sums: twice the lowest frequency on, same distance, level i + j.
    sums: Morlet,
    time_step_s: f64,
    /// `R(t)`.
    factors: Vec<f64>,
    /// `e^{−2πiR(t)}`: what a biphase beyond π is turned back by.
    turns: Vec<Complex64>,
    /// `e^{iφ(1 + R(t))}` of each surrogate, real and imaginary part, a column each.
    surrogates: DMatrix<f64>,
}

/// `W` at one level over time, in the parts of which the triple products consist.
struct LevelRow {
    modulus: Vec<f64>,
    argument: Vec<f64>,
    /// `W e^{iR arg W}`: times one another they are `W W W* e^{iRβ}`, up to whole turns of the biphase β.
    randomised: Vec<Complex64>,
}

impl Plane {
    fn new(pair: &SignalPair<'_>, parameters: &BicoherenceParameters) -> Result<Self> {
        check(parameters)?;
        let (count, step) = (pair.sample_count(), pair.time_step_s());
        // Also checks the parameters as given.
        let whole = Morlet::new(&parameters.wavelet, count, step)?;
        let half_hz = 0.5 * parameters.wavelet.frequency_max_hz;
        let low = |&level: &usize| whole.frequency_hz(level) <= half_hz;
        let level_count = (0..whole.level_count()).take_while(low).count();
        ensure(
            level_count != 0,
            "highest wavelet frequency, Hz",
            "at least twice the lowest",
            parameters.wavelet.frequency_max_hz,
        )?;
        let lowest = parameters.wavelet.frequency_min_hz;
        let grid = |level_count: usize, first_hz: f64| WaveletParameters {
            level_count,
            frequency_min_hz: first_hz,
            frequency_max_hz: first_hz + (level_count - 1) as f64 * whole.frequency_step_hz(),
            ..parameters.wavelet
        };
        let (randomised, _) = factors(parameters, 0, count);
        let turns = randomised.iter().map(|r| Complex64::cis(-TAU * r));
        let streams = 1..=parameters.surrogate_count as u64;
        let columns = streams.flat_map(|stream| surrogate(parameters, stream, count));
        Ok(Self {
            single: Morlet::new(&grid(level_count, lowest), count, step)?,
            sums: Morlet::new(&grid(2 * level_count - 1, 2.0 * lowest), count, step)?,
            time_step_s: step,
            turns: turns.collect(),
            surrogates: DMatrix::from_vec(count, 2 * parameters.surrogate_count, columns.collect()),
            factors: randomised,
        })
    }

    /// Levels of all pairs, the lower one first.
    fn cells(&self) -> impl Iterator<Item = (usize, usize)> + Clone {
        let count = self.single.level_count();
        (0..count).flat_map(move |i| (i..count).map(move |j| (i, j)))
    }

    /// `B` of all pairs, zero where it is not above the threshold, and the threshold.
    fn thresholded(&self, signal: &[f64], parameters: &BicoherenceParameters) -> (Vec<f64>, f64) {
        let [single, sums] = [&self.single, &self.sums].map(|plan| self.rows(plan, signal));
        let values = threads::numbered(single.len(), true, |i| {
            self.bispectra(i, &single[i..], &sums[2 * i..], parameters)
        });
        let values = values.concat();
        let threshold = values.iter().fold(0.0_f64, |m, v| m.max(v[1]));
        let kept = |v: &[f64; 2]| if v[0] > threshold { v[0] } else { 0.0 };
        (values.iter().map(kept).collect(), threshold)
    }

    /// All levels of a signal.
    fn rows(&self, plan: &Morlet, signal: &[f64]) -> Vec<LevelRow> {
        let randomised = |(w, r): (&Complex64, &f64)| w * Complex64::cis(r * w.arg());
        let groups = plan.by_groups(|group| {
            let (spectrum, mut buffer) = (group.spectrum(signal), RowBuffer::default());
            let mut row = |level| {
                let w = group.row(&group.kernel(level), &spectrum, &mut buffer);
                LevelRow {
                    modulus: w.iter().map(|w| w.norm()).collect(),
                    argument: w.iter().map(|w| w.arg()).collect(),
                    randomised: w.iter().zip(&self.factors).map(randomised).collect(),
                }
            };
            group.levels.clone().map(&mut row).collect::<Vec<_>>()
        });
        groups.into_iter().flatten().collect()
    }

    /// `B` of the pairs of level `i` with itself and those above, and the level their surrogates reach. `single` are the levels
    /// from `i` on, `sums` those of their sums with `i`.
    fn bispectra(
        &self,
        i: usize,
        single: &[LevelRow],
        sums: &[LevelRow],
        parameters: &BicoherenceParameters,
    ) -> Vec<[f64; 2]> {
        let inside = self.single.inside(i);
        let pairs = || single.iter().zip(sums);
        // a row for each pair: the moduli of its triple products
        let moduli = DMatrix::from_iterator(
            single.len(),
            inside.len(),
            inside.clone().flat_map(|t| {
                let modulus = move |(b, c): (&LevelRow, &LevelRow)| {
                    single[0].modulus[t] * b.modulus[t] * c.modulus[t]
                };
                pairs().map(modulus)
            }),
        );
        let sums = moduli * self.surrogates.rows_range(inside.clone());
        let levels = sums.row_iter().map(|row| {
            let parts: Vec<f64> = row.iter().copied().collect();
            let (pairs, _) = parts.as_chunks::<2>();
            let root = |[re, im]: &[f64; 2]| re.hypot(*im) * self.time_step_s;
            let (mean, deviation) = mean_and_deviation(pairs.iter().map(root));
            (mean + parameters.threshold_deviations * deviation).powi(2)
        });
        let own = pairs().map(|(b, c)| {
            let sum = self.randomised_sum(inside.clone(), [&single[0], b, c]);
            (sum.norm() * self.time_step_s).powi(2)
        });
        own.zip(levels).map(|(own, level)| [own, level]).collect()
    }

    /// `Σ_t W W W* e^{iRβ}` of two levels and that of their sum.
    fn randomised_sum(&self, inside: Range<usize>, [a, b, c]: [&LevelRow; 3]) -> Complex64 {
        let product = |t: usize| {
            let product = a.randomised[t] * b.randomised[t] * c.randomised[t].conj();
            let biphase = a.argument[t] + b.argument[t] - c.argument[t];
            // the biphase lies between −π and π
            if biphase > PI {
                product * self.turns[t]
            } else if biphase <= -PI {
                product * self.turns[t].conj()
            } else {
                product
            }
        };
        inside.map(product).sum()
    }
}

/// Random factors `R(t)` of a stream, and a constant biphase of random sign.
fn factors(parameters: &BicoherenceParameters, stream: u64, count: usize) -> (Vec<f64>, f64) {
    let mut random = random_stream(parameters.seed, stream);
    let modulus = random.random_range(parameters.smallest_biphase_rad..PI);
    let biphase = if random.random() { modulus } else { -modulus };
    let factor = |_| parameters.randomisation * random.random_range(-1.0..=1.0);
    ((0..count).map(factor).collect(), biphase)
}

/// `e^{iφ(1 + R(t))}`: all real parts, then all imaginary ones.
fn surrogate(parameters: &BicoherenceParameters, stream: u64, count: usize) -> Vec<f64> {
    let (factors, biphase) = factors(parameters, stream, count);
    let of = |part: fn(f64) -> f64| factors.iter().map(move |r| part(biphase * (1.0 + r)));
    of(f64::cos).chain(of(f64::sin)).collect()
}

#[cfg(test)]
mod tests;
