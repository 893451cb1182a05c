//! Text of OpenSees recorders: a folder with eigenvalues and one recording per mode.
//!
//! - `nodes.out`: `tag x y z` a line, in the order in which the nodes are recorded;
//! - `eigenvalues.out`: what `eigen` returns, `ω²` in (rad/s)², on one line or many;
//! - `mode_1.out`, …: `recorder Node -file mode_1.out -node … -dof 1 2 3 4 5 6 "eigen 1"`: six numbers per node in one line, of
//!   which the last counts; a leading time is allowed;
//! - `masses.out`, optional: generalised masses; without it the vectors are mass-normalised, as `eigen` makes them.
//!
//! `examples/export_modes_opensees.py` writes them.

use super::modal_data::{ModalData, RawMode};
use super::table::{Table, TableRow};
use crate::error::{Error, Place, Result, ensure};
use std::f64::consts::TAU;
use std::path::Path;

/// Reads the folder.
pub(super) fn read(folder: &Path) -> Result<ModalData> {
    let nodes = Table::read(&folder.join("nodes.out"), nodes)?;
    let path = folder.join("eigenvalues.out");
    let eigenvalues = Table::read(&path, Table::all_numbers)?;
    let masses = masses(&folder.join("masses.out"), eigenvalues.len())?;
    let mut modes = Vec::with_capacity(masses.len());
    for (i, (square, generalised_mass)) in eigenvalues.into_iter().zip(masses).enumerate() {
        ensure(
            square > 0.0,
            format_args!("eigenvalue {}", i + 1),
            "a positive square of a frequency, rad²/s²",
            square,
        )
        .map_err(|e| e.in_file(&path))?;
        let path = folder.join(format!("mode_{}.out", i + 1));
        modes.push(RawMode {
            number: i + 1,
            frequency_hz: square.sqrt() / TAU,
            generalised_mass,
            shape: Table::read(&path, |table| shape(table, nodes.len()))?,
        });
    }
    Ok(ModalData { nodes, modes })
}

fn nodes(table: &Table) -> Result<Vec<(String, [f64; 3])>> {
    let one = |row: &TableRow| Ok((row.name(0), row.numbers([1, 2, 3])?));
    table.rows.iter().map(one).collect()
}

fn masses(path: &Path, modes: usize) -> Result<Vec<f64>> {
    if !path.exists() {
        return Ok(vec![1.0; modes]);
    }
    Table::read(path, |table| {
        let masses = table.all_numbers()?;
        ensure(
            masses.len() == modes && masses.iter().all(|m| *m > 0.0),
            "",
            format_args!("{modes} positive masses, one per eigenvalue"),
            format_args!(
                "{} numbers, the least {}",
                masses.len(),
                masses.iter().copied().fold(f64::INFINITY, f64::min)
            ),
        )?;
        Ok(masses)
    })
}

fn shape(table: &Table, nodes: usize) -> Result<Vec<[f64; 6]>> {
    let wanted = 6 * nodes;
    let row = &table.rows[table.rows.len() - 1];
    let leading = row
        .cells
        .len()
        .checked_sub(wanted)
        .filter(|time| *time <= 1);
    let Some(leading) = leading else {
        return Err(Error::input(
            Place::line(row.line),
            format!("{wanted} numbers, six for each of the {nodes} nodes of nodes.out"),
            row.cells.len().to_string(),
        ));
    };
    let part = |n: usize| row.numbers(std::array::from_fn(|d| leading + 6 * n + d));
    (0..nodes).map(part).collect()
}
