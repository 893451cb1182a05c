//! The load cells: from their own axes to global ones, their moments about the centre of rotation, and their sum.
//!
//! `v_global = R(θ) A v_local` with the mounting `A` of the cell; a cell behind the actuator turns with the model, and
//! `R(θ)` is a turn of θ nose-up, that is of −θ about z. So the weight of the model, which a turning cell sees swing by
//! `θ W` from one channel to another, is constant again.
//!
//! `F = Σ f_i`, `M = Σ (m_i + p_i × f_i)` with the place `p_i` of cell i, which turns with the model when the cell does. What
//! clamping does to one cell it does oppositely to the others (3.1): it falls out of the sums. Lift is `F_y`, drag `F_x`, the
//! nose-up moment `−M_z`.

use crate::signal::mean;
use crate::wind_tunnel::{LoadCell, RawRecording, Rig};
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
pub(crate) fn sum_about_centre(
    cells: &[GlobalCell],
    rig: &Rig,
    rotation_rad: &[f64],
) -> [Vec<f64>; 3] {
    let count = cells.first().map_or(0, |c| c[0].len());
    let mut sum: [Vec<f64>; 3] = std::array::from_fn(|_| vec![0.0; count]);
    for (place, cell) in rig.cells.iter().zip(cells) {
        for (sum, force) in sum.iter_mut().zip(about_centre(cell, place, rotation_rad)) {
            sum.iter_mut().zip(force).for_each(|(s, f)| *s += f);
        }
    }
    sum
}

/// Of one cell: lift (N), drag (N) and nose-up moment about the centre of rotation (N·m).
pub(crate) fn about_centre(
    cell: &GlobalCell,
    place: &LoadCell,
    rotation_rad: &[f64],
) -> [Vec<f64>; 3] {
    let mut moved = cell.clone();
    move_moment(&mut moved, place, rotation_rad, 1.0);
    let [drag, lift, _, _, _, mut moment] = moved;
    moment.iter_mut().for_each(|m| *m = -*m);
    [lift, drag, moment]
}

/// Means of every cell, for the report.
pub(crate) fn shares(cells: &[GlobalCell], rig: &Rig) -> Vec<CellShare> {
    let share = |(place, cell): (&LoadCell, &GlobalCell)| CellShare {
        cell: place.name.clone(),
        mean_force_n: std::array::from_fn(|i| mean(&cell[i])),
        mean_moment_n_m: std::array::from_fn(|i| mean(&cell[3 + i])),
    };
    rig.cells.iter().zip(cells).map(share).collect()
}

/// Force (x, y, z) and moment (x, y, z) at a cell in global axes: N, N·m.
pub(crate) type GlobalCell = [Vec<f64>; 6];

/// All cells of a recording in global axes; `rotation_rad` is the rotation of the model at each sample.
pub(crate) fn to_global(
    recording: &RawRecording,
    rig: &Rig,
    rotation_rad: &[f64],
) -> Vec<GlobalCell> {
    let turn = |(cell, channels): (&LoadCell, &[Vec<f64>; 6])| {
        let mut global: GlobalCell =
            std::array::from_fn(|_| Vec::with_capacity(recording.sample_count()));
        let samples = channels.iter().map(Vec::len).min().unwrap_or(0);
        let local =
            |k: usize, triple: usize| nalgebra::Vector3::from_fn(|i, _| channels[triple + i][k]);
        for k in 0..samples {
            let axes = cell.axes_at(rotation_rad.get(k).copied().unwrap_or(0.0));
            for triple in [0, 3] {
                let v = axes * local(k, triple);
                for i in 0..3 {
                    global[triple + i].push(v[i]);
                }
            }
        }
        global
    };
    rig.cells.iter().zip(&recording.cells).map(turn).collect()
}

/// Moves the moments of a cell by `sign` times its arm from the centre of rotation: `m ± p × f`.
pub(crate) fn move_moment(
    global: &mut GlobalCell,
    cell: &LoadCell,
    rotation_rad: &[f64],
    sign: f64,
) {
    for k in 0..global[0].len() {
        let arm = cell.position_at(rotation_rad.get(k).copied().unwrap_or(0.0));
        let force = nalgebra::Vector3::from_fn(|i, _| global[i][k]);
        let added = arm.cross(&force) * sign;
        for i in 0..3 {
            global[3 + i][k] += added[i];
        }
    }
}

/// Back to the axes of a cell of a model at rest.
pub(crate) fn to_cell_at_rest(global: &GlobalCell, cell: &LoadCell) -> GlobalCell {
    let back = cell.axes_at(0.0).transpose();
    std::array::from_fn(|c| {
        let (triple, row) = (c / 3 * 3, c % 3);
        (0..global[0].len())
            .map(|k| (0..3).map(|i| back[(row, i)] * global[triple + i][k]).sum())
            .collect()
    })
}
