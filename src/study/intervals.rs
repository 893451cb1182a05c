//! Intervals of the onsets of a study.

use super::{FlutterStudy, RouteTable, Study};
use crate::error::Result;
use crate::flutter::{FlutterSearch, Onset, OnsetInterval, OnsetMethod};
use crate::section::Structure;
use crate::trained_model::TrainedModel;
use crate::uncertainty::ModelUncertainty;

/// Uncertainty of one model, or why it is not known.
pub(crate) type KnownUncertainty = std::result::Result<Box<ModelUncertainty>, String>;

/// Gives every onset of a trained model its interval, in the order of `models`; onsets that the data do not determine are
/// no onsets any more (see [`FlutterStudy::undetermined`]).
pub(crate) fn state_intervals(
    results: &mut FlutterStudy,
    study: &Study,
    models: &[TrainedModel],
    known: &[KnownUncertainty],
) -> Result<()> {
    state_each(results.onsets.iter_mut(), study, models, known)?;
    results.separate_undetermined();
    Ok(())
}

/// As [`state_intervals`] for the onsets that a table of routes found by eigenvalues.
pub(crate) fn state_route_intervals(
    table: &mut RouteTable,
    study: &Study,
    models: &[TrainedModel],
    known: &[KnownUncertainty],
) -> Result<()> {
    let onsets = table.routes.iter_mut().filter_map(|r| match &mut r.search {
        FlutterSearch::Onset(onset) => Some(onset.as_mut()),
        FlutterSearch::UnstableAtOrBelow(_) | FlutterSearch::StableUpTo(_) => None,
    });
    state_each(onsets, study, models, known)
}

fn state_each<'a>(
    onsets: impl Iterator<Item = &'a mut Onset>,
    study: &Study,
    models: &[TrainedModel],
    known: &[KnownUncertainty],
) -> Result<()> {
    let structure = study.section.structure()?;
    let by_roots = |o: &&mut Onset| {
        !matches!(
            o.at.method,
            OnsetMethod::Determinant | OnsetMethod::PkIteration
        )
    };
    for onset in onsets.filter(by_roots) {
        let own = models
            .iter()
            .zip(known)
            .find(|(m, _)| m.name == onset.at.model);
        if let Some((model, known)) = own {
            onset.interval = interval_of(&structure, model, known, onset);
            onset
                .warnings
                .extend(known.iter().filter_map(|k| k.warning()));
        }
    }
    Ok(())
}

/// Interval of one onset of one model. A sensitivity that fails is a reason, not an error: the onset stands.
pub(crate) fn interval_of(
    structure: &Structure,
    model: &TrainedModel,
    known: &KnownUncertainty,
    onset: &Onset,
) -> OnsetInterval {
    match known {
        Ok(uncertainty) => uncertainty
            .interval(&model.model, structure, onset)
            .unwrap_or_else(|e| OnsetInterval::none(e.to_string())),
        Err(reason) => OnsetInterval::none(reason.clone()),
    }
}
