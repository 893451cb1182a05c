//! The layout of NTNU's tools: as a channel map, and a virtual campaign as such a file.
//!
//! One HDF5 group per run: `motion` (n, 3) lateral, vertical, torsion; `forces_global_coord` (n, 24), six channels for each
//! of four cells in fixed axes x downwind, y along the span, z up; `wind_velocity`, `air_density`, `temperature`; the
//! attribute `sampling frequency`. Cells of the rig take the columns in their order.
//!
//! The file has all that the Python package `w3t` (MIT licence) opens: `Experiment.fromWTT` reads the attribute `sampling
//! frequency` and the datasets `temperature`, `air_density`, `wind_velocity`, `motion`, `forces_global_coord` and
//! `forces_global_coord_center` of a group; units and descriptions are those that its import of TDMS files writes.

use super::channel::ChannelRef;
use super::channel_map::{ChannelMap, cell_unit};
use crate::section::Dof;
use crate::wind_tunnel::virtual_campaign::VirtualCampaign;
use crate::wind_tunnel::{CELL_CHANNELS, LoadCell, RawRecording, Rig};
use hdf5_pure::{AttrValue, FileBuilder};
use nalgebra::{Matrix3, Vector3};

/// Rotation from the laboratory's axes (x downwind, z up) to those used here (x downwind, y up), for `axes` of the
/// cells; these do not turn with the model.
const AXES: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]];
/// Cells of the layout.
pub(super) const CELLS: usize = 4;
/// Forces with moments about the places of the cells, and about the centre.
const FORCES: &str = "forces_global_coord";
const CENTRE_FORCES: &str = "forces_global_coord_center";

/// The map for the cells of `rig`, of which there are at most [`CELLS`].
pub(super) fn channel_map(rig: &Rig) -> ChannelMap {
    let motion = |column: usize, unit| Some(ChannelRef::new(format!("motion[{column}]"), unit));
    let of_cell = |cell: usize, channel: usize| {
        let name = format!("{FORCES}[{}]", 6 * cell + channel + 1);
        ChannelRef::new(name, cell_unit(CELL_CHANNELS[channel]))
    };
    ChannelMap {
        lateral: motion(1, "m"),
        vertical: motion(2, "m"),
        torsion: motion(3, "rad"),
        wind_speed: Some(ChannelRef::new("wind_velocity", "m/s")),
        cells: ChannelMap::measured_cells(rig, of_cell),
        ..ChannelMap::default()
    }
}

/// Temperature at which dry air of the sea level has a density, °C: the plan states the density alone.
fn temperature_c(density_kg_m3: f64) -> f64 {
    101_325.0 / (287.058 * density_kg_m3) - 273.15
}

/// The same cells as the layout has them: fixed axes at the place of the cell at rest.
pub(super) fn rig(rig: &Rig) -> Rig {
    let fixed = |cell: &LoadCell| LoadCell {
        axes: AXES,
        turns_with_model: false,
        ..cell.clone()
    };
    Rig {
        cells: rig.cells.iter().map(fixed).collect(),
        ..rig.clone()
    }
}

/// Name, numbers, shape and units.
type Dataset<'a> = (&'a str, Vec<f64>, &'a [u64], &'a [&'a str]);

/// One group a recording: `RUN-wind` and `RUN-still`.
pub(super) fn build(made: &VirtualCampaign) -> FileBuilder {
    let rig = &made.raw.rig;
    let mut file = FileBuilder::new();
    for run in &made.raw.runs {
        let still = run.still_air.iter().map(|r| ("still", r));
        for (what, recording) in std::iter::once(("wind", &run.in_wind)).chain(still) {
            let text = |words: &str| AttrValue::VarLenString(words.to_owned());
            let mut group = file.create_group(&format!("{}-{what}", run.name));
            group.set_attr("test_type", text("Forced vibration"));
            group.set_attr("test operator", text("aerodeck, virtual campaign"));
            group.set_attr("sampling frequency", AttrValue::F64(recording.sampling_hz));
            group.set_attr("forced motion", text(&Dof::names(&run.motion)));
            let density = run.air_density_kg_m3;
            let (n, channels) = (recording.sample_count() as u64, 6 * CELLS as u64);
            let of_cells = &["N", "N", "N", "Nm", "Nm", "Nm"].repeat(CELLS)[..];
            let at_cells = |about_centre| forces(recording, rig, about_centre);
            let wind = recording.wind_speed_m_s.clone();
            let datasets: [Dataset<'_>; 6] = [
                ("temperature", vec![temperature_c(density)], &[], &["C"]),
                ("air_density", vec![density], &[], &["kg/m^3"]),
                ("wind_velocity", wind, &[n], &["m/s"]),
                ("motion", motion(recording), &[n, 3], &["m", "m", "rad"]),
                (FORCES, at_cells(false), &[n, channels], of_cells),
                (CENTRE_FORCES, at_cells(true), &[n, channels], of_cells),
            ];
            for (name, values, shape, units) in datasets {
                let units = units.iter().map(|u| (*u).to_owned()).collect();
                let dataset = group.create_dataset(name);
                dataset.with_f64_data(&values).with_shape(shape);
                dataset.set_attr("units", AttrValue::VarLenStringArray(units));
                if name == CENTRE_FORCES {
                    dataset.set_attr("eccentricity", AttrValue::F64Array(eccentricity(rig)));
                }
            }
            file.add_group(group.finish());
        }
    }
    file
}

/// Mean distance downwind of the first two and the last two cells from the centre of rotation, m.
fn eccentricity(rig: &Rig) -> Vec<f64> {
    let mean = |cells: &[LoadCell]| {
        let sum: f64 = cells.iter().map(|c| c.position_m[0]).sum();
        sum / cells.len().max(1) as f64
    };
    let (upwind, downwind) = rig.cells.split_at(rig.cells.len().min(2));
    vec![mean(upwind), mean(downwind)]
}

/// Rows of lateral, vertical, torsion.
fn motion(recording: &RawRecording) -> Vec<f64> {
    let [vertical, lateral, torsion] = &recording.motion;
    (0..recording.sample_count())
        .flat_map(|i| [lateral[i], vertical[i], torsion[i]])
        .collect()
}

/// Rows of the six channels of each cell in fixed axes. Moments are those about the place of the cell at rest, or `about_centre` of
/// rotation; along the span, as in the laboratory's own import, always about the place of the cell.
fn forces(recording: &RawRecording, rig: &Rig, about_centre: bool) -> Vec<f64> {
    let to_lab = Matrix3::from_fn(|i, j| AXES[j][i]);
    let mut rows = Vec::with_capacity(recording.sample_count() * 6 * CELLS);
    for i in 0..recording.sample_count() {
        let theta = recording.motion[Dof::Torsion as usize].get(i);
        let theta = theta.copied().unwrap_or(0.0);
        for (cell, channels) in rig.cells.iter().zip(&recording.cells) {
            let to_global = cell.axes_at(theta);
            let [fx, fy, fz, mx, my, mz] = channels;
            let force = to_global * Vector3::new(fx[i], fy[i], fz[i]);
            let [x, y, z] = cell.position_m;
            let origin = match about_centre {
                true => Vector3::new(0.0, 0.0, z),
                false => Vector3::new(x, y, z),
            };
            let arm = cell.position_at(theta) - origin;
            let moment = to_global * Vector3::new(mx[i], my[i], mz[i]) + arm.cross(&force);
            rows.extend((to_lab * force).iter());
            rows.extend((to_lab * moment).iter());
        }
        rows.resize((i + 1) * 6 * CELLS, 0.0);
    }
    rows
}
