//! Scalograms `S = |W|²` of many signals of one length, as far as a test of stationarity wants to know them: sums over the
//! levels, one level at a time, and moments over the signals at a level.

use super::morlet::{LevelGroup, RowBuffer};
use crate::signal::{Complex64, mean_and_deviation};
use aerodeck_core::vectorised;
use std::f64::consts::{LN_2, LOG10_E};

/// A signal and what the statistic Θ of its scalogram needs: with `s(t) = ΣS` and the mean spectrum `h = S̄`,
/// `Σ(G − H) ln(G/H)` is `Σ S ln(S/h)/s − Σ h ln(S/h)/Σh`.
pub(super) struct Scalogram {
    samples: Vec<f64>,
    /// `ΣS`.
    power: Vec<f64>,
    /// `Σ S ln(S/h)`.
    local: Vec<f64>,
    /// `Σ h ln(S/h)`.
    global: Vec<f64>,
    /// `Σ |ln(S/h)|`.
    deviation: Vec<f64>,
    /// `Σh`.
    mean_power: f64,
}

impl Scalogram {
    /// Of a signal, no level taken yet.
    pub(super) fn new(samples: Vec<f64>) -> Self {
        let zeros = || vec![0.0; samples.len()];
        Self {
            power: zeros(),
            local: zeros(),
            global: zeros(),
            deviation: zeros(),
            mean_power: 0.0,
            samples,
        }
    }

    /// Takes a group of levels, and shows `visit(level in the group, S)`.
    pub(super) fn advance(
        &mut self,
        group: &LevelGroup<'_>,
        kernels: &[Vec<f64>],
        buffer: &mut RowBuffer,
        mut visit: impl FnMut(usize, &[f64]),
    ) {
        let spectrum = group.spectrum(&self.samples);
        let mut power = vec![0.0; self.samples.len()];
        for (at, kernel) in kernels.iter().enumerate() {
            let row = group.row(kernel, &spectrum, buffer);
            add_level(self, row, &mut power);
            visit(at, &power);
        }
    }

    /// Statistic Θ of the levels taken, which are `step_hz` apart.
    pub(super) fn statistic(&self, step_hz: f64) -> f64 {
        let local = self.local.iter().zip(&self.power).map(|(l, p)| l / p);
        let global = self.global.iter().map(|g| g / self.mean_power);
        let divergence = local.zip(global).map(|(l, g)| LOG10_E * (l - g));
        let (_, divergence_spread) = mean_and_deviation(divergence);
        let log_deviation = self.deviation.iter().map(|d| LOG10_E * d * step_hz);
        let (_, log_spread) = mean_and_deviation(log_deviation);
        divergence_spread.powi(2) * (1.0 + log_spread.powi(2))
    }
}

vectorised! {
    /// Adds a level to the sums; its power is left in `power`.
    fn add_level<'a>(sums: &'a mut Scalogram, row: &'a [Complex64], power: &'a mut [f64]) -> () {
        // silence would have an infinite logarithm
        const FLOOR: f64 = 1e-30;
        for (p, w) in power.iter_mut().zip(row) {
            *p = w.re * w.re + w.im * w.im;
        }
        let mean = sum(power) / power.len() as f64;
        if mean == 0.0 {
            return;
        }
        sums.mean_power += mean;
        let of_bands = sums.local.iter_mut().zip(&mut sums.global);
        let of_times = sums.power.iter_mut().zip(&mut sums.deviation);
        for (p, ((local, global), (power, deviation))) in power.iter().zip(of_bands.zip(of_times)) {
            let ratio = p / mean;
            let ratio = if ratio < FLOOR { FLOOR } else { ratio };
            let (share, logarithm) = (ratio * mean, ln(ratio));
            *power += share;
            *local += share * logarithm;
            *global += mean * logarithm;
            *deviation += logarithm.abs();
        }
    }

    /// Adds a signal to the moments.
    fn add_signal<'a>(moments: &'a mut Moments, power: &'a [f64]) -> () {
        let part = 1.0 / moments.count;
        let to = moments.mean.iter_mut().zip(&mut moments.squares);
        for (p, (m, s)) in power.iter().zip(to) {
            let step = p - *m;
            *m += step * part;
            *s += step * (p - *m);
        }
    }
}

/// Sum in eight parts, which do not wait for one another.
#[inline(always)]
fn sum(values: &[f64]) -> f64 {
    let (blocks, rest) = values.as_chunks::<8>();
    let mut parts = [0.0; 8];
    for block in blocks {
        for (part, x) in parts.iter_mut().zip(block) {
            *part += x;
        }
    }
    parts.iter().chain(rest).sum()
}

/// `ln x` of a normal positive number, to two units of the last place, without a branch: many at once in the vectors of the
/// processor. With `x = 2^k z`, `√½ ≤ z < √2` and `s = (z − 1)/(z + 1)`, `ln x = k ln 2 + 2(s + s³/3 + s⁵/5 + …)`.
#[inline(always)]
fn ln(x: f64) -> f64 {
    const ONE: u64 = 1.0_f64.to_bits();
    // the exponent of numbers from √½ on, with its bias
    const FROM: u64 = ONE - std::f64::consts::FRAC_1_SQRT_2.to_bits();
    // 2⁵² and a whole number are that number in the last bits
    const WHOLE: f64 = 4_503_599_627_370_496.0;
    let biased = (x.to_bits() + FROM) >> 52;
    let exponent = f64::from_bits(WHOLE.to_bits() | biased) - (WHOLE + 1023.0);
    let z = x.to_bits().wrapping_sub(biased << 52).wrapping_add(ONE);
    let z = f64::from_bits(z);
    let s = (z - 1.0) / (z + 1.0);
    let square = s * s;
    // s² < 0.0295: what is left out is 1e-18 of the sum
    let tail = [21.0, 19.0, 17.0, 15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0];
    let series = tail.iter().fold(0.0, |sum, n| square * (sum + 1.0 / n));
    exponent * LN_2 + 2.0 * (s + s * series)
}

/// Mean and sum of squared deviations of the scalograms of some signals at a level.
#[derive(Clone)]
pub(super) struct Moments {
    count: f64,
    mean: Vec<f64>,
    squares: Vec<f64>,
}

impl Moments {
    /// Of no signal.
    pub(super) fn new(samples: usize) -> Self {
        Self {
            count: 0.0,
            mean: vec![0.0; samples],
            squares: vec![0.0; samples],
        }
    }

    /// Takes a signal (Welford's recurrence).
    pub(super) fn add(&mut self, power: &[f64]) {
        self.count += 1.0;
        add_signal(self, power);
    }

    /// Takes the signals of others (Chan, Golub & LeVeque 1983).
    pub(super) fn merge(&mut self, other: &Self) {
        let total = self.count + other.count;
        let part = other.count / total;
        let mine = self.mean.iter_mut().zip(&mut self.squares);
        for ((m, s), (n, t)) in mine.zip(other.mean.iter().zip(&other.squares)) {
            let step = n - *m;
            *m += step * part;
            *s += t + step * step * self.count * part;
        }
        self.count = total;
    }

    /// Largest over time of the mean and so many standard deviations.
    pub(super) fn threshold(&self, deviations: f64) -> f64 {
        let each = self.mean.iter().zip(&self.squares);
        each.map(|(m, s)| m + deviations * (s / (self.count - 1.0)).sqrt())
            .fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithms_are_those_of_the_library() {
        for k in -1000..1000 {
            for x in [1.0 + 1e-4 * f64::from(k), 1.07_f64.powi(k), 2.0_f64.powi(k)] {
                let (ours, theirs) = (ln(x), x.ln());
                assert!((ours - theirs).abs() <= 5e-16 * theirs.abs(), "{x}");
            }
        }
    }
}
