//! `aerodeck study`: the whole chain of a study file.

use super::report::folder::{REPORT, SUMMARY, today};
use super::stages::{self, Stages};
use super::summary::{FitSummary, Summary};
use super::vocabulary::{
    Answer, Error, FlutterSearch, FlutterStudy, OnsetMethod, OutputDir, Progress, Result, Study,
    StudyArgs, Verdict, sentences,
};
use super::{buffeting, figures, headline, measured_forces, report, result_files, study_run, text};
use crate::study::{
    RecordSet, SteppedOnset, TrainedWithReport, interval_of, section_evidence, stepped_onset,
    study_findings,
};
use crate::verdict::{Evidence, StageFailure};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Stages that later ones ask for, in the messages of failures.
const RECORDS: &str = "records";
const STEPPING: &str = "stepping the FMU";

/// Runs the command.
pub(crate) fn run(
    args: &StudyArgs,
    allow_unstable: bool,
    force: bool,
    progress: &Progress,
) -> Result<Answer> {
    let (study, text) = args.read_with_text()?;
    let mut out = OutputDir::new(&args.directory())?;
    if force {
        out.replace(study_run::STUDY);
    }
    run_chain(study, &text, args.file(), out, allow_unstable, progress)
}

/// The whole chain of a study into `out`, with its text and the file that this stands in (none when it was read otherwise or
/// changed). A stage that fails is reported in its place and leaves the others as they are; then the answer did not pass.
pub(crate) fn run_chain(
    study: Study,
    text: &str,
    file: Option<&Path>,
    out: OutputDir,
    allow_unstable: bool,
    progress: &Progress,
) -> Result<Answer> {
    let mut chain = Stages::new(study, out, progress)?;
    let (study_file, study_text) = study_run::leave(&chain.study, text, file, &mut chain.out)?;
    let records = chain.records()?;
    let selection = chain.select(records.as_ref())?;
    let trained = chain.trained(records.as_ref())?;
    let mut results = chain.flutter_of(&trained)?;
    let own = chain.own(&trained)?;
    let verdict = chain.verdict(own, &results);
    let fmu = chain.packed(own, &verdict, allow_unstable)?;
    let stepped = chain.step(own, fmu, &mut results)?;
    let verdict = chain.verdict(own, &results);
    chain.draw(&trained, &results, &verdict)?;
    chain.draw_exported(own, &results, records.as_ref())?;
    let buffeting = chain.buffeting(own, &verdict)?;
    let summary = Summary {
        study_file,
        study_text,
        selection,
        buffeting,
        ..chain.summary(trained, results, stepped)?
    };
    chain.finish(summary)
}

impl Stages<'_> {
    /// The records of the study: measured, or those of the virtual tunnel.
    fn records(&mut self) -> Result<Option<RecordSet>> {
        let records = match self.study.deck.records.is_empty() {
            true => self.tunnel().map(RecordSet::in_memory),
            false => RecordSet::measured(&self.study),
        };
        self.attempt(RECORDS, records)
    }

    fn trained(&mut self, records: Option<&RecordSet>) -> Result<Vec<TrainedWithReport>> {
        let trained = self.train(records)?;
        let no_records = self.failed.iter().find(|f| f.stage == RECORDS);
        match no_records.filter(|_| trained.is_empty()) {
            Some(StageFailure { reason, .. }) => Err(Error::Numerical(format!(
                "no model can be trained: {reason}"
            ))),
            None => Ok(trained),
        }
    }

    /// The model that the study exports, if it was trained.
    fn own<'t>(&self, trained: &'t [TrainedWithReport]) -> Result<Option<&'t TrainedWithReport>> {
        let name = &self.study.exported()?.name;
        Ok(trained.iter().find(|t| t.model.name == *name))
    }

    /// Packs the model that the study exports; where its FMU stands for now.
    fn packed(
        &mut self,
        own: Option<&TrainedWithReport>,
        verdict: &Verdict,
        allow_unstable: bool,
    ) -> Result<Option<PathBuf>> {
        self.out.outdated(stages::FMU_FILE);
        let Some(own) = own else {
            let reason = format!("{} was not trained", self.study.exported()?.name);
            self.failed.push(StageFailure::new("export", reason));
            return Ok(None);
        };
        let bytes = self.export(own, verdict, allow_unstable);
        let Some(bytes) = self.attempt("export", bytes)? else {
            return Ok(None);
        };
        self.out.write(stages::FMU_FILE, bytes)?;
        self.out.stage(stages::FMU_FILE).map(Some)
    }

    /// Steps the FMU to its onset, which enters `results` as far as it is a result.
    fn step(
        &mut self,
        own: Option<&TrainedWithReport>,
        fmu: Option<PathBuf>,
        results: &mut FlutterStudy,
    ) -> Result<Option<SteppedOnset>> {
        let (Some(own), Some(path)) = (own, fmu) else {
            return Ok(None);
        };
        let (model, known) = (&own.model, &own.uncertainty);
        let highest_m_s = self.study.speeds().searched_to_m_s;
        let stepped = || stepped_onset(model, &path, highest_m_s);
        let found = self.progress.during(STEPPING, stepped);
        let Some((search, runs)) = self.attempt(STEPPING, found)? else {
            return Ok(None);
        };
        let mut onset = match search {
            FlutterSearch::Onset(onset) => *onset,
            none => {
                results.take(none, &model.name, OnsetMethod::FmuStepping);
                return Ok(None);
            }
        };
        let structure = self.study.section.structure()?;
        onset.interval = interval_of(&structure, model, known, &onset);
        let to = match onset.headline_m_s() {
            Ok(_) => &mut results.onsets,
            Err(_) => &mut results.undetermined,
        };
        to.push(onset.clone());
        Ok(Some(SteppedOnset { onset, runs }))
    }

    /// What everything found so far amounts to.
    fn verdict(&self, own: Option<&TrainedWithReport>, results: &FlutterStudy) -> Verdict {
        let (study, deck) = (&self.study, &self.deck);
        let (model, known) = (own.map(|t| &t.model), own.map(|t| &t.uncertainty));
        Verdict::judge(&Evidence {
            constraints: own.and_then(|t| t.report.constraints.as_ref()?.onset),
            ..section_evidence(study, deck, results, model, known, &self.failed)
        })
    }

    /// Figures and curves of all models.
    fn draw(
        &mut self,
        trained: &[TrainedWithReport],
        results: &FlutterStudy,
        verdict: &Verdict,
    ) -> Result<()> {
        let (study, out) = (&self.study, &mut self.out);
        let figure = result_files::flutter_figure(study, results, Some(verdict), out);
        let derivatives = result_files::write_derivatives(study, &self.deck, trained, out);
        let curves = result_files::write_curves(study, &results.curves, out);
        self.attempt("figure", figure)?;
        self.attempt("figure of derivatives", derivatives)?;
        self.attempt("curves", curves)?;
        Ok(())
    }

    /// Measured forces and motion of the exported model at its onset.
    fn draw_exported(
        &mut self,
        own: Option<&TrainedWithReport>,
        results: &FlutterStudy,
        records: Option<&RecordSet>,
    ) -> Result<()> {
        for stem in [measured_forces::FORCES, result_files::RESPONSE] {
            figures::outdated(stem, &mut self.out);
        }
        let Some(own) = own.filter(|_| figures::wanted()) else {
            return Ok(());
        };
        let Some(onset) = headline::own_onset(results, &own.model.name) else {
            return Ok(());
        };
        let at = &onset.at;
        if let Some(records) = records {
            let made = self.study.deck.records.is_empty();
            let origin = match made {
                true => "made from the deck",
                false => "measured",
            };
            let forces = measured_forces::write(&own.model, records, at, origin, &mut self.out);
            self.attempt("figure of measured forces", forces)?;
        }
        let response = result_files::write_response(&own.model, at, &mut self.out);
        self.attempt("figure of the motion", response)?;
        Ok(())
    }

    /// What `summary.json` holds, but for the files and the study's own.
    fn summary(
        &mut self,
        trained: Vec<TrainedWithReport>,
        results: FlutterStudy,
        stepped: Option<SteppedOnset>,
    ) -> Result<Summary> {
        // figures that failed since the last one are among the doubts
        let verdict = self.verdict(self.own(&trained)?, &results);
        let (study, deck) = (&self.study, &self.deck);
        let name = &study.exported()?.name;
        let failed = std::mem::take(&mut self.failed);
        let of_study = study_findings(study);
        let fit = |trained: TrainedWithReport| FitSummary {
            model: trained.model.name,
            report: trained.report,
            uncertainty: trained.uncertainty,
        };
        Ok(Summary {
            model: name.clone(),
            verdict,
            comparisons: headline::comparisons(&results, stepped.as_ref(), name),
            study_file: String::new(),
            study_text: String::new(),
            sha1: BTreeMap::new(),
            generator: format!("aerodeck {}", env!("CARGO_PKG_VERSION")),
            date: Some(today()?),
            study: study.name.clone(),
            deck: deck.description(),
            warnings: [deck.warnings(), sentences(&of_study)].concat(),
            findings: [&deck.findings[..], &of_study[..]].concat(),
            licence: deck.licence(),
            speeds: study.speeds(),
            results: FlutterStudy {
                curves: Vec::new(),
                quasi_steady: None,
                ..results
            },
            fits: trained.into_iter().map(fit).collect(),
            stepped,
            buffeting: None,
            selection: None,
            failed,
            files: Vec::new(),
        })
    }

    /// The response to turbulence in a line, where the study states some. The flutter results are complete by now, and stay what they are.
    fn buffeting(
        &mut self,
        own: Option<&TrainedWithReport>,
        verdict: &Verdict,
    ) -> Result<Option<String>> {
        buffeting::none_of_study(&mut self.out);
        let Some(block) = self.study.buffeting.as_ref().filter(|_| own.is_some()) else {
            return Ok(None);
        };
        let model = self.out.stage(stages::MODEL_FILE)?;
        let (study, out) = (&self.study, &mut self.out);
        let line = buffeting::of_study(study, block, &model, verdict, out, self.progress);
        // also a file that it cannot read takes nothing with it
        let noted = |e| self.failed.push(StageFailure::new("buffeting", e));
        Ok(line.map_err(noted).ok())
    }

    /// Summary and report, then all files in their places.
    fn finish(mut self, mut summary: Summary) -> Result<Answer> {
        self.out.stage(REPORT)?;
        self.out.stage(SUMMARY)?;
        stages::outdate_models(&mut self.out);
        summary.files = self.out.targets();
        summary.files.sort();
        summary.sha1 = report::digests_of_run(self.out.staging())?;
        self.out.write_json(SUMMARY, "summary", &summary)?;
        report::leave(&mut self.out)?;
        let written = self.out.commit()?;
        let verbose = self.progress.verbose;
        let text = text::chain(&self.study, &self.deck, &summary, &written, verbose);
        Ok(Answer::new(text, &summary)?
            .passed_if(summary.failed.is_empty())
            .with_outcome_of(&summary.verdict))
    }
}
