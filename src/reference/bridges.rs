//! Cases of whole bridges, and of a wing that is one.

use crate::aerodynamics::derivatives::{Extrapolation, InterpolatedTable, Interpolation};
use crate::aerodynamics::{FlatPlate, Transfer};
use crate::bridge::{Bridge, StripGroup};
use crate::error::{Error, Result};
use crate::files::bridge::embedded;
use crate::flutter::{CriticalPoint, OnsetSearch, pk_onset};
use crate::section::Dof;
use std::sync::Arc;

/// Chord of Goland's wing, m.
const GOLAND_CHORD_M: f64 = 1.8288;

/// Goland's wing: modes of the embedded file, undamped as they stand there, strips of Theodorsen's plate along all of it.
fn goland_wing() -> Result<Bridge> {
    let modes = embedded::modes("goland")?;
    let wing: StripGroup = StripGroup {
        name: "wing".to_owned(),
        width_m: GOLAND_CHORD_M,
        wind_factor: 1.0,
        nodes: (0..modes.nodes.len()).collect(),
        forces: Arc::new(FlatPlate::default()),
    };
    Bridge::new("Goland", 1.225, modes.nodes, modes.modes, vec![wing])
}

/// The suspension bridge of IABSE step 2a in `motions`. The test of the project that its data come from has the lateral axis
/// against the wind (`against_lateral`): motions as they are, rotation turned round, which is the same.
fn iabse_2a_bridge(motions: &[Dof], against_lateral: bool) -> Result<Bridge> {
    let mut modes = embedded::modes("iabse-2a")?;
    for mode in &mut modes.modes {
        mode.damping_ratio = 0.003;
        for [_, _, rotation] in &mut mode.shape {
            *rotation *= if against_lateral { -1.0 } else { 1.0 };
        }
    }
    let table = embedded::iabse_2a_derivatives()?;
    let by = Interpolation::LinearK;
    let forces = InterpolatedTable::by(by, &table, motions, Extrapolation::Hold)?;
    let girder: StripGroup = StripGroup {
        name: "girder".to_owned(),
        width_m: table.width_m,
        wind_factor: 1.0,
        nodes: (0..modes.nodes.len()).collect(),
        forces: Arc::new(forces),
    };
    Bridge::new("IABSE 2a", 1.22, modes.nodes, modes.modes, vec![girder])
}

/// Onset of a bridge by the p-k iteration up to this wind speed, m/s.
fn onset(bridge: &Bridge, speed_max_m_s: f64) -> Result<CriticalPoint> {
    let forces = bridge.forces();
    let range = forces.known_range();
    let search = OnsetSearch::new(speed_max_m_s, 100);
    let found = pk_onset("reference", &bridge.structure(), &forces, &search, range)?;
    let onset = found.onset().map(|onset| onset.at.clone());
    onset.ok_or_else(|| Error::Numerical(found.explain()))
}

/// Onset (m/s) and circular frequency (rad/s) of Goland's wing.
pub(super) fn goland() -> Result<Vec<f64>> {
    let at = onset(&goland_wing()?, 200.0)?;
    Ok(vec![at.speed_m_s, std::f64::consts::TAU * at.frequency_hz])
}

/// Onsets of the bridge of IABSE step 2a (m/s, Hz): two motions; three; three with the lateral axis against the wind.
pub(super) fn iabse_2a() -> Result<Vec<f64>> {
    let two = onset(&iabse_2a_bridge(&Dof::TWO, false)?, 100.0)?;
    let three = onset(&iabse_2a_bridge(&Dof::THREE, false)?, 100.0)?;
    let against = onset(&iabse_2a_bridge(&Dof::THREE, true)?, 100.0)?;
    let (speed, frequency) = (against.speed_m_s, against.frequency_hz);
    Ok(vec![
        two.speed_m_s,
        two.frequency_hz,
        three.speed_m_s,
        speed,
        frequency,
    ])
}

/// Onset of the bridge of IABSE step 2a with the lateral axis against the wind, m/s.
pub(super) fn iabse_2a_against_lateral() -> Result<Vec<f64>> {
    let bridge = iabse_2a_bridge(&Dof::THREE, true)?;
    Ok(vec![onset(&bridge, 100.0)?.speed_m_s])
}
