//! Cases of whole bridges, and of a wing that is one.

use crate::aerodynamics::Transfer;
use crate::error::{Error, Result};
use crate::files::bridge::BridgeFile;
use crate::flutter::pk_onset;
use crate::study::bridge::BridgeStudy;
use std::path::PathBuf;

const GOLAND: &str = r#"
schema = 1
name = "Goland"
air_density_kg_m3 = 1.225
[modes]
format = "embedded"
path = "goland"
damping_ratio = 0.0
[[section]]
name = "wing"
width_m = 1.8288
derivatives = "flat plate"
[flutter]
speed_max_m_s = 200.0
speeds = 100
"#;

/// Onset (m/s) and circular frequency (rad/s) of Goland's wing.
pub(super) fn goland() -> Result<Vec<f64>> {
    let study = BridgeStudy::new(BridgeFile::from_toml(GOLAND, PathBuf::new())?)?;
    let bridge = study.by_table.as_ref();
    let bridge = bridge.ok_or_else(|| Error::input("derivatives", "the flat plate", "none"))?;
    let forces = bridge.forces();
    let range = forces.known_range();
    let found = pk_onset(
        "plate",
        &bridge.structure(),
        &forces,
        &study.search(),
        range,
    )?;
    let onset = found
        .onset()
        .ok_or_else(|| Error::Numerical(found.explain()))?;
    let omega = std::f64::consts::TAU * onset.at.frequency_hz;
    Ok(vec![onset.at.speed_m_s, omega])
}
