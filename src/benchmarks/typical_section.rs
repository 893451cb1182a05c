//! Typical sections of aeronautics: an axis that is not mid-chord and a centre of mass that is not on the axis.
//!
//! The references are roots of the flutter determinant of Theodorsen's forces about the axis `a b` aft of mid-chord, as
//! textbooks write them (Y. C. Fung, *An Introduction to the Theory of Aeroelasticity*, section 6.7; R. L.
//! Bisplinghoff, H. Ashley, R. L. Halfman, *Aeroelasticity*, section 5-6), with `h` down. This crate has the forces
//! about mid-chord and takes them to the axis.

use super::flat_plate::{WIDE, by_determinant};
use super::{Case, Figure};
use crate::aerodynamics::{AerodynamicModel, FlatPlate};
use crate::error::{Error, Result};
use crate::flutter::{OnsetSearch, divergence_speed, pk_onset};
use crate::section::SectionModel;
use crate::units::ReducedFrequency;
use std::f64::consts::{PI, TAU};

const METHOD: &str = "NumPy/SciPy, closed form about the axis";

/// Figures about typical sections.
pub const CASES: &[Case] = &[
    Case {
        name: "typical-section",
        what: "Flat plate (Theodorsen), typical section a −0.2, x_α 0.1, μ 20, r² 0.24, ω_h/ω_α 0.4: axis and centre of mass off mid-chord",
        figures: &[
            Figure::new("onset speed V/(bω_α)", 2.18391, 5, "")
                .computed(METHOD)
                .headline(),
            Figure::new("frequency at onset ω/ω_α", 0.648984, 6, "").computed(METHOD),
            Figure::new("divergence speed V/(bω_α)", 2.82843, 5, "").computed(METHOD),
        ],
        compute: || typical(-0.2),
    },
    Case {
        name: "typical-section-axis-aft",
        what: "Flat plate (Theodorsen), typical section a +0.2, x_α 0.1, μ 20, r² 0.24, ω_h/ω_α 0.4",
        figures: &[
            Figure::new("onset speed V/(bω_α)", 1.65037, 5, "").computed(METHOD),
            Figure::new("frequency at onset ω/ω_α", 0.646287, 6, "").computed(METHOD),
            Figure::new("divergence speed V/(bω_α)", 1.85164, 5, "").computed(METHOD),
        ],
        compute: || typical(0.2),
    },
    Case {
        name: "table-4.1-unbalanced",
        what: "Flat plate (Theodorsen), section of Table 4.1 with the axis 50 mm and the centre of mass 80 mm downwind of mid-chord",
        figures: &[
            Figure::new("onset speed by the determinant", 32.50389, 5, "m/s").computed(METHOD),
            Figure::new("frequency at onset", 3.289962, 6, "Hz").computed(METHOD),
            Figure::new("onset speed by the p-k iteration", 32.50389, 5, "m/s").computed(METHOD),
            Figure::new("divergence speed", 42.54740, 5, "m/s").computed(METHOD),
        ],
        compute: unbalanced,
    },
];

fn divergence(section: &SectionModel) -> Result<f64> {
    let steady = FlatPlate::default().transfer(ReducedFrequency::from_full_width(0.0))?;
    divergence_speed(&section.structure()?, &steady)?
        .ok_or_else(|| Error::Numerical("no divergence".into()))
}

/// With `b`, `ω_α` and `ρ` of one only the ratios are left.
fn typical(a: f64) -> Result<Vec<f64>> {
    let mass = 20.0 * PI;
    let mut section = SectionModel::two_dof(
        2.0,
        1.0,
        (mass, 0.4 / TAU, 0.0),
        (0.24 * mass, 1.0 / TAU, 0.0),
    );
    section.axis_offset_m = Some(a);
    section.mass_offset_m = Some(0.1);
    let onset = by_determinant(&section, &FlatPlate::default(), WIDE)?;
    Ok(vec![
        onset.speed_m_s,
        TAU * onset.frequency_hz,
        divergence(&section)?,
    ])
}

fn unbalanced() -> Result<Vec<f64>> {
    let mut section = SectionModel::table_4_1();
    section.axis_offset_m = Some(0.05);
    section.mass_offset_m = Some(0.03);
    let onset = by_determinant(&section, &FlatPlate::default(), WIDE)?;
    let search = OnsetSearch {
        speed_max_m_s: 42.0,
        speeds: 84,
    };
    let by_iteration = pk_onset(
        "",
        &section.structure()?,
        &FlatPlate::default(),
        &search,
        None,
    )?
    .onset()
    .cloned()
    .ok_or_else(|| Error::Numerical("no onset up to 42 m/s".into()))?;
    Ok(vec![
        onset.speed_m_s,
        onset.frequency_hz,
        by_iteration.speed_m_s,
        divergence(&section)?,
    ])
}
