//! The onset of a whole bridge: its shape, and from it the onsets of bridges nearby.

use super::critical_point::CriticalPoint;
use super::determinant::StructureInWind;
use super::following::{MIN_ASSURANCE, Mode, assurance};
use super::modal_characteristic::ModalCharacteristic;
use crate::aerodynamics::Transfer;
use crate::aeroelastic::CoupledSection;
use crate::bridge::Bridge;
use crate::error::Result;
use crate::state_space::{ValueAt, secant};
use nalgebra::{Complex, DVector};
use std::f64::consts::TAU;

/// First step of the secant, its longest, and the last, over the speed.
const FIRST_STEP: f64 = 1e-3;
const LONGEST_STEP: f64 = 0.1;
const SETTLED: f64 = 1e-9;
const MOST_STEPS: usize = 30;

/// The motion that the impedance of `forces` (of [`Bridge::forces`]) at an onset resists least, in mass-normalised modal coordinates.
///
/// # Errors
/// [`Error::Input`](crate::Error::Input) for forces that say nothing at its reduced frequency;
/// [`Error::Numerical`](crate::Error::Numerical) when there is no such motion.
pub fn modal_shape(
    bridge: &Bridge,
    forces: &dyn Transfer,
    at: &CriticalPoint,
) -> Result<DVector<Complex<f64>>> {
    let (structure, model) = (&bridge.structure(), forces);
    StructureInWind { structure, model }.shape(at.speed_m_s, at.omega(bridge.width_m()))
}

/// An onset from which those of bridges nearby are found without a search: by the mode that flutters, followed by its shape.
#[derive(Debug, Clone)]
pub struct NearbyOnset {
    /// Wind speed, m/s.
    pub speed_m_s: f64,
    lambda: Complex<f64>,
    shape: DVector<Complex<f64>>,
}

impl NearbyOnset {
    /// Starts from the onset `at` of `bridge`.
    ///
    /// # Errors
    /// As [`modal_shape`] has them.
    pub fn new(bridge: &Bridge, at: &CriticalPoint) -> Result<Self> {
        Ok(Self {
            speed_m_s: at.speed_m_s,
            lambda: Complex::new(0.0, at.omega(bridge.width_m())),
            shape: modal_shape(bridge, &bridge.forces(), at)?,
        })
    }

    /// Starts from a mode at a wind speed, m/s, where it need not be critical.
    pub(super) fn of_mode(speed_m_s: f64, mode: &Mode) -> Self {
        Self {
            speed_m_s,
            lambda: mode.lambda,
            shape: mode.shape.clone(),
        }
    }

    /// Its frequency, Hz.
    pub fn frequency_hz(&self) -> f64 {
        self.lambda.im / TAU
    }

    /// Whether this is the motion of `other`, hardly changed.
    pub fn resembles(&self, other: &Self) -> bool {
        assurance(&self.shape, &other.shape) >= MIN_ASSURANCE
    }

    /// The onset of the same mode of another bridge, by the secant, from which it goes on; `None` where the mode cannot be followed
    /// that far.
    pub fn follow(&self, other: &CoupledSection) -> Option<Self> {
        let problem = ModalCharacteristic::new(other)?;
        let mut known = (self.lambda, self.shape.clone());
        let mut growth = |speed: f64| -> Option<f64> {
            known = problem.at(speed).solve(known.0, &known.1, None)?;
            Some(known.0.re)
        };
        let (from, beside) = (self.speed_m_s, self.speed_m_s * (1.0 + FIRST_STEP));
        let start = ValueAt::new(from, growth(from)?);
        // no further than a tenth at once: beyond, it may be another mode
        let ends = [LONGEST_STEP, SETTLED];
        let found = secant::<()>(start, beside, ends, MOST_STEPS, |speed| Ok(growth(speed)));
        let speed_m_s = found.ok()??;
        let (lambda, shape) = known;
        Some(Self {
            speed_m_s,
            lambda,
            shape,
        })
    }
}
