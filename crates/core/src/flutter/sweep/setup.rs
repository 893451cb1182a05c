//! What a sweep starts from: the grid of reduced frequencies and the supports of one sample.

use super::pencil::Supports;
use crate::error::Result;
use crate::section::{Dof, SectionModel};

/// Highest reduced frequency: still air.
const K_STILL: f64 = 1000.0;
/// Below this reduced frequency the roots move: nearly still air.
pub(super) const K_MAX: f64 = 10.0;
/// Points of the grid for a factor e of `K`, above and below that.
const POINTS_PER_E: (f64, f64) = (3.0, 10.0);

/// Reduced frequencies from still air down to `k_min`, with the ends of the tested range among them.
pub(super) fn grid(k_min: f64, ends: impl Iterator<Item = f64>) -> Vec<f64> {
    let part = |from: f64, to: f64, points_per_e: f64| {
        let steps = (points_per_e * (from / to).ln()).ceil();
        (0..steps as usize).map(move |i| from * (to / from).powf(i as f64 / steps))
    };
    let mut grid: Vec<f64> = part(K_STILL, K_MAX, POINTS_PER_E.0)
        .chain(part(K_MAX, k_min, POINTS_PER_E.1))
        .chain([k_min])
        .chain(ends.filter(|k| (k_min..K_STILL).contains(k)))
        .collect();
    grid.sort_by(|a, b| b.total_cmp(a));
    grid.dedup();
    grid
}

/// Mass, damping, stiffness of the supports in units of the rotation. Does not allocate for values that are right.
pub(super) fn supports<const N: usize>(section: &SectionModel) -> Result<Supports<N>> {
    let usual = section.supports()?;
    let square = section.width_m * section.width_m;
    let mut s = Supports {
        width: section.width_m,
        density: section.air_density_kg_m3,
        mass: [0.0; N],
        damping: [0.0; N],
        stiffness: [0.0; N],
        // the row of heave in units of the rotation
        coupling: section.width_m * section.static_coupling(),
        axis: section.axis_offset_m.unwrap_or(0.0) / section.width_m,
    };
    let mut used = 0;
    for (dof, support) in Dof::THREE.into_iter().zip(usual) {
        let (Some(support), true) = (support, used < N) else {
            continue;
        };
        let scale = if dof == Dof::Torsion { 1.0 } else { square };
        s.mass[used] = scale * support.mass;
        s.damping[used] = scale * support.damping;
        s.stiffness[used] = scale * support.stiffness;
        used += 1;
    }
    Ok(s)
}
