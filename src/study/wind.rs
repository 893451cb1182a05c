//! The wind file: section, aerodynamics and turbulence for quasi-steady theory and buffeting.

mod arms;
mod buffeting;
mod quasi_steady;

pub(crate) use buffeting::{BuffetingStudy, buffeting_study};
pub(crate) use quasi_steady::{
    QuasiSteadyStudy, SimulatedMotion, quasi_steady_study, simulated_motion,
};

use super::{FlutterBlock, SpeedRange, Study, is_default};
use crate::aerodynamics::derivatives::{Extrapolation, InterpolatedTable, Interpolation};
use crate::aerodynamics::quasi_steady::{Arms, QuasiSteady, StaticCoefficients};
use crate::buffeting::{TimePlan, Turbulence, check_plan};
use crate::error::{Error, Result, ensure, finite, of_schema, positive};
use crate::files::coefficients::named_coefficients;
use crate::files::derivatives::{StatedConvention, named_table};
use crate::files::toml_lines;
use crate::plausibility::{Finding, of_coefficients, of_section};
use crate::section::{Dof, SectionModel};
use crate::trained_model::TrainedModel;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Version of the wind file.
const WIND_SCHEMA: u32 = 1;

/// Text of the example: a box girder of made-up coefficients in turbulent wind.
pub fn example_wind_study_text() -> &'static str {
    include_str!("wind/example.toml")
}

/// Contents of a wind file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct WindStudy {
    /// Version of the file, 1.
    pub schema: u32,
    /// Name in titles.
    pub name: String,
    /// The suspended section; may be left out with a trained model, which has its own.
    pub section: Option<SectionModel>,
    /// Static coefficients, for quasi-steady theory and for gust forces.
    pub coefficients: Option<CoefficientsBlock>,
    /// Self-excited forces in turbulence: `quasi-steady`, `flat plate`, `flat plate (Jones)`, a trained model (`.json`), an
    /// embedded deck or a table of derivatives (`.csv`, `.xlsx`).
    #[serde(default = "quasi_steady_forces")]
    pub aerodynamics: String,
    /// Notation, argument and axes of such a table, as far as it does not state them itself.
    #[serde(default)]
    pub convention: StatedConvention,
    /// How such a table is read between its points.
    #[serde(default)]
    pub interpolation: Interpolation,
    /// Wind speeds of all curves and of the search for the onset.
    #[serde(default)]
    pub speeds: FlutterBlock,
    /// The turbulence.
    pub turbulence: Option<Turbulence>,
    /// Wind speeds at which the response is computed in the time domain as well.
    #[serde(default)]
    pub time: TimeBlock,
    /// A run with nonlinear forces.
    pub simulation: Option<SimulationBlock>,
    /// Directory of the file, against which paths in it are read.
    #[serde(skip)]
    pub directory: PathBuf,
}

fn quasi_steady_forces() -> String {
    QUASI_STEADY.to_owned()
}

const QUASI_STEADY: &str = "quasi-steady";

/// Static coefficients and the arms of the corrected theory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoefficientsBlock {
    /// Name of an embedded table, or the path of one (`.csv`).
    pub source: String,
    /// `B₁/B` of each force; left out, none.
    pub arms: Option<Arms>,
    /// Derivatives from which the arms follow at their highest reduced velocity (1.18): an embedded deck or a table.
    pub arms_from: Option<String>,
}

/// The turbulence of a study, on its section in the forces of its exported model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SectionBuffetingBlock {
    /// Mean wind speeds, m/s; left out, those of the curves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub speeds_m_s: Vec<f64>,
    /// The gusts and their admittances.
    pub turbulence: Turbulence,
    /// Wind speeds at which the response is computed in the time domain as well.
    #[serde(default, skip_serializing_if = "is_default")]
    pub(crate) time: TimeBlock,
}

impl SectionBuffetingBlock {
    /// Checks every value; `place` is the key of the block.
    pub(in crate::study) fn validate(&self, place: &str) -> Result<()> {
        self.turbulence.validate(&format!("{place}.turbulence"))?;
        all_positive(&format!("{place}.speeds_m_s"), &self.speeds_m_s)?;
        self.time.validate(&format!("{place}.time"))
    }
}

fn all_positive(place: &str, values: &[f64]) -> Result<()> {
    for (i, value) in values.iter().enumerate() {
        positive(format!("{place}[{i}]"), *value)?;
    }
    Ok(())
}

/// What is stepped in the time domain.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct TimeBlock {
    /// Mean wind speeds, m/s; none by default.
    pub speeds_m_s: Vec<f64>,
    /// Records at each.
    pub plan: TimePlan,
}

impl TimeBlock {
    fn validate(&self, place: &str) -> Result<()> {
        all_positive(&format!("{place}.speeds_m_s"), &self.speeds_m_s)?;
        let TimePlan {
            records,
            duration_s,
            step_s,
            ..
        } = self.plan;
        check_plan(&format!("{place}.plan"), records, duration_s, step_s)
    }
}

/// A run with nonlinear quasi-steady forces, released from the static equilibrium.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SimulationBlock {
    /// Mean wind speed, m/s.
    pub wind_speed_m_s: f64,
    /// Length of the run, s.
    pub duration_s: f64,
    /// Time between rows of the result, s.
    pub step_s: f64,
    /// Gusts (`.csv`); left out, they are generated from the turbulence, or there are none.
    pub gusts: Option<PathBuf>,
    /// Seed of generated gusts.
    #[serde(default = "first_seed")]
    pub seed: u64,
    /// Release from this vertical displacement off the equilibrium, m.
    #[serde(default)]
    pub initial_vertical_m: f64,
    /// Release from this rotation off the equilibrium, deg.
    #[serde(default)]
    pub initial_rotation_deg: f64,
}

fn first_seed() -> u64 {
    1
}

impl WindStudy {
    /// Reads and checks a wind file.
    ///
    /// # Errors
    /// [`Error::Io`] when it cannot be read; [`Error::Input`] with file and line for everything that is wrong in it.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        toml_lines::read(path, Self::from_toml)
    }

    /// Reads and checks the text of a wind file; paths in it are read against `directory`.
    pub(crate) fn from_toml(text: &str, directory: PathBuf) -> Result<Self> {
        toml_lines::only_blocks(text)?;
        toml_lines::parse("a wind file", text, |study: &mut Self| {
            study.directory = directory;
            study.validate()
        })
    }

    fn validate(&self) -> Result<()> {
        of_schema(WIND_SCHEMA, self.schema)?;
        if let Some(section) = &self.section {
            section.structure()?;
        }
        self.speeds.validate("speeds")?;
        if let Some(turbulence) = &self.turbulence {
            turbulence.validate("turbulence")?;
        }
        self.time.validate("time")?;
        if let Some(block) = &self.coefficients {
            block.validate("coefficients")?;
        }
        if let Some(run) = &self.simulation {
            positive("simulation.wind_speed_m_s", run.wind_speed_m_s)?;
            positive("simulation.duration_s", run.duration_s)?;
            positive("simulation.step_s", run.step_s)?;
            finite("simulation.initial_vertical_m", run.initial_vertical_m)?;
            finite("simulation.initial_rotation_deg", run.initial_rotation_deg)?;
        }
        Ok(())
    }

    /// The turbulence of a study as a wind file states it; `model` is the file of the exported model.
    pub(crate) fn of_study(study: &Study, block: &SectionBuffetingBlock, model: &Path) -> Self {
        Self {
            schema: WIND_SCHEMA,
            name: study.name.clone(),
            section: Some(study.section.clone()),
            coefficients: study.coefficients.clone(),
            aerodynamics: model.to_string_lossy().into_owned(),
            convention: StatedConvention::default(),
            interpolation: Interpolation::default(),
            speeds: study.flutter,
            turbulence: Some(block.turbulence),
            time: block.time.clone(),
            simulation: None,
            directory: study.directory.clone(),
        }
    }

    /// The trained model of `aerodynamics`, when it names one.
    pub(crate) fn trained_model(&self) -> Result<Option<TrainedModel>> {
        if !self.aerodynamics.ends_with(".json") {
            return Ok(None);
        }
        TrainedModel::read(&self.directory.join(&self.aerodynamics)).map(Some)
    }

    /// What is odd about section and coefficients.
    pub(crate) fn findings(&self) -> Vec<Finding> {
        let Ok(section) = self.section() else {
            return Vec::new();
        };
        let mut found = of_section(&section);
        if let Some(block) = &self.coefficients {
            found.extend(block.findings(&self.directory, &section.dofs()));
        }
        found
    }

    /// The section: that of the file, else that of the trained model.
    pub(crate) fn section(&self) -> Result<SectionModel> {
        if let Some(section) = &self.section {
            return Ok(section.clone());
        }
        let model = self.trained_model()?;
        model.map(|m| m.section).ok_or_else(|| {
            let expected = "a [section], or a trained model that has one";
            Error::input("section", expected, "neither")
        })
    }

    /// Wind speeds of all curves and of the search for the onset.
    pub(crate) fn speed_range(&self) -> Result<SpeedRange> {
        Ok(self.speeds.range(&self.section()?))
    }

    /// The table of static coefficients.
    pub(crate) fn static_coefficients(&self) -> Result<StaticCoefficients> {
        named_coefficients(&self.coefficients_block()?.source, &self.directory)
    }

    fn coefficients_block(&self) -> Result<&CoefficientsBlock> {
        self.coefficients
            .as_ref()
            .ok_or_else(|| Error::input("coefficients", "a table of static coefficients", "none"))
    }

    /// Quasi-steady theory with its arms.
    pub(crate) fn quasi_steady(&self) -> Result<QuasiSteady> {
        let dofs = self.section()?.dofs();
        self.coefficients_block()?.theory(&self.directory, &dofs)
    }
}

impl CoefficientsBlock {
    /// Quasi-steady theory with its arms for these degrees of freedom; paths are read against `directory`.
    pub(crate) fn theory(&self, directory: &Path, dofs: &[Dof]) -> Result<QuasiSteady> {
        let arms = match (&self.arms, &self.arms_from) {
            (Some(arms), _) => *arms,
            (None, Some(source)) => {
                let table = named_table(source, directory)?;
                let model = InterpolatedTable::new(&table, dofs, Extrapolation::Refuse)?;
                arms::arms_of(&model, model.tested_range().min)?
            }
            (None, None) => Arms::default(),
        };
        QuasiSteady::new(named_coefficients(&self.source, directory)?, arms, dofs)
    }

    /// What is odd about the coefficients at no rotation, or the angle of the table next to it; of a table that cannot be read the
    /// computation says so.
    pub(in crate::study) fn findings(&self, directory: &Path, dofs: &[Dof]) -> Vec<Finding> {
        let Ok(theory) = self.theory(directory, dofs) else {
            return Vec::new();
        };
        let (low, high) = theory.coefficients().range_rad();
        let at = theory.coefficients().at(0.0_f64.clamp(low, high));
        let arms = self.arms.unwrap_or_default();
        at.map_or_else(
            |_| Vec::new(),
            |at| of_coefficients("coefficients.", &at, &arms),
        )
    }

    /// Refuses arms from two sources; `place` is the key of the block.
    pub(in crate::study) fn validate(&self, place: &str) -> Result<()> {
        let one = self.arms.is_none() || self.arms_from.is_none();
        let (key, expected) = (format!("{place}.arms_from"), "`arms` or `arms_from`");
        ensure(one, key, expected, "both")?;
        self.arms.unwrap_or_default().validate(&format!("{place}."))
    }
}
