//! `aerodeck demo --bridge`: from wind-tunnel records to the flutter of a whole bridge.

use super::super::text::ending;
use super::files::BRIDGE_FMU;
use super::flutter::{computed, leave};
use super::summary::BridgeSummary;
use super::text::{MORE, text};
use crate::cli::stages::{MODEL_FILE, Stages};
use crate::cli::vocabulary::{
    Answer, BridgeStudy, Error, Label, OutputDir, Progress, Result, Runtime, Study, TrainedModel,
    Verdict,
};
use crate::files::bridge::BridgeFile;
use crate::fmu::package::package;
use crate::study::bridge::{BridgeExportOptions, demo_bridge_text};
use crate::study::{KnownUncertainty, RecordSet, demo_study_text};
use crate::verdict::StageFailure;
use std::path::Path;

const BRIDGE_FILE: &str = "bridge.toml";

/// Runs the chain into the folder `directory`.
pub(crate) fn run(directory: &Path, force: bool, progress: &Progress) -> Result<Answer> {
    let mut out = OutputDir::new(directory)?;
    out.write(BRIDGE_FILE, demo_bridge_text())?;
    let instead = "run yours with `aerodeck bridge flutter`, choose another --out";
    out.refuse_edited(BRIDGE_FILE, force, instead)?;
    let mut section = Study::from_toml(demo_study_text(), directory.to_path_buf())?;
    // the model of the records; the others compare forms of models, which the demo of the section does
    section.models.truncate(1);
    let mut section = Stages::new(section, out, progress)?;
    let at_hand = trained(&mut section)?;
    let mut out = section.out;
    let file = BridgeFile::from_toml(demo_bridge_text(), directory.to_path_buf())?;
    let study = BridgeStudy::with_trained(file, |_| Some(at_hand.clone()))?;
    let (results, mut failed) = computed(&study, &mut out, progress)?;
    let verdict = Verdict::judge(&study.evidence(&results, &failed));
    let fmu = || {
        let (model, mut export) = study.export(&BridgeExportOptions {
            onset_interval: results.interval(),
            ..BridgeExportOptions::default()
        })?;
        export.verdict = Some(verdict);
        export.label = Label::default().dated()?;
        out.write(BRIDGE_FMU, package(&model, &Runtime::available()?, export)?)
    };
    if let Err(e) = progress.during("packing the FMU", fmu) {
        failed.push(format!("FMU: {e}"));
    }
    let verdict = Verdict::judge(&study.evidence(&results, &failed));
    let mut text = text(&study, &results, &verdict, progress.verbose);
    let mut summary = BridgeSummary {
        bridge_file: demo_bridge_text().to_owned(),
        command: "aerodeck demo --bridge --out results".to_owned(),
        failed,
        ..BridgeSummary::new(&study, &results, &verdict)?
    };
    leave(&mut summary, &mut out)?;
    let written = out.commit()?;
    text.push_str(&ending(&written, MORE, progress.verbose));
    Ok(Answer::new(text, &summary)?
        .passed_if(summary.failed.is_empty())
        .with_outcome_of(&verdict))
}

/// The records of the virtual tunnel and the model trained on them.
fn trained(section: &mut Stages<'_>) -> Result<(TrainedModel, KnownUncertainty)> {
    let records = RecordSet::in_memory(section.tunnel()?);
    let models = section.train(Some(&records))?;
    // the model of the section alone is not what is exported here
    section.out.discard(MODEL_FILE);
    let first = models.into_iter().next();
    let first = first.map(|t| (t.model, t.uncertainty));
    first.ok_or_else(|| {
        let why = section.failed.first().map(StageFailure::explain);
        let why = why.unwrap_or("no model in the study".to_owned());
        Error::Numerical(format!("no model can be trained: {why}"))
    })
}
