//! What is saved after training: section, model, tested range, provenance, as JSON with a schema version.

use crate::aerodynamics::{
    DiscreteLaguerre, Lags, LaguerreModel, MinimumStateModel, RationalModel, Realizable,
    Realization, Transfer, TransferMatrix,
};
use crate::error::{Error, Result, ensure, finite, positive, without_control_characters};
use crate::json;
use crate::section::{Dof, SectionModel};
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Version of the file layout of models that need nothing newer, so that programs of that version read them; raised when
/// a field of all files is added or changed.
pub const SCHEMA_VERSION: u32 = 1;
/// Newest version that is read and written. Version 2: discrete Laguerre filters of single transfer functions, rational
/// functions with lags of each force, minimum-state form.
pub const NEWEST_SCHEMA_VERSION: u32 = 2;

/// What the files of models say they are.
const KIND: &str = "model";

/// States of a realisation at most, a hundred times those of any model that was ever fitted: its matrices are full.
const MAX_STATES: usize = 1000;

/// The models that can be saved and exported.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::RationalModel;
/// use aerodeck::trained_model::Model;
///
/// let model = Model::Rational(RationalModel::jones_flat_plate());
/// assert_eq!(model.kind(), "rational functions");
/// assert_eq!(model.schema_version(), 1);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Model {
    /// Continuous Laguerre or Takenaka–Malmquist filters with feed-through.
    Laguerre(LaguerreModel),
    /// The thesis's discrete Laguerre model.
    DiscreteLaguerre(DiscreteLaguerre),
    /// Rational functions in Roger's form.
    Rational(RationalModel),
    /// Rational functions in Karpel's minimum-state form.
    MinimumState(MinimumStateModel),
}

impl Model {
    /// The kind in words.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Laguerre(_) => "continuous Laguerre",
            Self::DiscreteLaguerre(_) => "discrete Laguerre",
            Self::Rational(_) => "rational functions",
            Self::MinimumState(_) => "minimum-state rational functions",
        }
    }

    /// Lowest version of the file layout that can hold the model.
    pub fn schema_version(&self) -> u32 {
        match self {
            Self::Rational(m) if matches!(m.lags, Lags::PerForce(_)) => NEWEST_SCHEMA_VERSION,
            Self::MinimumState(_) => NEWEST_SCHEMA_VERSION,
            Self::DiscreteLaguerre(m) if m.shared_parameters().is_none() => NEWEST_SCHEMA_VERSION,
            _ => SCHEMA_VERSION,
        }
    }

    fn inner(&self) -> &dyn Realizable {
        match self {
            Self::Laguerre(m) => m,
            Self::DiscreteLaguerre(m) => m,
            Self::Rational(m) => m,
            Self::MinimumState(m) => m,
        }
    }

    /// Number of states of the realisation at most, without making it.
    fn states_at_most(&self) -> usize {
        match self {
            Self::Laguerre(m) => m.terms.iter().map(|t| t.poles.count()).sum(),
            Self::DiscreteLaguerre(m) => m.terms.iter().map(|t| t.coefficients.ncols()).sum(),
            Self::Rational(m) => {
                let lags = match &m.lags {
                    Lags::Shared(lags) => lags.len(),
                    Lags::PerForce(rows) => rows.iter().map(Vec::len).sum(),
                };
                lags.saturating_mul(m.dofs.len())
            }
            Self::MinimumState(m) => m.lags.len(),
        }
    }

    /// Checks shapes and values, and that it has not more states than can be computed with.
    ///
    /// # Errors
    /// [`Error::Input`] with what is wrong.
    pub fn validate(&self) -> Result<()> {
        let states = self.states_at_most();
        ensure(
            states <= MAX_STATES,
            "model",
            format_args!("filters or lags of at most {MAX_STATES} states"),
            states,
        )?;
        match self {
            Self::Laguerre(m) => m.validate(),
            Self::DiscreteLaguerre(m) => m.validate(),
            Self::Rational(m) => m.validate(),
            Self::MinimumState(m) => m.validate(),
        }
    }
}

impl Transfer for Model {
    fn dofs(&self) -> &[Dof] {
        self.inner().dofs()
    }
    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        self.inner().transfer(k)
    }
    fn realizable(&self) -> Option<&dyn Realizable> {
        Some(self)
    }
}

impl Realizable for Model {
    fn realize(&self) -> Realization {
        self.inner().realize()
    }
}

/// Where a model comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// The data: deck, laboratory, publication.
    pub source: String,
    /// Licence of the data.
    pub licence: String,
    /// How the model was fitted, in words.
    pub method: String,
    /// Version of this program that fitted it.
    pub aerodeck_version: String,
    /// Remarks of the fit that a user of the model must know (bias, conditioning, range).
    #[serde(default)]
    pub notes: Vec<String>,
}

/// What an exported section does when an importer just runs it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Experiment {
    /// Start value of the wind speed, m/s.
    pub wind_speed_m_s: f64,
    /// Release from this vertical displacement, m.
    pub initial_vertical_m: f64,
    /// Release from this rotation, rad.
    pub initial_rotation_rad: f64,
    /// Length of the run, s.
    pub stop_time_s: f64,
    /// Communication step, s.
    pub step_size_s: f64,
    /// Onset and divergence are searched up to this wind speed, m/s.
    pub onset_search_limit_m_s: f64,
}

/// A trained model with the section it is coupled with, as `model.json` holds it.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::trained_model::TrainedModel;
///
/// let refused = TrainedModel::from_json("{ \"schema_version\": 99 }").unwrap_err();
/// assert_eq!(refused.to_string(), "schema_version: expected 1 to 2, found 99");
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainedModel {
    /// Version of the file layout, at least `Model::schema_version`.
    pub schema_version: u32,
    /// Name of the deck or study.
    pub name: String,
    /// The suspended section.
    pub section: SectionModel,
    /// The force model.
    pub model: Model,
    /// Reduced frequencies `K = ωB/V` at which every force was measured in every motion.
    pub tested_range: ReducedFrequencyRange,
    /// Where it comes from.
    pub provenance: Provenance,
    /// Default experiment of the exported section.
    pub experiment: Experiment,
}

impl TrainedModel {
    /// Reads and checks the file of a model.
    ///
    /// # Errors
    /// [`Error::Io`] when it cannot be read; [`Error::Input`] with file, line and column.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|e| Error::io(path, e))?;
        Self::from_json(&text).map_err(|e| e.in_file(path))
    }

    /// Reads and checks a model.
    ///
    /// # Errors
    /// [`Error::Input`] with line and column for text that is not such a file, and for every value that cannot be.
    pub fn from_json(text: &str) -> Result<Self> {
        let version: SchemaOnly = json::read(KIND, text).map_err(|e| json_error(&e))?;
        ensure(
            (SCHEMA_VERSION..=NEWEST_SCHEMA_VERSION).contains(&version.schema_version),
            "schema_version",
            format_args!("{SCHEMA_VERSION} to {NEWEST_SCHEMA_VERSION}"),
            version.schema_version,
        )?;
        let model: Self = json::read(KIND, text).map_err(|e| json_error(&e))?;
        model.validate()?;
        Ok(model)
    }

    /// Writes the model as indented JSON; numbers survive the round trip bit for bit.
    ///
    /// # Errors
    /// [`Error::Input`] when the model could not be read back.
    pub fn to_json(&self) -> Result<String> {
        self.validate()?;
        json::write(KIND, self)
    }

    /// Checks every value.
    pub fn validate(&self) -> Result<()> {
        let from = &self.provenance;
        let texts = [
            ("name", &self.name),
            ("provenance.source", &from.source),
            ("provenance.licence", &from.licence),
            ("provenance.method", &from.method),
        ];
        let notes = from.notes.iter().map(|note| ("provenance.notes", note));
        for (key, text) in texts.into_iter().chain(notes) {
            without_control_characters(key, text)?;
        }
        ensure(!self.name.trim().is_empty(), "name", "a name", "none")?;
        self.section.structure()?;
        self.model.validate()?;
        ensure(
            self.schema_version >= self.model.schema_version(),
            "schema_version",
            format_args!("at least {} for this model", self.model.schema_version()),
            self.schema_version,
        )?;
        let own = self.section.dofs();
        ensure(
            self.model.dofs() == own,
            "model.dofs",
            format_args!("the section's degrees of freedom {}", Dof::names(&own)),
            Dof::names(self.model.dofs()),
        )?;
        positive("tested_range.min", self.tested_range.min.full_width())?;
        ensure(
            self.tested_range.max >= self.tested_range.min
                && self.tested_range.max.full_width().is_finite(),
            "tested_range.max",
            "a finite number not below tested_range.min",
            self.tested_range.max.full_width(),
        )?;
        self.experiment.validate()
    }
}

impl Experiment {
    fn validate(&self) -> Result<()> {
        positive("experiment.wind_speed_m_s", self.wind_speed_m_s)?;
        positive("experiment.stop_time_s", self.stop_time_s)?;
        let step_size_s = positive("experiment.step_size_s", self.step_size_s)?;
        ensure(
            step_size_s <= self.stop_time_s,
            "experiment.step_size_s",
            format_args!("at most experiment.stop_time_s, {} s", self.stop_time_s),
            step_size_s,
        )?;
        let limit = self.onset_search_limit_m_s;
        positive("experiment.onset_search_limit_m_s", limit)?;
        finite("experiment.initial_vertical_m", self.initial_vertical_m)?;
        finite("experiment.initial_rotation_rad", self.initial_rotation_rad).map(drop)
    }
}

#[derive(Deserialize)]
struct SchemaOnly {
    schema_version: u32,
}

fn json_error(e: &serde_json::Error) -> Error {
    Error::json("a trained model as written by `aerodeck train`", e)
}

#[cfg(test)]
mod tests;
