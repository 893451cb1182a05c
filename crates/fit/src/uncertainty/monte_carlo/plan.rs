//! The file of a Monte Carlo analysis.

use super::distribution::Distribution;
use crate::error::{Error, Result, ensure, of_schema, positive};
use crate::files::toml_lines;
use crate::plausibility::{Finding, FindingKind, of_section};
use crate::section::SectionModel;
use serde::Deserialize;
use std::path::PathBuf;

/// Version of the file.
pub(crate) const PLAN_SCHEMA: u32 = 1;
/// Most samples of one run: more do not fit into memory.
pub const MAX_SAMPLES: usize = 100_000_000;

/// What is random, and what is asked.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MonteCarloPlan {
    /// `PLAN_SCHEMA`.
    pub schema: u32,
    /// The trained model (section and forces), a path against the folder of the file.
    pub model: PathBuf,
    /// Number of samples.
    pub samples: usize,
    /// Seed of the random numbers; the same seed gives the same samples on every machine and number of threads.
    #[serde(default)]
    pub seed: u64,
    /// Onsets are searched up to this wind speed, m/s; left out, as far as the study of the model did.
    pub speed_max_m_s: Option<f64>,
    /// The probability of an onset below this wind speed is asked, m/s.
    pub design_speed_m_s: Option<f64>,
    /// Level of the confidence interval of that probability.
    #[serde(default = "usual_confidence")]
    pub confidence: f64,
    /// Probabilities whose quantiles are printed.
    #[serde(default = "usual_quantiles")]
    pub quantiles: Vec<f64>,
    /// Random numbers of the section.
    #[serde(rename = "parameter", default)]
    pub parameters: Vec<RandomParameter>,
    /// Correlations between them.
    #[serde(rename = "correlation", default)]
    pub correlations: Vec<Correlation>,
    /// Scatter of the force model.
    #[serde(default)]
    pub aerodynamics: AerodynamicScatter,
    /// Folder of the file.
    #[serde(skip)]
    pub directory: PathBuf,
}

/// One random number of the section.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RandomParameter {
    /// Which.
    pub name: SectionProperty,
    /// Its distribution.
    pub distribution: Distribution,
}

/// Correlation of two random numbers (of the Gaussian variables behind them).
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Correlation {
    /// The two.
    pub between: [SectionProperty; 2],
    /// Between −1 and 1.
    pub coefficient: f64,
}

/// Scatter of the coefficients of the force model: nothing, a relative one, or a covariance.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AerodynamicScatter {
    /// Standard deviation of every coefficient over its value, Gaussian and independent.
    pub relative_scatter: Option<f64>,
    /// Covariance of the coefficients: that of all parameters of a fit (`fits/<model>.uncertainty.json` as `train` writes it,
    /// also found beside the fit's report `fits/<model>.json`), or a table (`.csv`: names of the coefficients in the first
    /// line, then the matrix).
    pub covariance: Option<PathBuf>,
}

fn usual_confidence() -> f64 {
    0.95
}

fn usual_quantiles() -> Vec<f64> {
    vec![0.001, 0.01, 0.05, 0.5, 0.95, 0.99]
}

impl MonteCarloPlan {
    /// Reads and checks the text of a file; paths in it are read against `directory`.
    ///
    /// # Errors
    /// [`Error::Input`] with line and key.
    pub fn from_toml(text: &str, directory: PathBuf) -> Result<Self> {
        toml_lines::parse("a Monte Carlo file", text, |plan: &mut Self| {
            plan.directory = directory;
            plan.validate()
        })
    }

    /// The same error with the line of the key it names in `text`, for what shows only beside the model.
    pub fn locate(text: &str, error: Error) -> Error {
        toml_lines::with_line(text, error)
    }

    /// Checks every value that does not need the model.
    pub(crate) fn validate(&self) -> Result<()> {
        of_schema(PLAN_SCHEMA, self.schema)?;
        let samples = (1..=MAX_SAMPLES).contains(&self.samples);
        ensure(samples, "samples", "a number from 1 to 1e8", self.samples)?;
        if let Some(speed) = self.speed_max_m_s {
            positive("speed_max_m_s", speed)?;
        }
        if let Some(speed) = self.design_speed_m_s {
            positive("design_speed_m_s", speed)?;
            self.check_design_speed(self.speed_max_m_s.unwrap_or(f64::INFINITY))?;
        }
        let inside = |p: f64| p > 0.0 && p < 1.0;
        let confidence = self.confidence;
        let between = "a number between 0 and 1";
        ensure(inside(confidence), "confidence", between, confidence)?;
        for (i, p) in self.quantiles.iter().enumerate() {
            let place = format_args!("quantiles[{i}]");
            ensure(inside(*p), place, "probabilities between 0 and 1", p)?;
        }
        self.validate_parameters()?;
        self.aerodynamics.validate()?;
        ensure(
            !self.parameters.is_empty() || self.aerodynamics != AerodynamicScatter::default(),
            "parameter",
            "something random: a [[parameter]] or [aerodynamics]",
            "nothing",
        )
    }

    /// The design speed has to lie where onsets are searched.
    pub(super) fn check_design_speed(&self, speed_max_m_s: f64) -> Result<()> {
        let speed = self.design_speed_m_s.unwrap_or(0.0);
        ensure(
            speed <= speed_max_m_s,
            "design_speed_m_s",
            format_args!(
                "a speed not above speed_max_m_s ({speed_max_m_s}), up to which onsets are searched"
            ),
            speed,
        )
    }

    /// What is odd about the section of all means where the section of the model is not, and every mean below half or above twice
    /// the model's own number: mostly one in another unit. Offsets may be any.
    pub(super) fn findings(&self, section: &SectionModel) -> Result<Vec<Finding>> {
        let (mut means, mut found) = (section.clone(), Vec::new());
        for random in &self.parameters {
            let key = random.name.name();
            let own = random.name.nominal(key, section)?;
            let mean = random.distribution.mean(own);
            if let Some(place) = random.name.place(&mut means) {
                *place = mean;
            }
            let offset = key.ends_with("_offset_m");
            if own > 0.0 && !(0.5..=2.0).contains(&(mean / own)) && !offset {
                let text = format!("the mean of its distribution, where the model has {own}");
                let doubt = Finding::doubt(FindingKind::Contradiction, key, text);
                let value = Some(mean);
                found.push(Finding { value, ..doubt });
            }
        }
        let own = of_section(section);
        found.extend(of_section(&means).into_iter().filter(|f| !own.contains(f)));
        Ok(found)
    }

    fn validate_parameters(&self) -> Result<()> {
        for (i, random) in self.parameters.iter().enumerate() {
            ensure(
                self.parameters[..i].iter().all(|p| p.name != random.name),
                format_args!("parameter[{i}].name"),
                "every parameter once",
                format_args!("`{}` a second time", random.name.name()),
            )?;
        }
        for (i, c) in self.correlations.iter().enumerate() {
            let key = format!("correlation[{i}]");
            ensure(
                c.coefficient > -1.0 && c.coefficient < 1.0,
                format_args!("{key}.coefficient"),
                "a number between -1 and 1",
                c.coefficient,
            )?;
            let random = |p: &SectionProperty| self.parameters.iter().any(|r| r.name == *p);
            let missing = c.between.iter().find(|p| !random(p));
            let pair = |o: &Correlation| {
                o.between == c.between || o.between == [c.between[1], c.between[0]]
            };
            let twice = c.between[0] == c.between[1] || self.correlations[..i].iter().any(pair);
            ensure(
                missing.is_none() && !twice,
                format_args!("{key}.between"),
                "two different random parameters, every pair once",
                match missing {
                    Some(p) => format!("`{}`, which is not random", p.name()),
                    None => "a pair of one parameter, or a pair a second time".into(),
                },
            )?;
        }
        Ok(())
    }
}

impl AerodynamicScatter {
    fn validate(&self) -> Result<()> {
        if let Some(scatter) = self.relative_scatter {
            positive("aerodynamics.relative_scatter", scatter)?;
            ensure(
                self.covariance.is_none(),
                "aerodynamics.covariance",
                "either `relative_scatter` or `covariance`",
                "both",
            )?;
        }
        Ok(())
    }
}

/// A number of the section that may be random, by the name it has in a study file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub struct SectionProperty(usize);

/// Where a number stands; none where the section states it otherwise (a stiffness instead of a frequency) or has no such support.
type Place = fn(&mut SectionModel) -> Option<&mut f64>;

/// All of them.
const PROPERTIES: [(&str, Place); 16] = [
    ("width_m", |s| Some(&mut s.width_m)),
    ("air_density_kg_m3", |s| Some(&mut s.air_density_kg_m3)),
    ("axis_offset_m", |s| s.axis_offset_m.as_mut()),
    ("mass_offset_m", |s| s.mass_offset_m.as_mut()),
    ("vertical.mass_kg_m", |s| Some(&mut s.vertical.mass_kg_m)),
    ("vertical.frequency_hz", |s| {
        s.vertical.frequency_hz.as_mut()
    }),
    ("vertical.stiffness_n_m2", |s| {
        s.vertical.stiffness_n_m2.as_mut()
    }),
    ("vertical.damping_ratio", |s| {
        Some(&mut s.vertical.damping_ratio)
    }),
    ("lateral.mass_kg_m", |s| {
        Some(&mut s.lateral.as_mut()?.mass_kg_m)
    }),
    ("lateral.frequency_hz", |s| {
        s.lateral.as_mut()?.frequency_hz.as_mut()
    }),
    ("lateral.stiffness_n_m2", |s| {
        s.lateral.as_mut()?.stiffness_n_m2.as_mut()
    }),
    ("lateral.damping_ratio", |s| {
        Some(&mut s.lateral.as_mut()?.damping_ratio)
    }),
    ("torsion.inertia_kg_m2_m", |s| {
        Some(&mut s.torsion.inertia_kg_m2_m)
    }),
    ("torsion.frequency_hz", |s| s.torsion.frequency_hz.as_mut()),
    ("torsion.stiffness_n", |s| s.torsion.stiffness_n.as_mut()),
    ("torsion.damping_ratio", |s| {
        Some(&mut s.torsion.damping_ratio)
    }),
];

impl SectionProperty {
    /// Where the number stands; `None` when the section states it otherwise (a stiffness instead of a frequency) or has
    /// no such support.
    pub fn place(self, section: &mut SectionModel) -> Option<&mut f64> {
        PROPERTIES[self.0].1(section)
    }

    /// The value in `section`.
    pub(super) fn nominal(self, key: &str, section: &SectionModel) -> Result<f64> {
        let mut copy = section.clone();
        self.place(&mut copy).copied().ok_or_else(|| {
            Error::input(
                key,
                "a number that the section of the model states (a support has either a frequency or a stiffness)",
                format!("`{}`", self.name()),
            )
        })
    }

    /// The number of this name in files.
    ///
    /// # Errors
    /// [`Error::Input`] for a name that none has.
    pub fn named(name: &str) -> Result<Self> {
        let place = PROPERTIES.iter().position(|(own, _)| *own == name);
        place.map(Self).ok_or_else(|| {
            let expected = "a number of the section, such as vertical.mass_kg_m";
            Error::input("parameter", expected, format!("`{name}`"))
        })
    }

    /// The name in files.
    pub(crate) fn name(self) -> &'static str {
        PROPERTIES[self.0].0
    }
}

impl TryFrom<String> for SectionProperty {
    type Error = Error;

    fn try_from(name: String) -> Result<Self> {
        Self::named(&name)
    }
}
