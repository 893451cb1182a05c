//! Facts of the table that importers rely on.

use super::*;
use crate::resources::Resources;
use crate::section::Translation;

fn fixture(kind: &str) -> TrainedModel {
    let path = format!(
        "{}/../../tests/data/models/{kind}.json",
        env!("CARGO_MANIFEST_DIR")
    );
    TrainedModel::from_json(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// With dependencies.
fn described(kind: &str) -> VariableTable {
    described_model(&fixture(kind))
}

fn described_model(model: &TrainedModel) -> VariableTable {
    let json = model.to_json().unwrap();
    let resources = Resources::from_bytes(json.as_bytes(), [None; 3]);
    resources.unwrap().described_table().unwrap()
}

fn names<'a>(table: &'a VariableTable, on: &[Dependency]) -> Vec<&'a str> {
    let names = on.iter().map(|d| table.variables()[d.on].name.as_str());
    names.collect()
}

fn direct<'a>(table: &'a VariableTable, output: &str) -> Vec<&'a str> {
    let index = table.find_name(output).unwrap();
    names(table, &table.variables()[index].direct_inputs)
}

#[test]
fn names_are_unique_and_numbers_carry_units() {
    for kind in ["continuous_laguerre", "rational", "discrete_laguerre"] {
        let table = VariableTable::new(&fixture(kind), None, None, None).unwrap();
        for (i, v) in table.variables().iter().enumerate() {
            assert_eq!(table.find_name(&v.name), Some(i));
            let ratio = matches!(
                v.quantity,
                Some("DampingRatio" | "ReducedVelocity" | "FilterState")
            );
            let real = matches!(v.value, StartValue::Real(_));
            assert_eq!(v.unit.is_some(), real && !ratio, "{}", v.name);
            let shown = v
                .display_unit
                .map(|d| v.unit.unwrap().display.iter().any(|u| u.0 == d));
            assert_ne!(shown, Some(false), "{}", v.name);
        }
        assert_eq!(table.find(Role::ExternalForce(Dof::Lateral)), None);
        assert_eq!(table.dofs(), Dof::TWO);
    }
}

#[test]
fn added_mass_couples_forces_into_accelerations() {
    let with = described("rational");
    let inputs = |table, output| -> Vec<String> {
        let all = direct(table, output).into_iter().map(str::to_owned);
        all.take_while(|name| !name.starts_with("heave")).collect()
    };
    let all = ["wind_speed", "external_lift", "external_moment"];
    // the added mass of a plate about its centre has no moment by heave
    assert_eq!(inputs(&with, "heave_acceleration"), all[..2]);
    assert_eq!(inputs(&with, "moment"), [all[0], all[2]]);
    let mut model = fixture("rational");
    model.section.axis_offset_m = Some(0.0);
    let movable = described_model(&model);
    for output in [
        "heave_acceleration",
        "rotation_acceleration",
        "lift",
        "moment",
    ] {
        assert_eq!(inputs(&movable, output), all, "{output}");
    }
    let without = described("discrete_laguerre");
    assert_eq!(direct(&without, "heave_acceleration"), all[..2]);
    assert_eq!(direct(&without, "moment"), all[..1]);
    assert!(direct(&without, "heave").is_empty());
    assert_eq!(direct(&with, "rotation_rate"), ["rotation_rate"]);
    for table in [&with, &without] {
        let heave = &table.variables()[table.find_name("heave").unwrap()];
        let on = &heave.initial_dependencies;
        assert_eq!(names(table, on), ["initial_heave"]);
        assert_eq!(on[0].kind, DependencyKind::Constant);
    }
}

#[test]
fn a_lateral_support_brings_its_variables() {
    let mut model = fixture("discrete_laguerre");
    model.section.lateral = Some(Translation {
        mass_kg_m: 15.0,
        frequency_hz: Some(1.5),
        stiffness_n_m2: None,
        damping_ratio: 0.003,
    });
    let table = VariableTable::new(&model, None, None, None).unwrap();
    assert_eq!(table.dofs(), Dof::THREE);
    for name in [
        "external_drag",
        "sway",
        "sway_rate",
        "sway_acceleration",
        "drag",
        "sway_mass",
        "sway_frequency",
        "sway_damping_ratio",
        "initial_sway",
        "initial_sway_rate",
    ] {
        assert!(table.find_name(name).is_some(), "{name}");
    }
    assert_eq!(table.variables().len(), 41 + 1 + 4 + 3 + 2);
}

#[test]
fn start_values_outside_their_limits_are_refused() {
    let mut model = fixture("rational");
    model.section.vertical.mass_kg_m = 1e-9;
    let message = VariableTable::new(&model, None, None, None)
        .unwrap_err()
        .to_string();
    assert_eq!(
        message,
        "start value of mass: expected a finite number (minimum 0.000001, maximum none), found 0.000000001"
    );
}
