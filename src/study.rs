//! A study: one TOML file that says which deck, which section, which models, and what to do with them.
//!
//! Every stage of the chain is a function from values to values, so that each command of the program, the demo and a
//! script of somebody else run the same code.

pub mod bridge;
mod deck;
mod defaults;
mod evidence;
mod failures;
mod intervals;
mod models;
mod onsets;
mod plausibility;
mod processed;
mod records;
mod reference_lines;
mod routes;
mod speeds;
mod stepped;
mod wind;

pub use deck::Deck;
pub use defaults::demo_study_text;
pub(crate) use defaults::{new_study_text, thesis_study_text};
pub(crate) use evidence::{saved_evidence, section_evidence};
pub(crate) use failures::{attempt, is_of_a_file};
pub(crate) use intervals::{
    FITS, UNCERTAINTY, interval_of, saved_moved_onset, saved_uncertainty, state_intervals,
    state_route_intervals,
};
pub use intervals::{KnownUncertainty, uncertainty_beside};
pub use models::{TrainedWithReport, train_one};
pub use onsets::{Deviation, FlutterStudy, OnsetSummary, flutter_study};
pub(crate) use plausibility::study_findings;
pub(crate) use processed::{processed_study_text, read_section};
pub use records::RecordSet;
pub(crate) use reference_lines::derivative_lines;
pub(crate) use routes::{Route, RouteTable, route_table};
pub use speeds::{FlutterBlock, SpeedRange};
pub use stepped::{SteppedOnset, stepped_onset};
pub(crate) use wind::{
    BuffetingStudy, QuasiSteadyStudy, SimulatedMotion, WindStudy, buffeting_study,
    quasi_steady_study, simulated_motion,
};
pub use wind::{CoefficientsBlock, SectionBuffetingBlock, example_wind_study_text};

use crate::aerodynamics::derivatives::{Interpolation, Missing};
use crate::error::{Error, Place, Result, ensure, finite, of_schema, positive};
use crate::files::derivatives::StatedConvention;
use crate::files::report_block::ReportBlock;
use crate::files::toml_lines;
use crate::identification::{DiscreteFit, FrequencyFit, TimeFit};
use crate::section::SectionModel;
use crate::trained_model::Experiment;
use crate::wind_tunnel::TunnelPlan;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Version of the study file.
pub(crate) const STUDY_SCHEMA: u32 = 1;
/// Wind speed of the default experiment over the onset at most.
const MOST_OF_ONSET: f64 = 2.0;

/// Contents of a study file.
///
/// ```
/// use aerodeck::prelude::*;
/// use aerodeck::study::demo_study_text;
///
/// let study = Study::from_toml(demo_study_text(), "".into())?;
/// assert_eq!(study.models.len(), 3);
/// let wrong = demo_study_text().replace("speeds = 120", "speeds = -1");
/// assert!(Study::from_toml(&wrong, "".into()).unwrap_err().to_string().contains("line"));
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Study {
    /// `STUDY_SCHEMA`.
    pub schema: u32,
    /// Name of the study.
    pub name: String,
    /// The suspended section.
    pub section: SectionModel,
    /// Where the aerodynamics come from.
    pub deck: DeckSource,
    /// Virtual wind tunnel; not used when the deck states records of its own.
    #[serde(default)]
    pub tunnel: TunnelPlan,
    /// Whether the model that `aerodeck select` recommends is trained first, under the name `selected`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub select: bool,
    /// The models to train.
    #[serde(rename = "model")]
    pub models: Vec<ModelBlock>,
    /// Where to look for the onset.
    #[serde(default)]
    pub flutter: FlutterBlock,
    /// Static coefficients, for quasi-steady theory beside the other routes to the onset.
    pub coefficients: Option<CoefficientsBlock>,
    /// Turbulence, and the response of the section to it.
    pub buffeting: Option<SectionBuffetingBlock>,
    /// What to export.
    #[serde(default)]
    pub export: ExportBlock,
    /// Whose report it is.
    #[serde(default, skip_serializing_if = "ReportBlock::is_empty")]
    pub report: ReportBlock,
    /// Directory of the file, against which paths in it are read.
    #[serde(skip)]
    pub directory: PathBuf,
}

/// Source of the aerodynamics.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeckSource {
    /// Name of an embedded deck, `flat plate`, or the path of a derivative table (`.csv`, `.xlsx`, `.xls`, `.ods`; `table.xlsx#SHEET`).
    pub source: String,
    /// Notation, argument and axes of the table; a CSV file states them itself and must not be contradicted.
    #[serde(default, skip_serializing_if = "StatedConvention::is_empty")]
    pub convention: StatedConvention,
    /// How the table is read between its points.
    #[serde(default, skip_serializing_if = "is_default")]
    pub interpolation: Interpolation,
    /// Width of the section model, m, for a table that does not state it.
    pub width_m: Option<f64>,
    /// Mean angle of the section in the tests, deg, nose-up positive, for a table that does not state it; left out, 0.
    pub angle_deg: Option<f64>,
    /// What stands for H4*, A4* in a table without them: `zero` (as when nothing is stated, with a warning) or
    /// `quasi_steady`.
    pub missing: Option<Missing>,
    /// Mean speeds of the table to be used, numbered from 1 for the lowest; left out, all.
    pub speed_groups: Option<Vec<usize>>,
    /// Measured records (`.csv`) to be used instead of the virtual tunnel.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub records: Vec<PathBuf>,
}

/// Whether a key may be left out of a written study.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// One model and how it is fitted: exactly one of `records`, `table`, `discrete`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelBlock {
    /// Name in tables and figures.
    pub name: String,
    /// Mean speeds used for this model, numbered from 1 for the lowest; left out, all of the deck.
    pub speed_groups: Option<Vec<usize>>,
    /// Continuous model fitted to records in the time domain.
    pub records: Option<TimeFit>,
    /// Continuous model fitted to the derivatives in the frequency domain.
    pub table: Option<FrequencyFit>,
    /// The thesis's discrete Laguerre model, fitted to records.
    pub discrete: Option<DiscreteFit>,
}

/// Which model goes into the FMU, and its default experiment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ExportBlock {
    /// Name of the model; left out, the first.
    pub model: Option<String>,
    /// Wind speed of the default experiment as a part of the onset speed.
    pub part_of_onset: f64,
    /// Release from this vertical displacement, m.
    pub initial_vertical_m: f64,
    /// Release from this rotation, deg.
    pub initial_rotation_deg: f64,
    /// Length of the run, s.
    pub stop_time_s: f64,
    /// Communication step, s.
    pub step_size_s: f64,
    /// Who is responsible for the FMU.
    pub author: Option<String>,
    /// Whose it is.
    pub copyright: Option<String>,
}

impl ExportBlock {
    /// A released section just below the onset or what else [comes first](crate::flutter::FlutterSearch::first_limit_m_s), so that
    /// an importer that merely runs the FMU sees something; the FMU searches its onset up to `limit_m_s`.
    pub fn experiment(&self, first_m_s: f64, limit_m_s: f64) -> Experiment {
        // a round number of decimetres per second reads better in an importer
        let part = self.part_of_onset * first_m_s;
        let speed = (10.0 * self.part_of_onset * first_m_s).floor() / 10.0;
        Experiment {
            wind_speed_m_s: if speed > 0.0 { speed } else { part },
            initial_vertical_m: self.initial_vertical_m,
            initial_rotation_rad: self.initial_rotation_deg.to_radians(),
            stop_time_s: self.stop_time_s,
            step_size_s: self.step_size_s,
            onset_search_limit_m_s: limit_m_s,
        }
    }
}

impl Default for ExportBlock {
    fn default() -> Self {
        Self {
            model: None,
            part_of_onset: 0.98,
            initial_vertical_m: 0.01,
            initial_rotation_deg: 1.0,
            stop_time_s: 10.0,
            step_size_s: 0.01,
            author: None,
            copyright: None,
        }
    }
}

impl Study {
    /// Reads and checks a study file.
    ///
    /// # Errors
    /// [`Error::Io`] when it cannot be read; [`Error::Input`] with file and line for everything that is wrong in it.
    pub fn read(path: &Path) -> Result<Self> {
        toml_lines::read(path, Self::from_toml)
    }

    /// Reads and checks the text of a study file; paths in it are read against `directory`.
    ///
    /// # Errors
    /// [`Error::Input`] with line and key for everything that is wrong in it.
    pub fn from_toml(text: &str, directory: PathBuf) -> Result<Self> {
        require_section(text)?;
        toml_lines::only_blocks(text)?;
        toml_lines::parse("a study file", text, |study: &mut Self| {
            study.directory = directory;
            study.validate()
        })
    }

    fn validate(&self) -> Result<()> {
        of_schema(STUDY_SCHEMA, self.schema)?;
        self.section.structure()?;
        let named = !self.name.trim().is_empty();
        ensure(named, "name", "a name", "an empty one")?;
        self.tunnel.validate().map_err(|e| e.within("tunnel"))?;
        if self.models.is_empty() {
            return Err(Error::input("model", "at least one [[model]]", "none"));
        }
        for (i, model) in self.models.iter().enumerate() {
            model.validate(&format!("model[{i}]"))?;
            let alone = self.models[..i].iter().all(|m| m.slug() != model.slug());
            let expected = "a name of its own for every model";
            let found = format_args!("`{}` a second time", model.name);
            ensure(alone, format!("model[{i}].name"), expected, found)?;
        }
        self.flutter.validate("flutter")?;
        if let Some(block) = &self.coefficients {
            block.validate("coefficients")?;
        }
        if let Some(block) = &self.buffeting {
            block.validate("buffeting")?;
        }
        self.export.validate()?;
        self.exported().map(|_| ())
    }

    /// Wind speeds of curves, searches, Monte Carlo analysis and FMU.
    pub(crate) fn speeds(&self) -> SpeedRange {
        self.flutter.range(&self.section)
    }

    /// The model that goes into the FMU.
    ///
    /// # Errors
    /// [`Error::Input`] when `export.model` names none of the models.
    pub(crate) fn exported(&self) -> Result<&ModelBlock> {
        let Some(name) = &self.export.model else {
            let none = || Error::input("model", "at least one [[model]]", "none");
            return self.models.first().ok_or_else(none);
        };
        self.models.iter().find(|m| m.name == *name).ok_or_else(|| {
            let names: Vec<_> = self.models.iter().map(|m| m.name.as_str()).collect();
            let expected = format!("one of {}", names.join(", "));
            Error::input("export.model", expected, format!("`{name}`"))
        })
    }
}

/// Refuses a file whose section is still to be stated, as `process` leaves it.
fn require_section(text: &str) -> Result<()> {
    let stated = text.parse::<toml::Table>().map_or(true, |values| {
        values.contains_key("section") || !values.contains_key("deck")
    });
    if stated {
        return Ok(());
    }
    Err(Error::input(
        "section",
        "a [section] with width_m, air_density_kg_m3, vertical and torsion: the structure that is to be built, which no \
         campaign or table knows",
        "none",
    ))
}

/// The name of a model as part of a file name.
pub(crate) fn slug(name: &str) -> String {
    let mut slug = String::new();
    for c in name.chars() {
        if c.is_alphanumeric() {
            slug.extend(c.to_lowercase());
        } else if !slug.ends_with('_') && !slug.is_empty() {
            slug.push('_');
        }
    }
    slug.trim_end_matches('_').to_owned()
}

impl ModelBlock {
    /// The name as part of a file name.
    pub(crate) fn slug(&self) -> String {
        slug(&self.name)
    }

    fn validate(&self, place: &str) -> Result<()> {
        let expected = "a name with letters or digits";
        let (named, found) = (!self.slug().is_empty(), format_args!("`{}`", self.name));
        ensure(named, format!("{place}.name"), expected, found)?;
        let below = |key: &str, result: Result<()>| {
            result.map_err(|e| e.within(Place::from(place).key(key)))
        };
        match (&self.records, &self.table, &self.discrete) {
            (Some(fit), None, None) => below("records", fit.validate()),
            (None, Some(fit), None) => below("table", fit.validate()),
            (None, None, Some(fit)) => below("discrete", fit.validate()),
            _ => Err(Error::input(
                place,
                "exactly one of `records`, `table`, `discrete`",
                "none or several",
            )),
        }
    }
}

impl ExportBlock {
    fn validate(&self) -> Result<()> {
        positive("export.part_of_onset", self.part_of_onset)?;
        let expected = format_args!("at most {MOST_OF_ONSET}: 1 is the onset");
        let (place, part) = ("export.part_of_onset", self.part_of_onset);
        ensure(part <= MOST_OF_ONSET, place, expected, part)?;
        positive("export.stop_time_s", self.stop_time_s)?;
        positive("export.step_size_s", self.step_size_s)?;
        let expected = format_args!("at most stop_time_s ({} s)", self.stop_time_s);
        let fits = self.step_size_s <= self.stop_time_s;
        ensure(fits, "export.step_size_s", expected, self.step_size_s)?;
        finite("export.initial_vertical_m", self.initial_vertical_m)?;
        finite("export.initial_rotation_deg", self.initial_rotation_deg)?;
        Ok(())
    }
}
