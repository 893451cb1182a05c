//! How alike two mode shapes are: what decides whether two modes may be treated as one section.

use super::{Bridge, BridgeMode};
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

impl Bridge {
    /// The motion that carries the largest part of a mode's sum of squares: 0 vertical, 1 lateral, 2 rotation, which
    /// counts with half the width; `None` of a shape that is zero everywhere.
    pub fn main_motion(&self, mode: &BridgeMode) -> Option<usize> {
        let scale = [1.0, 1.0, 0.5 * self.width_m()];
        let part = |i: usize| -> f64 {
            let nodes = self.nodes.iter().zip(&mode.shape);
            let squares = nodes.map(|(node, s)| node.length_m * (scale[i] * s[i]).powi(2));
            squares.sum()
        };
        let parts = [part(0), part(1), part(2)];
        let moving = (0..3).filter(|i| parts[*i] > 0.0);
        moving.max_by(|a, b| parts[*a].total_cmp(&parts[*b]))
    }

    /// Its name; `none` where there is none.
    pub fn main_motion_name(&self, mode: &BridgeMode) -> &'static str {
        let motion = self.main_motion(mode);
        motion.map_or("none", |i| Dof::THREE[i].name())
    }
}
