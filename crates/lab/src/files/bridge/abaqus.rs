//! CSV exports of Abaqus: a folder with one file per mode.
//!
//! - `nodes.csv`: `node,x,y,z`;
//! - `eigenfrequencies.csv`: one frequency per mode, Hz (the last column counts where there are several);
//! - `generalised_masses.csv`: one per mode, likewise;
//! - `mode_1.csv`, `mode_2.csv`, …: `node,U1,U2,U3,UR1,UR2,UR3`, in any order of nodes.
//!
//! `examples/export_modes_abaqus.py` writes them from an output database.

use super::modal_data::{ModalData, RawMode};
use super::table::Table;
use super::tables;
use crate::error::{Error, Result, ensure};
use std::collections::HashMap;
use std::path::Path;

/// Reads the folder.
pub(super) fn read(folder: &Path) -> Result<ModalData> {
    let path = folder.join("nodes.csv");
    let nodes = tables::nodes(&Table::read(&path)?).map_err(|e| e.in_file(&path))?;
    let frequencies = column(
        &folder.join("eigenfrequencies.csv"),
        "a positive frequency in Hz",
    )?;
    let path = folder.join("generalised_masses.csv");
    let masses = column(&path, "a positive generalised mass")?;
    ensure(
        masses.len() == frequencies.len(),
        "",
        format_args!("{} masses, one per frequency", frequencies.len()),
        masses.len(),
    )
    .map_err(|e| e.in_file(path))?;
    let mut modes = Vec::with_capacity(masses.len());
    for (i, (frequency_hz, generalised_mass)) in frequencies.into_iter().zip(masses).enumerate() {
        let path = folder.join(format!("mode_{}.csv", i + 1));
        modes.push(RawMode {
            number: i + 1,
            frequency_hz,
            generalised_mass,
            shape: shape(&Table::read(&path)?, &nodes).map_err(|e| e.in_file(&path))?,
        });
    }
    Ok(ModalData { nodes, modes })
}

/// The last number of every row.
fn column(path: &Path, expected: &str) -> Result<Vec<f64>> {
    let table = Table::read(path)?;
    let rows = table
        .rows
        .iter()
        .map(|row| row.positive(row.cells.len() - 1, expected));
    rows.collect::<Result<_>>().map_err(|e| e.in_file(path))
}

fn shape(table: &Table, nodes: &[(String, [f64; 3])]) -> Result<Vec<[f64; 6]>> {
    let node = table.required(&["node", "label"])?;
    let names = [
        ["U1", "ux"],
        ["U2", "uy"],
        ["U3", "uz"],
        ["UR1", "rx"],
        ["UR2", "ry"],
        ["UR3", "rz"],
    ];
    let mut columns = [0; 6];
    for (column, name) in columns.iter_mut().zip(&names) {
        *column = table.required(name)?;
    }
    let mut at: HashMap<String, [f64; 6]> = HashMap::new();
    for row in &table.rows {
        let mut values = [0.0; 6];
        for (value, column) in values.iter_mut().zip(columns) {
            *value = row.number(column)?;
        }
        at.insert(row.name(node), values);
    }
    let of_node = |(name, _): &(String, [f64; 3])| {
        at.get(name).copied().ok_or_else(|| {
            let expected = format!("a row for each of the {} nodes of nodes.csv", nodes.len());
            Error::input("", expected, format!("none for node {name}"))
        })
    };
    nodes.iter().map(of_node).collect()
}
