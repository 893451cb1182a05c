//! `Bridge`: modes and strips of a whole bridge.

use crate::bridge_scatter::{BridgeScatter, derivative_scatter};
use crate::buffeting::Buffeting;
use crate::convert::{Reduced, list, reduced, restored, shown};
use crate::error::{raised, warned, wrong};
use crate::onset::Onset;
use crate::sweep::Sweep;
use crate::work::Work;
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::files::bridge::BridgeFile;
use aerodeck::flutter::{find_onset, trace_modes_watched};
use aerodeck::fmu::package::{Label, Runtime, package, write_archive};
use aerodeck::study::bridge::{
    BridgeExportOptions, BridgeStudy, DerivativeScatter, Scatter, bridge_flutter,
};
use aerodeck::verdict::Verdict;
use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;
use std::path::PathBuf;

/// A whole bridge: natural modes, strips of sections with their forces, wind along the span.
///
/// Read from a bridge file (`Bridge.read("bridge.toml")`), which docs/bridge.md describes.
#[pyclass(frozen, module = "aerodeck")]
pub struct Bridge(BridgeStudy);

#[pymethods]
impl Bridge {
    /// Read a bridge file with the modes, tables and models it names.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     The bridge file (.toml).
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let work = Work::new(None);
        let study = work.run(py, || BridgeStudy::new(BridgeFile::read(&path)?))?;
        let study = study.map_err(raised)?;
        warned(py, &study.findings)?;
        Ok(Self(study))
    }

    /// The file and its folder: what it names is read again.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let file = &slf.get().0.file;
        // of a file in the current folder it is empty
        let directory = std::path::Path::new(".").join(&file.directory);
        reduced(slf, &(file, std::path::absolute(directory)?))
    }

    #[staticmethod]
    fn _from_state(state: &str) -> PyResult<Self> {
        let (file, directory): (BridgeFile, PathBuf) = restored(state)?;
        let study = BridgeStudy::new(BridgeFile { directory, ..file });
        study.map(Self).map_err(raised)
    }

    /// Name in the file.
    #[getter]
    fn name(&self) -> &str {
        &self.0.file.name
    }

    /// Names of the nodes along the girder; n of them.
    #[getter]
    fn nodes(&self) -> Vec<String> {
        let nodes = self.0.by_model.nodes.iter();
        nodes.map(|n| n.name.clone()).collect()
    }

    /// Places of the nodes along the girder, m; shape (n,).
    #[getter]
    fn along_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let nodes = self.0.by_model.nodes.iter();
        PyArray1::from_iter(py, nodes.map(|n| n.along_m))
    }

    /// Numbers of the modes in the model they come from; m of them.
    #[getter]
    fn modes(&self) -> Vec<usize> {
        self.0.by_model.modes.iter().map(|m| m.number).collect()
    }

    /// Natural frequencies, Hz; shape (m,).
    #[getter]
    fn frequency_hz<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let modes = self.0.by_model.modes.iter();
        PyArray1::from_iter(py, modes.map(|m| m.frequency_hz))
    }

    /// Ratios to critical damping without wind; shape (m,).
    #[getter]
    fn damping_ratio<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let modes = self.0.by_model.modes.iter();
        PyArray1::from_iter(py, modes.map(|m| m.damping_ratio))
    }

    /// Vertical (m, up), lateral (m, downwind) and rotation (rad, nose-up) at each node, per unit of the modal coordinate; shape
    /// (m, n, 3).
    #[getter]
    fn shapes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let bridge = &self.0.by_model;
        let flat = bridge.modes.iter().flat_map(|m| m.shape.iter().flatten());
        let flat = PyArray1::from_iter(py, flat.copied());
        flat.reshape([bridge.modes.len(), bridge.nodes.len(), 3])
    }

    /// What a reader should know: hints about units, simplifications.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.0.warnings()
    }

    /// Find the flutter onset.
    ///
    /// Parameters
    /// ----------
    /// forces : {"models", "tables"}
    ///     Eigenvalues with the force models, or p-k iteration with the tables between their points.
    ///
    /// Returns
    /// -------
    /// Onset
    ///     Its card also holds `motion` (modes by their share of the energy, motion of every node), `left_out` (onsets with fewer
    ///     modes), `divergence_m_s` and `mean_rotation_deg`.
    #[pyo3(signature = (*, forces = "models"))]
    fn flutter(&self, py: Python<'_>, forces: &str) -> PyResult<Onset> {
        let method = match forces {
            "models" => "eigenvalues",
            "tables" => "pk",
            other => return Err(wrong("forces", "models or tables", format!("`{other}`"))),
        };
        let found = Work::new(None).run(py, || bridge_flutter(&self.0))?;
        let found = found.map_err(raised)?;
        // the answer of the models comes last, that of the tables, where there is one, first
        let answer = match forces {
            "tables" if found.answers.len() < 2 => {
                let why = found.failed.first().cloned();
                let why = why.unwrap_or_else(|| "no section with a table".to_owned());
                return Err(wrong("forces", "tables that have an onset to search", why));
            }
            "tables" => found.answers.first(),
            _ => found.answers.last(),
        };
        let answer = answer.ok_or_else(|| {
            raised(aerodeck::Error::Numerical(
                "no route to the onset".to_owned(),
            ))
        })?;
        let card = json!({
            "search": answer.search, "motion": answer.motion, "left_out": found.left_out,
            "divergence_m_s": found.divergence_m_s, "mean_rotation_deg": found.mean_rotation.map(|mean| mean.rotation_deg), "failed": found.failed,
        });
        let verdict = Verdict::judge(&self.0.evidence(&found, &found.failed));
        Onset::with_card(&answer.search, method, &verdict, &card)
    }

    /// Follow the modes over wind speed, with the force models.
    ///
    /// Parameters
    /// ----------
    /// speeds_m_s : array of shape (n,), optional
    ///     Rising wind speeds, m/s; left out, those of the bridge file.
    ///
    /// Returns
    /// -------
    /// Sweep
    #[pyo3(signature = (speeds_m_s = None))]
    fn sweep(&self, py: Python<'_>, speeds_m_s: Option<&Bound<'_, PyAny>>) -> PyResult<Sweep> {
        let study = &self.0;
        let speeds: Vec<f64> = match speeds_m_s {
            Some(speeds) => list("speeds_m_s", speeds)?,
            None => {
                let search = &study.file.flutter;
                let step = search.speed_max_m_s / search.speeds as f64;
                (1..=search.speeds).map(|i| step * i as f64).collect()
            }
        };
        let work = Work::new(None);
        let curves = work.run(py, || {
            let watch = || work.check();
            let curves = trace_modes_watched("model", &self.coupled()?, &speeds, &watch)?;
            aerodeck::Result::Ok(curves.marked(study.by_model.width_m(), study.tested_range()))
        })?;
        let curves = curves.map_err(raised)?;
        let names = curves.branches.iter().map(|b| b.name.clone()).collect();
        Sweep::new(py, &curves, speeds, names)
    }

    /// Find the onset of many bridges whose modes and forces scatter, with the force models: that of the mode which flutters in
    /// the mean, followed in every sample.
    ///
    /// Parameters
    /// ----------
    /// samples : int
    /// frequency : float
    ///     Standard deviation of each natural frequency over its mean (normal).
    /// damping : float
    ///     Standard deviation of each damping ratio over its mean (log-normal).
    /// derivatives : float or {"measured"}
    ///     Standard deviation of the derivatives of each force by each motion over their mean (normal); "measured" draws the models
    ///     of the sections from the covariance of their fits.
    /// seed : int
    /// progress : callable, optional
    ///     Called with (samples done, samples), from any thread.
    ///
    /// Returns
    /// -------
    /// BridgeScatter
    #[pyo3(signature = (samples = 1000, *, frequency = 0.02, damping = 0.3, derivatives = None, seed = 1,
        progress = None), text_signature = "($self, samples=1000, *, frequency=0.02, damping=0.3, derivatives=0.05, seed=1, progress=None)")]
    #[allow(clippy::too_many_arguments)] // keywords of Python, not positions
    fn scatter(
        &self,
        py: Python<'_>,
        samples: usize,
        frequency: f64,
        damping: f64,
        derivatives: Option<&Bound<'_, PyAny>>,
        seed: u64,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<BridgeScatter> {
        let scatter = Scatter {
            frequency,
            damping,
            derivatives: derivatives
                .map_or(Ok(DerivativeScatter::Relative(0.05)), derivative_scatter)?,
            samples,
            seed,
        };
        let work = Work::new(progress);
        let found = work.run(py, || {
            let mean = find_onset(
                "model",
                &self.coupled()?,
                &self.0.search(),
                self.0.tested_range(),
            )?;
            let onset = mean.onset().ok_or_else(|| {
                aerodeck::Error::Numerical(format!("scatter: the bridge {}", mean.explain()))
            })?;
            self.0
                .scattered_onset(onset, &scatter, &|done, all| work.tell(done, all))
        })?;
        Ok(BridgeScatter::new(py, &found.map_err(raised)?))
    }

    /// Compute the response to the turbulence of the bridge file's `[buffeting]`.
    ///
    /// Parameters
    /// ----------
    /// speed_m_s : float
    ///     Mean wind speed, m/s.
    /// progress : callable, optional
    ///     Called with (records done, records), from any thread.
    ///
    /// Returns
    /// -------
    /// Buffeting
    #[pyo3(signature = (speed_m_s, *, progress = None))]
    fn buffeting(
        &self,
        py: Python<'_>,
        speed_m_s: f64,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Buffeting> {
        let work = Work::new(progress);
        let found = work.run(py, || {
            let block = self.0.buffeting_block()?;
            self.0
                .buffeting(&block, speed_m_s, &|done, all| work.tell(done, all))
        })?;
        Buffeting::new(py, &found.map_err(raised)?)
    }

    /// Write an FMU of the bridge for FMI 2.0.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    /// nodes : sequence of str, optional
    ///     Nodes with inputs and outputs; left out, mid-span and both quarter points.
    /// name, author, copyright : str, optional
    ///     What the description says of its origin.
    /// overwrite : bool
    ///     Replace a file that is there.
    /// allow_unstable : bool
    ///     Export a bridge that grows from the lowest wind speed on.
    #[pyo3(signature = (path, *, nodes = None, name = None, author = None, copyright = None, overwrite = false,
        allow_unstable = false))]
    #[allow(clippy::too_many_arguments)] // keywords of Python, not positions
    fn export_fmu(
        &self,
        py: Python<'_>,
        path: PathBuf,
        nodes: Option<Vec<String>>,
        name: Option<String>,
        author: Option<String>,
        copyright: Option<String>,
        overwrite: bool,
        allow_unstable: bool,
    ) -> PyResult<()> {
        let label = Label {
            name,
            author,
            copyright,
            generated: None,
        };
        let written = Work::new(None).run(py, || {
            let results = bridge_flutter(&self.0)?;
            let (model, mut export) = self.0.export(&BridgeExportOptions {
                nodes: nodes.unwrap_or_default(),
                allow_unstable,
                onset_interval: results.interval(),
                ..BridgeExportOptions::default()
            })?;
            let evidence = self.0.evidence(&results, &results.failed);
            export.verdict = Some(Verdict::judge(&evidence));
            export.label = label.dated()?;
            let bytes = package(&model, &Runtime::available()?, export)?;
            write_archive(&path, &bytes, overwrite)
        })?;
        written.map_err(raised)
    }

    fn __repr__(&self) -> String {
        let bridge = &self.0.by_model;
        format!(
            "Bridge({}, {} nodes, {} modes)",
            self.0.file.name,
            bridge.nodes.len(),
            bridge.modes.len()
        )
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        shown(slf.as_any(), "bridge_html", None)
    }

    /// Draw the vertical and rotational shapes of the modes over the girder with matplotlib; returns the figure.
    #[pyo3(signature = (**keywords))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        keywords: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        shown(slf.as_any(), "bridge_plot", keywords)
    }
}

impl Bridge {
    /// Its modes in the forces of its models.
    fn coupled(&self) -> aerodeck::Result<CoupledSection> {
        let bridge = &self.0.by_model;
        CoupledSection::new(bridge.structure(), bridge.forces().realize()?)
    }
}
