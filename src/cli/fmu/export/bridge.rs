//! A whole bridge as an FMU, its structure alone, or the wind forces on its sections.

use super::{ExportKind, FmuExportArgs};
use crate::cli::bridge::{self, files::BRIDGE_FMU};
use crate::cli::{Answer, Progress, headline, stages, warn};
use crate::error::{Error, Result, counted};
use crate::files::bridge::read_field;
use crate::fmu::package::{Export, Label, package};
use crate::plausibility::sentences;
use crate::study::bridge::{BridgeExportOptions, BridgeStudy, SectionForcePart, bridge_flutter};
use crate::trained_model::TrainedModel;
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
            ExportKind::Force => self.bridge_forces(&study, &wanted, &verdict),
            _ => self.bridge_unit(&study, &wanted, &verdict),
        };
        drop(stage);
        answer
    }

    /// Packs and writes a part of a bridge, by the name of its file; where it stands, and what is said of that.
    fn written(
        &self,
        model: &TrainedModel,
        export: Export,
        verdict: &Verdict,
        file: &str,
    ) -> Result<PathBuf> {
        let export = Export {
            verdict: Some(verdict.clone()),
            ..self.described(export)?
        };
        let bytes = package(model, &self.runtimes()?, export)?;
        let beside_the_file = || self.model.with_file_name(file);
        let path = self.out.clone().unwrap_or_else(beside_the_file);
        self.write(&path, &bytes)?;
        Ok(path)
    }

    /// The whole bridge, or its structure.
    fn bridge_unit(
        &self,
        study: &BridgeStudy,
        wanted: &BridgeExportOptions,
        verdict: &Verdict,
    ) -> Result<Answer> {
        let (file, of, exported) = match self.kind {
            ExportKind::Structure => (
                "bridge_structure.fmu",
                "the structure of ",
                study.structure(wanted),
            ),
            _ => (BRIDGE_FMU, "", study.export(wanted)),
        };
        let (model, export) = exported.map_err(stages::or_allow_unstable)?;
        let of_bridge = export.bridge.iter();
        let named = of_bridge.flat_map(|b| (0..b.named.len()).map(|n| b.node_name(n)));
        let named: Vec<String> = named.collect();
        let path = self.written(&model, export, verdict, file)?;
        let (name, modes) = (&study.file.name, study.by_model.modes.len());
        let text = headline::text(name, verdict, &[]);
        let text = format!(
            "{text}wrote {}: {of}{name} with {}; inputs and outputs at the {} {}\n",
            path.display(),
            counted(modes, "mode"),
            if named.len() == 1 { "node" } else { "nodes" },
            named.join(", ")
        );
        let json =
            serde_json::json!({ "fmu": path, "nodes": named, "modes": modes, "verdict": verdict });
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
        let export = forces.packed(&Label::default(), self.fmi);
        let path = self.written(&forces.model, export, verdict, "bridge_force.fmu")?;
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
