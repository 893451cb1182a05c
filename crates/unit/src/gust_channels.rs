//! Gusts on strips of a bridge as forces on its modes.
//!
//! Gust forces per unit length are quasi-steady, `½ρVB A (u, w)` (the moment with `B²`), so strip `s` gives mode `m`
//! `V Σ_{i in s} w_i φ_m(i)ᵀ ½ρp diag(B, B, B²) A (u_s, w_s)`. The admittance delays a gust by lags that follow with the wind and
//! the width of their strip: strips of one `p/B` share the lags of each mode, and their forces per 1 m/s of wind are a channel.

use crate::bridge::Bridge;
use crate::error::{Error, Result, counted, ensure};
use crate::section::Dof;

/// What the gusts of strips do to the mass-normalised modes, per 1 m/s of wind.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct GustChannels {
    /// Wind factor over width of each group of channels, 1/m; as many channels in a group as modes.
    pub convection_per_width: Vec<f64>,
    /// Force on each channel by a gust of 1 m/s: `u` of the first strip, `w` of the first strip, `u` of the second …
    pub by_gust: Vec<Vec<f64>>,
}

impl GustChannels {
    /// Of a bridge with the buffeting matrices `A` of its groups (rows vertical, lateral, rotation; columns `u`, `w`), where
    /// each of `strips` holds places of nodes in one gust. Nodes in no strip and in no group feel none.
    ///
    /// # Errors
    /// [`Error::Input`] for another number of matrices than of groups and for strips of nodes that are none or already taken.
    pub(crate) fn new(
        bridge: &Bridge,
        matrices: &[[[f64; 2]; 3]],
        strips: &[Vec<usize>],
    ) -> Result<Self> {
        ensure(
            matrices.len() == bridge.groups.len(),
            "gust forces",
            format_args!("coefficients of {}", counted(bridge.groups.len(), "group")),
            matrices.len(),
        )?;
        let strip_of_node = owners(bridge, strips)?;
        let modes = bridge.coordinates();
        let mut all = Self {
            convection_per_width: Vec::new(),
            by_gust: vec![Vec::new(); 2 * strips.len()],
        };
        for (group, matrix) in bridge.groups.iter().zip(matrices) {
            if group.wind_factor == 0.0 {
                continue;
            }
            let at = all.channel_of(group.wind_factor / group.width_m, modes);
            let pressure = 0.5 * bridge.air_density_kg_m3 * group.wind_factor;
            let scale = Dof::THREE.map(|dof| pressure * dof.force_scale(group.width_m));
            for &node in &group.nodes {
                let Some(strip) = strip_of_node[node] else {
                    continue;
                };
                let length = bridge.nodes[node].length_m;
                for (m, mode) in bridge.modes.iter().enumerate() {
                    let by_mass = length / mode.generalised_mass.sqrt();
                    for component in 0..2 {
                        let rows = mode.shape[node].iter().zip(matrix).zip(scale);
                        let work: f64 = rows.map(|((phi, a), s)| phi * s * a[component]).sum();
                        all.by_gust[2 * strip + component][at + m] += by_mass * work;
                    }
                }
            }
        }
        Ok(all)
    }

    /// First channel of the strips with this wind factor over width.
    fn channel_of(&mut self, convection_per_width: f64, modes: usize) -> usize {
        let mut known = self.convection_per_width.iter();
        let group = known.position(|p| *p == convection_per_width);
        let group = group.unwrap_or_else(|| {
            self.convection_per_width.push(convection_per_width);
            let groups = self.convection_per_width.len();
            let columns = self.by_gust.iter_mut();
            columns.for_each(|c| c.resize(groups * modes, 0.0));
            groups - 1
        });
        group * modes
    }

    /// Adds the forces of these gusts, m/s, to every channel.
    pub(crate) fn add(&self, gusts: impl Iterator<Item = f64>, channels: &mut [f64]) {
        for (gust, column) in gusts.zip(&self.by_gust).filter(|(gust, _)| *gust != 0.0) {
            for (channel, force) in channels.iter_mut().zip(column) {
                *channel += gust * force;
            }
        }
    }
}

/// Strip of every node.
fn owners(bridge: &Bridge, strips: &[Vec<usize>]) -> Result<Vec<Option<usize>>> {
    let mut owner = vec![None; bridge.nodes.len()];
    for (s, strip) in strips.iter().enumerate() {
        for &node in strip {
            let place = format!("gusts: strip {}", s + 1);
            let claimed = owner.get_mut(node).ok_or_else(|| {
                let expected = format!("nodes below {}", bridge.nodes.len());
                Error::input(&place, expected, node.to_string())
            })?;
            if let Some(other) = claimed.replace(s) {
                let (name, other) = (&bridge.nodes[node].name, other + 1);
                let found = format!("node {name} also in strip {other}");
                return Err(Error::input(place, "each node in one strip", found));
            }
        }
    }
    Ok(owner)
}
