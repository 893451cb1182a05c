//! The deck LN21-5200 with a lateral support: 18 derivatives, three degrees of freedom.

use aerodeck::aerodynamics::Realizable;
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::files::derivatives::embedded;
use aerodeck::identification::{Constraints, Fitted, Form, FrequencyFit, fit_table};
use aerodeck::section::{Dof, SectionModel, Translation};
use aerodeck::trained_model::{Experiment, Provenance, SCHEMA_VERSION, TrainedModel};

/// The section of Table 4.1 with 15 kg/m, 0.3 % and this frequency (Hz) sideways.
pub fn section(lateral_hz: f64) -> SectionModel {
    let mut section = SectionModel::table_4_1();
    section.lateral = Some(Translation {
        mass_kg_m: 15.0,
        frequency_hz: Some(lateral_hz),
        stiffness_n_m2: None,
        damping_ratio: 0.003,
    });
    section
}

/// A model of all 18 derivatives.
pub fn trained(form: Form, lateral_hz: f64) -> TrainedModel {
    let table = embedded::deck("LN21-5200").unwrap();
    let fit = FrequencyFit {
        form,
        // the reference figures are those of least squares alone
        constraints: Constraints::None,
        ..FrequencyFit::default()
    };
    let Fitted { model, report } =
        fit_table(&table.samples(&Dof::THREE), &Dof::THREE, &fit).unwrap();
    TrainedModel {
        schema_version: SCHEMA_VERSION,
        name: "LN21-5200, three degrees of freedom".into(),
        section: section(lateral_hz),
        model,
        tested_range: report.tested_range,
        provenance: Provenance {
            source: "LN21-5200, measured derivatives".into(),
            licence: "as of the data".into(),
            method: report.method,
            aerodeck_version: env!("CARGO_PKG_VERSION").into(),
            notes: report.notes,
        },
        experiment: Experiment {
            wind_speed_m_s: 35.0,
            initial_vertical_m: 0.01,
            initial_rotation_rad: 0.01,
            stop_time_s: 10.0,
            step_size_s: 0.01,
            onset_search_limit_m_s: 60.0,
        },
    }
}

pub fn coupled(model: &TrainedModel) -> CoupledSection {
    let structure = model.section.structure().unwrap();
    CoupledSection::new(structure, model.model.realize()).unwrap()
}
