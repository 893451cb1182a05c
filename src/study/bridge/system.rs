//! A bridge as a system of FMUs: its structure, and the wind forces beside it.

use super::{BridgeExportOptions, BridgeStudy, SectionForcePart};
use crate::aerodynamics::Transfer as _;
use crate::error::Result;
use crate::fmu::bridge_options::BridgeOptions;
use crate::fmu::package::{Export, FmiVersion, GrowthPolicy, Label, Runtime, package};
use crate::fmu::ssp::{Connection, System, SystemComponent};
use crate::section::Dof;
use crate::verdict::Verdict;

/// Names of the components.
const STRUCTURE: &str = "structure";
const FORCE: &str = "force";

impl SectionForcePart {
    /// What packs it. Whether the bridge grows below its onset has been judged before.
    pub fn packed(&self, label: &Label, version: FmiVersion) -> Export {
        Export {
            force: Some(self.options.clone()),
            gusts: self.gusts.clone(),
            label: Label {
                name: label.name.clone().or_else(|| Some(self.name.clone())),
                ..label.clone()
            },
            version,
            ..GrowthPolicy::Allow.into()
        }
    }

    /// Connections with the structure, there and back.
    fn connections(&self) -> (Vec<Connection>, Vec<Connection>) {
        let (mut motions, mut forces) = (Vec::new(), Vec::new());
        let parts = self.options.parts(&self.model, None).into_iter();
        let strips = parts.flat_map(|part| part.strips.map(move |s| (s, part.model)));
        for (strip, model) in strips {
            let node = self.options.nodes[strip];
            let at = |element: &str, of: &str| [element.to_owned(), format!("node[{node}].{of}")];
            for dof in model.model.dofs() {
                // the motion that the forces follow, the force, and what it is to the structure
                let (motion, force, external) = match dof {
                    Dof::Vertical => (["heave", "heave_rate"], "total_lift", "external_lift"),
                    Dof::Lateral => (["sway", "sway_rate"], "total_drag", "external_drag"),
                    Dof::Torsion => (
                        ["rotation", "rotation_rate"],
                        "total_moment",
                        "external_moment",
                    ),
                };
                motions.extend(motion.map(|of| Connection {
                    from: at(STRUCTURE, of),
                    to: at(FORCE, of),
                }));
                forces.push(Connection {
                    from: at(FORCE, force),
                    to: at(STRUCTURE, external),
                });
            }
        }
        (motions, forces)
    }
}

impl BridgeStudy {
    /// The bridge as a system of two units, which give what the whole bridge gives as far as the steps in which they exchange motion
    /// and forces allow.
    ///
    /// # Errors
    /// As [`Self::structure`] and [`Self::section_forces`].
    pub fn system(
        &self,
        wanted: &BridgeExportOptions,
        verdict: &Verdict,
        runtimes: &[Runtime],
        label: &Label,
    ) -> Result<System> {
        let (model, whole) = self.export(wanted)?;
        let forces = self.joined(self.section_forces_of(&model, None)?)?;
        let (model, structure) = self.structure_of(model, whole, true)?;
        let values = structure.bridge.as_ref().map(structure_values);
        let experiment = model.experiment.clone();
        let structure = Export {
            verdict: Some(verdict.clone()),
            label: label.clone(),
            ..structure
        };
        let (motions, back) = forces.connections();
        let from = |list: &[Connection]| list.iter().map(|c| c.from[1].clone()).collect();
        let to = |list: &[Connection]| list.iter().map(|c| c.to[1].clone()).collect();
        let export = Export {
            verdict: Some(verdict.clone()),
            ..forces.packed(label, FmiVersion::Two)
        };
        let components = vec![
            SystemComponent {
                name: STRUCTURE.to_owned(),
                fmu: package(&model, runtimes, structure)?,
                inputs: to(&back),
                outputs: from(&motions),
                values: values.unwrap_or_default(),
            },
            SystemComponent {
                name: FORCE.to_owned(),
                fmu: package(&forces.model, runtimes, export)?,
                inputs: to(&motions),
                outputs: from(&back),
                values: [
                    ("wind_speed", forces.model.experiment.wind_speed_m_s),
                    ("air_density", self.by_model.air_density_kg_m3),
                    ("prediction", forces.options.prediction_steps),
                ]
                .map(|(name, value)| (name.to_owned(), value))
                .to_vec(),
            },
        ];
        Ok(System {
            name: self.file.name.clone(),
            components,
            connections: motions.into_iter().chain(back).collect(),
            experiment,
        })
    }
}

/// What may be set of modes and dampers.
fn structure_values(bridge: &BridgeOptions) -> Vec<(String, f64)> {
    let modes = bridge.modes.iter().zip(&bridge.initial);
    let of = |(mode, initial): (&crate::bridge::BridgeMode, &f64)| {
        let named = |what: &str, value| (format!("mode[{}].{what}", mode.number), value);
        [
            named("frequency", mode.frequency_hz),
            named("damping_ratio", mode.damping_ratio),
            named("initial_coordinate", *initial),
        ]
    };
    let masses = bridge.dampers.masses.iter().enumerate();
    let masses = masses.flat_map(|(d, damper)| {
        let named = |what: &str, value| (format!("damper[{}].{what}", d + 1), value);
        [
            named("mass", damper.mass_kg),
            named("frequency", damper.frequency_hz),
            named("damping_ratio", damper.damping_ratio),
        ]
    });
    let links = bridge.dampers.links.iter().enumerate();
    let links = links.map(|(l, link)| (format!("link[{}].coefficient", l + 1), link.coefficient));
    modes.flat_map(of).chain(masses).chain(links).collect()
}
