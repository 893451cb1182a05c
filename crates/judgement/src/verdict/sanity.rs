//! Onset formulas of handbooks: lines to compare with, not results.
//!
//! Both are fits to the flat plate without structural damping, written here for full width `B` with
//! `μ = πρB²/(2m)` and `ν = 8J/(mB²)`:
//!
//! - A. Selberg, E. Hjorth-Hansen, *Aerodynamic stability and related aspects of suspension bridges*, Symposium on
//!   Suspension Bridges, Lisbon (1966): `V = 0.44 · 2πf_θ B √((1 − γ²) √ν/μ)`, and the same with a rounded factor as
//!   handbooks print it, `V = 3.72 f_θ B √(m r/(ρB³) (1 − γ²))`;
//! - Y. Rocard, *Instabilité des ponts suspendus dans le vent*, National Physical Laboratory, Teddington, paper 10
//!   (1963): `V = 0.443 · 2πf_θ B √((1 − γ²)/μ · 2ν/(1 + ν))`,
//!
//! with `γ = f_y/f_θ` and `r² = J/m`.

use crate::section::{Dof, Structure};
use serde::Serialize;
use std::f64::consts::{PI, TAU};

/// Handbook onsets of a section, m/s.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SanityLines {
    /// Selberg's formula with the factor 0.44.
    pub selberg_m_s: f64,
    /// Selberg's formula as rounded in handbooks, with the factor 3.72.
    pub selberg_rounded_m_s: f64,
    /// Rocard's formula.
    pub rocard_m_s: f64,
}

/// Selberg's and Rocard's onsets; `None` for a section whose rotation is not faster than its heave, or that does not
/// turn about its mid-chord with the centre of mass there: the formulas say nothing of these.
pub fn sanity_lines(structure: &Structure) -> Option<SanityLines> {
    let at = |dof: Dof| structure.dofs.iter().position(|d| *d == dof);
    let (y, theta) = (at(Dof::Vertical)?, at(Dof::Torsion)?);
    let (mass, inertia) = (structure.mass[(y, y)], structure.mass[(theta, theta)]);
    let heave_squared = structure.stiffness[(y, y)] / mass;
    let torsion_squared = structure.stiffness[(theta, theta)] / inertia;
    let separation = 1.0 - heave_squared / torsion_squared;
    let symmetric = structure.axis_offset_m == 0.0 && structure.mass[(y, theta)] == 0.0;
    if !(symmetric && separation.is_finite() && separation > 0.0) {
        return None;
    }
    let (width, density) = (structure.width_m, structure.air_density_kg_m3);
    let mu = PI * density * width * width / (2.0 * mass);
    let nu = 8.0 * inertia / (mass * width * width);
    let omega = torsion_squared.sqrt();
    let radius = (inertia / mass).sqrt();
    let heaviness = mass * radius / (density * width.powi(3));
    Some(SanityLines {
        selberg_m_s: 0.44 * omega * width * (separation * nu.sqrt() / mu).sqrt(),
        selberg_rounded_m_s: 3.72 * omega / TAU * width * (heaviness * separation).sqrt(),
        rocard_m_s: 0.443 * omega * width * (separation / mu * 2.0 * nu / (1.0 + nu)).sqrt(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::section::SectionModel;

    /// IABSE 1.1a: 76.175, 76.385 and 76.646 m/s, computed independently to three decimals.
    #[test]
    fn iabse() {
        let lines = sanity_lines(&SectionModel::iabse_1_1a().structure().unwrap()).unwrap();
        for (found, expected) in [
            (lines.selberg_m_s, 76.175),
            (lines.selberg_rounded_m_s, 76.385),
            (lines.rocard_m_s, 76.646),
        ] {
            assert!((found - expected).abs() < 5.1e-4, "{found}");
        }
    }

    #[test]
    fn slow_rotation_has_no_line() {
        let mut section = SectionModel::table_4_1();
        section.torsion.frequency_hz = Some(1.5);
        assert_eq!(sanity_lines(&section.structure().unwrap()), None);
        let mut section = SectionModel::table_4_1();
        section.mass_offset_m = Some(0.01);
        assert_eq!(sanity_lines(&section.structure().unwrap()), None);
    }
}
