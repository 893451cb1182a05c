//! A whole bridge as an FMU, its structure alone, or the wind forces on its sections.

use super::{ExportKind, FmuExportArgs};
use crate::cli::answer::Answer;
use crate::cli::bridge::{self, files::BRIDGE_FMU};
use crate::cli::common::warn;
use crate::cli::progress::Progress;
use crate::cli::{headline, stages};
use crate::error::{Error, Result, counted};
use crate::files::bridge::read_field;
use crate::fmu::package::{BridgeExport, package, package_bridge};
use crate::plausibility::sentences;
use crate::study::bridge::{BridgeExportOptions, BridgeStudy, SectionForcePart, bridge_flutter};
use crate::verdict::Verdict;
use std::path::PathBuf;

/// The word for the static coefficients of the bridge file.
const STATIC: &str = "static";

impl FmuExportArgs {
    /// Refuses what a bridge, or this part of one, does not have.
    fn check_bridge(&self) -> Result<()> {
        use ExportKind::{Force, Section, Structure};
        let strips = "none: the strips of a bridge are those of its nodes";
        let of_gusts = match self.kind {
            Force => "`static`, the coefficients of the bridge file",
            _ => "--gust-strips and the `static` coefficients of the bridge file",
        };
        let other_gusts = self
            .gusts
            .as_deref()
            .is_some_and(|g| self.kind != Force || g != STATIC);
        let of_whole = "--kind section: the whole bridge";
        let given: [(&str, bool, &str); 8] = [
            ("--strips", self.strips.is_some(), strips),
            ("--strip-length", self.strip_length.is_some(), strips),
            (
                "--prediction",
                self.prediction.is_some() && self.kind != Force,
                "--kind force with it",
            ),
            (
                "--section",
                self.section.is_some() && self.kind != Force,
                "--kind force with it",
            ),
            ("--gusts", other_gusts, of_gusts),
            (
                "--nodes",
                !self.nodes.is_empty() && self.kind == Force,
                "none: forces act on all nodes",
            ),
            (
                "--gust-strips",
                self.gust_strips.is_some() && self.kind != Section,
                of_whole,
            ),
            (
                "--turbulence",
                self.turbulence.is_some() && self.kind != Section,
                of_whole,
            ),
        ];
        let kind = match self.kind {
            Section => "--bridge",
            Force => "--bridge --kind force",
            Structure => "--bridge --kind structure",
        };
        match given.into_iter().find(|(_, given, _)| *given) {
            None => Ok(()),
            Some((flag, _, expected)) => Err(Error::input(flag, expected, kind)),
        }
    }

    /// Packs a bridge, or what is wanted of it.
    pub(super) fn of_bridge(&self, progress: &Progress) -> Result<Answer> {
        self.check_bridge()?;
        let study = bridge::read(&self.model, progress)?;
        let stage = progress.stage("packing the FMU");
        let mut wanted = BridgeExportOptions {
            nodes: self.nodes.clone(),
            allow_unstable: self.allow_unstable,
            gust_strips: self.gust_strips,
            admittance: self.admittance.unwrap_or_default(),
            turbulence: self.turbulence.as_deref().map(read_field).transpose()?,
            onset_interval: None,
        };
        let field = wanted.turbulence.as_ref();
        let of_field = field.map(|field| study.findings_of(field, field.mean_speed_m_s));
        let mut odd = sentences(&of_field.unwrap_or_default());
        odd.extend(study.other_admittance(&wanted));
        warn(&self.model, &odd);
        let results = bridge_flutter(&study)?;
        wanted.onset_interval = results.interval();
        let verdict = Verdict::judge(&study.evidence(&results, &results.failed));
        let answer = match self.kind {
            ExportKind::Section => {
                let export = study.export(&wanted).map_err(stages::or_allow_unstable)?;
                self.bridge_unit(export, &verdict, BRIDGE_FMU)
            }
            ExportKind::Structure => {
                let export = study
                    .structure(&wanted)
                    .map_err(stages::or_allow_unstable)?;
                self.bridge_unit(export, &verdict, "bridge_structure.fmu")
            }
            ExportKind::Force => self.bridge_forces(&study, &wanted, &verdict),
        };
        drop(stage);
        answer
    }

    fn place(&self, name: &str) -> PathBuf {
        let beside_the_file = || self.model.with_file_name(name);
        self.out.clone().unwrap_or_else(beside_the_file)
    }

    /// The whole bridge, or its structure.
    fn bridge_unit(
        &self,
        mut export: BridgeExport,
        verdict: &Verdict,
        file: &str,
    ) -> Result<Answer> {
        export.listing = self.listing();
        export.reference_runs = !self.no_reference;
        export.verdict = Some(verdict.clone());
        let bytes = package_bridge(&export, &self.runtimes()?, &self.label()?, self.fmi)?;
        let path = self.place(file);
        self.write(&path, &bytes)?;
        let bridge = &export.bridge;
        let named: Vec<String> = (0..bridge.named.len())
            .map(|n| bridge.node_name(n))
            .collect();
        let text = headline::text(&bridge.name, verdict, &[]);
        let text = format!(
            "{text}wrote {}: {}{} with {}; inputs and outputs at the {} {}\n",
            path.display(),
            if bridge.structure_alone {
                "the structure of "
            } else {
                ""
            },
            bridge.name,
            counted(bridge.modes.len(), "mode"),
            if named.len() == 1 { "node" } else { "nodes" },
            named.join(", ")
        );
        let json = serde_json::json!({ "fmu": path, "nodes": named, "modes": bridge.modes.len(), "verdict": verdict });
        Ok(Answer::new(text, &json)?.with_outcome_of(verdict))
    }

    /// The wind forces on all sections, or on the one that is wanted.
    fn bridge_forces(
        &self,
        study: &BridgeStudy,
        wanted: &BridgeExportOptions,
        verdict: &Verdict,
    ) -> Result<Answer> {
        let gusts = self.gusts.as_ref().map(|_| wanted.admittance);
        let all = study
            .section_forces(wanted, gusts)
            .map_err(stages::or_allow_unstable)?;
        let mut forces = match &self.section {
            Some(name) => chosen(name, all)?,
            None => study.joined(all)?,
        };
        let prediction = &mut forces.options.prediction_steps;
        *prediction = self.prediction.unwrap_or(*prediction);
        let mut export = forces.packed(&self.label()?, self.fmi);
        export.listing = self.listing();
        export.reference_runs = !self.no_reference;
        export.verdict = Some(verdict.clone());
        let bytes = package(&forces.model, &self.runtimes()?, export)?;
        let path = self.place("bridge_force.fmu");
        self.write(&path, &bytes)?;
        let nodes = &forces.options.nodes;
        let text = headline::text(&study.file.name, verdict, &[]);
        let text = format!(
            "{text}wrote {}: forces on {} of {}, at the nodes {} to {}\n",
            path.display(),
            counted(nodes.len(), "strip"),
            forces.name,
            nodes[0],
            nodes[nodes.len() - 1],
        );
        let json = serde_json::json!({ "fmu": path, "sections": forces.sections, "nodes": nodes, "verdict": verdict });
        Ok(Answer::new(text, &json)?.with_outcome_of(verdict))
    }
}

/// The forces of the section of that name.
fn chosen(name: &str, mut all: Vec<SectionForcePart>) -> Result<SectionForcePart> {
    let mut each = all.iter();
    match each.position(|forces| forces.sections == [name]) {
        Some(place) => Ok(all.swap_remove(place)),
        None => {
            let names: Vec<String> = all.into_iter().flat_map(|f| f.sections).collect();
            let expected = format!("one of the sections {}", names.join(", "));
            Err(Error::input("--section", expected, format!("`{name}`")))
        }
    }
}
