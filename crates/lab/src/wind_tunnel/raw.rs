//! Raw runs: what the load cells of a rig say, before any processing.
//!
//! # Axes
//!
//! Global axes are fixed to the tunnel: x downwind, y up, z along the span so that (x, y, z) is right-handed. Motion
//! and moments of the section are positive nose-up (windward edge up), which is a turn about −z:
//! `θ = −θ_z`, `M = −M_z`. Order of degrees of freedom is that of the whole crate: vertical, lateral, torsion.
//!
//! A load cell measures three forces and three moments in axes of its own; [`LoadCell::axes`] takes them to global
//! ones: `v_global = axes · v_local`. The sign of a channel is that of the force **on the cell by the model**, so
//! that inertia of an accelerating model of mass m shows as −m ẍ.

use crate::error::{Result, ensure, finite_numbers, positive};
use crate::plausibility::FindingSeverity;
use crate::section::Dof;
use nalgebra::{Matrix3, Rotation3, Vector3};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Names of the six channels of a load cell, in their order: forces in N, moments in N·m.
pub(crate) const CELL_CHANNELS: [&str; 6] = ["fx", "fy", "fz", "mx", "my", "mz"];

/// One six-component load cell of a rig.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoadCell {
    /// Name, as in the campaign file.
    pub name: String,
    /// Rotation from the cell's axes to the global ones, row by row: `v_global = axes · v_local`.
    pub axes: [[f64; 3]; 3],
    /// Position of the cell relative to the centre of rotation of the model, global axes at rest, m.
    pub position_m: [f64; 3],
    /// Whether the cell sits behind the actuator and turns with the model; its axes then turn with θ.
    pub turns_with_model: bool,
}

/// The rig that holds the section model.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rig {
    /// Length of the model along the span, m.
    pub model_length_m: f64,
    /// Width of the model B, m.
    pub model_width_m: f64,
    /// Mass of the model with all that moves with it, kg, to be compared with what the still-air runs show.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model_mass_kg: Option<f64>,
    /// Its moment of inertia about the centre of rotation, kg·m², likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model_inertia_kg_m2: Option<f64>,
    /// Place of its centre of mass from the axis of rotation, global axes at rest, m, likewise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub centre_of_mass_m: Option<[f64; 3]>,
    /// The cells that carry the model.
    pub cells: Vec<LoadCell>,
}

impl Rig {
    /// Checks lengths and axes.
    ///
    /// # Errors
    /// [`Error::Input`](crate::error::Error::Input) naming the key: no cell, a length that is not positive, axes that are no rotation.
    pub(crate) fn validate(&self) -> Result<()> {
        positive("rig.model_length_m", self.model_length_m)?;
        positive("rig.model_width_m", self.model_width_m)?;
        for (key, stated) in [
            ("rig.model_mass_kg", self.model_mass_kg),
            ("rig.model_inertia_kg_m2", self.model_inertia_kg_m2),
        ] {
            stated.map_or(Ok(0.0), |x| positive(key, x))?;
        }
        let centre = self.centre_of_mass_m.unwrap_or_default();
        finite_numbers("rig.centre_of_mass_m", &centre, 3)?;
        let any = !self.cells.is_empty();
        ensure(any, "rig.cells", "at least one load cell", "none")?;
        self.cells.iter().try_for_each(LoadCell::validate)
    }
}

impl LoadCell {
    /// Rotation from the cell's axes to the global ones while the model is turned nose-up by `theta_rad`.
    pub(crate) fn axes_at(&self, theta_rad: f64) -> Matrix3<f64> {
        self.turn(theta_rad) * Matrix3::from_fn(|i, j| self.axes[i][j])
    }

    /// Position relative to the centre of rotation while the model is turned nose-up by `theta_rad`, global axes, m.
    /// The centre and the cell move with heave and sway, so these do not show.
    pub(crate) fn position_at(&self, theta_rad: f64) -> Vector3<f64> {
        self.turn(theta_rad) * Vector3::from(self.position_m)
    }

    /// Nose-up is a turn about −z; a cell that does not turn with the model does not notice.
    fn turn(&self, theta_rad: f64) -> Rotation3<f64> {
        let angle = match self.turns_with_model {
            true => -theta_rad,
            false => 0.0,
        };
        Rotation3::from_axis_angle(&Vector3::z_axis(), angle)
    }

    fn validate(&self) -> Result<()> {
        let axes = Matrix3::from_fn(|i, j| self.axes[i][j]);
        // axes are typed by hand with a few digits
        let is_rotation = (axes * axes.transpose() - Matrix3::identity())
            .iter()
            .all(|e| e.abs() <= 1e-4)
            && axes.determinant() > 0.0;
        let place = format_args!("rig.cells `{}`.axes", self.name);
        let expected = "a rotation (orthonormal rows, right-handed)";
        let found = format_args!("{:?}", self.axes);
        ensure(is_rotation, place, expected, found)
    }
}

/// One file of samples, channels mapped and in SI units. All channels have the same length.
#[derive(Debug, Clone, PartialEq)]
pub struct RawRecording {
    /// File (and group in it) the samples come from, for messages.
    pub source: String,
    /// Sampling frequency, Hz.
    pub sampling_hz: f64,
    /// Motion as measured: vertical m, lateral m, torsion rad; a channel that was not recorded is empty.
    pub motion: [Vec<f64>; 3],
    /// For every cell of the rig, its six channels in the order of `CELL_CHANNELS`, local axes: N, N·m.
    pub cells: Vec<[Vec<f64>; 6]>,
    /// Wind speed, m/s; empty when there was no channel.
    pub wind_speed_m_s: Vec<f64>,
    /// Channels that were taken, as the file names them; empty where there is no file.
    pub channels: Vec<String>,
}

impl RawRecording {
    /// The same recording with every channel that was recorded changed by `change`.
    pub(super) fn map(&self, change: impl Fn(&[f64]) -> Vec<f64>) -> Self {
        let one = |x: &Vec<f64>| {
            if x.is_empty() { Vec::new() } else { change(x) }
        };
        Self {
            source: self.source.clone(),
            sampling_hz: self.sampling_hz,
            motion: self.motion.each_ref().map(one),
            cells: self.cells.iter().map(|c| c.each_ref().map(one)).collect(),
            wind_speed_m_s: one(&self.wind_speed_m_s),
            channels: self.channels.clone(),
        }
    }

    /// Number of samples.
    pub fn sample_count(&self) -> usize {
        self.cells.first().map_or(0, |c| c[0].len())
    }
}

/// One motion at one wind speed: in wind, and the same motion in still air.
#[derive(Debug, Clone, PartialEq)]
pub struct RawRun {
    /// Name of the run, for messages.
    pub name: String,
    /// What is said to move.
    pub motion: Vec<Dof>,
    /// Recording in wind.
    pub in_wind: RawRecording,
    /// Recording of the same motion in still air; `None` where the forces are those of the wind alone, without inertia,
    /// as those of a computation are.
    pub still_air: Option<RawRecording>,
    /// Mean wind speed, m/s: stated, or the mean of its channel.
    pub mean_speed_m_s: f64,
    /// Air density, kg/m³: stated, or from temperature and pressure.
    pub air_density_kg_m3: f64,
}

/// Every run of a campaign, with what they have in common and what is odd about them.
#[derive(Debug, Clone, PartialEq)]
pub struct RawCampaign {
    /// Name of the section.
    pub section: String,
    /// Where the data come from.
    pub source: String,
    /// Licence of the data.
    pub licence: String,
    /// The rig.
    pub rig: Rig,
    /// Forces that were measured or computed; `None` for all.
    pub forces: Option<Vec<Dof>>,
    /// The runs, in the order of the campaign file.
    pub runs: Vec<RawRun>,
    /// What did not stop reading.
    pub findings: Vec<RunFinding>,
}

impl RawCampaign {
    /// The findings of this weight in words.
    pub fn words(&self, severity: FindingSeverity) -> Vec<String> {
        let of_weight = self.findings.iter().filter(|f| f.severity == severity);
        of_weight.map(ToString::to_string).collect()
    }
}

/// Something that a user should look at.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunFinding {
    /// Name of the run; empty for the campaign file.
    pub run: String,
    /// Recording: `in wind` or `still air`; empty for the run as a whole.
    pub recording: String,
    /// Channel as the file names it, if one is meant.
    pub channel: Option<String>,
    /// First sample, from 0.
    pub sample: Option<usize>,
    /// Number of samples from there.
    pub samples: Option<usize>,
    /// How much it weighs: a doubt where what is stated and what is measured contradict each other.
    pub severity: FindingSeverity,
    /// What was found.
    pub what: String,
}

impl fmt::Display for RunFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.run.is_empty() {
            return write!(f, "{}", self.what);
        }
        write!(f, "run `{}`", self.run)?;
        if !self.recording.is_empty() {
            write!(f, ", {}", self.recording)?;
        }
        if let Some(channel) = &self.channel {
            write!(f, ", `{channel}`")?;
        }
        if let Some(sample) = self.sample {
            write!(f, ", sample {sample}")?;
        }
        write!(f, ": {}", self.what)
    }
}

impl RunFinding {
    /// About a run as a whole.
    pub(super) fn of_run(run: &str, severity: FindingSeverity, what: String) -> Self {
        Self {
            run: run.to_owned(),
            recording: String::new(),
            channel: None,
            sample: None,
            samples: None,
            severity,
            what,
        }
    }

    /// A note about a channel of a recording, of whose samples a stretch may be meant: the first, and how many.
    pub(super) fn of_channel(
        run: &str,
        recording: &str,
        channel: &str,
        stretch: Option<(usize, usize)>,
        what: String,
    ) -> Self {
        let (sample, samples) = stretch.unzip();
        Self {
            recording: recording.to_owned(),
            channel: Some(channel.to_owned()),
            sample,
            samples,
            ..Self::of_run(run, FindingSeverity::Note, what)
        }
    }
}
