//! Our folder of three tables: `nodes.csv`, `modes.csv`, `shapes.csv`.
//!
//! - `nodes.csv`: `node,x_m,y_m,z_m`, one row per node in the order of the girder;
//! - `modes.csv`: `mode,frequency_hz,generalised_mass_kg`;
//! - `shapes.csv`: `mode,node,ux,uy,uz,rx,ry,rz`, displacements (m) and rotations (rad) along and about the axes of the nodes.
//!
//! Lines that begin with `#` are comments; columns stand in any order and others are ignored.

use super::modal_data::{Frame, PlacedNodes, motion};
use super::table::{Table, TableRow};
use crate::bridge::BridgeMode;
use crate::error::{Error, Place, Result, ensure};
use std::collections::HashMap;
use std::path::Path;

const NODES: &str = "nodes.csv";
const MODES: &str = "modes.csv";
const SHAPES: &str = "shapes.csv";

/// Reads the folder.
pub(super) fn read(folder: &Path, frame: &Frame) -> Result<(PlacedNodes, Vec<BridgeMode>)> {
    let nodes = Table::read(&folder.join(NODES), nodes)?;
    let mut modes = Table::read(&folder.join(MODES), |table| modes(table, nodes.len()))?;
    Table::read(&folder.join(SHAPES), |table| {
        fill(table, frame, &nodes, &mut modes)
    })?;
    Ok((nodes, modes))
}

/// Nodes with their places.
pub(super) fn nodes(table: &Table) -> Result<PlacedNodes> {
    let [node, x, y, z] = table.columns([
        &["node", "tag", "label"],
        &["x_m", "x"],
        &["y_m", "y"],
        &["z_m", "z"],
    ])?;
    let one = |row: &TableRow| Ok((row.name(node), row.numbers([x, y, z])?));
    let nodes: PlacedNodes = table.rows.iter().map(one).collect::<Result<_>>()?;
    table.each_once(nodes.iter().map(|n| n.0.as_str()))?;
    Ok(nodes)
}

fn modes(table: &Table, nodes: usize) -> Result<Vec<BridgeMode>> {
    let [mode, frequency, mass] = table.columns([
        &["mode"],
        &["frequency_hz"],
        &["generalised_mass_kg", "generalised_mass"],
    ])?;
    let one = |row: &TableRow| {
        Ok(BridgeMode {
            number: row.count(mode)?,
            frequency_hz: row.positive(frequency, "a positive frequency in Hz")?,
            generalised_mass: row.positive(mass, "a positive generalised mass")?,
            damping_ratio: 0.0,
            shape: vec![[f64::NAN; 3]; nodes],
        })
    };
    let modes: Vec<BridgeMode> = table.rows.iter().map(one).collect::<Result<_>>()?;
    for (i, BridgeMode { number, .. }) in modes.iter().enumerate() {
        let is_new = modes[..i].iter().all(|before| before.number != *number);
        let place = Place::line(table.rows[i].line);
        let found = format_args!("mode {number} twice");
        ensure(is_new, place, "each mode once", found)?;
    }
    Ok(modes)
}

fn fill(table: &Table, frame: &Frame, nodes: &PlacedNodes, modes: &mut [BridgeMode]) -> Result<()> {
    let [mode, node] = table.columns([&["mode"], &["node"]])?;
    let parts = table.columns([&["ux"], &["uy"], &["uz"], &["rx"], &["ry"], &["rz"]])?;
    let places = nodes.iter().enumerate().map(|(i, n)| (n.0.as_str(), i));
    let place_of: HashMap<&str, usize> = places.collect();
    let numbers = modes.iter().enumerate().map(|(i, m)| (m.number, i));
    let mode_of: HashMap<usize, usize> = numbers.collect();
    for row in &table.rows {
        let number = row.count(mode)?;
        let unknown =
            |expected: String, found: String| Error::input(Place::line(row.line), expected, found);
        let of_mode = mode_of.get(&number);
        let of_mode = of_mode
            .ok_or_else(|| unknown(format!("a mode of {MODES}"), format!("mode {number}")))?;
        let name = row.name(node);
        let at = place_of.get(name.as_str());
        let at = at.ok_or_else(|| unknown(format!("a node of {NODES}"), format!("node {name}")))?;
        let values = &mut modes[*of_mode].shape[*at];
        let place = Place::line(row.line);
        let found = format_args!("node {name} of mode {number} twice");
        ensure(values[0].is_nan(), place, "each node once in a mode", found)?;
        *values = motion(frame, &row.numbers(parts)?);
    }
    for m in modes {
        if let Some(missing) = m.shape.iter().position(|u| u[0].is_nan()) {
            let expected = format!("a row for each of the {} nodes of {NODES}", nodes.len());
            let found = format!("none for node {}", nodes[missing].0);
            return Err(Error::input(format!("mode {}", m.number), expected, found));
        }
    }
    Ok(())
}
