//! A bridge in parts: its structure alone, the wind forces on its sections, and both as a system of FMUs.

use super::export::STATIC_COEFFICIENTS;
use super::similarity::equivalent_section;
use crate::aerodynamics::{GustForce, RationalAdmittance, RationalModel, Transfer as _};
use crate::bridge::StripGroup;
use crate::error::{Error, Result, ensure};
use crate::fmu::bridge_options::{BridgeOptions, node_number};
use crate::fmu::force_options::{ForceOptions, FurtherModel, StripOptions};
use crate::fmu::package::{Export, FmiVersion, Label, Runtime, package};
use crate::fmu::ssp::{Connection, System, SystemComponent};
use crate::section::Dof;
use crate::study::bridge::{BridgeExportOptions, BridgeStudy};
use crate::trained_model::{Model, Provenance, TrainedModel};
use crate::verdict::Verdict;
use nalgebra::DMatrix;
use std::collections::BTreeMap;

/// The wind forces on sections of a bridge, as strips with the numbers of their nodes.
#[derive(Debug, Clone)]
pub struct SectionForcePart {
    /// Names of the sections.
    pub sections: Vec<String>,
    /// What they are called together.
    pub name: String,
    /// The force model of the first; those of the others are in the options.
    pub model: TrainedModel,
    /// A strip for each of their nodes.
    pub options: ForceOptions,
    /// Forces of gusts on the first, where they are wanted.
    pub gusts: Option<GustForce>,
}

/// No forces of heave and rotation, whatever moves.
fn no_forces() -> Model {
    let zero = || DMatrix::zeros(2, 2);
    Model::Rational(RationalModel::without_lags(&Dof::TWO, zero(), zero()))
}

impl BridgeStudy {
    /// The structure alone of the whole bridge as it is exported, with inputs and outputs at its nodes or at all; its release is that of
    /// the whole bridge.
    ///
    /// # Errors
    /// [`Error::Input`] for gusts and turbulence, which blow on no structure alone.
    pub fn structure(
        &self,
        model: TrainedModel,
        whole: Export,
        all_nodes: bool,
    ) -> Result<(TrainedModel, Export)> {
        let gusts = whole.bridge.as_ref().and_then(|b| b.gusts.as_ref());
        let expected = "none: gusts belong to the forces, not to the structure";
        ensure(gusts.is_none(), "gusts", expected, "some")?;
        let nodes = self.by_model.nodes.len();
        let width_m = self.by_model.width_m();
        let alone = |bridge: BridgeOptions| BridgeOptions {
            structure_alone: true,
            groups: vec![StripGroup {
                name: "no wind".to_owned(),
                width_m,
                wind_factor: 1.0,
                nodes: (0..nodes).collect(),
                forces: 0,
            }],
            forces: vec![no_forces()],
            named: match all_nodes {
                true => (0..nodes).collect(),
                false => bridge.named,
            },
            tested_range: None,
            onset_interval: None,
            onset: None,
            ..bridge
        };
        let export = Export {
            bridge: whole.bridge.map(alone),
            ..whole
        };
        let model = TrainedModel {
            name: format!("{}, structure", model.name),
            model: no_forces(),
            section: equivalent_section(&self.by_model, &Dof::TWO)?,
            provenance: Provenance {
                source: "the modes of the bridge file".to_owned(),
                licence: "as of the modes".to_owned(),
                method: "no wind forces: those come from outside".to_owned(),
                notes: Vec::new(),
                ..model.provenance
            },
            ..model
        };
        Ok((model, export))
    }

    /// Those of all sections as one.
    ///
    /// # Errors
    /// As [`Self::export`]; [`Error::Input`] for a bridge without sections, or with more strips than a unit may have.
    pub fn joined(&self, forces: Vec<SectionForcePart>) -> Result<SectionForcePart> {
        let mut each = forces.into_iter();
        let none = || Error::input("sections", "one at least", "none");
        let mut all = each.next().ok_or_else(none)?;
        for (model, other) in (1..).zip(each) {
            let own = &mut all.options;
            let strips = other.options.strips.into_iter();
            own.strips
                .extend(strips.map(|s| StripOptions { model, ..s }));
            own.nodes.extend(other.options.nodes);
            own.further.push(FurtherModel {
                model: other.model,
                gusts: other.gusts,
            });
            all.sections.extend(other.sections);
            all.name = format!("{}, wind forces", self.file.name);
        }
        all.options.validate()?;
        Ok(all)
    }

    /// The wind forces of every section, each on strips at its nodes, in the order of the nodes, of the bridge that is exported with the
    /// model `whole`; with gusts as inputs where `gusts` states their admittance.
    ///
    /// # Errors
    /// As [`Self::export`]; [`Error::Input`] for gusts on sections without static coefficients.
    pub fn section_forces(
        &self,
        whole: &TrainedModel,
        gusts: Option<RationalAdmittance>,
    ) -> Result<Vec<SectionForcePart>> {
        let matrices = gusts.map(|_| self.gust_matrices()).transpose()?;
        let mut all = BTreeMap::new();
        for (s, (block, forces)) in self.file.sections.iter().zip(&self.sections).enumerate() {
            let groups = self.by_model.groups.iter().zip(&self.section_of_group);
            let own = groups.enumerate().filter(|(_, (_, of))| **of == s);
            let own: Vec<usize> = own.map(|(g, _)| g).collect();
            let Some(&first) = own.first() else { continue };
            let model = forces.saved.clone();
            let dofs = model.dofs().to_vec();
            let gusts = matrices.as_ref().zip(gusts);
            let gusts = gusts.map(|(of_group, admittance)| {
                let rows = dofs.iter().map(|d| of_group[first][*d as usize]);
                GustForce {
                    coefficients: rows.collect(),
                    dofs: dofs.clone(),
                    admittance,
                    source: format!("{STATIC_COEFFICIENTS} {}", block.name),
                }
            });
            let mut section = equivalent_section(&self.by_model, &dofs)?;
            section.width_m = block.width_m;
            let name = format!("{}, {}", self.file.name, block.name);
            let nodes = own.iter().flat_map(|g| &self.by_model.groups[*g].nodes);
            let part = SectionForcePart {
                sections: vec![block.name.clone()],
                name: name.clone(),
                options: self.strips(&own)?,
                gusts,
                model: TrainedModel {
                    name,
                    section,
                    tested_range: forces.tested.unwrap_or(whole.tested_range),
                    provenance: Provenance {
                        source: forces.source.clone(),
                        licence: forces.licence.clone(),
                        method: forces.method.clone(),
                        ..whole.provenance.clone()
                    },
                    experiment: whole.experiment.clone(),
                    schema_version: model.schema_version(),
                    model,
                },
            };
            all.insert(nodes.min().copied(), part);
        }
        Ok(all.into_values().collect())
    }

    /// A strip at each node of these groups, in the order of the nodes.
    fn strips(&self, groups: &[usize]) -> Result<ForceOptions> {
        let bridge = &self.by_model;
        let of_group = |g: &usize| {
            let group = &bridge.groups[*g];
            group.nodes.iter().map(move |n| (*n, group))
        };
        let mut own: Vec<_> = groups.iter().flat_map(of_group).collect();
        own.sort_by_key(|(node, _)| *node);
        let strip = |(node, group): &(usize, &StripGroup)| StripOptions {
            width_m: group.width_m,
            length_m: bridge.nodes[*node].length_m,
            wind_factor: group.wind_factor,
            model: 0,
        };
        let numbers = own.iter().map(|(n, _)| node_number(&bridge.nodes, *n));
        let options = ForceOptions {
            strips: own.iter().map(strip).collect(),
            named_strips: true,
            nodes: numbers.collect(),
            ..ForceOptions::single(bridge.width_m())
        };
        options.validate()?;
        Ok(options)
    }
}

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
            allow_unstable: true,
            ..Export::default()
        }
    }

    /// Connections with the structure, there and back.
    fn connections(&self) -> Vec<Connection> {
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
                    Dof::Torsion => {
                        let motion = ["rotation", "rotation_rate"];
                        (motion, "total_moment", "external_moment")
                    }
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
        motions.extend(forces);
        motions
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
        let forces = self.joined(self.section_forces(&model, None)?)?;
        let (model, structure) = self.structure(model, whole, true)?;
        let values = structure.bridge.as_ref().map(structure_values);
        let experiment = model.experiment.clone();
        let structure = Export {
            verdict: Some(verdict.clone()),
            label: label.clone(),
            ..structure
        };
        let export = Export {
            verdict: Some(verdict.clone()),
            ..forces.packed(label, FmiVersion::Two)
        };
        let of_forces = [
            ("wind_speed", forces.model.experiment.wind_speed_m_s),
            ("air_density", self.by_model.air_density_kg_m3),
            ("prediction", forces.options.prediction_steps),
        ];
        let of_forces = of_forces.map(|(name, value)| (name.to_owned(), value));
        let components = vec![
            SystemComponent {
                name: STRUCTURE.to_owned(),
                fmu: package(&model, runtimes, structure)?,
                values: values.unwrap_or_default(),
            },
            SystemComponent {
                name: FORCE.to_owned(),
                fmu: package(&forces.model, runtimes, export)?,
                values: of_forces.to_vec(),
            },
        ];
        Ok(System {
            name: self.file.name.clone(),
            components,
            connections: forces.connections(),
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
