//! Blocks of `bridge.toml`: sections along the span, the wind along it, and dampers.

use super::modal_data::BridgeModes;
use crate::aerodynamics::derivatives::Interpolation;
use crate::aerodynamics::quasi_steady::{Arms, CoefficientsAt};
use crate::bridge::{DampedPoint, Dampers, MOST_WIND_FACTOR, MassDamper, ViscousLink};
use crate::error::{Error, Result, ensure, finite, non_negative, positive};
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

/// Wind along the span.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct WindBlock {
    /// Wind speed at places along the girder over the wind speed of the bridge, linear between; left out, 1 everywhere.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub profile: Vec<ProfilePoint>,
}

/// A point of the wind profile.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProfilePoint {
    /// Place along the girder, m.
    pub along_m: f64,
    /// Wind speed there over that of the bridge.
    pub factor: f64,
}

impl WindBlock {
    /// The factor at a place along the girder.
    pub fn factor(&self, along_m: f64) -> f64 {
        let points = &self.profile;
        let after = points.partition_point(|p| p.along_m <= along_m);
        match (after.checked_sub(1).map(|i| points[i]), points.get(after)) {
            (Some(a), Some(b)) => {
                a.factor + (b.factor - a.factor) * (along_m - a.along_m) / (b.along_m - a.along_m)
            }
            (Some(end), None) => end.factor,
            (None, Some(end)) => end.factor,
            (None, None) => 1.0,
        }
    }

    /// Checks the profile.
    pub(super) fn validate(&self) -> Result<()> {
        let points = &self.profile;
        for (i, point) in points.iter().enumerate() {
            let place = format!("wind.profile[{i}]");
            finite(format!("{place}.along_m"), point.along_m)?;
            non_negative(format!("{place}.factor"), point.factor)?;
            let expected = format_args!(
                "at most {MOST_WIND_FACTOR} times the wind speed of the bridge (a factor, not per cent)"
            );
            let (fits, key) = (point.factor <= MOST_WIND_FACTOR, format!("{place}.factor"));
            ensure(fits, key, expected, point.factor)?;
            if let Some(before) = points[..i].last() {
                let expected = format_args!("a place beyond {} m", before.along_m);
                let rises = point.along_m > before.along_m;
                ensure(rises, place, expected, point.along_m)?;
            }
        }
        let blows = points.is_empty() || points.iter().any(|p| p.factor != 0.0);
        let expected = "wind somewhere along the bridge";
        ensure(blows, "wind.profile", expected, "zero everywhere")
    }
}

/// A damper at a node: a mass with `mass_kg`, `frequency_hz` and `damping_ratio`, or a link with `coefficient`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DamperBlock {
    /// Name of the node.
    pub node: String,
    /// What it acts against. A mass against `torsion` is a pair: half of it on either side, each moving up and down.
    pub motion: Dof,
    /// Distance of the halves of a pair from the axis of the node, m.
    pub arm_m: Option<f64>,
    /// Mass, of a pair both together, kg.
    pub mass_kg: Option<f64>,
    /// Natural frequency while the girder is held, Hz.
    pub frequency_hz: Option<f64>,
    /// Ratio to critical damping.
    pub damping_ratio: Option<f64>,
    /// Force of a link over its speed, N·s/m; against torsion N·m·s/rad.
    pub coefficient: Option<f64>,
    /// Name of the node at the other end of a link; left out, the ground.
    pub to: Option<String>,
}

impl DamperBlock {
    pub(super) fn validate(&self, place: &str) -> Result<()> {
        let is_link = self.coefficient.is_some();
        let is_pair = !is_link && self.motion == Dof::Torsion;
        let refused = |key: &str, expected: &str, is_there: bool| {
            let found = if is_there { "one" } else { "none" };
            Err(Error::input(format!("{place}.{key}"), expected, found))
        };
        let of_mass = [
            ("mass_kg", self.mass_kg),
            ("frequency_hz", self.frequency_hz),
            ("damping_ratio", self.damping_ratio),
        ];
        if let Some((key, value)) = of_mass.iter().find(|(_, v)| v.is_some() == is_link) {
            let expected = match is_link {
                true => "none beside the `coefficient` of a link",
                false => "mass_kg, frequency_hz and damping_ratio, or the `coefficient` of a link",
            };
            return refused(key, expected, value.is_some());
        }
        if self.to.is_some() && !is_link {
            let expected = "none: only links, of a `coefficient`, have two ends";
            return refused("to", expected, true);
        }
        if self.arm_m.is_some() != is_pair {
            let expected = match is_pair {
                true => "the distance of both halves of the mass from the axis",
                false => "none: only a mass against torsion has two halves",
            };
            return refused("arm_m", expected, !is_pair);
        }
        let key = |of: &str| format!("{place}.{of}");
        for (of, value) in [of_mass[0], of_mass[1], ("arm_m", self.arm_m)] {
            value.map(|x| positive(key(of), x)).transpose()?;
        }
        for (of, value) in [of_mass[2], ("coefficient", self.coefficient)] {
            value.map(|x| non_negative(key(of), x)).transpose()?;
        }
        Ok(())
    }

    /// Adds what the block stands for; `place` is that of the block.
    pub(super) fn add(&self, place: &str, modes: &BridgeModes, all: &mut Dampers) -> Result<()> {
        let point = |key: &str, name: &str, motion: Dof, offset_m: f64| {
            let node = modes.index_of(format!("{place}.{key}"), name)?;
            Ok::<_, Error>(DampedPoint {
                node,
                motion,
                offset_m,
            })
        };
        if let Some(coefficient) = self.coefficient {
            let other = self.to.as_ref();
            let to = other.map(|name| point("to", name, self.motion, 0.0));
            let to = to.transpose()?;
            let end = other.map_or("the ground".to_owned(), |n| format!("node {n}"));
            let (number, node) = (all.links.len() + 1, &self.node);
            all.links.push(ViscousLink {
                name: format!("link {number} from node {node} to {end}"),
                at: point("node", node, self.motion, 0.0)?,
                to,
                coefficient,
            });
            return Ok(());
        }
        let (motion, offsets) = match self.arm_m {
            Some(arm) => (Dof::Vertical, vec![-arm, arm]),
            None => (self.motion, vec![0.0]),
        };
        let given = |value: Option<f64>| value.unwrap_or(f64::NAN);
        for offset_m in &offsets {
            all.masses.push(MassDamper {
                name: format!("damper {} at node {}", all.masses.len() + 1, self.node),
                at: point("node", &self.node, motion, *offset_m)?,
                mass_kg: given(self.mass_kg) / offsets.len() as f64,
                frequency_hz: given(self.frequency_hz),
                damping_ratio: given(self.damping_ratio),
            });
        }
        Ok(())
    }
}
