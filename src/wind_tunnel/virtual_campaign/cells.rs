//! From the force of the model to the channels of the cells.

use super::body::Wrench;
use super::plan::Support;
use nalgebra::Vector3;

/// What the two cells say, local axes: six numbers each, N and N·m.
///
/// The forces are shared as the plan says, `f₁ = s F + C`, `f₂ = (1 − s) F − C` with the clamping force `C`; of the
/// moment that these leave, `M − Σ pᵢ × fᵢ`, the cells bear the same shares, with the clamping moment on top.
/// So `Σ fᵢ = F` and `Σ (mᵢ + pᵢ × fᵢ) = M` about the centre of rotation.
pub(super) fn readings(support: &Support, wrench: &Wrench, theta_rad: f64) -> [[f64; 6]; 2] {
    let clamping = Wrench {
        force: support.clamping_n.into(),
        moment: support.clamping_n_m.into(),
    };
    let shares = [support.share_of_first, 1.0 - support.share_of_first];
    let signs = [1.0, -1.0];
    let force = |i: usize| wrench.force * shares[i] + clamping.force * signs[i];
    let arms: Vec<Vector3<f64>> = support
        .cells
        .iter()
        .map(|cell| cell.position_at(theta_rad))
        .collect();
    let by_forces: Vector3<f64> = arms
        .iter()
        .enumerate()
        .map(|(i, p)| p.cross(&force(i)))
        .sum();
    let mut cells = [[0.0; 6]; 2];
    for (i, (cell, reading)) in support.cells.iter().zip(&mut cells).enumerate() {
        let to_local = cell.axes_at(theta_rad).transpose();
        let moment = (wrench.moment - by_forces) * shares[i] + clamping.moment * signs[i];
        let (force, moment) = (to_local * force(i), to_local * moment);
        reading[..3].copy_from_slice(force.as_slice());
        reading[3..].copy_from_slice(moment.as_slice());
    }
    cells
}
