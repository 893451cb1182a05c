//! Cases of whole bridges, and of a wing that is one.

use crate::aerodynamics::{FlatPlate, Transfer};
use crate::bridge::{Bridge, StripGroup};
use crate::error::{Error, Result};
use crate::files::bridge::embedded;
use crate::flutter::{OnsetSearch, pk_onset};
use std::sync::Arc;

/// Chord of Goland's wing, m.
const GOLAND_CHORD_M: f64 = 1.8288;

/// Goland's wing: modes of the embedded file, undamped as they stand there, strips of Theodorsen's plate along all of it.
fn goland_wing() -> Result<Bridge> {
    let modes = embedded::modes("goland")?;
    let wing = StripGroup {
        name: "wing".to_owned(),
        width_m: GOLAND_CHORD_M,
        wind_factor: 1.0,
        nodes: (0..modes.nodes.len()).collect(),
        forces: Arc::new(FlatPlate::default()),
    };
    Bridge::new("Goland", 1.225, modes.nodes, modes.modes, vec![wing])
}

/// Onset (m/s) and circular frequency (rad/s) of Goland's wing.
pub(super) fn goland() -> Result<Vec<f64>> {
    let wing = goland_wing()?;
    let forces = wing.forces();
    let range = forces.known_range();
    let search = OnsetSearch {
        speed_max_m_s: 200.0,
        speeds: 100,
    };
    let found = pk_onset("plate", &wing.structure(), &forces, &search, range)?;
    let onset = found
        .onset()
        .ok_or_else(|| Error::Numerical(found.explain()))?;
    let omega = std::f64::consts::TAU * onset.at.frequency_hz;
    Ok(vec![onset.at.speed_m_s, omega])
}
