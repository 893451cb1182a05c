//! `fit_laguerre`, `fit_rational`: from derivatives or records to models.

use crate::convert::{from_python, set_default};
use crate::derivatives::Derivatives;
use crate::error::{raised, wrong};
use crate::model::Model;
use crate::records::Records;
use crate::work::Work;
use aerodeck::aerodynamics::derivatives::DerivativeTable;
use aerodeck::files::derivatives::embedded;
use aerodeck::identification::{Fitted, FrequencyFit, TimeFit};
use aerodeck::plausibility::Finding;
use aerodeck::section::Dof;
use aerodeck::trained_model::Provenance;
use aerodeck::uncertainty::{FormEnsemble, ModelOfData, ModelUncertainty};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};
use serde_json::{Value, json};

/// Fit continuous Laguerre filters with feed-through to derivatives (frequency domain) or records (time domain).
///
/// Parameters
/// ----------
/// data : Derivatives or Records
/// filters : int, optional
///     Filters of each motion's bank; left out, as many as the data determine, three to five under constraints (four from records with sway).
/// lateral : bool
///     Whether sway is part of the model; for records what they hold.
/// poles : sequence of float, optional
///     Fixed poles; left out, they are searched.
/// progress : callable, optional
///     Called with (done, total), from any thread.
/// **options
///     Further keys of `table` or `records` of a `[[model]]` in a study file: `weights`, `constraints`, `own`, …
#[pyfunction]
#[pyo3(signature = (data, filters = None, *, lateral = false, poles = None, progress = None, **options))]
pub fn fit_laguerre(
    py: Python<'_>,
    data: &Bound<'_, PyAny>,
    filters: Option<usize>,
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
        // of Python: JSON would lose which are not finite
        options.set_item("poles", [("fixed", poles)].into_py_dict(py)?)?;
    }
    let work = Work::new(progress);
    if let Ok(table) = data.cast::<Derivatives>() {
        let dofs: &[Dof] = if lateral { &Dof::THREE } else { &Dof::TWO };
        let fit = from_python("options", options.as_any())?;
        let Derivatives(table, findings) = table.get();
        let fitted = to_table(py, table, dofs, &fit, &work)?;
        Ok(of_odd_data(fitted, findings))
    } else if let Ok(records) = data.cast::<Records>() {
        let fit = from_python("options", options.as_any())?;
        let records = records.get();
        let fitted = to_records(py, records, &fit, &work)?;
        Ok(of_odd_data(fitted, &records.1))
    } else {
        let found = data.get_type().name()?.to_string();
        Err(wrong("data", "Derivatives or Records", found))
    }
}

/// The model with what is odd about its data, which every answer by it and the file of the model hold.
fn of_odd_data(mut model: Model, findings: &[Finding]) -> Model {
    let odd = findings.iter().map(ToString::to_string);
    model.provenance.notes.extend(odd);
    model.findings = findings.to_vec();
    model
}

fn to_table(
    py: Python<'_>,
    table: &DerivativeTable,
    dofs: &[Dof],
    fit: &FrequencyFit,
    work: &Work,
) -> PyResult<Model> {
    table.require(dofs).map_err(raised)?;
    let found = work.run(py, || {
        let samples = table.samples(dofs);
        let found = ModelOfData::of_table(&samples, dofs, fit, Some(&table.name));
        work.tell(1, 1);
        found
    })?;
    let found = found.map_err(raised)?;
    let header = &table.header;
    let built_in = embedded::deck(&table.name).is_ok_and(|deck| deck == *table);
    // the notice has to go wherever the figures go
    let licence = match built_in {
        true => embedded::LICENCE.to_owned(),
        false => header.licence.clone(),
    };
    let source = format!("{}: {}", table.name, header.source);
    Ok(model(found, [source, licence, table.name.clone()]))
}

fn to_records(py: Python<'_>, records: &Records, fit: &TimeFit, work: &Work) -> PyResult<Model> {
    let progress = |done, total| work.tell(done, total);
    let found = work.run(py, || {
        let sources = records.sources();
        let header = sources.first().map(|r| r.header());
        let deck = header.and_then(|h| embedded::names().find(|deck| h.name.starts_with(deck)));
        let dofs = header.map_or(&[][..], |h| &h.dofs);
        ModelOfData::of_records(&sources, dofs, fit, deck, &progress)
    })?;
    let found = found.map_err(raised)?;
    let first = records.0.first().map(|r| &r.header);
    let source = first.map_or(String::new(), |h| h.source.clone());
    let licence = first.map_or(String::new(), |h| h.licence.clone());
    Ok(model(found, [source, licence, "deck".to_owned()]))
}

/// The model with what the data leave open, and where it comes from.
fn model(found: ModelOfData, [source, licence, name]: [String; 3]) -> Model {
    let Fitted { model, mut report } = found.fitted;
    let (known, forms) = (found.estimate, found.forms);
    if let Ok(known) = &known {
        known.enter(&mut report);
        report
            .notes
            .extend(known.speeds.iter().map(|s| s.describe()));
    }
    let known = known.and_then(|known| {
        let forms = FormEnsemble::or_noted(forms, &mut report)?;
        ModelUncertainty::of_data(known, forms, report.tested_range)
    });
    Model {
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
        uncertainty: known.map(Box::new).map_err(|e| e.to_string()),
        stored: None,
        name,
        findings: Vec::new(),
    }
}
