//! What a whole bridge does at an onset, the modes that take part and the motion of every node, and where steady wind holds it.

use crate::aerodynamics::{Transfer, TransferMatrix};
use crate::bridge::{Bridge, BridgeMode, Node};
use crate::error::{Error, Result};
use crate::flutter::{CriticalPoint, ModeRatio, modal_shape};
use nalgebra::{Complex, DVector};
use serde::{Deserialize, Serialize};

/// A mode in the motion at an onset.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModeShare {
    /// Number of the mode.
    pub mode: usize,
    /// Its natural frequency, Hz.
    pub frequency_hz: f64,
    /// Its share of the kinetic energy.
    pub energy_share: f64,
    /// Phase of its coordinate to that of the mode with the largest share, degrees in (−180, 180].
    pub phase_deg: f64,
}

/// The motion of a node: displacement is the real part of the complex number times `e^{iωt}`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NodeMotion {
    /// Name of the node.
    pub node: String,
    /// Place along the girder, m.
    pub along_m: f64,
    /// Vertical, lateral and rotation: real and imaginary part each, the greatest of vertical, lateral and half the width times
    /// rotation being 1.
    pub motion: [[f64; 2]; 3],
}

/// The motion at an onset.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BridgeMotion {
    /// Modes by falling share of the kinetic energy.
    pub modes: Vec<ModeShare>,
    /// Nodes in the order of the girder.
    pub nodes: Vec<NodeMotion>,
}

impl BridgeMotion {
    /// Heave over rotation where the girder turns most.
    pub fn mode_ratio(&self, width_m: f64) -> Option<ModeRatio> {
        let [heave, _, rotation] = self.turning_most()?;
        ModeRatio::new(heave, rotation * width_m)
    }

    /// The motion of the node that turns most.
    pub(crate) fn turning_most(&self) -> Option<[Complex<f64>; 3]> {
        let complex = |n: &NodeMotion| n.motion.map(|[re, im]| Complex::new(re, im));
        let nodes = self.nodes.iter().map(complex);
        nodes.max_by(|a, b| a[2].norm().total_cmp(&b[2].norm()))
    }
}

/// The motion that the impedance of `forces` (of [`Bridge::forces`]) at an onset resists least.
///
/// # Errors
/// [`Error::Input`] for forces that say nothing at its reduced frequency; [`Error::Numerical`] when there is no such
/// motion.
pub fn motion_at_onset(
    bridge: &Bridge,
    forces: &dyn Transfer,
    at: &CriticalPoint,
) -> Result<BridgeMotion> {
    let shape = modal_shape(bridge, forces, at)?;
    Ok(BridgeMotion {
        modes: shares(bridge, &shape),
        nodes: nodes(bridge, &shape),
    })
}

fn shares(bridge: &Bridge, shape: &DVector<Complex<f64>>) -> Vec<ModeShare> {
    let total = shape.norm_squared();
    let of_modes = shape.rows(0, bridge.modes.len());
    let largest = of_modes[of_modes.icamax()];
    let share = |(mode, z): (&BridgeMode, &Complex<f64>)| ModeShare {
        mode: mode.number,
        frequency_hz: mode.frequency_hz,
        energy_share: z.norm_sqr() / total,
        phase_deg: (z / largest).arg().to_degrees(),
    };
    let mut shares: Vec<ModeShare> = bridge.modes.iter().zip(shape).map(share).collect();
    shares.sort_by(|a, b| b.energy_share.total_cmp(&a.energy_share));
    shares
}

fn nodes(bridge: &Bridge, shape: &DVector<Complex<f64>>) -> Vec<NodeMotion> {
    let half_width = 0.5 * bridge.width_m();
    let at = |n: usize| -> [Complex<f64>; 3] {
        std::array::from_fn(|i| {
            let modes = bridge.modes.iter().zip(shape);
            modes
                .map(|(m, z)| z * (m.shape[n][i] / m.generalised_mass.sqrt()))
                .sum()
        })
    };
    let all: Vec<[Complex<f64>; 3]> = (0..bridge.nodes.len()).map(at).collect();
    let in_metres = all.iter().flat_map(|[y, x, t]| [*y, *x, t * half_width]);
    let greater = |a: Complex<f64>, b: Complex<f64>| if b.norm() > a.norm() { b } else { a };
    let greatest = in_metres.fold(Complex::default(), greater);
    let motion = |(node, z): (&Node, &[Complex<f64>; 3])| NodeMotion {
        node: node.name.clone(),
        along_m: node.along_m,
        motion: z.map(|z| z / greatest).map(|z| [z.re, z.im]),
    };
    bridge.nodes.iter().zip(&all).map(motion).collect()
}

/// Mean displacement of every node (m, m, rad) under steady wind, on which the forces of the deformed bridge act too.
///
/// `coefficients` are `(C_L, C_D, C_M)` of each group over its width; `static_forces` are the forces of unit modal coordinates
/// at rest, `G(0)` of [`Bridge::forces`].
///
/// # Errors
/// [`Error::Numerical`] at the speed of divergence.
pub fn static_deflection(
    bridge: &Bridge,
    coefficients: &[[f64; 3]],
    static_forces: &TransferMatrix,
    speed_m_s: f64,
) -> Result<Vec<[f64; 3]>> {
    let s = bridge.structure();
    let pressure = 0.5 * s.air_density_kg_m3 * speed_m_s * speed_m_s;
    let mut load = DVector::zeros(bridge.coordinates());
    for (group, c) in bridge.groups.iter().zip(coefficients) {
        let q = pressure * group.wind_factor * group.wind_factor * group.width_m;
        let force = [c[0] * q, c[1] * q, c[2] * q * group.width_m];
        for &n in &group.nodes {
            for (l, m) in load.iter_mut().zip(&bridge.modes) {
                let work: f64 = m.shape[n].iter().zip(force).map(|(phi, f)| phi * f).sum();
                *l += bridge.nodes[n].length_m * work / m.generalised_mass.sqrt();
            }
        }
    }
    let stiffness = &s.stiffness - s.to_physical(&static_forces.map(|z| z.re)) * pressure;
    let eta = stiffness.lu().solve(&load).ok_or_else(|| {
        Error::Numerical(format!(
            "static deflection: the bridge diverges at {speed_m_s} m/s"
        ))
    })?;
    let at = |n: usize| {
        std::array::from_fn(|i| {
            let modes = bridge.modes.iter().zip(&eta);
            modes
                .map(|(m, z)| z * m.shape[n][i] / m.generalised_mass.sqrt())
                .sum()
        })
    };
    Ok((0..bridge.nodes.len()).map(at).collect())
}
