//! The elastically suspended deck section: what the user states, and its matrices.
//!
//! Degrees of freedom stand in the order vertical `y` (up), lateral `x` (downwind), rotation `θ` (nose-up);
//! everything is per unit length of span. Heave and rotation are those of the axis about which the section turns; the
//! aerodynamic models speak of a reference point, mid-chord unless the data say otherwise. [`Structure`] takes their
//! forces to the axis and the motion back, and nothing else does.

mod structure;

pub use structure::Structure;

use crate::error::{Error, Place, Result, ensure, finite, non_negative, positive};
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Density of air where nothing else is stated, kg/m³ (EN 1991-1-4, 4.5).
pub const STANDARD_AIR_DENSITY_KG_M3: f64 = 1.25;

/// A degree of freedom of the section.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::section::Dof;
///
/// assert_eq!(Dof::names(&Dof::TWO), "vertical, torsion");
/// assert_eq!(Dof::Torsion.force_scale(31.0), 31.0 * 31.0); // a moment per metre over ½ρV²
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Dof {
    /// Vertical displacement `y` and lift, positive up.
    Vertical,
    /// Lateral displacement `x` and drag, positive downwind.
    Lateral,
    /// Rotation `θ` and moment, positive nose-up (windward edge up).
    Torsion,
}

impl Dof {
    /// The two degrees of freedom of classical flutter.
    pub const TWO: [Dof; 2] = [Dof::Vertical, Dof::Torsion];
    /// All three.
    pub const THREE: [Dof; 3] = [Dof::Vertical, Dof::Lateral, Dof::Torsion];

    /// Factor from motion to dimensionless motion: `1/B` for displacements, 1 for rotation.
    pub fn motion_scale(self, width_m: f64) -> f64 {
        match self {
            Dof::Torsion => 1.0,
            Dof::Vertical | Dof::Lateral => 1.0 / width_m,
        }
    }
    /// Factor from dimensionless force to force over `½ρV²`: `B` for forces, `B²` for the moment.
    pub fn force_scale(self, width_m: f64) -> f64 {
        match self {
            Dof::Torsion => width_m * width_m,
            Dof::Vertical | Dof::Lateral => width_m,
        }
    }
    /// Symbol and name of the motion, and name of the force.
    fn words(self) -> [&'static str; 3] {
        match self {
            Dof::Vertical => ["y", "vertical", "lift"],
            Dof::Lateral => ["x", "lateral", "drag"],
            Dof::Torsion => ["θ", "torsion", "moment"],
        }
    }
    /// Symbol of the motion: `y`, `x`, `θ`.
    pub fn symbol(self) -> &'static str {
        self.words()[0]
    }
    /// Names of several in words: `vertical, torsion`.
    pub fn names(dofs: &[Dof]) -> String {
        dofs.iter().map(|d| d.name()).collect::<Vec<_>>().join(", ")
    }
    /// Name of the force in words.
    pub fn force_name(self) -> &'static str {
        self.words()[2]
    }
    /// Name of the motion in words.
    pub fn name(self) -> &'static str {
        self.words()[1]
    }
}

/// Spring support of a displacement: mass with either frequency or stiffness.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Translation {
    /// Mass per length, kg/m.
    pub mass_kg_m: f64,
    /// Still-air natural frequency, Hz; give this or the stiffness.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frequency_hz: Option<f64>,
    /// Stiffness per length, N/m²; give this or the frequency.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stiffness_n_m2: Option<f64>,
    /// Ratio to critical damping, dimensionless.
    pub damping_ratio: f64,
}

impl Translation {
    /// Of this natural frequency.
    pub fn new(mass_kg_m: f64, frequency_hz: f64, damping_ratio: f64) -> Self {
        Self {
            mass_kg_m,
            frequency_hz: Some(frequency_hz),
            stiffness_n_m2: None,
            damping_ratio,
        }
    }
}

/// Spring support of the rotation: mass moment of inertia with either frequency or stiffness.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rotation {
    /// Mass moment of inertia per length, kg·m²/m.
    pub inertia_kg_m2_m: f64,
    /// Still-air natural frequency, Hz; give this or the stiffness.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frequency_hz: Option<f64>,
    /// Rotational stiffness per length, N·m/(rad·m); give this or the frequency.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stiffness_n: Option<f64>,
    /// Ratio to critical damping, dimensionless.
    pub damping_ratio: f64,
}

impl Rotation {
    /// Of this natural frequency.
    pub fn new(inertia_kg_m2_m: f64, frequency_hz: f64, damping_ratio: f64) -> Self {
        Self {
            inertia_kg_m2_m,
            frequency_hz: Some(frequency_hz),
            stiffness_n: None,
            damping_ratio,
        }
    }
}

/// An elastically suspended deck section in smooth flow.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::section::SectionModel;
///
/// let section = SectionModel { width_m: 0.6, ..SectionModel::table_4_1() };
/// let structure = section.structure()?;
/// assert_eq!(structure.mass[(0, 0)], 15.0); // kg/m
/// assert!(SectionModel { width_m: -1.0, ..section }.structure().is_err());
/// # Ok::<(), aerodeck::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SectionModel {
    /// Full deck width `B`, m.
    pub width_m: f64,
    /// Air density `ρ`, kg/m³.
    pub air_density_kg_m3: f64,
    /// Distance `a` of the axis about which the section turns from the reference point of the aerodynamic forces, m,
    /// positive downwind (towards the trailing edge); left out: zero.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis_offset_m: Option<f64>,
    /// Distance `e` of the centre of mass from that axis, m, positive downwind; left out: zero. The static unbalance is
    /// `m e`; frequencies and damping ratios of the supports stay those of each motion by itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass_offset_m: Option<f64>,
    /// Vertical support.
    pub vertical: Translation,
    /// Lateral support; leaving it out gives a section of two degrees of freedom.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lateral: Option<Translation>,
    /// Torsional support.
    pub torsion: Rotation,
}

impl SectionModel {
    /// The section of Table 4.1 of the thesis (B 0.5 m, m 15 kg/m, J 0.6 kg·m²/m, 2 Hz, 5 Hz, ζ 0.3 %, ρ 1.19 kg/m³).
    pub fn table_4_1() -> Self {
        let heave = Translation::new(15.0, 2.0, 0.003);
        Self::two_dof(0.5, 1.19, heave, Rotation::new(0.6, 5.0, 0.003))
    }

    /// The deck of IABSE Task Group 3.1, step 1.1a (B 31 m, m 22 740 kg/m, J 2.47e6 kg·m²/m, 0.100 and 0.278 Hz, ζ 0.3 %, ρ 1.22 kg/m³).
    pub fn iabse_1_1a() -> Self {
        let heave = Translation::new(22_740.0, 0.100, 0.003);
        Self::two_dof(31.0, 1.22, heave, Rotation::new(2.47e6, 0.278, 0.003))
    }

    /// A section that heaves and rotates.
    pub fn two_dof(
        width_m: f64,
        air_density_kg_m3: f64,
        vertical: Translation,
        torsion: Rotation,
    ) -> Self {
        Self {
            width_m,
            air_density_kg_m3,
            axis_offset_m: None,
            mass_offset_m: None,
            vertical,
            lateral: None,
            torsion,
        }
    }

    /// Degrees of freedom in the order of every matrix of this crate.
    pub fn dofs(&self) -> Vec<Dof> {
        match self.lateral {
            Some(_) => Dof::THREE.to_vec(),
            None => Dof::TWO.to_vec(),
        }
    }

    /// `M_yθ = −m e`, kg: with the centre of mass downwind of the axis a nose-up acceleration moves it down.
    pub fn static_coupling(&self) -> f64 {
        -self.vertical.mass_kg_m * self.mass_offset_m.unwrap_or(0.0)
    }

    /// Mass, damping and stiffness of the section about its axis; `R = 2ζ√(K M)` and `K` on the diagonal, `M` with the
    /// static unbalance.
    ///
    /// # Errors
    /// [`Error::Input`] for a value that is not finite, not positive where it must be, for a support that states
    /// both or neither of frequency and stiffness, and for a centre of mass as far from the axis as the radius of
    /// gyration or farther.
    pub fn structure(&self) -> Result<Structure> {
        let supports: Vec<_> = self.supports()?.into_iter().flatten().collect();
        let diagonal = |pick: fn(&Suspension) -> f64| {
            DMatrix::from_diagonal(&supports.iter().map(pick).collect::<Vec<_>>().into())
        };
        let mut mass = diagonal(|s| s.mass);
        let torsion = supports.len() - 1;
        if self.mass_offset_m.is_some() {
            mass[(0, torsion)] = self.static_coupling();
            mass[(torsion, 0)] = mass[(0, torsion)];
        }
        Ok(Structure {
            dofs: self.dofs(),
            width_m: self.width_m,
            air_density_kg_m3: self.air_density_kg_m3,
            axis_offset_m: self.axis_offset_m.unwrap_or(0.0),
            mass,
            damping: diagonal(|s| s.damping),
            stiffness: diagonal(|s| s.stiffness),
            mode_names: Vec::new(),
        })
    }

    /// What is stated of the support of a degree of freedom: inertia (kg/m or kg·m²/m), frequency (Hz), stiffness (N/m² or N) and
    /// damping ratio; `None` without one.
    pub fn stated(&self, dof: Dof) -> Option<(f64, Option<f64>, Option<f64>, f64)> {
        let (translation, turns) = match dof {
            Dof::Vertical => (Some(&self.vertical), None),
            Dof::Lateral => (self.lateral.as_ref(), None),
            Dof::Torsion => (None, Some(&self.torsion)),
        };
        let of_rotation = |s: &Rotation| {
            (
                s.inertia_kg_m2_m,
                s.frequency_hz,
                s.stiffness_n,
                s.damping_ratio,
            )
        };
        let of_translation = |s: &Translation| {
            (
                s.mass_kg_m,
                s.frequency_hz,
                s.stiffness_n_m2,
                s.damping_ratio,
            )
        };
        turns.map(of_rotation).or(translation.map(of_translation))
    }

    /// The vertical, lateral and torsional support.
    pub fn supports(&self) -> Result<[Option<Suspension>; 3]> {
        positive("section.width_m", self.width_m)?;
        positive("section.air_density_kg_m3", self.air_density_kg_m3)?;
        let (heave, sway) = (self.support(Dof::Vertical)?, self.support(Dof::Lateral));
        let twist = self.support(Dof::Torsion)?;
        if let Some(a) = self.axis_offset_m {
            finite("section.axis_offset_m", a)?;
        }
        if let (Some(e), Some(heave), Some(twist)) = (self.mass_offset_m, heave, twist) {
            finite("section.mass_offset_m", e)?;
            // about the axis J = J_cg + m e²
            let radius = (twist.mass / heave.mass).sqrt();
            ensure(
                e.abs() < radius,
                "section.mass_offset_m",
                format_args!("less than the radius of gyration about the axis, {radius:.4} m"),
                e,
            )?;
        }
        Ok([heave, sway?, twist])
    }

    fn support(&self, dof: Dof) -> Result<Option<Suspension>> {
        let Some((inertia, frequency_hz, stiffness, damping_ratio)) = self.stated(dof) else {
            return Ok(None);
        };
        let [inertia_key, stiffness_key] = match dof {
            Dof::Torsion => ["inertia_kg_m2_m", "stiffness_n"],
            _ => ["mass_kg_m", "stiffness_n_m2"],
        };
        // put together only where something is wrong: this is called for every sample of a random section
        let place = || Place::from("section").key(dof.name());
        let at = |key: &str, checked: fn(&'static str, f64) -> Result<f64>, value: f64| {
            checked("", value).map_err(|e| e.at(place().key(key)))
        };
        let inertia = at(inertia_key, positive, inertia)?;
        let damping_ratio = at("damping_ratio", non_negative, damping_ratio)?;
        let stiffness = match (frequency_hz, stiffness) {
            (Some(f), None) => {
                let omega = TAU * at("frequency_hz", positive, f)?;
                inertia * omega * omega
            }
            (None, Some(k)) => at(stiffness_key, non_negative, k)?,
            (given, _) => {
                return Err(Error::input(
                    place(),
                    format!("either `frequency_hz` or `{stiffness_key}`"),
                    if given.is_some() { "both" } else { "neither" },
                ));
            }
        };
        Ok(Some(Suspension {
            mass: inertia,
            damping: 2.0 * damping_ratio * (stiffness * inertia).sqrt(),
            stiffness,
        }))
    }
}

/// One degree of freedom by itself, in the units of its row of the structure's matrices.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Suspension {
    /// kg/m or kg·m²/m.
    pub mass: f64,
    /// N·s/m² or N·s.
    pub damping: f64,
    /// N/m² or N.
    pub stiffness: f64,
}

#[cfg(test)]
mod tests;
