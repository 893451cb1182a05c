//! `fit_laguerre`, `fit_rational`: from derivatives or records to models.

use crate::convert::{from_python, set_default};
use crate::derivatives::Derivatives;
use crate::error::{raised, wrong};
use crate::model::Model;
use crate::records::Records;
use crate::work::Work;
use aerodeck::identification::{FitReport, FrequencyFit, TimeFit, fit_records, fit_table};
use aerodeck::section::Dof;
use aerodeck::trained_model::{self, Provenance};
use aerodeck::uncertainty::{CoefficientUncertainty, record_uncertainty, table_uncertainty};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::{Value, json};

type Fitted = (
    trained_model::Model,
    FitReport,
    Result<CoefficientUncertainty, String>,
);

/// Fit continuous Laguerre filters with feed-through to derivatives (frequency domain) or records (time domain).
///
/// Parameters
/// ----------
/// data : Derivatives or Records
/// filters : int
///     Filters of each motion's bank.
/// lateral : bool
///     Whether sway is part of the model; for records what they hold.
/// poles : sequence of float, optional
///     Fixed poles; left out, they are searched.
/// progress : callable, optional
///     Called with (done, total), from any thread.
/// **options
///     Further keys of `table` or `records` of a `[[model]]` in a study file: `weights`, `constraints`, `own`, …
#[pyfunction]
#[pyo3(signature = (data, filters = 3, *, lateral = false, poles = None, progress = None, **options))]
pub fn fit_laguerre(
    py: Python<'_>,
    data: &Bound<'_, PyAny>,
    filters: usize,
    lateral: bool,
    poles: Option<Vec<f64>>,
    progress: Option<Py<PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Model> {
    let form = json!({ "kind": "laguerre", "filters": filters });
    fit(py, data, form, lateral, poles, progress, options)
}

/// Fit rational functions in Roger's form to derivatives (frequency domain) or records (time domain).
///
/// Parameters
/// ----------
/// data : Derivatives or Records
/// lags : int
///     Lag terms.
/// added_mass : bool
///     Whether forces may follow accelerations.
/// lateral, poles, progress, **options
///     As in `fit_laguerre`.
#[pyfunction]
#[pyo3(signature = (data, lags = 2, *, added_mass = true, lateral = false, poles = None, progress = None, **options))]
#[allow(clippy::too_many_arguments)] // keywords of Python, not positions
pub fn fit_rational(
    py: Python<'_>,
    data: &Bound<'_, PyAny>,
    lags: usize,
    added_mass: bool,
    lateral: bool,
    poles: Option<Vec<f64>>,
    progress: Option<Py<PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Model> {
    let form = json!({ "kind": "rational", "lags": lags, "added_mass": added_mass });
    fit(py, data, form, lateral, poles, progress, options)
}

fn fit(
    py: Python<'_>,
    data: &Bound<'_, PyAny>,
    form: Value,
    lateral: bool,
    poles: Option<Vec<f64>>,
    progress: Option<Py<PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<Model> {
    let options = options.map_or_else(|| Ok(PyDict::new(py)), |o| o.copy())?;
    set_default(&options, "form", form)?;
    if let Some(poles) = poles {
        set_default(&options, "poles", json!({ "fixed": poles }))?;
    }
    let work = Work::new(progress);
    let (fitted, source, licence, name) = if let Ok(table) = data.cast::<Derivatives>() {
        let table = &table.get().0;
        let fit: FrequencyFit = from_python("options", options.as_any())?;
        let dofs: &[Dof] = if lateral { &Dof::THREE } else { &Dof::TWO };
        table.require(dofs).map_err(raised)?;
        let fitted = work.run(py, || {
            let fitted = from_table(table.samples(dofs), dofs, &fit);
            work.tell(1, 1);
            fitted
        })?;
        let header = &table.header;
        (
            fitted,
            header.source.clone(),
            header.licence.clone(),
            table.name.clone(),
        )
    } else if let Ok(records) = data.cast::<Records>() {
        let records = records.get();
        let fit: TimeFit = from_python("options", options.as_any())?;
        let fitted = work.run(py, || from_records(records, &fit, &work))?;
        let of = |pick: fn(&aerodeck::wind_tunnel::RecordHeader) -> &String| {
            records
                .0
                .first()
                .map_or(String::new(), |r| pick(&r.header).clone())
        };
        (
            fitted,
            of(|h| &h.source),
            of(|h| &h.licence),
            "deck".to_owned(),
        )
    } else {
        let found = data.get_type().name()?.to_string();
        return Err(wrong("data", "Derivatives or Records", found));
    };
    let (model, report, uncertainty) = fitted.map_err(raised)?;
    Ok(Model {
        tested: report.tested_range,
        provenance: Provenance {
            source,
            licence,
            method: report.method.clone(),
            aerodeck_version: env!("CARGO_PKG_VERSION").to_owned(),
            notes: report.notes.clone(),
        },
        model,
        report: Some(report),
        uncertainty,
        stored: None,
        name,
    })
}

fn from_table(
    samples: Vec<aerodeck::aerodynamics::derivatives::TransferSample>,
    dofs: &[Dof],
    fit: &FrequencyFit,
) -> aerodeck::Result<Fitted> {
    let (model, mut report) = fit_table(&samples, dofs, fit)?;
    let known = table_uncertainty(&samples, dofs, fit, &report);
    enter(&known, &mut report);
    Ok((model, report, known.map_err(|e| e.to_string())))
}

fn from_records(records: &Records, fit: &TimeFit, work: &Work) -> aerodeck::Result<Fitted> {
    let sources = records.sources();
    let progress = |p: aerodeck::identification::Progress| {
        work.tell(
            (p.pass - 1) * p.records + p.records_done,
            p.passes * p.records,
        );
    };
    let (model, mut report) = fit_records(&sources, fit, &progress)?;
    let known = record_uncertainty(&sources, fit, &report, &|_| work.check());
    enter(&known, &mut report);
    Ok((model, report, known.map_err(|e| e.to_string())))
}

fn enter(known: &aerodeck::Result<CoefficientUncertainty>, report: &mut FitReport) {
    if let Ok(known) = known {
        known.enter(report);
    }
}
