//! Structure and self-excited forces as one linear system at a wind speed.
//!
//! The force model is taken to the axis of the section first, `G → Tᵀ G T` (see [`Structure`]).
//! Continuous models: with `P(G) = diag(B, B, B²) G diag(1/B, 1/B, 1)`,
//!
//! ```text
//! (M − ½ρB² P(e₂)) q̈ + (R − ½ρVB P(e₁)) q̇ + (K − ½ρV² P(e₀)) q = ½ρV² diag(B, B, B²) C x + w
//! ẋ = (V/B) (A x + b diag(1/B, 1/B, 1) q)
//! ```
//!
//! The added mass moves to the left and does not depend on `V`. Discrete model: equation (B.4) of the thesis,
//! corrected; the force is held over each step `Δt = Δs B/V`.

mod by_wind;
mod equilibrium;

pub use equilibrium::{EquilibriumEnd, EquilibriumPath, StaticEquilibrium, static_equilibria};

use crate::aerodynamics::{ContinuousRealization, DiscreteRealization, Realizable, Realization};
use crate::error::{Error, Result, ensure, non_negative, positive};
use crate::section::Structure;
use crate::state_space::{StateEquation, c2d, eigenvalues, first_order};
use nalgebra::{Complex, DMatrix};

/// An elastically suspended section with a realised aerodynamic model.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::RationalModel;
/// use aerodeck::aeroelastic::CoupledSection;
/// use aerodeck::section::SectionModel;
///
/// let structure = SectionModel::iabse_1_1a().structure()?;
/// let plate = RationalModel::jones_flat_plate();
/// let section = CoupledSection::with_model(&structure, &plate)?;
/// // four states of the motion, two filters of each of the two motions
/// assert_eq!(section.at(45.0)?.eigenvalues()?.len(), 8);
/// # Ok::<(), aerodeck::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct CoupledSection {
    structure: Structure,
    /// About the axis of the section.
    aerodynamics: Realization,
    /// `(M − ½ρB² P(e₂))⁻¹`, n×n.
    inverse_mass: DMatrix<f64>,
}

/// The coupled system at one wind speed, with the states `[q, q̇, x]` and without external forces.
#[derive(Debug, Clone)]
pub struct CoupledSystem {
    /// The state matrix: of `ż = A z` from a continuous model, of `z(k+1) = A z(k)` from the discrete Laguerre model.
    pub a: DMatrix<f64>,
    /// From sample to sample, s; `None` for a continuous model.
    pub step_s: Option<f64>,
}

impl CoupledSystem {
    /// Eigenvalues in continuous time, rad/s; of the sampled system the rates `ln z/Δt`, exact when the motion between two samples
    /// holds no frequency above half the sampling frequency. A pole at the origin has died out after one sample and is left out:
    /// no finite rate describes it.
    ///
    /// # Errors
    /// [`Error::Numerical`] when the iteration for the eigenvalues does not end.
    pub fn eigenvalues(&self) -> Result<Vec<Complex<f64>>> {
        let mut poles = eigenvalues(&self.a)?;
        if let Some(step_s) = self.step_s {
            poles.retain(|z| z.norm() > f64::MIN_POSITIVE);
            poles.iter_mut().for_each(|z| *z = z.ln() / step_s);
        }
        Ok(poles)
    }

    /// The eigenvalue of the state matrix that belongs to the continuous-time eigenvalue `lambda`.
    pub fn matrix_eigenvalue(&self, lambda: Complex<f64>) -> Complex<f64> {
        self.step_s.map_or(lambda, |step_s| (lambda * step_s).exp())
    }
}

impl CoupledSection {
    /// Couples a structure and a force model that has a realisation.
    pub fn with_model(structure: &Structure, model: &dyn Realizable) -> Result<Self> {
        Self::new(structure.clone(), model.realize())
    }

    /// Couples a structure and a realisation of the same degrees of freedom.
    ///
    /// # Errors
    /// [`Error::Input`] when the sizes differ, [`Error::Numerical`] when mass and added mass together are singular or
    /// negative.
    pub fn new(structure: Structure, aerodynamics: Realization) -> Result<Self> {
        let n = structure.dofs.len();
        let forces = match &aerodynamics {
            Realization::Continuous(c) => c.c.nrows().max(c.e0.nrows()),
            Realization::Discrete(d) => d.c.nrows(),
        };
        ensure(
            forces == n,
            "coupled section",
            format_args!("an aerodynamic model of {n} degrees of freedom"),
            forces,
        )?;
        let aerodynamics = at_axis(&structure, aerodynamics);
        let mut mass = structure.mass.clone();
        if let Realization::Continuous(c) = &aerodynamics {
            let half_rho_b2 = 0.5 * structure.air_density_kg_m3 * structure.width_m.powi(2);
            mass -= structure.scaled(&c.e2) * half_rho_b2;
        }
        let symmetric_part = (&mass + mass.transpose()) * 0.5;
        if symmetric_part.cholesky().is_none() {
            return Err(Error::Numerical(
                "coupled section: mass and added mass together are not positive definite".into(),
            ));
        }
        let inverse_mass = mass.try_inverse().ok_or_else(|| {
            Error::Numerical("coupled section: the mass matrix is singular".into())
        })?;
        Ok(Self {
            structure,
            aerodynamics,
            inverse_mass,
        })
    }

    /// The structure.
    pub fn structure(&self) -> &Structure {
        &self.structure
    }

    /// The realised aerodynamic model about the axis of the section.
    pub fn aerodynamics(&self) -> &Realization {
        &self.aerodynamics
    }

    /// `(M − ½ρB² P(e₂))⁻¹`, n×n.
    pub fn inverse_mass(&self) -> &DMatrix<f64> {
        &self.inverse_mass
    }

    /// Number of states `[q, q̇, x]`.
    pub fn states(&self) -> usize {
        2 * self.structure.dofs.len() + self.aerodynamics.states()
    }

    /// The coupled system at the wind speed `V` (m/s). `V = 0` is still air, for continuous models only.
    ///
    /// # Errors
    /// [`Error::Input`] for a speed that is negative, not finite, or zero with the discrete model.
    pub fn at(&self, wind_speed_m_s: f64) -> Result<CoupledSystem> {
        let system = match &self.aerodynamics {
            Realization::Continuous(_) => CoupledSystem {
                a: self.equation_at(wind_speed_m_s)?.a,
                step_s: None,
            },
            Realization::Discrete(d) => self.sampled_at(d, wind_speed_m_s)?,
        };
        let finite = system.a.iter().all(|x| x.is_finite());
        let why = "coupled system: a matrix entry is not finite";
        finite
            .then_some(system)
            .ok_or_else(|| Error::Numerical(why.into()))
    }

    /// What moves in the coupled system of a continuous model at the wind speed `V` (m/s): the equation of its states.
    ///
    /// # Errors
    /// [`Error::Input`] for a speed that is negative or not finite, [`Error::Numerical`] for a sampled model.
    pub fn equation_at(&self, wind_speed_m_s: f64) -> Result<StateEquation> {
        non_negative("wind speed", wind_speed_m_s)?;
        let Realization::Continuous(aero) = &self.aerodynamics else {
            return Err(Error::Numerical("step: the model is sampled".into()));
        };
        let s = &self.structure;
        let (n, filters) = (s.dofs.len(), aero.a.nrows());
        let rate = wind_speed_m_s / s.width_m;
        let half_rho = 0.5 * s.air_density_kg_m3;
        let q = half_rho * wind_speed_m_s * wind_speed_m_s;
        let stiffness = s.scaled(&aero.e0) * q - &s.stiffness;
        let damping = s.scaled(&aero.e1) * (half_rho * wind_speed_m_s * s.width_m) - &s.damping;
        let force_of_filters = self.force_of_filters(&aero.c, wind_speed_m_s);
        let mut a = DMatrix::zeros(2 * n + filters, 2 * n + filters);
        a.view_mut((0, n), (n, n)).fill_with_identity();
        // [K, R, C] acting on the state; the accelerations are its product with the inverse mass
        let mut force_rows = DMatrix::zeros(n, 2 * n + filters);
        force_rows.view_mut((0, 0), (n, n)).copy_from(&stiffness);
        force_rows.view_mut((0, n), (n, n)).copy_from(&damping);
        force_rows
            .view_mut((0, 2 * n), (n, filters))
            .copy_from(&force_of_filters);
        let acceleration = &self.inverse_mass * &force_rows;
        a.view_mut((n, 0), (n, 2 * n + filters))
            .copy_from(&acceleration);
        for j in 0..n {
            let scale = rate * s.dofs[j].motion_scale(s.width_m);
            a.view_mut((2 * n, j), (filters, 1))
                .copy_from(&(aero.b.column(j) * scale));
        }
        a.view_mut((2 * n, 2 * n), (filters, filters))
            .copy_from(&(&aero.a * rate));
        let mut b = DMatrix::zeros(2 * n + filters, n);
        b.view_mut((n, 0), (n, n)).copy_from(&self.inverse_mass);
        Ok(StateEquation { a, b })
    }

    fn sampled_at(&self, aero: &DiscreteRealization, wind_speed_m_s: f64) -> Result<CoupledSystem> {
        positive("wind speed", wind_speed_m_s)?;
        let s = &self.structure;
        let (n, filters) = (s.dofs.len(), aero.a.nrows());
        let step = aero.delta_s * s.width_m / wind_speed_m_s;
        let alone = self.structure_alone();
        let held = c2d(&alone.a, &alone.b, step)?;
        let force = self.force_of_filters(&aero.c, wind_speed_m_s);
        let drive = DMatrix::from_fn(filters, 2 * n, |l, j| {
            if j < n {
                aero.b[(l, j)] * s.dofs[j].motion_scale(s.width_m)
            } else {
                0.0
            }
        });
        let force_to_motion = &held.gamma_0 * &force;
        let mut a = DMatrix::zeros(2 * n + filters, 2 * n + filters);
        a.view_mut((0, 0), (2 * n, 2 * n)).copy_from(&held.phi);
        a.view_mut((0, 2 * n), (2 * n, filters))
            .copy_from(&force_to_motion);
        a.view_mut((2 * n, 0), (filters, 2 * n))
            .copy_from(&(&drive * &held.phi));
        a.view_mut((2 * n, 2 * n), (filters, filters))
            .copy_from(&(&aero.a + &drive * force_to_motion));
        let step_s = Some(step);
        Ok(CoupledSystem { a, step_s })
    }

    /// `ẋ/V = (A x + b diag(1/B, 1/B, 1) q)/B` of the filters of a continuous model at the state `[q, q̇, x]`; zero for a
    /// sampled one.
    pub fn filter_rates_per_wind(&self, state: &[f64], rates: &mut [f64]) {
        rates.fill(0.0);
        let Realization::Continuous(c) = &self.aerodynamics else {
            return;
        };
        let s = &self.structure;
        let n = s.dofs.len();
        let motion = s.dofs.iter().zip(state);
        let motion = motion.map(|(dof, x)| x * dof.motion_scale(s.width_m));
        let drives = state[2 * n..].iter().copied().chain(motion);
        let columns = c.a.column_iter().chain(c.b.column_iter());
        for (column, drive) in columns.zip(drives).filter(|(_, drive)| *drive != 0.0) {
            for (rate, a) in rates.iter_mut().zip(&column) {
                *rate += a * drive;
            }
        }
        rates.iter_mut().for_each(|rate| *rate /= s.width_m);
    }

    /// `½ρV² diag(B, B, B²) C`, n×N.
    pub fn force_of_filters(&self, c: &DMatrix<f64>, wind_speed_m_s: f64) -> DMatrix<f64> {
        let s = &self.structure;
        let q = 0.5 * s.air_density_kg_m3 * wind_speed_m_s * wind_speed_m_s;
        DMatrix::from_fn(c.nrows(), c.ncols(), |i, l| {
            q * s.dofs[i].force_scale(s.width_m) * c[(i, l)]
        })
    }

    /// `[[0, I], [−M⁻¹K, −M⁻¹R]]` and `[0; M⁻¹]` of the section without aerodynamic force.
    pub fn structure_alone(&self) -> StateEquation {
        let s = &self.structure;
        let n = s.dofs.len();
        let a = first_order(&self.inverse_mass, &-&s.stiffness, &-&s.damping);
        let mut b = DMatrix::zeros(2 * n, n);
        b.view_mut((n, 0), (n, n)).copy_from(&self.inverse_mass);
        StateEquation { a, b }
    }
}

/// The force model about the axis of the section.
fn at_axis(s: &Structure, aerodynamics: Realization) -> Realization {
    match aerodynamics {
        Realization::Continuous(c) => Realization::Continuous(ContinuousRealization {
            a: c.a,
            b: s.motion_at_axis(c.b),
            c: s.forces_at_axis(c.c),
            e0: s.at_axis(c.e0),
            e1: s.at_axis(c.e1),
            e2: s.at_axis(c.e2),
        }),
        Realization::Discrete(d) => Realization::Discrete(DiscreteRealization {
            b: s.motion_at_axis(d.b),
            c: s.forces_at_axis(d.c),
            ..d
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::{RationalModel, Realizable};
    use crate::section::SectionModel;
    use crate::state_space::damping_ratio;

    /// `ẍ + 2ζω₀ẋ + ω₀²x = u`, continuous and sampled with its input held: the damping table has the closed form for both, and
    /// holding changes nothing of the answer to a constant input.
    #[test]
    fn a_sampled_oscillator_has_the_damping_of_the_continuous_one() {
        let (frequency, ratio, h) = (3.0, 0.02, 0.1);
        let restoring = [-frequency * frequency, -2.0 * ratio * frequency];
        let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, restoring[0], restoring[1]]);
        let b = DMatrix::from_row_slice(2, 1, &[0.0, 1.0]);
        let held = c2d(&a, &b, h).unwrap();
        for z in eigenvalues(&held.phi).unwrap() {
            assert!((z.norm() - (-ratio * frequency * h).exp()).abs() < 1e-14);
        }
        let static_gain = 1.0 / (frequency * frequency);
        let passed = DMatrix::identity(2, 2) - &held.phi;
        for (stiffness, push) in [(-&a, b), (passed, held.gamma_0)] {
            let gain = stiffness.lu().solve(&push).unwrap()[0];
            assert!((gain / static_gain - 1.0).abs() < 1e-12);
        }
        for (a, step_s) in [(a, None), (held.phi, Some(h))] {
            let modes = CoupledSystem { a, step_s }.eigenvalues().unwrap();
            assert_eq!(modes.len(), 2);
            for pole in modes {
                assert!((pole.norm() / frequency - 1.0).abs() < 1e-12);
                assert!((damping_ratio(pole) / ratio - 1.0).abs() < 1e-12);
            }
        }
    }

    /// Eigenvalues of the IABSE 1.1a structure with Jones's rational function, six printed decimals.
    #[test]
    fn jones_eigenvalues() {
        let section = CoupledSection::new(
            SectionModel::iabse_1_1a().structure().unwrap(),
            RationalModel::jones_flat_plate().realize(),
        )
        .unwrap();
        let cases = [
            (
                45.0,
                [
                    -0.110397, -0.053759, -0.870968, -0.743344, -0.132097, -0.122668,
                ],
                [0.641068, 1.601890],
            ),
            (
                15.0,
                [
                    -0.023454, -0.016703, -0.290323, -0.283354, -0.044032, -0.043766,
                ],
                [0.620836, 1.724254],
            ),
        ];
        for (speed, decays, frequencies) in cases {
            let found = section.at(speed).unwrap().eigenvalues().unwrap();
            assert_eq!(found.len(), 8);
            let frequencies = frequencies.into_iter().chain([0.0; 4]);
            for (re, im) in decays.into_iter().zip(frequencies) {
                let is_near = |z: &Complex<f64>| (z - Complex::new(re, im)).norm() < 8e-7;
                assert!(found.iter().any(is_near), "{re} {im}i at {speed} m/s");
            }
        }
    }
}
