//! The committed descriptions are what the variable table gives, byte for byte.
//!
//! `AERODECK_BLESS=1 cargo test --test fmu description` writes the descriptions anew, `AERODECK_BLESS=models` the fixtures too.

use crate::models;
use aerodeck::aerodynamics::Transfer;
use aerodeck::fmu::description::model_description;
use aerodeck::fmu::package::Label;
use aerodeck::fmu::resources::Resources;
use aerodeck::trained_model::TrainedModel;
use aerodeck::units::ReducedFrequency;
use std::path::{Path, PathBuf};

fn golden(kind: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("modelDescription/{kind}.xml"))
}

fn describe(json: &[u8]) -> String {
    let resources = Resources::from_bytes(json, [None; 3]).unwrap();
    model_description(&resources, false, &Label::default()).unwrap()
}

#[test]
fn descriptions_are_the_committed_ones() {
    for kind in models::KINDS {
        let bless = std::env::var("AERODECK_BLESS").ok();
        if bless.as_deref() == Some("models") {
            let json = models::generate(kind).to_json().unwrap();
            std::fs::write(models::model_file(kind), &json).unwrap();
        }
        let json = std::fs::read(models::model_file(kind)).unwrap();
        if bless.is_some() {
            std::fs::write(golden(kind), describe(&json)).unwrap();
        }
        let committed = std::fs::read_to_string(golden(kind)).unwrap();
        assert!(
            describe(&json) == committed,
            "modelDescription/{kind}.xml differs from what the code gives; look at it, then AERODECK_BLESS=1"
        );
    }
}

/// The committed fixtures come from the generator: same transfer matrices up to the rounding of the least squares.
#[test]
fn fixtures_are_those_of_the_generator() {
    for kind in models::KINDS {
        let committed = std::fs::read_to_string(models::model_file(kind)).unwrap();
        let committed = TrainedModel::from_json(&committed).unwrap();
        let generated = models::generate(kind);
        assert_eq!(committed.section, generated.section);
        assert_eq!(committed.experiment, generated.experiment);
        for k in [0.1, 0.5, 1.5].map(ReducedFrequency::from_full_width) {
            let (a, b) = (
                committed.model.transfer(k).unwrap(),
                generated.model.transfer(k).unwrap(),
            );
            assert!((a - b).iter().all(|z| z.norm() < 1e-9), "{kind}");
        }
    }
}
