use super::*;
use crate::units::ReducedFrequency as K;

fn jones() -> TrainedModel {
    TrainedModel {
        schema_version: SCHEMA_VERSION,
        name: "flat plate".into(),
        section: SectionModel::table_4_1(),
        model: Model::Rational(RationalModel::jones_flat_plate()),
        tested_range: ReducedFrequencyRange::between(
            K::from_full_width(0.07),
            K::from_full_width(1.5),
        ),
        provenance: Provenance {
            source: "R. T. Jones".into(),
            licence: "public".into(),
            method: "closed form".into(),
            aerodeck_version: env!("CARGO_PKG_VERSION").into(),
            notes: vec![],
        },
        experiment: Experiment {
            wind_speed_m_s: 38.0,
            initial_vertical_m: 0.01,
            initial_rotation_rad: 0.0,
            stop_time_s: 10.0,
            step_size_s: 0.01,
            onset_search_limit_m_s: 100.0,
        },
    }
}

#[test]
fn json_round_trip_is_bit_exact() {
    let model = jones();
    let text = model.to_json().unwrap();
    let again = TrainedModel::from_json(&text).unwrap();
    assert_eq!(model, again);
    assert_eq!(text, again.to_json().unwrap());
}

/// Filters of single transfer functions need the newer layout and survive it; shared ones stay in the older one.
#[test]
fn own_filters_take_the_newer_layout() {
    let shared = DiscreteLaguerre::shared(
        Dof::TWO.to_vec(),
        0.6,
        0.0817,
        vec![nalgebra::DMatrix::from_element(2, 3, 0.1); 2],
        vec![0.0; 2],
    );
    let mut own = shared.clone();
    own.terms[1].alpha = 0.8;
    for (model, version) in [(shared, 1), (own, 2)] {
        let mut trained = jones();
        trained.model = Model::DiscreteLaguerre(model);
        assert_eq!(trained.model.schema_version(), version);
        let error = trained.to_json().err().map(|e| e.to_string());
        let expected = "schema_version: expected at least 2 for this model, found 1";
        assert_eq!(error.as_deref(), (version == 2).then_some(expected));
        trained.schema_version = version;
        let again = TrainedModel::from_json(&trained.to_json().unwrap()).unwrap();
        assert_eq!(again, trained);
    }
}

#[test]
fn damaged_files_are_refused_with_their_place() {
    let text = jones().to_json().unwrap();
    let newer = text.replace("\"schema_version\": 1", "\"schema_version\": 99");
    let refusal = |text: &str| TrainedModel::from_json(text).unwrap_err().to_string();
    assert_eq!(refusal(&newer), "schema_version: expected 1 to 2, found 99");
    assert!(refusal(&text[..text.len() / 2]).contains("line"));
    let negative = text.replace("\"mass_kg_m\": 15.0", "\"mass_kg_m\": -15.0");
    assert!(refusal(&negative).contains("mass_kg_m"));
    // what no description of an FMU may say
    let nameless = text.replace("flat plate", "");
    assert_eq!(refusal(&nameless), "name: expected a name, found none");
    let mut long = jones();
    long.experiment.step_size_s = 2.0 * long.experiment.stop_time_s;
    let said = long.validate().unwrap_err().to_string();
    assert!(said.starts_with("experiment.step_size_s: expected at most experiment.stop_time_s"));
    // a name goes to files and pages
    let said = "expected a text without control characters, found one with them";
    for (key, from) in [("name", "flat plate"), ("provenance.source", "R. T. Jones")] {
        let obeyed = text.replace(from, "a\\u001b[31m");
        assert_eq!(refusal(&obeyed), format!("{key}: {said}"));
    }
}

/// Newer forms take the newer layout and survive it; a file of the older layout cannot hold them.
#[test]
fn newer_forms_take_the_newer_layout() {
    let shared = jones();
    assert_eq!(shared.model.schema_version(), SCHEMA_VERSION);
    let mut own = RationalModel::jones_flat_plate();
    own.lags = Lags::PerForce(vec![vec![0.08, 0.7], vec![0.1, 0.5]]);
    let roger = RationalModel::jones_flat_plate();
    let small = MinimumStateModel {
        dofs: roger.dofs,
        a1: roger.a1,
        a2: roger.a2,
        a3: roger.a3,
        lags: vec![0.2],
        d: nalgebra::DMatrix::from_element(2, 1, 0.5),
        e: nalgebra::DMatrix::from_element(1, 2, -1.5),
    };
    for model in [Model::Rational(own), Model::MinimumState(small)] {
        let trained = TrainedModel {
            schema_version: model.schema_version(),
            model,
            ..jones()
        };
        assert_eq!(trained.schema_version, 2);
        let text = trained.to_json().unwrap();
        assert_eq!(TrainedModel::from_json(&text).unwrap(), trained);
        let older = text.replace("\"schema_version\": 2", "\"schema_version\": 1");
        assert_eq!(
            TrainedModel::from_json(&older).unwrap_err().to_string(),
            "schema_version: expected at least 2 for this model, found 1"
        );
    }
}
