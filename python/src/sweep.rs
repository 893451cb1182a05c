//! `sweep`: frequency and damping of every mode over the wind speed.

use crate::convert::{Parts, dof_names, framed, list, parts, rows, shown};
use crate::error::raised;
use crate::model::Model;
use crate::section::{Section, usual_range};
use crate::work::Work;
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::flutter::{FlutterCurves, ModePoint, trace_modes_watched};
use numpy::{PyArray1, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Frequencies and damping ratios of the modes over wind speed.
#[pyclass(frozen, module = "aerodeck", get_all)]
#[derive(FromPyObject)]
pub struct Sweep {
    /// Wind speeds, m/s; shape (n,).
    speed_m_s: Py<PyArray1<f64>>,
    /// Frequencies, Hz; shape (n, modes); NaN where a mode cannot be judged.
    frequency_hz: Py<numpy::PyArray2<f64>>,
    /// Damping ratios; shape (n, modes); negative when the motion grows.
    damping_ratio: Py<numpy::PyArray2<f64>>,
    /// Whether the data reach the reduced frequency of the mode; shape (n, modes).
    tested: Py<numpy::PyArray2<bool>>,
    /// Names of the modes: by the motion each begins as in still air, of a bridge by number.
    modes: Vec<String>,
    /// Why a mode ends before the highest speed; None when none does.
    ended: Option<String>,
}

#[pymethods]
impl Sweep {
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Parts<'py>> {
        parts(slf)
    }

    #[staticmethod]
    fn _from_parts(parts: Self) -> Self {
        parts
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let count = self.speed_m_s.bind(py).len();
        Ok(format!(
            "Sweep({count} wind speeds, modes {})",
            self.modes.join(", ")
        ))
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        shown(slf.as_any(), "sweep_html", None)
    }

    /// The curves as a pandas DataFrame: a row for every wind speed and mode.
    fn to_frame<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        framed(slf.as_any(), "sweep_frame", None)
    }

    /// The curves as an xarray Dataset over wind speed and mode.
    fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        framed(slf.as_any(), "sweep_dataset", None)
    }

    /// Draw frequency and damping over wind speed with matplotlib; returns the figure.
    #[pyo3(signature = (**keywords))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        keywords: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        shown(slf.as_any(), "sweep_plot", keywords)
    }
}

/// Follow the modes of a section in a trained model over wind speed.
///
/// Parameters
/// ----------
/// section : Section
/// model : Model
/// speeds_m_s : array of shape (n,), optional
///     Rising wind speeds, m/s; left out, 120 up to well beyond the flat plate's onset.
///
/// Returns
/// -------
/// Sweep
#[pyfunction]
#[pyo3(signature = (section, model, speeds_m_s = None))]
pub fn sweep(
    py: Python<'_>,
    section: &Bound<'_, Section>,
    model: &Bound<'_, Model>,
    speeds_m_s: Option<&Bound<'_, PyAny>>,
) -> PyResult<Sweep> {
    let (section, model) = (&section.get().0, model.get());
    let speeds: Vec<f64> = match speeds_m_s {
        Some(speeds) => list("speeds_m_s", speeds)?,
        None => usual_range(section).curve_speeds_m_s(),
    };
    let work = Work::new(None);
    let curves = work.run(py, || {
        let structure = section.structure()?;
        let coupled = CoupledSection::with_model(&structure, &model.model)?;
        let watch = || work.check();
        let curves = trace_modes_watched(&model.name, &coupled, &speeds, &watch)?;
        aerodeck::Result::Ok(curves.marked(section.width_m, Some(model.tested)))
    })?;
    let modes = dof_names(&section.dofs());
    let modes = modes.into_iter().map(str::to_owned).collect();
    Sweep::new(py, &curves.map_err(raised)?, speeds, modes)
}

impl Sweep {
    /// Curves as arrays over `speeds`, at which they were traced.
    pub fn new(
        py: Python<'_>,
        curves: &FlutterCurves,
        speeds: Vec<f64>,
        modes: Vec<String>,
    ) -> PyResult<Self> {
        let count = curves.branches.len();
        // a branch may begin later than the first speed and end before the last: speeds are matched bit for bit
        let at = |speed: f64, mode: usize| {
            let points = &curves.branches[mode].points;
            let found = points.binary_search_by(|p| p.speed_m_s.total_cmp(&speed));
            found.ok().map(|i| &points[i])
        };
        let array = |pick: fn(&ModePoint) -> f64| {
            let row = |speed: &f64| {
                let value = |mode| at(*speed, mode).map_or(f64::NAN, pick);
                (0..count).map(value).collect::<Vec<_>>()
            };
            rows(py, count, speeds.iter().map(row))
        };
        let known = |p: &ModePoint| p.in_tested_range.unwrap_or(false);
        let tested = |speed: &f64| {
            let one = |mode| at(*speed, mode).is_some_and(known);
            (0..count).map(one).collect::<Vec<bool>>()
        };
        let tested: Vec<Vec<bool>> = speeds.iter().map(tested).collect();
        Ok(Self {
            frequency_hz: array(|p| p.frequency_hz)?.unbind(),
            damping_ratio: array(|p| p.damping_ratio)?.unbind(),
            tested: numpy::PyArray2::from_vec2(py, &tested)?.unbind(),
            modes,
            ended: curves.ended.clone(),
            speed_m_s: PyArray1::from_vec(py, speeds).unbind(),
        })
    }
}
