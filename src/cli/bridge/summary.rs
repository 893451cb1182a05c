//! `summary.json` of a bridge, and copies of the files that it was computed from.

use super::text::beside_the_onset;
use crate::bridge::{Bridge, BridgeMode};
use crate::cli::report::folder::{digest, today};
use crate::cli::vocabulary::{BridgeStudy, Error, Finding, OutputDir, Result, Verdict};
use crate::files::bridge::{BridgeFile, ModesFormat};
use crate::files::derivatives::{file_and_sheet, is_table_file};
use crate::flutter::Onset;
use crate::section::Dof;
use crate::study::bridge::BridgeFlutter;
use crate::units::ReducedFrequencyRange;
use serde::{Deserialize, Serialize};
use std::path::{Component, Path, PathBuf};

/// Folder of the copies, laid out as the files lie around the bridge file.
const INPUTS: &str = "inputs";

/// A file that was read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct InputFile {
    /// Where it stands in the folder of results, or else where it was read.
    pub(crate) name: String,
    /// Its fingerprint.
    pub(crate) sha1: String,
}

/// What `summary.json` holds.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct BridgeSummary {
    /// Program and version.
    pub(crate) generator: String,
    /// Day of the run, unless a file of an earlier version says none.
    #[serde(default)]
    pub(crate) date: Option<String>,
    /// Name of the bridge.
    pub(crate) bridge: String,
    /// Text of the bridge file.
    pub(crate) bridge_file: String,
    /// The command that made the results.
    pub(crate) command: String,
    /// What everything found amounts to.
    pub(crate) verdict: Verdict,
    /// What else was found, in words.
    pub(crate) comparisons: Vec<String>,
    /// Number of nodes of the girder.
    pub(crate) nodes: usize,
    /// Length of the girder, m.
    pub(crate) length_m: f64,
    /// Width to which reduced frequencies refer, m.
    pub(crate) width_m: f64,
    /// Where the forces of each section come from.
    pub(crate) sections: Vec<SectionFacts>,
    /// The modes without wind.
    pub(crate) modes: Vec<ModeFacts>,
    /// Files written.
    pub(crate) files: Vec<PathBuf>,
    /// Files that were read, with copies in the folder as far as they lie below the bridge file.
    #[serde(default)]
    pub(crate) inputs: Vec<InputFile>,
    /// What was assumed or looks wrong, in words.
    pub(crate) warnings: Vec<String>,
    /// What is odd about modes, sections and tables.
    pub(crate) findings: Vec<Finding>,
    /// All onsets found, one entry per route.
    pub(crate) onsets: Vec<Onset>,
    /// The full answer.
    pub(crate) flutter: BridgeFlutter,
    /// Parts that failed, in words.
    pub(crate) failed: Vec<String>,
}

/// Where the forces of a section come from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct SectionFacts {
    pub(crate) name: String,
    pub(crate) width_m: f64,
    pub(crate) source: String,
    pub(crate) licence: String,
    /// Reduced frequencies of the tests.
    pub(crate) tested_range: Option<ReducedFrequencyRange>,
}

/// A mode without wind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct ModeFacts {
    pub(crate) mode: usize,
    pub(crate) frequency_hz: f64,
    pub(crate) generalised_mass: f64,
    pub(crate) damping_ratio: f64,
    pub(crate) main_motion: String,
}

impl BridgeSummary {
    /// Of results; what was run and read, and what is written beside it, is for the caller to say.
    pub(super) fn new(
        study: &BridgeStudy,
        results: &BridgeFlutter,
        verdict: &Verdict,
    ) -> Result<Self> {
        Ok(Self {
            generator: format!("aerodeck {}", env!("CARGO_PKG_VERSION")),
            date: Some(today()?),
            bridge: study.file.name.clone(),
            bridge_file: String::new(),
            command: String::new(),
            verdict: verdict.clone(),
            comparisons: beside_the_onset(results),
            nodes: study.by_model.nodes.len(),
            length_m: study.by_model.nodes.iter().map(|n| n.length_m).sum(),
            width_m: study.by_model.width_m(),
            sections: sections(study),
            modes: modes(study),
            files: Vec::new(),
            inputs: Vec::new(),
            warnings: study.warnings(),
            findings: study.findings.clone(),
            onsets: results.onsets().cloned().collect(),
            flutter: results.clone(),
            failed: Vec::new(),
        })
    }
}

fn sections(study: &BridgeStudy) -> Vec<SectionFacts> {
    let both = study.file.sections.iter().zip(&study.sections);
    both.map(|(block, forces)| SectionFacts {
        name: block.name.clone(),
        width_m: block.width_m,
        source: forces.source.clone(),
        licence: forces.licence.clone(),
        tested_range: forces.tested,
    })
    .collect()
}

fn modes(study: &BridgeStudy) -> Vec<ModeFacts> {
    let bridge = &study.by_model;
    let all = bridge.modes.iter();
    all.map(|m| ModeFacts {
        mode: m.number,
        frequency_hz: m.frequency_hz,
        generalised_mass: m.generalised_mass,
        damping_ratio: m.damping_ratio,
        main_motion: main_motion(bridge, m).to_owned(),
    })
    .collect()
}

/// Name of the motion that most of a mode is; `none` where there is none.
pub(super) fn main_motion(bridge: &Bridge, mode: &BridgeMode) -> &'static str {
    let main = bridge.main_motion(mode);
    main.map_or("none", |i| Dof::THREE[i].name())
}

/// Leaves the bridge file `at` and what it reads in the folder of results; a file outside the folder of the bridge file is named
/// with its fingerprint alone, and nothing is copied where results and bridge file share a folder.
pub(super) fn leave_inputs(
    at: &Path,
    file: &BridgeFile,
    out: &mut OutputDir,
) -> Result<Vec<InputFile>> {
    let own = PathBuf::from(at.file_name().unwrap_or_default());
    let same = match (out.target("").canonicalize(), file.directory.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => false,
    };
    let mut read = vec![own];
    read.extend(named(file)?);
    let mut inputs = Vec::with_capacity(read.len());
    for path in read {
        let from = file.directory.join(&path);
        let bytes = std::fs::read(&from).map_err(|e| Error::io(&from, e))?;
        let below = path.components().all(|c| matches!(c, Component::Normal(_)));
        let sha1 = digest(&bytes);
        let name = match below && !same {
            true => Path::new(INPUTS).join(&path),
            false => path,
        };
        if below && !same {
            out.write(&name, bytes)?;
        }
        let name = name.to_string_lossy().replace('\\', "/");
        inputs.push(InputFile { name, sha1 });
    }
    Ok(inputs)
}

/// The accounts of the fit of a model, from which its interval follows: in `fits/` beside it, or beside its folder.
fn accounts(directory: &Path, model: &Path) -> Vec<PathBuf> {
    let stem = model.file_stem().unwrap_or_default().to_string_lossy();
    let folders = model.ancestors().skip(1).take(2).map(|f| f.join("fits"));
    let names = [".json", ".uncertainty.json"].map(|ending| format!("{stem}{ending}"));
    let all = folders.flat_map(|f| names.clone().map(|name| f.join(name)));
    all.filter(|path| directory.join(path).is_file()).collect()
}

/// Files of modes, tables and models, as the bridge file names them.
pub(super) fn named(file: &BridgeFile) -> Result<Vec<PathBuf>> {
    let mut all = Vec::new();
    if file.modes.format != ModesFormat::Embedded {
        all.push(file.modes.path.clone());
    }
    for section in &file.sections {
        let table = section.derivatives.iter();
        let table = table.filter(|name| is_table_file(name));
        all.extend(table.map(|name| PathBuf::from(file_and_sheet(name.trim()).0)));
        if let Some(model) = &section.model {
            all.push(model.clone());
            all.extend(accounts(&file.directory, model));
        }
    }
    let mut files = Vec::new();
    for path in all {
        let at = file.directory.join(&path);
        if !at.is_dir() {
            files.push(path);
            continue;
        }
        for entry in std::fs::read_dir(&at).map_err(|e| Error::io(&at, e))? {
            let entry = entry.map_err(|e| Error::io(&at, e))?;
            if entry.path().is_file() {
                files.push(path.join(entry.file_name()));
            }
        }
    }
    files.sort();
    files.dedup();
    Ok(files)
}
