//! Plain statistics and rates of samples: median and robust scatter, clipping, central differences; streams of random numbers.

use crate::error::{Result, ensure, finite};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// A normal variable has its quartiles at this part of its standard deviation, inverted.
const NORMAL_MAD: f64 = 1.482_602_218_505_602;

/// Random numbers of one purpose: the same for the same seed and stream, whatever else is drawn and on however many threads.
pub fn random_stream(seed: u64, stream: u64) -> ChaCha8Rng {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(stream);
    random
}

/// Mean; zero for none.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Mean and standard deviation with n − 1; no numbers where there are too few.
pub fn mean_and_deviation(values: impl ExactSizeIterator<Item = f64> + Clone) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.clone().sum::<f64>() / count;
    let squares: f64 = values.map(|v| (v - mean).powi(2)).sum();
    (mean, (squares / (count - 1.0)).sqrt())
}

/// Largest magnitude of a value; zero for none.
pub fn largest_magnitude(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

/// Root mean square; zero for none.
pub fn root_mean_square(values: &[f64]) -> f64 {
    let squares: f64 = values.iter().map(|v| v * v).sum();
    (squares / values.len().max(1) as f64).sqrt()
}

/// Largest distance of a value from the mean of all.
pub fn largest_about_mean(values: &[f64]) -> f64 {
    let mean = mean(values);
    let distances = values.iter().map(|v| (v - mean).abs());
    distances.fold(0.0, f64::max)
}

/// Least and greatest value.
pub fn extremes(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
        (low.min(x), high.max(x))
    })
}

/// Median; the mean of the two in the middle for an even count, zero for none.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    match n {
        0 => 0.0,
        _ => 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]),
    }
}

/// Standard deviation of a normal variable with the median absolute deviation of `values` from their median.
pub fn robust_deviation(values: &[f64]) -> f64 {
    let centre = median(values);
    let distances: Vec<f64> = values.iter().map(|x| (x - centre).abs()).collect();
    NORMAL_MAD * median(&distances)
}

/// Refuses samples of a channel that are no finite numbers; `before` so many samples precede these.
///
/// # Errors
/// [`Error::Input`](crate::error::Error::Input) at the first of them.
pub fn check_finite(channel: &str, before: usize, samples: &[f64]) -> Result<()> {
    let bad = samples.iter().position(|x| !x.is_finite());
    bad.map_or(Ok(()), |bad| {
        let place = format!("{channel}, sample {}", before + bad);
        finite(place, samples[bad]).map(drop)
    })
}

/// So many equal samples at the extreme of a channel are a converter at its limit: 0.04 s at 200 Hz.
const CLIPPED_AT_LEAST: usize = 8;

/// A digitised channel dwells at a peak; one that is clipped gets there in more than this many of its smallest steps.
const STEPS_AT_LEAST: f64 = 3.0;

/// Shorter ones are as well where there are many: two equal samples are a wave that is sampled on both sides of its peak, three
/// are one that is cut.
const SHORT_AT_LEAST: usize = 3;
const SHORT_ONES_AT_LEAST: usize = 8;

/// First sample and length of every stretch of eight or more equal samples at the highest or lowest value; of three or more where
/// there are eight such stretches at that value.
/// A rest at the end of the range (a motion to one side) is none: the channel must have come there from elsewhere and go back.
pub fn clipped_stretches(samples: &[f64]) -> Vec<(usize, usize)> {
    let (low, high) = extremes(samples.iter().copied());
    let steps = samples.windows(2).map(|w| (w[1] - w[0]).abs());
    let (smallest, _) = extremes(steps.filter(|step| *step > 0.0));
    let mut found: Vec<(usize, usize)> = Vec::new();
    let mut at = 0;
    while at < samples.len() && low < high {
        let from = at;
        while at < samples.len() && samples[at] == samples[from] {
            at += 1;
        }
        let is_extreme = samples[from] == low || samples[from] == high;
        let is_inside = from > 0 && at < samples.len();
        if is_extreme
            && is_inside
            && at - from >= SHORT_AT_LEAST
            && (samples[from] - samples[from - 1]).abs() > STEPS_AT_LEAST * smallest
        {
            found.push((from, at - from));
        }
        // NaN equals nothing, not even itself
        at = at.max(from + 1);
    }
    let [lows, highs] = [low, high].map(|x| found.iter().filter(|s| samples[s.0] == x).count());
    found.retain(|(from, length)| {
        let alike = if samples[*from] == low { lows } else { highs };
        *length >= CLIPPED_AT_LEAST || alike >= SHORT_ONES_AT_LEAST
    });
    found
}

/// Up to this part of a channel may be clipped and replaced; more is refused.
const CLIPPED_PART: f64 = 0.005;

/// First sample and number of samples of every stretch in which a channel stands at its limit; `before` so many samples precede these.
///
/// # Errors
/// [`Error::Input`](crate::error::Error::Input) at the channel for more than a short while.
pub fn check_clipping(
    channel: &str,
    before: usize,
    samples: &[f64],
) -> Result<Vec<(usize, usize)>> {
    let stretches = clipped_stretches(samples);
    let total: usize = stretches.iter().map(|s| s.1).sum();
    let first = before + stretches.first().map_or(0, |s| s.0);
    let holds = total as f64 <= CLIPPED_PART * samples.len() as f64;
    let place = format_args!("{channel}, sample {first}");
    let count = stretches.len();
    let found = format_args!("{total} samples at its limit in {count} stretches");
    ensure(holds, place, "a channel that is not clipped", found).map(|()| stretches)
}

/// Weights of the differences over two, four and six samples.
const DIFFERENCES: [f64; 3] = [3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0];

/// First derivative, per second, by central differences of sixth order; before the first and after the last sample their
/// value is held. No phase is moved, the amplitude of a component sampled `m` times per period is off by `(2π/m)⁶/140`,
/// 2e-9 at 80 samples per period.
pub fn rate(signal: &[f64], sampling_hz: f64) -> Vec<f64> {
    let last = signal.len() as isize - 1;
    let at = |k: isize| signal[k.clamp(0, last) as usize];
    let rate_at = |k: isize| {
        let pairs = (1..).zip(DIFFERENCES);
        let sum: f64 = pairs.map(|(i, c)| c * (at(k + i) - at(k - i))).sum();
        sum * sampling_hz
    };
    (0..=last).map(rate_at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn outliers_do_not_count() {
        let mut values: Vec<f64> = (0..101).map(f64::from).collect();
        assert_eq!(median(&values), 50.0);
        assert!((robust_deviation(&values) - NORMAL_MAD * 25.0).abs() < 1e-12);
        values[100] = 1e9;
        assert_eq!(median(&values), 50.0);
        assert_eq!(median(&[1.0, 3.0]), 2.0);
        assert_eq!(median(&[]), 0.0);
    }

    #[test]
    fn a_converter_at_its_limit_is_seen() {
        let sine: Vec<f64> = (0..800).map(|k| (0.01 * f64::from(k)).sin()).collect();
        assert!(clipped_stretches(&sine).is_empty());
        let clipped: Vec<f64> = sine.iter().map(|x| x.min(0.98)).collect();
        let found = clipped_stretches(&clipped);
        // sin t > 0.98 from t = 1.3705 to 1.7711, and 2π later
        assert_eq!(found, [(138, 40)]);
        let digitised: Vec<f64> = sine.iter().map(|x| (100.0 * x).round() / 100.0).collect();
        assert!(clipped_stretches(&digitised).is_empty());
        assert!(clipped_stretches(&[1.0; 50]).is_empty());
    }

    /// Twenty samples a period, of which four lie above 80 %; two lie at the peak of the whole wave, one on either side.
    #[test]
    fn many_short_stretches_at_one_value_are_clipped() {
        let wave = |k: i32| (TAU * (f64::from(k) + 0.5) / 20.0).sin();
        let whole: Vec<f64> = (0..400).map(wave).collect();
        assert!(clipped_stretches(&whole).is_empty());
        let clipped: Vec<f64> = whole.iter().map(|x| x.min(0.8)).collect();
        let found = clipped_stretches(&clipped);
        assert_eq!(found.len(), 20);
        assert_eq!(found[0], (3, 4));
        assert!(
            clipped_stretches(&clipped[..140]).is_empty(),
            "seven are chance"
        );
    }

    #[test]
    fn rates_of_a_sine() {
        let omega = TAU * 2.5;
        let x: Vec<f64> = (0..400)
            .map(|k| (omega * f64::from(k) / 200.0).sin())
            .collect();
        let v = rate(&x, 200.0);
        for (k, v) in v.iter().enumerate().take(397).skip(3) {
            let cos = (omega * k as f64 / 200.0).cos();
            assert!((v / omega - cos).abs() < 3e-9);
        }
        assert!(rate(&[], 200.0).is_empty());
    }
}
