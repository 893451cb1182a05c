//! Moments moved to the centre of rotation, and the sum of the cells.
//!
//! `F = Σ f_i`, `M = Σ (m_i + p_i × f_i)` with the place `p_i` of cell i, which turns with the model when the cell does. What
//! clamping does to one cell it does oppositely to the others (3.1): it falls out of the sums. Lift is `F_y`, drag `F_x`, the
//! nose-up moment `−M_z`.

use super::axes::{GlobalCell, move_moment};
use crate::wind_tunnel::Rig;
use serde::{Deserialize, Serialize};

/// What one cell carries at rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CellShare {
    /// Name of the cell.
    pub cell: String,
    /// Mean force over the recording, global axes, N.
    pub mean_force_n: [f64; 3],
    /// Mean moment at the cell, global axes, N·m.
    pub mean_moment_n_m: [f64; 3],
}

/// Lift (N), drag (N) and nose-up moment about the centre of rotation (N·m) on all cells together.
pub fn sum_about_centre(cells: &[GlobalCell], rig: &Rig, rotation_rad: &[f64]) -> [Vec<f64>; 3] {
    let count = cells.first().map_or(0, |c| c[0].len());
    let mut sum: [Vec<f64>; 3] = std::array::from_fn(|_| vec![0.0; count]);
    for (place, cell) in rig.cells.iter().zip(cells) {
        let mut about_centre = cell.clone();
        move_moment(&mut about_centre, place, rotation_rad, 1.0);
        for k in 0..count {
            sum[0][k] += about_centre[1][k];
            sum[1][k] += about_centre[0][k];
            sum[2][k] -= about_centre[5][k];
        }
    }
    sum
}

/// Means of every cell, for the report.
pub fn shares(cells: &[GlobalCell], rig: &Rig) -> Vec<CellShare> {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len().max(1) as f64;
    rig.cells
        .iter()
        .zip(cells)
        .map(|(place, cell)| CellShare {
            cell: place.name.clone(),
            mean_force_n: std::array::from_fn(|i| mean(&cell[i])),
            mean_moment_n_m: std::array::from_fn(|i| mean(&cell[3 + i])),
        })
        .collect()
}
