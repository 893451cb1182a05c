//! What a virtual campaign consists of, every part of which can be switched off, and the truth behind it.

use crate::error::{Error, Result, ensure, non_negative, positive};
use crate::section::Dof;
use crate::wind_tunnel::{LoadCell, Rig, TunnelPlan};
use serde::{Deserialize, Serialize};

/// A raw campaign to be made. The default has the rig and the model of a plausible test in laminar flow without
/// disturbances; [`VirtualCampaignPlan::realistic`] has them too.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct VirtualCampaignPlan {
    /// Motions, speeds, sampling. Its noise is that of the sum of the cells about the centre of rotation, as a
    /// fraction of the RMS of the self-excited force of the run, in wind and in still air alike.
    pub tunnel: TunnelPlan,
    /// How the model is held.
    pub support: Support,
    /// Mass of the model.
    pub model: ModelBody,
    /// Steady aerodynamic coefficients.
    pub static_wind: StaticWind,
    /// Turbulence of the flow; left out, laminar.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turbulence: Option<TunnelTurbulence>,
    /// What measurement adds.
    pub disturbances: Disturbances,
}

/// Two load cells and what they have to hold besides the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Support {
    /// Length of the model, m.
    pub model_length_m: f64,
    /// The two cells.
    pub cells: Vec<LoadCell>,
    /// Part of all forces and of the moments left over that the first cell carries; the second has the rest.
    pub share_of_first: f64,
    /// Clamping force on the first cell, global axes, N; the second has its opposite.
    pub clamping_n: [f64; 3],
    /// Clamping moment on the first cell, global axes, N·m; the second has its opposite.
    pub clamping_n_m: [f64; 3],
}

/// Rigid body of the model, per unit length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ModelBody {
    /// Mass, kg/m; 0 for none (no gravity and no inertia).
    pub mass_kg_m: f64,
    /// Moment of inertia about the centre of gravity, kg·m²/m.
    pub inertia_kg_m2_m: f64,
    /// Centre of gravity relative to the centre of rotation, model at rest, global axes, m.
    pub centre_of_gravity_m: [f64; 3],
    /// Acceleration of gravity, m/s²; 0 for none.
    pub gravity_m_s2: f64,
}

/// Steady coefficients `F/(½ρV²B)`, `M/(½ρV²B²)` at the mean angle, and slopes per radian of nose-up angle of attack.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StaticWind {
    /// Drag.
    pub drag: f64,
    /// Lift.
    pub lift: f64,
    /// Moment.
    pub moment: f64,
    /// Slope of the drag, 1/rad; used for buffeting only.
    pub drag_slope: f64,
    /// Slope of the lift, 1/rad; used for buffeting only.
    pub lift_slope: f64,
    /// Slope of the moment, 1/rad; used for buffeting only.
    pub moment_slope: f64,
}

/// Gusts: first-order coloured noise, one value for the whole span.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TunnelTurbulence {
    /// Standard deviation of the downwind gust over the mean speed.
    pub intensity_u: f64,
    /// Standard deviation of the vertical gust over the mean speed.
    pub intensity_w: f64,
    /// Integral length of both, m; the correlation falls as `exp(−V|τ|/length)`.
    pub length_m: f64,
}

/// What measurement adds to the physics. All zero or none by default.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Disturbances {
    /// Slow drift of the force channels of each cell over a recording, N: each channel draws a rise of up to this
    /// and half a wave of up to half of this, of either sign.
    pub drift_n: f64,
    /// The same for the moment channels, N·m.
    pub drift_n_m: f64,
    /// Force channels are late by this against the motion, s; negative: early.
    pub force_lag_s: f64,
    /// The still-air recording is late by this against the one in wind, s; negative: early.
    pub still_air_offset_s: f64,
    /// White noise of the wind-speed channel, m/s.
    pub speed_noise_m_s: f64,
    /// A spike in the recordings in wind.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spike: Option<Spike>,
}

/// A short knock on the model in every recording in wind, as the one that spoilt the peak metric at 0.5 Hz in the
/// thesis (sections 3.5.2 and 3.5.6): half a sine wave, on all three self-excited components.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spike {
    /// It stands in the middle of the segment whose frequency is nearest to this, Hz.
    pub frequency_hz: f64,
    /// Height over the largest self-excited force of the segment.
    pub height: f64,
    /// Duration, s.
    pub duration_s: f64,
}

/// One entry of the transfer matrix at one test point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TruthPoint {
    /// Name of the run.
    pub run: String,
    /// Frequency of motion, Hz.
    pub frequency_hz: f64,
    /// Reduced frequency `K = ωB/V`.
    pub k: f64,
    /// Force: row of `G`.
    pub force: Dof,
    /// Motion: column of `G`.
    pub motion: Dof,
    /// Real part of the entry.
    pub real: f64,
    /// Imaginary part of the entry.
    pub imaginary: f64,
}

/// What was applied to one run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AppliedDisturbances {
    /// Name of the run.
    pub run: String,
    /// Mean load of the wind on the whole model: drag N, lift N, nose-up moment N·m.
    pub static_wind: [f64; 3],
    /// Standard deviation of the noise of the sum of the cells: drag N, lift N, nose-up moment about the centre of
    /// rotation N·m.
    pub noise: [f64; 3],
    /// Force channels are late by this against the motion, s.
    pub force_lag_s: f64,
    /// The still-air recording is late by this against the one in wind, s.
    pub still_air_offset_s: f64,
    /// The spike in wind.
    pub spike: Option<AppliedSpike>,
}

/// Where a spike stands.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AppliedSpike {
    /// First sample that differs.
    pub first: usize,
    /// Number of samples that differ.
    pub samples: usize,
    /// Greatest height on the whole model: drag N, lift N, nose-up moment N·m.
    pub height: [f64; 3],
}

impl Default for Support {
    fn default() -> Self {
        let cell = |name: &str, axes, position_m| LoadCell {
            name: name.to_owned(),
            axes,
            position_m,
            turns_with_model: true,
        };
        // x of either cell points along ±y, z outwards; mounted a little off the axis of rotation
        let near = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]];
        let far = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        Self {
            model_length_m: 2.68,
            cells: vec![
                cell("near", near, [0.012, -0.035, -1.40]),
                cell("far", far, [-0.006, -0.035, 1.40]),
            ],
            share_of_first: 0.56,
            clamping_n: [3.0, -5.0, 12.0],
            clamping_n_m: [0.6, -0.4, 0.25],
        }
    }
}

impl Default for ModelBody {
    fn default() -> Self {
        Self {
            mass_kg_m: 2.0,
            inertia_kg_m2_m: 0.04,
            centre_of_gravity_m: [0.004, -0.010, 0.05],
            gravity_m_s2: 9.81,
        }
    }
}

impl Default for StaticWind {
    fn default() -> Self {
        Self {
            drag: 0.08,
            lift: -0.12,
            moment: 0.02,
            drag_slope: 0.05,
            lift_slope: 4.4,
            moment_slope: 1.1,
        }
    }
}

impl VirtualCampaignPlan {
    /// The default with 5 % noise and every disturbance at a level that a careful laboratory meets: a lag of a third and an offset of
    /// two and a half samples at 200 Hz, a spike in the segment at 0.5 Hz.
    pub fn realistic() -> Self {
        let spike = Spike {
            frequency_hz: 0.5,
            height: 4.0,
            duration_s: 0.06,
        };
        let mut plan = Self {
            disturbances: Disturbances {
                drift_n: 0.3,
                drift_n_m: 0.03,
                force_lag_s: 0.0017,
                still_air_offset_s: 0.0123,
                speed_noise_m_s: 0.05,
                spike: Some(spike),
            },
            ..Self::default()
        };
        plan.tunnel.noise_fraction = 0.05;
        plan
    }

    /// The rig for a model of `width_m`, with the mass and inertia of the model as a laboratory would state them.
    pub(super) fn rig(&self, width_m: f64) -> Rig {
        let (body, length) = (&self.model, self.support.model_length_m);
        let [x, y, _] = body.centre_of_gravity_m;
        let about_rotation = body.inertia_kg_m2_m + body.mass_kg_m * (x * x + y * y);
        let stated = |value: f64| (value > 0.0).then_some(value * length);
        Rig {
            model_mass_kg: stated(body.mass_kg_m),
            model_inertia_kg_m2: stated(about_rotation),
            centre_of_mass_m: (body.mass_kg_m > 0.0).then_some(body.centre_of_gravity_m),
            ..self.support.rig(width_m)
        }
    }

    /// Checks that the plan can be carried out.
    pub fn validate(&self) -> Result<()> {
        self.tunnel.validate()?;
        self.support.validate()?;
        let body = &self.model;
        non_negative("model.mass_kg_m", body.mass_kg_m)?;
        non_negative("model.inertia_kg_m2_m", body.inertia_kg_m2_m)?;
        non_negative("model.gravity_m_s2", body.gravity_m_s2)?;
        finite("model.centre_of_gravity_m", &body.centre_of_gravity_m)?;
        let s = &self.static_wind;
        finite("static_wind", &[s.drag, s.lift, s.moment])?;
        finite("static_wind", &[s.drag_slope, s.lift_slope, s.moment_slope])?;
        if let Some(t) = &self.turbulence {
            non_negative("turbulence.intensity_u", t.intensity_u)?;
            non_negative("turbulence.intensity_w", t.intensity_w)?;
            positive("turbulence.length_m", t.length_m)?;
        }
        self.validate_disturbances()
    }

    fn validate_disturbances(&self) -> Result<()> {
        let d = &self.disturbances;
        non_negative("disturbances.drift_n", d.drift_n)?;
        non_negative("disturbances.drift_n_m", d.drift_n_m)?;
        non_negative("disturbances.speed_noise_m_s", d.speed_noise_m_s)?;
        for (key, value) in [
            ("disturbances.force_lag_s", d.force_lag_s),
            ("disturbances.still_air_offset_s", d.still_air_offset_s),
        ] {
            let limit = self.tunnel.still_s.min(self.tunnel.ramp_s) / 2.0;
            let expected =
                format_args!("at most half of tunnel.still_s and tunnel.ramp_s ({limit} s)");
            ensure(value.abs() <= limit, key, expected, value)?;
        }
        if let Some(spike) = &d.spike {
            positive("disturbances.spike.frequency_hz", spike.frequency_hz)?;
            positive("disturbances.spike.duration_s", spike.duration_s)?;
            finite("disturbances.spike.height", &[spike.height])?;
        }
        Ok(())
    }

    /// Reads and checks a plan; what it does not state is as in [`VirtualCampaignPlan::default`].
    ///
    /// # Errors
    /// [`Error::Io`] when it cannot be read; [`Error::Input`] with file and line for everything that is wrong in it.
    pub fn read(path: impl AsRef<std::path::Path>) -> Result<Self> {
        crate::files::toml_lines::read(path.as_ref(), |text, _| Self::from_toml(text))
    }

    /// Reads and checks the text of a plan.
    pub(crate) fn from_toml(text: &str) -> Result<Self> {
        crate::files::toml_lines::parse("a plan of a virtual campaign", text, |plan: &mut Self| {
            plan.validate()
        })
    }

    /// The plan as the text of a file.
    pub fn to_toml(&self) -> Result<String> {
        toml::to_string(self).map_err(|e| Error::Numerical(e.to_string()))
    }
}

impl Support {
    /// The rig for a model of `width_m`.
    pub(super) fn rig(&self, width_m: f64) -> Rig {
        Rig {
            model_length_m: self.model_length_m,
            model_width_m: width_m,
            cells: self.cells.clone(),
            ..Rig::default()
        }
    }

    fn validate(&self) -> Result<()> {
        let cells = self.cells.len();
        ensure(cells == 2, "support.cells", "two load cells", cells)?;
        // the width is the deck's and checked with it
        self.rig(1.0).validate()?;
        finite("support.share_of_first", &[self.share_of_first])?;
        finite("support.clamping_n", &self.clamping_n)?;
        finite("support.clamping_n_m", &self.clamping_n_m)
    }
}

fn finite(key: &str, values: &[f64]) -> Result<()> {
    let check = |x: &f64| ensure(x.is_finite(), key, "finite numbers", x);
    values.iter().try_for_each(check)
}
