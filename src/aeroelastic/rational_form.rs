//! Rational functions coupled with the section as the thesis writes them: (1.25)–(1.30), (1.33) and (1.34), with the
//! signs corrected.
//!
//! ```text
//! F = A₁ X + A₂ Ẋ + A₃ Ẍ + Q Δ        A₁ = ½ρV² P(a₁), A₂ = ½ρVB P(a₂), A₃ = ½ρB² P(a₃), Q = ½ρV² [P(a₄) P(a₅) …]
//! E Ẋ + B Δ̇ + D Δ = 0                 E = −[I I …]ᵀ, B = I, D = (V/B) diag(d₁I, d₂I, …)
//! ```
//!
//! so that `δ̇_l = Ẋ − (d_l V/B) δ_l`: printed with `E = +[I I …]ᵀ` and `δ̇ = X − …`, which turns every lag force round.
//! `P(G) = diag(B, B, B²) G diag(1/B, 1/B, 1)` in the order of the section's degrees of freedom. Lags of each force take
//! one block a lag of any force. The thesis leaves out the added mass A₃, which is zero then.

use crate::aerodynamics::RationalModel;
use crate::error::{Error, Result, non_negative};
use crate::section::Structure;
use crate::state_space::eigenvalues;
use nalgebra::{Complex, DMatrix};

/// Self-excited forces in state space at one wind speed, (1.25)–(1.30); n degrees of freedom, N blocks of lags.
#[derive(Debug, Clone, PartialEq)]
pub struct RationalForces {
    /// Aerodynamic stiffness, n×n, N/m² and its moments.
    pub a1: DMatrix<f64>,
    /// Aerodynamic damping, n×n.
    pub a2: DMatrix<f64>,
    /// Added mass, n×n.
    pub a3: DMatrix<f64>,
    /// Forces of the lag states, n×nN.
    pub q: DMatrix<f64>,
    /// nN×n.
    pub e: DMatrix<f64>,
    /// nN×nN.
    pub b: DMatrix<f64>,
    /// nN×nN, 1/s.
    pub d: DMatrix<f64>,
}

/// The coupled system `L ż = R z` with `z = [X, Ẋ, Δ]`: (1.33) as a descriptor system.
#[derive(Debug, Clone, PartialEq)]
pub struct RationalDescriptor {
    /// `diag(I, M − A₃, B)`.
    pub left: DMatrix<f64>,
    /// `[0 I 0; A₁ − K, A₂ − R, Q; 0, −E, −D]`.
    pub right: DMatrix<f64>,
}

impl RationalForces {
    /// The matrices for a section of this structure at `speed_m_s`.
    ///
    /// # Errors
    /// [`Error::Input`] for a model that is not valid or of other degrees of freedom, and a speed that cannot be.
    pub fn new(structure: &Structure, model: &RationalModel, speed_m_s: f64) -> Result<Self> {
        model.validate()?;
        non_negative("wind speed", speed_m_s)?;
        if model.dofs != structure.dofs {
            return Err(Error::input(
                "rational functions",
                format!("the degrees of freedom {:?}", structure.dofs),
                format!("{:?}", model.dofs),
            ));
        }
        let (n, width) = (structure.dofs.len(), structure.width_m);
        let half_rho = 0.5 * structure.air_density_kg_m3;
        let pressure = half_rho * speed_m_s * speed_m_s;
        let blocks = blocks(model);
        let size = n * blocks.len();
        let mut forces = Self {
            a1: structure.to_physical(&model.a1) * pressure,
            a2: structure.to_physical(&model.a2) * (half_rho * speed_m_s * width),
            a3: structure.to_physical(&model.a3) * (half_rho * width * width),
            q: DMatrix::zeros(n, size),
            e: DMatrix::zeros(size, n),
            b: DMatrix::identity(size, size),
            d: DMatrix::zeros(size, size),
        };
        let minus = -DMatrix::<f64>::identity(n, n);
        for (l, (lag, term)) in blocks.into_iter().enumerate() {
            let q = structure.to_physical(&term) * pressure;
            forces.q.view_mut((0, l * n), (n, n)).copy_from(&q);
            forces.e.view_mut((l * n, 0), (n, n)).copy_from(&minus);
            for i in 0..n {
                forces.d[(l * n + i, l * n + i)] = lag * speed_m_s / width;
            }
        }
        Ok(forces)
    }
}

/// Each different lag with its n×n matrix: shared lags have one each, lags of each force only the row of their force.
fn blocks(model: &RationalModel) -> Vec<(f64, DMatrix<f64>)> {
    let n = model.dofs.len();
    let mut blocks: Vec<(f64, DMatrix<f64>)> = Vec::new();
    for (l, term) in model.lag_terms.iter().enumerate() {
        for i in 0..n {
            let lag = model.lags.of_force(i)[l];
            let at = blocks.iter().position(|(d, _)| *d == lag);
            let at = at.unwrap_or_else(|| {
                blocks.push((lag, DMatrix::zeros(n, n)));
                blocks.len() - 1
            });
            let mut row = blocks[at].1.row_mut(i);
            row += term.row(i);
        }
    }
    blocks
}

impl RationalDescriptor {
    /// Couples the structure with the forces, (1.33).
    ///
    /// # Errors
    /// Those of [`RationalForces::new`].
    pub fn new(structure: &Structure, model: &RationalModel, speed_m_s: f64) -> Result<Self> {
        let f = RationalForces::new(structure, model, speed_m_s)?;
        let (n, lags) = (structure.dofs.len(), f.d.nrows());
        let size = 2 * n + lags;
        let mut left = DMatrix::identity(size, size);
        left.view_mut((n, n), (n, n))
            .copy_from(&(&structure.mass - &f.a3));
        left.view_mut((2 * n, 2 * n), (lags, lags)).copy_from(&f.b);
        let mut right = DMatrix::zeros(size, size);
        right.view_mut((0, n), (n, n)).fill_with_identity();
        for (column, block) in [
            (0, &f.a1 - &structure.stiffness),
            (n, &f.a2 - &structure.damping),
            (2 * n, f.q),
        ] {
            right.view_mut((n, column), block.shape()).copy_from(&block);
        }
        right.view_mut((2 * n, n), (lags, n)).copy_from(&-f.e);
        right
            .view_mut((2 * n, 2 * n), (lags, lags))
            .copy_from(&-f.d);
        Ok(Self { left, right })
    }

    /// The matrix of (1.34), `ż = L⁻¹R z`.
    ///
    /// # Errors
    /// [`Error::Numerical`] when mass and added mass together are singular.
    pub fn state_matrix(&self) -> Result<DMatrix<f64>> {
        self.left.clone().lu().solve(&self.right).ok_or_else(|| {
            Error::Numerical("rational functions: mass and added mass are singular".into())
        })
    }

    /// Its eigenvalues, rad/s.
    ///
    /// # Errors
    /// Those of [`RationalDescriptor::state_matrix`] and [`eigenvalues`].
    pub fn eigenvalues(&self) -> Result<Vec<Complex<f64>>> {
        eigenvalues(&self.state_matrix()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::{AerodynamicModel, Lags};
    use crate::aeroelastic::CoupledSection;
    use crate::section::SectionModel;
    use crate::state_space::complex;

    fn standard(section: &SectionModel, model: &RationalModel, speed: f64) -> Vec<Complex<f64>> {
        let aero = model.realize().unwrap();
        let coupled = CoupledSection::new(section.structure().unwrap(), aero).unwrap();
        coupled.at(speed).unwrap().eigenvalues().unwrap()
    }

    fn distance(z: Complex<f64>, others: &[Complex<f64>]) -> f64 {
        let distances = others.iter().map(|w| (w - z).norm());
        distances.fold(f64::INFINITY, f64::min)
    }

    /// (1.34) against the other choice of lag states (`x = r − δ`, driven by the displacement): the same eigenvalues to
    /// rounding, and det(λL − R) = 0 at each without any inverse, relative to a shift of λ by a millionth of itself.
    #[test]
    fn eigenvalues_are_those_of_the_standard_route() {
        let jones = RationalModel::jones_flat_plate();
        for (section, speeds) in [
            (SectionModel::iabse_1_1a(), [15.0, 45.0, 76.679]),
            (SectionModel::table_4_1(), [5.0, 20.0, 39.0]),
        ] {
            let structure = section.structure().unwrap();
            for speed in speeds {
                let descriptor = RationalDescriptor::new(&structure, &jones, speed).unwrap();
                let expected = standard(&section, &jones, speed);
                let found = descriptor.eigenvalues().unwrap();
                assert_eq!(found.len(), expected.len());
                let size = expected.iter().map(|z| z.norm()).fold(0.0, f64::max);
                for z in &found {
                    assert!(distance(*z, &expected) < 1e-11 * size, "{z} at {speed}");
                }
                let determinant = |z: Complex<f64>| {
                    (complex(&descriptor.left) * z - complex(&descriptor.right))
                        .determinant()
                        .norm()
                };
                for z in &expected {
                    assert!(determinant(*z) < 1e-4 * determinant(z * 1.000_001), "{z}");
                }
            }
        }
    }

    /// Lags of each force: (1.34) repeats every motion for every lag, so it has the standard route's eigenvalues and
    /// besides them −dV/B of states that no force sees.
    #[test]
    fn lags_of_each_force_are_contained() {
        let mut model = RationalModel::jones_flat_plate();
        let lags = [[0.08, 0.7], [0.2, 0.5]];
        model.lags = Lags::PerForce(lags.map(|r| r.to_vec()).to_vec());
        let section = SectionModel::iabse_1_1a();
        let structure = section.structure().unwrap();
        let speed = 45.0;
        let descriptor = RationalDescriptor::new(&structure, &model, speed).unwrap();
        let mut expected = standard(&section, &model, speed);
        assert_eq!(expected.len(), 8);
        for d in lags.iter().flatten() {
            expected.push(Complex::new(-d * speed / section.width_m, 0.0));
        }
        let found = descriptor.eigenvalues().unwrap();
        assert_eq!(found.len(), 12);
        for z in &expected {
            assert!(distance(*z, &found) < 1e-9, "{z}");
        }
        for z in &found {
            assert!(distance(*z, &expected) < 1e-9, "{z}");
        }
    }

    /// Signs of (1.29): the force of the lag states against a step of motion is that of (1.27), X − (dV/B)∫, which for a
    /// step is e^{−dVt/B}: positive, decaying, with the matrix a₄ itself at the start.
    #[test]
    fn a_step_of_motion_decays() {
        let section = SectionModel::iabse_1_1a();
        let structure = section.structure().unwrap();
        let jones = RationalModel::jones_flat_plate();
        let speed = 30.0;
        let f = RationalForces::new(&structure, &jones, speed).unwrap();
        // Ẋ is an impulse: Δ jumps by −B⁻¹E, then Δ̇ = −B⁻¹D Δ
        let jump = -&f.e;
        let rate = -(&f.d * &jump);
        let q = 0.5 * structure.air_density_kg_m3 * speed * speed;
        let at_once = &f.q * &jump;
        let expected = structure.to_physical(&(&jones.lag_terms[0] + &jones.lag_terms[1])) * q;
        assert!((at_once - &expected).amax() < 1e-12 * expected.amax());
        for l in 0..2 {
            let decay = rate[(2 * l, 0)] / jump[(2 * l, 0)];
            let d = jones.lags.of_force(0)[l] * speed / structure.width_m;
            assert!((decay + d).abs() < 1e-14);
        }
    }

    #[test]
    fn other_degrees_of_freedom_are_refused() {
        let structure = SectionModel::table_4_1().structure().unwrap();
        let mut model = RationalModel::jones_flat_plate();
        assert!(RationalDescriptor::new(&structure, &model, -1.0).is_err());
        model.dofs.reverse();
        let message = RationalDescriptor::new(&structure, &model, 10.0)
            .unwrap_err()
            .to_string();
        assert!(message.contains("the degrees of freedom"), "{message}");
    }
}
