//! Training the models of a study.

use super::{Deck, KnownUncertainty, ModelBlock, RecordSet, Study};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result};
use crate::flutter::{FlutterSearch, MovedOnset, StableRange, divergence_with_forces, find_onset};
use crate::identification::{FitReport, Fitted};
use crate::numbered::OnDone;
use crate::trained_model::{Provenance, TrainedModel};
use crate::uncertainty::{CoefficientUncertainty, FormEnsemble, ModelOfData, ModelUncertainty};

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
    progress: OnDone<'_>,
) -> Result<TrainedWithReport> {
    let ModelOfData {
        fitted: Fitted { model, mut report },
        estimate,
        forms,
    } = fit(study, block, deck, records, progress)?;
    if block.table.is_none() {
        report.notes.extend(records.note.clone());
    }
    let structure = study.section.structure()?;
    let (range, tested) = (study.speeds().search(), report.tested_range);
    let search = CoupledSection::with_model(&structure, &model)
        .and_then(|section| find_onset(&block.name, &section, &range, Some(tested)));
    // a search that fails takes no trained model with it
    let search = search.unwrap_or_else(|e| {
        report.notes.push(format!("onset: {e}"));
        FlutterSearch::StableUpTo(StableRange {
            from_m_s: 0.0,
            to_m_s: 0.0,
            not_judged: Some(e.to_string()),
        })
    });
    if let Some(constraints) = &mut report.constraints {
        let alone = constraints.unconstrained.as_deref();
        let alone = alone.and_then(|m| CoupledSection::with_model(&structure, m).ok());
        constraints.onset = Some(MovedOnset::new(alone.as_ref(), &search, &range, tested));
    }
    let uncertainty = estimate
        .and_then(|estimate| model_uncertainty(study, estimate, &mut report, &search))
        .and_then(|known| match FormEnsemble::or_noted(forms, &mut report)? {
            Some(forms) => known.with_forms(forms, &structure, &range),
            None => Ok(known),
        })
        .map(Box::new)
        .map_err(|e| e.to_string());
    let limit_m_s = study.speeds().searched_to_m_s;
    // where it cannot be computed, the stages that follow say why
    let divergence = divergence_with_forces(&structure, &model);
    let first_m_s = search.first_limit_m_s(divergence.ok().flatten(), limit_m_s);
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
        experiment: study.export.experiment(first_m_s, limit_m_s),
    };
    trained.validate()?;
    Ok(TrainedWithReport {
        model: trained,
        report,
        uncertainty,
    })
}

/// Fits to the table, to records, or to records in discrete time, as the block of the model says, and fits of other forms to that
/// table, or to the derivatives that the records show.
fn fit(
    study: &Study,
    block: &ModelBlock,
    deck: &Deck,
    records: &RecordSet,
    progress: OnDone<'_>,
) -> Result<ModelOfData> {
    let own = block.speed_groups.as_deref();
    let groups = own.or(study.deck.speed_groups.as_deref());
    let (dofs, name) = (study.section.dofs(), deck.table_name());
    if let Some(fit) = &block.table {
        return ModelOfData::of_table(&deck.samples(study, groups)?, &dofs, fit, name);
    }
    let chosen = records.select(groups)?;
    if let Some(fit) = &block.records {
        return ModelOfData::of_records(&chosen, &dofs, fit, name, progress);
    }
    let Some(fit) = &block.discrete else {
        let place = format!("model {}", block.name);
        let expected = "one of `records`, `table`, `discrete`";
        return Err(Error::input(place, expected, "none"));
    };
    ModelOfData::of_discrete(&chosen, fit, name, progress)
}

/// The uncertainty of coefficients, derivatives and onset, with what is to be said of it in the report.
fn model_uncertainty(
    study: &Study,
    estimate: CoefficientUncertainty,
    report: &mut FitReport,
    search: &FlutterSearch,
) -> Result<ModelUncertainty> {
    estimate.enter(report);
    let known = ModelUncertainty::new(
        estimate,
        &study.section.structure()?,
        search.onset(),
        study.speeds().search(),
        report.tested_range,
    )?;
    let speeds = known.coefficients.speeds.as_ref();
    report.notes.extend(speeds.map(|s| s.describe()));
    report.notes.extend(known.speeds.explain());
    report.notes.extend(known.warning());
    Ok(known)
}
