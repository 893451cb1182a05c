//! Training the models of a study.

use super::onsets::coupled;
use super::{Deck, ModelBlock, RecordSet, Study};
use crate::error::{Error, Result};
use crate::flutter::find_onset;
use crate::identification::{FitReport, OnProgress, fit_discrete, fit_records, fit_table};
use crate::trained_model::{Experiment, Model, Provenance, SCHEMA_VERSION, TrainedModel};

/// A model with the account of its fit.
#[derive(Debug, Clone)]
pub struct TrainedWithReport {
    /// What is saved.
    pub model: TrainedModel,
    /// How well it fits.
    pub report: FitReport,
}

/// Trains one model of a study from its records or table.
///
/// # Errors
/// [`Error::Input`] for speed groups that do not exist and data the fit cannot use.
pub fn train_one(
    study: &Study,
    block: &ModelBlock,
    deck: &Deck,
    records: &RecordSet,
    progress: OnProgress<'_>,
) -> Result<TrainedWithReport> {
    let groups = block
        .speed_groups
        .as_deref()
        .or(study.deck.speed_groups.as_deref());
    let (model, report) = if let Some(fit) = &block.table {
        let samples = deck.samples(study, groups)?;
        fit_table(&samples, &study.section.dofs(), fit)?
    } else {
        let chosen = records.select(groups)?;
        match (&block.records, &block.discrete) {
            (Some(fit), _) => fit_records(&chosen, fit, progress)?,
            (_, Some(fit)) => fit_discrete(&chosen, fit, progress)?,
            (None, None) => {
                return Err(Error::input(
                    format!("model {}", block.name),
                    "one of `records`, `table`, `discrete`",
                    "none",
                ));
            }
        }
    };
    let experiment = experiment(study, block, &model, &report)?;
    let trained = TrainedModel {
        schema_version: SCHEMA_VERSION,
        name: block.name.clone(),
        section: study.section.clone(),
        tested_range: report.tested_range,
        provenance: Provenance {
            source: deck.description(),
            licence: deck.licence(),
            method: report.method.clone(),
            aerodeck_version: env!("CARGO_PKG_VERSION").to_owned(),
            notes: report.notes.clone(),
        },
        model,
        experiment,
    };
    trained.validate()?;
    Ok(TrainedWithReport {
        model: trained,
        report,
    })
}

/// A released section just below the onset, so that an importer that merely runs the FMU sees something.
fn experiment(
    study: &Study,
    block: &ModelBlock,
    model: &Model,
    report: &FitReport,
) -> Result<Experiment> {
    let section = coupled(&study.section.structure()?, model)?;
    let search = find_onset(
        &block.name,
        &section,
        &study.flutter.search(),
        Some(report.tested_range),
    )?;
    let limit = study.flutter.speed_max_m_s;
    let onset = search.onset().map_or(limit, |o| o.speed_m_s);
    let export = &study.export;
    // a round number of decimetres per second reads better in an importer
    let speed = (10.0 * export.part_of_onset * onset).floor() / 10.0;
    Ok(Experiment {
        wind_speed_m_s: if speed > 0.0 {
            speed
        } else {
            export.part_of_onset * onset
        },
        initial_vertical_m: export.initial_vertical_m,
        initial_rotation_rad: export.initial_rotation_deg.to_radians(),
        stop_time_s: export.stop_time_s,
        step_size_s: export.step_size_s,
        onset_search_limit_m_s: limit,
    })
}
