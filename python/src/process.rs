//! `process`: from the load cells of a campaign to records and derivatives.

use crate::convert::{Parts, from_python, parts, to_python};
use crate::derivatives::Derivatives;
use crate::error::raised;
use crate::records::Records;
use crate::work::Work;
use aerodeck::aerodynamics::derivatives::TableHeader;
use aerodeck::aerodynamics::derivatives::notation::Convention;
use aerodeck::identification::derivatives::{DerivativeOptions, identify_derivatives};
use aerodeck::plausibility::{FindingSeverity, of_table};
use aerodeck::wind_tunnel::RecordSource;
use aerodeck::wind_tunnel::campaign::Campaign;
use aerodeck::wind_tunnel::processing::{self, ProcessingOptions};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Records and derivatives of a campaign.
#[pyclass(frozen, module = "aerodeck", get_all)]
#[derive(FromPyObject)]
pub struct Processing {
    /// Self-excited forces, one record per run.
    records: Py<Records>,
    /// The table of derivatives.
    derivatives: Py<Derivatives>,
    /// Every derivative at every test point with its standard error, as dicts.
    estimates: Py<PyAny>,
    /// What was done with each run, as dicts and lists.
    report: Py<PyAny>,
    /// What is odd about the files and runs.
    warnings: Vec<String>,
}

#[pymethods]
impl Processing {
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Parts<'py>> {
        parts(slf)
    }

    #[staticmethod]
    fn _from_parts(parts: Self) -> Self {
        parts
    }

    fn __repr__(&self) -> String {
        let (records, warnings) = (self.records.get().0.len(), self.warnings.len());
        format!("Processing({records} records, {warnings} warnings)")
    }
}

/// Process the raw runs of a campaign file into records and derivatives.
///
/// Parameters
/// ----------
/// campaign : str or os.PathLike
///     The campaign file (.toml).
/// progress : callable, optional
///     Called with (runs done, runs), from any thread.
/// **options
///     Options of processing: `lag_s`, `low_pass`, …
///
/// Returns
/// -------
/// Processing
#[pyfunction]
#[pyo3(signature = (campaign, *, progress = None, **options))]
pub fn process(
    py: Python<'_>,
    campaign: PathBuf,
    progress: Option<Py<PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Processing> {
    let options: ProcessingOptions = match options {
        Some(options) => from_python("options", options.as_any())?,
        None => ProcessingOptions::default(),
    };
    let work = Work::new(progress);
    let done = work.run(py, || {
        let raw = Campaign::read(&campaign)?.load()?;
        let warnings = raw.words(FindingSeverity::Note);
        let mut doubts = raw.words(FindingSeverity::Doubt);
        let processed = processing::process(&raw, &options, &|done, all| work.tell(done, all))?;
        let sources: Vec<&dyn RecordSource> = processed
            .records
            .iter()
            .map(|r| r as &dyn RecordSource)
            .collect();
        doubts.extend(processed.report.doubts());
        let found = identify_derivatives(&sources, &DerivativeOptions::default())?;
        doubts.extend(found.contradictions());
        let header = TableHeader {
            source: raw.source.clone(),
            licence: raw.licence.clone(),
            model_length_m: Some(raw.rig.model_length_m),
            doubts: doubts.clone(),
            ..TableHeader::default()
        };
        let table = found.table(&raw.section, header)?;
        let of_runs = processed.report.warnings();
        let warnings = [doubts, warnings, of_runs, found.warnings.clone()].concat();
        let odd = of_table(&table, &Convention::default());
        aerodeck::Result::Ok((processed, found, table, odd, warnings))
    })?;
    let (processed, found, table, odd, warnings) = done.map_err(raised)?;
    Ok(Processing {
        estimates: to_python(py, &found.estimates)?.unbind(),
        report: to_python(py, &processed.report)?.unbind(),
        records: Py::new(py, Records(processed.records, odd.clone()))?,
        derivatives: Py::new(py, Derivatives(table, odd))?,
        warnings,
    })
}
