//! Sums over the nodes of a group: `I_ab^ij = Σ_n w_n φ_a,i(n) φ_b,j(n)`.

use super::{Bridge, StripGroup};
use crate::aerodynamics::TransferMatrix;
use crate::section::Dof;
use nalgebra::DMatrix;

/// A group and its sums in mass-normalised modes, one matrix for each force and motion.
#[derive(Debug, Clone)]
pub(super) struct GroupSums {
    pub(super) group: StripGroup,
    /// Row by row in the order of its degrees of freedom, each modes×modes.
    sums: Vec<DMatrix<f64>>,
}

impl GroupSums {
    /// Of the group's nodes, with each shape divided by the root of its generalised mass; dampers move no node.
    pub(super) fn new(bridge: &Bridge, group: &StripGroup) -> Self {
        let dofs = group.forces.dofs();
        let weighted = |dof: &Dof, power: f64| {
            DMatrix::from_fn(group.nodes.len(), bridge.coordinates(), |n, m| {
                let (node, mode) = (group.nodes[n], bridge.modes.get(m));
                mode.map_or(0.0, |mode| {
                    let value = mode.shape[node][*dof as usize];
                    value * bridge.nodes[node].length_m.powf(power) / mode.generalised_mass.sqrt()
                })
            })
        };
        let forces: Vec<_> = dofs.iter().map(|d| weighted(d, 1.0).transpose()).collect();
        let motions: Vec<_> = dofs.iter().map(|d| weighted(d, 0.0)).collect();
        let pairs = forces
            .iter()
            .flat_map(|f| motions.iter().map(move |m| f * m));
        Self {
            sums: pairs.collect(),
            group: group.clone(),
        }
    }

    /// `Σ_ij s_ij g_ij I^ij` with the physical scale `s_ij = diag(B, B, B²)_i diag(1/B, 1/B, 1)_j`, modes×modes.
    pub(super) fn modal<T>(&self, g: &DMatrix<T>) -> DMatrix<T>
    where
        T: nalgebra::ComplexField<RealField = f64>,
    {
        let (dofs, width_m) = (self.group.forces.dofs(), self.group.width_m);
        let modes = self.sums[0].nrows();
        let mut total = DMatrix::<T>::zeros(modes, modes);
        for (i, force) in dofs.iter().enumerate() {
            for (j, motion) in dofs.iter().enumerate() {
                let scale = force.force_scale(width_m) * motion.motion_scale(width_m);
                let factor = g[(i, j)].clone().scale(scale);
                for (t, s) in total.iter_mut().zip(&self.sums[i * dofs.len() + j]) {
                    *t += factor.clone().scale(*s);
                }
            }
        }
        total
    }

    /// Adds `factor` times the same to the real and the imaginary parts of a matrix, column by column: the forces of every
    /// step of a p-k iteration, which are asked for very often.
    pub(super) fn add_modal(
        &self,
        g: &TransferMatrix,
        factor: f64,
        real: &mut [f64],
        imaginary: &mut [f64],
    ) {
        let (dofs, width_m) = (self.group.forces.dofs(), self.group.width_m);
        for (i, force) in dofs.iter().enumerate() {
            for (j, motion) in dofs.iter().enumerate() {
                let scale = factor * force.force_scale(width_m) * motion.motion_scale(width_m);
                let value = g[(i, j)] * scale;
                let sums = self.sums[i * dofs.len() + j].as_slice();
                for (sum, s) in real.iter_mut().zip(sums) {
                    *sum += value.re * s;
                }
                for (sum, s) in imaginary.iter_mut().zip(sums) {
                    *sum += value.im * s;
                }
            }
        }
    }
}
