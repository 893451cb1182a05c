//! The answers are those of the library, bit for bit.

use super::*;
use aerodeck_core::aerodynamics::{Lags, RationalModel, Transfer};
use aerodeck_core::trained_model::{Experiment, Model, Provenance, SCHEMA_VERSION};
use aerodeck_core::units::{ReducedFrequency, ReducedFrequencyRange};
use serde_json::{Value, json};

fn plate() -> TrainedModel {
    let text = String::from("test");
    TrainedModel {
        schema_version: SCHEMA_VERSION,
        name: "plate".into(),
        section: SectionModel::table_4_1(),
        model: Model::Rational(RationalModel::jones_flat_plate()),
        tested_range: ReducedFrequencyRange::between(
            ReducedFrequency::from_full_width(0.2),
            ReducedFrequency::from_full_width(3.0),
        ),
        provenance: Provenance {
            source: text.clone(),
            licence: text.clone(),
            method: text.clone(),
            aerodeck_version: text,
            notes: Vec::new(),
        },
        experiment: Experiment {
            wind_speed_m_s: 20.0,
            initial_vertical_m: 0.01,
            initial_rotation_rad: 0.01,
            stop_time_s: 10.0,
            step_size_s: 0.01,
            onset_search_limit_m_s: 70.0,
        },
    }
}

fn asked(section: &SectionModel, highest: f64) -> Value {
    asked_of(&plate(), section, highest)
}

fn asked_of(model: &TrainedModel, section: &SectionModel, highest: f64) -> Value {
    let request = json!({
        "model": serde_json::to_string(model).unwrap(), "section": section,
        "speed_min_m_s": 5.0, "speed_max_m_s": highest, "speeds": 40,
    });
    serde_json::from_str(&answer(&request.to_string())).unwrap()
}

#[test]
fn answers_are_those_of_the_library_to_the_last_bit() {
    let plate = plate();
    let mut section = plate.section.clone();
    section.torsion.frequency_hz = Some(4.2);
    section.vertical.damping_ratio = 0.011;
    let said = asked(&section, 60.0);

    let structure = section.structure().unwrap();
    let coupled = CoupledSection::with_model(&structure, &plate.model).unwrap();
    assert_eq!(
        plate.model.dofs().len(),
        said["modes"].as_array().unwrap().len()
    );
    let search = OnsetSearch {
        speed_max_m_s: 60.0,
        speeds: 40,
    };
    let found = find_onset("plate", &coupled, &search, Some(plate.tested_range)).unwrap();
    let speed = said["search"]["onset"]["speed_m_s"].as_f64().unwrap();
    assert_eq!(found.onset().unwrap().at.speed_m_s, speed);
    assert_eq!(said["search"], serde_json::to_value(&found).unwrap());
    assert_eq!(said["words"], found.explain());

    let speeds: Vec<f64> = (0..40).map(|i| 5.0 + 55.0 * i as f64 / 39.0).collect();
    let curves = trace_modes("plate", &coupled, &speeds).unwrap();
    for (branch, mode) in curves
        .branches
        .iter()
        .zip(said["modes"].as_array().unwrap())
    {
        assert_eq!(mode["name"], branch.name);
        // a branch ends where its motion stops oscillating
        assert!(branch.points.len() > 30);
        let points = mode["damping_ratio"].as_array().unwrap();
        assert_eq!(points.len(), branch.points.len());
        for (i, p) in branch.points.iter().enumerate() {
            assert_eq!(mode["speed_m_s"][i], p.speed_m_s);
            assert_eq!(mode["frequency_hz"][i], p.frequency_hz);
            assert_eq!(mode["damping_ratio"][i], p.damping_ratio);
        }
    }
}

#[test]
fn without_an_onset_it_says_up_to_where_none_is() {
    let said = asked(&plate().section, 20.0);
    assert_eq!(said["search"]["stable_up_to"]["to_m_s"], 20.0, "{said}");
    assert!(said["words"].as_str().unwrap().contains("20"), "{said}");
}

/// A page whose headline named divergence or growth outside the tests had sliders that knew of flutter alone.
#[test]
fn what_comes_before_flutter_is_said() {
    let plain = asked(&plate().section, 60.0);
    assert!(plain["first"].is_null(), "{plain}");
    // softer in torsion than in heave it does not flutter but diverges, unseen where the search ends below
    let mut soft = plate().section;
    soft.torsion.frequency_hz = Some(1.0);
    let said = asked(&soft, 60.0);
    let structure = soft.structure().unwrap();
    let speed = divergence_with_forces(&structure, &plate().model).unwrap();
    assert_eq!(said["divergence_m_s"].as_f64(), speed);
    let text = format!("static divergence at {} m/s", shown_m_s(speed.unwrap()));
    assert_eq!(said["first"], text, "{said}");
    assert!(asked(&soft, 0.9 * speed.unwrap())["first"].is_null());
    // fed with energy in fast heave, above K 2.6, where nothing was tested
    let mut model = RationalModel::jones_flat_plate();
    model.a2[(0, 0)] += 20.0;
    let mut lag = model.a2.clone() * 0.0;
    lag[(0, 0)] = -120.0;
    model.lag_terms.push(lag);
    model.lags = Lags::Shared(vec![0.091, 0.6, 6.0]);
    let mut fed = plate();
    fed.model = Model::Rational(model);
    fed.tested_range = ReducedFrequencyRange::between(
        ReducedFrequency::from_full_width(0.1),
        ReducedFrequency::from_full_width(1.5),
    );
    let said = asked_of(&fed, &fed.section, 80.0);
    let first = said["first"].as_str().unwrap();
    assert!(first.starts_with("growth outside the tests at "), "{said}");
}

#[test]
fn what_cannot_be_answered_is_refused_in_words() {
    let mut light = plate().section;
    light.vertical.mass_kg_m = -1.0;
    let said = asked(&light, 60.0);
    assert!(said["error"].as_str().unwrap().contains("mass"), "{said}");
    assert!(answer("no JSON").contains("error"));
    // a highest speed of zero is none
    let said = asked(&plate().section, 0.0);
    assert!(
        said["error"].as_str().unwrap().contains("speed_max"),
        "{said}"
    );
}
