//! `[[section]]` of `bridge.toml`: width, nodes and forces of a part of the span.

use crate::aerodynamics::derivatives::Interpolation;
use crate::aerodynamics::quasi_steady::{Arms, CoefficientsAt};
use crate::error::{Result, ensure, positive};
use crate::files::derivatives::StatedConvention;
use crate::section::Dof;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// One section along the span: `derivatives` for the table, `model` for a model trained already (without one it is fitted to the
/// table), or `static` alone for quasi-steady forces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BridgeSectionBlock {
    /// Name.
    pub name: String,
    /// Width `B`, m.
    pub width_m: f64,
    /// Name of the first node; left out, the first of the bridge.
    pub from: Option<String>,
    /// Name of the last node; left out, the last of the bridge.
    pub to: Option<String>,
    /// Embedded deck or file of a derivative table.
    pub derivatives: Option<String>,
    /// Notation, argument and axes of the table, as far as it does not state them itself.
    #[serde(default, skip_serializing_if = "StatedConvention::is_empty")]
    pub convention: StatedConvention,
    /// Mean angle of the section in the tests, deg, nose-up positive; left out, what the table states, or 0.
    pub angle_deg: Option<f64>,
    /// How the table is read between its points.
    #[serde(default)]
    pub interpolation: Interpolation,
    /// Filters of the model that is fitted to the table; every mode has them, and more than three cost more than they bring.
    #[serde(default = "three")]
    pub filters: usize,
    /// How the model is fitted to the table, as in a study; before `filters`.
    pub fit: Option<toml::Table>,
    /// Motions with self-excited forces.
    #[serde(default = "two")]
    pub motions: Vec<Dof>,
    /// File of a trained model.
    pub model: Option<PathBuf>,
    /// Static coefficients; without `derivatives` and `model` the forces are quasi-steady.
    #[serde(rename = "static")]
    pub statics: Option<StaticBlock>,
}

fn three() -> usize {
    3
}

fn two() -> Vec<Dof> {
    Dof::TWO.to_vec()
}

/// Static coefficients at the mean angle of attack, all over the width: lift up, moment nose-up, drag downwind.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct StaticBlock {
    /// `C_D`.
    pub drag: f64,
    /// `C_L`.
    pub lift: f64,
    /// `C_M`.
    pub moment: f64,
    /// `dC_D/dα`, per rad.
    pub drag_slope: f64,
    /// `dC_L/dα`, per rad.
    pub lift_slope: f64,
    /// `dC_M/dα`, per rad.
    pub moment_slope: f64,
    /// Arms of the corrected quasi-steady theory over the width.
    pub arms: Arms,
}

impl StaticBlock {
    /// As the theory takes them.
    pub fn coefficients(&self) -> CoefficientsAt {
        CoefficientsAt {
            drag: self.drag,
            lift: self.lift,
            moment: self.moment,
            drag_slope: self.drag_slope,
            lift_slope: self.lift_slope,
            moment_slope: self.moment_slope,
        }
    }
}

impl BridgeSectionBlock {
    pub(super) fn validate(&self, place: &str) -> Result<()> {
        positive(format!("{place}.width_m"), self.width_m)?;
        let any = self.derivatives.is_some() || self.model.is_some() || self.statics.is_some();
        let expected = "one of `derivatives`, `model`, `static`";
        ensure(any, place, expected, "none")?;
        let motions = &self.motions;
        let known = motions == &Dof::TWO || motions == &Dof::THREE;
        let (key, found) = (format!("{place}.motions"), Dof::names(motions));
        let expected = "[\"vertical\", \"torsion\"] or [\"vertical\", \"lateral\", \"torsion\"]";
        ensure(known, key, expected, found)?;
        let statics = self.statics.unwrap_or_default();
        statics.arms.validate(&format!("{place}.static."))
    }
}
