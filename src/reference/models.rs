//! Models trained on records and tables, and tables read between their points.

use super::first_order::alpha_upper_bound;
use super::flat_plate::{WIDE, WITHOUT_ROTARY, by_determinant, by_eigenvalues};
use crate::aerodynamics::derivatives::{
    DerivativeTable, Extrapolation, InterpolatedTable, Interpolation,
};
use crate::aerodynamics::laguerre::{alpha_lower_bound, impulse_response};
use crate::aerodynamics::{FlatPlate, Transfer};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result};
use crate::files::derivatives::embedded;
use crate::flutter::{Onset, divergence_speed, static_part};
use crate::identification::{
    Constraints, DiscreteFit, Fitted, Form, FrequencyFit, FrequencyWeights, PoleSearch, TimeFit,
    fit_discrete, fit_records, fit_table, sample_model,
};
use crate::section::{Dof, SectionModel};
use crate::trained_model::Model;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use crate::wind_tunnel::{Record, RecordSource, TrainingMotion, TunnelPlan};
use std::f64::consts::TAU;

pub(super) fn guideline() -> Result<Vec<f64>> {
    let g = impulse_response(0.889, 4, 177);
    Ok(vec![
        alpha_lower_bound(3.0, 200.0),
        alpha_lower_bound(2.5, 200.0),
        g[(3, 176)].abs(),
        alpha_upper_bound(4, 176),
    ])
}

/// Reduced frequencies of Table 3.2 on the section of Table 4.1.
fn tested_k(speed_m_s: f64) -> Vec<ReducedFrequency> {
    let frequencies_hz = [0.25, 0.5, 0.8, 1.1, 1.4, 1.7, 2.0, 2.5];
    let at = |f| ReducedFrequency::from_hertz(f, 0.5, speed_m_s);
    frequencies_hz.map(at).to_vec()
}

pub(super) fn flat_plate_fits() -> Result<Vec<f64>> {
    let samples = sample_model(&FlatPlate::default(), &tested_k(8.17))?;
    let fit = |form: Form, poles: PoleSearch| {
        let options = FrequencyFit {
            form,
            poles,
            // the reference figures are those of least squares alone
            constraints: Constraints::None,
            ..FrequencyFit::default()
        };
        Ok::<_, Error>(fit_table(&samples, &Dof::TWO, &options)?.model)
    };
    let rational = |lags, added_mass| Form::Rational { lags, added_mass };
    let given = fit(Form::laguerre(3), PoleSearch::fixed(&[0.305]))?;
    let searched = fit(Form::laguerre(3), PoleSearch::default())?;
    let one = fit(rational(1, false), PoleSearch::default())?;
    let two = fit(rational(2, true), PoleSearch::default())?;
    let mut figures = vec![onset_of_fit(&given)?, onset_of_fit(&searched)?];
    figures.push(onset_of_fit(&one)?);
    figures.extend(lags(&one));
    figures.push(onset_of_fit(&two)?);
    figures.extend(lags(&two));
    Ok(figures)
}

/// The onset of a section in the forces of a model, by eigenvalues.
fn onset_of(
    section: &SectionModel,
    model: &Model,
    speed_max_m_s: f64,
    tested: Option<ReducedFrequencyRange>,
) -> Result<Onset> {
    let coupled = CoupledSection::with_model(&section.structure()?, model)?;
    by_eigenvalues(&coupled, speed_max_m_s, tested)
}

fn onset_of_fit(model: &Model) -> Result<f64> {
    let onset = onset_of(&SectionModel::table_4_1(), model, 80.0, None)?;
    Ok(onset.at.speed_m_s)
}

fn lags(model: &Model) -> Vec<f64> {
    match model {
        Model::Rational(m) => m.lags.of_force(0).to_vec(),
        _ => Vec::new(),
    }
}

fn sources(records: &[Record]) -> Vec<&dyn RecordSource> {
    records.iter().map(|r| r as &dyn RecordSource).collect()
}

fn onset_of_records(model: &Model, tested: ReducedFrequencyRange) -> Result<Onset> {
    onset_of(&SectionModel::table_4_1(), model, 50.0, Some(tested))
}

fn discrete_onset(records: &[Record], filters: usize) -> Result<Onset> {
    let fit = DiscreteFit {
        filters,
        ..DiscreteFit::default()
    };
    let Fitted { model, report } = fit_discrete(&sources(records), &fit, &|_, _| {})?;
    onset_of_records(&model, report.tested_range)
}

pub(super) fn thesis_flat_plate() -> Result<Vec<f64>> {
    let plan = TunnelPlan {
        speeds_m_s: vec![8.17],
        ..TunnelPlan::default()
    };
    let records = plan.records_from_model(&FlatPlate::default(), "flat plate", 0.5)?;
    let mut figures = Vec::new();
    for filters in [3, 5] {
        let onset = discrete_onset(&records, filters)?;
        figures.extend([onset.at.speed_m_s, onset.at.frequency_hz]);
    }
    Ok(figures)
}

pub(super) fn thesis_headline() -> Result<Vec<f64>> {
    let table = embedded::deck("LN21-5200")?;
    let at = |group: usize| -> Result<Onset> {
        let table = table.at_speed_group(group)?;
        let records = TunnelPlan::default().records_from_table(&table, &Dof::TWO)?;
        discrete_onset(&records, 3)
    };
    let (first, second) = (at(0)?, at(1)?);
    Ok(vec![
        first.at.speed_m_s,
        first.at.speed_m_s,
        first.at.frequency_hz,
        second.at.speed_m_s,
    ])
}

/// A model of the plate moved at random as in Table 3.2, one speed, white from 0.25 to 2.5 Hz; its onset as the full-scale
/// deck's.
pub(super) fn random_motion() -> Result<Vec<f64>> {
    let mut section = SectionModel::iabse_1_1a();
    section.air_density_kg_m3 = 1.2;
    let reduced = |speed: f64| {
        let frequencies = [section.vertical.frequency_hz, section.torsion.frequency_hz];
        let [vertical, torsion] = frequencies.map(|f| f.unwrap_or(f64::NAN));
        speed / (section.width_m * 0.5 * (vertical + torsion))
    };
    let exact = by_determinant(&section, &WITHOUT_ROTARY, WIDE)?;
    let plan = TunnelPlan {
        speeds_m_s: vec![8.17],
        motion: TrainingMotion::WhiteNoise {
            min_hz: 0.25,
            max_hz: 2.5,
            duration_s: 180.0,
        },
        ..TunnelPlan::default()
    };
    let records = plan.records_from_model(&WITHOUT_ROTARY, "flat plate", 0.5)?;
    let Fitted { model, report } =
        fit_records(&sources(&records), &TimeFit::default(), &|_, _| {})?;
    let trained = onset_of(&section, &model, 120.0, Some(report.tested_range))?;
    Ok(vec![
        reduced(exact.at.speed_m_s),
        exact.at.speed_m_s,
        exact.at.frequency_hz,
        reduced(trained.at.speed_m_s),
    ])
}

pub(super) fn laguerre_flat_plate() -> Result<Vec<f64>> {
    let plan = TunnelPlan {
        noise_fraction: 0.05,
        ..TunnelPlan::default()
    };
    let records = plan.records_from_model(&FlatPlate::default(), "flat plate", 0.5)?;
    // the reference figure is that of least squares alone
    let fit = TimeFit {
        constraints: Constraints::None,
        ..TimeFit::default()
    };
    let Fitted { model, report } = fit_records(&sources(&records), &fit, &|_, _| {})?;
    let onset = onset_of_records(&model, report.tested_range)?;
    Ok(vec![onset.at.speed_m_s])
}

/// Wind speeds of each deck and section, from near still air to the onset.
const SPEEDS_BELOW: u8 = 200;

/// Onset of each deck on the section of Table 4.1, on the full-scale one, and the speeds at which either grows below.
pub(super) fn dissipative() -> Result<Vec<f64>> {
    let small = SectionModel::table_4_1();
    let full_scale = SectionModel {
        air_density_kg_m3: small.air_density_kg_m3,
        ..SectionModel::iabse_1_1a()
    };
    let sections = [(small, 50.0), (full_scale, 120.0)];
    let mut figures = Vec::new();
    let mut growing = 0.0;
    for (section, speed_max_m_s) in &sections {
        for name in embedded::names() {
            let table = embedded::deck(name)?;
            let samples = table.samples(&Dof::TWO);
            let model = fit_table(&samples, &Dof::TWO, &FrequencyFit::default())?.model;
            let coupled = CoupledSection::with_model(&section.structure()?, &model)?;
            let tested = Some(table.tested_range(&Dof::TWO));
            let onset = by_eigenvalues(&coupled, *speed_max_m_s, tested)?;
            let onset = onset.at.speed_m_s;
            figures.push(onset);
            for i in 1..=SPEEDS_BELOW {
                // up to just below the onset, from near still air
                let speed = 0.999 * onset * f64::from(i) / f64::from(SPEEDS_BELOW);
                let roots = coupled.at(speed)?.eigenvalues()?;
                growing += f64::from(u8::from(roots.iter().any(|z| z.re > 0.0)));
            }
        }
    }
    figures.push(growing);
    Ok(figures)
}

pub(super) fn over_decks(onset: fn(&DerivativeTable) -> Result<f64>) -> Result<Vec<f64>> {
    embedded::names()
        .map(|name| onset(&embedded::deck(name)?))
        .collect()
}

pub(super) fn interpolated(table: &DerivativeTable, by: Interpolation) -> Result<f64> {
    let model = InterpolatedTable::by(by, table, &Dof::TWO, Extrapolation::Refuse)?;
    let range = model.tested_range();
    let onset = by_determinant(&SectionModel::table_4_1(), &model, range)?;
    Ok(onset.at.speed_m_s)
}

pub(super) fn rational(
    table: &DerivativeTable,
    added_mass: bool,
    weights: FrequencyWeights,
) -> Result<f64> {
    let lags = 1;
    let fit = FrequencyFit {
        form: Form::Rational { lags, added_mass },
        weights,
        ..FrequencyFit::default()
    };
    fitted(table, fit)
}

pub(super) fn fitted(table: &DerivativeTable, fit: FrequencyFit) -> Result<f64> {
    // the reference figures are those of least squares alone
    let fit = FrequencyFit {
        constraints: Constraints::None,
        ..fit
    };
    let model = fit_table(&table.samples(&Dof::TWO), &Dof::TWO, &fit)?.model;
    let onset = onset_of_records(&model, table.tested_range(&Dof::TWO))?;
    Ok(onset.at.speed_m_s)
}

pub(super) fn rational_ln21_5200() -> Result<Vec<f64>> {
    use FrequencyWeights::{Derivatives, None as Unweighted, Relative};
    let table = embedded::deck("LN21-5200")?;
    let first = table.at_speed_group(0)?;
    Ok(vec![
        rational(&table, false, Derivatives)?,
        rational(&first, false, Derivatives)?,
        rational(&table, false, Unweighted)?,
        rational(&table, false, Relative)?,
        rational(&table, true, Derivatives)?,
        rational(&table, true, Unweighted)?,
        rational(&table, true, Relative)?,
    ])
}

/// Range of V̂ of every table.
const RANGE: (f64, f64) = (0.6, 8.0);
/// Tables of each number of points; neighbouring points are at least this far apart and at most that.
const TABLES: usize = 12;
const POINTS: [usize; 3] = [5, 7, 10];
const RATIOS: (f64, f64) = (1.1, 5.0);

/// Reduced velocities of every table: both ends and, between them, logarithmically uniform points that keep apart.
fn reduced_velocities() -> Vec<Vec<f64>> {
    // the congruential generator of D. E. Knuth (MMIX), upper 53 bits, which any language can repeat
    let mut state = 1_u64;
    let mut random = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (low, high) = RANGE;
    let mut drawn = |count: usize| {
        loop {
            let inner = (2..count).map(|_| low * (random() * (high / low).ln()).exp());
            let mut all: Vec<f64> = inner.chain([low, high]).collect();
            all.sort_by(f64::total_cmp);
            let ratios = || all.windows(2).map(|w| w[1] / w[0]);
            if ratios().all(|q| q > RATIOS.0 && q < RATIOS.1) {
                return all;
            }
        }
    };
    let counts = POINTS.iter().flat_map(|n| [*n; TABLES]);
    counts.map(&mut drawn).collect()
}

/// The flat plate at these reduced velocities; `B = 1 m` and `V = 1 m/s`, which have no influence.
fn tabulated(v_hats: &[f64]) -> Result<DerivativeTable> {
    let frequencies: Vec<f64> = v_hats.iter().map(|v| 1.0 / (TAU * v)).collect();
    let plate = FlatPlate::default();
    DerivativeTable::sampled("flat plate", &plate, 1.0, &[1.0], &frequencies)
}

pub(super) fn table_errors() -> Result<Vec<f64>> {
    use Interpolation::{CubicSpline, LinearVHat, ModifiedAkima};
    let sections = [SectionModel::table_4_1(), SectionModel::iabse_1_1a()];
    let mut figures = Vec::new();
    for by in [ModifiedAkima, CubicSpline, LinearVHat] {
        let mut errors = Vec::new();
        for section in &sections {
            let exact = by_determinant(section, &FlatPlate::default(), WIDE)?;
            for v_hats in reduced_velocities() {
                let table = tabulated(&v_hats)?;
                let model = InterpolatedTable::by(by, &table, &Dof::TWO, Extrapolation::Refuse)?;
                let onset = by_determinant(section, &model, model.tested_range())?;
                errors.push(100.0 * (onset.at.speed_m_s / exact.at.speed_m_s - 1.0));
            }
        }
        let squares: f64 = errors.iter().map(|e| e * e).sum();
        let worst = errors.iter().fold(0.0_f64, |w, e| w.max(e.abs()));
        let pair = [(squares / errors.len() as f64).sqrt(), worst];
        if by == Interpolation::default() {
            figures.extend(pair);
        }
        figures.extend(pair);
    }
    Ok(figures)
}

pub(super) fn table_divergence() -> Result<Vec<f64>> {
    let structure = SectionModel::iabse_1_1a().structure()?;
    let speed = |highest: f64| {
        let table = tabulated(&[1.0, 2.0, 4.0, highest])?;
        let model = InterpolatedTable::new(&table, &Dof::TWO, Extrapolation::Refuse)?;
        let lowest = model.transfer(ReducedFrequency::from_v_hat(highest))?;
        divergence_speed(&structure, &static_part(&Dof::TWO, &lowest))?
            .ok_or_else(|| Error::Numerical("no divergence".into()))
    };
    [8.0, 16.0, 32.0].into_iter().map(speed).collect()
}
