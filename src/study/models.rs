//! Training the models of a study.

use super::{Deck, KnownUncertainty, ModelBlock, RecordSet, Study};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result};
use crate::flutter::{FlutterSearch, StableRange, find_onset};
use crate::identification::{
    FitReport, OnProgress, OnsetEffect, fit_discrete, fit_records, fit_table,
};
use crate::trained_model::{Experiment, Model, Provenance, TrainedModel};
use crate::uncertainty::{
    ModelUncertainty, discrete_uncertainty, record_uncertainty, table_uncertainty,
};
use crate::units::ReducedFrequencyRange;

/// A model with the account of its fit.
#[derive(Debug, Clone)]
pub struct TrainedWithReport {
    /// What is saved.
    pub model: TrainedModel,
    /// How well it fits.
    pub report: FitReport,
    /// How far the data leave its coefficients, derivatives and onset open.
    pub uncertainty: KnownUncertainty,
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
    let (model, mut report, estimate) = if let Some(fit) = &block.table {
        let samples = deck.samples(study, groups)?;
        let dofs = study.section.dofs();
        let (model, report) = fit_table(&samples, &dofs, fit)?;
        let estimate = table_uncertainty(&samples, &dofs, fit, &report);
        (model, report, estimate)
    } else {
        let chosen = records.select(groups)?;
        match (&block.records, &block.discrete) {
            (Some(fit), _) => {
                let (model, report) = fit_records(&chosen, fit, progress)?;
                let estimate = record_uncertainty(&chosen, fit, &report, progress);
                (model, report, estimate)
            }
            (_, Some(fit)) => {
                let (model, report) = fit_discrete(&chosen, fit, progress)?;
                let estimate = discrete_uncertainty(&chosen, fit, &model, progress);
                (model, report, estimate)
            }
            (None, None) => {
                return Err(Error::input(
                    format!("model {}", block.name),
                    "one of `records`, `table`, `discrete`",
                    "none",
                ));
            }
        }
    };
    // a search that fails takes no trained model with it
    let search = onset_of(study, block, &model, &report).unwrap_or_else(|e| {
        report.notes.push(format!("onset: {e}"));
        FlutterSearch::StableUpTo(StableRange {
            from_m_s: 0.0,
            to_m_s: 0.0,
            not_judged: Some(e.to_string()),
        })
    });
    if let Some(constraints) = &mut report.constraints {
        // an account only: a search that fails without constraints is no reason to refuse the model with them
        let alone = find_onset_of(
            study,
            block,
            &constraints.unconstrained,
            report.tested_range,
        );
        let speed = |search: &FlutterSearch| search.onset().map(|o| o.at.speed_m_s);
        constraints.onset = Some(OnsetEffect {
            without_m_s: alone.ok().as_ref().and_then(speed),
            with_m_s: speed(&search),
        });
    }
    let uncertainty = estimate
        .and_then(|estimate| {
            estimate.enter(&mut report);
            ModelUncertainty::new(
                estimate,
                &study.section.structure()?,
                search.onset(),
                study.speeds().search(),
                report.tested_range,
            )
        })
        .map(Box::new)
        .map_err(|e| e.to_string());
    if let Ok(known) = &uncertainty {
        let speeds = known.coefficients.speeds.as_ref();
        report.notes.extend(speeds.map(|s| s.describe()));
        report.notes.extend(known.speeds.explain());
        report.notes.extend(known.warning());
    }
    let experiment = experiment(study, &search);
    let trained = TrainedModel {
        schema_version: model.schema_version(),
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
        uncertainty,
    })
}

/// Onset of the coupled section.
fn onset_of(
    study: &Study,
    block: &ModelBlock,
    model: &Model,
    report: &FitReport,
) -> Result<FlutterSearch> {
    find_onset_of(study, block, model, report.tested_range)
}

fn find_onset_of(
    study: &Study,
    block: &ModelBlock,
    model: &Model,
    tested: ReducedFrequencyRange,
) -> Result<FlutterSearch> {
    let section = CoupledSection::with_model(&study.section.structure()?, model)?;
    find_onset(
        &block.name,
        &section,
        &study.speeds().search(),
        Some(tested),
    )
}

/// A released section just below the onset, so that an importer that merely runs the FMU sees something.
fn experiment(study: &Study, search: &FlutterSearch) -> Experiment {
    let limit = study.speeds().speed_max_m_s;
    let onset = search.critical_speed_m_s().unwrap_or(limit);
    let export = &study.export;
    // a round number of decimetres per second reads better in an importer
    let speed = (10.0 * export.part_of_onset * onset).floor() / 10.0;
    Experiment {
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
    }
}
