//! Our folder of three tables: `nodes.csv`, `modes.csv`, `shapes.csv`.
//!
//! - `nodes.csv`: `node,x_m,y_m,z_m`, one row per node in the order of the girder;
//! - `modes.csv`: `mode,frequency_hz,generalised_mass_kg`;
//! - `shapes.csv`: `mode,node,ux,uy,uz,rx,ry,rz`, displacements (m) and rotations (rad) along and about the axes of the nodes.
//!
//! Lines that begin with `#` are comments; columns stand in any order and others are ignored.

use super::modal_data::{ModalData, RawMode};
use super::table::{Table, TableRow};
use crate::error::{Error, Place, Result, ensure};
use std::collections::HashMap;
use std::path::Path;

const NODES: &str = "nodes.csv";
const MODES: &str = "modes.csv";
const SHAPES: &str = "shapes.csv";

/// Reads the folder.
pub(super) fn read(folder: &Path) -> Result<ModalData> {
    let nodes = Table::read(&folder.join(NODES), nodes)?;
    let mut modes = Table::read(&folder.join(MODES), |table| modes(table, nodes.len()))?;
    Table::read(&folder.join(SHAPES), |table| {
        fill(table, &nodes, &mut modes)
    })?;
    Ok(ModalData { nodes, modes })
}

/// Nodes with their places.
pub(super) fn nodes(table: &Table) -> Result<Vec<(String, [f64; 3])>> {
    let [node, x, y, z] = table.columns([
        &["node", "tag", "label"],
        &["x_m", "x"],
        &["y_m", "y"],
        &["z_m", "z"],
    ])?;
    let one = |row: &TableRow| Ok((row.name(node), row.numbers([x, y, z])?));
    let nodes: Vec<(String, [f64; 3])> = table.rows.iter().map(one).collect::<Result<_>>()?;
    table.each_once(nodes.iter().map(|n| n.0.as_str()))?;
    Ok(nodes)
}

fn modes(table: &Table, nodes: usize) -> Result<Vec<RawMode>> {
    let [mode, frequency, mass] = table.columns([
        &["mode"],
        &["frequency_hz"],
        &["generalised_mass_kg", "generalised_mass"],
    ])?;
    let one = |row: &TableRow| {
        Ok(RawMode {
            number: row.count(mode)?,
            frequency_hz: row.positive(frequency, "a positive frequency in Hz")?,
            generalised_mass: row.positive(mass, "a positive generalised mass")?,
            shape: vec![[f64::NAN; 6]; nodes],
        })
    };
    let modes: Vec<RawMode> = table.rows.iter().map(one).collect::<Result<_>>()?;
    for (i, m) in modes.iter().enumerate() {
        ensure(
            modes[..i].iter().all(|before| before.number != m.number),
            Place::line(table.rows[i].line),
            "each mode once",
            format_args!("mode {} twice", m.number),
        )?;
    }
    Ok(modes)
}

fn fill(table: &Table, nodes: &[(String, [f64; 3])], modes: &mut [RawMode]) -> Result<()> {
    let [mode, node] = table.columns([&["mode"], &["node"]])?;
    let parts = table.columns([&["ux"], &["uy"], &["uz"], &["rx"], &["ry"], &["rz"]])?;
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
        let number = row.count(mode)?;
        let of_mode = mode_of.get(&number).ok_or_else(|| {
            Error::input(
                Place::line(row.line),
                format!("a mode of {MODES}"),
                format!("mode {number}"),
            )
        })?;
        let name = row.name(node);
        let at = place_of.get(name.as_str()).ok_or_else(|| {
            Error::input(
                Place::line(row.line),
                format!("a node of {NODES}"),
                format!("node {name}"),
            )
        })?;
        let values = &mut modes[*of_mode].shape[*at];
        ensure(
            values[0].is_nan(),
            Place::line(row.line),
            "each node once in a mode",
            format_args!("node {name} of mode {number} twice"),
        )?;
        *values = row.numbers(parts)?;
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
