//! The state matrix of a continuous model as a polynomial of the wind speed.

use super::CoupledSection;
use crate::aerodynamics::Realization;
use nalgebra::DMatrix;

impl CoupledSection {
    /// The matrices of `A₀ + V A₁ + V² A₂`, the state matrix of [`at`](Self::at); `None` for sampled models.
    pub fn state_matrix_by_wind(&self) -> Option<[DMatrix<f64>; 3]> {
        let Realization::Continuous(c) = self.aerodynamics() else {
            return None;
        };
        let (s, states) = (self.structure(), self.states());
        let (n, filters) = (s.dofs.len(), c.a.nrows());
        let half_rho = 0.5 * s.air_density_kg_m3;
        let mut powers: [DMatrix<f64>; 3] = std::array::from_fn(|_| DMatrix::zeros(states, states));
        powers[0].view_mut((0, n), (n, n)).fill_with_identity();
        // accelerations by displacements and rates
        let mass = self.inverse_mass();
        let accelerations = [
            (0, 0, -(mass * &s.stiffness)),
            (0, n, -(mass * &s.damping)),
            (1, n, mass * s.scaled(&c.e1) * (half_rho * s.width_m)),
            (2, 0, mass * s.scaled(&c.e0) * half_rho),
            (2, 2 * n, mass * self.force_of_filters(&c.c, 1.0)),
        ];
        for (power, column, block) in &accelerations {
            let mut place = powers[*power].view_mut((n, *column), block.shape());
            place.copy_from(block);
        }
        for (j, dof) in s.dofs.iter().enumerate() {
            let scale = dof.motion_scale(s.width_m) / s.width_m;
            let mut place = powers[1].view_mut((2 * n, j), (filters, 1));
            place.copy_from(&(c.b.column(j) * scale));
        }
        let mut place = powers[1].view_mut((2 * n, 2 * n), (filters, filters));
        place.copy_from(&(&c.a / s.width_m));
        Some(powers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::RationalModel;
    use crate::section::SectionModel;

    #[test]
    fn the_polynomial_is_the_state_matrix() {
        let structure = SectionModel::iabse_1_1a().structure().unwrap();
        let plate = RationalModel::jones_flat_plate();
        let section = CoupledSection::with_model(&structure, &plate).unwrap();
        let [a0, a1, a2] = section.state_matrix_by_wind().unwrap();
        for wind in [0.0, 3.0, 45.0] {
            let expected = section.continuous_at(wind).unwrap().a;
            let found = &a0 + &a1 * wind + &a2 * (wind * wind);
            assert!((found - &expected).amax() <= 1e-15 * expected.amax());
        }
    }
}
