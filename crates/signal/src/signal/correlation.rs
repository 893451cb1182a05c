//! Full cross-correlation of two real signals, and the energies of the parts that overlap.

use super::Complex64;
use super::fourier::Fourier;

/// `c(n) = Σ_k X₂[k+n] X₁[k]`, `|n| < N`: a positive lag means that `X₂` comes later.
pub struct CrossCorrelation {
    /// `c(n)` at `n mod M`, M large enough that nothing wraps round.
    values: Vec<f64>,
    /// `Σ_{k<n} X[k]²` for n = 0…N, of reference and compared signal.
    cumulated_energy: [Vec<f64>; 2],
}

impl CrossCorrelation {
    /// Of two signals of equal length.
    pub fn new(reference: &[f64], compared: &[f64]) -> Self {
        let product = cross_spectrum(reference, compared);
        let size = product.len();
        let sums = Fourier::new(size).sums(product);
        let values = sums.iter().map(|x| x / size as f64).collect();
        Self {
            values,
            cumulated_energy: [cumulated_energy(reference), cumulated_energy(compared)],
        }
    }

    /// Number of samples N.
    pub fn sample_count(&self) -> usize {
        self.cumulated_energy[0].len() - 1
    }

    /// `√(Σ X₁² Σ X₂²)` over the samples that overlap at a lag: by Schwarz's inequality the largest `|c|` can be.
    pub fn overlap_energy(&self, lag: isize) -> f64 {
        let count = self.sample_count();
        let shift = lag.unsigned_abs().min(count);
        let [first, second] = &self.cumulated_energy;
        let head = |energy: &[f64]| energy[count - shift];
        let tail = |energy: &[f64]| energy[count] - energy[shift];
        let product = match lag >= 0 {
            true => head(first) * tail(second),
            false => tail(first) * head(second),
        };
        product.max(0.0).sqrt()
    }

    /// `c` at a whole lag; zero where the signals do not overlap.
    pub fn at(&self, lag: isize) -> f64 {
        if lag.unsigned_abs() >= self.sample_count() {
            return 0.0;
        }
        self.values[lag.rem_euclid(self.values.len() as isize) as usize]
    }

    /// Whole lag at which `c` itself is largest, the first of equal ones.
    pub fn largest(&self) -> isize {
        self.largest_by(|c| c)
    }

    /// Whole lag at which `|c|` is largest, the first of equal ones.
    pub fn largest_magnitude(&self) -> isize {
        self.largest_by(f64::abs)
    }

    fn largest_by(&self, measure: impl Fn(f64) -> f64) -> isize {
        let end = self.sample_count() as isize;
        let (mut best, mut best_value) = (0, f64::NEG_INFINITY);
        for lag in 1 - end..end {
            let value = measure(self.at(lag));
            if value > best_value {
                (best, best_value) = (lag, value);
            }
        }
        best
    }
}

/// Transform of `compared` times the conjugate of that of `reference`, both padded with zeros to a power of two of at least
/// twice the samples.
pub(super) fn cross_spectrum(reference: &[f64], compared: &[f64]) -> Vec<Complex64> {
    let fourier = Fourier::new((2 * reference.len()).next_power_of_two());
    let transform = |x: &[f64]| fourier.spectrum(x.iter().copied());
    let mut product = transform(compared);
    for (z, w) in product.iter_mut().zip(transform(reference)) {
        *z *= w.conj();
    }
    product
}

fn cumulated_energy(signal: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut cumulated = vec![0.0];
    for x in signal {
        sum += x * x;
        cumulated.push(sum);
    }
    cumulated
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn signals() -> (Vec<f64>, Vec<f64>) {
        let x: Vec<f64> = (0..30).map(|k| ((k * k) as f64 * 0.37).sin()).collect();
        let y = (0..30).map(|k| ((k * k + 5) as f64 * 0.21).cos()).collect();
        (x, y)
    }

    #[test]
    fn whole_lags_are_the_sum_of_the_definition() {
        let (x, y) = signals();
        let c = CrossCorrelation::new(&x, &y);
        for lag in -30_isize..=30 {
            let direct: f64 = (0..30)
                .filter(|k| (0..30).contains(&(k + lag)))
                .map(|k| y[(k + lag) as usize] * x[k as usize])
                .sum();
            assert_relative_eq!(c.at(lag), direct, epsilon = 1e-13);
            let energy = |z: &[f64], shift: isize| -> f64 {
                (0..30)
                    .filter(|k| (0..30).contains(&(k + shift)))
                    .map(|k| z[k as usize].powi(2))
                    .sum()
            };
            let overlap = (energy(&x, lag) * energy(&y, -lag)).sqrt();
            assert_relative_eq!(c.overlap_energy(lag), overlap, epsilon = 1e-6);
        }
    }
}
