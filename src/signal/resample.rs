//! Resampling of a stream at a longer step by six-point Lagrange interpolation.
//!
//! Interpolation moves no phase. Its relative error for a motion sampled `m` times a period is about `(2.6/m)⁶`; nothing is
//! filtered before, so components near half the sampling frequency must be absent already.

use super::lagrange::lagrange_weights;

/// Input samples kept before the buffer is cut.
const KEEP: usize = 1024;

/// Interpolates channels that arrive in pieces at the times `m · ratio`, in units of the input step.
pub struct Resampler {
    ratio: f64,
    /// Next output sample.
    next: usize,
    /// Input index of the first buffered sample.
    start: usize,
    buffers: Vec<Vec<f64>>,
}

impl Resampler {
    /// `ratio` of output step to input step, at least one.
    pub fn new(ratio: f64, channels: usize) -> Self {
        Self {
            ratio,
            next: 0,
            start: 0,
            buffers: vec![Vec::new(); channels],
        }
    }

    /// Takes one piece a channel and replaces `out` by the samples that have become known. The last one or two samples
    /// of a record, whose neighbours never come, are left out.
    pub fn push(&mut self, input: &[Vec<f64>], out: &mut [Vec<f64>]) {
        for (buffer, piece) in self.buffers.iter_mut().zip(input) {
            buffer.extend_from_slice(piece);
        }
        out.iter_mut().for_each(Vec::clear);
        let end = self.start + self.buffers.first().map_or(0, Vec::len);
        loop {
            let at = self.next as f64 * self.ratio;
            // two nodes before and three after, but none before the record
            let window = (at as usize).saturating_sub(2);
            if window + 6 > end {
                break;
            }
            let weights = lagrange_weights(at - window as f64);
            for (buffer, out) in self.buffers.iter().zip(out.iter_mut()) {
                let nodes = &buffer[window - self.start..window - self.start + 6];
                out.push(nodes.iter().zip(weights).map(|(x, w)| x * w).sum());
            }
            self.next += 1;
        }
        self.cut(end);
    }

    fn cut(&mut self, end: usize) {
        let needed = ((self.next as f64 * self.ratio) as usize)
            .saturating_sub(2)
            .min(end);
        if needed > self.start + KEEP {
            for buffer in &mut self.buffers {
                buffer.drain(..needed - self.start);
            }
            self.start = needed;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Polynomials of degree five are exact; pieces of any size give the same numbers.
    #[test]
    fn quintics_are_exact_however_they_arrive() {
        let value = |t: f64| 1.0 + t * (0.5 - t * (0.02 + 1e-5 * t * t * t));
        let input: Vec<f64> = (0..60).map(|i| value(0.1 * f64::from(i))).collect();
        let ratio = 1.34;
        let resample = |piece: usize| {
            let mut resampler = Resampler::new(ratio, 1);
            let mut out = vec![Vec::new()];
            let mut all = Vec::new();
            for chunk in input.chunks(piece) {
                resampler.push(&[chunk.to_vec()], &mut out);
                all.extend_from_slice(&out[0]);
            }
            all
        };
        let whole = resample(60);
        assert!(whole.len() >= 42);
        for (m, x) in whole.iter().enumerate() {
            assert!((x - value(0.1 * ratio * m as f64)).abs() < 1e-12);
        }
        assert_eq!(whole, resample(1));
        assert_eq!(whole, resample(7));
    }
}
