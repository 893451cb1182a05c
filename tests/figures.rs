//! Figures of cases with known answers: well-formed, complete, the same bytes every time.
#![cfg(feature = "cli")]

use aerodeck::aerodynamics::{AerodynamicModel, FlatPlate, RationalModel};
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::flutter::{
    FlutterCurves, Onset, OnsetSearch, determinant_onset, find_onset, trace_modes,
};
use aerodeck::report::{Figure, PNG_SCALE, VfVgOptions, vf_vg_figure};
use aerodeck::section::SectionModel;
use aerodeck::units::{ReducedFrequency, ReducedFrequencyRange};
use quick_xml::events::Event;
use resvg::tiny_skia::Pixmap;
use std::path::Path;

fn jones(section: &SectionModel) -> CoupledSection {
    let model = RationalModel::jones_flat_plate().realize().unwrap();
    CoupledSection::new(section.structure().unwrap(), model).unwrap()
}

fn jones_curves(name: &str, section: &SectionModel, speed_max_m_s: f64) -> FlutterCurves {
    let speeds: Vec<f64> = (0..=120)
        .map(|i| speed_max_m_s * f64::from(i) / 120.0)
        .collect();
    trace_modes(name, &jones(section), &speeds).unwrap()
}

fn jones_onset(name: &str, section: &SectionModel, speed_max_m_s: f64) -> Onset {
    let search = OnsetSearch {
        speed_max_m_s,
        speeds: 60,
    };
    let found = find_onset(name, &jones(section), &search, None).unwrap();
    found.onset().unwrap().clone()
}

fn plate_onset(section: &SectionModel) -> Onset {
    let range = ReducedFrequencyRange {
        min: ReducedFrequency::from_full_width(0.02),
        max: ReducedFrequency::from_full_width(10.0),
    };
    let plate = FlatPlate {
        rotary_inertia: false,
    };
    let structure = section.structure().unwrap();
    let found = determinant_onset("flat plate (Theodorsen)", &structure, &plate, range, 200.0);
    found.unwrap().onset().unwrap().clone()
}

/// All texts of a figure, which must be well-formed XML; collects identifiers on the way.
fn texts(figure: &Figure) -> (Vec<String>, Vec<String>) {
    let mut reader = quick_xml::Reader::from_str(figure.svg());
    let (mut texts, mut ids) = (Vec::new(), Vec::new());
    let mut text = String::new();
    loop {
        match reader.read_event().unwrap() {
            Event::Start(tag) | Event::Empty(tag) => {
                for attribute in tag.attributes() {
                    let attribute = attribute.unwrap();
                    if attribute.key.as_ref() == "id" {
                        ids.push(attribute.value.to_string());
                    }
                }
                text.clear();
            }
            Event::Text(part) => text.push_str(&part),
            Event::GeneralRef(name) => text.push(match &*name {
                "amp" => '&',
                "lt" => '<',
                "gt" => '>',
                "quot" => '"',
                "apos" => '\'',
                other => panic!("entity {other}"),
            }),
            Event::End(tag) if tag.name().as_ref() == "text" => texts.push(text.clone()),
            Event::Eof => return (texts, ids),
            _ => {}
        }
    }
}

/// Checks what every figure must fulfil, and leaves it in the directory of test files for looking at.
#[track_caller]
fn check(figure: &Figure, again: &Figure, stem: &str, labels: &[&str]) {
    assert_eq!(figure.svg(), again.svg(), "two drawings differ");
    let (found, ids) = texts(figure);
    for label in labels {
        assert!(
            found.iter().any(|t| t == label),
            "{label:?} not in {found:?}"
        );
    }
    let mut unique = ids.clone();
    unique.sort();
    unique.dedup();
    assert_eq!(unique.len(), ids.len(), "identifiers are used twice");

    let paths = figure
        .write(Path::new(env!("CARGO_TARGET_TMPDIR")), stem)
        .unwrap();
    assert_eq!(std::fs::read_to_string(&paths[0]).unwrap(), figure.svg());
    let png = std::fs::read(&paths[1]).unwrap();
    assert_eq!(png, again.png(PNG_SCALE).unwrap(), "two images differ");
    let size = |image: &Pixmap| (image.width(), image.height());
    let large = Pixmap::decode_png(&png).unwrap();
    let small = Pixmap::decode_png(&figure.png(1.0).unwrap()).unwrap();
    assert_eq!(size(&large), (2 * small.width(), 2 * small.height()));
    let view_box = format!("viewBox=\"0 0 {} {}\"", small.width(), small.height());
    assert!(figure.svg().contains(&view_box));
}

#[test]
fn vf_vg_of_the_iabse_deck() {
    let section = SectionModel::iabse_1_1a();
    let mut heavier = section.clone();
    heavier.torsion.inertia_kg_m2_m *= 1.2;
    let names = ["flat plate, Jones", "Jones, inertia & frequency < plan"];
    let curves = [
        jones_curves(names[0], &section, 100.0),
        jones_curves(names[1], &heavier, 100.0),
    ];
    let mut outside = jones_onset(names[1], &heavier, 120.0);
    outside.in_tested_range = Some(false);
    outside.spurious_speeds_m_s = vec![12.0];
    let onsets = [
        jones_onset(names[0], &section, 120.0),
        plate_onset(&section),
        outside,
    ];
    let options = VfVgOptions {
        title: Some("IABSE TG 3.1, step 1.1a".into()),
        tested_speeds_m_s: Some((5.0, 70.0)),
        ..VfVgOptions::default()
    };
    let draw = || vf_vg_figure(&curves, &onsets, &options).unwrap();
    check(
        &draw(),
        &draw(),
        "vf_vg_iabse",
        &[
            "IABSE TG 3.1, step 1.1a",
            "Wind speed V (m/s)",
            "Frequency f (Hz)",
            "Damping ratio ζ (%)",
            names[0],
            names[1],
            "vertical branch",
            "torsion branch",
            "wind speed outside the tests",
            "onset outside the tested range",
            "probably spurious crossing",
            "77.48 m/s",
            "Onset flat plate (Theodorsen): V = 77.48 m/s, f = 0.1940 Hz, V/(fB) = 12.88, torsion branch (determinant)",
        ],
    );
}

#[test]
fn vf_vg_of_table_4_1() {
    let section = SectionModel::table_4_1();
    let curves = [jones_curves("flat plate, Jones", &section, 45.0)];
    let onsets = [jones_onset("flat plate, Jones", &section, 60.0)];
    let draw = || vf_vg_figure(&curves, &onsets, &VfVgOptions::default()).unwrap();
    check(
        &draw(),
        &draw(),
        "vf_vg_table_4_1",
        &["flat plate, Jones", "vertical branch", "torsion branch"],
    );
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let none = vf_vg_figure(&[], &[], &VfVgOptions::default()).unwrap_err();
    assert_eq!(
        none.to_string(),
        "flutter curves: expected at least one mode, found none"
    );
    let mut curves = [jones_curves("Jones", &SectionModel::table_4_1(), 30.0)];
    curves[0].branches[1].points[2].damping_ratio = f64::NAN;
    let message = vf_vg_figure(&curves, &[], &VfVgOptions::default())
        .unwrap_err()
        .to_string();
    assert_eq!(
        message,
        "V-f and V-g diagram, Jones, torsion branch: expected finite numbers, found (0.5, NaN) at point 3"
    );
    curves[0].branches[1].points.clear();
    let message = vf_vg_figure(&curves, &[], &VfVgOptions::default())
        .unwrap_err()
        .to_string();
    assert!(message.ends_with("torsion branch: expected points, found none"));
    let figure = vf_vg_figure(
        &[jones_curves("Jones", &SectionModel::table_4_1(), 30.0)],
        &[],
        &VfVgOptions::default(),
    )
    .unwrap();
    for scale in [0.0, -1.0, f64::NAN, 1e6] {
        assert!(figure.png(scale).is_err());
    }
    assert!(figure.write("no/such/directory", "x").is_err());
}
