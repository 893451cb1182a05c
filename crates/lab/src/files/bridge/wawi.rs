//! The model folder of wawi: `modal.json` (generalised masses, stiffnesses, shapes) and `element.json` (nodes).
//!
//! `phi.full` has six rows per node, in the order of `node_matrix`, and one column per mode; axes are those of the nodes.

use super::modal_data::{ModalData, RawMode};
use crate::error::{Error, Result, counted, ensure};
use crate::files::text::read_text;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::f64::consts::TAU;
use std::path::Path;

#[derive(Deserialize)]
struct Modal {
    m: Vec<f64>,
    k: Option<Vec<f64>>,
    omega_n: Option<Vec<f64>>,
    #[serde(default)]
    local: bool,
    phi: Phi,
}

#[derive(Deserialize)]
struct Phi {
    full: Vec<Vec<f64>>,
}

#[derive(Deserialize)]
struct WawiElement {
    node_matrix: Vec<Vec<f64>>,
}

/// Reads the folder.
pub(super) fn read(folder: &Path) -> Result<ModalData> {
    let element: WawiElement = json(&folder.join("element.json"))?;
    let path = folder.join("modal.json");
    let modal: Modal = json(&path)?;
    data(element, modal).map_err(|e| e.in_file(path))
}

fn json<T: DeserializeOwned>(path: &Path) -> Result<T> {
    let text = read_text(path)?;
    serde_json::from_str(&text)
        .map_err(|e| Error::json("a file of wawi's model folder", &e).in_file(path))
}

fn data(element: WawiElement, modal: Modal) -> Result<ModalData> {
    ensure(
        !modal.local,
        "local",
        "shapes along global axes (`false`)",
        "`true`",
    )?;
    let mut nodes = Vec::new();
    for (i, row) in element.node_matrix.iter().enumerate() {
        let [name, x, y, z] = row[..] else {
            let place = format!("element.json: node_matrix[{i}]");
            return Err(Error::input(
                place,
                "node, x, y, z",
                format!("{} numbers", row.len()),
            ));
        };
        nodes.push((format!("{name:.0}"), [x, y, z]));
    }
    let omega = frequencies(&modal)?;
    let rows = modal.phi.full;
    ensure(
        rows.len() == 6 * nodes.len(),
        "phi.full",
        format_args!(
            "{} rows, six for each of the {} nodes",
            6 * nodes.len(),
            nodes.len()
        ),
        counted(rows.len(), "row"),
    )?;
    if let Some(i) = rows.iter().position(|r| r.len() != modal.m.len()) {
        return Err(Error::input(
            format!("phi.full[{i}]"),
            format!("{}, one per mode of `m`", counted(modal.m.len(), "column")),
            counted(rows[i].len(), "column"),
        ));
    }
    let mode = |(m, omega): (usize, f64)| RawMode {
        number: m + 1,
        frequency_hz: omega / TAU,
        generalised_mass: modal.m[m],
        shape: (0..nodes.len())
            .map(|n| std::array::from_fn(|d| rows[6 * n + d][m]))
            .collect(),
    };
    let modes = omega.into_iter().enumerate().map(mode).collect();
    Ok(ModalData { nodes, modes })
}

fn frequencies(modal: &Modal) -> Result<Vec<f64>> {
    let count = modal.m.len();
    let of = |name: &str, values: &[f64], square: bool| {
        ensure(
            values.len() == count,
            name,
            format_args!("{count} values, one per mode of `m`"),
            values.len(),
        )?;
        let one = |(i, x): (usize, &f64)| {
            let omega = if square { (x / modal.m[i]).sqrt() } else { *x };
            ensure(
                omega > 0.0 && omega.is_finite() && modal.m[i] > 0.0,
                format_args!("mode {}", i + 1),
                "a positive mass and frequency",
                format_args!("mass {}, {name} {x}", modal.m[i]),
            )?;
            Ok(omega)
        };
        values.iter().enumerate().map(one).collect()
    };
    match (&modal.omega_n, &modal.k) {
        (Some(omega), _) => of("omega_n", omega, false),
        (None, Some(k)) => of("k", k, true),
        (None, None) => Err(Error::input("", "`k` or `omega_n`", "neither")),
    }
}
