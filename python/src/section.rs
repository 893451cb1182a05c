//! `Section`: what is suspended.

use crate::convert::{Reduced, dof_names, from_python, reduced, restored, shown, to_python};
use crate::error::{raised, warned};
use aerodeck::plausibility::of_section;
use aerodeck::section::{Rotation, STANDARD_AIR_DENSITY_KG_M3, SectionModel, Translation};
use aerodeck::study::{FlutterBlock, SpeedRange};
use aerodeck::uncertainty::monte_carlo::SectionProperty;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::f64::consts::TAU;

// shown in the help of `Section`
const _: () = assert!(STANDARD_AIR_DENSITY_KG_M3 == 1.25);

/// Wind speeds that follow from the section, as in a study that states none.
pub fn usual_range(section: &SectionModel) -> SpeedRange {
    FlutterBlock::default().range(section)
}

/// An elastically suspended deck section, per metre of span.
///
/// Heave and lift positive up, rotation and moment nose-up, sway and drag downwind.
///
/// Parameters
/// ----------
/// width_m : float
///     Full deck width B, m.
/// mass_kg_m, inertia_kg_m2_m : float
///     Mass, kg/m, and mass moment of inertia, kg·m²/m.
/// vertical_frequency_hz, torsion_frequency_hz : float
///     Still-air natural frequencies of each motion alone, Hz.
/// vertical_damping_ratio, torsion_damping_ratio : float
///     Ratios to critical damping.
/// air_density_kg_m3 : float
///     Density of the air, kg/m³; left out, that of EN 1991-1-4, 1.25.
/// lateral : tuple of float, optional
///     Mass (kg/m), frequency (Hz) and damping ratio of sway; left out, the section has two degrees of freedom.
/// axis_offset_m, mass_offset_m : float, optional
///     Axis from mid-chord and centre of mass from the axis, m, positive downwind.
#[pyclass(frozen, module = "aerodeck")]
#[derive(Clone)]
pub struct Section(pub SectionModel);

#[pymethods]
impl Section {
    #[new]
    #[pyo3(signature = (*, width_m, mass_kg_m, inertia_kg_m2_m, vertical_frequency_hz, torsion_frequency_hz,
        vertical_damping_ratio, torsion_damping_ratio, air_density_kg_m3 = 1.25, lateral = None,
        axis_offset_m = None, mass_offset_m = None))]
    #[allow(clippy::too_many_arguments)] // keywords of Python, not positions
    fn new(
        width_m: f64,
        mass_kg_m: f64,
        inertia_kg_m2_m: f64,
        vertical_frequency_hz: f64,
        torsion_frequency_hz: f64,
        vertical_damping_ratio: f64,
        torsion_damping_ratio: f64,
        air_density_kg_m3: f64,
        lateral: Option<(f64, f64, f64)>,
        axis_offset_m: Option<f64>,
        mass_offset_m: Option<f64>,
    ) -> PyResult<Self> {
        let translation = |(mass_kg_m, frequency_hz, damping_ratio)| Translation {
            mass_kg_m,
            frequency_hz: Some(frequency_hz),
            stiffness_n_m2: None,
            damping_ratio,
        };
        Self::checked(SectionModel {
            width_m,
            air_density_kg_m3,
            axis_offset_m,
            mass_offset_m,
            vertical: translation((mass_kg_m, vertical_frequency_hz, vertical_damping_ratio)),
            lateral: lateral.map(translation),
            torsion: Rotation {
                inertia_kg_m2_m,
                frequency_hz: Some(torsion_frequency_hz),
                stiffness_n: None,
                damping_ratio: torsion_damping_ratio,
            },
        })
    }

    /// The section of Table 4.1 of the source thesis: B 0.5 m, 15 kg/m, 0.6 kg·m²/m, 2 and 5 Hz, 0.3 %, 1.19 kg/m³.
    #[staticmethod]
    fn table_4_1() -> Self {
        Self(SectionModel::table_4_1())
    }

    /// The full-scale deck of IABSE Task Group 3.1, step 1.1a: B 31 m, 0.100 and 0.278 Hz.
    #[staticmethod]
    fn iabse_1_1a() -> Self {
        Self(SectionModel::iabse_1_1a())
    }

    /// A section from the keys of `[section]` in a study file.
    #[staticmethod]
    fn from_dict(values: &Bound<'_, PyDict>) -> PyResult<Self> {
        Self::checked(from_python("section", values.as_any())?)
    }

    /// The keys of `[section]` in a study file.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.0)
    }

    /// The same section with other numbers, by their names in a study file: `replace({"torsion.frequency_hz": 4.5})`.
    fn replace(&self, values: &Bound<'_, PyDict>) -> PyResult<Self> {
        let mut section = self.0.clone();
        for (name, value) in values {
            let name: String = name.extract()?;
            *place(&name, &mut section)? = value.extract()?;
        }
        Self::checked(section)
    }

    /// Full deck width B, m.
    #[getter]
    fn width_m(&self) -> f64 {
        self.0.width_m
    }

    /// Mass, kg/m.
    #[getter]
    fn mass_kg_m(&self) -> f64 {
        self.0.vertical.mass_kg_m
    }

    /// Mass moment of inertia about the axis, kg·m²/m.
    #[getter]
    fn inertia_kg_m2_m(&self) -> f64 {
        self.0.torsion.inertia_kg_m2_m
    }

    /// Still-air natural frequency of the vertical motion alone, Hz.
    #[getter]
    fn vertical_frequency_hz(&self) -> f64 {
        frequency(&self.0.vertical)
    }

    /// Still-air natural frequency of the torsional motion alone, Hz.
    #[getter]
    fn torsion_frequency_hz(&self) -> f64 {
        let t = &self.0.torsion;
        natural(t.frequency_hz, t.stiffness_n, t.inertia_kg_m2_m)
    }

    /// Ratio to critical damping of the vertical motion.
    #[getter]
    fn vertical_damping_ratio(&self) -> f64 {
        self.0.vertical.damping_ratio
    }

    /// Ratio to critical damping of the torsional motion.
    #[getter]
    fn torsion_damping_ratio(&self) -> f64 {
        self.0.torsion.damping_ratio
    }

    /// Density of the air, kg/m³.
    #[getter]
    fn air_density_kg_m3(&self) -> f64 {
        self.0.air_density_kg_m3
    }

    /// Mass (kg/m), frequency (Hz) and damping ratio of sway; None for a section of two motions.
    #[getter]
    fn lateral(&self) -> Option<(f64, f64, f64)> {
        let of = |t: &Translation| (t.mass_kg_m, frequency(t), t.damping_ratio);
        self.0.lateral.as_ref().map(of)
    }

    /// Axis from mid-chord, m, positive downwind; None where none is stated: on mid-chord.
    #[getter]
    fn axis_offset_m(&self) -> Option<f64> {
        self.0.axis_offset_m
    }

    /// Centre of mass from the axis, m, positive downwind; None where none is stated: on the axis.
    #[getter]
    fn mass_offset_m(&self) -> Option<f64> {
        self.0.mass_offset_m
    }

    /// Names of the motions in the order of every array: vertical, lateral (if suspended), torsion.
    #[getter]
    fn dofs(&self) -> Vec<&'static str> {
        dof_names(&self.0.dofs())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        reduced(slf, &slf.get().0)
    }

    #[staticmethod]
    fn _from_state(state: &str) -> PyResult<Self> {
        restored(state).map(Self)
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|o| o.get().0 == self.0)
    }

    fn __repr__(&self) -> String {
        let s = &self.0;
        format!(
            "Section(B {} m, m {} kg/m, J {} kg·m²/m, ρ {} kg/m³, {} motions)",
            s.width_m,
            s.vertical.mass_kg_m,
            s.torsion.inertia_kg_m2_m,
            s.air_density_kg_m3,
            s.dofs().len()
        )
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        shown(slf.as_any(), "section_html", None)
    }
}

impl Section {
    fn checked(section: SectionModel) -> PyResult<Self> {
        section.structure().map_err(raised)?;
        Python::attach(|py| warned(py, &of_section(&section)))?;
        Ok(Self(section))
    }
}

/// Frequency, Hz, of a translation that states it or a stiffness.
fn frequency(t: &Translation) -> f64 {
    natural(t.frequency_hz, t.stiffness_n_m2, t.mass_kg_m)
}

/// The stated frequency, or that of a stiffness and an inertia, Hz.
fn natural(frequency_hz: Option<f64>, stiffness: Option<f64>, inertia: f64) -> f64 {
    let of_stiffness = |k: f64| (k / inertia).sqrt() / TAU;
    frequency_hz
        .or(stiffness.map(of_stiffness))
        .unwrap_or(f64::NAN)
}

/// The number of that name in a section.
pub fn place<'a>(name: &str, section: &'a mut SectionModel) -> PyResult<&'a mut f64> {
    let parameter = SectionProperty::named(name).map_err(raised)?;
    parameter.place(section).ok_or_else(|| {
        let expected =
            "a number that the section states (a support has either a frequency or a stiffness)";
        crate::error::wrong("section", expected, format!("`{name}`"))
    })
}
