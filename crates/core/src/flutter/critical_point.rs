//! The motion at a speed at which flutter begins, or is found to have begun.

use crate::section::Structure;
use crate::units::{ReducedFrequency, ReducedVelocity};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// How an onset was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OnsetMethod {
    /// Eigenvalues of the coupled state matrix.
    Eigenvalues,
    /// Determinant of the impedance in `(V, ω)`.
    Determinant,
    /// Growth rate of the stepped FMU.
    FmuStepping,
    /// Modes with the forces at their own frequency, iterated (p-k).
    PkIteration,
}

impl OnsetMethod {
    /// The route in a word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Eigenvalues => "eigenvalues",
            Self::Determinant => "determinant",
            Self::FmuStepping => "FMU stepped",
            Self::PkIteration => "p-k iteration",
        }
    }
}

/// Speed and frequency of a motion that loses its damping or has lost it, by one route for one force model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CriticalPoint {
    /// Force model.
    pub model: String,
    /// Route by which it was found.
    pub method: OnsetMethod,
    /// Wind speed, m/s.
    pub speed_m_s: f64,
    /// Frequency of the motion there, Hz.
    pub frequency_hz: f64,
    /// `V* = V/(fB)`.
    pub reduced_velocity: ReducedVelocity,
    /// `K = ωB/V`.
    pub reduced_frequency: ReducedFrequency,
}

impl CriticalPoint {
    /// Its circular frequency (rad/s) for this width.
    pub(super) fn omega(&self, width_m: f64) -> f64 {
        self.reduced_frequency.circular(width_m, self.speed_m_s)
    }

    /// A motion of the structure with the circular frequency `omega` (rad/s).
    pub(super) fn of_motion(
        model: &str,
        method: OnsetMethod,
        structure: &Structure,
        speed_m_s: f64,
        omega: f64,
    ) -> Self {
        let k = ReducedFrequency::from_circular(omega, structure.width_m, speed_m_s);
        Self::new(model, method, speed_m_s, omega / TAU, k)
    }

    /// At a speed and a frequency, whose reduced frequency is `k`.
    pub fn new(
        model: &str,
        method: OnsetMethod,
        speed_m_s: f64,
        frequency_hz: f64,
        k: ReducedFrequency,
    ) -> Self {
        Self {
            model: model.to_owned(),
            method,
            speed_m_s,
            frequency_hz,
            reduced_velocity: k.into(),
            reduced_frequency: k,
        }
    }
}
