//! Continuous Morlet transform on chosen frequencies.

use crate::error::{Result, ensure, non_negative, positive};
use crate::signal::{Complex64, Fourier};
use aerodeck_core::{threads, vectorised};
use serde::Serialize;
use std::f64::consts::{PI, SQRT_2, TAU};
use std::ops::Range;
use std::sync::Arc;

/// Parameters of the wavelet transform.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WaveletParameters {
    /// Number of frequencies, equally spaced from lowest to highest; default 1200.
    pub level_count: usize,
    /// Lowest frequency, Hz; default 0.2.
    pub frequency_min_hz: f64,
    /// Highest frequency, Hz; default 12.
    pub frequency_max_hz: f64,
    /// Central frequency `f₀` of the mother wavelet, cycles per unit of its time; default 6.
    pub central_frequency: f64,
    /// Half width `β` of the wavelet in units of `a/√2`; default 3.
    pub truncation: f64,
    /// Width of the cone of influence in units of `a/√2`; default 1.
    pub cone: f64,
}

impl Default for WaveletParameters {
    fn default() -> Self {
        Self {
            level_count: 1200,
            frequency_min_hz: 0.2,
            frequency_max_hz: 12.0,
            central_frequency: 6.0,
            truncation: 3.0,
            cone: 1.0,
        }
    }
}

/// Transform of signals of one length and time step.
///
/// At frequency `f` the scale is `a = f₀/f` (s) and
/// `W(f, t) = Δt/√a Σ_s x(t − s) ψ(s)`, `ψ(s) = π^(−1/4) exp(2πi f₀ s/a) exp(−(s/a)²/2)`, `|s| ≤ β a/√2`,
/// zeros beyond the ends of the record. Coefficients within `cone · a/√2` of an end are left out
/// (time counted from the first sample).
pub(super) struct Morlet {
    parameters: WaveletParameters,
    sample_count: usize,
    time_step_s: f64,
    /// Transforms of the groups of levels, each long enough for the longest wavelet of its own.
    fourier: Vec<Arc<Fourier>>,
}

/// Levels that are computed together.
pub(super) struct LevelGroup<'a> {
    plan: &'a Morlet,
    fourier: &'a Fourier,
    /// Consecutive levels.
    pub levels: Range<usize>,
}

/// Memory of [`LevelGroup::row`], kept from one level and signal to the next.
pub(super) type RowBuffer = [Vec<Complex64>; 2];

/// Levels in a group.
const GROUP: usize = 16;

impl Morlet {
    /// For signals of `sample_count` samples.
    ///
    /// # Errors
    /// [`Error::Input`](crate::error::Error::Input) for parameters that are not positive, a highest frequency beyond Nyquist, or a record too
    /// short to hold any coefficient outside the cone.
    pub(super) fn new(
        parameters: &WaveletParameters,
        sample_count: usize,
        time_step_s: f64,
    ) -> Result<Self> {
        check(parameters, time_step_s)?;
        let mut plan = Self {
            parameters: *parameters,
            sample_count,
            time_step_s,
            fourier: Vec::new(),
        };
        for first in (0..plan.level_count()).step_by(GROUP) {
            // with this length the ends do not wrap into the record
            let length = quick_length(sample_count + plan.half_width(first));
            let same = plan.fourier.last().filter(|f| f.length() == length);
            let transform = same.cloned();
            let transform = transform.unwrap_or_else(|| Arc::new(Fourier::new(length)));
            plan.fourier.push(transform);
        }
        let highest_hz = parameters.frequency_max_hz;
        ensure(
            !plan.inside(plan.level_count() - 1).is_empty(),
            "signals for the wavelet transform",
            format_args!("a record longer than twice the cone at {highest_hz} Hz"),
            format_args!("{} s", sample_count as f64 * time_step_s),
        )?;
        Ok(plan)
    }

    /// Number of frequencies.
    pub(super) fn level_count(&self) -> usize {
        self.parameters.level_count
    }

    /// Number of samples of a signal.
    pub(super) fn sample_count(&self) -> usize {
        self.sample_count
    }

    /// Frequency of a level, Hz.
    pub(super) fn frequency_hz(&self, level: usize) -> f64 {
        self.parameters.frequency_min_hz + level as f64 * self.frequency_step_hz()
    }

    /// Distance of the frequencies, Hz.
    pub(super) fn frequency_step_hz(&self) -> f64 {
        let p = &self.parameters;
        (p.frequency_max_hz - p.frequency_min_hz) / (p.level_count.max(2) - 1) as f64
    }

    /// Samples outside the cone of influence at a level, possibly none.
    pub(super) fn inside(&self, level: usize) -> Range<usize> {
        let scale = self.parameters.central_frequency / self.frequency_hz(level);
        let edge = scale / SQRT_2 * self.parameters.cone;
        let last = (self.sample_count - 1) as f64 * self.time_step_s;
        let time = |k: usize| self.time_step_s * k as f64;
        // First candidates by division, then the condition itself, so that rounding cannot shift the edge.
        let mut start = (edge / self.time_step_s) as usize;
        while start < self.sample_count && time(start) <= edge {
            start += 1;
        }
        let mut end = self.sample_count;
        while end > start && time(end - 1) >= last - edge {
            end -= 1;
        }
        start.min(end)..end
    }

    /// Samples of the wavelet of a level on each side of its centre; those beyond the record multiply nothing.
    fn half_width(&self, level: usize) -> usize {
        let p = &self.parameters;
        let scale = p.central_frequency / self.frequency_hz(level);
        ((p.truncation * scale / SQRT_2 / self.time_step_s) as usize).min(self.sample_count - 1)
    }

    /// The groups of levels, in their order.
    pub(super) fn groups(&self) -> impl ExactSizeIterator<Item = LevelGroup<'_>> {
        (0..self.fourier.len()).map(|g| self.group(g))
    }

    fn group(&self, g: usize) -> LevelGroup<'_> {
        LevelGroup {
            plan: self,
            fourier: &self.fourier[g],
            levels: g * GROUP..((g + 1) * GROUP).min(self.level_count()),
        }
    }

    /// `work` on groups of levels, in parallel; results in the order of the levels, so that sums over them do
    /// not depend on the number of threads.
    pub(super) fn by_groups<T: Send>(&self, work: impl Fn(LevelGroup<'_>) -> T + Sync) -> Vec<T> {
        threads::numbered(self.fourier.len(), true, |g| work(self.group(g)))
    }
}

impl LevelGroup<'_> {
    /// Spectrum of a signal, as [`Self::row`] wants it.
    pub(super) fn spectrum(&self, signal: &[f64]) -> Vec<Complex64> {
        self.fourier.spectrum(signal.iter().copied())
    }

    /// Coefficients of a signal at the level of a kernel.
    pub(super) fn row<'b>(
        &self,
        kernel: &[f64],
        spectrum: &[Complex64],
        buffer: &'b mut RowBuffer,
    ) -> &'b [Complex64] {
        let [values, scratch] = buffer;
        values.resize(kernel.len(), Complex64::default());
        at_level(values, kernel, spectrum);
        self.fourier.inverse_in(values, scratch);
        &values[..self.plan.sample_count]
    }

    /// Spectrum of the wavelet of a level, scaled by `Δt/(√a M)` (M for the transform back). It is real: at negative times,
    /// which stand at the end, the wavelet is the conjugate of itself.
    pub(super) fn kernel(&self, level: usize) -> Vec<f64> {
        let (plan, length) = (self.plan, self.fourier.length());
        let f = plan.frequency_hz(level);
        let scale = plan.parameters.central_frequency / f;
        let factor = PI.powf(-0.25) * plan.time_step_s / scale.sqrt() / length as f64;
        let mut kernel = vec![Complex64::default(); length];
        for k in 0..=plan.half_width(level) {
            let time = k as f64 * plan.time_step_s;
            let envelope = factor * (-0.5 * (time / scale).powi(2)).exp();
            let value = Complex64::from_polar(envelope, TAU * f * time);
            kernel[k] = value;
            if k > 0 {
                kernel[length - k] = value.conj();
            }
        }
        self.fourier.forward(&mut kernel);
        kernel.iter().map(|z| z.re).collect()
    }
}

vectorised! {
    /// A spectrum by the kernel of a level.
    fn at_level<'a>(values: &'a mut [Complex64], kernel: &'a [f64], spectrum: &'a [Complex64]) -> () {
        for (value, (k, x)) in values.iter_mut().zip(kernel.iter().zip(spectrum)) {
            *value = Complex64::new(x.re * k, x.im * k);
        }
    }
}

/// The least length from `least` on that is 8, 9, 10, 12 or 14 times a power of two: quick to transform.
fn quick_length(least: usize) -> usize {
    let unit = (least.next_power_of_two() / 16).max(1);
    let lengths = [8, 9, 10, 12, 14].map(|times| times * unit);
    let long_enough = lengths.into_iter().find(|length| *length >= least);
    long_enough.unwrap_or(16 * unit)
}

/// Finer levels than this tell nothing more, and memory and time grow with them.
const MOST_LEVELS: usize = 100_000;

fn check(parameters: &WaveletParameters, time_step_s: f64) -> Result<()> {
    let p = parameters;
    let (levels, most) = (1..=MOST_LEVELS, format_args!("1 to {MOST_LEVELS}"));
    let usual = levels.contains(&p.level_count);
    ensure(usual, "number of wavelet levels", most, p.level_count)?;
    positive("lowest wavelet frequency, Hz", p.frequency_min_hz)?;
    positive("central frequency of the wavelet", p.central_frequency)?;
    positive("truncation of the wavelet", p.truncation)?;
    non_negative("cone of influence of the wavelet", p.cone)?;
    let nyquist = 0.5 / time_step_s;
    ensure(
        p.frequency_max_hz >= p.frequency_min_hz && p.frequency_max_hz <= nyquist,
        "highest wavelet frequency, Hz",
        format_args!(
            "a number from {} Hz to the Nyquist frequency {nyquist} Hz",
            p.frequency_min_hz
        ),
        p.frequency_max_hz,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    fn parameters(level_count: usize) -> WaveletParameters {
        WaveletParameters {
            level_count,
            frequency_min_hz: 0.5,
            frequency_max_hz: 5.0,
            ..WaveletParameters::default()
        }
    }

    fn row(plan: &Morlet, signal: &[f64], level: usize) -> Vec<Complex64> {
        let rows = plan.by_groups(|group| {
            let (spectrum, mut buffer) = (group.spectrum(signal), RowBuffer::default());
            let mut row = |level| {
                group
                    .row(&group.kernel(level), &spectrum, &mut buffer)
                    .to_vec()
            };
            group.levels.clone().map(&mut row).collect::<Vec<_>>()
        });
        rows.concat().swap_remove(level)
    }

    #[test]
    fn rows_are_the_sums_of_the_definition() {
        let dt = 0.05;
        let x: Vec<f64> = (0..150)
            .map(|k| (0.3 * k as f64).sin() + 0.01 * k as f64)
            .collect();
        let plan = Morlet::new(&parameters(4), x.len(), dt).unwrap();
        // Level 0 has a wavelet longer than the record, level 3 a short one.
        for level in [0, 3] {
            let a = 6.0 / plan.frequency_hz(level);
            let row = row(&plan, &x, level);
            for t in [0_usize, 1, 70, 149] {
                let mut sum = Complex64::default();
                for (k, value) in x.iter().enumerate() {
                    let s = (t as f64 - k as f64) * dt;
                    if s.abs() <= 3.0 * a / SQRT_2 {
                        let envelope = PI.powf(-0.25) * (-0.5 * (s / a).powi(2)).exp();
                        sum += Complex64::from_polar(envelope * value, TAU * 6.0 * s / a);
                    }
                }
                let expected = sum * dt / a.sqrt();
                assert_abs_diff_eq!(row[t].re, expected.re, epsilon = 1e-13);
                assert_abs_diff_eq!(row[t].im, expected.im, epsilon = 1e-13);
            }
        }
    }

    #[test]
    fn amplitude_of_a_harmonic_is_the_closed_form() {
        // |W| = A/2 · √(2π) π^(−1/4) √a at the frequency itself, for an untruncated wavelet.
        let dt = 0.01;
        let x: Vec<f64> = (0..6000)
            .map(|k| 0.8 * (TAU * 2.0 * dt * k as f64).cos())
            .collect();
        let p = WaveletParameters {
            level_count: 1,
            frequency_min_hz: 2.0,
            frequency_max_hz: 2.0,
            truncation: 9.0,
            ..WaveletParameters::default()
        };
        let plan = Morlet::new(&p, x.len(), dt).unwrap();
        let row = row(&plan, &x, 0);
        let expected = 0.4 * TAU.sqrt() * PI.powf(-0.25) * 3.0_f64.sqrt();
        // The tail left out beyond 9/√2 standard widths is erfc(4.5) = 2e-10 of the whole.
        assert_abs_diff_eq!(row[3000].norm(), expected, epsilon = 1e-8);
    }

    #[test]
    fn cone_and_limits() {
        let plan = Morlet::new(&parameters(10), 1000, 0.01).unwrap();
        // a/√2 = 12/√2 = 8.49 s at 0.5 Hz: nothing is left of 10 s; 1.2/√2 = 0.8485 s at 5 Hz.
        assert!(plan.inside(0).is_empty());
        assert_eq!(plan.inside(9), 85..915);
        assert!(Morlet::new(&parameters(10), 100, 0.01).is_err());
        assert!(Morlet::new(&parameters(10), 1000, 0.2).is_err());
        assert!(Morlet::new(&parameters(0), 1000, 0.01).is_err());
    }
}
