//! `flutter`, `sweep`, `onsets`: at which wind speed a motion grows.

use crate::convert::{Callback, dof_names, rows, shown};
use crate::derivatives::Derivatives;
use crate::error::{raised, wrong};
use crate::model::Model;
use crate::section::{Section, place};
use aerodeck::aerodynamics::derivatives::{Extrapolation, InterpolatedTable};
use aerodeck::aerodynamics::{FlatPlate, Transfer};
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::flutter::{
    FlutterSearch, OnsetInterval, OnsetSearch, determinant_onset, find_onset, pk_onset, trace_modes,
};
use aerodeck::reliability::{OnsetKind, Parameter, many_onsets};
use aerodeck::section::SectionModel;
use aerodeck::study::{FlutterBlock, SpeedRange};
use aerodeck::units::{ReducedFrequency, ReducedFrequencyRange};
use numpy::{PyArray1, PyReadonlyArray1, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Reduced frequencies in which the flat plate is searched.
const PLATE_K: (f64, f64) = (0.02, 20.0);

/// Wind speeds that follow from the section, as in a study that states none.
pub fn usual_range(section: &SectionModel) -> SpeedRange {
    FlutterBlock::default().range(section)
}

/// The flutter onset of a section in a force model.
#[pyclass(frozen, module = "aerodeck", get_all)]
pub struct Onset {
    /// `onset`; `unstable` when a motion grows already at the lowest speed that could be judged (the onset is there or below);
    /// `stable` when there is none.
    state: &'static str,
    /// Wind speed, m/s; None when stable.
    speed_m_s: Option<f64>,
    /// Frequency of the motion, Hz; None when stable.
    frequency_hz: Option<f64>,
    /// V* = V/(fB); None when stable.
    reduced_velocity: Option<f64>,
    /// 95 % interval of the speed, m/s, as (low, high); None when it is not known or the data do not determine the onset.
    interval: Option<(f64, f64)>,
    /// Why there is no interval; None when there is one.
    no_interval: Option<String>,
    /// Whether the data reach the onset; None when there is none, or the model is exact.
    in_tested_range: Option<bool>,
    /// The answer in one line.
    headline: String,
    /// What limits trust in it.
    warnings: Vec<String>,
    /// How it was found.
    method: String,
    json: String,
}

#[pymethods]
impl Onset {
    /// Everything that is known, as dicts and numbers: the card of `aerodeck flutter --json`.
    #[getter]
    fn card<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("json")?.call_method1("loads", (&self.json,))
    }

    fn __repr__(&self) -> String {
        format!("Onset({})", self.headline)
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        shown(slf.as_any(), "onset_html", None)
    }
}

impl Onset {
    fn new(search: FlutterSearch, method: &str) -> PyResult<Self> {
        let json = serde_json::to_string(&search)
            .map_err(|e| raised(aerodeck::Error::Numerical(e.to_string())))?;
        let mut answer = Self {
            state: "stable",
            speed_m_s: None,
            frequency_hz: None,
            reduced_velocity: None,
            interval: None,
            no_interval: None,
            in_tested_range: None,
            headline: search.explain(),
            warnings: vec![],
            method: method.to_owned(),
            json,
        };
        let at = match &search {
            FlutterSearch::Onset(onset) => {
                answer.state = "onset";
                answer.headline = onset.headline();
                answer.in_tested_range = onset.in_tested_range;
                answer.warnings.clone_from(&onset.warnings);
                match &onset.interval {
                    OnsetInterval::Known {
                        low_m_s, high_m_s, ..
                    } => {
                        answer.interval = Some((*low_m_s, *high_m_s));
                    }
                    OnsetInterval::Undetermined { reason, .. } | OnsetInterval::None { reason } => {
                        answer.no_interval = Some(reason.clone());
                    }
                    OnsetInterval::Spread { of, .. } => answer.no_interval = Some(of.clone()),
                }
                &onset.at
            }
            FlutterSearch::UnstableAtOrBelow(start) => {
                answer.state = "unstable";
                answer.in_tested_range = start.in_tested_range;
                answer.warnings.clone_from(&start.warnings);
                &start.at
            }
            FlutterSearch::StableUpTo(_) => return Ok(answer),
        };
        answer.speed_m_s = Some(at.speed_m_s);
        answer.frequency_hz = Some(at.frequency_hz);
        answer.reduced_velocity = Some(at.reduced_velocity.v_star());
        Ok(answer)
    }
}

/// Find the flutter onset of a section.
///
/// Parameters
/// ----------
/// section : Section
/// model : Model, Derivatives or "flat plate"
///     A trained model, a measured table (searched inside its test points) or Theodorsen's flat plate.
/// speed_max_m_s : float, optional
///     Highest wind speed searched, m/s; left out, well beyond the flat plate's onset.
/// method : {"eigenvalues", "determinant", "pk"}, optional
///     Left out, eigenvalues for a model and the determinant for the others, which have none.
///
/// Returns
/// -------
/// Onset
#[pyfunction]
#[pyo3(signature = (section, model, *, speed_max_m_s = None, method = None))]
pub fn flutter(
    py: Python<'_>,
    section: &Bound<'_, Section>,
    model: &Bound<'_, PyAny>,
    speed_max_m_s: Option<f64>,
    method: Option<&str>,
) -> PyResult<Onset> {
    let section = &section.get().0;
    let mut search = usual_range(section).search();
    search.speed_max_m_s = speed_max_m_s.unwrap_or(search.speed_max_m_s);
    if let Ok(model) = model.cast::<Model>() {
        let method = method.unwrap_or("eigenvalues");
        let model = model.get();
        let found = py.detach(|| of_model(section, model, &search, method));
        return Onset::new(found?, method);
    }
    let exact = |range| FixedForces { range, search };
    let method = method.unwrap_or("determinant");
    let found = if let Ok(table) = model.cast::<Derivatives>() {
        let table = &table.get().0;
        py.detach(|| {
            let dofs = section.dofs();
            let forces =
                InterpolatedTable::new(table, &dofs, Extrapolation::Refuse).map_err(raised)?;
            exact(forces.tested_range()).find(&table.name, section, &forces, method)
        })
    } else if model
        .extract::<&str>()
        .is_ok_and(|name| name == "flat plate")
    {
        let k = ReducedFrequency::from_full_width;
        let range = ReducedFrequencyRange {
            min: k(PLATE_K.0),
            max: k(PLATE_K.1),
        };
        let found =
            py.detach(|| exact(range).find("flat plate", section, &FlatPlate::default(), method));
        found.map(exactly)
    } else {
        let found = model.get_type().name()?.to_string();
        return Err(wrong(
            "model",
            "a Model, Derivatives or \"flat plate\"",
            found,
        ));
    };
    Onset::new(found?, method)
}

/// The answer of forces that hold at every reduced frequency.
fn exactly(mut found: FlutterSearch) -> FlutterSearch {
    if let FlutterSearch::Onset(onset) = &mut found {
        onset.in_tested_range = None;
        let reason = "the forces are exact".to_owned();
        onset.interval = OnsetInterval::None { reason };
    }
    found
}

/// Forces without a realisation.
struct FixedForces {
    range: ReducedFrequencyRange,
    search: OnsetSearch,
}

impl FixedForces {
    fn find(
        &self,
        name: &str,
        section: &SectionModel,
        forces: &dyn Transfer,
        method: &str,
    ) -> PyResult<FlutterSearch> {
        let structure = section.structure().map_err(raised)?;
        match method {
            "determinant" => determinant_onset(
                name,
                &structure,
                forces,
                self.range,
                self.search.speed_max_m_s,
            ),
            "pk" => pk_onset(name, &structure, forces, &self.search, None),
            other => return Err(wrong("method", "determinant or pk", format!("`{other}`"))),
        }
        .map_err(raised)
    }
}

fn of_model(
    section: &SectionModel,
    model: &Model,
    search: &OnsetSearch,
    method: &str,
) -> PyResult<FlutterSearch> {
    let tested = Some(model.tested);
    let structure = section.structure().map_err(raised)?;
    let mut found = match method {
        "eigenvalues" => {
            let coupled = CoupledSection::with_model(&structure, &model.model).map_err(raised)?;
            find_onset(&model.name, &coupled, search, tested)
        }
        "determinant" => determinant_onset(
            &model.name,
            &structure,
            &model.model,
            model.tested,
            search.speed_max_m_s,
        ),
        "pk" => pk_onset(&model.name, &structure, &model.model, search, tested),
        other => {
            let expected = "eigenvalues, determinant or pk";
            return Err(wrong("method", expected, format!("`{other}`")));
        }
    }
    .map_err(raised)?;
    if let FlutterSearch::Onset(onset) = &mut found {
        onset.interval = match &model.uncertainty {
            Ok(known) => known.onset_interval(&structure, onset).map_err(raised)?,
            Err(reason) => OnsetInterval::None {
                reason: reason.clone(),
            },
        };
    }
    Ok(found)
}

/// Frequencies and damping ratios of the modes over wind speed.
#[pyclass(frozen, module = "aerodeck", get_all)]
pub struct Sweep {
    /// Wind speeds, m/s; shape (n,).
    speed_m_s: Py<PyArray1<f64>>,
    /// Frequencies, Hz; shape (n, modes); NaN where a mode cannot be judged.
    frequency_hz: Py<numpy::PyArray2<f64>>,
    /// Damping ratios; shape (n, modes); negative when the motion grows.
    damping_ratio: Py<numpy::PyArray2<f64>>,
    /// Whether the data reach the reduced frequency of the mode; shape (n, modes).
    tested: Py<numpy::PyArray2<bool>>,
    /// Names of the modes, by the motion each begins as in still air.
    modes: Vec<&'static str>,
    /// Why a mode ends before the highest speed; None when none does.
    ended: Option<String>,
}

#[pymethods]
impl Sweep {
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
    speeds_m_s: Option<PyReadonlyArray1<'_, f64>>,
) -> PyResult<Sweep> {
    let (section, model) = (&section.get().0, model.get());
    let speeds: Vec<f64> = match speeds_m_s {
        Some(speeds) => speeds.as_array().to_vec(),
        None => usual_range(section).curve_speeds_m_s(),
    };
    let curves = py.detach(|| {
        let structure = section.structure()?;
        let coupled = CoupledSection::with_model(&structure, &model.model)?;
        let curves = trace_modes(&model.name, &coupled, &speeds)?;
        aerodeck::Result::Ok(curves.marked(section.width_m, Some(model.tested)))
    });
    let curves = curves.map_err(raised)?;
    let modes = curves.branches.len();
    // a branch may begin later than the first speed and end before the last: speeds are matched bit for bit
    let at = |speed: f64, mode: usize| {
        let points = &curves.branches[mode].points;
        let found = points.binary_search_by(|p| p.speed_m_s.total_cmp(&speed));
        found.ok().map(|i| &points[i])
    };
    let array = |pick: fn(&aerodeck::flutter::ModePoint) -> f64| {
        let row = |speed: &f64| {
            let value = |mode| at(*speed, mode).map_or(f64::NAN, pick);
            (0..modes).map(value).collect::<Vec<_>>()
        };
        rows(py, modes, speeds.iter().map(row))
    };
    let tested = |speed: &f64| {
        let one = |mode| {
            at(*speed, mode)
                .and_then(|p| p.in_tested_range)
                .unwrap_or(false)
        };
        (0..modes).map(one).collect::<Vec<bool>>()
    };
    let tested: Vec<Vec<bool>> = speeds.iter().map(tested).collect();
    Ok(Sweep {
        frequency_hz: array(|p| p.frequency_hz)?.unbind(),
        damping_ratio: array(|p| p.damping_ratio)?.unbind(),
        tested: numpy::PyArray2::from_vec2(py, &tested)?.unbind(),
        modes: dof_names(&section.dofs()),
        ended: curves.ended,
        speed_m_s: PyArray1::from_vec(py, speeds).unbind(),
    })
}

/// Onsets of many sections, one entry each.
#[pyclass(frozen, module = "aerodeck", get_all)]
pub struct Onsets {
    /// Onset speeds, m/s; NaN where there is none; shape (n,).
    speed_m_s: Py<PyArray1<f64>>,
    /// Frequencies at the onset, Hz; shape (n,).
    frequency_hz: Py<PyArray1<f64>>,
    /// Whether the data reach the onset; shape (n,).
    tested: Py<PyArray1<bool>>,
    /// Whether a motion grows already at the lowest speed that could be judged, which then stands for the onset; shape (n,).
    unstable: Py<PyArray1<bool>>,
}

#[pymethods]
impl Onsets {
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
/// values : dict of str to array of shape (n,)
///     Numbers of the section by their names in a study file: `"vertical.mass_kg_m"`, `"torsion.frequency_hz"`, …
/// speed_max_m_s : float, optional
///     Highest wind speed searched, m/s.
/// progress : callable, optional
///     Called with (done, total), from any thread.
///
/// Returns
/// -------
/// Onsets
#[pyfunction]
#[pyo3(signature = (section, model, values, *, speed_max_m_s = None, progress = None))]
pub fn onsets(
    py: Python<'_>,
    section: &Bound<'_, Section>,
    model: &Bound<'_, Model>,
    values: &Bound<'_, PyDict>,
    speed_max_m_s: Option<f64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Onsets> {
    let trained = model.get().trained(Some(section.get()))?;
    let mut varied: Vec<(Parameter, Vec<f64>)> = Vec::new();
    for (name, array) in values {
        let name: String = name.extract()?;
        place(&name, &mut trained.section.clone())?;
        let array: PyReadonlyArray1<f64> = array.extract()?;
        let parameter = Parameter::named(&name).map_err(raised)?;
        varied.push((parameter, array.as_array().to_vec()));
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
    let callback = Callback::new(progress);
    let found = py.detach(|| {
        many_onsets(&trained, count, &make, limit, &|done| {
            callback.tell(done, count)
        })
    });
    callback.finish()?;
    let found = found.map_err(raised)?;
    let are = |kind: OnsetKind| {
        let all = found.kinds.iter().map(|k| *k == kind).collect();
        PyArray1::from_vec(py, all).unbind()
    };
    Ok(Onsets {
        tested: are(OnsetKind::Tested),
        unstable: are(OnsetKind::UnstableAtOrBelow),
        speed_m_s: PyArray1::from_vec(py, found.speeds_m_s).unbind(),
        frequency_hz: PyArray1::from_vec(py, found.frequencies_hz).unbind(),
    })
}
