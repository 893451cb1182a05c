//! Theodorsen's flat plate: the section of Table 4.1, the IABSE benchmark, Fung's deck.

use super::{Case, Figure};
use crate::aerodynamics::{AerodynamicModel, FlatPlate};
use crate::error::{Error, Result};
use crate::flutter::{
    Onset, OnsetSearch, determinant_onset, divergence_speed, impedance, pk_onset, quasi_pk_mode,
    sanity_lines,
};
use crate::section::SectionModel;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use std::f64::consts::{PI, TAU};

pub(super) const IABSE: &str =
    "IABSE Task Group 3.1, step 1.1a, as quoted in the tests of the Python package wawi";

/// Figures about the flat plate.
pub const CASES: &[Case] = &[
    Case {
        name: "flat-plate-table-4.1",
        what: "Flat plate (Theodorsen, exact), section of Table 4.1",
        figures: &[
            Figure::new("onset speed", 39.468, 3, "m/s").headline(),
            Figure::new("frequency at onset", 3.5496, 4, "Hz").headline(),
        ],
        compute: table_4_1,
    },
    Case {
        name: "iabse-1.1a-onset",
        what: "Flat plate (Theodorsen), IABSE 1.1a, without the apparent rotary inertia as its participants do",
        figures: &[
            Figure::new("onset speed", 77.45, 2, "m/s")
                .published(IABSE)
                .within(0.05, "the published figure lies 0.04 % below the exact one")
                .headline(),
            Figure::new("onset speed", 77.480, 3, "m/s").headline(),
            Figure::new("frequency at onset", 0.19400, 5, "Hz").headline(),
            Figure::new("mode ratio |y|/(B|θ|)", 0.6526, 4, ""),
            Figure::new("phase of y to θ", -160.1, 1, "°"),
            Figure::new("reduced velocity V/(fB)", 12.883, 3, ""),
            Figure::new("onset speed with the rotary inertia", 77.242, 3, "m/s"),
            Figure::new(
                "frequency at onset with the rotary inertia",
                0.19358,
                5,
                "Hz",
            ),
            Figure::new("divergence speed", 90.466, 3, "m/s").headline(),
        ],
        compute: iabse_onset,
    },
    Case {
        name: "iabse-1.1a-in-wind",
        what: "Flat plate (Theodorsen), IABSE 1.1a: modes in wind by quasi-p-k, without the rotary inertia",
        figures: &[
            Figure::new("torsion at 15 m/s: frequency", 0.27591, 5, "Hz"),
            Figure::new("torsion at 15 m/s: damping ratio", 0.00971, 5, ""),
            Figure::new("torsion at 30 m/s: frequency", 0.26910, 5, "Hz"),
            Figure::new("torsion at 30 m/s: damping ratio", 0.01887, 5, ""),
            Figure::new("torsion at 45 m/s: frequency", 0.25602, 5, "Hz"),
            Figure::new("torsion at 45 m/s: damping ratio", 0.03115, 5, ""),
            Figure::new("torsion at 60 m/s: frequency", 0.23381, 5, "Hz"),
            Figure::new("torsion at 60 m/s: damping ratio", 0.04260, 5, ""),
            Figure::new("torsion at 75 m/s: frequency", 0.19969, 5, "Hz"),
            Figure::new("torsion at 75 m/s: damping ratio", 0.01594, 5, ""),
            Figure::new("heave at 15 m/s: frequency", 0.09873, 5, "Hz"),
            Figure::new("heave at 15 m/s: damping ratio", 0.03995, 5, ""),
            Figure::new("heave at 30 m/s: frequency", 0.09985, 5, "Hz"),
            Figure::new("heave at 30 m/s: damping ratio", 0.09207, 5, ""),
            Figure::new("heave at 45 m/s: frequency", 0.10101, 5, "Hz"),
            Figure::new("heave at 45 m/s: damping ratio", 0.16793, 5, ""),
            Figure::new("heave at 60 m/s: frequency", 0.10171, 5, "Hz"),
            Figure::new("heave at 60 m/s: damping ratio", 0.30089, 5, ""),
        ],
        compute: iabse_in_wind,
    },
    Case {
        name: "iabse-1.1a-in-wind-published",
        what: "Flat plate (Theodorsen), IABSE 1.1a: the printed figures of modes in wind",
        figures: &[
            in_wind("torsion at 15 m/s: damping ratio", 0.0096, ""),
            in_wind("torsion at 30 m/s: frequency", 0.2691, "Hz"),
            in_wind("torsion at 30 m/s: damping ratio", 0.0189, ""),
            in_wind("torsion at 45 m/s: frequency", 0.2561, "Hz"),
            in_wind("torsion at 45 m/s: damping ratio", 0.0309, ""),
            in_wind("torsion at 60 m/s: frequency", 0.2340, "Hz"),
            in_wind("torsion at 60 m/s: damping ratio", 0.0418, ""),
            in_wind("torsion at 75 m/s: frequency", 0.1994, "Hz"),
            in_wind("torsion at 75 m/s: damping ratio", 0.0148, ""),
            in_wind("heave at 15 m/s: frequency", 0.0987, "Hz"),
            in_wind("heave at 15 m/s: damping ratio", 0.0399, ""),
            in_wind("heave at 30 m/s: frequency", 0.0999, "Hz"),
            in_wind("heave at 30 m/s: damping ratio", 0.0921, ""),
            in_wind("heave at 45 m/s: frequency", 0.1014, "Hz"),
            in_wind("heave at 45 m/s: damping ratio", 0.1689, ""),
            in_wind("heave at 60 m/s: frequency", 0.1027, "Hz"),
            in_wind("heave at 60 m/s: damping ratio", 0.3034, ""),
        ],
        // the printed torsion frequency at 15 m/s, 0.279 Hz, lies above that in still air: a misprint for 0.276
        compute: || Ok(iabse_in_wind()?.split_off(1)),
    },
    Case {
        name: "iabse-1.1a-impedance",
        what: "Flat plate (Theodorsen), IABSE 1.1a: impedance at 45 m/s and 0.278 Hz, in units of 1e6 N/m² (N for rotation)",
        figures: &[
            Figure::new("Z_yy, real part", -0.0619, 4, "").published(IABSE),
            Figure::new("Z_yy, imaginary part", 0.0056, 4, "").published(IABSE),
            Figure::new("Z_yθ, real part", -0.1492, 4, "").published(IABSE),
            Figure::new("Z_yθ, imaginary part", -0.0811, 4, "").published(IABSE),
            Figure::new("Z_θy, real part", 0.0100, 4, "").published(IABSE),
            Figure::new("Z_θy, imaginary part", 0.0419, 4, "").published(IABSE),
            Figure::new("Z_θθ, real part", -1.1559, 4, "").published(IABSE),
            Figure::new("Z_θθ, imaginary part", 0.5382, 4, "").published(IABSE),
        ],
        compute: iabse_impedance,
    },
    Case {
        name: "iabse-1.1a-sanity-lines",
        what: "IABSE 1.1a: handbook formulas for the onset of a flat plate",
        figures: &[
            Figure::new("Selberg, factor 3.72", 76.385, 3, "m/s"),
            Figure::new("Selberg, factor 0.44", 76.175, 3, "m/s"),
            Figure::new("Rocard", 76.646, 3, "m/s"),
        ],
        compute: iabse_sanity,
    },
    Case {
        name: "iabse-1.1a-p-k",
        what: "Flat plate (Theodorsen), IABSE 1.1a: onset by the p-k iteration, without the rotary inertia",
        figures: &[
            Figure::new("onset speed", 77.480, 3, "m/s"),
            Figure::new("frequency at onset", 0.19400, 5, "Hz"),
        ],
        compute: iabse_by_iteration,
    },
    Case {
        name: "fung-p236",
        what: "Flat plate (Theodorsen), bridge deck of Fung, Theory of Aeroelasticity, p. 236 (μ 40, r² 0.6222, B 60 ft)",
        figures: &[
            Figure::new("onset speed", 161.763, 3, "ft/s").headline(),
            Figure::new("circular frequency at onset", 1.25246, 5, "rad/s"),
            Figure::new("reduced frequency ωb/V", 0.23228, 5, ""),
        ],
        compute: fung,
    },
];

const fn in_wind(quantity: &'static str, expected: f64, unit: &'static str) -> Figure {
    Figure::new(quantity, expected, 4, unit)
        .published(IABSE)
        .within(
            0.003,
            "methods for damped modes differ; strongly damped heave is farthest off",
        )
}

/// Reduced frequencies far on both sides of any onset here.
pub(super) const WIDE: ReducedFrequencyRange = ReducedFrequencyRange {
    min: ReducedFrequency::from_full_width(0.02),
    max: ReducedFrequency::from_full_width(10.0),
};

pub(super) const WITHOUT_ROTARY: FlatPlate = FlatPlate {
    rotary_inertia: false,
};

/// The onset by the determinant; a section that does not flutter is a failure here.
pub(super) fn by_determinant(
    section: &SectionModel,
    model: &dyn AerodynamicModel,
    range: ReducedFrequencyRange,
) -> Result<Onset> {
    determinant_onset("", &section.structure()?, model, range, 300.0)?
        .onset()
        .cloned()
        .ok_or_else(|| Error::Numerical("no onset up to 300 m/s".into()))
}

fn table_4_1() -> Result<Vec<f64>> {
    let onset = by_determinant(&SectionModel::table_4_1(), &FlatPlate::default(), WIDE)?;
    Ok(vec![onset.speed_m_s, onset.frequency_hz])
}

fn iabse_onset() -> Result<Vec<f64>> {
    let section = SectionModel::iabse_1_1a();
    let onset = by_determinant(&section, &WITHOUT_ROTARY, WIDE)?;
    let with_rotary = by_determinant(&section, &FlatPlate::default(), WIDE)?;
    let steady = FlatPlate::default().transfer(ReducedFrequency::from_full_width(0.0))?;
    let divergence = divergence_speed(&section.structure()?, &steady)?
        .ok_or_else(|| Error::Numerical("no divergence".into()))?;
    Ok(vec![
        onset.speed_m_s,
        onset.speed_m_s,
        onset.frequency_hz,
        onset.mode_ratio,
        onset.phase_deg,
        onset.reduced_velocity.v_star(),
        with_rotary.speed_m_s,
        with_rotary.frequency_hz,
        divergence,
    ])
}

fn iabse_sanity() -> Result<Vec<f64>> {
    let lines = sanity_lines(&SectionModel::iabse_1_1a().structure()?)
        .ok_or_else(|| Error::Numerical("no sanity lines".into()))?;
    Ok(vec![
        lines.selberg_rounded_m_s,
        lines.selberg_m_s,
        lines.rocard_m_s,
    ])
}

fn iabse_by_iteration() -> Result<Vec<f64>> {
    let structure = SectionModel::iabse_1_1a().structure()?;
    let search = OnsetSearch {
        speed_max_m_s: 100.0,
        speeds: 100,
    };
    let onset = pk_onset("", &structure, &WITHOUT_ROTARY, &search, None)?
        .onset()
        .cloned()
        .ok_or_else(|| Error::Numerical("no onset up to 100 m/s".into()))?;
    Ok(vec![onset.speed_m_s, onset.frequency_hz])
}

/// Frequency (Hz) and damping ratio: torsion at 15 to 75 m/s, heave at 15 to 60 m/s.
fn iabse_in_wind() -> Result<Vec<f64>> {
    let structure = SectionModel::iabse_1_1a().structure()?;
    let mode = |speed, dof| -> Result<[f64; 2]> {
        let z = quasi_pk_mode(&structure, &WITHOUT_ROTARY, speed, dof)?;
        Ok([z.im / TAU, -z.re / z.norm()])
    };
    let mut figures = Vec::new();
    for speed in [15.0, 30.0, 45.0, 60.0, 75.0] {
        figures.extend(mode(speed, 1)?);
    }
    for speed in [15.0, 30.0, 45.0, 60.0] {
        figures.extend(mode(speed, 0)?);
    }
    Ok(figures)
}

fn iabse_impedance() -> Result<Vec<f64>> {
    let structure = SectionModel::iabse_1_1a().structure()?;
    let z = impedance(&structure, &WITHOUT_ROTARY, 45.0, TAU * 0.278)?;
    let by_row = [z[(0, 0)], z[(0, 1)], z[(1, 0)], z[(1, 1)]];
    Ok(by_row
        .iter()
        .flat_map(|z| [z.re / 1e6, z.im / 1e6])
        .collect())
}

/// Fung's deck in feet; only ratios of mass and density count, so that the density may be 1.
fn fung() -> Result<Vec<f64>> {
    let (mass_ratio, radius_squared, semi_chord) = (40.0, 0.6222, 30.0);
    let (heave_squared, torsion_squared) = (0.775_f64, 2.41_f64);
    let mass = mass_ratio * PI * semi_chord * semi_chord;
    let section = SectionModel::two_dof(
        2.0 * semi_chord,
        1.0,
        (mass, heave_squared.sqrt() / TAU, 0.0),
        (
            mass * radius_squared * semi_chord * semi_chord,
            torsion_squared.sqrt() / TAU,
            0.0,
        ),
    );
    let onset = by_determinant(&section, &FlatPlate::default(), WIDE)?;
    Ok(vec![
        onset.speed_m_s,
        onset.frequency_hz * TAU,
        onset.reduced_frequency.semi_chord(),
    ])
}
