//! An output is added by one row: its value, its derivatives, what it depends on and its place in the description follow from it.

use crate::bridges::{TWO, langenuen};
use crate::models;
use aerodeck::fmu::description::model_description;
use aerodeck::fmu::force_options::{ForceOptions, StripOptions};
use aerodeck::fmu::instance::Instance;
use aerodeck::fmu::package::Label;
use aerodeck::fmu::resources::Resources;
use aerodeck::fmu::variables::{Causality, ComputedNumber, Dependency, Formula, Known, Response};
use aerodeck::section::Dof;
use aerodeck::study::bridge::BridgeExportOptions;
use aerodeck::trained_model::TrainedModel;

/// Reads all that has a derivative.
static ROW: ComputedNumber = ComputedNumber::new(
    "of_all",
    "Made up for a test",
    Causality::Output,
    &[Known::Onset, Known::Wind, Known::Damping, Known::Rotation],
    Formula::Real(|p| {
        p.wind_m_s / p.onset.speed_m_s + p.damping_ratio * p.wind_m_s - p.rotation_rad
    }),
);

/// Reads the motion and what moves.
static OF_MOTION: ComputedNumber = ComputedNumber::new(
    "of_motion",
    "Made up for a test",
    Causality::Output,
    &[
        Known::Wind,
        Known::Motion(Response::Acceleration, Dof::Torsion),
        Known::Motion(Response::Rate, Dof::Vertical),
    ],
    Formula::Real(|p| {
        let acceleration = p.motion(Response::Acceleration, Dof::Torsion);
        acceleration + p.motion(Response::Rate, Dof::Vertical) * p.wind_m_s
    }),
);

fn section(kind: &str) -> Resources {
    let json = std::fs::read(models::model_file(kind)).unwrap();
    Resources::from_bytes(&json, [None; 3]).unwrap()
}

fn bridge() -> Resources {
    let study = langenuen("LN21-5200", TWO);
    let (model, export) = study.export(&BridgeExportOptions::default()).unwrap();
    let (model, bridge) = (model.to_json(), export.bridge.unwrap().to_json());
    Resources::of_bridge(model.unwrap().as_bytes(), bridge.unwrap().as_bytes(), None).unwrap()
}

fn with_row(mut resources: Resources, row: &'static ComputedNumber) -> Resources {
    resources.table = resources.table.with_number(row);
    resources
}

/// In initialisation mode, where every known may be set.
struct RowUnit(Instance);

impl RowUnit {
    fn new(resources: Resources) -> Self {
        let mut instance = Instance::new(resources).unwrap();
        instance.set_up_experiment(0.0, None).unwrap();
        instance.enter_initialization();
        Self(instance)
    }

    fn place(&self, name: &str) -> u32 {
        self.0.table().find_name(name).unwrap() as u32
    }

    fn get(&mut self, name: &str) -> f64 {
        let mut value = [f64::NAN];
        let place = self.place(name);
        self.0.reals(&[place], &mut value).unwrap();
        value[0]
    }

    fn set(&mut self, name: &str, value: f64) {
        let place = self.place(name);
        self.0.set_reals(&[place], &[value]).unwrap();
    }

    fn slope(&mut self, unknown: &str, known: &str) -> f64 {
        let mut slope = [f64::NAN];
        let (unknown, known) = (self.place(unknown), self.place(known));
        self.0
            .directional_derivative(&[unknown], &[known], &[1.0], &mut slope)
            .unwrap();
        slope[0]
    }

    fn difference(&mut self, unknown: &str, known: &str, step: f64) -> f64 {
        let value = self.get(known);
        let mut at = |moved: f64| {
            self.set(known, moved);
            self.get(unknown)
        };
        let rise = at(value + step) - at(value - step);
        self.set(known, value);
        rise / (2.0 * step)
    }
}

fn check(resources: Resources, initial: &str, rotations: &[&str]) {
    let resources = with_row(resources, &ROW);
    let described = resources.described_table().unwrap();
    let of_row = described.variables().last().unwrap();
    let names = |on: &[Dependency]| -> Vec<String> {
        let all = described.variables();
        on.iter().map(|d| all[d.on].name.clone()).collect()
    };
    let direct = names(&of_row.direct_inputs);
    let knowns = names(&of_row.initial_dependencies);
    assert!(direct.contains(&"wind_speed".to_owned()), "{direct:?}");
    for known in ["wind_speed", "air_density", "onset_search_limit", initial] {
        assert!(knowns.contains(&known.to_owned()), "{known}: {knowns:?}");
    }
    let description = model_description(&resources, false, &Label::default()).unwrap();
    assert!(description.contains("name=\"of_all\""));
    let reference = resources.table.variables().len();
    let listed = description
        .matches(&format!("<Unknown index=\"{reference}\""))
        .count();
    assert_eq!(
        listed, 2,
        "as an output and as an unknown of the initialisation"
    );

    let mut unit = RowUnit::new(resources);
    unit.set("wind_speed", 7.0);
    unit.set(initial, 0.02);
    let turned = rotations.iter().map(|name| unit.get(name));
    let turned = turned.fold(0.0_f64, |a, b| if b.abs() > a.abs() { b } else { a });
    assert!(turned.abs() > 1e-6);
    let expected = 7.0 / unit.get("onset_speed") + unit.get("damping_now") * 7.0 - turned;
    let found = unit.get("of_all");
    assert!(
        (found - expected).abs() <= 1e-12 * expected.abs(),
        "{found}, {expected}"
    );
    for (known, step) in [("wind_speed", 1e-3), (initial, 1e-3), ("air_density", 1e-3)] {
        let (slope, difference) = (
            unit.slope("of_all", known),
            unit.difference("of_all", known, step),
        );
        // what differences of damping ratios and of onsets leave
        assert!(
            (slope - difference).abs() <= 1e-5 * difference.abs(),
            "{known}: {slope}, {difference}"
        );
    }
}

#[test]
fn an_output_of_a_section_is_one_row() {
    for kind in models::KINDS {
        check(section(kind), "initial_rotation", &["rotation"]);
    }
}

#[test]
fn an_output_of_a_bridge_is_one_row() {
    let resources = bridge();
    let names = resources.table.variables().iter().map(|v| v.name.clone());
    let rotations: Vec<String> = names
        .filter(|n| n.starts_with("node[") && n.ends_with("].rotation"))
        .collect();
    let rotations: Vec<&str> = rotations.iter().map(String::as_str).collect();
    let initial = resources.table.variables().iter();
    let mut initial = initial
        .map(|v| v.name.clone())
        .filter(|n| n.ends_with(".initial_coordinate"));
    // a mode that turns the girder
    let last = initial.next_back().unwrap();
    check(bridge(), &last, &rotations);
}

/// `of` are the acceleration of the rotation and the rate of the heave that it reads; `knowns` what acts on them, with steps.
fn check_motion(resources: Resources, of: [&str; 2], knowns: &[(&str, f64)]) {
    let resources = with_row(resources, &OF_MOTION);
    let described = resources.described_table().unwrap();
    let all = described.variables();
    let find = |name: &str| described.find_name(name).unwrap();
    let of_row = &all[find("of_motion")];
    for name in of {
        let stated = |on: &Dependency, list: &[Dependency]| list.iter().any(|d| d.on == on.on);
        let read = &all[find(name)];
        assert!(
            read.direct_inputs
                .iter()
                .all(|d| stated(d, &of_row.direct_inputs))
        );
        let initial = &of_row.initial_dependencies;
        assert!(read.initial_dependencies.iter().all(|d| stated(d, initial)));
    }
    let mut unit = RowUnit::new(resources);
    unit.set("wind_speed", 7.0);
    for (known, _) in knowns.iter().filter(|(known, _)| *known != "wind_speed") {
        let value = unit.get(known);
        unit.set(known, if value == 0.0 { 0.02 } else { value });
    }
    let expected = unit.get(of[0]) + 7.0 * unit.get(of[1]);
    let found = unit.get("of_motion");
    assert!(
        (found - expected).abs() <= 1e-12 * expected.abs(),
        "{found}, {expected}"
    );
    for (known, step) in knowns {
        let slope = unit.slope("of_motion", known);
        let difference = unit.difference("of_motion", known, *step);
        assert!(
            (slope - difference).abs() <= 1e-5 * difference.abs(),
            "{known}: {slope}, {difference}"
        );
    }
}

#[test]
fn an_output_of_the_motion_is_one_row() {
    for kind in models::KINDS {
        let knowns = [
            ("wind_speed", 1e-3),
            ("external_moment", 1e-2),
            ("initial_heave_rate", 1e-3),
            ("initial_rotation", 1e-3),
            ("inertia", 1e-5),
        ];
        check_motion(
            section(kind),
            ["rotation_acceleration", "heave_rate"],
            &knowns,
        );
    }
    // the node that is turned most
    let mut unit = RowUnit::new(with_row(bridge(), &OF_MOTION));
    let table = bridge().table;
    let initial = table
        .variables()
        .iter()
        .rev()
        .find(|v| v.name.ends_with(".initial_coordinate"));
    let initial = initial.unwrap().name.clone();
    unit.set(&initial, 0.02);
    let nodes = table
        .variables()
        .iter()
        .filter_map(|v| v.name.strip_suffix("].rotation"));
    let nodes: Vec<String> = nodes.map(str::to_owned).collect();
    let turned = |unit: &mut RowUnit, node: &str| unit.get(&format!("{node}].rotation")).abs();
    let most = nodes
        .iter()
        .max_by(|a, b| turned(&mut unit, a).total_cmp(&turned(&mut unit, b)));
    let most = most.unwrap();
    let [acceleration, rate, moment] = ["rotation_acceleration", "heave_rate", "external_moment"]
        .map(|name| format!("{most}].{name}"));
    let knowns = [
        ("wind_speed", 1e-3),
        (initial.as_str(), 1e-4),
        (moment.as_str(), 1.0),
        ("air_density", 1e-4),
    ];
    check_motion(bridge(), [&acceleration, &rate], &knowns);
}

/// Reads all that forces alone have of a strip.
static OF_A_STRIP: ComputedNumber = ComputedNumber::new(
    "power",
    "Made up for a test",
    Causality::Output,
    &[
        Known::Wind,
        Known::Length,
        Known::Rotation,
        Known::Motion(Response::Rate, Dof::Vertical),
        Known::Motion(Response::SelfExcitedForce, Dof::Vertical),
    ],
    Formula::Real(|p| {
        let lift = p.motion(Response::SelfExcitedForce, Dof::Vertical);
        lift * p.motion(Response::Rate, Dof::Vertical) * p.length_m + p.wind_m_s * p.rotation_rad
    }),
);

/// Forces alone: of one strip, of several, of those of a bridge.
fn forces(model: &[u8], strips: usize, nodes: Vec<u32>) -> Resources {
    let text = std::str::from_utf8(model).unwrap();
    let single = ForceOptions::single(TrainedModel::from_json(text).unwrap().section.width_m);
    let like = |s: usize| StripOptions {
        length_m: 2.0 + s as f64,
        ..single.strips[0].clone()
    };
    let options = ForceOptions {
        strips: (0..strips).map(like).collect(),
        named_strips: strips > 1,
        nodes,
        ..single.clone()
    };
    let options = options.to_json().unwrap();
    let files = [Some(options.as_bytes()), None, None];
    Resources::from_bytes(model, files).unwrap()
}

/// The row of the last strip, whose variables have names that begin with `strip`.
fn check_strip(resources: Resources, strip: &str) {
    let resources = with_row(resources, &OF_A_STRIP);
    let name = |of: &str| format!("{strip}{of}");
    let power = name("power");
    let described = resources.described_table().unwrap();
    let all = described.variables();
    let of_row = &all[described.find_name(&power).unwrap()];
    let names = |on: &[Dependency]| -> Vec<String> {
        let mut names: Vec<_> = on.iter().map(|d| all[d.on].name.clone()).collect();
        names.sort();
        names
    };
    let lift = &all[described.find_name(&name("lift")).unwrap()];
    assert_eq!(names(&of_row.direct_inputs), names(&lift.direct_inputs));
    let mut knowns = names(&lift.initial_dependencies);
    knowns.push(name("length"));
    knowns.sort();
    assert_eq!(names(&of_row.initial_dependencies), knowns);
    let description = model_description(&resources, false, &Label::default()).unwrap();
    let reference = described.find_name(&power).unwrap() + 1;
    let listed = format!("<Unknown index=\"{reference}\"");
    assert_eq!(description.matches(&listed).count(), 2);

    let mut unit = RowUnit::new(resources);
    let moved = [
        ("heave", 0.02),
        ("heave_rate", 0.3),
        ("rotation", 0.01),
        ("rotation_rate", -0.2),
    ];
    unit.set("wind_speed", 7.0);
    for (of, value) in moved {
        unit.set(&name(of), value);
    }
    let per_metre = unit.get(&name("lift")) * 0.3;
    let length = unit.get(&name("length"));
    assert_eq!(unit.get(&power), per_metre * length + 7.0 * 0.01);
    let steps = [("wind_speed", 1e-3), ("air_density", 1e-3)].map(|(of, step)| (of.into(), step));
    let of_strip = ["heave", "heave_rate", "rotation", "length", "width"];
    let of_strip = of_strip.map(|of| (name(of), 1e-3));
    for (known, step) in steps.into_iter().chain(of_strip) {
        let slope = unit.slope(&power, &known);
        let difference = unit.difference(&power, &known, step);
        // forces of second degree, and what the differences of the unit leave
        assert!(
            (slope - difference).abs() <= 1e-6 * difference.abs().max(1e-3),
            "{known}: {slope}, {difference}"
        );
    }
    // put out with every step
    unit.0.exit_initialization().unwrap();
    unit.0.do_step(0.0, 0.01).unwrap();
    let lift = unit.get(&name("lift"));
    assert_eq!(unit.get(&power), lift * 0.3 * length + 7.0 * 0.01);
}

#[test]
fn an_output_of_forces_alone_is_one_row() {
    for kind in models::KINDS {
        let model = std::fs::read(models::model_file(kind)).unwrap();
        check_strip(forces(&model, 1, Vec::new()), "");
        check_strip(forces(&model, 3, Vec::new()), "strip[3].");
    }
    let study = langenuen("LN21-5200", TWO);
    let (model, _) = study.export(&BridgeExportOptions::default()).unwrap();
    let model = model.to_json().unwrap();
    check_strip(forces(model.as_bytes(), 2, vec![1081, 1156]), "node[1156].");
}
