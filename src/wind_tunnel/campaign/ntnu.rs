//! The layout of NTNU's tools as a channel map.
//!
//! One HDF5 group a run: `motion` (n, 3) lateral, vertical, torsion; `forces_global_coord` (n, 24), six channels for each
//! of four cells in fixed axes x downwind, y along the span, z up; `wind_velocity`, `air_density`, `temperature`; the
//! attribute `sampling frequency`. Cells of the rig take the columns in their order.

use super::channel_map::{CellChannel, ChannelMap, ChannelRef, cell_quantity};
use super::quantity::Quantity;
use crate::wind_tunnel::{CELL_CHANNELS, Rig};

/// Rotation from the laboratory's axes (x downwind, z up) to those used here (x downwind, y up), for `axes` of the
/// cells; these do not turn with the model.
pub(super) const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]];
/// Cells of the layout.
pub(super) const CELLS: usize = 4;

/// The map for the cells of `rig`, of which there are at most [`CELLS`].
pub(super) fn channel_map(rig: &Rig) -> ChannelMap {
    let motion = |column: usize, unit| Some(ChannelRef::new(format!("motion[{column}]"), unit));
    let cells = rig.cells.iter().enumerate().map(|(i, cell)| {
        let channel = |(k, key): (usize, &&str)| {
            let name = format!("forces_global_coord[{}]", 6 * i + k + 1);
            let unit = if cell_quantity(key) == Quantity::Force {
                "N"
            } else {
                "Nm"
            };
            let channel = CellChannel::Measured(ChannelRef::new(name, unit));
            ((*key).to_owned(), channel)
        };
        let channels = CELL_CHANNELS.iter().enumerate().map(channel).collect();
        (cell.name.clone(), channels)
    });
    ChannelMap {
        lateral: motion(1, "m"),
        vertical: motion(2, "m"),
        torsion: motion(3, "rad"),
        wind_speed: Some(ChannelRef::new("wind_velocity", "m/s")),
        cells: cells.collect(),
        ..ChannelMap::default()
    }
}
