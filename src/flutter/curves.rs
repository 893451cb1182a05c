//! Frequencies, damping ratios and shapes of the tracked modes over wind speed (V-f and V-g curves).

use super::tracking::{Tracker, branch_name};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result, non_negative};
use nalgebra::Complex;
use serde::Serialize;
use std::f64::consts::TAU;

/// One mode at one wind speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModePoint {
    /// Wind speed, m/s.
    pub speed_m_s: f64,
    /// Eigenvalue `λ`, rad/s.
    pub eigenvalue: Complex64,
    /// `|Im λ|/2π`, Hz.
    pub frequency_hz: f64,
    /// `−Re λ/|λ|`; negative when the motion grows.
    pub damping_ratio: f64,
    /// Displacements of the mode in the order of the degrees of freedom: m, rad; unit norm in `(y/B, x/B, θ)`.
    pub shape: Vec<Complex64>,
}

/// A complex number as it is written to files.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Complex64 {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl From<Complex<f64>> for Complex64 {
    fn from(z: Complex<f64>) -> Self {
        Self { re: z.re, im: z.im }
    }
}

/// A mode followed over all wind speeds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModeBranch {
    /// Degree of freedom the mode moves in still air.
    pub name: String,
    /// One point a wind speed, up to where the mode stops oscillating.
    pub points: Vec<ModePoint>,
}

/// All structural modes over wind speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FlutterCurves {
    /// Name of the force model.
    pub model: String,
    /// One branch a degree of freedom.
    pub branches: Vec<ModeBranch>,
}

/// Follows the structural modes of `section` from still air over the increasing `speeds_m_s`.
///
/// # Errors
/// [`Error::Input`] for speeds that do not increase; [`Error::Numerical`] when modes cannot be told apart.
pub fn trace_modes(
    model: &str,
    section: &CoupledSection,
    speeds_m_s: &[f64],
) -> Result<FlutterCurves> {
    let mut tracker = Tracker::start(section)?;
    let mut branches: Vec<ModeBranch> = section
        .structure()
        .dofs
        .iter()
        .map(|dof| ModeBranch {
            name: branch_name(*dof),
            points: Vec::with_capacity(speeds_m_s.len()),
        })
        .collect();
    let mut last = 0.0;
    for &speed in speeds_m_s {
        if non_negative("wind speeds", speed)? < last {
            return Err(Error::input(
                "wind speeds",
                "increasing numbers",
                format!("{speed} after {last}"),
            ));
        }
        last = speed;
        if speed < tracker.speed {
            // below the first speed at which the sampled system resolves the modes nothing can be said
            continue;
        }
        tracker = tracker.advance(speed)?;
        for mode in &tracker.modes {
            branches[mode.branch].points.push(ModePoint {
                speed_m_s: speed,
                eigenvalue: mode.lambda.into(),
                frequency_hz: mode.lambda.im.abs() / TAU,
                damping_ratio: damping_ratio(mode.lambda),
                shape: mode.shape.iter().map(|z| (*z).into()).collect(),
            });
        }
    }
    Ok(FlutterCurves {
        model: model.to_owned(),
        branches,
    })
}

/// `−Re λ/|λ|`.
pub(super) fn damping_ratio(lambda: Complex<f64>) -> f64 {
    -lambda.re / lambda.norm()
}
