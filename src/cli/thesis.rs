//! `aerodeck thesis`: the headline of the source document, repeated.

use super::answer::Answer;
use super::interrupt::Temporary;
use super::output::{OutputDir, list};
use super::progress::Progress;
use super::thesis_page::thesis_page;
use super::{headline, result_files, stages, text};
use crate::error::{Error, Result};
use crate::report::rendered;
use crate::study::{Deck, RecordSet, Study, thesis_study_text};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Onset printed in the thesis (Figures 4.2 and 4.3) for both models, m/s.
const PRINTED_M_S: f64 = 37.6;

/// Runs the command, which writes its page into the folder `left_in`.
pub(crate) fn run(left_in: Option<&Path>, progress: &Progress) -> Result<Answer> {
    let aside = tempfile::tempdir().map_err(|e| Error::io(std::env::temp_dir(), e))?;
    let aside = Temporary::new(aside.keep());
    let study = Study::from_toml(thesis_study_text(), PathBuf::new())?;
    let deck = Deck::load(&study)?;
    let mut out = OutputDir::new(aside.path())?;
    let records = RecordSet::in_memory(stages::tunnel(&study, &deck, &mut out, progress)?);
    let mut failed = Vec::new();
    let trained = stages::train(
        &study,
        &deck,
        Some(&records),
        &mut out,
        &mut failed,
        progress,
    )?;
    let results = stages::flutter_of(&study, &deck, &trained, &mut failed, progress)?;
    let mut text = format!("{}\n\n", study.name);
    for result in &trained {
        text.push_str(&text::fit_of(result));
    }
    text.push('\n');
    text.push_str(&text::onsets(&results));
    text.push_str(&text::deviations(&results));
    text.push_str(&text::failures(&failed));
    let _ = writeln!(text, "thesis: {PRINTED_M_S} m/s for both models");
    if let Some(folder) = left_in {
        result_files::flutter_figure(&study, &results, None, &mut out)?;
        result_files::write_curves(&study, &results.curves, &mut out)?;
        if let Some(own) = trained.first()
            && let Some(onset) = headline::own_onset(&results, &own.model.name)
        {
            result_files::write_response(&own.model, &onset.at, &mut out)?;
        }
        let page = thesis_page(
            &results,
            PRINTED_M_S,
            &records.select(Some(&[1]))?,
            &out,
            progress,
        )?;
        let mut left = OutputDir::new(folder)?;
        left.write("thesis.html", rendered(&page)?)?;
        text.push_str(&list(&left.commit()?));
    }
    let answer = Answer::new(
        text,
        &serde_json::json!({ "printed_m_s": PRINTED_M_S, "flutter": results, "failed": failed }),
    )?;
    Ok(answer.passed_if(failed.is_empty()))
}
