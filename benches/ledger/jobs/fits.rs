//! Fits to records: of one short record, of a full set, of hours, of a grid.

use super::models::{POLE, folder, full_set, records, records_as_json, sources};
use crate::entry::{Job, finding};
use aerodeck::flutter::OnsetSearch;
use aerodeck::identification::{
    Constraints, Form, Grid, GridAxis, PoleSearch, TimeFit, TimeWeights, fit_records,
};
use aerodeck::section::SectionModel;
use aerodeck::selection::select;
use aerodeck::study::demo_study_text;
use aerodeck::wind_tunnel::TunnelPlan;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::hint::black_box;
use std::process::{Command, Stdio};
use std::sync::Once;

pub(crate) const VALUES: usize = 50;
const FILTERS: usize = 10;
/// Every how many values the baseline of the grid computes: each costs the same.
const EVERY: usize = 10;
pub(crate) const SHARE: f64 = 1.0 / EVERY as f64;

/// One speed, four seconds a frequency, by the default fit.
pub(crate) fn short_record() -> Job {
    let plan = TunnelPlan {
        still_s: 1.0,
        segment_s: 4.0,
        ramp_s: 0.5,
        sampling_hz: 50.0,
        ..TunnelPlan::default()
    };
    let records = records(&plan, "LN21-5200");
    let fit = TimeFit::default();
    Job::new(move || {
        let fitted = fit_records(&sources(&records), &fit, &|_, _| ());
        black_box(fitted.expect("a fit").model);
    })
}

/// Six filters and least squares alone, as the baseline does it, over the full set with a given pole.
pub(crate) fn training() -> Job {
    let records = full_set();
    let fit = TimeFit {
        form: Form::laguerre(6),
        poles: PoleSearch::fixed(&[POLE]),
        constraints: Constraints::None,
        weights: TimeWeights::None,
        ..TimeFit::default()
    };
    Job::new(move || {
        let fitted = fit_records(&sources(&records), &fit, &|_, _| ());
        black_box(fitted.expect("a fit").model);
    })
}

pub(crate) fn training_argument() -> Value {
    json!({ "records": records_as_json(&full_set()), "filters": 6, "pole": POLE })
}

/// Four records of one hour at 200 Hz, written once.
pub(crate) fn prepare_hours() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let study = demo_study_text().replace(
            "[[model]]\nname = \"Laguerre\"",
            "[tunnel]\nsegment_s = 449.0\n\n[[model]]\nname = \"Laguerre\"",
        );
        std::fs::write(folder("hours").join("study.toml"), study).expect("a study");
        aerodeck("tunnel");
    });
}

/// `aerodeck train` on them, as its own process.
pub(crate) fn hours() -> Job {
    Job::new(|| aerodeck("train"))
}

fn aerodeck(command: &str) {
    let status = Command::new(env!("CARGO_BIN_EXE_aerodeck"))
        .args([command, "study.toml", "--quiet"])
        .current_dir(folder("hours"))
        .stdout(Stdio::null())
        .status();
    // a verdict on the models is no failure of the run
    assert!(
        status
            .expect("the program")
            .code()
            .is_some_and(|code| code < 2)
    );
}

fn values(low: f64, high: f64) -> Vec<f64> {
    let last = VALUES as f64 - 1.0;
    let value = |i| low + (high - low) * i as f64 / last;
    (0..VALUES).map(value).collect()
}

fn discrete_axis() -> GridAxis {
    GridAxis::Discrete(values(0.3, 0.95), TimeWeights::None)
}

fn continuous_axis() -> GridAxis {
    let fit = TimeFit {
        weights: TimeWeights::None,
        ..TimeFit::default()
    };
    GridAxis::Continuous(values(0.05, 1.9), Box::new(fit))
}

/// All models of the grid with their residuals.
fn grid(axis: GridAxis) -> Job {
    finding(full_set(), move |records| {
        let grid = Grid::new(&sources(records), axis.clone(), FILTERS, &|_, _| ())?;
        let fits = |value| grid.fits(value, &|_| true);
        Ok((0..VALUES).into_par_iter().map(fits).collect::<Vec<_>>())
    })
}

pub(crate) fn grid_discrete() -> Job {
    grid(discrete_axis())
}

pub(crate) fn grid_continuous() -> Job {
    grid(continuous_axis())
}

fn grid_argument(axis: &GridAxis, continuous: bool) -> Value {
    let shared: Vec<f64> = axis.values().iter().copied().step_by(EVERY).collect();
    json!({
        "records": records_as_json(&full_set()), "values": shared, "filters": FILTERS, "continuous": continuous,
    })
}

pub(crate) fn grid_discrete_argument() -> Value {
    grid_argument(&discrete_axis(), false)
}

pub(crate) fn grid_continuous_argument() -> Value {
    grid_argument(&continuous_axis(), true)
}

/// Data left out, onsets and guards of all cells of the continuous grid.
pub(crate) fn judging() -> Job {
    let records = full_set();
    let grid =
        Grid::new(&sources(&records), continuous_axis(), FILTERS, &|_, _| ()).expect("a grid");
    let structure = SectionModel::table_4_1().structure().expect("a structure");
    let search = OnsetSearch {
        speed_max_m_s: 60.0,
        speeds: 120,
    };
    Job::new(move || {
        black_box(select(&grid, &structure, &search, &|_, _| ()).expect("a selection"));
    })
}
