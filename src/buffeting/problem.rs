//! What a buffeting computation needs: section, self-excited forces, gust forces, turbulence.

use super::admittance::Admittance;
use super::spectrum::{GustComponent, GustSpectrum};
use crate::aerodynamics::Transfer;
use crate::aerodynamics::quasi_steady::LinearQuasiSteady;
use crate::error::{Error, Result};
use crate::flutter::impedance;
use crate::section::{Dof, Structure};
use crate::units::ReducedFrequency;
use nalgebra::{Complex, DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// One component of the turbulence and how the deck takes it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gust {
    /// Spectrum and scales.
    pub spectrum: GustSpectrum,
    /// Factor on the amplitude of the force.
    #[serde(default)]
    pub admittance: Admittance,
}

/// Turbulence with independent components; one that is left out is zero.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Turbulence {
    /// `u`, along the mean wind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub along: Option<Gust>,
    /// `w`, upwards.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vertical: Option<Gust>,
}

impl Turbulence {
    /// One component, if it is there.
    pub(crate) fn component(&self, component: GustComponent) -> Option<&Gust> {
        match component {
            GustComponent::Along => self.along.as_ref(),
            GustComponent::Vertical => self.vertical.as_ref(),
        }
    }

    /// Checks every value.
    ///
    /// # Errors
    /// [`Error::Input`] naming the key below `place`; for no component at all.
    pub(crate) fn validate(&self, place: &str) -> Result<()> {
        let parts = [("along", &self.along), ("vertical", &self.vertical)];
        if parts.iter().all(|(_, gust)| gust.is_none()) {
            return Err(Error::input(
                place,
                "`along`, `vertical` or both",
                "neither",
            ));
        }
        for (key, gust) in parts {
            if let Some(gust) = gust {
                gust.spectrum.validate(&format!("{place}.{key}.spectrum"))?;
                gust.admittance
                    .validate(&format!("{place}.{key}.admittance"))?;
            }
        }
        Ok(())
    }
}

/// Dimensionless forces by the gusts without admittance: `q = A (u/V, w/V)`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct GustForces {
    dofs: Vec<Dof>,
    /// n×2.
    matrix: DMatrix<f64>,
}

impl GustForces {
    /// The thin plate: lift `2π w/V`, moment about mid-chord `(π/2) w/V`.
    pub(crate) fn flat_plate() -> Self {
        Self {
            dofs: Dof::TWO.to_vec(),
            matrix: DMatrix::from_row_slice(2, 2, &[0.0, 2.0 * PI, 0.0, PI / 2.0]),
        }
    }

    /// The buffeting matrix of quasi-steady theory (1.12d).
    pub(crate) fn quasi_steady(theory: &LinearQuasiSteady) -> Self {
        Self {
            dofs: theory.dofs().to_vec(),
            matrix: theory.buffeting().clone(),
        }
    }

    /// Degrees of freedom of the rows.
    pub(crate) fn dofs(&self) -> &[Dof] {
        &self.dofs
    }
}

/// A section in turbulence.
#[derive(Clone, Copy)]
pub(crate) struct BuffetingProblem<'a> {
    /// The suspended section.
    pub structure: &'a Structure,
    /// Its self-excited forces.
    pub model: &'a dyn Transfer,
    /// Its gust forces.
    pub forces: &'a GustForces,
    /// The turbulence.
    pub turbulence: &'a Turbulence,
}

impl BuffetingProblem<'_> {
    /// Checks that all parts have the same degrees of freedom.
    pub(crate) fn validate(&self) -> Result<()> {
        let dofs = &self.structure.dofs;
        for (place, found) in [
            ("buffeting: model", self.model.dofs()),
            ("buffeting: gust forces", self.forces.dofs()),
        ] {
            if found != dofs.as_slice() {
                return Err(Error::input(
                    place,
                    format!("the section's degrees of freedom {}", Dof::names(dofs)),
                    Dof::names(found),
                ));
            }
        }
        self.turbulence.validate("turbulence")
    }

    /// Force per unit length by a gust of 1 m/s of one component at a frequency, admittance included (n).
    pub(crate) fn gust_force(
        &self,
        component: GustComponent,
        frequency_hz: f64,
        speed_m_s: f64,
    ) -> DVector<Complex<f64>> {
        let s = self.structure;
        let k = ReducedFrequency::from_hertz(frequency_hz, s.width_m, speed_m_s);
        let admittance = self
            .turbulence
            .component(component)
            .map_or(Complex::default(), |gust| gust.admittance.amplitude(k));
        let column = match component {
            GustComponent::Along => 0,
            GustComponent::Vertical => 1,
        };
        let half_rho_v = 0.5 * s.air_density_kg_m3 * speed_m_s;
        let forces = s.forces_at_axis(self.forces.matrix.clone());
        DVector::from_fn(s.dofs.len(), |i, _| {
            let scale = half_rho_v * s.dofs[i].force_scale(s.width_m);
            admittance * (scale * forces[(i, column)])
        })
    }

    /// `−ω²M + iωR + K − ½ρV² P(G)`, n×n.
    pub(super) fn impedance(
        &self,
        frequency_hz: f64,
        speed_m_s: f64,
    ) -> Result<DMatrix<Complex<f64>>> {
        impedance(self.structure, self.model, speed_m_s, TAU * frequency_hz)
    }

    /// Displacements by a gust of 1 m/s of each component (n×2), `H` times the gust forces; the column of a component that
    /// is left out is zero.
    pub(crate) fn gust_to_motion(
        &self,
        frequency_hz: f64,
        speed_m_s: f64,
    ) -> Result<DMatrix<Complex<f64>>> {
        let forces = GustComponent::BOTH.map(|c| self.gust_force(c, frequency_hz, speed_m_s));
        let forces = DMatrix::from_columns(&forces);
        self.impedance(frequency_hz, speed_m_s)?
            .lu()
            .solve(&forces)
            .ok_or_else(|| {
                Error::Numerical(format!(
                    "buffeting: the impedance is singular at {frequency_hz} Hz and {speed_m_s} m/s"
                ))
            })
    }
}
