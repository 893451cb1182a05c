//! Intervals of the onsets of a study.

use super::{FlutterStudy, RouteTable, Study, slug};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result};
use crate::flutter::{FlutterSearch, MovedOnset, Onset, OnsetInterval, OnsetMethod, OnsetSearch};
use crate::identification::FitReport;
use crate::json;
use crate::section::{SectionModel, Structure};
use crate::trained_model::TrainedModel;
use crate::uncertainty::ModelUncertainty;
use std::path::{Path, PathBuf};

/// Uncertainty of one model, or why it is not known.
pub type KnownUncertainty = std::result::Result<Box<ModelUncertainty>, String>;

/// Folder of the fit reports in a folder of results.
pub(crate) const FITS: &str = "fits";
/// Ending of the uncertainties, in the folder of the fit reports.
pub(crate) const UNCERTAINTY: &str = "uncertainty.json";

/// The uncertainty that training left in a folder of results.
pub(crate) fn saved_uncertainty(model: &TrainedModel, folder: &Path) -> Result<KnownUncertainty> {
    let file = format!("{}.{UNCERTAINTY}", slug(&model.name));
    let path = folder.join(FITS).join(file);
    if !path.exists() {
        return Ok(Err("no covariance was saved with the model".to_owned()));
    }
    let text = std::fs::read_to_string(&path).map_err(|e| Error::io(&path, e))?;
    let known = ModelUncertainty::from_json(&text).map_err(|e| e.in_file(&path))?;
    Ok(Ok(Box::new(known)))
}

/// What constraints of the fit of the model, in the first of the folders of results that has it, do to the onset of a section, which is `with`: as
/// training left it, or for another section by the model of the data alone; `None` where training left nothing.
pub(crate) fn saved_moved_onset(
    model: &TrainedModel,
    folders: &[PathBuf],
    section: &SectionModel,
    search: &OnsetSearch,
    with: &FlutterSearch,
) -> Result<Option<MovedOnset>> {
    let name = Path::new(FITS).join(format!("{}.json", slug(&model.name)));
    let mut paths = folders.iter().map(|folder| folder.join(&name));
    let Some(path) = &paths.find(|path| path.exists()) else {
        return Ok(None);
    };
    let text = std::fs::read_to_string(path).map_err(|e| Error::io(path, e))?;
    let report: FitReport = json::read("fit", &text)
        .map_err(|e| Error::json("the account of a fit", &e).in_file(path))?;
    let Some(held) = report.constraints else {
        return Ok(None);
    };
    let Some(alone) = held.unconstrained.filter(|_| *section != model.section) else {
        return Ok(held.onset);
    };
    alone.validate().map_err(|e| e.in_file(path))?;
    let alone = CoupledSection::with_model(&section.structure()?, &*alone).ok();
    let moved = MovedOnset::new(alone.as_ref(), with, search, model.tested_range);
    Ok(Some(moved))
}

/// The uncertainty that training left for the file of a model, beside it or beside the folder it is in; or why it is not known.
///
/// # Errors
/// [`Error::Io`] and [`Error::Input`] for a file of uncertainties that cannot be read.
pub fn uncertainty_beside(file: &Path, model: &TrainedModel) -> Result<KnownUncertainty> {
    let folder = file.parent().unwrap_or(Path::new(""));
    match saved_uncertainty(model, folder)? {
        Err(_) => saved_uncertainty(model, &folder.join("..")),
        known => Ok(known),
    }
}

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
        let mut all = models.iter().zip(known);
        let own = all.find(|(m, _)| m.name == onset.at.model);
        if let Some((model, known)) = own {
            onset.interval = interval_of(&structure, model, known, onset);
            let warning = known.as_ref().ok();
            let warning = warning.and_then(|k| k.warning_of(&structure, onset));
            onset.warnings.extend(warning);
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
