//! Named reference cases: what is computed, what is expected and who says so, how far off it may be and why.
//!
//! The same list serves the tests, `aerodeck validate` and the table in the README, so that every reference figure
//! stands once. "Published" figures are printed in the source named; "computed" ones were obtained with NumPy and
//! SciPy, independently of this crate.

mod buffeting;
mod decks;
mod first_order;
mod fits;
mod flat_plate;
mod interpolation;
mod jones;
mod records;
mod table;
mod typical_section;
#[cfg(feature = "campaigns")]
mod user_case;

pub use first_order::{FirstOrderExample, FirstOrderResults, SampledTransfer};
pub use table::validation_table;
#[cfg(feature = "campaigns")]
pub use user_case::{CASE_SCHEMA, Quantity, UserAerodynamics, UserCase, UserFigure};

use crate::error::{Error, Result};
use serde::Serialize;
use std::borrow::Cow;

/// Who says what the figure should be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", content = "citation", rename_all = "snake_case")]
pub enum Source {
    /// Printed in this publication.
    Published(&'static str),
    /// Computed independently of this crate, by this method.
    Computed(&'static str),
}

/// The same in a result, where it may come from a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", content = "citation", rename_all = "snake_case")]
pub enum Citation {
    /// Printed in this publication.
    Published(Cow<'static, str>),
    /// Computed independently of this crate, by this method.
    Computed(Cow<'static, str>),
    /// Stated by the user in a case file.
    Stated(Cow<'static, str>),
}

impl Citation {
    /// The source in words.
    pub fn words(&self) -> String {
        match self {
            Self::Published(text) => format!("published: {text}"),
            Self::Computed(text) => format!("computed: {text}"),
            Self::Stated(text) => format!("stated: {text}"),
        }
    }
}

impl From<Source> for Citation {
    fn from(source: Source) -> Self {
        match source {
            Source::Published(text) => Self::Published(text.into()),
            Source::Computed(text) => Self::Computed(text.into()),
        }
    }
}

/// How far a figure may be from its reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// Half of the last digit that is given.
    LastDigit,
    /// This much, in the unit of the figure, for a reason.
    Within(f64, &'static str),
}

/// One reference figure of a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figure {
    /// What it is.
    pub quantity: &'static str,
    /// Its unit; empty for a dimensionless figure.
    pub unit: &'static str,
    /// The reference.
    pub expected: f64,
    /// Decimals to which the reference is given.
    pub decimals: usize,
    /// How far off a result may be.
    pub tolerance: Tolerance,
    /// Whose figure it is.
    pub source: Source,
    /// Whether it stands in the short table of the README.
    pub headline: bool,
}

impl Figure {
    /// A figure computed independently with NumPy and SciPy, good to its last digit.
    const fn new(
        quantity: &'static str,
        expected: f64,
        decimals: usize,
        unit: &'static str,
    ) -> Self {
        Self {
            quantity,
            unit,
            expected,
            decimals,
            tolerance: Tolerance::LastDigit,
            source: Source::Computed("NumPy/SciPy"),
            headline: false,
        }
    }

    /// The same, to be shown in the README.
    const fn headline(mut self) -> Self {
        self.headline = true;
        self
    }

    /// The same, printed in a publication.
    const fn published(mut self, citation: &'static str) -> Self {
        self.source = Source::Published(citation);
        self
    }

    /// The same, computed in another way than the default.
    const fn computed(mut self, method: &'static str) -> Self {
        self.source = Source::Computed(method);
        self
    }

    /// The same with a tolerance of its own.
    const fn within(mut self, tolerance: f64, reason: &'static str) -> Self {
        self.tolerance = Tolerance::Within(tolerance, reason);
        self
    }

    /// Allowed deviation in the unit of the figure.
    pub fn allowed(&self) -> f64 {
        match self.tolerance {
            // half a digit, and the rounding of the comparison itself
            Tolerance::LastDigit => 0.5 * 10f64.powi(-(self.decimals as i32)) * (1.0 + 1e-9),
            Tolerance::Within(tolerance, _) => tolerance,
        }
    }

    /// Reason of the tolerance.
    pub fn reason(&self) -> &'static str {
        match self.tolerance {
            Tolerance::LastDigit => "half of the last digit given",
            Tolerance::Within(_, reason) => reason,
        }
    }
}

/// A reference case: a computation and the figures it should give.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Name, as `aerodeck validate NAME` takes it.
    pub name: &'static str,
    /// What is computed, in words.
    pub what: &'static str,
    /// The figures.
    pub figures: &'static [Figure],
    /// Computes them, in the same order.
    pub compute: fn() -> Result<Vec<f64>>,
}

/// One figure after the computation.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CaseResult {
    /// Name of the case.
    pub name: Cow<'static, str>,
    /// What is computed, in words.
    pub what: Cow<'static, str>,
    /// The figure.
    pub quantity: Cow<'static, str>,
    /// Its unit.
    pub unit: Cow<'static, str>,
    /// The reference.
    pub expected: f64,
    /// Decimals to which the reference is given.
    pub decimals: usize,
    /// What was computed; `None` when the computation failed.
    pub found: Option<f64>,
    /// `found − expected`.
    pub deviation: Option<f64>,
    /// Allowed deviation.
    pub tolerance: f64,
    /// Reason of the tolerance.
    pub reason: Cow<'static, str>,
    /// Whether the deviation is within the tolerance.
    pub passed: bool,
    /// Whose figure it is.
    pub source: Citation,
    /// Whether it stands in the short table of the README.
    pub headline: bool,
    /// Why the computation failed, if it did.
    pub problem: Option<String>,
}

/// All cases.
pub fn cases() -> impl Iterator<Item = &'static Case> {
    [
        flat_plate::CASES,
        typical_section::CASES,
        jones::CASES,
        fits::CASES,
        records::CASES,
        decks::CASES,
        interpolation::CASES,
        buffeting::CASES,
    ]
    .into_iter()
    .flatten()
}

/// Computes every case. A computation that fails is a result that has not passed.
pub fn run_all() -> Vec<CaseResult> {
    cases().flat_map(Case::run).collect()
}

/// Computes the case of this name.
///
/// # Errors
/// [`Error::Input`] listing the names when there is no such case.
pub fn run(name: &str) -> Result<Vec<CaseResult>> {
    let case = cases().find(|case| case.name == name).ok_or_else(|| {
        let names: Vec<_> = cases().map(|case| case.name).collect();
        Error::input(
            "reference case",
            format!("one of {}", names.join(", ")),
            format!("`{name}`"),
        )
    })?;
    Ok(case.run())
}

impl Case {
    /// Computes the figures of this case.
    pub fn run(&self) -> Vec<CaseResult> {
        let values = (self.compute)().and_then(|values| {
            if values.len() == self.figures.len() {
                return Ok(values);
            }
            Err(Error::Numerical(format!(
                "{} figures computed, {} expected",
                values.len(),
                self.figures.len()
            )))
        });
        let judge = |(i, figure): (usize, &Figure)| match &values {
            Ok(values) => self.result(figure, Some(values[i]), None),
            Err(error) => self.result(figure, None, Some(error.to_string())),
        };
        self.figures.iter().enumerate().map(judge).collect()
    }

    fn result(&self, figure: &Figure, found: Option<f64>, problem: Option<String>) -> CaseResult {
        let deviation = found.map(|found| found - figure.expected);
        CaseResult {
            name: self.name.into(),
            what: self.what.into(),
            quantity: figure.quantity.into(),
            unit: figure.unit.into(),
            expected: figure.expected,
            decimals: figure.decimals,
            found,
            deviation,
            tolerance: figure.allowed(),
            reason: figure.reason().into(),
            passed: deviation.is_some_and(|d| d.abs() <= figure.allowed()),
            source: figure.source.into(),
            headline: figure.headline,
            problem,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wrong() -> Result<Vec<f64>> {
        Ok(vec![1.0004, 1.0006])
    }

    fn broken() -> Result<Vec<f64>> {
        Err(Error::Numerical("no roots".into()))
    }

    fn too_few() -> Result<Vec<f64>> {
        Ok(vec![1.0])
    }

    #[test]
    fn results_are_judged() {
        const FIGURES: &[Figure] = &[
            Figure::new("a", 1.0, 3, "m/s"),
            Figure::new("b", 1.0, 3, "m/s"),
        ];
        let case = |compute| Case {
            name: "made up",
            what: "",
            figures: FIGURES,
            compute,
        };
        let results = case(wrong).run();
        assert!(results[0].passed && !results[1].passed);
        for compute in [broken as fn() -> _, too_few] {
            let results = case(compute).run();
            assert_eq!(results.len(), 2);
            assert!(results.iter().all(|r| !r.passed && r.problem.is_some()));
        }
    }

    #[test]
    fn names_are_unique_and_unknown_ones_are_refused() {
        let mut names: Vec<_> = cases().map(|c| c.name).collect();
        names.sort_unstable();
        let count = names.len();
        names.dedup();
        assert_eq!(names.len(), count);
        assert!(run("nothing").unwrap_err().to_string().contains("jones"));
    }
}
