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
    /// Distance of the axis from the reference point of the aerodynamic forces; only where the section states it.
    AxisOffset,
    /// Distance of the centre of mass from the axis; only where the section states it.
    MassOffset,
    /// Mass or mass moment of inertia per length.
    Inertia(Dof),
    /// Still-air natural frequency.
    Frequency(Dof),
    /// Ratio to critical damping.
    DampingRatio(Dof),
}

impl SectionParameter {
    /// The properties of a section, in the order of the table.
    pub fn all(section: &SectionModel) -> Vec<Self> {
        let axis = section.axis_offset_m.map(|_| Self::AxisOffset);
        let mass = section.mass_offset_m.map(|_| Self::MassOffset);
        let supports = section
            .dofs()
            .into_iter()
            .flat_map(|d| [Self::Inertia(d), Self::Frequency(d), Self::DampingRatio(d)]);
        [Self::Width, Self::AirDensity]
            .into_iter()
            .chain(axis)
            .chain(mass)
            .chain(supports)
            .collect()
    }

    /// The value in a section, in the unit of the variable; a stiffness is turned into `f = √(K/m)/2π`. NaN for a
    /// degree of freedom that the section does not have.
    pub fn value_in(self, section: &SectionModel) -> f64 {
        let nothing = (f64::NAN, None, None, f64::NAN);
        let support = |dof: Dof| section.stated(dof).unwrap_or(nothing);
        match self {
            Self::Width => section.width_m,
            Self::AirDensity => section.air_density_kg_m3,
            Self::AxisOffset => section.axis_offset_m.unwrap_or(0.0),
            Self::MassOffset => section.mass_offset_m.unwrap_or(0.0),
            Self::Inertia(dof) => support(dof).0,
            Self::DampingRatio(dof) => support(dof).3,
            Self::Frequency(dof) => {
                let (inertia, frequency, stiffness, _) = support(dof);
                frequency.unwrap_or_else(|| (stiffness.unwrap_or(f64::NAN) / inertia).sqrt() / TAU)
            }
        }
    }
}
