//! Harmonics in a stretch of a signal: least squares for constant, trend and amplitudes at a frequency and its multiples.

use crate::error::{Error, Result, ensure};
use nalgebra::{Complex, DMatrix, DVector, Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::ops::Range;

/// Whole periods of a harmonic at full amplitude.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plateau {
    /// First sample.
    pub first: usize,
    /// Number of samples.
    pub samples: usize,
    /// Number of periods they hold, to the nearest sample.
    pub periods: usize,
}

impl Plateau {
    /// Its samples.
    pub fn range(&self) -> Range<usize> {
        self.first..self.first + self.samples
    }
}

/// `x(t) ≈ a + b(t − t_c) + Σ_n Re(Z_n e^{inωt})`, `t` from the beginning of the signal, `t_c` the middle of the stretch.
#[derive(Debug, Clone, PartialEq)]
pub struct HarmonicFit {
    /// Frequency `ω/2π` of the first harmonic, Hz.
    pub frequency_hz: f64,
    /// `t_c`, s.
    pub centre_s: f64,
    /// `a`.
    pub offset: f64,
    /// `b`, 1/s.
    pub slope_per_s: f64,
    /// `Z_n`, from the first harmonic on.
    pub amplitudes: Vec<Complex<f64>>,
    /// RMS of what is left.
    pub residual_rms: f64,
}

impl HarmonicFit {
    /// Harmonics alone at `t_s`, and their rate of change, 1/s.
    pub fn oscillation(&self, t_s: f64) -> (f64, f64) {
        let omega = TAU * self.frequency_hz;
        let turn = Complex::from_polar(1.0, omega * t_s);
        let mut power = Complex::new(1.0, 0.0);
        let (mut value, mut rate) = (0.0, 0.0);
        for (n, z) in self.amplitudes.iter().enumerate() {
            power *= turn;
            value += (z * power).re;
            rate -= (n + 1) as f64 * omega * (z * power).im;
        }
        (value, rate)
    }

    /// Complex amplitude of the first harmonic.
    pub fn fundamental(&self) -> Complex<f64> {
        self.amplitudes.first().copied().unwrap_or_default()
    }
}

/// Fits `harmonics` multiples of `frequency_hz` with constant and trend to the samples in `range`; those for which `used`
/// is false are left out.
///
/// # Errors
/// [`Error::Input`] for a range outside the signal; [`Error::Numerical`] for fewer samples than unknowns or a stretch too short
/// to tell the harmonics from the trend.
pub fn fit_harmonics(
    signal: &[f64],
    range: Range<usize>,
    sampling_hz: f64,
    frequency_hz: f64,
    harmonics: usize,
    used: &dyn Fn(usize) -> bool,
) -> Result<HarmonicFit> {
    let inside = range.end <= signal.len() && !range.is_empty();
    let expected = format_args!("samples within 0 to {}", signal.len());
    let found = format_args!("{} to {}", range.start, range.end);
    ensure(inside, "stretch of a signal", expected, found)?;
    let angle = TAU * frequency_hz / sampling_hz;
    let mut regressors = HarmonicRegressors::new(&range, angle, harmonics);
    let unknowns = regressors.unknowns();
    let mut gram = DMatrix::zeros(unknowns, unknowns);
    let mut moments = DVector::zeros(unknowns);
    let mut row = vec![0.0; unknowns];
    let mut count = 0_usize;
    for k in range.clone().filter(|k| used(*k)) {
        regressors.at(k, &mut row);
        for i in 0..unknowns {
            for j in 0..=i {
                gram[(i, j)] += row[i] * row[j];
            }
            moments[i] += row[i] * signal[k];
        }
        count += 1;
    }
    let solution: DVector<f64> = (count > unknowns)
        .then(|| gram.cholesky())
        .flatten()
        .map(|c| c.solve(&moments))
        .ok_or_else(|| {
            Error::Numerical(format!(
                "harmonics of {frequency_hz} Hz: {count} samples do not determine {unknowns} unknowns"
            ))
        })?;
    let mut squares = 0.0;
    for k in range.filter(|k| used(*k)) {
        regressors.at(k, &mut row);
        let fitted: f64 = row.iter().zip(solution.iter()).map(|(r, c)| r * c).sum();
        squares += (signal[k] - fitted).powi(2);
    }
    Ok(HarmonicFit {
        frequency_hz,
        centre_s: regressors.centre / sampling_hz,
        offset: solution[0],
        slope_per_s: solution[1] * sampling_hz / regressors.half,
        amplitudes: (0..harmonics)
            .map(|n| Complex::new(solution[2 + 2 * n], solution[3 + 2 * n]))
            .collect(),
        residual_rms: (squares / count as f64).sqrt(),
    })
}

/// Samples of a block.
const BLOCK: usize = 64;

/// Constant, trend, then cosine and sine of each harmonic.
struct HarmonicRegressors {
    /// Middle of the stretch, and half of its length, samples.
    centre: f64,
    half: f64,
    harmonics: usize,
    /// Angle `θ` of the first harmonic from sample to sample.
    angle: f64,
    /// `e^{iθk}` of the samples of the first block.
    turns: [Complex<f64>; BLOCK],
    /// Number of the block that was asked for last, and the turn of its first sample.
    block: (usize, Complex<f64>),
}

impl HarmonicRegressors {
    fn new(range: &Range<usize>, angle: f64, harmonics: usize) -> Self {
        Self {
            centre: 0.5 * (range.start + range.end - 1) as f64,
            half: (0.5 * range.len() as f64).max(1.0),
            harmonics,
            angle,
            turns: std::array::from_fn(|k| Complex::cis(angle * k as f64)),
            block: (0, Complex::new(1.0, 0.0)),
        }
    }

    fn unknowns(&self) -> usize {
        2 + 2 * self.harmonics
    }

    /// Those of sample `k`.
    fn at(&mut self, k: usize, row: &mut [f64]) {
        row[0] = 1.0;
        row[1] = (k as f64 - self.centre) / self.half;
        let turn = self.turn(k);
        let mut power = Complex::new(1.0, 0.0);
        for n in 0..self.harmonics {
            power *= turn;
            row[2 + 2 * n] = power.re;
            row[3 + 2 * n] = -power.im;
        }
    }

    /// `e^{iθk}`: that of the first sample of a block times that of the place in the block.
    fn turn(&mut self, k: usize) -> Complex<f64> {
        let block = k / BLOCK;
        if self.block.0 != block {
            let first = (block * BLOCK) as f64;
            self.block = (block, Complex::cis(self.angle * first));
        }
        self.block.1 * self.turns[k % BLOCK]
    }
}

/// One harmonic, all samples used.
pub fn fit_sine(
    signal: &[f64],
    range: Range<usize>,
    sampling_hz: f64,
    frequency_hz: f64,
) -> Result<HarmonicFit> {
    fit_harmonics(signal, range, sampling_hz, frequency_hz, 1, &|_| true)
}

/// The frequency of the harmonic near `frequency_hz` in `range`, from the phases of its two halves.
pub fn refine_frequency(
    signal: &[f64],
    range: Range<usize>,
    sampling_hz: f64,
    frequency_hz: f64,
) -> Result<f64> {
    let middle = range.start + range.len() / 2;
    let distance_s = (range.len() / 2) as f64 / sampling_hz;
    let mut frequency = frequency_hz;
    for _ in 0..4 {
        let half = |r| fit_sine(signal, r, sampling_hz, frequency).map(|fit| fit.fundamental());
        let advance = half(middle..range.end)? * half(range.start..middle)?.conj();
        frequency += advance.arg() / (TAU * distance_s);
    }
    Ok(frequency)
}

/// The longest stretch within `range` in which the amplitude at `frequency_hz`, taken over one period at a time, is at least
/// `share` of its typical value, cut to whole periods; `None` when there is not one period.
pub fn plateau(
    signal: &[f64],
    range: Range<usize>,
    sampling_hz: f64,
    frequency_hz: f64,
    share: f64,
) -> Option<Plateau> {
    let range = range.start..range.end.min(signal.len());
    let period = sampling_hz / frequency_hz;
    let window = period.round() as usize;
    let hop = (window / 8).max(1);
    if window < 4 || range.len() < window {
        return None;
    }
    let starts: Vec<usize> = (range.start..=range.end - window).step_by(hop).collect();
    let weights = amplitude_weights(window, TAU * frequency_hz / sampling_hz)?;
    let amplitude = |start: &usize| {
        let samples = &signal[*start..start + window];
        let weighted = weights.iter().zip(samples).map(|(w, x)| w * x);
        weighted.sum::<Complex<f64>>().norm()
    };
    let amplitudes: Vec<f64> = starts.iter().map(amplitude).collect();
    let largest = amplitudes.iter().copied().fold(0.0, f64::max);
    // the median of what is near full amplitude: one wild period does not raise the bar
    let near = amplitudes.iter().copied().filter(|a| *a > 0.5 * largest);
    let near: Vec<f64> = near.collect();
    let full = share * super::median(&near);
    let mut best: Option<(usize, usize)> = None;
    let mut at = 0;
    while at < starts.len() {
        if amplitudes[at] < full {
            at += 1;
            continue;
        }
        let from = at;
        while at < starts.len() && amplitudes[at] >= full {
            at += 1;
        }
        if best.is_none_or(|(a, b)| at - from > b - a) {
            best = Some((from, at));
        }
    }
    let (from, to) = best?;
    let (first, end) = (starts[from], starts[to - 1] + window);
    let periods = ((end - first) as f64 / period + 1e-6) as usize;
    (largest > 0.0 && periods > 0).then(|| Plateau {
        first,
        samples: ((periods as f64 * period).round() as usize).min(end - first),
        periods,
    })
}

/// Windows of so many samples are a whole number of periods nearly enough for the transform of one frequency.
const MANY_SAMPLES: usize = 20;

/// What each of `window` samples counts in the amplitude of a harmonic; of few samples, which may be half a sample off a whole number of
/// periods, in the one that least squares finds beside a constant. `angle` is that of the harmonic from sample to sample.
fn amplitude_weights(window: usize, angle: f64) -> Option<Vec<Complex<f64>>> {
    let row = |k: usize| {
        let (sin, cos) = (angle * k as f64).sin_cos();
        Vector3::new(1.0, cos, sin)
    };
    if window >= MANY_SAMPLES {
        let turn = |k: usize| Complex::cis(-angle * k as f64);
        let mean = (0..window).map(turn).sum::<Complex<f64>>() / window as f64;
        let weights = (0..window).map(|k| (turn(k) - mean) * (2.0 / window as f64));
        return Some(weights.collect());
    }
    let gram: Matrix3<f64> = (0..window).map(|k| row(k) * row(k).transpose()).sum();
    let inverse = gram.try_inverse()?;
    let weights = (0..window).map(|k| inverse * row(k));
    Some(weights.map(|w| Complex::new(w[1], -w[2])).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramped(t: f64) -> f64 {
        let w = (t / 4.0).min((26.0 - t) / 4.0).clamp(0.0, 1.0);
        w * (TAU * 1.1 * t + 0.4).sin()
    }

    #[test]
    fn amplitudes_and_rates_come_back() {
        let omega = TAU * 0.8;
        let x =
            |t: f64| 3.0 - 0.2 * t + 2.0 * (omega * t + 0.3).cos() + 0.1 * (2.0 * omega * t).sin();
        let signal: Vec<f64> = (0..3000).map(|k| x(f64::from(k) / 200.0)).collect();
        let fit = fit_harmonics(&signal, 500..2750, 200.0, 0.8, 2, &|k| k != 700).unwrap();
        assert!((fit.fundamental() - Complex::from_polar(2.0, 0.3)).norm() < 1e-11);
        assert!((fit.amplitudes[1] - Complex::new(0.0, -0.1)).norm() < 1e-11);
        assert!((fit.slope_per_s + 0.2).abs() < 1e-11 && fit.residual_rms < 1e-6);
        let (t, h) = (7.123, 1e-5);
        let line = |t: f64| fit.offset + fit.slope_per_s * (t - fit.centre_s);
        let whole = |t: f64| fit.oscillation(t).0 + line(t);
        assert!((whole(t) - x(t)).abs() < 1e-11);
        let difference = (fit.oscillation(t + h).0 - fit.oscillation(t - h).0) / (2.0 * h);
        // ω³h²/6
        assert!((fit.oscillation(t).1 - difference).abs() < 1e-7);
    }

    #[test]
    fn full_amplitude_is_found_between_the_ramps() {
        let signal: Vec<f64> = (0..5201).map(|k| ramped(f64::from(k) / 200.0)).collect();
        let found = plateau(&signal, 0..5200, 200.0, 1.1, 0.99).unwrap();
        // 18 s hold 19.8 periods; the mean over a period falls to 0.99 when it reaches 0.27 s into a ramp
        assert_eq!(found.periods, 20);
        assert!(found.first >= 740 && found.range().end <= 4460, "{found:?}");
        let f = refine_frequency(&signal, found.range(), 200.0, 1.08).unwrap();
        assert!((f - 1.1).abs() < 1e-4, "{f}");
        assert!(plateau(&signal, 0..100, 200.0, 1.1, 0.99).is_none());
    }

    /// The samples of a window are no whole period: all of a clean sine is at full amplitude all the same.
    #[test]
    fn few_samples_in_a_period_are_no_change_of_amplitude() {
        for per_period in [3.7, 4.3, 5.0, 5.3, 7.7, 9.4, 11.3, 13.3] {
            let sine = |k: u32| 2.0 + (TAU * f64::from(k) / per_period + 0.3).sin();
            let signal: Vec<f64> = (0..200).map(sine).collect();
            let found = plateau(&signal, 0..200, per_period, 1.0, 0.99).unwrap();
            let all = (200.0 / per_period) as usize;
            assert_eq!((found.first, found.periods), (0, all), "{per_period}");
        }
    }
}
