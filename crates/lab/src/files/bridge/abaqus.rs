//! CSV exports of Abaqus: a folder with one file per mode.
//!
//! - `nodes.csv`: `node,x,y,z`;
//! - `eigenfrequencies.csv`: one frequency per mode, Hz (the last column counts where there are several, and the first, or that named
//!   `mode`, has the numbers of the modes, from 1);
//! - `generalised_masses.csv`: one per mode, likewise;
//! - `mode_1.csv`, `mode_2.csv`, …: `node,U1,U2,U3,UR1,UR2,UR3`, in any order of nodes.
//!
//! `examples/export_modes_abaqus.py` writes them from an output database.

use super::modal_data::{Frame, PlacedNodes, mode};
use super::table::{Table, TableRow};
use super::tables;
use crate::bridge::BridgeMode;
use crate::error::{Error, Place, Result, ensure};
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Reads the folder.
pub(super) fn read(folder: &Path, frame: &Frame) -> Result<(PlacedNodes, Vec<BridgeMode>)> {
    let nodes = Table::read(&folder.join("nodes.csv"), tables::nodes)?;
    let frequencies = Table::read(&folder.join("eigenfrequencies.csv"), |table| {
        column(table, "a positive frequency in Hz")
    })?;
    let path = folder.join("generalised_masses.csv");
    let masses = Table::read(&path, |table| column(table, "a positive generalised mass"))?;
    let (found, wanted) = (masses.len(), frequencies.len());
    let expected = format_args!("{wanted} masses, one per frequency");
    ensure(found == wanted, "", expected, found).map_err(|e| e.in_file(path))?;
    let mut modes = Vec::with_capacity(masses.len());
    for (number, (frequency_hz, mass)) in (1..).zip(frequencies.into_iter().zip(masses)) {
        let path = folder.join(format!("mode_{number}.csv"));
        let shape = Table::read(&path, |table| shape(table, &nodes))?;
        modes.push(mode(frame, number, frequency_hz, mass, &shape));
    }
    Ok((nodes, modes))
}

/// The last number of every row, which are those of the modes 1, 2, ….
fn column(table: &Table, expected: &str) -> Result<Vec<f64>> {
    let mode = match table.heading.is_empty() {
        true => Some(0),
        false => table.column(&["mode", "mode no", "mode number"]),
    };
    let one = |(i, row): (usize, &TableRow)| {
        let last = row.cells.len() - 1;
        if let Some(mode) = mode.filter(|mode| *mode < last) {
            let is_next = row.count(mode)? == i + 1;
            let expected = format_args!("mode {}, in the order of the modes", i + 1);
            let found = format_args!("`{}`", row.cells[mode]);
            ensure(is_next, Place::line(row.line), expected, found)?;
        }
        row.positive(last, expected)
    };
    table.rows.iter().enumerate().map(one).collect()
}

fn shape(table: &Table, nodes: &[(String, [f64; 3])]) -> Result<Vec<[f64; 6]>> {
    let node = table.required(&["node", "label"])?;
    let columns = table.columns([
        &["U1", "ux"],
        &["U2", "uy"],
        &["U3", "uz"],
        &["UR1", "rx"],
        &["UR2", "ry"],
        &["UR3", "rz"],
    ])?;
    let mut at: HashMap<String, [f64; 6]> = HashMap::new();
    let names: Vec<String> = table.rows.iter().map(|row| row.name(node)).collect();
    table.each_once(names.iter().map(String::as_str))?;
    let known: HashSet<&str> = nodes.iter().map(|n| n.0.as_str()).collect();
    for (row, name) in table.rows.iter().zip(names) {
        let (expected, found) = ("a node of nodes.csv", format_args!("node {name}"));
        let is_known = known.contains(name.as_str());
        ensure(is_known, Place::line(row.line), expected, found)?;
        at.insert(name, row.numbers(columns)?);
    }
    let of_node = |(name, _): &(String, [f64; 3])| {
        at.get(name).copied().ok_or_else(|| {
            let expected = format!("a row for each of the {} nodes of nodes.csv", nodes.len());
            Error::input("", expected, format!("none for node {name}"))
        })
    };
    nodes.iter().map(of_node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::bridge::{Direction, WindAxes};

    /// What is said of a folder of two nodes and modes after a change of one file.
    fn said(file: &str, text: &str) -> String {
        let folder = tempfile::tempdir().unwrap();
        let rows = "node,U1,U2,U3,UR1,UR2,UR3\n1,0,0,1,0,0,0\n2,0,0,1,0,0,0\n";
        for (name, content) in [
            ("nodes.csv", "node,x,y,z\n1,0,0,0\n2,9,0,0\n"),
            ("eigenfrequencies.csv", "mode,frequency\n1,0.1\n2,0.3\n"),
            ("generalised_masses.csv", "1 4e6\n2 7e6\n"),
            ("mode_1.csv", rows),
            ("mode_2.csv", rows),
            (file, text),
        ] {
            std::fs::write(folder.path().join(name), content).unwrap();
        }
        let [up, downwind] = ["z", "y"].map(|axis| Direction::Axis(axis.to_owned()));
        let frame = WindAxes { up, downwind }.frame().unwrap();
        let read = read(folder.path(), &frame);
        read.map_or_else(
            |e| e.to_string(),
            |(_, modes)| format!("{} modes", modes.len()),
        )
    }

    #[test]
    fn rows_of_other_nodes_and_modes_are_refused_with_their_line() {
        let shape =
            |rows: &str| format!("node,U1,U2,U3,UR1,UR2,UR3\n1,0,0,1,0,0,0\n{rows}2,0,0,1,0,0,0\n");
        assert_eq!(said("mode_1.csv", &shape("")), "2 modes");
        for (file, text, expected) in [
            (
                "mode_2.csv",
                shape("1,0,0,9,0,0,0\n"),
                "mode_2.csv: line 3: expected each node once, found node 1 twice",
            ),
            (
                "mode_2.csv",
                shape("7,0,0,9,0,0,0\n"),
                "mode_2.csv: line 3: expected a node of nodes.csv, found node 7",
            ),
            (
                "generalised_masses.csv",
                "2 7e6\n1 4e6\n".to_owned(),
                "generalised_masses.csv: line 1: expected mode 1, in the order of the modes, found `2`",
            ),
            (
                "eigenfrequencies.csv",
                "0,11\n0,31\n".to_owned(),
                "eigenfrequencies.csv: line 1: expected mode 1, in the order of the modes, found `0`",
            ),
        ] {
            let message = said(file, &text);
            assert!(message.ends_with(expected), "{message}");
        }
    }
}
