//! Our folder of three tables: `nodes.csv`, `modes.csv`, `shapes.csv`.
//!
//! - `nodes.csv`: `node,x_m,y_m,z_m`, one row per node in the order of the girder;
//! - `modes.csv`: `mode,frequency_hz,generalised_mass_kg`;
//! - `shapes.csv`: `mode,node,ux,uy,uz,rx,ry,rz`, displacements (m) and rotations (rad) along and about the axes of the nodes.
//!
//! Lines that begin with `#` are comments; columns stand in any order and others are ignored.

use super::modal_data::{ModalData, RawMode};
use super::table::Table;
use crate::error::{Error, Place, Result};
use std::collections::HashMap;
use std::path::Path;

const NODES: &str = "nodes.csv";
const MODES: &str = "modes.csv";
const SHAPES: &str = "shapes.csv";

/// Reads the folder.
pub(super) fn read(folder: &Path) -> Result<ModalData> {
    let path = folder.join(NODES);
    let nodes = nodes(&Table::read(&path)?).map_err(|e| e.in_file(&path))?;
    let path = folder.join(MODES);
    let mut modes = modes(&Table::read(&path)?, nodes.len()).map_err(|e| e.in_file(&path))?;
    let path = folder.join(SHAPES);
    fill(&Table::read(&path)?, &nodes, &mut modes).map_err(|e| e.in_file(&path))?;
    Ok(ModalData { nodes, modes })
}

/// Nodes with their places.
pub(super) fn nodes(table: &Table) -> Result<Vec<(String, [f64; 3])>> {
    let node = table.required(&["node", "tag", "label"])?;
    let x = table.required(&["x_m", "x"])?;
    let y = table.required(&["y_m", "y"])?;
    let z = table.required(&["z_m", "z"])?;
    let one = |row: &(usize, Vec<String>)| {
        let at = [
            Table::number(row, x)?,
            Table::number(row, y)?,
            Table::number(row, z)?,
        ];
        Ok((Table::name(row, node), at))
    };
    let nodes: Vec<(String, [f64; 3])> = table.rows.iter().map(one).collect::<Result<_>>()?;
    for (i, (name, _)) in nodes.iter().enumerate() {
        if nodes[..i].iter().any(|n| n.0 == *name) {
            let place = Place::line(table.rows[i].0);
            return Err(Error::input(
                place,
                "each node once",
                format!("node {name} twice"),
            ));
        }
    }
    Ok(nodes)
}

fn modes(table: &Table, nodes: usize) -> Result<Vec<RawMode>> {
    let mode = table.required(&["mode"])?;
    let frequency = table.required(&["frequency_hz"])?;
    let mass = table.required(&["generalised_mass_kg", "generalised_mass"])?;
    let one = |row: &(usize, Vec<String>)| {
        Ok(RawMode {
            number: Table::count(row, mode)?,
            frequency_hz: positive(row, frequency, "a positive frequency in Hz")?,
            generalised_mass: positive(row, mass, "a positive generalised mass")?,
            shape: vec![[f64::NAN; 6]; nodes],
        })
    };
    table.rows.iter().map(one).collect()
}

/// A positive number in a cell.
pub(super) fn positive(row: &(usize, Vec<String>), column: usize, expected: &str) -> Result<f64> {
    let x = Table::number(row, column)?;
    if x > 0.0 {
        return Ok(x);
    }
    let place = Place::line(row.0).column(column + 1);
    Err(Error::input(place, expected, x.to_string()))
}

fn fill(table: &Table, nodes: &[(String, [f64; 3])], modes: &mut [RawMode]) -> Result<()> {
    let columns =
        ["mode", "node", "ux", "uy", "uz", "rx", "ry", "rz"].map(|n| table.required(&[n]));
    let [mode, node, ux, uy, uz, rx, ry, rz] = columns;
    let parts = [ux?, uy?, uz?, rx?, ry?, rz?];
    let (mode, node) = (mode?, node?);
    let place_of: HashMap<&str, usize> = nodes
        .iter()
        .enumerate()
        .map(|(i, n)| (n.0.as_str(), i))
        .collect();
    let mode_of: HashMap<usize, usize> = modes
        .iter()
        .enumerate()
        .map(|(i, m)| (m.number, i))
        .collect();
    for row in &table.rows {
        let number = Table::count(row, mode)?;
        let of_mode = mode_of.get(&number).ok_or_else(|| {
            Error::input(
                Place::line(row.0),
                format!("a mode of {MODES}"),
                format!("mode {number}"),
            )
        })?;
        let name = Table::name(row, node);
        let at = place_of.get(name.as_str()).ok_or_else(|| {
            Error::input(
                Place::line(row.0),
                format!("a node of {NODES}"),
                format!("node {name}"),
            )
        })?;
        for (value, column) in modes[*of_mode].shape[*at].iter_mut().zip(parts) {
            *value = Table::number(row, column)?;
        }
    }
    for m in modes {
        if let Some(missing) = m.shape.iter().position(|u| u[0].is_nan()) {
            return Err(Error::input(
                format!("mode {}", m.number),
                format!("a row for each of the {} nodes of {NODES}", nodes.len()),
                format!("none for node {}", nodes[missing].0),
            ));
        }
    }
    Ok(())
}
