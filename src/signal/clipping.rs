//! Where a channel stood at the limit of its range.

/// So many equal samples at the extreme of a channel are a converter at its limit: 0.04 s at 200 Hz.
const CLIPPED_AT_LEAST: usize = 8;

/// A digitised channel dwells at a peak; one that is clipped gets there in more than this many of its smallest steps.
const STEPS_AT_LEAST: f64 = 3.0;

/// First sample and length of every stretch of eight or more equal samples at the highest or lowest value.
/// A rest at the end of the range (a motion to one side) is none: the channel must have come there from elsewhere and go back.
pub fn clipped_stretches(samples: &[f64]) -> Vec<(usize, usize)> {
    let low = samples.iter().copied().fold(f64::INFINITY, f64::min);
    let high = samples.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let smallest = samples
        .windows(2)
        .map(|w| (w[1] - w[0]).abs())
        .filter(|step| *step > 0.0)
        .fold(f64::INFINITY, f64::min);
    let mut found = Vec::new();
    let mut at = 0;
    while at < samples.len() && low < high {
        let from = at;
        while at < samples.len() && samples[at] == samples[from] {
            at += 1;
        }
        let is_extreme = samples[from] == low || samples[from] == high;
        let is_long = at - from >= CLIPPED_AT_LEAST && from > 0 && at < samples.len();
        if is_extreme
            && is_long
            && (samples[from] - samples[from - 1]).abs() > STEPS_AT_LEAST * smallest
        {
            found.push((from, at - from));
        }
        // NaN equals nothing, not even itself
        at = at.max(from + 1);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::clipped_stretches;

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
}
