//! The stages of a study with their files: what `study` runs through and each command does alone.

use super::figures;
use super::report::folder::{SUMMARY, digest};
use super::vocabulary::{
    Error, Export, FlutterStudy, Label, OutputDir, Progress, Result, Runtime, Study, TrainedModel,
    Verdict, attempt, ensure, file_name,
};
use crate::aerodynamics::derivatives::DerivativeTable;
use crate::aeroelastic::CoupledSection;
use crate::files::derivatives::write_csv;
use crate::files::toml_lines::of_a_kind_of_ours;
use crate::flutter::{OnsetSearch, find_onset};
use crate::fmu::onset_bounds::OnsetBounds;
use crate::fmu::package::package;
use crate::study::{
    Deck, FITS, KnownUncertainty, RecordSet, TrainedWithReport, UNCERTAINTY, flutter_study,
    interval_of, is_of_a_file, state_intervals, train_one,
};
use crate::verdict::StageFailure;
use crate::wind_tunnel::{Record, RecordFile, RecordSource};
use std::ffi::OsString;
use std::path::Path;

/// Folder of the records in the output directory.
pub(crate) const RECORDS: &str = "records";
/// Folder of the trained models.
pub(crate) const MODELS: &str = "models";
/// Beside them, the fingerprint of the table that they were trained on.
const TABLE: &str = "table.sha1";
/// The model that goes into the FMU.
pub(crate) const MODEL_FILE: &str = "model.json";
/// The FMU.
pub(crate) const FMU_FILE: &str = "deck_section.fmu";

/// A study on its way through the stages.
pub(crate) struct Stages<'a> {
    /// With the selected model, once there is one.
    pub study: Study,
    pub deck: Deck,
    pub out: OutputDir,
    pub failed: Vec<StageFailure>,
    pub progress: &'a Progress,
}
impl<'a> Stages<'a> {
    /// With the deck that the study names.
    pub(crate) fn new(study: Study, out: OutputDir, progress: &'a Progress) -> Result<Self> {
        Ok(Self {
            deck: Deck::load(&study)?,
            study,
            out,
            failed: Vec::new(),
            progress,
        })
    }

    /// The value of a stage; a failure is noted.
    pub(crate) fn attempt<T>(
        &mut self,
        stage: impl Into<String>,
        result: Result<T>,
    ) -> Result<Option<T>> {
        attempt(&mut self.failed, stage, result)
    }

    /// The records of the virtual tunnel, written as well.
    pub(crate) fn tunnel(&mut self) -> Result<Vec<Record>> {
        let _stage = self.progress.stage("virtual wind tunnel");
        let (records, out) = (self.deck.virtual_records(&self.study)?, &mut self.out);
        let folder = Path::new(RECORDS);
        for name in virtual_records(&out.target(RECORDS)) {
            out.outdated(folder.join(name));
        }
        let name = |r: &Record| folder.join(format!("{}.csv", file_name(&r.header.name)));
        out.write_records(records.iter().map(|r| (name(r), r)))?;
        // the header of a record names it; a line alone is the whole notice
        let licence = self.deck.licence();
        if licence.contains('\n') {
            out.write(folder.join("LICENSE"), licence)?;
        }
        Ok(records)
    }

    /// Trains every model and writes model and report; without records (`None`) those that are fitted to the table.
    ///
    /// A model that cannot be trained is noted among the failures.
    pub(crate) fn train(&mut self, records: Option<&RecordSet>) -> Result<Vec<TrainedWithReport>> {
        let Self {
            study,
            deck,
            out,
            failed,
            progress,
        } = self;
        let mut trained = Vec::with_capacity(study.models.len());
        let none = RecordSet::none();
        let mut first_error = None;
        for (i, block) in study.models.iter().enumerate() {
            let file = format!("{}.json", block.slug());
            let [of_model, of_fit] = [MODELS, FITS].map(|folder| Path::new(folder).join(&file));
            let of_uncertainty = of_fit.with_file_name(format!("{}.{UNCERTAINTY}", block.slug()));
            let exported = (block.name == study.exported()?.name).then_some(Path::new(MODEL_FILE));
            // what an earlier run left of a model is not of this one
            for name in [&of_model, &of_fit, &of_uncertainty] {
                out.outdated(name);
            }
            exported.iter().for_each(|name| out.outdated(name));
            check_groups(study, i, deck, records)?;
            if records.is_none() && block.table.is_none() {
                let reason = "it needs records, which could not be made";
                let stage = format!("training of {}", block.name);
                failed.push(StageFailure::new(stage, reason));
                continue;
            }
            let result = progress.counting(&format!("training {}", block.name), |on_done| {
                train_one(study, block, deck, records.unwrap_or(&none), on_done)
            });
            let result = match result {
                Ok(result) => result,
                Err(e) if is_of_a_file(&e) => return Err(e),
                Err(e) => {
                    failed.push(StageFailure::new(format!("training of {}", block.name), &e));
                    first_error = first_error.or(Some(e));
                    continue;
                }
            };
            let json = result.model.to_json()?;
            out.write(of_model, &json)?;
            out.write_json(of_fit, "fit", &result.report)?;
            if let Ok(uncertainty) = &result.uncertainty {
                out.write(of_uncertainty, uncertainty.to_json()?)?;
            }
            if let Some(name) = exported {
                out.write(name, json)?;
            }
            trained.push(result);
        }
        leave_fingerprint(deck, out)?;
        match first_error {
            Some(error @ Error::Input(_)) if trained.is_empty() => Err(error),
            _ => Ok(trained),
        }
    }

    /// Curves and onsets of models that were trained just now, with their intervals.
    pub(crate) fn flutter_of(&mut self, trained: &[TrainedWithReport]) -> Result<FlutterStudy> {
        let models: Vec<_> = trained.iter().map(|t| t.model.clone()).collect();
        let known: Vec<_> = trained.iter().map(|t| t.uncertainty.clone()).collect();
        let mut results = self.flutter(&models, &known)?;
        self.failed.append(&mut results.failed);
        Ok(results)
    }

    /// Packs a model of the study with all runtimes that are there.
    pub(crate) fn export(
        &self,
        own: &TrainedWithReport,
        verdict: &Verdict,
        allow_unstable: bool,
    ) -> Result<Vec<u8>> {
        let _stage = self.progress.stage("packing the FMU");
        let label = Label {
            name: Some(self.study.name.clone()),
            author: self.study.export.author.clone(),
            copyright: self.study.export.copyright.clone(),
            generated: None,
        };
        let label = label.dated()?;
        let (model, structure) = (&own.model, own.model.section.structure()?);
        let section = CoupledSection::with_model(&structure, &model.model)?;
        let search = OnsetSearch::up_to(model.experiment.onset_search_limit_m_s);
        let found = find_onset(&model.name, &section, &search, Some(model.tested_range))?;
        let interval = found.onset();
        let interval = interval.map(|o| interval_of(&structure, model, &own.uncertainty, o));
        let export = Export {
            label,
            bounds: interval.as_ref().and_then(OnsetBounds::from_interval),
            verdict: Some(verdict.clone()),
            allow_unstable,
            ..Export::default()
        };
        package(model, &Runtime::available()?, export).map_err(or_allow_unstable)
    }
}

/// Models and fits that an earlier study says it wrote there, of which this one has none, go; those of a bridge stay.
pub(super) fn outdate_models(out: &mut OutputDir) {
    let text = std::fs::read_to_string(out.target(SUMMARY)).unwrap_or_default();
    let earlier: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
    let files = earlier["study"].as_str().and(earlier["files"].as_array());
    let files = files.into_iter().flatten().filter_map(|f| f.as_str());
    for file in files.map(Path::new) {
        // by folder and name: it may have been run from elsewhere
        for folder in [MODELS, FITS].map(Path::new) {
            if let Some(name) = file.file_name().filter(|n| file.ends_with(folder.join(n))) {
                out.outdated(folder.join(name));
            }
        }
    }
}

/// Names of the records in a folder that the virtual tunnel made.
fn virtual_records(folder: &Path) -> Vec<OsString> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let of_tunnel = |path: &Path| {
        let record = RecordFile::open(path).ok();
        record.is_some_and(|r| r.header().source.starts_with("virtual tunnel"))
    };
    let made = entries.filter(|e| of_tunnel(&e.path()));
    made.map(|e| e.file_name()).collect()
}

/// Writes of which table the models are. What other commands left beside models of another table is not of this one.
fn leave_fingerprint(deck: &Deck, out: &mut OutputDir) -> Result<()> {
    let name = Path::new(MODELS).join(TABLE);
    let own = fingerprint(deck)?;
    let before = std::fs::read_to_string(out.target(&name)).ok();
    if before.is_some() && before != own {
        for stem in ["routes", "selection", "selection_metrics", "simulation"] {
            figures::outdated(stem, out);
        }
        out.outdated("simulation.csv");
    }
    match own {
        Some(of_table) => out.write(name, of_table)?,
        None => out.outdated(name),
    }
    Ok(())
}

/// What tells the numbers of the deck's table from those of a revised one; none of a deck that is exact.
fn fingerprint(deck: &Deck) -> Result<Option<String>> {
    let of_table = |table: &DerivativeTable| {
        let mut text = Vec::new();
        let written = write_csv(table, &mut text).map_err(|e| Error::io(TABLE, e));
        written.map(|()| digest(&text) + "\n")
    };
    deck.table().map(of_table).transpose()
}

/// Refuses speed groups that do not exist before anything is trained: that is a wrong key, no failure of a stage.
fn check_groups(study: &Study, i: usize, deck: &Deck, records: Option<&RecordSet>) -> Result<()> {
    let block = &study.models[i];
    let (groups, place) = match block.speed_groups.as_deref() {
        Some(own) => (Some(own), format!("model[{i}].speed_groups")),
        None => {
            let of_deck = study.deck.speed_groups.as_deref();
            (of_deck, "deck.speed_groups".to_owned())
        }
    };
    let chosen = match records {
        _ if groups.is_none() => Ok(()),
        Some(records) if block.table.is_none() => records.select(groups).map(drop),
        _ => deck.samples(study, groups).map(drop),
    };
    chosen.map_err(|e| e.at(place))
}

impl Stages<'_> {
    /// Reads the models that `train` wrote; one that is not there, or is of another deck, is noted among the failures.
    pub(crate) fn read_models(&mut self) -> Result<Vec<TrainedModel>> {
        let (study, deck, folder) = (&self.study, &self.deck, self.out.target(MODELS));
        let file = folder.join(TABLE);
        let trained_on = std::fs::read_to_string(&file).ok();
        let same = trained_on.is_none() || trained_on == fingerprint(deck)?;
        let expected = "models of the deck of the study (run `aerodeck train` again)";
        ensure(same, "", expected, "those of another table").map_err(|e| e.in_file(&file))?;
        let own = deck.description();
        let of_deck = |model: TrainedModel| {
            let source = &model.provenance.source;
            let expected =
                format_args!("{own}, the deck of the study (run `aerodeck train` again)");
            ensure(*source == own, "provenance.source", expected, source).map(|()| model)
        };
        let mut models = Vec::new();
        let mut first_error = None;
        for block in &study.models {
            let file = format!("{}.json", block.slug());
            let path = folder.join(file);
            let model = read_model(&path).and_then(of_deck);
            match model.map_err(|e| e.in_file(&path)) {
                Ok(model) => models.push(model),
                Err(e) => {
                    let stage = format!("reading {}", block.name);
                    self.failed.push(StageFailure::new(stage, &e));
                    first_error = first_error.or(Some(e));
                }
            }
        }
        match first_error {
            Some(error) if models.is_empty() => Err(error),
            _ => Ok(models),
        }
    }

    /// Curves and onsets with their intervals.
    pub(crate) fn flutter(
        &self,
        models: &[TrainedModel],
        known: &[KnownUncertainty],
    ) -> Result<FlutterStudy> {
        let _stage = self.progress.stage("modes over wind speed");
        let mut results = flutter_study(&self.study, &self.deck, models)?;
        state_intervals(&mut results, &self.study, models, known)?;
        Ok(results)
    }
}

/// Reads one trained model.
pub(crate) fn read_model(path: &Path) -> Result<TrainedModel> {
    let expected = "a trained model (run `aerodeck train` first)";
    ensure(path.exists(), "", expected, "no such file").map_err(|e| e.in_file(path))?;
    let what = "a trained model as written by `aerodeck train`";
    TrainedModel::read(path).map_err(|e| of_a_kind_of_ours(what, path).unwrap_or(e))
}

/// A refused export with the flag that allows it.
pub(crate) fn or_allow_unstable(error: Error) -> Error {
    match error {
        Error::Unstable(text) => {
            Error::Unstable(format!("{text} (--allow-unstable exports it anyway)"))
        }
        other => other,
    }
}
