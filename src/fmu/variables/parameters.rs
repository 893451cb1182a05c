//! The properties of the section as parameters.

use crate::section::{Dof, SectionModel};
use std::f64::consts::TAU;

/// A tunable property of the section.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SectionParameter {
    /// Deck width `B`.
    Width,
    /// Air density `ρ`.
    AirDensity,
    /// Mass or mass moment of inertia per length.
    Inertia(Dof),
    /// Still-air natural frequency.
    Frequency(Dof),
    /// Ratio to critical damping.
    DampingRatio(Dof),
}

impl SectionParameter {
    /// The properties of a section with these degrees of freedom, in the order of the table.
    pub fn all(dofs: &[Dof]) -> Vec<Self> {
        let supports = dofs
            .iter()
            .flat_map(|&d| [Self::Inertia(d), Self::Frequency(d), Self::DampingRatio(d)]);
        [Self::Width, Self::AirDensity]
            .into_iter()
            .chain(supports)
            .collect()
    }

    /// The value in a section, in the unit of the variable; a stiffness is turned into `f = √(K/m)/2π`. NaN for a
    /// degree of freedom that the section does not have.
    pub fn value_in(self, section: &SectionModel) -> f64 {
        let support = |dof: Dof| match dof {
            Dof::Torsion => {
                let s = &section.torsion;
                (
                    s.inertia_kg_m2_m,
                    s.frequency_hz,
                    s.stiffness_n,
                    s.damping_ratio,
                )
            }
            _ => {
                let s = match dof {
                    Dof::Vertical => Some(&section.vertical),
                    _ => section.lateral.as_ref(),
                };
                s.map_or((f64::NAN, None, None, f64::NAN), |s| {
                    (
                        s.mass_kg_m,
                        s.frequency_hz,
                        s.stiffness_n_m2,
                        s.damping_ratio,
                    )
                })
            }
        };
        match self {
            Self::Width => section.width_m,
            Self::AirDensity => section.air_density_kg_m3,
            Self::Inertia(dof) => support(dof).0,
            Self::DampingRatio(dof) => support(dof).3,
            Self::Frequency(dof) => {
                let (inertia, frequency, stiffness, _) = support(dof);
                frequency.unwrap_or_else(|| (stiffness.unwrap_or(f64::NAN) / inertia).sqrt() / TAU)
            }
        }
    }
}
