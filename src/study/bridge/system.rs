//! A bridge as a system of FMUs: its structure, and the wind forces of each section beside it.

use super::{BridgeExportOptions, BridgeStudy, SectionForcePart};
use crate::aerodynamics::Transfer as _;
use crate::error::Result;
use crate::fmu::bridge_options::BridgeOptions;
use crate::fmu::package::{
    Export, FmiVersion, GrowthPolicy, Label, Runtime, package, package_bridge,
};
use crate::fmu::ssp::{Connection, System, SystemComponent};
use crate::section::Dof;
use crate::verdict::Verdict;

/// Name of the structure among the components.
const STRUCTURE: &str = "structure";

/// A degree of freedom in the names of variables: the motion that the forces follow, the force, and what it is to the structure.
struct Names {
    motion: [&'static str; 2],
    force: &'static str,
    external: &'static str,
}

fn names(dof: Dof) -> Names {
    let (motion, force, external) = match dof {
        Dof::Vertical => (["heave", "heave_rate"], "total_lift", "external_lift"),
        Dof::Lateral => (["sway", "sway_rate"], "total_drag", "external_drag"),
        Dof::Torsion => (
            ["rotation", "rotation_rate"],
            "total_moment",
            "external_moment",
        ),
    };
    Names {
        motion,
        force,
        external,
    }
}

impl SectionForcePart {
    /// What packs it. Whether the bridge grows below its onset has been judged before.
    pub(crate) fn packed(&self, label: &Label, version: FmiVersion) -> Export {
        Export {
            force: Some(self.options.clone()),
            gusts: self.gusts.clone(),
            label: label.clone(),
            version,
            ..GrowthPolicy::Allow.into()
        }
    }

    /// Name of its component in a system.
    fn component_name(&self, sections: usize) -> String {
        let word = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
        match sections {
            1 => "force".to_owned(),
            _ => format!(
                "force_{}",
                self.section.chars().map(word).collect::<String>()
            ),
        }
    }

    /// Connections with the structure, there and back.
    fn connections(&self, component: &str) -> (Vec<Connection>, Vec<Connection>) {
        let (mut motions, mut forces) = (Vec::new(), Vec::new());
        for node in &self.options.nodes {
            let at = |element: &str, of: &str| [element.to_owned(), format!("node[{node}].{of}")];
            for dof in self.model.model.dofs() {
                let names = names(*dof);
                motions.extend(names.motion.map(|of| Connection {
                    from: at(STRUCTURE, of),
                    to: at(component, of),
                }));
                forces.push(Connection {
                    from: at(component, names.force),
                    to: at(STRUCTURE, names.external),
                });
            }
        }
        (motions, forces)
    }
}

impl BridgeStudy {
    /// The bridge as a system of two units or more, which give what the whole bridge gives as far as the steps in which they exchange
    /// motion and forces allow.
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
        let whole = self.export(wanted)?;
        let forces = self.section_forces_of(&whole, None)?;
        let mut structure = self.structure_of(whole, true)?;
        structure.verdict = Some(verdict.clone());
        let mut system = System {
            name: self.file.name.clone(),
            components: Vec::new(),
            connections: Vec::new(),
            experiment: structure.model.experiment.clone(),
        };
        let mut whole = SystemComponent {
            name: STRUCTURE.to_owned(),
            fmu: package_bridge(&structure, runtimes, label, FmiVersion::Two)?,
            inputs: Vec::new(),
            outputs: Vec::new(),
            values: structure_values(&structure.bridge),
        };
        for section in &forces {
            let name = section.component_name(forces.len());
            let (motions, back) = section.connections(&name);
            let ends = |list: &[Connection], to: bool| -> Vec<String> {
                let end = |c: &Connection| {
                    if to {
                        c.to[1].clone()
                    } else {
                        c.from[1].clone()
                    }
                };
                list.iter().map(end).collect()
            };
            whole.outputs.extend(ends(&motions, false));
            whole.inputs.extend(ends(&back, true));
            let experiment = &section.model.experiment;
            let export = section.packed(label, FmiVersion::Two);
            system.components.push(SystemComponent {
                fmu: package(&section.model, runtimes, export)?,
                inputs: ends(&motions, true),
                outputs: ends(&back, false),
                values: vec![
                    ("wind_speed".to_owned(), experiment.wind_speed_m_s),
                    ("air_density".to_owned(), self.by_model.air_density_kg_m3),
                    ("prediction".to_owned(), section.options.prediction_steps),
                ],
                name,
            });
            system.connections.extend(motions.into_iter().chain(back));
        }
        system.components.insert(0, whole);
        Ok(system)
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
