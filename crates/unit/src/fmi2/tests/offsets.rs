//! Units of sections that state an axis and a centre of mass.

use super::*;
use crate::aerodynamics::Realizable;
use crate::aeroelastic::CoupledSection;
use crate::flutter::{OnsetSearch, find_onset};

fn unbalanced(kind: &str, axis: f64, mass: f64) -> Extracted {
    let mut model = Extracted::fixture(kind).resources.model;
    model.section.axis_offset_m = Some(axis);
    model.section.mass_offset_m = Some(mass);
    Extracted::new(&model.to_json().unwrap())
}

fn onset(model: &TrainedModel) -> f64 {
    let structure = model.section.structure().unwrap();
    let section = CoupledSection::new(structure, model.model.realize()).unwrap();
    let search = OnsetSearch {
        speed_max_m_s: model.experiment.onset_search_limit_m_s,
        ..OnsetSearch::default()
    };
    let found = find_onset("", &section, &search, Some(model.tested_range)).unwrap();
    found.onset().unwrap().at.speed_m_s
}

#[test]
fn an_unbalanced_section_moves_as_the_stepper_does() {
    for kind in ["continuous_laguerre", "rational", "discrete_laguerre"] {
        super::run::compare(unbalanced(kind, 0.03, -0.02));
    }
}

/// The offsets are parameters where the section states them, and only there.
#[test]
fn offsets_are_parameters_where_they_are_stated() {
    let plain = Extracted::fixture("rational");
    for name in ["axis_offset", "mass_offset"] {
        assert_eq!(plain.resources.table.find_name(name), None);
    }
    let moved = unbalanced("rational", 0.02, 0.03);
    let unit = StartedUnit::instantiate(unbalanced("rational", 0.0, 0.0));
    unit.start();
    let before = unit.get(["onset_speed"])[0];
    let close = |found: f64, searched: f64| (found / searched - 1.0).abs() < 1e-9;
    assert!(close(before, onset(plain.model())));
    unit.set("axis_offset", 0.02);
    unit.set("mass_offset", 0.03);
    let after = unit.get(["onset_speed"])[0];
    assert!(close(after, onset(moved.model())));
    assert!(after < 0.95 * before, "{before} {after}");
}

/// With static unbalance a moment accelerates the heave, and the description says so.
#[test]
fn a_moment_acts_on_the_heave() {
    let archive = unbalanced("discrete_laguerre", 0.0, 0.05);
    let table = archive.resources.described_table().unwrap();
    let moment = table.find_name("external_moment").unwrap();
    let acts_on = |name: &str| {
        let variable = &table.variables()[table.find_name(name).unwrap()];
        variable.direct_inputs.iter().any(|d| d.on == moment)
    };
    assert!(acts_on("heave_acceleration"));
    assert!(!acts_on("lift"));
    let unit = StartedUnit::instantiate(archive);
    unit.start();
    let before = unit.get(["heave_acceleration"])[0];
    unit.set("external_moment", 1.0);
    // centre of mass downwind: turned nose-up about it, the axis is lifted
    assert!(unit.get(["heave_acceleration"])[0] > before);
}
