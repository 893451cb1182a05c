//! Our single file of modes: compact, in the signs of this program.
//!
//! ```text
//! # aerodeck bridge modes 1
//! # source: where the figures come from
//! # licence: …
//! # axes: vertical up, lateral downwind, rotation nose-up
//! # units: along_m and length_m in m; vertical, lateral in m and rotation in rad per unit of the modal coordinate
//! # generator: …
//! # mode: 1, 0.0551 Hz, 10203440 kg
//! node,along_m,length_m,downwind_m,up_m,vertical_1,lateral_1,rotation_1
//! 1001,-617.5,2.0,0,31.2,…
//! ```
//!
//! The places downwind and up are left out where they are not known. No force needs them: they show whether the nodes run as the
//! axes say, and straight, which a file of places along the girder alone would hide.

use super::modal_data::{BridgeModes, check_order};
use super::table::{Table, TableRow};
use crate::bridge::{BridgeMode, Node};
use crate::error::{Result, ensure, positive};
use crate::files::header_csv::CommentHeader;
use crate::files::text::{csv_cell, of_csv_cell};
use std::collections::HashSet;
use std::io::Write;

const FORMAT: &str = "aerodeck bridge modes 1";
const AXES: &str = "vertical up, lateral downwind, rotation nose-up";
const UNITS: &str = "along_m and length_m in m; vertical, lateral in m and rotation in rad per unit of the modal coordinate";
const MODE: &str = "mode";
/// Columns of a mode; its number stands behind them.
const PARTS: [&str; 3] = ["vertical", "lateral", "rotation"];
/// Columns of the places across the girder.
const OFFSETS: [&str; 2] = ["downwind_m", "up_m"];
const KEYS: &[&str] = &["source", "licence", "axes", "units", "generator", MODE];

pub(super) fn parse(text: &str) -> Result<BridgeModes> {
    let first = text.lines().next().unwrap_or("");
    let (expected, found) = (format!("# {FORMAT}"), format_args!("`{first}`"));
    let is_ours = first.trim() == expected;
    ensure(is_ours, "line 1", format_args!("`{expected}`"), found)?;
    let header = CommentHeader::read(text, &[FORMAT], KEYS, &[MODE])?;
    header.must_say("axes", AXES)?;
    header.must_say("units", UNITS)?;
    let table = Table::parse(text)?;
    let [name, along, length] = table.columns([&["node"], &["along_m"], &["length_m"]])?;
    let node = |row: &TableRow| {
        Ok(Node {
            name: of_csv_cell(&row.name(name)).to_owned(),
            along_m: row.number(along)?,
            length_m: row.number(length)?,
        })
    };
    let nodes: Vec<Node> = table.rows.iter().map(node).collect::<Result<_>>()?;
    table.each_once(nodes.iter().map(|n| n.name.as_str()))?;
    let offsets_m = offsets(&table)?;
    check_order(&nodes)?;
    let mut numbers = HashSet::new();
    let modes = header.all(MODE).map(|entry| {
        let (number, frequency_hz, generalised_mass) = mode_line(&entry.value)
            .ok_or_else(|| entry.wrong("`number, frequency Hz, generalised mass kg`"))?;
        if !numbers.insert(number) {
            return Err(entry.wrong("each mode once"));
        }
        let place = entry.place();
        positive(format!("{place}, frequency"), frequency_hz)?;
        positive(format!("{place}, generalised mass"), generalised_mass)?;
        let names = PARTS.map(|part| format!("{part}_{number}"));
        let [v, l, r] = names.each_ref().map(String::as_str);
        let columns = table.columns([&[v], &[l], &[r]])?;
        Ok(BridgeMode {
            number,
            frequency_hz,
            generalised_mass,
            damping_ratio: 0.0,
            shape: table.all(columns)?,
        })
    });
    let modes = modes.collect::<Result<Vec<_>>>()?;
    refuse_unstated(&table, &modes)?;
    Ok(BridgeModes {
        source: header.text("source"),
        modes,
        nodes,
        offsets_m,
        ..BridgeModes::default()
    })
}

/// Refuses columns of a mode that no line of the header states.
fn refuse_unstated(table: &Table, modes: &[BridgeMode]) -> Result<()> {
    let number = |column: &str| {
        let (part, number) = column.rsplit_once('_')?;
        number.parse().ok().filter(|_| PARTS.contains(&part))
    };
    let stated = |n: usize| modes.iter().any(|mode| mode.number == n);
    table.heading.iter().try_for_each(|column| {
        let is_stated = number(column).is_none_or(stated);
        let expected = format_args!("a line `# mode: …` for the column `{column}`");
        ensure(is_stated, "header", expected, "none")
    })
}

/// Places downwind and up, of a file that knows them.
fn offsets(table: &Table) -> Result<Vec<[f64; 2]>> {
    if OFFSETS.iter().all(|name| table.column(&[name]).is_none()) {
        return Ok(Vec::new());
    }
    let [downwind, up] = OFFSETS;
    table.all(table.columns([&[downwind], &[up]])?)
}

fn mode_line(value: &str) -> Option<(usize, f64, f64)> {
    let mut parts = value.split(',').map(str::trim);
    let number = parts.next()?.parse().ok()?;
    let frequency = parts.next()?.strip_suffix("Hz")?.trim().parse().ok()?;
    let mass = parts.next()?.strip_suffix("kg")?.trim().parse().ok()?;
    parts.next().is_none().then_some((number, frequency, mass))
}

/// Writes modes as a single file.
///
/// # Errors
/// When `out` takes no more.
pub fn write_modes(
    modes: &BridgeModes,
    licence: &str,
    generator: &str,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let entries = [
        ("source", modes.source.as_str()),
        ("licence", licence),
        ("axes", AXES),
        ("units", UNITS),
        ("generator", generator),
    ];
    CommentHeader::write(out, FORMAT, &entries)?;
    for m in &modes.modes {
        let line = format!(
            "{}, {} Hz, {} kg",
            m.number, m.frequency_hz, m.generalised_mass
        );
        CommentHeader::write_line(out, MODE, line)?;
    }
    write!(out, "node,along_m,length_m")?;
    if !modes.offsets_m.is_empty() {
        write!(out, ",{}", OFFSETS.join(","))?;
    }
    for m in &modes.modes {
        write!(out, ",vertical_{0},lateral_{0},rotation_{0}", m.number)?;
    }
    writeln!(out)?;
    for (i, node) in modes.nodes.iter().enumerate() {
        let name = csv_cell(&node.name);
        write!(out, "{name},{},{}", node.along_m, node.length_m)?;
        if let Some([downwind, up]) = modes.offsets_m.get(i) {
            write!(out, ",{downwind},{up}")?;
        }
        for x in modes.modes.iter().flat_map(|m| m.shape[i]) {
            // what is below the figures of the program that made it is zero
            let x = if x.abs() < 1e-9 { 0.0 } else { x };
            write!(out, ",{x}")?;
        }
        writeln!(out)?;
    }
    Ok(())
}
