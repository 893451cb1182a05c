//! The numbers of a section that may be random, by the names they have in a study file.

use crate::error::{Error, Result};
use crate::section::{SectionModel, Translation};
use serde::{Deserialize, Serialize};

/// A number of the section.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Parameter {
    /// Deck width, m.
    #[serde(rename = "width_m")]
    Width,
    /// Air density, kg/m³.
    #[serde(rename = "air_density_kg_m3")]
    AirDensity,
    /// Distance of the axis from the reference point of the forces, m.
    #[serde(rename = "axis_offset_m")]
    AxisOffset,
    /// Distance of the centre of mass from the axis, m.
    #[serde(rename = "mass_offset_m")]
    MassOffset,
    /// Mass of the vertical motion, kg/m.
    #[serde(rename = "vertical.mass_kg_m")]
    VerticalMass,
    /// Natural frequency of the vertical motion, Hz; the stiffness follows from it and the mass.
    #[serde(rename = "vertical.frequency_hz")]
    VerticalFrequency,
    /// Stiffness of the vertical motion, N/m².
    #[serde(rename = "vertical.stiffness_n_m2")]
    VerticalStiffness,
    /// Damping ratio of the vertical motion.
    #[serde(rename = "vertical.damping_ratio")]
    VerticalDamping,
    /// Mass of the lateral motion, kg/m.
    #[serde(rename = "lateral.mass_kg_m")]
    LateralMass,
    /// Natural frequency of the lateral motion, Hz.
    #[serde(rename = "lateral.frequency_hz")]
    LateralFrequency,
    /// Stiffness of the lateral motion, N/m².
    #[serde(rename = "lateral.stiffness_n_m2")]
    LateralStiffness,
    /// Damping ratio of the lateral motion.
    #[serde(rename = "lateral.damping_ratio")]
    LateralDamping,
    /// Mass moment of inertia, kg·m²/m.
    #[serde(rename = "torsion.inertia_kg_m2_m")]
    Inertia,
    /// Natural frequency of the rotation, Hz.
    #[serde(rename = "torsion.frequency_hz")]
    TorsionFrequency,
    /// Stiffness of the rotation, N·m/(rad·m).
    #[serde(rename = "torsion.stiffness_n")]
    TorsionStiffness,
    /// Damping ratio of the rotation.
    #[serde(rename = "torsion.damping_ratio")]
    TorsionDamping,
}

impl Parameter {
    /// Where the number stands; `None` when the section states it otherwise (a stiffness instead of a frequency) or has
    /// no such support.
    pub fn place(self, section: &mut SectionModel) -> Option<&mut f64> {
        fn frequency(t: &mut Translation) -> Option<&mut f64> {
            t.frequency_hz.as_mut()
        }
        fn stiffness(t: &mut Translation) -> Option<&mut f64> {
            t.stiffness_n_m2.as_mut()
        }
        match self {
            Self::Width => Some(&mut section.width_m),
            Self::AirDensity => Some(&mut section.air_density_kg_m3),
            Self::AxisOffset => section.axis_offset_m.as_mut(),
            Self::MassOffset => section.mass_offset_m.as_mut(),
            Self::VerticalMass => Some(&mut section.vertical.mass_kg_m),
            Self::VerticalFrequency => frequency(&mut section.vertical),
            Self::VerticalStiffness => stiffness(&mut section.vertical),
            Self::VerticalDamping => Some(&mut section.vertical.damping_ratio),
            Self::LateralMass => section.lateral.as_mut().map(|t| &mut t.mass_kg_m),
            Self::LateralFrequency => section.lateral.as_mut().and_then(frequency),
            Self::LateralStiffness => section.lateral.as_mut().and_then(stiffness),
            Self::LateralDamping => section.lateral.as_mut().map(|t| &mut t.damping_ratio),
            Self::Inertia => Some(&mut section.torsion.inertia_kg_m2_m),
            Self::TorsionFrequency => section.torsion.frequency_hz.as_mut(),
            Self::TorsionStiffness => section.torsion.stiffness_n.as_mut(),
            Self::TorsionDamping => Some(&mut section.torsion.damping_ratio),
        }
    }

    /// The value in `section`.
    ///
    /// # Errors
    /// [`Error::Input`] at `key` when the section does not state it.
    pub(super) fn nominal(self, key: &str, section: &SectionModel) -> Result<f64> {
        let mut copy = section.clone();
        self.place(&mut copy).copied().ok_or_else(|| {
            Error::input(
                key,
                "a number that the section of the model states (a support has either a frequency or a stiffness)",
                format!("`{}`", self.name()),
            )
        })
    }

    /// The number of this name in files.
    ///
    /// # Errors
    /// [`Error::Input`] for a name that none has.
    pub fn named(name: &str) -> Result<Self> {
        serde_json::from_value(name.into()).map_err(|_| {
            let expected = "a number of the section, such as vertical.mass_kg_m";
            Error::input("parameter", expected, format!("`{name}`"))
        })
    }

    /// The name in files.
    pub(crate) fn name(self) -> String {
        match serde_json::to_value(self) {
            Ok(serde_json::Value::String(name)) => name,
            _ => String::new(),
        }
    }
}
