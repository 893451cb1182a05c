//! `simulate`, `Stepper`: how a section moves.

use crate::convert::{Parts, dof_names, framed, parts, rows, shown};
use crate::error::{raised, wrong};
use crate::model::Model;
use crate::section::Section;
use crate::work::Work;
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::error::{finite, non_negative};
use aerodeck::response::{self, Inputs, Outputs, SectionState};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Mutex;

/// Longest run that is kept in memory, in steps.
const MAX_STEPS: f64 = 1e7;

/// Motion of a section over time; columns in the order of `dofs`.
#[pyclass(frozen, module = "aerodeck", get_all)]
#[derive(FromPyObject)]
pub struct Motion {
    /// Instants, s; shape (n,).
    time_s: Py<PyArray1<f64>>,
    /// Displacements, m and rad; shape (n, d).
    displacement: Py<PyArray2<f64>>,
    /// Rates, m/s and rad/s; shape (n, d).
    rate: Py<PyArray2<f64>>,
    /// Accelerations, m/s² and rad/s²; shape (n, d).
    acceleration: Py<PyArray2<f64>>,
    /// Self-excited forces per metre, N/m and N·m/m; shape (n, d).
    force: Py<PyArray2<f64>>,
    /// Names of the motions.
    dofs: Vec<String>,
    /// Wind speed, m/s.
    wind_speed_m_s: f64,
}

#[pymethods]
impl Motion {
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Parts<'py>> {
        parts(slf)
    }

    #[staticmethod]
    fn _from_parts(parts: Self) -> Self {
        parts
    }

    fn __repr__(&self) -> String {
        format!(
            "Motion({} at {} m/s)",
            self.dofs.join(", "),
            self.wind_speed_m_s
        )
    }

    /// The motion as a pandas DataFrame over time: displacement, rate, acceleration and force of every motion.
    fn to_frame<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        framed(slf.as_any(), "motion_frame", None)
    }

    /// The motion as an xarray Dataset over time and motion.
    fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        framed(slf.as_any(), "motion_dataset", None)
    }

    /// Draw the displacements over time with matplotlib; returns the figure.
    #[pyo3(signature = (**keywords))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        keywords: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        shown(slf.as_any(), "motion_plot", keywords)
    }
}

/// Release a section in steady wind and follow its motion by exact steps.
///
/// Parameters
/// ----------
/// section : Section
/// model : Model
/// wind_speed_m_s : float
/// stop_time_s, step_s : float
///     Length of the run and step of the output, s.
/// displacement : sequence of float, optional
///     Released from here, m and rad, in the order of the motions; left out, 0.01 m and 1 degree.
///
/// Returns
/// -------
/// Motion
#[pyfunction]
#[pyo3(signature = (section, model, wind_speed_m_s, *, stop_time_s = 10.0, step_s = 0.01, displacement = None))]
pub fn simulate(
    py: Python<'_>,
    section: &Bound<'_, Section>,
    model: &Bound<'_, Model>,
    wind_speed_m_s: f64,
    stop_time_s: f64,
    step_s: f64,
    displacement: Option<Vec<f64>>,
) -> PyResult<Motion> {
    let steps = (stop_time_s / step_s).round();
    let within = step_s <= stop_time_s || stop_time_s == 0.0;
    if !(step_s > 0.0 && within && (0.0..=MAX_STEPS).contains(&steps)) {
        let expected = "a positive step within stop_time_s and at most 1e7 of them";
        let found = format!("{stop_time_s} s in steps of {step_s} s");
        return Err(wrong("step_s", expected, found));
    }
    let mut stepper = section_stepper(section, model)?;
    let dofs = section.get().0.dofs();
    let n = dofs.len();
    let released = displacement.unwrap_or_else(|| usual_release(n));
    let work = Work::new(None);
    let run = work.run(py, || {
        let mut state = stepper.released(&released, &vec![0.0; n])?;
        let inputs = Inputs::steady(wind_speed_m_s, n);
        let mut all: [Vec<Vec<f64>>; 4] = Default::default();
        let mut outputs = Outputs::default();
        for i in 0..=steps as usize {
            work.check();
            if i > 0 {
                stepper.advance(&mut state, &inputs, step_s)?;
            }
            stepper.outputs(&state, &inputs, &mut outputs)?;
            for (kept, values) in all.iter_mut().zip(outputs.lists()) {
                kept.push(values.clone());
            }
        }
        aerodeck::Result::Ok(all)
    });
    let [displacement, rate, acceleration, force] = run?.map_err(raised)?;
    let array = |lists: Vec<Vec<f64>>| rows(py, n, lists).map(Bound::unbind);
    let time = (0..displacement.len()).map(|i| i as f64 * step_s).collect();
    Ok(Motion {
        time_s: PyArray1::from_vec(py, time).unbind(),
        displacement: array(displacement)?,
        rate: array(rate)?,
        acceleration: array(acceleration)?,
        force: array(force)?,
        dofs: dof_names(&dofs).into_iter().map(str::to_owned).collect(),
        wind_speed_m_s,
    })
}

/// A section that is stepped from outside, with wind and external force of each step.
///
/// Parameters
/// ----------
/// section : Section
/// model : Model
/// displacement, rate : sequence of float, optional
///     Released from here: m and rad, m/s and rad/s; left out, 0.01 m and 1 degree, at rest.
#[pyclass(frozen, module = "aerodeck")]
pub struct Stepper(Mutex<Stepping>);

/// Time, values, phase, last wind speed, outputs.
type Snapshot = (f64, Vec<f64>, f64, Option<f64>, [Vec<f64>; 4]);

struct Stepping {
    /// What it was made of, for `pickle`.
    section: Py<Section>,
    model: Py<Model>,
    stepper: response::Stepper,
    state: SectionState,
    outputs: Outputs,
    time_s: f64,
}

#[pymethods]
impl Stepper {
    #[new]
    #[pyo3(signature = (section, model, *, displacement = None, rate = None))]
    fn new(
        section: &Bound<'_, Section>,
        model: &Bound<'_, Model>,
        displacement: Option<Vec<f64>>,
        rate: Option<Vec<f64>>,
    ) -> PyResult<Self> {
        let mut stepper = section_stepper(section, model)?;
        let n = section.get().0.dofs().len();
        let displacement = displacement.unwrap_or_else(|| usual_release(n));
        let rate = rate.unwrap_or_else(|| vec![0.0; n]);
        let state = stepper.released(&displacement, &rate).map_err(raised)?;
        let mut outputs = Outputs::default();
        stepper
            .outputs(&state, &Inputs::steady(0.0, n), &mut outputs)
            .map_err(raised)?;
        Ok(Self(Mutex::new(Stepping {
            section: section.clone().unbind(),
            model: model.clone().unbind(),
            stepper,
            state,
            outputs,
            time_s: 0.0,
        })))
    }

    /// Advance by a step, exactly for wind and force that are held or run on a straight line over it.
    ///
    /// Parameters
    /// ----------
    /// step_s : float
    /// wind_speed_m_s : float
    ///     At the start of the step.
    /// force : sequence of float, optional
    ///     External force per metre at the start of the step, N/m and N·m/m; left out, none.
    /// wind_speed_rate_m_s2, force_rate
    ///     Their constant rates over the step, per second; left out, none.
    ///
    /// Returns
    /// -------
    /// ndarray of shape (d,)
    ///     Displacements at the end of the step, m and rad.
    #[pyo3(signature = (step_s, wind_speed_m_s, force = None, *, wind_speed_rate_m_s2 = 0.0, force_rate = None))]
    fn step<'py>(
        &self,
        py: Python<'py>,
        step_s: f64,
        wind_speed_m_s: f64,
        force: Option<Vec<f64>>,
        wind_speed_rate_m_s2: f64,
        force_rate: Option<Vec<f64>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let mut guard = self.lock();
        let own = &mut *guard;
        let n = own.outputs.displacement.len();
        let mut inputs = Inputs {
            wind_speed_rate_m_s2,
            force: force.unwrap_or_else(|| vec![0.0; n]),
            force_rate: force_rate.unwrap_or_else(|| vec![0.0; n]),
            ..Inputs::steady(wind_speed_m_s, n)
        };
        own.stepper
            .advance(&mut own.state, &inputs, step_s)
            .map_err(raised)?;
        inputs.wind_speed_m_s = response::wind_at_rest(
            wind_speed_m_s + step_s * wind_speed_rate_m_s2,
            wind_speed_m_s,
        );
        for (force, rate) in inputs.force.iter_mut().zip(&inputs.force_rate) {
            *force += step_s * rate;
        }
        own.stepper
            .outputs(&own.state, &inputs, &mut own.outputs)
            .map_err(raised)?;
        own.time_s += step_s;
        Ok(PyArray1::from_slice(py, &own.outputs.displacement))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Parts<'py>> {
        let (py, own) = (slf.py(), slf.get().lock());
        let (section, model) = (own.section.clone_ref(py), own.model.clone_ref(py));
        drop(own);
        let parts = (section, model, slf.get().snapshot()).into_pyobject(py)?;
        Ok((slf.get_type().getattr("_from_parts")?, parts))
    }

    #[staticmethod]
    fn _from_parts(
        section: &Bound<'_, Section>,
        model: &Bound<'_, Model>,
        snapshot: Snapshot,
    ) -> PyResult<Self> {
        let stepper = Self::new(section, model, None, None)?;
        stepper.restore(snapshot)?;
        Ok(stepper)
    }

    /// The whole state, to come back to with `restore`: (time, values, phase, last wind speed, outputs).
    fn snapshot(&self) -> Snapshot {
        let own = self.lock();
        let state = &own.state;
        (
            own.time_s,
            state.values.clone(),
            state.phase,
            state.last_wind_m_s,
            own.outputs.lists().map(Clone::clone),
        )
    }

    /// Go back to a `snapshot`; the same steps then give the same bits.
    fn restore(&self, snapshot: Snapshot) -> PyResult<()> {
        let mut own = self.lock();
        let expected = own.state.values.len();
        let (time_s, values, phase, last_wind_m_s, outputs) = snapshot;
        let n = own.outputs.displacement.len();
        if values.len() != expected || outputs.iter().any(|list| list.len() != n) {
            let found = format!("one of {}", values.len());
            let expected = format!("one of {expected} states and {n} motions");
            return Err(wrong("snapshot", &expected, found));
        }
        let numbers = values.iter().chain(outputs.iter().flatten());
        for number in numbers.chain([&time_s]) {
            finite("snapshot", *number).map_err(raised)?;
        }
        if let Some(wind) = last_wind_m_s {
            non_negative("snapshot: wind speed", wind).map_err(raised)?;
        }
        own.time_s = time_s;
        own.state = SectionState {
            values,
            phase,
            last_wind_m_s,
            ..SectionState::default()
        };
        let [displacement, rate, acceleration, self_excited_force] = outputs;
        own.outputs = Outputs {
            displacement,
            rate,
            acceleration,
            self_excited_force,
        };
        Ok(())
    }

    /// Time since the release, s.
    #[getter]
    fn time_s(&self) -> f64 {
        self.lock().time_s
    }

    /// Displacements, m and rad; shape (d,).
    #[getter]
    fn displacement<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.lock().outputs.displacement)
    }

    /// Rates, m/s and rad/s; shape (d,).
    #[getter]
    fn rate<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.lock().outputs.rate)
    }

    /// Accelerations, m/s² and rad/s²; shape (d,).
    #[getter]
    fn acceleration<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.lock().outputs.acceleration)
    }

    /// Self-excited forces per metre, N/m and N·m/m; shape (d,).
    #[getter]
    fn force<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.lock().outputs.self_excited_force)
    }

    fn __repr__(&self) -> String {
        format!("Stepper(at {} s)", self.lock().time_s)
    }
}

impl Stepper {
    fn lock(&self) -> std::sync::MutexGuard<'_, Stepping> {
        self.0.lock().unwrap_or_else(|e| e.into_inner())
    }
}

fn section_stepper(
    section: &Bound<'_, Section>,
    model: &Bound<'_, Model>,
) -> PyResult<response::Stepper> {
    let structure = section.get().0.structure().map_err(raised)?;
    let coupled = CoupledSection::with_model(&structure, &model.get().model).map_err(raised)?;
    Ok(response::Stepper::new(coupled))
}

fn usual_release(dofs: usize) -> Vec<f64> {
    let mut release = vec![0.0; dofs];
    release[0] = 0.01;
    release[dofs - 1] = 1f64.to_radians();
    release
}
