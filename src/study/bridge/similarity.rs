//! How alike two mode shapes are: what decides whether two modes may be treated as one section.

use crate::bridge::{Bridge, BridgeMode};
use crate::section::Dof;
use serde::Serialize;

/// Similarity of a vertical and a torsional mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Similarity {
    /// Number of the mode whose vertical displacement counts.
    pub vertical_mode: usize,
    /// Number of the mode whose rotation counts.
    pub torsional_mode: usize,
    /// `(∫φ_y φ_θ)²/(∫φ_y² ∫φ_θ²)`: 1 for like shapes, 0 for shapes that do not feel each other.
    pub similarity: f64,
}

/// Similarities of every mode that moves mainly up and down with every mode that mainly turns, the most alike first.
///
/// A mode counts as what carries the largest part of its sum of squares, rotations times half the width.
pub fn similarities(bridge: &Bridge) -> Vec<Similarity> {
    let kind = |of: Dof| {
        let modes = bridge.modes.iter();
        modes.filter(move |m| bridge.main_motion(m) == Some(of as usize))
    };
    let product = |a: &BridgeMode, i: usize, b: &BridgeMode, j: usize| -> f64 {
        let shapes = a.shape.iter().zip(&b.shape).zip(&bridge.nodes);
        let each = shapes.map(|((a, b), node)| node.length_m * a[i] * b[j]);
        each.sum()
    };
    let mut all = Vec::new();
    for y in kind(Dof::Vertical) {
        for theta in kind(Dof::Torsion) {
            let squares = product(y, 0, y, 0) * product(theta, 2, theta, 2);
            all.push(Similarity {
                vertical_mode: y.number,
                torsional_mode: theta.number,
                similarity: product(y, 0, theta, 2).powi(2) / squares,
            });
        }
    }
    all.sort_by(|a, b| b.similarity.total_cmp(&a.similarity));
    all
}
