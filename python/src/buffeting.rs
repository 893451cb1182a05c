//! `Buffeting`: response of a whole bridge to turbulence.

use crate::convert::{Parts, parts, rows, shown, to_python};
use aerodeck::study::bridge::BridgeBuffeting;
use numpy::PyArray2;
use pyo3::prelude::*;

/// Response of a bridge to turbulence: vertical (m), lateral (m) and rotation (rad) at n nodes, by two ways.
#[pyclass(frozen, module = "aerodeck", get_all)]
#[derive(FromPyObject)]
pub struct Buffeting {
    /// Mean wind speed, m/s.
    speed_m_s: f64,
    /// Names of the nodes.
    nodes: Vec<String>,
    /// Root mean square, by spectra; shape (n, 3).
    rms: Py<PyArray2<f64>>,
    /// Root mean square, by records in time; shape (n, 3). `None` where the models grow and the tables do not.
    rms_of_records: Option<Py<PyArray2<f64>>>,
    /// Standard error of `rms_of_records`; shape (n, 3).
    standard_error: Option<Py<PyArray2<f64>>>,
    /// Root mean square by spectra with the models that are stepped in time, over `rms`, less 1; shape (n, 3). `None`
    /// without tables.
    model_change: Option<Py<PyArray2<f64>>>,
    /// Mean frequency of upward crossings of the mean, Hz; shape (n, 3).
    crossing_frequency_hz: Py<PyArray2<f64>>,
    /// Expected greatest departure over the root mean square in 600 s, or in `duration_s` where that is stated, by spectra; shape (n, 3).
    expected_peak_factor: Py<PyArray2<f64>>,
    /// The same by records; shape (n, 3).
    peak_factor: Option<Py<PyArray2<f64>>>,
    _all: Py<PyAny>,
}

impl Buffeting {
    /// The response that was found.
    pub fn new(py: Python<'_>, found: &BridgeBuffeting) -> PyResult<Self> {
        let array = |values: &[[f64; 3]]| rows(py, 3, values).map(Bound::unbind);
        let (frequency, time) = (&found.frequency, found.time.as_ref());
        let change = found.models.as_ref().and_then(|m| m.change.as_deref());
        Ok(Self {
            speed_m_s: frequency.speed_m_s,
            nodes: found.nodes.clone(),
            rms: array(&frequency.rms)?,
            rms_of_records: time.map(|t| array(&t.rms)).transpose()?,
            standard_error: time.map(|t| array(&t.standard_error)).transpose()?,
            model_change: change.map(array).transpose()?,
            crossing_frequency_hz: array(&frequency.crossing_frequency_hz)?,
            expected_peak_factor: array(&found.expected_peak_factor)?,
            peak_factor: time.map(|t| array(&t.peak_factor)).transpose()?,
            _all: to_python(py, found)?.unbind(),
        })
    }
}

#[pymethods]
impl Buffeting {
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Parts<'py>> {
        parts(slf)
    }

    #[staticmethod]
    fn _from_parts(parts: Self) -> Self {
        parts
    }

    /// Everything, as `bridge_buffeting.json` of the command line holds it.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("copy")?
            .call_method1("deepcopy", (self._all.bind(py),))
    }

    fn __repr__(&self) -> String {
        format!(
            "Buffeting({} m/s, nodes {})",
            self.speed_m_s,
            self.nodes.join(", ")
        )
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        shown(slf.as_any(), "buffeting_html", None)
    }
}
