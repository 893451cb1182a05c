//! Measured decks as trained models.

use aerodeck::files::derivatives::embedded;
use aerodeck::identification::{Fitted, FrequencyFit, fit_table};
use aerodeck::section::{Dof, SectionModel};
use aerodeck::trained_model::{Experiment, Provenance, SCHEMA_VERSION, TrainedModel};

/// An embedded deck as it is fitted, with the section of Table 4.1, to be asked for onsets up to a speed (m/s).
pub fn of_deck(deck: &str, fit: &FrequencyFit, onset_search_limit_m_s: f64) -> TrainedModel {
    let table = embedded::deck(deck).expect("an embedded deck");
    let Fitted { model, report } =
        fit_table(&table.samples(&Dof::TWO), &Dof::TWO, fit).expect("a fit");
    TrainedModel {
        schema_version: SCHEMA_VERSION,
        name: deck.into(),
        section: SectionModel::table_4_1(),
        model,
        tested_range: report.tested_range,
        provenance: Provenance {
            source: table.header.source.clone(),
            licence: table.header.licence.clone(),
            method: report.method,
            aerodeck_version: env!("CARGO_PKG_VERSION").into(),
            notes: report.notes,
        },
        experiment: Experiment {
            wind_speed_m_s: 20.0,
            initial_vertical_m: 0.01,
            initial_rotation_rad: 0.0,
            stop_time_s: 10.0,
            step_size_s: 0.01,
            onset_search_limit_m_s,
        },
    }
}
