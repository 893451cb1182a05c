//! `Onset`: at which wind speed a motion grows.

use crate::convert::{Reduced, json_text, reduced, restored, shown};
use aerodeck::flutter::{FlutterSearch, OnsetInterval};
use aerodeck::verdict::{Outcome, Verdict};
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// The flutter onset of a section in a force model.
#[pyclass(frozen, module = "aerodeck", get_all)]
#[derive(Serialize, Deserialize)]
pub struct Onset {
    /// `onset`; `unstable` when a motion grows already at the lowest speed that could be judged (the onset is there or below);
    /// `stable` when there is none up to the highest speed searched; `not_judged` when there is none as far as the data reach, which is less:
    /// `headline` says how far and why.
    state: Cow<'static, str>,
    /// Wind speed, m/s; None when stable or not judged.
    speed_m_s: Option<f64>,
    /// Frequency of the motion, Hz; None when stable or not judged.
    frequency_hz: Option<f64>,
    /// V* = V/(fB); None when stable or not judged.
    reduced_velocity: Option<f64>,
    /// 95 % interval of the speed, m/s, as (low, high); None when it is not known or the data do not determine the onset.
    interval: Option<(f64, f64)>,
    /// Why there is no interval; None when there is one.
    no_interval: Option<String>,
    /// Whether the data reach the onset; None when there is none, or the model is exact.
    in_tested_range: Option<bool>,
    /// The answer in one line; begins with the outcome where a speed is required.
    headline: String,
    /// `met`, `not_met` or `cannot_be_judged`; None where no speed is required.
    outcome: Option<Cow<'static, str>>,
    /// Why, or what it takes to have one.
    explanation: String,
    /// What limits trust in it, the gravest first.
    warnings: Vec<String>,
    /// How it was found.
    method: String,
    json: String,
    verdict_json: String,
}

#[pymethods]
impl Onset {
    /// Everything that is known, as dicts and numbers: the card of `aerodeck flutter --json`.
    #[getter]
    fn card<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("json")?.call_method1("loads", (&self.json,))
    }

    /// What everything that is known amounts to, as dicts and numbers: outcome, what governs, doubts with their kinds, severities
    /// and numbers.
    #[getter]
    fn verdict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("json")?
            .call_method1("loads", (&self.verdict_json,))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        reduced(slf, slf.get())
    }

    #[staticmethod]
    fn _from_state(state: &str) -> PyResult<Self> {
        restored(state)
    }

    fn __repr__(&self) -> String {
        format!("Onset({})", self.headline)
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        shown(slf.as_any(), "onset_html", None)
    }
}

impl Onset {
    /// What was found, by `method`.
    pub fn new(search: &FlutterSearch, method: &str, verdict: &Verdict) -> PyResult<Self> {
        Self::with_card(search, method, verdict, search)
    }

    /// What was found, with a card that holds more.
    pub fn with_card(
        search: &FlutterSearch,
        method: &str,
        verdict: &Verdict,
        card: &impl Serialize,
    ) -> PyResult<Self> {
        let json = json_text(card)?;
        let mut answer = Self {
            state: "stable".into(),
            speed_m_s: None,
            frequency_hz: None,
            reduced_velocity: None,
            interval: None,
            no_interval: None,
            in_tested_range: None,
            headline: verdict.headline.clone(),
            outcome: verdict.outcome.as_ref().map(|outcome| match outcome {
                Outcome::Met => "met".into(),
                Outcome::NotMet { .. } => "not_met".into(),
                Outcome::CannotBeJudged { .. } => "cannot_be_judged".into(),
            }),
            explanation: verdict.explanation.clone(),
            warnings: verdict.warnings().map(str::to_owned).collect(),
            method: method.to_owned(),
            json,
            verdict_json: json_text(verdict)?,
        };
        let at = match search {
            FlutterSearch::Onset(onset) => {
                answer.state = "onset".into();
                answer.in_tested_range = onset.in_tested_range;
                match &onset.interval {
                    OnsetInterval::Known(error) => {
                        answer.interval = Some((error.low_m_s, error.high_m_s));
                    }
                    OnsetInterval::Undetermined { reason, .. } | OnsetInterval::None { reason } => {
                        answer.no_interval = Some(reason.clone());
                    }
                    OnsetInterval::Spread { of, .. } => answer.no_interval = Some(of.clone()),
                }
                &onset.at
            }
            FlutterSearch::UnstableAtOrBelow(start) => {
                answer.state = "unstable".into();
                answer.in_tested_range = start.in_tested_range;
                &start.at
            }
            FlutterSearch::StableUpTo(range) => {
                if range.not_judged.is_some() {
                    answer.state = "not_judged".into();
                }
                return Ok(answer);
            }
        };
        answer.speed_m_s = Some(at.speed_m_s);
        answer.frequency_hz = Some(at.frequency_hz);
        answer.reduced_velocity = Some(at.reduced_velocity.v_star());
        Ok(answer)
    }
}
