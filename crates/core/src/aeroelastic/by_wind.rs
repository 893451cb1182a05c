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
        let mut powers = self.accelerations_by_wind().map(|rows| {
            let mut power = DMatrix::zeros(states, states);
            power.view_mut((n, 0), rows.shape()).copy_from(&rows);
            power
        });
        powers[0].view_mut((0, n), (n, n)).fill_with_identity();
        for (j, dof) in s.dofs.iter().enumerate() {
            let scale = dof.motion_scale(s.width_m) / s.width_m;
            let mut place = powers[1].view_mut((2 * n, j), (filters, 1));
            place.copy_from(&(c.b.column(j) * scale));
        }
        let mut place = powers[1].view_mut((2 * n, 2 * n), (filters, filters));
        place.copy_from(&(&c.a / s.width_m));
        Some(powers)
    }

    /// The rows that give `q̈` on `[q, q̇, x]` without external force, n×N, by the power of the wind speed.
    fn accelerations_by_wind(&self) -> [DMatrix<f64>; 3] {
        let (s, n) = (self.structure(), self.structure().dofs.len());
        let [mut still, by_wind, by_pressure] = self.forces_by_wind();
        still.columns_mut(0, n).copy_from(&-&s.stiffness);
        still.columns_mut(n, n).copy_from(&-&s.damping);
        [still, by_wind, by_pressure].map(|forces| self.inverse_mass() * forces)
    }

    /// The rows that give the forces of air without mass on `[q, q̇, x]`, n×N, by the power of the wind speed.
    fn forces_by_wind(&self) -> [DMatrix<f64>; 3] {
        let (s, n) = (self.structure(), self.structure().dofs.len());
        let half_rho = 0.5 * s.air_density_kg_m3;
        let mut powers = std::array::from_fn(|_| DMatrix::zeros(n, self.states()));
        let c = match self.aerodynamics() {
            Realization::Continuous(c) => {
                let [_, by_wind, by_pressure] = &mut powers;
                let mut place = by_wind.columns_mut(n, n);
                place.copy_from(&(s.scaled(&c.e1) * (half_rho * s.width_m)));
                let mut place = by_pressure.columns_mut(0, n);
                place.copy_from(&(s.scaled(&c.e0) * half_rho));
                &c.c
            }
            Realization::Discrete(d) => &d.c,
        };
        let by_filters = self.force_of_filters(c, 1.0);
        let mut place = powers[2].columns_mut(2 * n, by_filters.ncols());
        place.copy_from(&by_filters);
        powers
    }

    /// The rows that give `[q̈, F]` (accelerations and self-excited forces, 2n) on `[q, q̇, x, w]`, by the power of the wind
    /// speed: `F` is the force of air without mass, and that of the added mass by the acceleration.
    pub fn output_rows_by_wind(&self) -> [DMatrix<f64>; 3] {
        let s = self.structure();
        let (n, states) = (s.dofs.len(), self.states());
        let added_mass = match self.aerodynamics() {
            Realization::Continuous(c) => {
                s.scaled(&c.e2) * (0.5 * s.air_density_kg_m3 * s.width_m * s.width_m)
            }
            Realization::Discrete(_) => DMatrix::zeros(n, n),
        };
        let mut powers = self.forces_by_wind().map(|forces| {
            let mut rows = DMatrix::zeros(2 * n, states + n);
            rows.view_mut((n, 0), (n, states)).copy_from(&forces);
            rows
        });
        let mut accelerations = self
            .accelerations_by_wind()
            .map(|a| a.resize_horizontally(states + n, 0.0));
        accelerations[0]
            .columns_mut(states, n)
            .copy_from(self.inverse_mass());
        for (rows, accelerations) in powers.iter_mut().zip(accelerations) {
            rows.rows_mut(0, n).copy_from(&accelerations);
            let mut forces = rows.rows_mut(n, n);
            forces += &added_mass * accelerations;
        }
        powers
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
            let expected = section.equation_at(wind).unwrap().a;
            let found = &a0 + &a1 * wind + &a2 * (wind * wind);
            assert!((found - &expected).amax() <= 1e-15 * expected.amax());
        }
    }
}
