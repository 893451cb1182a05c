//! The stages of a study with their files: what `study` runs through and each command does alone.

use super::output::OutputDir;
use super::progress::Progress;
use crate::error::{Error, Result};
use crate::flutter::{FlutterCurves, Onset};
use crate::fmu::package::{Runtime, package};
use crate::identification::{self, FitReport};
use crate::report::{PNG_SCALE, VfVgOptions, vf_vg_figure};
use crate::study::{
    Deck, FlutterStudy, KnownUncertainty, RecordSet, Study, TrainedWithReport, flutter_study,
    state_intervals, train_one,
};
use crate::trained_model::TrainedModel;
use crate::uncertainty::ModelUncertainty;
use crate::wind_tunnel::{Record, write_record};
use std::fs;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// Folder of the records in the output directory.
pub const RECORDS: &str = "records";
/// Folder of the trained models.
pub const MODELS: &str = "models";
/// Folder of the fit reports.
pub const FITS: &str = "fits";
/// Ending of the uncertainties, in the folder of the fit reports.
pub const UNCERTAINTY: &str = "uncertainty.json";
/// The model that goes into the FMU.
pub const MODEL_FILE: &str = "model.json";
/// The FMU.
pub const FMU_FILE: &str = "deck_section.fmu";
/// Force models that can be told apart in one figure.
pub const MAX_CURVES: usize = 7;
/// Stem of the figure of frequencies and damping ratios.
pub const FIGURE: &str = "flutter";

/// Writes the records of the virtual tunnel; gives the paths at which they stand for now.
pub fn tunnel(
    study: &Study,
    deck: &Deck,
    out: &mut OutputDir,
    progress: &Progress,
) -> Result<Vec<(PathBuf, Record)>> {
    let stage = progress.stage("virtual wind tunnel");
    let records = deck.virtual_records(study)?;
    let mut paths = Vec::with_capacity(records.len());
    for record in records {
        let path = out.stage(Path::new(RECORDS).join(format!("{}.csv", record.header.name)))?;
        let file = fs::File::create(&path).map_err(|e| Error::io(&path, e))?;
        write_record(&record, &mut BufWriter::new(file)).map_err(|e| e.in_file(&path))?;
        paths.push((path, record));
    }
    drop(stage);
    Ok(paths)
}

/// Trains every model and writes model and report.
pub fn train(
    study: &Study,
    deck: &Deck,
    records: &RecordSet,
    out: &mut OutputDir,
    progress: &Progress,
) -> Result<Vec<TrainedWithReport>> {
    let mut trained = Vec::with_capacity(study.models.len());
    for block in &study.models {
        let stage = progress.steps(&format!("training {}", block.name));
        let result = train_one(
            study,
            block,
            deck,
            records,
            &|p: identification::Progress| {
                let total = (p.passes * p.records) as u64;
                let done = ((p.pass - 1) * p.records + p.records_done) as u64;
                stage.at(done, total);
            },
        )?;
        let file = format!("{}.json", block.slug());
        let json = result.model.to_json()?;
        out.write(Path::new(MODELS).join(&file), &json)?;
        out.write(Path::new(FITS).join(&file), report_json(&result.report)?)?;
        if let Ok(uncertainty) = &result.uncertainty {
            let file = format!("{}.{UNCERTAINTY}", block.slug());
            out.write(Path::new(FITS).join(file), uncertainty.to_json()?)?;
        }
        if block.name == study.exported()?.name {
            out.write(MODEL_FILE, json)?;
        }
        trained.push(result);
        drop(stage);
    }
    Ok(trained)
}

fn report_json(report: &FitReport) -> Result<String> {
    let mut text =
        serde_json::to_string_pretty(report).map_err(|e| Error::Numerical(e.to_string()))?;
    text.push('\n');
    Ok(text)
}

/// Reads the models that `train` wrote.
pub fn read_models(study: &Study, directory: &Path) -> Result<Vec<TrainedModel>> {
    study
        .models
        .iter()
        .map(|block| {
            let path = directory
                .join(MODELS)
                .join(format!("{}.json", block.slug()));
            read_model(&path)
        })
        .collect()
}

/// Reads one trained model.
pub fn read_model(path: &Path) -> Result<TrainedModel> {
    if !path.exists() {
        return Err(Error::input(
            "",
            "a trained model (run `aerodeck train` first)",
            "no such file",
        )
        .in_file(path));
    }
    let text = fs::read_to_string(path).map_err(|e| Error::io(path, e))?;
    TrainedModel::from_json(&text).map_err(|e| e.in_file(path))
}

/// Reads the uncertainties that `train` wrote beside the models.
pub fn read_uncertainties(study: &Study, directory: &Path) -> Result<Vec<KnownUncertainty>> {
    study
        .models
        .iter()
        .map(|block| {
            let file = format!("{}.{UNCERTAINTY}", block.slug());
            let path = directory.join(FITS).join(file);
            if !path.exists() {
                return Ok(Err("no covariance was saved with the model".to_owned()));
            }
            let text = fs::read_to_string(&path).map_err(|e| Error::io(&path, e))?;
            let known = ModelUncertainty::from_json(&text).map_err(|e| e.in_file(&path))?;
            Ok(Ok(Box::new(known)))
        })
        .collect()
}

/// Curves and onsets with their intervals.
pub fn flutter(
    study: &Study,
    deck: &Deck,
    models: &[TrainedModel],
    known: &[KnownUncertainty],
    progress: &Progress,
) -> Result<FlutterStudy> {
    let stage = progress.stage("modes over wind speed");
    let mut results = flutter_study(study, deck, models)?;
    state_intervals(&mut results, study, models, known)?;
    drop(stage);
    Ok(results)
}

/// The V-f and V-g figure as SVG and PNG.
pub fn flutter_figure(
    study: &Study,
    results: &FlutterStudy,
    further: &[Onset],
    out: &mut OutputDir,
) -> Result<()> {
    let onsets: Vec<Onset> = results.onsets.iter().chain(further).cloned().collect();
    let options = VfVgOptions {
        title: Some(study.name.clone()),
        ..VfVgOptions::default()
    };
    let figure = vf_vg_figure(&results.curves, &onsets, &options)?;
    out.write(format!("{FIGURE}.svg"), figure.svg())?;
    out.write(format!("{FIGURE}.png"), figure.png(PNG_SCALE)?)
}

/// The same figure for all routes, as far as there are colours.
pub fn routes_figure(
    study: &Study,
    curves: &[FlutterCurves],
    onsets: &[Onset],
    out: &mut OutputDir,
) -> Result<()> {
    let curves = &curves[..curves.len().min(MAX_CURVES)];
    let drawn = |o: &&Onset| curves.iter().any(|c| c.model == o.model);
    let onsets: Vec<Onset> = onsets.iter().filter(drawn).cloned().collect();
    let options = VfVgOptions {
        title: Some(format!("{}: all routes", study.name)),
        ..VfVgOptions::default()
    };
    let figure = vf_vg_figure(curves, &onsets, &options)?;
    out.write("routes.svg", figure.svg())?;
    out.write("routes.png", figure.png(PNG_SCALE)?)
}

/// Packs a model with all runtimes that are there.
pub fn export(model: &TrainedModel, progress: &Progress) -> Result<Vec<u8>> {
    let stage = progress.stage("packing the FMU");
    let bytes = package(model, &Runtime::available()?)?;
    drop(stage);
    Ok(bytes)
}
