//! Quasi-steady theory beside the other routes: from static coefficients where the study gives them, else the
//! low-frequency limit of the derivatives.

use super::super::SpeedRange;
use super::limit::limit_onset;
use super::{Forces, RouteTable, THEORY};
use crate::aerodynamics::RationalModel;
use crate::aerodynamics::quasi_steady::QuasiSteady;
use crate::aeroelastic::{CoupledSection, EquilibriumEnd, static_equilibria};
use crate::error::Result;
use crate::flutter::{
    OnsetMethod, divergence_with_forces, find_onset, quasi_steady_modes, quasi_steady_onset,
    trace_modes,
};
use crate::section::Structure;
use crate::units::ReducedFrequency;

impl RouteTable {
    /// Quasi-steady theory with static coefficients, each wind speed about its own equilibrium (1.31).
    pub(super) fn add_static_coefficients(
        &mut self,
        speeds: &SpeedRange,
        structure: &Structure,
        theory: &QuasiSteady,
    ) -> Result<()> {
        let found = quasi_steady_onset(THEORY, structure, theory, &speeds.search())?;
        // the mode at onset belongs to the linear forces about the equilibrium there
        let speed = found.search.onset().map(|o| o.at.speed_m_s);
        let path = static_equilibria(structure, theory, speed.as_slice())?;
        let rotation = path.points.first().map_or(0.0, |p| p.rotation_rad);
        let linear = theory.linearised(rotation)?;
        let divergence_m_s = match found.equilibrium_end {
            Some(EquilibriumEnd::Divergence { speed_m_s, .. }) => Some(speed_m_s),
            _ => None,
        };
        let forces = Forces {
            name: THEORY.into(),
            model: &linear,
            structure,
            speeds,
            tested: None,
            divergence_m_s,
            quasi_steady_m_s: speed,
        };
        let mut route = forces.route(OnsetMethod::Eigenvalues, found.search)?;
        route.low_frequency_limit = true;
        self.routes.push(route);
        let path = static_equilibria(structure, theory, &speeds.curve_speeds_m_s())?;
        self.draw(
            &forces,
            quasi_steady_modes(THEORY, structure, theory, &path),
        );
        Ok(())
    }

    /// The affine limit of the deck's own forces.
    pub(super) fn add_quasi_steady(
        &mut self,
        speeds: &SpeedRange,
        structure: &Structure,
        limit: &RationalModel,
        from: Option<ReducedFrequency>,
    ) -> Result<()> {
        let forces = Forces {
            name: "quasi-steady limit".into(),
            model: limit,
            structure,
            speeds,
            tested: None,
            divergence_m_s: divergence_with_forces(structure, limit)?,
            quasi_steady_m_s: limit_onset(speeds, structure, limit)?,
        };
        let section = CoupledSection::with_model(structure, limit)?;
        let found = find_onset(&forces.name, &section, &speeds.search(), None)?;
        let mut route = forces.route(OnsetMethod::Eigenvalues, found)?;
        route.low_frequency_limit = true;
        route.warnings.push(match from {
            Some(k) => format!(
                "no static coefficients given: slopes and rates from the derivatives at K = {:.3}, good for K well below \
                 that only",
                k.full_width()
            ),
            None => "circulation without lag, C = 1".into(),
        });
        self.routes.push(route);
        let curves = trace_modes(&forces.name, &section, &speeds.curve_speeds_m_s());
        self.draw(&forces, curves);
        Ok(())
    }
}
