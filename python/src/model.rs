//! `Model`: a trained model of the self-excited forces.

use crate::convert::{Reduced, dof_names, reduced, refuse_unreal, restored, shown, to_python};
use crate::error::{raised, wrong};
use crate::section::Section;
use aerodeck::aerodynamics::{Realizable, Transfer};
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::flutter::{divergence_with_forces, find_onset};
use aerodeck::identification::FitReport;
use aerodeck::plausibility::{Finding, of_model};
use aerodeck::section::SectionModel;
use aerodeck::study::{ExportBlock, uncertainty_beside};
use aerodeck::trained_model::{self, Experiment, Provenance, TrainedModel};
use aerodeck::uncertainty::{CoefficientUncertainty, Design, FormEnsemble, ModelUncertainty};
use aerodeck::units::{ReducedFrequency, ReducedFrequencyRange};
use nalgebra::Complex;
use numpy::{PyArray1, PyArray3, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// A model of the self-excited forces, `q̂ = G(K) r̂`, with the account of its fit.
#[pyclass(frozen, module = "aerodeck")]
pub struct Model {
    /// The forces.
    pub model: trained_model::Model,
    /// Where the data were taken.
    pub tested: ReducedFrequencyRange,
    pub provenance: Provenance,
    /// `None` for a model that was read from a file.
    pub report: Option<FitReport>,
    /// How far the data leave coefficients and onsets open, or why that is not known.
    pub uncertainty: Result<Box<ModelUncertainty>, String>,
    /// Section and experiment of the file it was read from.
    pub stored: Option<(SectionModel, Experiment)>,
    pub name: String,
    /// What is odd about the data it was fitted to.
    pub findings: Vec<Finding>,
}

#[pymethods]
impl Model {
    /// Read `model.json` as `save` and `aerodeck train` write it, with the covariance that `train` leaves beside it.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        let trained = TrainedModel::read(&path).map_err(raised)?;
        let uncertainty = uncertainty_beside(&path, &trained).map_err(raised)?;
        Ok(Self {
            model: trained.model,
            tested: trained.tested_range,
            provenance: trained.provenance,
            report: None,
            uncertainty,
            stored: Some((trained.section, trained.experiment)),
            name: trained.name,
            findings: Vec::new(),
        })
    }

    /// Write `model.json`: the model with the section it is coupled with (left out, that of the file it came from).
    #[pyo3(signature = (path, section = None))]
    fn save(&self, path: PathBuf, section: Option<&Bound<'_, Section>>) -> PyResult<()> {
        let trained = self.exported(section.map(|s| s.get()))?;
        let text = trained.to_json().map_err(raised)?;
        std::fs::write(&path, text).map_err(|e| raised(aerodeck::Error::io(&path, e)))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let m = slf.get();
        let known = m.uncertainty.clone().map(|known| {
            let ModelUncertainty {
                coefficients,
                forms,
                ..
            } = *known;
            // what is written of the coefficients leaves their data out
            let data = coefficients.data.clone();
            (coefficients, data, forms)
        });
        let of_data = (&m.tested, &m.provenance, &m.report, &known);
        reduced(slf, &(&m.model, of_data, &m.stored, &m.name, &m.findings))
    }

    #[staticmethod]
    fn _from_state(state: &str) -> PyResult<Self> {
        let (model, of_data, stored, name, findings) = restored(state)?;
        let (tested, provenance, report, known) = of_data;
        type Known = (CoefficientUncertainty, Option<Design>, Option<FormEnsemble>);
        let known: Result<Known, String> = known;
        let of_data = |(mut coefficients, data, forms): Known| {
            coefficients.data = data;
            ModelUncertainty::of_data(coefficients, forms, tested).map_err(|e| e.to_string())
        };
        Ok(Self {
            model,
            tested,
            provenance,
            report,
            uncertainty: known.and_then(of_data).map(Box::new),
            stored,
            name,
            findings,
        })
    }

    /// The transfer matrix at reduced frequencies K = ωB/V.
    ///
    /// Parameters
    /// ----------
    /// K : float or array of shape (n,)
    ///
    /// Returns
    /// -------
    /// ndarray of complex, shape (n, d, d)
    ///     Force over motion, both without dimension: F/(½ρV²B), M/(½ρV²B²) over (y/B, x/B, θ).
    #[allow(non_snake_case)] // the field's own letter
    fn transfer<'py>(
        &self,
        py: Python<'py>,
        K: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray3<Complex<f64>>>> {
        refuse_unreal("K", K)?;
        let array = py
            .import("numpy")?
            .call_method1("asarray", (K, "float64"))?;
        let values: PyReadonlyArrayDyn<'py, f64> = array.extract()?;
        let n = self.model.dofs().len();
        let mut flat = Vec::with_capacity(values.as_array().len() * n * n);
        for k in values.as_array() {
            let k = ReducedFrequency::from_full_width(*k);
            let g = self.model.transfer(k).map_err(raised)?;
            flat.extend((0..n * n).map(|at| g[(at / n, at % n)]));
        }
        let count = flat.len() / (n * n);
        PyArray1::from_vec(py, flat).reshape([count, n, n])
    }

    /// The account of the fit as dicts and lists: residuals, poles, condition, coefficients with standard errors, active
    /// constraints, notes. None for a model that was read from a file.
    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.report.as_ref().map(|r| to_python(py, r)).transpose()
    }

    /// Kind of model in words.
    #[getter]
    fn kind(&self) -> &'static str {
        self.model.kind()
    }

    /// How it was fitted, in words.
    #[getter]
    fn method(&self) -> &str {
        &self.provenance.method
    }

    /// Number of states of the realisation.
    #[getter]
    fn states(&self) -> usize {
        self.model.realize().states()
    }

    /// Motions in the order of every array.
    #[getter]
    fn dofs(&self) -> Vec<&'static str> {
        dof_names(self.model.dofs())
    }

    /// Lowest and highest reduced frequency K = ωB/V of the data.
    #[getter]
    fn tested_range(&self) -> (f64, f64) {
        (self.tested.min.full_width(), self.tested.max.full_width())
    }

    /// What a user of the model should know.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.provenance.notes.clone()
    }

    /// Section of the file the model was read from.
    #[getter]
    fn section(&self) -> Option<Section> {
        self.stored.as_ref().map(|(s, _)| Section(s.clone()))
    }

    fn __repr__(&self) -> String {
        let (low, high) = self.tested_range();
        format!("Model({}, tested K {low:.3} to {high:.3})", self.kind())
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        shown(slf.as_any(), "model_html", None)
    }

    /// Draw the derivatives of the model over V̂ with matplotlib, with measured ones if `derivatives` is given.
    #[pyo3(signature = (**keywords))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        keywords: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        shown(slf.as_any(), "model_plot", keywords)
    }
}

impl Model {
    /// What is odd about its data and its forces.
    pub fn odd(&self) -> Vec<Finding> {
        let of_forces = of_model(&self.name, &self.model, self.tested, &self.findings);
        [&self.findings[..], &of_forces].concat()
    }

    /// What is saved and exported, for `section` or that of the file: its experiment begins below the onset.
    pub fn exported(&self, section: Option<&Section>) -> PyResult<TrainedModel> {
        let mut trained = self.trained(section)?;
        if self.stored.is_none() {
            let range = crate::section::usual_range(&trained.section);
            let limit = range.searched_to_m_s;
            let structure = trained.section.structure().map_err(raised)?;
            let coupled = CoupledSection::with_model(&structure, &self.model).map_err(raised)?;
            let found = find_onset(&self.name, &coupled, &range.search(), Some(self.tested));
            let found = found.map_err(raised)?;
            let divergence = divergence_with_forces(&structure, &self.model);
            let first = found.first_limit_m_s(divergence.map_err(raised)?, limit);
            trained.experiment = ExportBlock::default().experiment(first, limit);
        }
        Ok(trained)
    }

    /// What is computed with, for `section` or that of the file.
    pub fn trained(&self, section: Option<&Section>) -> PyResult<TrainedModel> {
        let stored = self.stored.as_ref().map(|(s, _)| s);
        let section = section.map(|s| &s.0).or(stored).cloned();
        let section = section.ok_or_else(|| {
            wrong(
                "section",
                "the section that the model is coupled with",
                "none".to_owned(),
            )
        })?;
        let experiment = match &self.stored {
            Some((_, experiment)) => experiment.clone(),
            None => {
                let limit = crate::section::usual_range(&section).speed_max_m_s;
                ExportBlock::default().experiment(limit, limit)
            }
        };
        Ok(TrainedModel {
            schema_version: self.model.schema_version(),
            name: self.name.clone(),
            section,
            model: self.model.clone(),
            tested_range: self.tested,
            provenance: self.provenance.clone(),
            experiment,
        })
    }
}
