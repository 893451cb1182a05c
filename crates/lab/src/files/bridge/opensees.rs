//! Text of OpenSees recorders: a folder with eigenvalues and one recording per mode.
//!
//! - `nodes.out`: `tag x y z` a line, in the order in which the nodes are recorded;
//! - `eigenvalues.out`: what `eigen` returns, `ω²` in (rad/s)², on one line or many;
//! - `mode_1.out`, …: `recorder Node -file mode_1.out -node … -dof 1 2 3 4 5 6 "eigen 1"`: six numbers per node in one line, of
//!   which the last counts; a leading time is allowed;
//! - `masses.out`, optional: generalised masses; without it the vectors are mass-normalised, as `eigen` makes them.
//!
//! `examples/export_modes_opensees.py` writes them.

use super::modal_data::{Frame, PlacedNodes, mode};
use super::table::{Table, TableRow};
use crate::bridge::BridgeMode;
use crate::error::{Error, Place, Result, ensure};
use std::f64::consts::TAU;
use std::path::Path;

/// Reads the folder.
pub(super) fn read(folder: &Path, frame: &Frame) -> Result<(PlacedNodes, Vec<BridgeMode>)> {
    let nodes = Table::read(&folder.join("nodes.out"), nodes)?;
    let path = folder.join("eigenvalues.out");
    let eigenvalues = Table::read(&path, Table::all_numbers)?;
    let masses = masses(&folder.join("masses.out"), eigenvalues.len())?;
    let mut modes = Vec::with_capacity(masses.len());
    for (number, (square, mass)) in (1..).zip(eigenvalues.into_iter().zip(masses)) {
        let expected = "a positive square of a frequency, rad²/s²";
        let place = format_args!("eigenvalue {number}");
        ensure(square > 0.0, place, expected, square).map_err(|e| e.in_file(&path))?;
        let path = folder.join(format!("mode_{number}.out"));
        let shape = Table::read(&path, |table| shape(table, nodes.len()))?;
        modes.push(mode(frame, number, square.sqrt() / TAU, mass, &shape));
    }
    Ok((nodes, modes))
}

fn nodes(table: &Table) -> Result<PlacedNodes> {
    let one = |row: &TableRow| Ok((row.name(0), row.numbers([1, 2, 3])?));
    table.rows.iter().map(one).collect()
}

fn masses(path: &Path, modes: usize) -> Result<Vec<f64>> {
    if !path.exists() {
        return Ok(vec![1.0; modes]);
    }
    Table::read(path, |table| {
        let masses = table.all_numbers()?;
        let least = masses.iter().copied().fold(f64::INFINITY, f64::min);
        let count = masses.len();
        let fits = count == modes && masses.iter().all(|m| *m > 0.0);
        let expected = format_args!("{modes} positive masses, one per eigenvalue");
        let found = format_args!("{count} numbers, the least {least}");
        ensure(fits, "", expected, found).map(|()| masses)
    })
}

fn shape(table: &Table, nodes: usize) -> Result<Vec<[f64; 6]>> {
    let wanted = 6 * nodes;
    let row = &table.rows[table.rows.len() - 1];
    let found = row.cells.len();
    let Some(leading) = found.checked_sub(wanted).filter(|time| *time <= 1) else {
        let expected = format!("{wanted} numbers, six for each of the {nodes} nodes of nodes.out");
        let place = Place::line(row.line);
        return Err(Error::input(place, expected, found.to_string()));
    };
    let part = |n: usize| row.numbers(std::array::from_fn(|d| leading + 6 * n + d));
    (0..nodes).map(part).collect()
}
