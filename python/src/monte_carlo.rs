//! `monte_carlo`: the distribution of the onset when section and forces are random.

use crate::convert::{
    Reduced, from_python, json_text, reduced, refuse_not_finite, restored, set_default, shown,
    to_python,
};
use crate::error::{raised, warn, warned, wrong};
use crate::flutter::verdict_at;
use crate::model::Model;
use crate::section::Section;
use crate::work::{Work, detached, on_threads};
use aerodeck::uncertainty::monte_carlo::{
    self as analysis, MonteCarloPlan, MonteCarloResult, Tally,
};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use serde_json::json;

/// Distribution of the onset speed.
#[pyclass(frozen, module = "aerodeck")]
pub struct MonteCarlo(MonteCarloResult);

#[pymethods]
impl MonteCarlo {
    /// Onset of the model itself, m/s; None when it has none.
    #[getter]
    fn nominal_m_s(&self) -> Option<f64> {
        self.0.nominal_m_s
    }

    /// Mean of the onsets, m/s: of the samples that have one (`counts["onsets"]` of `counts["samples"]`), the others are left out.
    #[getter]
    fn mean_m_s(&self) -> Option<f64> {
        self.0.mean_m_s
    }

    /// Standard deviation of the onsets, m/s, of the same samples.
    #[getter]
    fn standard_deviation_m_s(&self) -> Option<f64> {
        self.0.standard_deviation_m_s
    }

    /// Numbers of samples by what became of them: onsets, unstable, stable, not judged to the highest speed, failed.
    #[getter]
    fn counts(&self) -> std::collections::BTreeMap<&'static str, usize> {
        [
            ("samples", self.0.samples),
            ("onsets", self.0.onsets),
            ("unstable", self.0.unstable_at_or_below),
            ("stable", self.0.stable - self.0.not_judged),
            ("not_judged", self.0.not_judged),
            ("failed", self.0.failed),
        ]
        .into()
    }

    /// Speeds below which a part of all sections flutters, m/s, by that part; None where it is above the searched speeds
    /// or depends on samples that failed or could not be judged so far (`ends_m_s` in `to_dict()`), and where the samples are too few
    /// to tell (`too_few_samples` there).
    #[getter]
    fn quantiles(&self) -> Vec<(f64, Option<f64>)> {
        let one = |q: &analysis::Quantile| (q.probability, q.speed_m_s);
        self.0.quantiles.iter().map(one).collect()
    }

    /// Edges (m/s; shape (n + 1,)) and counts (shape (n,)) of the histogram.
    #[getter]
    fn histogram<'py>(
        &self,
        py: Python<'py>,
    ) -> (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<u64>>) {
        let h = &self.0.histogram;
        let edge = |i: usize| h.from_m_s + i as f64 * h.width_m_s;
        let edges = (0..=h.counts.len()).map(edge).collect();
        (
            PyArray1::from_vec(py, edges),
            PyArray1::from_slice(py, &h.counts),
        )
    }

    /// Probability of an onset below the design speed and its confidence interval, as (probability, low, high); None when
    /// no design speed was given.
    #[getter]
    fn probability(&self) -> Option<(f64, f64, f64)> {
        self.0
            .design
            .as_ref()
            .map(|d| (d.probability, d.lower, d.upper))
    }

    /// What the model itself can say of the design speed, as `verdict` of `monte_carlo.json`; None when no design speed was given.
    #[getter]
    fn verdict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.0.verdict)
    }

    /// Everything, as `monte_carlo.json` of the command line holds it.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.0)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        reduced(slf, &slf.get().0)
    }

    #[staticmethod]
    fn _from_state(state: &str) -> PyResult<Self> {
        restored(state).map(Self)
    }

    fn __repr__(&self) -> String {
        format!(
            "MonteCarlo({} samples, {} onsets)",
            self.0.samples, self.0.onsets
        )
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        shown(slf.as_any(), "monte_carlo_html", None)
    }

    /// Draw the histogram with matplotlib; returns the figure.
    #[pyo3(signature = (**keywords))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        keywords: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        shown(slf.as_any(), "monte_carlo_plot", keywords)
    }
}

/// Draw sections and forces at random and find the onset of each, over all cores.
///
/// Parameters
/// ----------
/// section : Section
/// model : Model
/// parameters : dict of str to dict
///     Distributions by the names of the numbers in a study file:
///     `{"torsion.frequency_hz": {"kind": "lognormal", "coefficient_of_variation": 0.05}}`; kinds are normal, lognormal (with
///     standard_deviation or coefficient_of_variation) and uniform (lower, upper).
/// samples, seed : int
///     The same seed gives the same samples on every machine and number of threads.
/// aerodynamic_scatter : float, optional
///     Standard deviation of every coefficient of the force model over its value.
/// design_speed_m_s : float, optional
///     The probability of an onset below this wind speed is asked, m/s.
/// speed_max_m_s : float, optional
///     Highest wind speed searched, m/s.
/// progress : callable, optional
///     Called with (done, total), from any thread.
/// **plan
///     Further keys of the file of a Monte Carlo analysis: `correlation`, `quantiles`, `confidence`, and `aerodynamics` in place of
///     `aerodynamic_scatter`: `{"covariance": "fits/laguerre.uncertainty.json"}`.
///
/// Returns
/// -------
/// MonteCarlo
#[pyfunction]
#[pyo3(signature = (section, model, parameters, *, samples = 10_000, seed = 0, aerodynamic_scatter = None,
    design_speed_m_s = None, speed_max_m_s = None, progress = None, **plan))]
#[allow(clippy::too_many_arguments)] // keywords of Python, not positions
pub fn monte_carlo(
    py: Python<'_>,
    section: &Bound<'_, Section>,
    model: &Bound<'_, Model>,
    parameters: &Bound<'_, PyDict>,
    samples: usize,
    seed: u64,
    aerodynamic_scatter: Option<f64>,
    design_speed_m_s: Option<f64>,
    speed_max_m_s: Option<f64>,
    progress: Option<Py<PyAny>>,
    plan: Option<&Bound<'_, PyDict>>,
) -> PyResult<MonteCarlo> {
    let trained = model.get().trained(Some(section.get()))?;
    let plan = plan.map_or_else(|| Ok(PyDict::new(py)), |p| p.copy())?;
    plan.set_item("samples", samples)?;
    plan.set_item("seed", seed)?;
    for (key, value) in [
        ("design_speed_m_s", design_speed_m_s),
        ("speed_max_m_s", speed_max_m_s),
        ("aerodynamic_scatter", aerodynamic_scatter),
    ] {
        // what is left out is not there: `aerodynamics` may say the same
        let Some(value) = value else { continue };
        if !value.is_finite() {
            return Err(wrong(key, "a finite number", value.to_string()));
        }
        set_default(&plan, key, value)?;
    }
    let plan = plan_of(parameters, &plan)?;
    let work = Work::new(progress);
    let result = work.run(py, || {
        analysis::monte_carlo(&plan, &trained, &|done, total| work.tell(done, total))
    })?;
    judged(py, result.map_err(raised)?, section, model)
}

/// The distribution, with what the model itself can say of the design speed.
fn judged(
    py: Python<'_>,
    mut result: MonteCarloResult,
    section: &Bound<'_, Section>,
    model: &Bound<'_, Model>,
) -> PyResult<MonteCarlo> {
    let (section, model) = (&section.get().0, model.get());
    let speed = result.design.as_ref().map(|d| d.speed_m_s);
    let odd = &result.findings;
    warned(py, odd)?;
    let judge = |speed| detached(py, || verdict_at(section, model, speed, odd));
    result.verdict = speed.map(judge).transpose()?;
    if result.failed + result.not_judged > 0 {
        warn(
            py,
            &format!("{} samples: {}", result.samples, result.counts_in_words()),
        )?;
    }
    Ok(MonteCarlo(result))
}

/// The plan of these distributions, with the keywords of `monte_carlo`.
fn plan_of(
    parameters: &Bound<'_, PyDict>,
    keywords: &Bound<'_, PyDict>,
) -> PyResult<MonteCarloPlan> {
    let py = parameters.py();
    refuse_not_finite("parameters", parameters.as_any())?;
    let plan = keywords.copy()?;
    if plan.contains("parameter")? {
        return Err(wrong(
            "parameter",
            "the distributions as `parameters`",
            "`parameter`".into(),
        ));
    }
    let list = PyList::empty(py);
    for (name, distribution) in parameters {
        let one = PyDict::new(py);
        one.set_item("name", name)?;
        one.set_item("distribution", distribution)?;
        list.append(one)?;
    }
    plan.set_item("parameter", list)?;
    let scatter = plan.get_item("aerodynamic_scatter")?;
    if plan.contains("aerodynamic_scatter")? {
        plan.del_item("aerodynamic_scatter")?;
    }
    if let Some(scatter) = scatter.filter(|s| !s.is_none()) {
        if plan.contains("aerodynamics")? {
            let expected = "`aerodynamics` or `aerodynamic_scatter`";
            return Err(wrong("aerodynamic_scatter", expected, "both".into()));
        }
        let block = PyDict::new(py);
        block.set_item("relative_scatter", scatter)?;
        plan.set_item("aerodynamics", block)?;
    }
    set_default(&plan, "schema", json!(1))?;
    set_default(&plan, "model", json!("model.json"))?;
    from_python("parameters", plan.as_any())
}

/// Answers of the samples `first` to `last`, without the last, on one core: a part of a distribution for
/// `aerodeck.distributed`.
#[pyfunction]
pub fn _monte_carlo_part(
    py: Python<'_>,
    section: &Bound<'_, Section>,
    model: &Bound<'_, Model>,
    parameters: &Bound<'_, PyDict>,
    keywords: &Bound<'_, PyDict>,
    first: usize,
    last: usize,
) -> PyResult<String> {
    let trained = model.get().trained(Some(section.get()))?;
    let plan = plan_of(parameters, keywords)?;
    let samples = || analysis::tally(&plan, &trained, first..last, &|_, _| {});
    let part = py.detach(|| on_threads(Some(1), samples).and_then(|part| part));
    json_text(&part.map_err(raised)?)
}

/// The distribution of which these are all parts, in their order.
#[pyfunction]
pub fn _monte_carlo_of(
    py: Python<'_>,
    section: &Bound<'_, Section>,
    model: &Bound<'_, Model>,
    parameters: &Bound<'_, PyDict>,
    keywords: &Bound<'_, PyDict>,
    parts: Vec<String>,
) -> PyResult<MonteCarlo> {
    let trained = model.get().trained(Some(section.get()))?;
    let plan = plan_of(parameters, keywords)?;
    let parts = parts.iter().map(|part| restored(part));
    let parts = parts.collect::<PyResult<Vec<Tally>>>()?;
    let result = analysis::summarise(&plan, &trained, parts);
    judged(py, result.map_err(raised)?, section, model)
}
