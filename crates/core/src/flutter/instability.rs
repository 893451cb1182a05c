//! What kind of instability an onset is: coupled flutter, torsional flutter, galloping.
//!
//! Two things decide: which degrees of freedom carry the kinetic energy of the mode at onset, and whether the direct
//! damping derivative of that degree of freedom (`H1*`, `P1*`, `A2*`: `Im G_ii/K²`) is positive there, so that its own
//! motion is fed by the wind without any help of another.

use super::determinant::{StructureInWind, determinant_onset};
use super::onset::Onset;
use crate::aerodynamics::{Transfer, TransferMatrix};
use crate::error::Result;
use crate::section::{Dof, Structure};
use crate::state_space::complex;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use nalgebra::{Complex, DMatrix};
use serde::Serialize;

/// Share of the kinetic energy from which on a mode counts as one of a single degree of freedom.
const SINGLE_DOF_SHARE: f64 = 0.9;

/// Kind of an instability.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Instability {
    /// Two or three degrees of freedom, none of which would be fed alone.
    CoupledFlutter,
    /// Several degrees of freedom move, but rotation alone would be fed too (`A2* > 0`).
    TorsionDrivenFlutter,
    /// One degree of freedom, rotation, with `A2* > 0`.
    TorsionalFlutter,
    /// One degree of freedom, heave, with `H1* > 0`.
    Galloping,
    /// One degree of freedom, sway, with `P1* > 0`.
    LateralGalloping,
}

impl Instability {
    /// The kind in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::CoupledFlutter => "coupled flutter",
            Self::TorsionDrivenFlutter => "torsion-driven flutter (A2* > 0)",
            Self::TorsionalFlutter => "torsional flutter, one degree of freedom (A2* > 0)",
            Self::Galloping => "galloping, one degree of freedom (H1* > 0)",
            Self::LateralGalloping => "lateral galloping, one degree of freedom (P1* > 0)",
        }
    }

    /// Whether it needs one degree of freedom only.
    pub fn single_dof(self) -> bool {
        !matches!(self, Self::CoupledFlutter | Self::TorsionDrivenFlutter)
    }
}

/// One degree of freedom in the mode at onset.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Participation {
    /// The degree of freedom.
    pub dof: Dof,
    /// Its share of the kinetic energy.
    pub energy_share: f64,
    /// Its direct damping derivative at the reduced frequency of the onset: `H1*`, `P1*` or `A2*`.
    pub direct_damping: f64,
    /// Onset of this degree of freedom alone, the others locked, m/s; `None` when it does not flutter inside the tested
    /// range below the highest speed.
    pub alone_m_s: Option<f64>,
}

/// Kind of an onset and the mode behind it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModeAtOnset {
    /// Kind of instability.
    pub kind: Instability,
    /// Every degree of freedom, in their order.
    pub participation: Vec<Participation>,
}

/// Names an onset by the mode of the impedance of `model` at its speed and frequency.
///
/// `range` is where single degrees of freedom are searched, up to `speed_max_m_s`.
pub fn classify(
    structure: &Structure,
    model: &dyn Transfer,
    onset: &Onset,
    range: ReducedFrequencyRange,
    speed_max_m_s: f64,
) -> Result<ModeAtOnset> {
    let k = onset.at.reduced_frequency;
    let omega = onset.at.omega(structure.width_m);
    let shape = StructureInWind { structure, model }.shape(onset.at.speed_m_s, omega)?;
    let velocity = shape.map(|z| z * Complex::new(0.0, omega));
    let momentum = complex(&structure.mass) * &velocity;
    let both = velocity.iter().zip(momentum.iter());
    let energy: Vec<f64> = both.map(|(v, m)| (v.conj() * m).re).collect();
    let total: f64 = energy.iter().sum();
    let g = model.transfer(k)?;
    let k_squared = k.full_width() * k.full_width();
    let mut participation = Vec::with_capacity(energy.len());
    for (i, dof) in structure.dofs.iter().enumerate() {
        // with the others locked
        let locked = structure.only(&[*dof]);
        let alone = OneDof {
            structure,
            model,
            dof: i,
        };
        let alone = determinant_onset("", &locked, &alone, range, speed_max_m_s)?;
        participation.push(Participation {
            dof: *dof,
            energy_share: energy[i] / total,
            direct_damping: g[(i, i)].im / k_squared,
            alone_m_s: alone.critical_speed_m_s(),
        });
    }
    Ok(ModeAtOnset {
        kind: kind(&participation),
        participation,
    })
}

fn kind(participation: &[Participation]) -> Instability {
    let mut fed = participation.iter().filter(|p| p.direct_damping > 0.0);
    let alone = fed.clone().find(|p| p.energy_share >= SINGLE_DOF_SHARE);
    match alone.map(|p| p.dof) {
        Some(Dof::Torsion) => Instability::TorsionalFlutter,
        Some(Dof::Vertical) => Instability::Galloping,
        Some(Dof::Lateral) => Instability::LateralGalloping,
        None if fed.any(|p| p.dof == Dof::Torsion) => Instability::TorsionDrivenFlutter,
        None => Instability::CoupledFlutter,
    }
}

/// One diagonal entry of a model about the axis of a structure.
struct OneDof<'a> {
    structure: &'a Structure,
    model: &'a dyn Transfer,
    dof: usize,
}

impl Transfer for OneDof<'_> {
    fn dofs(&self) -> &[Dof] {
        &self.model.dofs()[self.dof..=self.dof]
    }
    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        let g = self.structure.at_axis(self.model.transfer(k)?);
        Ok(DMatrix::from_element(1, 1, g[(self.dof, self.dof)]))
    }
    fn known_range(&self) -> Option<ReducedFrequencyRange> {
        self.model.known_range()
    }
}
