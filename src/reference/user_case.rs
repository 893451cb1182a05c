//! Reference cases of users, as TOML files.

mod evaluate;

use crate::aerodynamics::FlatPlate;
use crate::aerodynamics::derivatives::Interpolation;
use crate::error::{Error, Result, ensure, finite, non_negative, of_schema, positive};
use crate::files::toml_lines;
use crate::flutter::OnsetMethod;
use crate::section::{Dof, SectionModel};
use nalgebra::DMatrix;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Version of the case file.
pub(crate) const CASE_SCHEMA: u32 = 1;

/// Contents of a case file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct UserCase {
    /// [`CASE_SCHEMA`].
    pub schema: u32,
    /// Name of the case.
    pub name: String,
    /// What is computed, in words.
    pub what: String,
    /// The suspended section; may be left out for a trained model, which brings its own.
    pub section: Option<SectionModel>,
    /// The forces: exactly one kind.
    pub aerodynamics: UserAerodynamics,
    /// Onsets are searched up to this wind speed, m/s.
    #[serde(default = "usual_speed_max")]
    pub speed_max_m_s: f64,
    /// The expected figures.
    #[serde(rename = "figure")]
    pub figures: Vec<UserFigure>,
    /// Folder of the file.
    #[serde(skip)]
    pub directory: PathBuf,
}

fn usual_speed_max() -> f64 {
    200.0
}

/// The forces of a case: exactly one of these.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct UserAerodynamics {
    /// Theodorsen's flat plate; `rotary_inertia` keeps the apparent rotary inertia.
    pub flat_plate: Option<FlatPlate>,
    /// Rational functions in Roger's form.
    pub rational: Option<UserRational>,
    /// A table of derivatives (`.csv`, `.xlsx`) or the name of an embedded deck.
    pub table: Option<String>,
    /// How the table is read between its points.
    pub interpolation: Option<Interpolation>,
    /// A trained model (`.json`).
    pub model: Option<PathBuf>,
}

/// `G = a₁ + a₂ p + a₃ p² + Σ a_{l+3} p/(p + d_l)`; rows of matrices are forces, in the order of the section.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct UserRational {
    /// `a₁`.
    #[serde(with = "crate::state_space::rows")]
    pub a1: DMatrix<f64>,
    /// `a₂`.
    #[serde(with = "crate::state_space::rows")]
    pub a2: DMatrix<f64>,
    /// `a₃`.
    #[serde(with = "crate::state_space::rows")]
    pub a3: DMatrix<f64>,
    /// `d_l`.
    #[serde(default)]
    pub lags: Vec<f64>,
    /// `a_{l+3}`, one matrix per lag.
    #[serde(default, with = "crate::state_space::rows::list")]
    pub lag_terms: Vec<DMatrix<f64>>,
}

/// One expected figure.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct UserFigure {
    /// What.
    pub quantity: FigureQuantity,
    /// Route of the onset; left out, eigenvalues where the forces have a realisation, else the determinant.
    pub route: Option<OnsetMethod>,
    /// Wind speed of a mode in wind, m/s.
    pub speed_m_s: Option<f64>,
    /// Degree of freedom that a mode in wind moves in still air.
    pub dof: Option<Dof>,
    /// The reference.
    pub expected: f64,
    /// Allowed deviation, in the unit of the quantity.
    pub tolerance: f64,
    /// Why so much is allowed.
    #[serde(default)]
    pub reason: String,
    /// Whose figure it is.
    pub source: String,
}

/// What a figure of a case file can be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum FigureQuantity {
    /// Onset speed, m/s.
    OnsetSpeed,
    /// Frequency at onset, Hz.
    OnsetFrequency,
    /// `V* = V/(fB)` at onset.
    OnsetReducedVelocity,
    /// `V̂ = V/(ωB)` at onset.
    OnsetVHat,
    /// `|y|/(B|θ|)` at onset.
    ModeRatio,
    /// Phase of `y` to `θ` at onset, degrees.
    Phase,
    /// `dζ/dV` at onset, s/m.
    DampingSlope,
    /// Static divergence, m/s.
    DivergenceSpeed,
    /// Selberg's formula, factor 0.44, m/s.
    Selberg,
    /// Rocard's formula, m/s.
    Rocard,
    /// Frequency of a mode in wind (p-k), Hz; needs `speed_m_s` and `dof`.
    ModeFrequency,
    /// Damping ratio of a mode in wind (p-k); needs `speed_m_s` and `dof`.
    ModeDampingRatio,
}

impl FigureQuantity {
    /// Name and unit in words.
    pub(crate) fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::OnsetSpeed => ("onset speed", "m/s"),
            Self::OnsetFrequency => ("frequency at onset", "Hz"),
            Self::OnsetReducedVelocity => ("reduced velocity V/(fB) at onset", ""),
            Self::OnsetVHat => ("reduced velocity V/(ωB) at onset", ""),
            Self::ModeRatio => ("mode ratio |y|/(B|θ|)", ""),
            Self::Phase => ("phase of y to θ", "°"),
            Self::DampingSlope => ("damping slope dζ/dV at onset", "s/m"),
            Self::DivergenceSpeed => ("divergence speed", "m/s"),
            Self::Selberg => ("Selberg's formula", "m/s"),
            Self::Rocard => ("Rocard's formula", "m/s"),
            Self::ModeFrequency => ("frequency in wind", "Hz"),
            Self::ModeDampingRatio => ("damping ratio in wind", ""),
        }
    }

    fn in_wind(self) -> bool {
        matches!(self, Self::ModeFrequency | Self::ModeDampingRatio)
    }
}

impl UserCase {
    /// Reads and checks a case file.
    ///
    /// # Errors
    /// [`Error::Io`] when it cannot be read; [`Error::Input`] with file and line for everything that is wrong in it.
    pub(crate) fn read(path: &Path) -> Result<Self> {
        toml_lines::read(path, Self::from_toml)
    }

    /// Reads and checks the text of a case file; paths in it are read against `directory`.
    pub(crate) fn from_toml(text: &str, directory: PathBuf) -> Result<Self> {
        toml_lines::parse("a case file", text, |case: &mut Self| {
            case.directory = directory;
            case.validate()
        })
    }

    fn validate(&self) -> Result<()> {
        of_schema(CASE_SCHEMA, self.schema)?;
        positive("speed_max_m_s", self.speed_max_m_s)?;
        let a = &self.aerodynamics;
        let formulas = [a.flat_plate.is_some(), a.rational.is_some()];
        let files = [a.table.is_some(), a.model.is_some()];
        let kinds = [formulas, files].concat();
        if kinds.iter().filter(|given| **given).count() != 1 {
            let expected = "exactly one of `flat_plate`, `rational`, `table`, `model`";
            return Err(Error::input("aerodynamics", expected, "none or several"));
        }
        match &self.section {
            Some(section) => drop(section.structure()?),
            None if a.model.is_some() => {}
            None => return Err(Error::input("section", "a section", "none")),
        }
        if self.figures.is_empty() {
            return Err(Error::input("figure", "at least one [[figure]]", "none"));
        }
        for (i, figure) in self.figures.iter().enumerate() {
            figure.validate(&format!("figure[{i}]"))?;
        }
        Ok(())
    }
}

impl UserFigure {
    fn validate(&self, place: &str) -> Result<()> {
        finite(format!("{place}.expected"), self.expected)?;
        positive(format!("{place}.tolerance"), self.tolerance)?;
        let expected = "`eigenvalues`, `determinant` or `pk_iteration`";
        let known = self.route != Some(OnsetMethod::FmuStepping);
        ensure(known, format!("{place}.route"), expected, "`fmu_stepping`")?;
        let in_wind = (self.speed_m_s, self.dof);
        match (self.quantity.in_wind(), in_wind) {
            (true, (Some(speed), Some(_))) => {
                non_negative(format!("{place}.speed_m_s"), speed).map(drop)
            }
            (true, _) => {
                let expected = "`speed_m_s` and `dof` of a mode in wind";
                Err(Error::input(place, expected, "none"))
            }
            (false, (None, None)) => Ok(()),
            (false, _) => {
                let expected =
                    "`speed_m_s` and `dof` with `mode_frequency` and `mode_damping_ratio` only";
                let found = format!("them with the {}", self.quantity.words().0);
                Err(Error::input(place, expected, found))
            }
        }
    }
}

#[cfg(test)]
mod tests;
