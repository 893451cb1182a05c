//! The flat plate with R. T. Jones's approximation: a rational function, hence exact in state space.

use super::flat_plate::{WIDE, by_determinant};
use super::{Case, Figure};
use crate::aerodynamics::RationalModel;
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result};
use crate::flutter::{Onset, OnsetSearch, find_onset};
use crate::section::SectionModel;
use crate::units::ReducedFrequencyRange;

const CLOSED_FORM: &str = "closed form from R. T. Jones, NACA Report 681 (1940)";

const fn coefficient(quantity: &'static str, expected: f64) -> Figure {
    Figure::new(quantity, expected, 6, "").computed(CLOSED_FORM)
}

/// Figures about Jones's rational function.
pub const CASES: &[Case] = &[
    Case {
        name: "jones-coefficients",
        what: "Flat plate as a rational function (Jones): lag terms in Roger's form",
        figures: &[
            coefficient("a4, lift by heave", -0.094342),
            coefficient("a4, lift by rotation", -1.013140),
            coefficient("a4, moment by heave", -0.023586),
            coefficient("a4, moment by rotation", -0.253285),
            coefficient("a5, lift by heave", -1.262920),
            coefficient("a5, lift by rotation", -1.789137),
            coefficient("a5, moment by heave", -0.315730),
            coefficient("a5, moment by rotation", -0.447284),
        ],
        compute: coefficients,
    },
    Case {
        name: "jones-iabse-1.1a-onset",
        what: "Flat plate (Jones), IABSE 1.1a, by eigenvalues",
        figures: &[
            Figure::new("onset speed", 76.6790, 4, "m/s").headline(),
            Figure::new("frequency at onset", 0.19319, 5, "Hz"),
            Figure::new("mode ratio |y|/(B|θ|)", 0.65745, 5, "").headline(),
            Figure::new("phase of y to θ", -160.343, 3, "°").headline(),
            Figure::new("onset speed by the determinant", 76.6790, 4, "m/s"),
            Figure::new("onset speed at 1.20 kg/m³", 77.2838, 4, "m/s"),
            Figure::new("onset speed at 1.25 kg/m³", 75.8002, 4, "m/s"),
        ],
        compute: onset,
    },
    Case {
        name: "jones-iabse-1.1a-eigenvalues",
        what: "Flat plate (Jones), IABSE 1.1a: eigenvalues in wind",
        figures: &[
            rate("heave at 45 m/s, real part", -0.110397),
            rate("heave at 45 m/s, imaginary part", 0.641068),
            rate("torsion at 45 m/s, real part", -0.053759),
            rate("torsion at 45 m/s, imaginary part", 1.601890),
            rate("lag 1 at 45 m/s", -0.870968),
            rate("lag 2 at 45 m/s", -0.743344),
            rate("lag 3 at 45 m/s", -0.132097),
            rate("lag 4 at 45 m/s", -0.122668),
            rate("heave at 15 m/s, real part", -0.023454),
            rate("heave at 15 m/s, imaginary part", 0.620836),
            rate("torsion at 15 m/s, real part", -0.016703),
            rate("torsion at 15 m/s, imaginary part", 1.724254),
            rate("lag 1 at 15 m/s", -0.290323),
            rate("lag 2 at 15 m/s", -0.283354),
            rate("lag 3 at 15 m/s", -0.044032),
            rate("lag 4 at 15 m/s", -0.043766),
        ],
        compute: eigenvalues,
    },
];

const fn rate(quantity: &'static str, expected: f64) -> Figure {
    Figure::new(quantity, expected, 6, "rad/s")
}

fn coefficients() -> Result<Vec<f64>> {
    let jones = RationalModel::jones_flat_plate();
    Ok(jones
        .lag_terms
        .iter()
        .flat_map(|a| [a[(0, 0)], a[(0, 1)], a[(1, 0)], a[(1, 1)]])
        .collect())
}

/// The section with Jones's rational function.
fn coupled(section: &SectionModel) -> Result<CoupledSection> {
    CoupledSection::with_model(&section.structure()?, &RationalModel::jones_flat_plate())
}

/// The onset by eigenvalues, inside the tested range if there is one; a section that does not flutter is a failure here.
pub(super) fn by_eigenvalues(
    section: &CoupledSection,
    speed_max_m_s: f64,
    tested: Option<ReducedFrequencyRange>,
) -> Result<Onset> {
    let search = OnsetSearch {
        speed_max_m_s,
        ..OnsetSearch::default()
    };
    find_onset("", section, &search, tested)?
        .onset()
        .cloned()
        .ok_or_else(|| Error::Numerical(format!("no onset up to {speed_max_m_s} m/s")))
}

fn onset() -> Result<Vec<f64>> {
    let mut section = SectionModel::iabse_1_1a();
    let onset = by_eigenvalues(&coupled(&section)?, 120.0, None)?;
    let second = by_determinant(&section, &RationalModel::jones_flat_plate(), WIDE)?;
    let mut figures = vec![
        onset.speed_m_s,
        onset.frequency_hz,
        onset.mode_ratio,
        onset.phase_deg,
        second.speed_m_s,
    ];
    for density in [1.20, 1.25] {
        section.air_density_kg_m3 = density;
        figures.push(by_eigenvalues(&coupled(&section)?, 120.0, None)?.speed_m_s);
    }
    Ok(figures)
}

/// At each speed the two modes, the slower first, then the real eigenvalues of the lags, the fastest first.
fn eigenvalues() -> Result<Vec<f64>> {
    let section = coupled(&SectionModel::iabse_1_1a())?;
    let mut figures = Vec::new();
    for speed in [45.0, 15.0] {
        let all = section.at(speed)?.eigenvalues()?;
        let mut modes: Vec<_> = all.iter().filter(|z| z.im > 1e-9).collect();
        modes.sort_by(|a, b| a.im.total_cmp(&b.im));
        figures.extend(modes.iter().flat_map(|z| [z.re, z.im]));
        let mut lags: Vec<f64> = all
            .iter()
            .filter(|z| z.im.abs() <= 1e-9)
            .map(|z| z.re)
            .collect();
        lags.sort_by(f64::total_cmp);
        figures.extend(lags);
    }
    Ok(figures)
}
