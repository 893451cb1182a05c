//! `onsets`: one model on many sections, from arrays.

use crate::convert::{Parts, framed, list, parts};
use crate::error::{raised, wrong};
use crate::model::Model;
use crate::section::{Section, place};
use crate::work::{Work, on_threads};
use aerodeck::flutter::{SweepOutcome, SweptOnset};
use aerodeck::section::SectionModel;
use aerodeck::uncertainty::monte_carlo::{SectionProperty, many_onsets};
use numpy::{PyArray1, PyUntypedArrayMethods};
use pyo3::prelude::*;

/// Onsets of many sections, one entry each.
#[pyclass(frozen, module = "aerodeck", get_all)]
#[derive(FromPyObject)]
pub struct Onsets {
    /// Onset speeds, m/s; NaN where there is none up to `searched_to_m_s`, and where that cannot be judged (see `judged`); shape (n,).
    speed_m_s: Py<PyArray1<f64>>,
    /// Frequencies at the onset, Hz; shape (n,).
    frequency_hz: Py<PyArray1<f64>>,
    /// Whether the data reach the onset; shape (n,).
    tested: Py<PyArray1<bool>>,
    /// Whether a motion grows already at the lowest speed that could be judged, which then stands for the onset; shape (n,).
    unstable: Py<PyArray1<bool>>,
    /// Whether there is an answer: an onset, or none up to the highest speed searched; False where the data end before; shape (n,).
    judged: Py<PyArray1<bool>>,
    /// Highest wind speed searched, m/s.
    searched_to_m_s: f64,
}

#[pymethods]
impl Onsets {
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Parts<'py>> {
        parts(slf)
    }

    #[staticmethod]
    fn _from_parts(parts: Self) -> Self {
        parts
    }

    /// The onsets as a pandas DataFrame, a row for every section.
    fn to_frame<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        framed(slf.as_any(), "onsets_frame", None)
    }

    fn __len__(&self, py: Python<'_>) -> usize {
        self.speed_m_s.bind(py).len()
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        format!("Onsets({} sections)", self.__len__(py))
    }
}

/// Find the onsets of one model on many sections, over all cores.
///
/// Parameters
/// ----------
/// section : Section
///     What is not varied.
/// model : Model
/// values : dict of str to array or sequence of n numbers, or pandas.DataFrame of such columns
///     Numbers of the section by their names in a study file: `"vertical.mass_kg_m"`, `"torsion.frequency_hz"`, …
/// speed_max_m_s : float, optional
///     Highest wind speed searched, m/s.
/// threads : int, optional
///     Threads that compute; left out, one for each core. The results are the same.
/// progress : callable, optional
///     Called with (done, total), from any thread.
///
/// Returns
/// -------
/// Onsets
#[pyfunction]
#[pyo3(signature = (section, model, values, *, speed_max_m_s = None, threads = None, progress = None))]
#[allow(clippy::too_many_arguments)] // keywords of Python, not positions
pub fn onsets(
    py: Python<'_>,
    section: &Bound<'_, Section>,
    model: &Bound<'_, Model>,
    values: &Bound<'_, PyAny>,
    speed_max_m_s: Option<f64>,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Onsets> {
    let trained = model.get().trained(Some(section.get()))?;
    let mut varied: Vec<(SectionProperty, Vec<f64>)> = Vec::new();
    // what has names and arrays: a dict, any other mapping, a DataFrame
    let entries = values.call_method0("items").map_err(|_| {
        let expected = "a dict or DataFrame: numbers of the section by their names";
        wrong("values", expected, values.get_type().to_string())
    })?;
    for entry in entries.try_iter()? {
        let (name, array): (Bound<'_, PyAny>, Bound<'_, PyAny>) = entry?.extract()?;
        let name: String = name.extract().map_err(|_| {
            let expected = "names of numbers of the section, such as \"torsion.frequency_hz\"";
            wrong("values", expected, name.to_string())
        })?;
        place(&name, &mut trained.section.clone())?;
        let parameter = SectionProperty::named(&name).map_err(raised)?;
        varied.push((parameter, list(&name, &array)?));
    }
    let count = varied.first().map_or(1, |v| v.1.len());
    if let Some((_, other)) = varied.iter().find(|v| v.1.len() != count) {
        let found = format!("{count} and {}", other.len());
        return Err(wrong("values", "arrays of one length", found));
    }
    let make = |i: usize, section: &mut SectionModel| {
        for (parameter, values) in &varied {
            if let Some(place) = parameter.place(section) {
                *place = values[i];
            }
        }
    };
    let limit = speed_max_m_s.unwrap_or(trained.experiment.onset_search_limit_m_s);
    let work = Work::new(progress);
    let found = work.run(py, || {
        on_threads(threads, || {
            many_onsets(&trained, count, &make, limit, &|done, all| {
                work.tell(done, all)
            })
        })
    })?;
    let found = found.and_then(|found| found).map_err(raised)?;
    let are = |is: &dyn Fn(&SweepOutcome) -> bool| {
        let all = found.iter().map(is).collect();
        PyArray1::from_vec(py, all).unbind()
    };
    let numbers = |pick: fn(&SweptOnset) -> f64| {
        let number = |outcome: &SweepOutcome| outcome.onset().map_or(f64::NAN, pick);
        let all = found.iter().map(number).collect();
        PyArray1::from_vec(py, all).unbind()
    };
    Ok(Onsets {
        judged: are(&|outcome| outcome.is_judged_to(limit)),
        searched_to_m_s: limit,
        tested: are(&|o| matches!(o, SweepOutcome::Onset(at) if at.in_tested_range)),
        unstable: are(&|o| matches!(o, SweepOutcome::UnstableAtOrBelow(_))),
        speed_m_s: numbers(|at| at.speed_m_s),
        frequency_hz: numbers(|at| at.frequency_hz),
    })
}
