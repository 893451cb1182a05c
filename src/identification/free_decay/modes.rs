//! Damped exponentials in several channels: the eigensystem realisation algorithm.
//!
//! Of the block Hankel matrix `H₀ = [y(i+j)]` of the samples and the one a sample later, `H₁`, the reduced state matrix is
//! `A = S^{−1/2} Uᵀ H₁ V S^{−1/2}` with the largest singular values of `H₀ = U S Vᵀ` (Juang & Pappa 1985, J. Guidance 8(5));
//! its eigenvalues are `z_m = e^{λ_m Δt}`. More exponentials than modes are taken, for the memory of the flow and the noise;
//! their amplitudes follow by least squares, and the oscillations with the most energy are the modes.

use crate::error::{Error, Result, positive};
use crate::state_space::eigenvalues;
use nalgebra::{Complex, DMatrix};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// How modes are told in a decay.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DecayOptions {
    /// Seconds at the start that are left out, default 0.
    pub discard_s: f64,
    /// Highest frequency looked for, Hz, default 10: the samples are thinned to eight times that.
    pub highest_hz: f64,
    /// Exponentials besides two a mode, default 6: the lag terms of two motions, and noise.
    pub extra: usize,
    /// Samples used after thinning at most, default 400.
    pub samples: usize,
}

impl Default for DecayOptions {
    fn default() -> Self {
        Self {
            discard_s: 0.0,
            highest_hz: 10.0,
            extra: 6,
            samples: 400,
        }
    }
}

/// Samples a period of the highest frequency.
const SAMPLES_A_PERIOD: f64 = 8.0;
/// Singular values below this part of the largest are rounding.
const RANK: f64 = 1e-11;

/// One mode of a decay.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DecayMode {
    /// Frequency `Im λ/2π`, Hz.
    pub frequency_hz: f64,
    /// Damping ratio `−Re λ/|λ|`.
    pub damping_ratio: f64,
    /// Real and imaginary part of `λ`, rad/s.
    pub lambda: [f64; 2],
    /// Real and imaginary part of the shape at the first sample used, one a degree of freedom: m, rad.
    pub amplitudes: Vec<[f64; 2]>,
    /// Energy of the mode over that of the record.
    pub energy: f64,
}

impl DecayMode {
    /// `λ`, rad/s.
    pub fn eigenvalue(&self) -> Complex<f64> {
        Complex::new(self.lambda[0], self.lambda[1])
    }

    /// `φ`.
    pub fn shape(&self) -> Vec<Complex<f64>> {
        self.amplitudes
            .iter()
            .map(|[re, im]| Complex::new(*re, *im))
            .collect()
    }
}

/// The modes of a decay, as many as there are channels, by frequency.
///
/// # Errors
/// [`Error::Input`] naming `record` for numbers that are not finite or too few samples; [`Error::Numerical`] when fewer modes
/// than channels are found.
pub fn identify_modes(
    record: &str,
    channels: &[Vec<f64>],
    sampling_hz: f64,
    options: &DecayOptions,
) -> Result<Vec<DecayMode>> {
    let place = |what: &str| format!("record {record}: {what}");
    positive(&place("sampling_hz"), sampling_hz)?;
    positive("highest_hz", options.highest_hz)?;
    let n = channels.len();
    for (c, x) in channels.iter().enumerate() {
        if let Some(k) = x.iter().position(|v| !v.is_finite()) {
            let place = place(&format!("channel {}, sample {k}", c + 1));
            return Err(Error::input(place, "a finite number", x[k].to_string()));
        }
    }
    let every = (sampling_hz / (SAMPLES_A_PERIOD * options.highest_hz))
        .floor()
        .max(1.0) as usize;
    let step_s = every as f64 / sampling_hz;
    let first = (options.discard_s * sampling_hz).ceil().max(0.0) as usize;
    // channels of one size, so that the Hankel matrix does not see one alone
    let scales: Vec<f64> = channels
        .iter()
        .map(|x| {
            x.iter()
                .fold(0.0_f64, |m, v| m.max(v.abs()))
                .max(f64::MIN_POSITIVE)
        })
        .collect();
    let y: Vec<Vec<f64>> = channels
        .iter()
        .zip(&scales)
        .map(|(x, s)| {
            let thinned = x.iter().skip(first).step_by(every);
            thinned.take(options.samples).map(|v| v / s).collect()
        })
        .collect();
    let count = y.iter().map(Vec::len).min().unwrap_or(0);
    let order = 2 * n + options.extra;
    let least = 4 * order;
    if n == 0 || count < least {
        let expected = format!("at least {least} samples {step_s} s apart after discard_s");
        return Err(Error::input(place("motion"), expected, count.to_string()));
    }
    let poles = poles(&y, count, order)?;
    let residues = amplitudes(&y, count, &poles)?;
    let mut modes = select(&poles, &residues, &scales, step_s, count, options);
    if modes.len() < n {
        return Err(Error::Numerical(format!(
            "record {record}: {} oscillations below {} Hz found, {n} expected",
            modes.len(),
            options.highest_hz
        )));
    }
    modes.truncate(n);
    modes.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    Ok(modes)
}

/// `z_m` of the realisation of `order`.
fn poles(y: &[Vec<f64>], count: usize, order: usize) -> Result<Vec<Complex<f64>>> {
    let n = y.len();
    let rows = (count / 3).max(order);
    let columns = count - rows;
    let hankel =
        |late: usize| DMatrix::from_fn(n * rows, columns, |i, j| y[i % n][i / n + j + late]);
    let svd = hankel(0)
        .try_svd(true, true, f64::EPSILON, 10_000)
        .ok_or_else(|| Error::Numerical("free decay: no singular values".into()))?;
    let (Some(u), Some(v_t)) = (&svd.u, &svd.v_t) else {
        return Err(Error::Numerical("free decay: no singular vectors".into()));
    };
    let mut by_size: Vec<usize> = (0..svd.singular_values.len()).collect();
    by_size.sort_by(|a, b| svd.singular_values[*b].total_cmp(&svd.singular_values[*a]));
    let largest = by_size.first().map_or(0.0, |i| svd.singular_values[*i]);
    by_size.retain(|i| svd.singular_values[*i] > RANK * largest);
    by_size.truncate(order);
    let later = hankel(1);
    let a = DMatrix::from_fn(by_size.len(), by_size.len(), |p, q| {
        let (i, j) = (by_size[p], by_size[q]);
        let scale = (svd.singular_values[i] * svd.singular_values[j]).sqrt();
        (u.column(i).transpose() * &later * v_t.row(j).transpose())[(0, 0)] / scale
    });
    eigenvalues(&a)
}

/// Complex amplitude of every pole in every channel, `[pole][channel]`, by least squares.
fn amplitudes(
    y: &[Vec<f64>],
    count: usize,
    poles: &[Complex<f64>],
) -> Result<Vec<Vec<Complex<f64>>>> {
    let powers = DMatrix::from_fn(count, poles.len(), |k, m| poles[m].powi(k as i32));
    let samples = DMatrix::from_fn(count, y.len(), |k, c| Complex::new(y[c][k], 0.0));
    let svd = powers
        .try_svd(true, true, f64::EPSILON, 10_000)
        .ok_or_else(|| Error::Numerical("free decay: no amplitudes".into()))?;
    let solution = svd
        .solve(&samples, 1e-13)
        .map_err(|e| Error::Numerical(format!("free decay: {e}")))?;
    Ok((0..poles.len())
        .map(|m| solution.row(m).iter().copied().collect())
        .collect())
}

/// Oscillations below the highest frequency, the most energetic first.
fn select(
    poles: &[Complex<f64>],
    residues: &[Vec<Complex<f64>>],
    scales: &[f64],
    step_s: f64,
    count: usize,
    options: &DecayOptions,
) -> Vec<DecayMode> {
    let mut modes = Vec::new();
    for (z, residue) in poles.iter().zip(residues) {
        let lambda = z.ln() / step_s;
        let frequency_hz = lambda.im / TAU;
        if z.im <= 0.0 || !(frequency_hz > 0.0 && frequency_hz <= options.highest_hz) {
            continue;
        }
        let decay = z.norm_sqr();
        let sum: f64 = if (decay - 1.0).abs() < 1e-12 {
            count as f64
        } else {
            (1.0 - decay.powi(count as i32)) / (1.0 - decay)
        };
        let size: f64 = residue.iter().map(Complex::norm_sqr).sum();
        modes.push(DecayMode {
            frequency_hz,
            damping_ratio: -lambda.re / lambda.norm(),
            lambda: [lambda.re, lambda.im],
            // the conjugate pole has the other half
            amplitudes: residue
                .iter()
                .zip(scales)
                .map(|(r, s)| [2.0 * s * r.re, 2.0 * s * r.im])
                .collect(),
            energy: size * sum,
        });
    }
    modes.sort_by(|a, b| b.energy.total_cmp(&a.energy));
    let total: f64 = modes.iter().map(|m| m.energy).sum();
    for mode in &mut modes {
        mode.energy /= total.max(f64::MIN_POSITIVE);
    }
    modes
}
