//! Mean and turbulent motion along the whole span, accelerations, and section forces, from the covariances of the modes.

use super::BridgeStudy;
use super::motion::static_deflection;
use crate::aerodynamics::Transfer;
use crate::bridge::Bridge;
use crate::buffeting::{FrequencyDomain, peak_factor, rms_of};
use crate::error::{Error, Result};
use crate::files::bridge::read_section_forces;
use crate::units::ReducedFrequency;
use nalgebra::DMatrix;
use serde::Serialize;
use std::f64::consts::TAU;
use std::path::Path;

/// Response of every node, girder order; vertical, lateral (m) and rotation (rad).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpanEnvelope {
    /// Places along the girder, m.
    pub along_m: Vec<f64>,
    /// Mean displacement by the static coefficients of the sections.
    pub mean: Vec<[f64; 3]>,
    /// Root mean square about the mean.
    pub rms: Vec<[f64; 3]>,
    /// Expected greatest departure from the mean in the length of a record, over the root mean square.
    pub peak_factor: Vec<[f64; 3]>,
    /// Root mean square of the accelerations, m/s², rad/s².
    pub acceleration_rms: Vec<[f64; 3]>,
    /// Section forces about their mean, where the file states those of the modes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub section_forces: Vec<SectionForceResponse>,
}

/// A section force in turbulence.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SectionForceResponse {
    /// The element.
    pub element: String,
    /// The force, as its column is named.
    pub force: String,
    /// Root mean square about the mean, in the unit of the column.
    pub rms: f64,
    /// Expected greatest departure from the mean over that.
    pub peak_factor: f64,
}

/// The envelope of the bridge that answers; `forces` is the file of the section forces of the modes.
pub(super) fn envelope(
    study: &BridgeStudy,
    domain: &FrequencyDomain<'_>,
    speed_m_s: f64,
    duration_s: f64,
    forces: Option<&Path>,
) -> Result<SpanEnvelope> {
    let covariances = domain.modal_covariances()?;
    let bridge = study.by_table.as_ref().unwrap_or(&study.by_model);
    let nodes: Vec<usize> = (0..bridge.nodes.len()).collect();
    let shapes = bridge.shapes_at(&nodes);
    let moved = |n: &usize| -> [[f64; 3]; 3] {
        std::array::from_fn(|i| {
            let row: Vec<f64> = shapes.row(3 * n + i).iter().copied().collect();
            rms_of(&covariances, &row)
        })
    };
    let rms: Vec<[[f64; 3]; 3]> = nodes.iter().map(moved).collect();
    let still = study.static_coefficients().unwrap_or_default();
    let at_rest = study.by_model.forces();
    let at_rest = at_rest.transfer(ReducedFrequency::from_full_width(0.0))?;
    let peaks = |r: &[[f64; 3]; 3]| r.map(|of| peak(of, duration_s));
    let section_forces = match forces {
        Some(path) => {
            let path = study.file.directory.join(path);
            section_forces(&path, bridge, &covariances, duration_s)?
        }
        None => Vec::new(),
    };
    Ok(SpanEnvelope {
        along_m: bridge.nodes.iter().map(|n| n.along_m).collect(),
        mean: static_deflection(&study.by_model, &still, &at_rest, speed_m_s)?,
        rms: rms.iter().map(|r| r.map(|of| of[0])).collect(),
        peak_factor: rms.iter().map(peaks).collect(),
        acceleration_rms: rms.iter().map(|r| r.map(|of| of[2])).collect(),
        section_forces,
    })
}

/// Of root mean squares of displacement, rate and acceleration.
fn peak(rms: [f64; 3], duration_s: f64) -> f64 {
    match rms[0] > 0.0 {
        true => peak_factor(rms[1] / rms[0] / TAU, duration_s),
        false => 0.0,
    }
}

fn section_forces(
    path: &Path,
    bridge: &Bridge,
    covariances: &[DMatrix<f64>; 3],
    duration_s: f64,
) -> Result<Vec<SectionForceResponse>> {
    let forces = read_section_forces(path)?;
    let mut all = Vec::new();
    for (element, by_mode) in &forces.elements {
        for (i, force) in forces.names.iter().enumerate() {
            let row = bridge.modes.iter().map(|m| {
                let stated = by_mode.get(&m.number).ok_or_else(|| {
                    let expected = format!("forces of mode {} in {element}", m.number);
                    Error::input("buffeting.section_forces", expected, "none").in_file(path)
                })?;
                Ok(stated[i] / m.generalised_mass.sqrt())
            });
            let rms = rms_of(covariances, &row.collect::<Result<Vec<f64>>>()?);
            all.push(SectionForceResponse {
                element: element.clone(),
                force: force.clone(),
                rms: rms[0],
                peak_factor: peak(rms, duration_s),
            });
        }
    }
    Ok(all)
}
