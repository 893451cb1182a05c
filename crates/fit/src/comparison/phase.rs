//! Phase metric: the mean delay between two signals.

use super::{Metric, SignalPair, zero_signal};
use crate::error::{Result, ensure, positive};
use crate::signal::CrossCorrelation;
use crate::state_space::golden_section;
use serde::Serialize;
use std::convert::Infallible;
use std::f64::consts::PI;

/// Parameters of [`phase`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PhaseParameters {
    /// Delay `T_c` that brings the metric to 1/e, s; default 1 s. A phase of 5° at `f` is `5/(360 f)`.
    pub significant_delay_s: f64,
    /// Lag in whole samples, as in the published toolbox: at 200 Hz one sample is 3.6° of 2 Hz. Else, by default, the maximum of the
    /// band-limited (sinc) interpolation of the correlation, which is exact for band-limited signals.
    pub whole_samples: bool,
    /// Refine the lag on the correlation divided by `√(Σ X₁² Σ X₂²)` of the overlapping samples; default `true`.
    ///
    /// The published correlation is not divided. Then fewer samples overlap at larger lags, which draws the lag of
    /// a harmonic of circular frequency ω and phase φ in a record of whole periods and duration T towards zero by
    /// `(1 + cos²φ)/(ω²T)`: 0.9° at 2 Hz and 10 s. Divided, it is largest, 1, at the delay of any delayed signal.
    /// No effect on whole samples.
    pub overlap_normalised: bool,
}

impl PhaseParameters {
    /// The form of the published toolbox: lag in whole samples of the undivided correlation.
    pub const fn published(significant_delay_s: f64) -> Self {
        Self {
            significant_delay_s,
            whole_samples: true,
            overlap_normalised: false,
        }
    }
}

impl Default for PhaseParameters {
    fn default() -> Self {
        Self {
            significant_delay_s: 1.0,
            whole_samples: false,
            overlap_normalised: true,
        }
    }
}

/// What [`phase`] found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PhaseDetails {
    /// Lag of the largest absolute correlation in whole samples; positive if the compared signal is late.
    pub whole_lag_samples: isize,
    /// Lag the metric is made of, s; positive if the compared signal is late.
    pub lag_s: f64,
    /// `c(n)/√(Σ X₁² Σ X₂²)` at the whole lag; negative if the signals were matched in antiphase.
    pub correlation: f64,
}

/// Phase metric `M_φ = exp(−|τ|/T_c)`, τ the lag at which the **absolute** full cross-correlation is largest.
///
/// Because of the absolute value, signals in antiphase are locked to the nearest multiple of π:
/// for `X₂ = a cos(ωt − φ)` the metric is `exp(−φ/(ωT_c))` only up to `φ = π/2`.
/// The whole lag is refined as [`PhaseParameters`] says.
///
/// # Errors
/// [`crate::Error::Input`] if a signal is zero throughout, `T_c` is not positive, or the correlation still grows at the end of the search,
/// a sixteenth of the record from the whole lag: then there is no lag.
pub fn phase(pair: &SignalPair<'_>, parameters: &PhaseParameters) -> Result<Metric<PhaseDetails>> {
    let delay = positive("significant delay T_c, s", parameters.significant_delay_s)?;
    let energy = |x: &[f64]| x.iter().map(|v| v * v).sum::<f64>().sqrt();
    let (first, second) = (energy(pair.reference), energy(pair.compared));
    for (place, norm) in [("reference signal", first), ("compared signal", second)] {
        if norm == 0.0 {
            return Err(zero_signal(place));
        }
    }
    let correlation = CrossCorrelation::new(pair.reference, pair.compared);
    let whole = correlation.largest_magnitude();
    // the correlation over what it is divided by
    let divided = |lag: isize| {
        let divisor = match parameters.overlap_normalised {
            true => correlation.overlap_energy(lag),
            false => 1.0,
        };
        let value = correlation.at(lag);
        if divisor > 0.0 { value / divisor } else { 0.0 }
    };
    let lag = match parameters.whole_samples {
        true => whole as f64,
        false => {
            let reach = (correlation.sample_count() / 16) as isize;
            band_limited(&divided, climb(&divided, whole, reach)?)
        }
    };
    let lag_s = lag * pair.time_step_s();
    Ok(Metric {
        value: (-lag_s.abs() / delay).exp(),
        details: PhaseDetails {
            whole_lag_samples: whole,
            lag_s,
            correlation: correlation.at(whole) / first / second,
        },
    })
}

/// Whole lag at the local maximum of a correlation next to `start`, at most a sixteenth of the record (`reach`) away: the division favours
/// lags at which hardly anything overlaps. Refused where it would be farther away.
fn climb(correlation: &dyn Fn(isize) -> f64, start: isize, reach: isize) -> Result<isize> {
    let magnitude = |lag: isize| correlation(lag).abs();
    let mut lag = start;
    loop {
        let next = match magnitude(lag + 1) > magnitude(lag - 1) {
            true => lag + 1,
            false => lag - 1,
        };
        if magnitude(next) <= magnitude(lag) {
            return Ok(lag);
        }
        ensure(
            (next - start).abs() <= reach,
            "record",
            "a correlation that is largest at some lag (more than a period)",
            "one that still grows a sixteenth of the record away",
        )?;
        lag = next;
    }
}

/// Maximum of the band-limited function through the values around `top`, within one sample of it: the sum of
/// sinc functions under a Gaussian window, good to about 1e-7 for content up to 0.7 of the Nyquist frequency.
///
/// The correlation is interpolated, not the signals: these end abruptly and would ring there.
fn band_limited(correlation: &dyn Fn(isize) -> f64, top: isize) -> f64 {
    const HALF_WIDTH: isize = 32;
    const WINDOW_SIGMA: f64 = HALF_WIDTH as f64 / 6.0;
    let sign = correlation(top).signum();
    let value = |k| (k as f64, sign * correlation(top + k));
    let values: Vec<(f64, f64)> = (-HALF_WIDTH..=HALF_WIDTH).map(value).collect();
    let interpolated = |offset: f64| -> f64 {
        let part = |(k, value): &(f64, f64)| {
            let x = offset - k;
            let window = (-0.5 * (x / WINDOW_SIGMA).powi(2)).exp();
            // sin(πx)/(πx)
            let sinc = if x == 0.0 {
                1.0
            } else {
                (PI * x).sin() / (PI * x)
            };
            value * window * sinc
        };
        values.iter().map(part).sum()
    };
    top as f64 + place_of_maximum(interpolated, -1.0, 1.0)
}

/// Place of the maximum of a function with one maximum between `low` and `high`.
fn place_of_maximum(function: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    // (√5 − 1)/2 to the 45th is 4e-10; the flatness of a maximum allows no more than about 1e-7.
    const ITERATIONS: usize = 45;
    let mut steps = 0;
    let done = |_, _: &f64, _: &f64| {
        steps += 1;
        steps > ITERATIONS
    };
    let at = |x| Ok::<_, Infallible>(function(x));
    let Ok(((low, high), _)) = golden_section(low..high, at, f64::gt, done);
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;
    use std::f64::consts::{FRAC_PI_2, TAU};

    const STEP_S: f64 = 0.005;

    /// 2 Hz for 100 s, the compared one late by `phase_rad` and `a` times as large.
    fn harmonics(a: f64, phase_rad: f64) -> (Vec<f64>, Vec<f64>) {
        let time = |k: usize| TAU * 2.0 * STEP_S * k as f64;
        let reference = (0..20_000).map(|k| time(k).cos()).collect();
        let compared = (0..20_000)
            .map(|k| a * (time(k) - phase_rad).cos())
            .collect();
        (reference, compared)
    }

    fn lag_of(
        phase_rad: f64,
        whole_samples: bool,
        overlap_normalised: bool,
    ) -> Metric<PhaseDetails> {
        let (x1, x2) = harmonics(0.7, phase_rad);
        let pair = SignalPair::new(&x1, &x2, STEP_S).unwrap();
        let parameters = PhaseParameters {
            significant_delay_s: 5.0 / 360.0 / 2.0,
            whole_samples,
            overlap_normalised,
        };
        phase(&pair, &parameters).unwrap()
    }

    #[test]
    fn lag_follows_the_closed_form() {
        // Lags of 0.4, 1.7 and 3 samples: sub-sample resolution, and 0.015 s = 10.8° → exp(−10.8/5).
        for samples in [0.4, 1.7, 3.0] {
            let phi = TAU * 2.0 * STEP_S * samples;
            let metric = lag_of(phi, false, true);
            // The ends of the record are not band-limited: ringing of one sample's size in 20 000.
            assert_abs_diff_eq!(
                metric.details.lag_s,
                samples * STEP_S,
                epsilon = 1e-4 * STEP_S
            );
            let expected = (-samples * STEP_S / (5.0 / 720.0)).exp();
            assert_abs_diff_eq!(metric.value, expected, epsilon = 2e-5);
        }
    }

    #[test]
    fn undivided_correlation_is_drawn_towards_zero_as_documented() {
        let omega = TAU * 2.0;
        // Far from zero lag, where the undivided correlation has a kink.
        let phi = omega * STEP_S * 12.3;
        let lag_s = lag_of(phi, false, false).details.lag_s;
        let expected = phi / omega - (1.0 + phi.cos().powi(2)) / (omega * omega * 100.0);
        // Sums instead of integrals: the ends lie half a sample off, ωΔt/2 = 0.03 rad.
        assert_abs_diff_eq!(lag_s, expected, epsilon = 0.05 * (phi / omega - expected));
    }

    #[test]
    fn whole_samples_are_quantised() {
        let metric = lag_of(TAU * 2.0 * STEP_S * 2.9, true, false);
        assert_eq!(metric.details.whole_lag_samples, 3);
        assert_eq!(metric.details.lag_s, 3.0 * STEP_S);
        // 0.015 s at 2 Hz is 10.8°: exp(−10.8/5) = 0.115.
        assert_abs_diff_eq!(metric.value, 0.1153, epsilon = 1e-4);
    }

    #[test]
    fn antiphase_locks_to_the_nearest_multiple_of_pi() {
        let metric = lag_of(2.0 * FRAC_PI_2, true, false);
        assert_eq!(metric.details.whole_lag_samples, 0);
        assert_abs_diff_eq!(metric.details.correlation, -1.0, epsilon = 1e-12);
        assert_eq!(metric.value, 1.0);
    }

    #[test]
    fn a_part_of_a_period_has_no_lag() {
        let of = |shift: f64| -> Vec<f64> {
            let x = |k: i32| (0.5 + 0.004 * (f64::from(k) - shift)).sin();
            (0..200).map(x).collect()
        };
        let (x1, x2) = (of(0.0), of(40.0));
        let pair = SignalPair::new(&x1, &x2, STEP_S).unwrap();
        let refused = phase(&pair, &PhaseParameters::default()).unwrap_err();
        assert!(refused.to_string().contains("still grows"), "{refused}");
    }

    #[test]
    fn zero_signals_are_refused() {
        let pair = SignalPair::new(&[1.0, 0.0], &[0.0, 0.0], 1.0).unwrap();
        assert!(phase(&pair, &PhaseParameters::default()).is_err());
    }
}
