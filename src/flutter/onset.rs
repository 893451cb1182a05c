//! The flutter onset as a result: everything a practitioner wants on the card.

use crate::section::Structure;
use crate::units::{ReducedFrequency, ReducedFrequencyRange, ReducedVelocity};
use nalgebra::{Complex, DVector};
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

/// A flutter onset.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Onset {
    /// Force model.
    pub model: String,
    /// Route by which it was found.
    pub method: OnsetMethod,
    /// Onset speed `V_F`, m/s.
    pub speed_m_s: f64,
    /// Frequency at onset, Hz.
    pub frequency_hz: f64,
    /// `V* = V/(fB)`.
    pub reduced_velocity: ReducedVelocity,
    /// `K = ωB/V`.
    pub reduced_frequency: ReducedFrequency,
    /// `|y|/(B|θ|)`.
    pub mode_ratio: f64,
    /// Phase of `y` relative to `θ`, degrees in (−180, 180].
    pub phase_deg: f64,
    /// `dζ/dV` at onset, s/m; `None` where the route does not give it.
    pub damping_slope_s_m: Option<f64>,
    /// Branch that loses its damping.
    pub branch: String,
    /// Whether `K` lies in the range in which the model was tested; `None` when there is no such range.
    pub in_tested_range: Option<bool>,
    /// Further crossings below this one that lie outside the tested range, m/s: signs of an over-fitted model.
    pub spurious_speeds_m_s: Vec<f64>,
    /// What a reader must know before using the number.
    pub warnings: Vec<String>,
    /// How far the data leave the speed open.
    pub interval: OnsetInterval,
}

/// 95 % interval of an onset speed, or why there is none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum OnsetInterval {
    /// The scatter of the data, carried to the onset; says nothing of the bias of the form of the model.
    Known {
        /// Lower end, m/s.
        low_m_s: f64,
        /// Upper end, m/s.
        high_m_s: f64,
        /// Standard error, m/s.
        standard_error_m_s: f64,
        /// Degrees of freedom of the standard error.
        degrees_of_freedom: f64,
    },
    /// There is none.
    None {
        /// Why.
        reason: String,
    },
}

impl OnsetInterval {
    /// No interval, for this reason.
    pub fn none(reason: impl Into<String>) -> Self {
        Self::None {
            reason: reason.into(),
        }
    }
}

impl Onset {
    /// The onset at speed and frequency with a mode shape; nothing about ranges yet.
    pub(super) fn new(
        model: &str,
        method: OnsetMethod,
        structure: &Structure,
        (speed_m_s, omega): (f64, f64),
        shape: &DVector<Complex<f64>>,
        branch: String,
    ) -> Self {
        let width = structure.width_m;
        let y = shape[0] / width;
        let theta = shape[shape.len() - 1];
        let k = ReducedFrequency::from_circular(omega, width, speed_m_s);
        Self {
            model: model.to_owned(),
            method,
            speed_m_s,
            frequency_hz: omega / TAU,
            reduced_velocity: k.into(),
            reduced_frequency: k,
            mode_ratio: y.norm() / theta.norm(),
            phase_deg: (y / theta).arg().to_degrees(),
            damping_slope_s_m: None,
            branch,
            in_tested_range: None,
            spurious_speeds_m_s: Vec::new(),
            warnings: Vec::new(),
            interval: OnsetInterval::none("the data behind the model are not known here"),
        }
    }
}

/// Answer of a search: an onset, or the statement that there is none.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FlutterSearch {
    /// The section flutters.
    Onset(Box<Onset>),
    /// No flutter up to this speed, m/s.
    StableUpTo(f64),
}

impl FlutterSearch {
    /// The onset, if there is one.
    pub fn onset(&self) -> Option<&Onset> {
        match self {
            Self::Onset(onset) => Some(onset),
            Self::StableUpTo(_) => None,
        }
    }
}

/// Picks the answer among all crossings: the lowest one inside the tested range; crossings below it are named as
/// suspicious. Without one inside, the lowest, with a warning.
pub(super) fn choose(
    mut crossings: Vec<Onset>,
    tested: Option<ReducedFrequencyRange>,
    speed_max: f64,
) -> FlutterSearch {
    crossings.sort_by(|a, b| a.speed_m_s.total_cmp(&b.speed_m_s));
    for onset in &mut crossings {
        onset.in_tested_range = tested.map(|range| range.contains(onset.reduced_frequency));
    }
    let trusted = crossings
        .iter()
        .position(|o| o.in_tested_range != Some(false));
    let Some(chosen) = trusted.or(if crossings.is_empty() { None } else { Some(0) }) else {
        return FlutterSearch::StableUpTo(speed_max);
    };
    let mut onset = crossings.swap_remove(chosen);
    crossings.retain(|o| o.speed_m_s < onset.speed_m_s);
    crossings.sort_by(|a, b| a.speed_m_s.total_cmp(&b.speed_m_s));
    for below in &crossings {
        onset.warnings.push(format!(
            "the model also loses damping at {:.2} m/s (V* {:.2}, {} branch), outside the tested range: \
             probably spurious, a sign of over-fitting",
            below.speed_m_s,
            below.reduced_velocity.v_star(),
            below.branch
        ));
        onset.spurious_speeds_m_s.push(below.speed_m_s);
    }
    if onset.in_tested_range == Some(false) {
        onset.warnings.push(format!(
            "V* {:.2} at this onset lies outside the tested range: the model is extrapolating, the onset may be spurious",
            onset.reduced_velocity.v_star()
        ));
    }
    FlutterSearch::Onset(Box::new(onset))
}
