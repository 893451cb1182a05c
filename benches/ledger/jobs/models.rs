//! Models and records that several jobs use.

use crate::trained;
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::files::derivatives::embedded;
use aerodeck::identification::{Form, FrequencyFit, PoleSearch};
use aerodeck::section::Dof;
use aerodeck::trained_model::TrainedModel;
use aerodeck::wind_tunnel::{Record, RecordSource, TunnelPlan};
use nalgebra::DMatrix;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

const DECK: &str = "LN21-5200";
pub(crate) const POLE: f64 = 0.5;
pub(crate) const SPEED_MAX_M_S: f64 = 60.0;

/// A folder of this program's own below the target directory.
pub(crate) fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("ledger")
        .join(name);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Text of a committed model.
pub(crate) fn text(kind: &str) -> String {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/models");
    std::fs::read_to_string(format!("{folder}/{kind}.json")).expect("a model")
}

pub(crate) fn model(kind: &str) -> TrainedModel {
    TrainedModel::from_json(&text(kind)).expect("a model")
}

pub(crate) fn coupled(model: &TrainedModel) -> CoupledSection {
    use aerodeck::aerodynamics::Realizable;
    let structure = model.section.structure().expect("a structure");
    CoupledSection::new(structure, model.model.realize()).expect("a section")
}

/// The deck LN21-5200 by four filters per motion at a given pole: twelve states with the section.
pub(crate) fn four_filters() -> TrainedModel {
    let fit = FrequencyFit {
        form: Form::laguerre(4),
        poles: PoleSearch::fixed(&[POLE]),
        ..FrequencyFit::default()
    };
    trained::of_deck(DECK, &fit, SPEED_MAX_M_S)
}

/// The same with as many filters as asked for, at the pole that fits best: three are the form of the thesis, five those that a
/// fit takes by itself.
pub(crate) fn by_filters(filters: usize) -> TrainedModel {
    let fit = FrequencyFit {
        form: Form::laguerre(filters),
        ..FrequencyFit::default()
    };
    trained::of_deck(DECK, &fit, SPEED_MAX_M_S)
}

/// Records of 43 200 samples, four for each motion: 172 800 samples per motion.
pub(crate) fn full_set() -> Vec<Record> {
    ["LN21-5200", "LN21-5500"]
        .iter()
        .flat_map(|deck| records(&TunnelPlan::default(), deck))
        .collect()
}

pub(crate) fn records(plan: &TunnelPlan, deck: &str) -> Vec<Record> {
    let deck = embedded::deck(deck).expect("an embedded deck");
    plan.records_from_table(&deck, &Dof::TWO).expect("records")
}

pub(crate) fn sources(records: &[Record]) -> Vec<&dyn RecordSource> {
    records.iter().map(|r| r as &dyn RecordSource).collect()
}

pub(crate) fn records_as_json(records: &[Record]) -> Value {
    let one = |r: &Record| {
        json!({
            "width": r.header.width_m, "speed": r.header.mean_speed_m_s, "density": r.header.air_density_kg_m3,
            "sampling": r.header.sampling_hz, "motion": r.motion, "force": r.force,
        })
    };
    records.iter().map(one).collect()
}

pub(crate) fn rows(m: &DMatrix<f64>) -> Value {
    m.row_iter()
        .map(|r| r.iter().copied().collect::<Vec<_>>())
        .collect::<Vec<_>>()
        .into()
}
