//! `Records`: forced-vibration records.

use crate::convert::{
    Reduced, dof_names, dofs, from_python, reduced, restored, rows, table, to_python,
};
use crate::derivatives::Derivatives;
use crate::error::{raised, wrong};
use crate::work::detached;
use aerodeck::error::{positive, without_control_characters};
use aerodeck::files::text::file_name;
use aerodeck::plausibility::Finding;
use aerodeck::section::Dof;
use aerodeck::wind_tunnel::{
    Record, RecordHeader, RecordSource, Segment, TunnelPlan, read_record, write_record,
};
use numpy::{PyArray1, PyArray2, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Motion and self-excited force of a section model in forced vibration, one or several runs.
///
/// Beside them stands what is odd about the table they were made from.
#[pyclass(frozen, module = "aerodeck")]
pub struct Records(pub Vec<Record>, pub Vec<Finding>);

#[pymethods]
impl Records {
    /// Read record files (.csv).
    #[staticmethod]
    #[pyo3(signature = (*paths))]
    fn read(py: Python<'_>, paths: Vec<PathBuf>) -> PyResult<Self> {
        let read = || {
            paths
                .iter()
                .map(read_record)
                .collect::<aerodeck::Result<_>>()
        };
        let records = detached(py, read).map_err(raised)?;
        Self::once_each(records, Vec::new())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let Self(records, findings) = slf.get();
        let records = records.iter().map(|r| (&r.header, &r.motion, &r.force));
        reduced(slf, &(records.collect::<Vec<_>>(), findings))
    }

    #[staticmethod]
    fn _from_state(state: &str) -> PyResult<Self> {
        let (records, findings): (Vec<_>, _) = restored(state)?;
        let record = |(header, motion, force)| Record {
            header,
            motion,
            force,
        };
        Ok(Self(records.into_iter().map(record).collect(), findings))
    }

    /// One record from arrays.
    ///
    /// Parameters
    /// ----------
    /// motion : array of shape (n, d)
    ///     Displacements in the order of `dofs`: m, m, rad.
    /// force : array of shape (n, d)
    ///     Self-excited forces per metre of span: N/m, N/m, N·m/m.
    /// sampling_hz, mean_speed_m_s, width_m, air_density_kg_m3 : float
    /// dofs : sequence of str
    ///     `("vertical", "torsion")` or with `"lateral"`, in any order; the record has vertical, lateral, torsion.
    /// segments : sequence of (float, float, float), optional
    ///     Stretches of harmonic motion, ramps included: frequency (Hz), start and end (s).
    #[staticmethod]
    #[pyo3(signature = (motion, force, *, sampling_hz, mean_speed_m_s, width_m, air_density_kg_m3,
        dofs = vec!["vertical".to_owned(), "torsion".to_owned()], segments = vec![], name = "record"))]
    #[allow(clippy::too_many_arguments)] // keywords of Python, not positions
    fn from_arrays(
        motion: &Bound<'_, PyAny>,
        force: &Bound<'_, PyAny>,
        sampling_hz: f64,
        mean_speed_m_s: f64,
        width_m: f64,
        air_density_kg_m3: f64,
        dofs: Vec<String>,
        segments: Vec<(f64, f64, f64)>,
        name: &str,
    ) -> PyResult<Self> {
        without_control_characters("name", name).map_err(raised)?;
        for (key, value) in [
            ("sampling_hz", sampling_hz),
            ("mean_speed_m_s", mean_speed_m_s),
            ("width_m", width_m),
            ("air_density_kg_m3", air_density_kg_m3),
        ] {
            positive(key, value).map_err(raised)?;
        }
        let dofs = self::dofs(&dofs)?;
        let (motion, force) = (table("motion", motion)?, table("force", force)?);
        let shapes = [motion.shape(), force.shape()];
        if shapes[0] != shapes[1] || shapes[0][1] != dofs.len() {
            let expected = format!("two arrays of one shape (n, {})", dofs.len());
            return Err(wrong("motion, force", &expected, format!("{shapes:?}")));
        }
        // the order of every matrix, as of files
        let mut order: Vec<usize> = (0..dofs.len()).collect();
        order.sort_by_key(|&i| dofs[i]);
        let columns = |a: &PyReadonlyArray2<'_, f64>| {
            let column = |&c: &usize| a.as_array().column(c).to_vec();
            order.iter().map(column).collect::<Vec<Vec<f64>>>()
        };
        let segment = |(frequency_hz, start_s, end_s)| Segment {
            frequency_hz,
            start_s,
            end_s,
        };
        let record = Record {
            motion: columns(&motion),
            force: columns(&force),
            header: RecordHeader {
                name: name.to_owned(),
                dofs: order.iter().map(|&i| dofs[i]).collect(),
                width_m,
                air_density_kg_m3,
                mean_speed_m_s,
                sampling_hz,
                segments: segments.into_iter().map(segment).collect(),
                source: "arrays".to_owned(),
                licence: "as of the data".to_owned(),
            },
        };
        let mut samples = record.motion.iter().chain(&record.force).flatten();
        if let Some(bad) = samples.find(|x| !x.is_finite()) {
            return Err(wrong("motion, force", "finite numbers", bad.to_string()));
        }
        let checked = record.header.check_segments(&record.motion);
        checked.map_err(raised)?;
        Ok(Self(vec![record], Vec::new()))
    }

    /// Records of a virtual wind tunnel: what a forced-vibration rig would measure on a deck with these derivatives.
    ///
    /// Parameters
    /// ----------
    /// derivatives : Derivatives
    /// lateral : bool
    ///     Whether sway is moved and drag measured.
    /// **plan
    ///     Keys of `[tunnel]` in a study file: `noise_fraction`, `seed`, `sampling_hz`, …
    #[staticmethod]
    #[pyo3(signature = (derivatives, *, lateral = false, **plan))]
    fn virtual_tunnel(
        py: Python<'_>,
        derivatives: &Bound<'_, Derivatives>,
        lateral: bool,
        plan: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let plan: TunnelPlan = match plan {
            Some(plan) => from_python("tunnel", plan.as_any())?,
            None => TunnelPlan::default(),
        };
        let dofs: &[Dof] = if lateral { &Dof::THREE } else { &Dof::TWO };
        let Derivatives(table, findings) = derivatives.get();
        detached(py, || plan.records_from_table(table, dofs))
            .map(|records| Self(records, findings.clone()))
            .map_err(raised)
    }

    /// Write every record as `<name>.csv` into a folder, which is made, with `_` for characters that not every path can hold; returns the paths.
    fn write(&self, py: Python<'_>, folder: PathBuf) -> PyResult<Vec<PathBuf>> {
        let name = |record: &Record| format!("{}.csv", file_name(&record.header.name));
        for (i, record) in self.0.iter().enumerate() {
            if self.0[..i].iter().any(|other| name(other) == name(record)) {
                let found = format!("{} twice", name(record));
                return Err(wrong(
                    "records",
                    "a name of its own for every record",
                    found,
                ));
            }
        }
        detached(py, || {
            std::fs::create_dir_all(&folder)
                .map_err(|e| raised(aerodeck::Error::io(&folder, e)))?;
            let one = |record: &Record| {
                let path = folder.join(name(record));
                let file = std::fs::File::create(&path);
                let file = file.map_err(|e| raised(aerodeck::Error::io(&path, e)))?;
                write_record(record, &mut std::io::BufWriter::new(file)).map_err(raised)?;
                Ok(path)
            };
            self.0.iter().map(one).collect()
        })
    }

    /// Time (s, shape (n,)), motion (m, rad; shape (n, d)) and force per metre (N/m, N·m/m; shape (n, d)) of a record.
    #[allow(clippy::type_complexity)] // three arrays
    fn to_numpy<'py>(
        &self,
        py: Python<'py>,
        index: usize,
    ) -> PyResult<(
        Bound<'py, PyArray1<f64>>,
        Bound<'py, PyArray2<f64>>,
        Bound<'py, PyArray2<f64>>,
    )> {
        let record = self.get(index)?;
        let samples = record.motion.first().map_or(0, Vec::len);
        let step = 1.0 / record.header.sampling_hz;
        let time = PyArray1::from_vec(py, (0..samples).map(|i| i as f64 * step).collect());
        let array = |channels: &[Vec<f64>]| {
            let row = |i: usize| channels.iter().map(|c| c[i]).collect::<Vec<_>>();
            rows(py, channels.len(), (0..samples).map(row))
        };
        Ok((time, array(&record.motion)?, array(&record.force)?))
    }

    /// Run, section, air, wind speed and sampling of a record: everything but its samples.
    fn header<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.get(index)?.header)
    }

    /// Motions of the first record.
    #[getter]
    fn dofs(&self) -> Vec<&'static str> {
        self.0.first().map_or(vec![], |r| dof_names(&r.header.dofs))
    }

    fn __len__(&self) -> usize {
        self.0.len()
    }

    fn __add__(&self, other: &Bound<'_, Self>) -> PyResult<Self> {
        let (other, mut findings) = (other.get(), self.1.clone());
        let new = other.1.iter().filter(|f| !self.1.contains(f));
        findings.extend(new.cloned());
        Self::once_each([&self.0[..], &other.0].concat(), findings)
    }

    fn __repr__(&self) -> String {
        let names: Vec<&str> = self.0.iter().map(|r| r.header.name.as_str()).collect();
        format!("Records({})", names.join(", "))
    }
}

impl Records {
    fn once_each(records: Vec<Record>, findings: Vec<Finding>) -> PyResult<Self> {
        for (i, record) in records.iter().enumerate() {
            // whatever they are called: noise never repeats
            let same =
                |other: &&Record| (&other.motion, &other.force) == (&record.motion, &record.force);
            if let Some(other) = records[..i].iter().find(same) {
                let expected = "each record once: what stands twice looks better known than it is";
                let name = &record.header.name;
                let found = match &other.header.name {
                    first if first == name => format!("{name} twice"),
                    first => format!("the samples of {first} again as {name}"),
                };
                return Err(wrong("records", expected, found));
            }
        }
        Ok(Self(records, findings))
    }

    fn get(&self, index: usize) -> PyResult<&Record> {
        let missing = || PyIndexError::new_err(format!("{} records, not {index}", self.0.len()));
        self.0.get(index).ok_or_else(missing)
    }

    /// For the library.
    pub fn sources(&self) -> Vec<&dyn RecordSource> {
        self.0.iter().map(|r| r as &dyn RecordSource).collect()
    }
}
