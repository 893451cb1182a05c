//! The bridge of Langenuen as tables of a finite-element program, so that its files can be wrong.

use crate::bridges::{TWO, langenuen_text};
use aerodeck::files::bridge::embedded;
use std::fs;
use std::path::Path;

/// How the model stands in its axes.
pub struct GirderShape {
    /// Components of `modes.axes.downwind`; the girder runs along x, so the wind square to it blows along −y.
    pub downwind: [f64; 3],
    /// Rise of the girder in plan over its half length.
    pub bow: f64,
    /// Stated requirement, m/s.
    pub required_m_s: f64,
}

impl Default for GirderShape {
    fn default() -> Self {
        Self {
            downwind: [0.0, -1.0, 0.0],
            bow: 0.0,
            required_m_s: 60.0,
        }
    }
}

/// `nodes.csv`, `modes.csv`, `shapes.csv` and `bridge.toml` of eight modes of the bridge.
pub fn write_tables(folder: &Path, girder: &GirderShape) {
    let mut modes = embedded::modes("langenuen").unwrap();
    modes
        .modes
        .retain(|m| [2, 3, 5, 12, 14, 16, 17, 23].contains(&m.number));
    let half = 0.5 * (modes.nodes[modes.nodes.len() - 1].along_m - modes.nodes[0].along_m);
    let (mut nodes, mut of_modes, mut shapes) = (
        "node,x_m,y_m,z_m\n".to_owned(),
        "mode,frequency_hz,generalised_mass_kg\n".to_owned(),
        "mode,node,ux,uy,uz,rx,ry,rz\n".to_owned(),
    );
    for node in &modes.nodes {
        let part = node.along_m / half;
        let y = girder.bow * half * (1.0 - part * part);
        nodes += &format!("{},{},{y},60\n", node.name, node.along_m);
    }
    for m in &modes.modes {
        of_modes += &format!("{},{},{}\n", m.number, m.frequency_hz, m.generalised_mass);
        for (node, [vertical, lateral, rotation]) in modes.nodes.iter().zip(&m.shape) {
            shapes += &format!(
                "{},{},0,{},{vertical},{rotation},0,0\n",
                m.number, node.name, -lateral
            );
        }
    }
    for (name, text) in [
        ("nodes.csv", nodes),
        ("modes.csv", of_modes),
        ("shapes.csv", shapes),
        ("bridge.toml", bridge_text(girder)),
    ] {
        fs::write(folder.join(name), text).unwrap();
    }
}

fn bridge_text(girder: &GirderShape) -> String {
    let axes = format!(
        "axes = {{ up = \"z\", downwind = {:?} }}\n",
        girder.downwind
    );
    let required = format!(
        "[flutter]\nrequired_speed_m_s = {:?}\n",
        girder.required_m_s
    );
    langenuen_text("LN21-5200", TWO, "modified_akima")
        .replace("\"embedded\"", "\"csv\"")
        .replace("\"langenuen\"\n", &format!("\".\"\n{axes}"))
        .replace("[flutter]\n", &required)
}
