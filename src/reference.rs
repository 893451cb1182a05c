//! Named reference cases: what is computed, what is expected and who says so, how far off it may be and why.
//!
//! The figures stand in `data/reference`, one file per source; here stands how each case is computed. The same list serves the
//! tests, `aerodeck validate` and the table in docs/validation.md. "Published" figures are printed in the source named; "computed" ones
//! were obtained with NumPy and SciPy, independently of this crate. Users write cases of their own as `UserCase`.

mod bridges;
mod first_order;
mod flat_plate;
mod laguerre_functions;
mod models;
mod user_case;

pub(crate) use first_order::{ALPHA, ALPHA_OF_ORDERS, FILTERS, STEP_S, VALIDATION_HZ};
pub use first_order::{FirstOrderResults, first_order_example};
pub use laguerre_functions::{Lines, OF_THE_DECKS, laguerre_functions};
pub(crate) use user_case::UserCase;

use crate::aerodynamics::derivatives::Interpolation;
use crate::error::{Error, Result};
use crate::files::toml_lines;
use crate::identification::{FrequencyFit, FrequencyWeights};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// The files of `data/reference`.
const FILES: [&str; 10] = [
    include_str!("../data/reference/flat-plate-fits.toml"),
    include_str!("../data/reference/fung-1955.toml"),
    include_str!("../data/reference/goland-1945.toml"),
    include_str!("../data/reference/iabse-1.1a.toml"),
    include_str!("../data/reference/iabse-2a.toml"),
    include_str!("../data/reference/jones-1940.toml"),
    include_str!("../data/reference/kavrakov-2022.toml"),
    include_str!("../data/reference/ntnu-langenuen.toml"),
    include_str!("../data/reference/thesis.toml"),
    include_str!("../data/reference/typical-section.toml"),
];

/// Computes the figures of a case, in the order of its file.
type Compute = fn() -> Result<Vec<f64>>;

/// All cases by name, in the order in which they are shown.
const COMPUTATIONS: [(&str, Compute); 36] = [
    ("flat-plate-table-4.1", flat_plate::table_4_1),
    ("iabse-1.1a-onset", flat_plate::iabse_onset),
    ("iabse-1.1a-in-wind", flat_plate::iabse_in_wind),
    // the printed torsion frequency at 15 m/s, 0.279 Hz, lies above that in still air: a misprint for 0.276
    ("iabse-1.1a-in-wind-published", || {
        Ok(flat_plate::iabse_in_wind()?.split_off(1))
    }),
    ("iabse-1.1a-impedance", flat_plate::iabse_impedance),
    ("iabse-1.1a-sanity-lines", flat_plate::iabse_sanity),
    ("iabse-1.1a-p-k", flat_plate::iabse_by_iteration),
    ("fung-p236", flat_plate::fung),
    ("typical-section", || flat_plate::typical(-0.2)),
    ("typical-section-axis-aft", || flat_plate::typical(0.2)),
    ("table-4.1-unbalanced", flat_plate::unbalanced),
    ("jones-coefficients", flat_plate::jones_coefficients),
    ("jones-iabse-1.1a-onset", flat_plate::jones_onset),
    (
        "jones-iabse-1.1a-eigenvalues",
        flat_plate::jones_eigenvalues,
    ),
    ("alpha-guideline", models::guideline),
    ("fits-flat-plate-table-4.1", models::flat_plate_fits),
    ("thesis-flat-plate", models::thesis_flat_plate),
    ("thesis-headline", models::thesis_headline),
    ("laguerre-flat-plate-records", models::laguerre_flat_plate),
    ("iabse-1.1a-random-motion", models::random_motion),
    ("rational-ln21-5200", models::rational_ln21_5200),
    ("measured-decks-interpolated", || {
        models::over_decks(|table| models::interpolated(table, Interpolation::LinearVHat))
    }),
    ("measured-decks-modified-akima", || {
        models::over_decks(|table| models::interpolated(table, Interpolation::ModifiedAkima))
    }),
    ("measured-decks-rational", || {
        models::over_decks(|table| models::rational(table, true, FrequencyWeights::Relative))
    }),
    ("measured-decks-laguerre", || {
        models::over_decks(|table| models::fitted(table, FrequencyFit::default()))
    }),
    ("measured-decks-dissipative", models::dissipative),
    ("flat-plate-tables", models::table_errors),
    ("flat-plate-table-divergence", models::table_divergence),
    ("iabse-1.1a-turbulence", flat_plate::gust_density),
    ("iabse-1.1a-buffeting", flat_plate::iabse_rms),
    ("iabse-1.1a-buffeting-adaptive", flat_plate::iabse_rms),
    ("iabse-1.1a-buffeting-published", flat_plate::iabse_rms),
    ("goland-wing", bridges::goland),
    ("goland-wing-published", bridges::goland),
    ("iabse-2a", bridges::iabse_2a),
    ("iabse-2a-published", bridges::iabse_2a_against_lateral),
];

/// Who says what a figure should be.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(
    tag = "kind",
    content = "citation",
    rename_all = "snake_case",
    deny_unknown_fields
)]
pub enum Citation {
    /// Printed in this publication.
    Published(String),
    /// Computed independently of this crate, by this method.
    Computed(String),
    /// Stated by the user in a case file.
    Stated(String),
}

impl Citation {
    /// The source in words.
    pub(crate) fn words(&self) -> String {
        match self {
            Self::Published(text) => format!("published: {text}"),
            Self::Computed(text) => format!("computed: {text}"),
            Self::Stated(text) => format!("stated: {text}"),
        }
    }
}

/// A reference case: what is computed and the figures it should give.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct ReferenceCase {
    /// Name, as `aerodeck validate NAME` takes it.
    name: String,
    /// What is computed, in words.
    what: String,
    source: Citation,
    figures: Vec<CaseResult>,
}

/// One figure of a case and, after the computation, what came of it; files state the figure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseResult {
    /// Name of the case.
    #[serde(skip_deserializing)]
    pub name: String,
    /// What is computed, in words.
    #[serde(skip_deserializing)]
    pub what: String,
    /// The figure.
    pub quantity: String,
    /// Its unit; empty for a dimensionless figure.
    pub unit: String,
    /// The reference.
    pub expected: f64,
    /// Decimals to which the reference is given.
    pub decimals: usize,
    /// What was computed; `None` when the computation failed.
    #[serde(skip_deserializing)]
    pub found: Option<f64>,
    /// `found − expected`.
    #[serde(skip_deserializing)]
    pub deviation: Option<f64>,
    /// Allowed deviation; left out in a file, half of the last digit.
    #[serde(rename(deserialize = "within"), default = "unstated")]
    pub tolerance: f64,
    /// Reason of the tolerance.
    #[serde(default = "usual_reason")]
    pub reason: String,
    /// Whether the deviation is within the tolerance.
    #[serde(skip_deserializing)]
    pub passed: bool,
    /// Whose figure it is; left out in a file, that of the case.
    #[serde(default = "of_the_case")]
    pub source: Citation,
    /// Whether it stands in the short table of docs/validation.md.
    #[serde(default)]
    pub headline: bool,
    /// Why the computation failed, if it did.
    #[serde(skip_deserializing)]
    pub problem: Option<String>,
}

fn unstated() -> f64 {
    f64::NAN
}

fn usual_reason() -> String {
    "half of the last digit given".to_owned()
}

fn of_the_case() -> Citation {
    Citation::Stated(String::new())
}

impl CaseResult {
    /// Judged by what was computed, or by why nothing was.
    fn judged(self, found: std::result::Result<f64, String>) -> Self {
        // half a digit, and the rounding of the comparison itself
        let last_digit = 0.5 * 10f64.powi(-(self.decimals as i32)) * (1.0 + 1e-9);
        let tolerance = match self.tolerance.is_nan() {
            true => last_digit,
            false => self.tolerance,
        };
        let (found, problem) = match found {
            Ok(found) => (Some(found), None),
            Err(problem) => (None, Some(problem)),
        };
        let deviation = found.map(|found| found - self.expected);
        Self {
            found,
            deviation,
            tolerance,
            passed: deviation.is_some_and(|d| d.abs() <= tolerance),
            problem,
            ..self
        }
    }
}

/// The cases of the files, in the order of [`COMPUTATIONS`].
fn cases() -> Result<Vec<(ReferenceCase, Compute)>> {
    let mut read = Vec::new();
    for text in FILES {
        let file: BTreeMap<String, Vec<ReferenceCase>> =
            toml_lines::parse("a file of reference cases", text, |_| Ok(()))?;
        read.extend(file.into_values().flatten());
    }
    let of = |(name, compute): &(&str, Compute)| {
        let place = read.iter().position(|case| case.name == *name);
        let place = place.ok_or_else(|| {
            let expected = "a case for every computation";
            Error::input("data/reference", expected, format!("no `{name}`"))
        })?;
        Ok((read.swap_remove(place), *compute))
    };
    COMPUTATIONS.iter().map(of).collect()
}

/// Computes every case. A computation that fails is a result that has not passed.
///
/// # Errors
/// [`Error::Input`] for a file of reference cases that is none.
pub fn run_all() -> Result<Vec<CaseResult>> {
    let cases = cases()?.into_iter();
    Ok(cases
        .flat_map(|(case, compute)| case.run(compute))
        .collect())
}

/// Computes the case of this name.
///
/// # Errors
/// [`Error::Input`] listing the names when there is no such case.
pub fn run(name: &str) -> Result<Vec<CaseResult>> {
    let cases = cases()?;
    let Some((case, compute)) = cases.iter().find(|(case, _)| case.name == name) else {
        let names = COMPUTATIONS.map(|(name, _)| name).join(", ");
        let expected = format!("one of {names}");
        let found = format!("`{name}`");
        return Err(Error::input("reference case", expected, found));
    };
    Ok(case.run(*compute))
}

impl ReferenceCase {
    fn run(&self, compute: Compute) -> Vec<CaseResult> {
        let values = compute().and_then(|values| {
            if values.len() == self.figures.len() {
                return Ok(values);
            }
            let (computed, expected) = (values.len(), self.figures.len());
            let why = format!("{computed} figures computed, {expected} expected");
            Err(Error::Numerical(why))
        });
        let judge = |(i, figure): (usize, &CaseResult)| {
            let found = values.as_ref().map(|values| values[i]);
            let own = figure.source != of_the_case();
            let of = CaseResult {
                name: self.name.clone(),
                what: self.what.clone(),
                source: if own { &figure.source } else { &self.source }.clone(),
                ..figure.clone()
            };
            of.judged(found.map_err(|e| e.to_string()))
        };
        self.figures.iter().enumerate().map(judge).collect()
    }
}

/// Markdown table of the headline figures, and a sentence that counts all of them.
pub fn validation_table(results: &[CaseResult]) -> String {
    let mut text = String::from(
        "| case | figure | reference | computed | allowed | source |\n|---|---|---|---|---|---|\n",
    );
    let mut last = "";
    for r in results.iter().filter(|r| r.headline) {
        let case = if r.what == last { "" } else { &r.what };
        last = &r.what;
        let found = match r.found {
            Some(found) => with_unit(found, r.decimals, &r.unit),
            None => "no result".into(),
        };
        let mark = if r.passed { "" } else { " **failed**" };
        let expected = with_unit(r.expected, r.decimals, &r.unit);
        let (quantity, source) = (escaped(&r.quantity), escaped(&r.source.words()));
        let (allowed, found) = (allowed(r), found + mark);
        text +=
            &format!("| {case} | {quantity} | {expected} | {found} | ±{allowed} | {source} |\n");
    }
    let passed = results.iter().filter(|r| r.passed).count();
    let _ = write!(
        text,
        "\n{passed} of {} reference figures are met; `aerodeck validate` computes and prints all of them.\n",
        results.len()
    );
    text
}

fn with_unit(value: f64, decimals: usize, unit: &str) -> String {
    match unit {
        "" => format!("{value:.decimals$}"),
        "°" => format!("{value:.decimals$}°"),
        _ => format!("{value:.decimals$} {unit}"),
    }
}

fn allowed(result: &CaseResult) -> String {
    // one digit more than the reference shows half of its last digit
    let text = format!("{:.*}", result.decimals + 1, result.tolerance);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A bar would end the cell.
fn escaped(text: &str) -> String {
    text.replace('|', "\\|")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_judged() {
        let text = r#"
            name = "made up"
            what = ""
            source = { kind = "computed", citation = "by hand" }
            figures = [
                { quantity = "a", expected = 1.0, decimals = 3, unit = "m/s" },
                { quantity = "b", expected = 1.0, decimals = 3, unit = "m/s" },
            ]"#;
        let case: ReferenceCase = toml::from_str(text).unwrap();
        let results = case.run(|| Ok(vec![1.0004, 1.0006]));
        assert!(results[0].passed && !results[1].passed);
        let broken: Compute = || Err(Error::Numerical("no roots".into()));
        let too_few: Compute = || Ok(vec![1.0]);
        for compute in [broken, too_few] {
            let results = case.run(compute);
            assert_eq!(results.len(), 2);
            assert!(results.iter().all(|r| !r.passed && r.problem.is_some()));
        }
    }

    #[test]
    fn every_case_of_the_files_is_computed_once_and_unknown_ones_are_refused() {
        let mut names = COMPUTATIONS.map(|(name, _)| name);
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]));
        let stated: usize = FILES
            .iter()
            .map(|text| text.matches("[[case]]").count())
            .sum();
        assert_eq!(cases().unwrap().len(), stated);
        assert!(run("nothing").unwrap_err().to_string().contains("jones"));
    }
}
