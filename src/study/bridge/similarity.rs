//! How alike two mode shapes are: what decides whether two modes may be treated as one section.

use crate::bridge::{Bridge, BridgeMode};
use crate::error::{Error, Result};
use crate::section::{Dof, Rotation, SectionModel, Translation};
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

/// The section that a study of two modes would take: the first mode that moves mainly up and down, the first that mainly
/// turns and, where `dofs` has it, the first that moves mainly sideways, each with its mass per length `M/∫φ²`. A motion without a
/// mode of its own takes that of another, with the mass or inertia of a plate of one thickness, `I = mB²/12`.
///
/// # Errors
/// [`Error::Input`] when nothing moves.
pub fn equivalent_section(bridge: &Bridge, dofs: &[Dof]) -> Result<SectionModel> {
    let width_m = bridge.width_m();
    // mass per moment of inertia of a plate of one thickness
    let per_inertia = 12.0 / (width_m * width_m);
    let taken_from = |of: Dof, dof: Dof| {
        let (i, mut modes) = (of as usize, bridge.modes.iter());
        let mode = modes.find(|m| bridge.main_motion(m) == Some(i))?;
        let nodes = bridge.nodes.iter().zip(&mode.shape);
        let square: f64 = nodes.map(|(n, s)| n.length_m * s[i] * s[i]).sum();
        let factor = match (of == Dof::Torsion, dof == Dof::Torsion) {
            (true, false) => per_inertia,
            (false, true) => 1.0 / per_inertia,
            _ => 1.0,
        };
        let inertia = mode.generalised_mass / square * factor;
        Some((inertia, mode.frequency_hz, mode.damping_ratio))
    };
    let support = |dof: Dof| {
        let mut each = [dof].into_iter().chain(Dof::THREE);
        let found = each.find_map(|of| taken_from(of, dof));
        found.ok_or_else(|| Error::input("modes", "modes that move", "none"))
    };
    let translation = |dof: Dof| -> Result<Translation> {
        let (mass, hertz, damping) = support(dof)?;
        Ok(Translation::new(mass, hertz, damping))
    };
    let (inertia, hertz, damping) = support(Dof::Torsion)?;
    let heave = translation(Dof::Vertical)?;
    let twist = Rotation::new(inertia, hertz, damping);
    let mut section = SectionModel::two_dof(width_m, bridge.air_density_kg_m3, heave, twist);
    if dofs.contains(&Dof::Lateral) {
        section.lateral = Some(translation(Dof::Lateral)?);
    }
    Ok(section)
}
