//! A whole bridge as an FMU, its structure alone, or the wind forces on its sections.

use super::{ExportKind, FmuExportArgs, none_of};
use crate::cli::bridge::{self, files::BRIDGE_FMU};
use crate::cli::vocabulary::{
    Answer, BridgeStudy, Error, Export, Label, Progress, Result, TrainedModel, Verdict, counted,
    sentences, warn,
};
use crate::cli::{headline, stages};
use crate::files::bridge::read_field;
use crate::study::bridge::{BridgeExportOptions, SectionForcePart, bridge_flutter};
use serde_json::{Value, json};
use std::path::PathBuf;

/// The word for the static coefficients of the bridge file.
const STATIC: &str = "static";

impl FmuExportArgs {
    /// Refuses what a bridge, or this part of one, does not have.
    fn check_bridge(&self) -> Result<()> {
        let forces = self.kind == ExportKind::Force;
        let whole = self.kind == ExportKind::Section;
        let (kind, of_gusts) = match self.kind {
            ExportKind::Section => ("--bridge", GUST_STRIPS),
            ExportKind::Force => (
                "--bridge --kind force",
                "`static`, the coefficients of the bridge file",
            ),
            ExportKind::Structure => ("--bridge --kind structure", GUST_STRIPS),
        };
        let gusts = self.gusts.as_deref();
        let other_gusts = gusts.is_some_and(|g| !forces || g != STATIC);
        let strips = "none: the strips of a bridge are those of its nodes";
        let of_forces = "--kind force with it";
        let of_whole = "--kind section: the whole bridge";
        let on_all = "none: forces act on all nodes";
        let prediction = !forces && self.prediction.is_some();
        let gust_strips = !whole && self.gust_strips.is_some();
        let turbulence = !whole && self.turbulence.is_some();
        let flags = [
            ("--strips", self.strips.is_some(), strips),
            ("--strip-length", self.strip_length.is_some(), strips),
            ("--prediction", prediction, of_forces),
            ("--section", !forces && self.section.is_some(), of_forces),
            ("--gusts", other_gusts, of_gusts),
            ("--nodes", forces && !self.nodes.is_empty(), on_all),
            ("--gust-strips", gust_strips, of_whole),
            ("--turbulence", turbulence, of_whole),
        ];
        none_of(flags, kind)
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
        let whole = study.export(&wanted);
        let (model, whole) = whole.map_err(stages::or_allow_unstable)?;
        let (path, what, mut json) = match self.kind {
            ExportKind::Force => self.bridge_forces(&study, &model, &verdict),
            _ => self.bridge_unit(&study, model, whole, &verdict),
        }?;
        drop(stage);
        json["fmu"] = json!(path);
        json["verdict"] = json!(verdict);
        let text = headline::text(&study.file.name, &verdict, &[]);
        let text = format!("{text}wrote {}: {what}\n", path.display());
        Ok(Answer::new(text, &json)?.with_outcome_of(&verdict))
    }

    /// The whole bridge, or its structure: where its archive stands, and what is in it, in words and for machines.
    fn bridge_unit(
        &self,
        study: &BridgeStudy,
        model: TrainedModel,
        whole: Export,
        verdict: &Verdict,
    ) -> Result<(PathBuf, String, Value)> {
        let (file, of, (model, export)) = match self.kind {
            ExportKind::Structure => {
                let structure = study.structure(model, whole, self.nodes.is_empty())?;
                ("bridge_structure.fmu", "the structure of ", structure)
            }
            _ => (BRIDGE_FMU, "", (model, whole)),
        };
        let of_bridge = export.bridge.iter();
        let named = of_bridge.flat_map(|b| (0..b.named.len()).map(|n| b.node_name(n)));
        let named: Vec<String> = named.collect();
        let export = Export {
            verdict: Some(verdict.clone()),
            ..export
        };
        let (path, _) = self.packed(&model, export, file)?;
        let modes = study.by_model.modes.len();
        let what = format!(
            "{of}{} with {}; inputs and outputs at the {} {}",
            study.file.name,
            counted(modes, "mode"),
            if named.len() == 1 { "node" } else { "nodes" },
            named.join(", ")
        );
        Ok((path, what, json!({ "nodes": named, "modes": modes })))
    }

    /// The wind forces on all sections, or on the one that is wanted, as [`Self::bridge_unit`].
    fn bridge_forces(
        &self,
        study: &BridgeStudy,
        whole: &TrainedModel,
        verdict: &Verdict,
    ) -> Result<(PathBuf, String, Value)> {
        let admittance = self.admittance.unwrap_or_default();
        let gusts = self.gusts.as_ref().map(|_| admittance);
        let all = study.section_forces(whole, gusts)?;
        let mut forces = match &self.section {
            Some(name) => chosen(name, all)?,
            None => study.joined(all)?,
        };
        let prediction = &mut forces.options.prediction_steps;
        *prediction = self.prediction.unwrap_or(*prediction);
        let export = Export {
            verdict: Some(verdict.clone()),
            ..forces.packed(&Label::default(), self.fmi)
        };
        let (path, _) = self.packed(&forces.model, export, "bridge_force.fmu")?;
        let nodes = &forces.options.nodes;
        let what = format!(
            "forces on {} of {}, at the nodes {} to {}",
            counted(nodes.len(), "strip"),
            forces.name,
            nodes[0],
            nodes[nodes.len() - 1],
        );
        let json = json!({ "sections": forces.sections, "nodes": nodes });
        Ok((path, what, json))
    }
}

/// What states the gusts on a whole bridge.
const GUST_STRIPS: &str = "--gust-strips and the `static` coefficients of the bridge file";

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
