//! The flat plate: Theodorsen's and Jones's, sections of textbooks and benchmarks, its response to gusts.

use crate::aerodynamics::{FlatPlate, RationalModel, Transfer};
use crate::aeroelastic::CoupledSection;
use crate::buffeting::{
    Admittance, BuffetingProblem, FrequencyDomain, Gust, GustComponent, GustSpectrum,
    SpectrumShape, Turbulence,
};
use crate::error::{Error, Result};
use crate::flutter::{
    FlutterSearch, ModeRatio, Onset, OnsetSearch, determinant_onset, divergence_speed, find_onset,
    impedance, pk_onset, quasi_pk_mode,
};
use crate::section::{Rotation, SectionModel, Translation};
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use crate::verdict::sanity_lines;
use std::f64::consts::{PI, TAU};

/// Reduced frequencies far on both sides of any onset here.
pub(super) const WIDE: ReducedFrequencyRange = ReducedFrequencyRange::between(
    ReducedFrequency::from_full_width(0.02),
    ReducedFrequency::from_full_width(10.0),
);

pub(super) const WITHOUT_ROTARY: FlatPlate = FlatPlate {
    rotary_inertia: false,
};

/// The onset by the determinant; a section that does not flutter is a failure here.
pub(super) fn by_determinant(
    section: &SectionModel,
    model: &dyn Transfer,
    range: ReducedFrequencyRange,
) -> Result<Onset> {
    let highest_m_s = 300.0;
    let found = determinant_onset("", &section.structure()?, model, range, highest_m_s)?;
    onset_of(&found, highest_m_s)
}

fn onset_of(found: &FlutterSearch, highest_m_s: f64) -> Result<Onset> {
    let none = || Error::Numerical(format!("no onset up to {highest_m_s} m/s"));
    found.onset().cloned().ok_or_else(none)
}

pub(super) fn table_4_1() -> Result<Vec<f64>> {
    let onset = by_determinant(&SectionModel::table_4_1(), &FlatPlate::default(), WIDE)?;
    Ok(vec![onset.at.speed_m_s, onset.at.frequency_hz])
}

fn with_rotation(onset: &Onset) -> Result<ModeRatio> {
    let none = || Error::Numerical("no rotation at the onset".into());
    onset.mode.ok_or_else(none)
}

pub(super) fn iabse_onset() -> Result<Vec<f64>> {
    let section = SectionModel::iabse_1_1a();
    let onset = by_determinant(&section, &WITHOUT_ROTARY, WIDE)?;
    let with_rotary = by_determinant(&section, &FlatPlate::default(), WIDE)?;
    let mode = with_rotation(&onset)?;
    Ok(vec![
        onset.at.speed_m_s,
        onset.at.speed_m_s,
        onset.at.frequency_hz,
        mode.mode_ratio,
        mode.phase_deg,
        onset.at.reduced_velocity.v_star(),
        with_rotary.at.speed_m_s,
        with_rotary.at.frequency_hz,
        divergence(&section)?,
    ])
}

pub(super) fn iabse_sanity() -> Result<Vec<f64>> {
    let lines = sanity_lines(&SectionModel::iabse_1_1a().structure()?)
        .ok_or_else(|| Error::Numerical("no sanity lines".into()))?;
    Ok(vec![
        lines.selberg_rounded_m_s,
        lines.selberg_m_s,
        lines.rocard_m_s,
    ])
}

pub(super) fn iabse_by_iteration() -> Result<Vec<f64>> {
    let structure = SectionModel::iabse_1_1a().structure()?;
    let search = OnsetSearch::new(100.0, 100);
    let found = pk_onset("", &structure, &WITHOUT_ROTARY, &search, None)?;
    let onset = onset_of(&found, search.speed_max_m_s)?;
    Ok(vec![onset.at.speed_m_s, onset.at.frequency_hz])
}

/// Frequency (Hz) and damping ratio: torsion at 15 to 75 m/s, heave at 15 to 60 m/s.
pub(super) fn iabse_in_wind() -> Result<Vec<f64>> {
    let structure = SectionModel::iabse_1_1a().structure()?;
    let mode = |speed, dof| -> Result<[f64; 2]> {
        let z = quasi_pk_mode(&structure, &WITHOUT_ROTARY, speed, dof)?;
        Ok([z.im / TAU, -z.re / z.norm()])
    };
    let mut figures = Vec::new();
    for speed in SPEEDS_M_S {
        figures.extend(mode(speed, 1)?);
    }
    for speed in &SPEEDS_M_S[..4] {
        figures.extend(mode(*speed, 0)?);
    }
    Ok(figures)
}

pub(super) fn iabse_impedance() -> Result<Vec<f64>> {
    let structure = SectionModel::iabse_1_1a().structure()?;
    let z = impedance(&structure, &WITHOUT_ROTARY, 45.0, TAU * 0.278)?;
    let by_row = [z[(0, 0)], z[(0, 1)], z[(1, 0)], z[(1, 1)]];
    let parts = by_row.iter().flat_map(|z| [z.re / 1e6, z.im / 1e6]);
    Ok(parts.collect())
}

/// Fung's deck in feet; only ratios of mass and density count, so that the density may be 1.
pub(super) fn fung() -> Result<Vec<f64>> {
    let (mass_ratio, radius_squared, semi_chord) = (40.0, 0.6222, 30.0);
    let (heave_squared, torsion_squared) = (0.775_f64, 2.41_f64);
    let mass = mass_ratio * PI * semi_chord * semi_chord;
    let inertia = mass * radius_squared * semi_chord * semi_chord;
    let heave = Translation::new(mass, heave_squared.sqrt() / TAU, 0.0);
    let torsion = Rotation::new(inertia, torsion_squared.sqrt() / TAU, 0.0);
    let section = SectionModel::two_dof(2.0 * semi_chord, 1.0, heave, torsion);
    let onset = by_determinant(&section, &FlatPlate::default(), WIDE)?;
    Ok(vec![
        onset.at.speed_m_s,
        onset.at.frequency_hz * TAU,
        onset.at.reduced_frequency.semi_chord(),
    ])
}

fn divergence(section: &SectionModel) -> Result<f64> {
    let steady = FlatPlate::default().transfer(ReducedFrequency::from_full_width(0.0))?;
    divergence_speed(&section.structure()?, &steady)?
        .ok_or_else(|| Error::Numerical("no divergence".into()))
}

/// With `b`, `ω_α` and `ρ` of one only the ratios are left.
pub(super) fn typical(a: f64) -> Result<Vec<f64>> {
    let mass = 20.0 * PI;
    let heave = Translation::new(mass, 0.4 / TAU, 0.0);
    let torsion = Rotation::new(0.24 * mass, 1.0 / TAU, 0.0);
    let mut section = SectionModel::two_dof(2.0, 1.0, heave, torsion);
    section.axis_offset_m = Some(a);
    section.mass_offset_m = Some(0.1);
    let onset = by_determinant(&section, &FlatPlate::default(), WIDE)?;
    Ok(vec![
        onset.at.speed_m_s,
        TAU * onset.at.frequency_hz,
        divergence(&section)?,
    ])
}

pub(super) fn unbalanced() -> Result<Vec<f64>> {
    let mut section = SectionModel::table_4_1();
    section.axis_offset_m = Some(0.05);
    section.mass_offset_m = Some(0.03);
    let onset = by_determinant(&section, &FlatPlate::default(), WIDE)?;
    let search = OnsetSearch::new(42.0, 84);
    let structure = section.structure()?;
    let found = pk_onset("", &structure, &FlatPlate::default(), &search, None)?;
    let by_iteration = onset_of(&found, search.speed_max_m_s)?;
    Ok(vec![
        onset.at.speed_m_s,
        onset.at.frequency_hz,
        by_iteration.at.speed_m_s,
        divergence(&section)?,
    ])
}

pub(super) fn jones_coefficients() -> Result<Vec<f64>> {
    let jones = RationalModel::jones_flat_plate();
    let terms = jones.lag_terms.iter();
    let by_row = terms.flat_map(|a| [a[(0, 0)], a[(0, 1)], a[(1, 0)], a[(1, 1)]]);
    Ok(by_row.collect())
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
    let search = OnsetSearch::up_to(speed_max_m_s);
    onset_of(&find_onset("", section, &search, tested)?, speed_max_m_s)
}

pub(super) fn jones_onset() -> Result<Vec<f64>> {
    let mut section = SectionModel::iabse_1_1a();
    let onset = by_eigenvalues(&coupled(&section)?, 120.0, None)?;
    let second = by_determinant(&section, &RationalModel::jones_flat_plate(), WIDE)?;
    let mode = with_rotation(&onset)?;
    let mut figures = vec![
        onset.at.speed_m_s,
        onset.at.frequency_hz,
        mode.mode_ratio,
        mode.phase_deg,
        second.at.speed_m_s,
    ];
    for density in [1.20, 1.25] {
        section.air_density_kg_m3 = density;
        let onset = by_eigenvalues(&coupled(&section)?, 120.0, None)?;
        figures.push(onset.at.speed_m_s);
    }
    Ok(figures)
}

/// At each speed the two modes, the slower first, then the real eigenvalues of the lags, the fastest first.
pub(super) fn jones_eigenvalues() -> Result<Vec<f64>> {
    let section = coupled(&SectionModel::iabse_1_1a())?;
    let mut figures = Vec::new();
    for speed in [45.0, 15.0] {
        let all = section.at(speed)?.eigenvalues()?;
        let mut modes: Vec<_> = all.iter().filter(|z| z.im > 1e-9).collect();
        modes.sort_by(|a, b| a.im.total_cmp(&b.im));
        figures.extend(modes.iter().flat_map(|z| [z.re, z.im]));
        let real = all.iter().filter(|z| z.im.abs() <= 1e-9);
        let mut lags: Vec<f64> = real.map(|z| z.re).collect();
        lags.sort_by(f64::total_cmp);
        figures.extend(lags);
    }
    Ok(figures)
}

const SPEEDS_M_S: [f64; 5] = [15.0, 30.0, 45.0, 60.0, 75.0];

const W: Gust = Gust {
    spectrum: GustSpectrum {
        shape: SpectrumShape::VonKarman {},
        length_m: 20.0,
        intensity: 0.05,
    },
    admittance: Admittance::Davenport { decay: 7.0 },
};

/// Density of the vertical gusts at 0.278 Hz and 45 m/s, m²/s.
pub(super) fn gust_density() -> Result<Vec<f64>> {
    let vertical = GustComponent::Vertical;
    Ok(vec![W.spectrum.density(vertical, 0.278, 45.0)])
}

/// RMS of `y` and of `θ·B/2` (m) at the five speeds.
pub(super) fn iabse_rms() -> Result<Vec<f64>> {
    let structure = SectionModel::iabse_1_1a().structure()?;
    let turbulence = Turbulence {
        along: None,
        vertical: Some(W),
    };
    let problem = BuffetingProblem::of_section(&structure, &WITHOUT_ROTARY, None, &turbulence)?;
    let at = |speed: &f64| FrequencyDomain::new(&problem, *speed)?.section_response(None);
    let responses = SPEEDS_M_S.iter().map(at).collect::<Result<Vec<_>>>()?;
    let heave = responses.iter().map(|r| r.rms[0]);
    let edge = responses.iter().map(|r| r.rms[1] * 0.5 * structure.width_m);
    Ok(heave.chain(edge).collect())
}
