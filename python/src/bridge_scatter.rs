//! `BridgeScatter`: the onset of a bridge whose modes and forces scatter.

use crate::convert::{Parts, parts};
use crate::error::wrong;
use aerodeck::study::bridge::DerivativeScatter;
use aerodeck::uncertainty::SampledOnsets;
use numpy::PyArray1;
use pyo3::prelude::*;

/// Standard deviation over the mean, or the word for the covariance of the fits.
///
/// # Errors
/// What is neither, and a word that is none.
pub fn derivative_scatter(stated: &Bound<'_, PyAny>) -> PyResult<DerivativeScatter> {
    if let Ok(part) = stated.extract() {
        return Ok(DerivativeScatter::Relative(part));
    }
    let word: String = stated.extract()?;
    word.parse().map_err(|_| {
        let expected = "a standard deviation over the mean, or measured";
        wrong("derivatives", expected, format!("`{word}`"))
    })
}

/// Onsets of a bridge whose frequencies, damping and self-excited forces scatter.
#[pyclass(frozen, module = "aerodeck", get_all)]
#[derive(FromPyObject)]
pub struct BridgeScatter {
    /// Onset of each sample that has one, m/s, rising; shape (k,).
    speeds_m_s: Py<PyArray1<f64>>,
    /// Mean, m/s.
    mean_m_s: f64,
    /// Standard deviation, m/s.
    standard_deviation_m_s: f64,
    /// 95 % of the samples lie between these, m/s.
    interval_m_s: (f64, f64),
    /// Samples without an onset up to the highest wind speed; they are not in the numbers above.
    without_onset: usize,
}

impl BridgeScatter {
    pub fn new(py: Python<'_>, onsets: &SampledOnsets) -> Self {
        Self {
            speeds_m_s: PyArray1::from_slice(py, &onsets.speeds_m_s).unbind(),
            mean_m_s: onsets.mean_m_s,
            standard_deviation_m_s: onsets.standard_deviation_m_s,
            interval_m_s: onsets.interval_m_s.into(),
            without_onset: onsets.without_onset,
        }
    }
}

#[pymethods]
impl BridgeScatter {
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Parts<'py>> {
        parts(slf)
    }

    #[staticmethod]
    fn _from_parts(parts: Self) -> Self {
        parts
    }

    fn __repr__(&self) -> String {
        format!(
            "BridgeScatter({:.3} m/s, standard deviation {:.3} m/s, 95 % between {:.3} and {:.3} m/s, {} without onset)",
            self.mean_m_s,
            self.standard_deviation_m_s,
            self.interval_m_s.0,
            self.interval_m_s.1,
            self.without_onset
        )
    }
}
