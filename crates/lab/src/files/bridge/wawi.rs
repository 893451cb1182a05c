//! The model folder of wawi: `modal.json` (generalised masses, stiffnesses, shapes) and `element.json` (nodes).
//!
//! `phi.full` has six rows per node, in the order of `node_matrix`, and one column per mode; axes are those of the nodes.

use super::modal_data::{Frame, PlacedNodes, mode};
use crate::bridge::BridgeMode;
use crate::error::{Error, Result, counted, ensure};
use crate::files::text::parsed;
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
pub(super) fn read(folder: &Path, frame: &Frame) -> Result<(PlacedNodes, Vec<BridgeMode>)> {
    let element: WawiElement = json(&folder.join("element.json"))?;
    let path = folder.join("modal.json");
    let modal: Modal = json(&path)?;
    data(element, modal, frame).map_err(|e| e.in_file(path))
}

fn json<T: DeserializeOwned>(path: &Path) -> Result<T> {
    let wrong = |e| Error::json("a file of wawi's model folder", &e);
    parsed(path, |text| serde_json::from_str(text).map_err(wrong))
}

fn data(
    element: WawiElement,
    modal: Modal,
    frame: &Frame,
) -> Result<(PlacedNodes, Vec<BridgeMode>)> {
    let expected = "shapes along global axes (`false`)";
    ensure(!modal.local, "local", expected, "`true`")?;
    let mut nodes = Vec::new();
    for (i, row) in element.node_matrix.iter().enumerate() {
        let [name, x, y, z] = row[..] else {
            let place = format!("element.json: node_matrix[{i}]");
            let found = format!("{} numbers", row.len());
            return Err(Error::input(place, "node, x, y, z", found));
        };
        nodes.push((format!("{name:.0}"), [x, y, z]));
    }
    let (place, any) = ("element.json: node_matrix", !nodes.is_empty());
    ensure(any, place, "at least one node", "none")?;
    let omega = frequencies(&modal)?;
    let rows = modal.phi.full;
    let (count, wanted) = (nodes.len(), 6 * nodes.len());
    let expected = format_args!("{wanted} rows, six for each of the {count} nodes");
    let found = counted(rows.len(), "row");
    ensure(rows.len() == wanted, "phi.full", expected, found)?;
    if let Some(i) = rows.iter().position(|r| r.len() != modal.m.len()) {
        let [wanted, found] = [modal.m.len(), rows[i].len()].map(|n| counted(n, "column"));
        let expected = format!("{wanted}, one per mode of `m`");
        return Err(Error::input(format!("phi.full[{i}]"), expected, found));
    }
    let of_number = |(m, omega): (usize, f64)| {
        let at = |n: usize| std::array::from_fn(|d| rows[6 * n + d][m]);
        let shape: Vec<[f64; 6]> = (0..nodes.len()).map(at).collect();
        mode(frame, m + 1, omega / TAU, modal.m[m], &shape)
    };
    let modes = omega.into_iter().enumerate().map(of_number).collect();
    Ok((nodes, modes))
}

fn frequencies(modal: &Modal) -> Result<Vec<f64>> {
    let count = modal.m.len();
    let of = |name: &str, values: &[f64], square: bool| {
        let expected = format_args!("{count} values, one per mode of `m`");
        ensure(values.len() == count, name, expected, values.len())?;
        let one = |(i, x): (usize, &f64)| {
            let omega = if square { (x / modal.m[i]).sqrt() } else { *x };
            let is_positive = omega > 0.0 && omega.is_finite() && modal.m[i] > 0.0;
            let (place, expected) = (format!("mode {}", i + 1), "a positive mass and frequency");
            let found = format_args!("mass {}, {name} {x}", modal.m[i]);
            ensure(is_positive, place, expected, found).map(|()| omega)
        };
        values.iter().enumerate().map(one).collect()
    };
    match (&modal.omega_n, &modal.k) {
        (Some(omega), _) => of("omega_n", omega, false),
        (None, Some(k)) => of("k", k, true),
        (None, None) => Err(Error::input("", "`k` or `omega_n`", "neither")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bridge_without_nodes_is_refused() {
        let element = serde_json::from_str(r#"{ "node_matrix": [] }"#).unwrap();
        let modal = r#"{ "m": [1.0], "omega_n": [2.0], "phi": { "full": [] } }"#;
        let modal = serde_json::from_str(modal).unwrap();
        let said = data(element, modal, &Frame::identity()).unwrap_err();
        let expected = "element.json: node_matrix: expected at least one node, found none";
        assert_eq!(said.to_string(), expected);
    }
}
