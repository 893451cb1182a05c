//! Reduced frequency and reduced velocity as types.
//!
//! Four numbers circulate in the field for the same thing, apart by factors of 2 and 2π:
//! `K = ωB/V`, `k = ωb/V = K/2` (semi-chord), `V̂ = V/(ωB) = 1/K` and `V* = V/(fB) = 2π/K`.
//! They are made and read here by name, so that no bare number has to be guessed.

mod range;

pub use range::LowerEnd;
pub use range::{ReducedFrequencyGap, ReducedFrequencyRange};

use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Mean speeds whose neighbours are within this ratio belong to one group of test points.
pub const SAME_SPEED: f64 = 1.05;

/// `values` rising, split where one is more than `ratio` times the one before. Every value is in exactly one group (none
/// is empty), whatever the order in which they come.
pub fn near_groups(values: impl IntoIterator<Item = f64>, ratio: f64) -> Vec<Vec<f64>> {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    values
        .chunk_by(|a, b| *b <= ratio * a)
        .map(<[f64]>::to_vec)
        .collect()
}

/// So many numbers from one to another, both positive, in equal ratios.
pub fn in_equal_ratios(from: f64, to: f64, count: usize) -> impl Iterator<Item = f64> {
    let last = count.max(2) as f64 - 1.0;
    (0..count).map(move |i| from * (to / from).powf(i as f64 / last))
}

/// The group of [`near_groups`] that `value` is in, or else the one below it.
pub fn group_of(groups: &[Vec<f64>], value: f64) -> usize {
    groups.partition_point(|g| g[0] <= value).saturating_sub(1)
}

/// Reduced frequency `K = ωB/V` of the full deck width, dimensionless.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::units::{ReducedFrequency, ReducedVelocity};
/// use std::f64::consts::TAU;
///
/// let k = ReducedFrequency::from_hertz(0.2, 31.0, 40.0); // 0.2 Hz, B = 31 m, 40 m/s
/// assert!((k.full_width() - TAU * 0.2 * 31.0 / 40.0).abs() < 1e-15);
/// assert_eq!(k.semi_chord(), 0.5 * k.full_width());
/// assert!((ReducedVelocity::from(k).v_star() - 40.0 / (0.2 * 31.0)).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ReducedFrequency(f64);

impl ReducedFrequency {
    /// From `K = ωB/V` itself.
    pub const fn from_full_width(k: f64) -> Self {
        Self(k)
    }
    /// From circular frequency `ω` (rad/s), width `B` (m) and speed `V` (m/s).
    pub fn from_circular(omega_rad_s: f64, width_m: f64, speed_m_s: f64) -> Self {
        Self(omega_rad_s * width_m / speed_m_s)
    }
    /// From frequency `f` (Hz), width `B` (m) and speed `V` (m/s).
    pub fn from_hertz(frequency_hz: f64, width_m: f64, speed_m_s: f64) -> Self {
        Self::from_circular(TAU * frequency_hz, width_m, speed_m_s)
    }
    /// From the semi-chord reduced frequency `k = ωb/V`, `b = B/2`.
    pub fn from_semi_chord(k: f64) -> Self {
        Self(2.0 * k)
    }
    /// From `V̂ = V/(ωB) = 1/K`, the abscissa of the NTNU workbooks.
    pub fn from_v_hat(v_hat: f64) -> Self {
        Self(1.0 / v_hat)
    }
    /// `K = ωB/V`.
    pub const fn full_width(self) -> f64 {
        self.0
    }
    /// `k = ωb/V = K/2`.
    pub fn semi_chord(self) -> f64 {
        0.5 * self.0
    }
    /// `V̂ = V/(ωB) = 1/K`.
    pub fn v_hat(self) -> f64 {
        1.0 / self.0
    }
    /// Circular frequency `ω = K V/B`, rad/s.
    pub fn circular(self, width_m: f64, speed_m_s: f64) -> f64 {
        self.0 * speed_m_s / width_m
    }
}

/// Reduced velocity `V* = V/(fB) = 2π/K`, dimensionless.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::units::{ReducedFrequency, ReducedVelocity};
/// use std::f64::consts::TAU;
///
/// let k = ReducedFrequency::from(ReducedVelocity::new(5.0));
/// assert!((k.full_width() - TAU / 5.0).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ReducedVelocity(f64);

impl ReducedVelocity {
    /// From `V* = V/(fB)` itself.
    pub const fn new(v_star: f64) -> Self {
        Self(v_star)
    }
    /// `V* = V/(fB)`.
    pub const fn v_star(self) -> f64 {
        self.0
    }
}

impl From<ReducedFrequency> for ReducedVelocity {
    fn from(k: ReducedFrequency) -> Self {
        Self(TAU / k.0)
    }
}

impl From<ReducedVelocity> for ReducedFrequency {
    fn from(v: ReducedVelocity) -> Self {
        Self(TAU / v.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_four_conventions_are_one_number() {
        let k = ReducedFrequency::from_hertz(0.278, 31.0, 45.0);
        assert_eq!(k.semi_chord() * 2.0, k.full_width());
        assert!((k.v_hat() * k.full_width() - 1.0).abs() < 1e-15);
        let v: ReducedVelocity = k.into();
        assert!((v.v_star() - 45.0 / (0.278 * 31.0)).abs() < 1e-14);
        assert!((v.v_star() - TAU * k.v_hat()).abs() < 1e-14);
    }
}
