//! Fits to the decks, and where they grow.

use crate::matrix::{NamedSection, fastest_growth};
use aerodeck::aerodynamics::derivatives::DerivativeTable;
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::identification::{
    Constraints, FitReport, Fitted, Form, FrequencyFit, MOST_CHOSEN, fit_table,
};
use aerodeck::section::{Dof, SectionModel};
use aerodeck::trained_model::Model;
use aerodeck::wind_tunnel::{Record, RecordSource};

/// Lowest wind speed, m/s.
const SLOWEST_M_S: f64 = 0.05;

/// Highest wind speed: beyond every onset of the decks, by section.
pub fn fastest_m_s(section: &NamedSection) -> f64 {
    if section.name.starts_with("IABSE") {
        90.0
    } else {
        46.0
    }
}

/// Wind speeds of a scan.
const SPEEDS: usize = 400;

/// Bands of wind speed in which something grows.
pub fn bands(model: &Model, named: &NamedSection) -> Vec<(f64, f64)> {
    let Some(section) = coupled(model, &named.section) else {
        // mass and added mass together are no mass: nothing can be said at any speed
        return vec![(SLOWEST_M_S, fastest_m_s(named)); 2];
    };
    let top = fastest_m_s(named);
    let mut bands: Vec<(f64, f64)> = Vec::new();
    let mut grew = false;
    for i in 0..SPEEDS {
        let speed = SLOWEST_M_S * (top / SLOWEST_M_S).powf(i as f64 / (SPEEDS as f64 - 1.0));
        let grows = fastest_growth(&section, speed) > 0.0;
        match bands.last_mut() {
            Some(last) if grows && grew => last.1 = speed,
            _ if grows => bands.push((speed, speed)),
            _ => {}
        }
        grew = grows;
    }
    bands
}

pub fn coupled(model: &Model, section: &SectionModel) -> Option<CoupledSection> {
    CoupledSection::with_model(&section.structure().unwrap(), model).ok()
}

/// Onset between the last stable speed of a scan and the first of the last band, by bisection.
pub fn onset_m_s(model: &Model, named: &NamedSection) -> f64 {
    let Some(section) = coupled(model, &named.section) else {
        return f64::NAN;
    };
    let bands = bands(model, named);
    let above = bands
        .last()
        .unwrap_or_else(|| panic!("no onset: {}", named.name))
        .0;
    let ratio = (fastest_m_s(named) / SLOWEST_M_S).powf(1.0 / (SPEEDS as f64 - 1.0));
    let (mut low, mut high) = (above / ratio, above);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if fastest_growth(&section, middle) > 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

pub fn rational(lags: usize) -> Form {
    Form::Rational {
        lags,
        added_mass: true,
    }
}

pub fn forms() -> Vec<Form> {
    let filters = (1..=MOST_CHOSEN).map(Form::laguerre);
    filters.chain((1..3).map(rational)).collect()
}

pub fn fitted(
    table: &DerivativeTable,
    dofs: &[Dof],
    form: &Form,
    constraints: Constraints,
) -> Fitted {
    let fit = FrequencyFit {
        form: form.clone(),
        constraints,
        ..FrequencyFit::default()
    };
    fit_table(&table.samples(dofs), dofs, &fit)
        .unwrap_or_else(|e| panic!("{}, {}: {e}", table.name, form.describe()))
}

/// One band, the flutter beyond the onset, and nothing below it.
pub fn assert_stable_below_onset(what: &str, model: &Model, named: &NamedSection) {
    let found = bands(model, named);
    assert!(
        found.len() == 1,
        "{what}, {}: grows at {found:?} m/s",
        named.name
    );
}

/// Smallest objective that a search found.
pub fn objective(report: &FitReport) -> f64 {
    report.search[0].chosen.objective
}

pub fn sources(records: &[Record]) -> Vec<&dyn RecordSource> {
    records.iter().map(|r| r as &dyn RecordSource).collect()
}
