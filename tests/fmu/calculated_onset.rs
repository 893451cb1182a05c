//! The onset that an instance calculates for its parameters is that of the search of all eigenvalues, on every deck; so is
//! its word on growth below.

use crate::trained::of_deck;
use aerodeck::aerodynamics::Realizable;
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::files::derivatives::embedded;
use aerodeck::flutter::{OnsetSearch, find_onset, unwanted_growth};
use aerodeck::fmu::instance::Instance;
use aerodeck::fmu::resources::Resources;
use aerodeck::identification::{Form, FrequencyFit, PoleSearch};

const LIMIT: f64 = 60.0;
const CALCULATED: [&str; 3] = ["onset_speed", "onset_frequency", "onset_reduced_velocity"];

fn reference(instance: &Instance, name: &str) -> u32 {
    let variables = instance.table().variables();
    variables.iter().position(|v| v.name == name).unwrap() as u32
}

fn calculated(instance: &mut Instance) -> [f64; 3] {
    let references = CALCULATED.map(|name| reference(instance, name));
    let mut values = [0.0; 3];
    instance.reals(&references, &mut values).unwrap();
    values
}

/// Every deck with filters and with lags, and a light, a heavy and a slack section.
#[test]
fn calculated_onsets_are_those_of_the_search() {
    let search = OnsetSearch {
        speed_max_m_s: LIMIT,
        ..OnsetSearch::default()
    };
    let laguerre = Form::laguerre(3);
    let rational = Form::Rational {
        lags: 2,
        added_mass: true,
    };
    let mut onsets = 0;
    for deck in embedded::names() {
        for (form, poles) in [(&laguerre, &[0.5][..]), (&rational, &[0.2, 0.8])] {
            let fit = FrequencyFit {
                form: form.clone(),
                poles: PoleSearch::fixed(poles),
                ..FrequencyFit::default()
            };
            let model = of_deck(deck, &fit, LIMIT);
            let tested = Some(model.tested_range);
            let json = model.to_json().unwrap();
            let made = || {
                let resources = Resources::from_bytes(json.as_bytes(), [None; 3]);
                let mut instance = Instance::new(resources.unwrap()).unwrap();
                instance.enter_initialization();
                instance
            };
            let mut as_exported = made();
            as_exported.exit_initialization().unwrap();
            let notices = as_exported.take_notices();
            let grows = notices.iter().any(|n| n.contains("grows"));
            let mut instance = made();
            for (mass, twist_hz) in [(15.0, 5.0), (8.0, 5.0), (40.0, 4.0), (15.0, 2.5)] {
                let places = ["mass", "torsion_frequency"].map(|n| reference(&instance, n));
                instance.set_reals(&places, &[mass, twist_hz]).unwrap();
                let mut section = model.section.clone();
                section.vertical.mass_kg_m = mass;
                section.torsion.frequency_hz = Some(twist_hz);
                let structure = section.structure().unwrap();
                let section = CoupledSection::new(structure, model.model.realize()).unwrap();
                let found = find_onset("", &section, &search, tested).unwrap();
                if (mass, twist_hz) == (15.0, 5.0) {
                    let growth = unwanted_growth(&section, &search, tested).unwrap();
                    assert_eq!(grows, !growth.is_none(), "{deck}: {}", growth.explain());
                }
                let Some(onset) = found.onset().filter(|o| o.in_tested_range == Some(true)) else {
                    continue;
                };
                onsets += 1;
                let expected = [
                    onset.at.speed_m_s,
                    onset.at.frequency_hz,
                    onset.at.reduced_velocity.v_star(),
                ];
                for (now, expected) in calculated(&mut instance).iter().zip(expected) {
                    // the search halves and bisects to some 1e-11
                    assert!(
                        (now / expected - 1.0).abs() < 1e-9,
                        "{deck}, {mass} kg/m, {twist_hz} Hz: {now} against {expected}"
                    );
                }
            }
        }
    }
    assert!(onsets >= 12, "{onsets} onsets in the tested range only");
}
