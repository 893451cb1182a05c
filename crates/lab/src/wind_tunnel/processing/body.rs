//! What still air says of the model as a rigid body, against what a model can be and what the rig states.
//!
//! Of a body of mass m whose centre of gravity is `e` from the axis of rotation, heave shows m in the lift and `m e` in the moment,
//! rotation `I = m (r² + e²)` in the moment and `m e` in the lift. So `|e| < B` bounds the one, and `e/(r² + e²) ≤ 1/(2r)` with a
//! radius of gyration r of no less than `B/20` the other, whatever the model: beyond them the motion is not the one that its channel says.

use crate::error::{Result, ensure};
use crate::section::Dof;
use crate::wind_tunnel::{RawRecording, Rig};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// A stated mass may be off by this part, for screws and clamps, before it is said …
const SAME_BODY: f64 = 0.03;
/// … and by this part before nothing else can be right either: a channel that is lost or taken twice changes more.
const ANOTHER_BODY: f64 = 0.2;
/// Mass of air that moves with the model over that with a flat plate of its width, at most.
const AIR_OVER_PLATE: f64 = 1.5;
/// What else gives another inertia: forces count once in it, the motion and the square of the sampling rate divide it.
const WHAT_IS_WRONG: &str = "a load-cell channel is missing, taken twice, or in another unit, or the motion or the sampling rate is";
/// `1/(2r)` with `r = B/20`, times B.
const LEVER_OF_ROTATION: f64 = 10.0;
/// A sign is certain when the figure is this many standard errors from zero.
pub(super) const CERTAIN: f64 = 5.0;

/// Inertia of the model and lag of the force channels, from one still-air recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StillAirInertia {
    /// Degree of freedom that moved.
    pub dof: Dof,
    /// Lag of the force channels behind the motion, s.
    pub lag_s: f64,
    /// Standard error of the lag, s.
    pub lag_standard_error_s: f64,
    /// Inertia μ of the whole model in that degree of freedom: kg, kg·m².
    pub inertia: f64,
    /// Standard error of the inertia.
    pub inertia_standard_error: f64,
    /// Stiffness κ of gravity: N/m, N·m/rad; `None` where all runs of the motion have one frequency, which does not tell it from μ.
    pub stiffness: Option<f64>,
    /// Damping c in still air: N·s/m, N·m·s/rad; `None` likewise, since one frequency does not tell it from the lag.
    pub damping: Option<f64>,
    /// Place of the centre of mass from the axis, m: downwind of it in heave, above it in sway; `None` in rotation.
    #[serde(default)]
    pub centre_of_mass_m: Option<f64>,
}

impl StillAirInertia {
    /// The inertia with its standard error.
    fn in_words(&self, unit: &str) -> String {
        format!(
            "{:.4} ± {:.4} {unit}",
            self.inertia, self.inertia_standard_error
        )
    }

    /// Whether the inertia is no chance.
    pub(crate) fn is_certain(&self) -> bool {
        self.inertia.abs() > CERTAIN * self.inertia_standard_error
    }

    /// Whether the inertia holds what gravity does to the turning model.
    pub(super) fn hides_weight(&self) -> bool {
        self.dof == Dof::Torsion && self.stiffness.is_none()
    }

    /// Whether there is inertia enough to tell the lag to a fifth of a sample.
    pub(crate) fn tells_lag(&self, sampling_hz: f64) -> bool {
        self.lag_standard_error_s * sampling_hz < 0.2 && self.inertia > 0.0
    }
}

/// Refuses inertia in another force than a motion of `dof` can have: then rotation and a displacement are exchanged.
pub(super) fn check_motion(
    run: &str,
    rig: &Rig,
    own: &StillAirInertia,
    across: &StillAirInertia,
) -> Result<()> {
    let width = rig.model_width_m;
    let (there, besides) = (own.inertia.abs(), across.inertia.abs());
    let (exchanged, unit) = match (own.dof, across.dof) {
        (Dof::Torsion, _) => (besides * width > LEVER_OF_ROTATION * there, "kg·m²"),
        (_, Dof::Torsion) => (besides > width * there, "kg"),
        _ => return Ok(()),
    };
    let name = own.dof.name();
    ensure(
        !(exchanged && across.is_certain()),
        format_args!("run {run}, still air"),
        format_args!("inertia of the {name} motion mostly in the {name} force"),
        format_args!(
            "{:.4} {unit} there and {:.4} kg·m in the {} force, which no body has: the channels of rotation and displacement are \
             exchanged",
            own.inertia,
            across.inertia,
            across.dof.name()
        ),
    )
}

/// What the rig states of the inertia in `dof`: its key, value and unit.
fn stated(rig: &Rig, dof: Dof) -> (&'static str, Option<f64>, &'static str) {
    match dof {
        Dof::Torsion => ("rig.model_inertia_kg_m2", rig.model_inertia_kg_m2, "kg·m²"),
        _ => ("rig.model_mass_kg", rig.model_mass_kg, "kg"),
    }
}

/// Refuses a recording in still air of a model that moves in `dof` and pushes no cell.
pub(super) fn check_force(run: &str, rig: &Rig, still: &RawRecording, dof: Dof) -> Result<()> {
    let mut channels = still.cells.iter().flatten();
    let expected = match stated(rig, dof) {
        (key, Some(stated), unit) => format!("about the {stated:.4} {unit} that `{key}` states"),
        _ => "the inertia of the model".to_owned(),
    };
    let place = format_args!("run {run}, still air, {} motion", dof.name());
    let pushes = channels.any(|c| c.iter().any(|f| *f != c[0]));
    let found = "no force: no load-cell channel ever changes";
    ensure(pushes, place, expected, found)
}

/// Compares the inertia with that of the rig, if it states one: a doubt with the figures, or nothing.
pub(super) fn compare(
    run: &str,
    rig: &Rig,
    found: &StillAirInertia,
    air_density_kg_m3: f64,
) -> Result<Option<String>> {
    let (width, length) = (rig.model_width_m, rig.model_length_m);
    let (key, Some(stated), unit) = stated(rig, found.dof) else {
        return Ok(None);
    };
    if found.hides_weight() {
        return Ok(None);
    }
    let air = match found.dof {
        Dof::Torsion => PI / 128.0 * width.powi(4),
        _ => PI / 4.0 * width.powi(2),
    };
    // a real tunnel at rest adds the mass of the air that moves with the model
    let with_air = stated + AIR_OVER_PLATE * air * air_density_kg_m3 * length;
    let beyond = (stated - found.inertia).max(found.inertia - with_air);
    let error = 3.0 * found.inertia_standard_error;
    if beyond <= SAME_BODY * stated + error {
        return Ok(None);
    }
    let (name, times) = (found.dof.name(), found.inertia / stated);
    let shown = found.in_words(unit);
    ensure(
        beyond <= ANOTHER_BODY * stated + error,
        format_args!("run {run}, still air, {name} motion"),
        format_args!("about the {stated:.4} {unit} that `{key}` states"),
        format_args!("{shown}, {times:.4} times that: {WHAT_IS_WRONG}"),
    )?;
    let doubt =
        format!("still air shows {shown} in {name} motion, `{key}` states {stated:.4} {unit}");
    Ok(Some(doubt))
}

/// Compares the inertia of the runs in which `dof` moves, by their names, which is that of one model: the run with the lowest and
/// a doubt with the figures, or nothing.
pub(super) fn compare_runs(
    dof: Dof,
    mut runs: Vec<(&str, &StillAirInertia)>,
) -> Result<Option<(String, String)>> {
    runs.retain(|(_, found)| found.is_certain());
    runs.sort_by(|a, b| a.1.inertia.total_cmp(&b.1.inertia));
    let [(lowest, low), .., (highest, high)] = runs[..] else {
        return Ok(None);
    };
    let errors = [high, low].map(|found| found.inertia_standard_error);
    let error = 3.0 * errors[0].hypot(errors[1]);
    let apart = high.inertia - low.inertia;
    if apart <= SAME_BODY * high.inertia + error {
        return Ok(None);
    }
    let unit = if dof == Dof::Torsion { "kg·m²" } else { "kg" };
    let (name, times) = (dof.name(), high.inertia / low.inertia);
    let (most, least) = (high.in_words(unit), low.in_words(unit));
    let found = format!("{most} in run {highest}, {least} in run {lowest}");
    ensure(
        apart <= ANOTHER_BODY * high.inertia + error,
        format_args!("runs, still air, {name} motion"),
        "the inertia of one model in all of them",
        format_args!("{found}, {times:.4} times that: {WHAT_IS_WRONG}"),
    )?;
    let doubt = format!("still air shows another inertia in {name} motion: {found}");
    Ok(Some((lowest.to_owned(), doubt)))
}
