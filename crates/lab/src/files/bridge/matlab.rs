//! MATLAB files of `wn` (3×m, rad/s) and `phi` (3×m×n): lateral, vertical, torsional modes of a single span, each in one
//! motion, at `n` points from one end to the other (the layout of E. Cheynet's programs).
//!
//! Such a file knows neither the span nor the masses; both are stated beside it and the generalised masses are `m ∫φ²`.

use super::modal_data::{BridgeModes, tributary_lengths};
use crate::bridge::{BridgeMode, Node};
use crate::error::{Error, Result, ensure};
use crate::files::lab::matlab_array;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::path::Path;

/// A single span with uniform masses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpanBlock {
    /// Length, m.
    pub span_m: f64,
    /// Mass per length that moves with the girder, kg/m.
    pub mass_kg_m: f64,
    /// Mass moment of inertia per length, kg·m²/m.
    pub inertia_kg_m2_m: f64,
}

/// Motions in the order of the rows, as places in a shape.
const ROWS: [usize; 3] = [1, 0, 2];

/// Reads the file.
pub(super) fn read(path: &Path, span: &SpanBlock) -> Result<BridgeModes> {
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    parse(bytes, span).map_err(|e| e.in_file(path))
}

fn parse(bytes: Vec<u8>, span: &SpanBlock) -> Result<BridgeModes> {
    let (wn_size, wn) = matlab_array(bytes.clone(), "wn")?;
    let (phi_size, phi) = matlab_array(bytes, "phi")?;
    let (&[3, modes], &[3, of_phi, points]) = (&wn_size[..], &phi_size[..]) else {
        let found = format!("wn {wn_size:?}, phi {phi_size:?}");
        return Err(Error::input("", "wn (3×m) and phi (3×m×n)", found));
    };
    let expected = format_args!("phi of {modes} modes at two points or more");
    let found = format_args!("{of_phi} modes at {points} points");
    ensure(of_phi == modes && points >= 2, "phi", expected, found)?;
    let at = |i: usize| span.span_m * i as f64 / (points as f64 - 1.0);
    let along: Vec<f64> = (0..points).map(at).collect();
    let lengths = tributary_lengths(&along);
    let mut all = Vec::with_capacity(3 * modes);
    for mode in 0..modes {
        for (row, motion) in ROWS.into_iter().enumerate() {
            let at = row + 3 * mode;
            let omega = wn[at];
            let is_positive = |x: f64| x > 0.0 && x.is_finite();
            let place = format_args!("wn({}, {})", row + 1, mode + 1);
            let expected = "a positive frequency, rad/s";
            ensure(is_positive(omega), place, expected, omega)?;
            let values = phi.iter().skip(at).step_by(3 * modes).take(points);
            let found = mode_of(omega, motion, values.copied().collect(), &lengths, span);
            let mass = found.generalised_mass;
            let place = format_args!("phi({}, {}, :)", row + 1, mode + 1);
            let expected = "a shape with a finite mass, m ∫φ² dx > 0";
            ensure(is_positive(mass), place, expected, mass)?;
            all.push(found);
        }
    }
    all.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    for (mode, number) in all.iter_mut().zip(1..) {
        mode.number = number;
    }
    let nodes = along.iter().zip(lengths).enumerate();
    let nodes = nodes.map(|(i, (along_m, length_m))| Node {
        name: (i + 1).to_string(),
        along_m: *along_m,
        length_m,
    });
    Ok(BridgeModes {
        source: "MATLAB wn and phi".to_owned(),
        nodes: nodes.collect(),
        modes: all,
        ..BridgeModes::default()
    })
}

/// A mode of one motion, with the mass that goes with it; its number follows from the order of frequencies.
fn mode_of(
    omega: f64,
    motion: usize,
    values: Vec<f64>,
    lengths: &[f64],
    span: &SpanBlock,
) -> BridgeMode {
    let per_length = match motion {
        2 => span.inertia_kg_m2_m,
        _ => span.mass_kg_m,
    };
    let square: f64 = values.iter().zip(lengths).map(|(x, w)| w * x * x).sum();
    let at_node = |x: f64| std::array::from_fn(|m| if m == motion { x } else { 0.0 });
    BridgeMode {
        number: 0,
        frequency_hz: omega / TAU,
        generalised_mass: per_length * square,
        damping_ratio: 0.0,
        shape: values.into_iter().map(at_node).collect(),
    }
}
