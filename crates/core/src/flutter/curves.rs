//! Frequencies, damping ratios and shapes of the tracked modes over wind speed (V-f and V-g curves).

use super::following::{Follower, Mode};
use super::mode_words::mode_in_words;
use super::tracking::Tracker;
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result, ensure, non_negative};
use crate::section::Structure;
use crate::state_space::damping_ratio;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use nalgebra::Complex;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// One mode at one wind speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
    /// Whether `K = ωB/V` lies in the range in which the model was tested; `None` when there is no such range.
    pub in_tested_range: Option<bool>,
}

impl ModePoint {
    /// A mode at a wind speed, its displacements divided by `size`; nothing about ranges yet.
    pub(super) fn new(speed_m_s: f64, mode: &Mode, size: f64) -> Self {
        Self {
            speed_m_s,
            eigenvalue: mode.lambda.into(),
            frequency_hz: mode.lambda.im / TAU,
            damping_ratio: damping_ratio(mode.lambda),
            shape: mode.shape.iter().map(|z| (z / size).into()).collect(),
            in_tested_range: None,
        }
    }
}

/// A complex number as it is written to files.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
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
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModeBranch {
    /// Degree of freedom the mode moves in still air.
    pub name: String,
    /// One point per wind speed, up to where the mode stops oscillating.
    pub points: Vec<ModePoint>,
}

impl ModeBranch {
    /// The name of a branch as one says it: "torsion mode", "mode 17".
    ///
    /// ```
    /// use aerodeck_core::flutter::ModeBranch;
    ///
    /// assert_eq!(ModeBranch::in_words("torsion"), "torsion mode");
    /// assert_eq!(ModeBranch::in_words("mode 17"), "mode 17");
    /// ```
    pub fn in_words(name: &str) -> String {
        mode_in_words(name)
    }
}

/// All structural modes over wind speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FlutterCurves {
    /// Name of the force model.
    pub model: String,
    /// One branch per degree of freedom.
    pub branches: Vec<ModeBranch>,
    /// Why the branches end before the highest speed, where they do because the modes cannot be followed.
    pub ended: Option<String>,
}

impl FlutterCurves {
    /// States of every point whether its reduced frequency lies in `tested`; `width_m` is that of the section.
    #[must_use]
    pub fn marked(mut self, width_m: f64, tested: Option<ReducedFrequencyRange>) -> Self {
        for point in self.branches.iter_mut().flat_map(|b| &mut b.points) {
            let k = ReducedFrequency::from_hertz(point.frequency_hz, width_m, point.speed_m_s);
            point.in_tested_range = tested.map(|range| range.contains(k));
        }
        self
    }
}

/// A branch for every degree of freedom, with room for its points.
pub(super) fn empty_branches(structure: &Structure, points: usize) -> Vec<ModeBranch> {
    let branch = |row| ModeBranch {
        name: structure.branch_name(row),
        points: Vec::with_capacity(points),
    };
    (0..structure.dofs.len()).map(branch).collect()
}

/// Follows the structural modes of `section` from still air over the increasing `speeds_m_s`.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::RationalModel;
/// use aerodeck::aeroelastic::CoupledSection;
/// use aerodeck::flutter::{trace_modes};
/// use aerodeck::section::SectionModel;
///
/// let structure = SectionModel::iabse_1_1a().structure()?;
/// let section = CoupledSection::with_model(&structure, &RationalModel::jones_flat_plate())?;
/// let curves = trace_modes("plate", &section, &[20.0, 50.0, 90.0])?;
/// let torsion = curves.branches.iter().find(|b| b.name == "torsion").expect("its branch");
/// let damping: Vec<f64> = torsion.points.iter().map(|p| p.damping_ratio).collect();
/// assert!(damping[1] > 0.0 && damping[2] < 0.0); // it flutters between
/// # Ok::<(), aerodeck::Error>(())
/// ```
///
/// # Errors
/// [`Error::Input`] for speeds that do not increase. Where modes cannot be told apart the branches end.
pub fn trace_modes(
    model: &str,
    section: &CoupledSection,
    speeds_m_s: &[f64],
) -> Result<FlutterCurves> {
    trace_modes_watched(model, section, speeds_m_s, &|| ())
}

/// The same, with a look at `watch` before every speed: where work of minutes can be ended.
///
/// # Errors
/// As [`trace_modes`].
pub fn trace_modes_watched(
    model: &str,
    section: &CoupledSection,
    speeds_m_s: &[f64],
    watch: &dyn Fn(),
) -> Result<FlutterCurves> {
    let tracker = Tracker::new(section);
    let mut modes = tracker.start()?;
    let mut branches = empty_branches(section.structure(), speeds_m_s.len());
    let (mut last, mut ended) = (0.0, None);
    for &speed in speeds_m_s {
        watch();
        let grows = non_negative("wind speeds", speed)? >= last;
        let found = format_args!("{speed} after {last}");
        ensure(grows, "wind speeds", "increasing numbers", found)?;
        last = speed;
        if speed < modes.speed {
            // below the first speed at which the sampled system resolves the modes nothing can be said
            continue;
        }
        modes = match tracker.advance(&modes, speed) {
            Ok(modes) => modes,
            Err(Error::NotDistinct(why) | Error::Numerical(why)) => {
                ended = Some(why);
                break;
            }
            other => other?,
        };
        for mode in &modes.all {
            let point = ModePoint::new(speed, mode, 1.0);
            branches[mode.branch].points.push(point);
        }
    }
    Ok(FlutterCurves {
        model: model.to_owned(),
        branches,
        ended,
    })
}
