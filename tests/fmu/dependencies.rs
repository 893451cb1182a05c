//! What descriptions state of dependencies against what moves: nothing that moves is left out, nothing that is stated stands still,
//! and factors are as constant as they are said to be.

use crate::bridges::{THREE, TWO, langenuen, lively, read};
use crate::{models, three_dof};
use aerodeck::aerodynamics::{GustForce, RationalAdmittance};
use aerodeck::fmu::instance::Instance;
use aerodeck::fmu::package::Export;
use aerodeck::fmu::resources::Resources;
use aerodeck::fmu::variables::{
    Causality, Dependency, DependencyKind, Role, StartValue, Variability, Variable, VariableTable,
};
use aerodeck::identification::Form;
use aerodeck::study::bridge::BridgeExportOptions;
use aerodeck::trained_model::TrainedModel;

/// What rounding leaves, as a part of the largest change of a response.
const ROUNDING: f64 = 1e-9;

/// A unit with its table.
struct ProbedUnit {
    what: String,
    table: VariableTable,
    make: Box<dyn Fn() -> Resources>,
}

impl ProbedUnit {
    fn new(what: impl Into<String>, make: impl Fn() -> Resources + 'static) -> Self {
        let table = make().described_table().unwrap();
        let (what, make) = (what.into(), Box::new(make));
        Self { what, table, make }
    }

    fn section(what: &str, model: &TrainedModel, gusts: Option<RationalAdmittance>) -> Self {
        let dofs = model.section.dofs();
        let gusts = gusts.map(|admittance| GustForce {
            coefficients: (1..=dofs.len()).map(|i| [0.4 * i as f64, -1.7]).collect(),
            dofs,
            admittance,
            source: "made up".into(),
        });
        let gusts = gusts.map(|gusts| serde_json::to_vec(&gusts).unwrap());
        let json = model.to_json().unwrap();
        Self::new(what, move || {
            let gusts = gusts.as_deref();
            let files = [None, gusts, None];
            Resources::from_bytes(json.as_bytes(), files).unwrap()
        })
    }

    fn bridge(what: &str, model: &TrainedModel, export: &Export) -> Self {
        let (model, bridge) = (
            model.to_json().unwrap(),
            export.bridge.as_ref().unwrap().to_json().unwrap(),
        );
        let turbulence = export
            .turbulence
            .as_ref()
            .map(|t| serde_json::to_string(t).unwrap());
        Self::new(what, move || {
            let turbulence = turbulence.as_deref().map(str::as_bytes);
            Resources::of_bridge(model.as_bytes(), bridge.as_bytes(), turbulence).unwrap()
        })
    }

    /// In initialisation mode, with every number other than zero: parameters `shift` times theirs, and the wind.
    fn started(&self, shift: f64, wind: f64) -> Instance {
        let mut instance = Instance::new((self.make)()).unwrap();
        instance.set_up_experiment(0.0, None).unwrap();
        instance.enter_initialization();
        for place in self.knowns() {
            let variable = &self.table.variables()[place];
            let StartValue::Real(Some(start)) = variable.value else {
                continue;
            };
            let value = match variable.role {
                Role::WindSpeed => wind,
                Role::TurbulenceFactor | Role::OnsetSearchLimit => start,
                _ if start == 0.0 => 0.01 + 0.001 * (place % 7) as f64,
                _ if variable.causality == Causality::Parameter => start * shift,
                _ => start,
            };
            instance.set_reals(&[place as u32], &[value]).unwrap();
        }
        instance
    }

    /// Places of what is set.
    fn knowns(&self) -> impl Iterator<Item = usize> + '_ {
        let all = self.table.variables().iter().enumerate();
        let set = |v: &Variable| matches!(v.causality, Causality::Input | Causality::Parameter);
        all.filter(move |(_, v)| set(v)).map(|(place, _)| place)
    }

    /// Places of what is computed from the motion: outputs, states and rates of states.
    fn responses(&self) -> Vec<u32> {
        let all = self.table.variables().iter().enumerate();
        let response = |v: &Variable| {
            v.is_initial_unknown()
                && v.variability == Variability::Continuous
                && !matches!(v.role, Role::Computed(_))
        };
        all.filter(|(_, v)| response(v))
            .map(|(place, _)| place as u32)
            .collect()
    }

    /// Whether what is stated of each response is what moves it: `moved` has a row per known, `sizes` how far each moves at most.
    fn check(
        &self,
        mode: &str,
        list: fn(&Variable) -> &[Dependency],
        moved: &[(usize, Vec<f64>)],
        sizes: &[f64],
    ) {
        let name = |place: usize| &self.table.variables()[place].name;
        for (i, place) in self.responses().into_iter().enumerate() {
            let stated = list(&self.table.variables()[place as usize]);
            for (known, row) in moved {
                let is_stated = stated.iter().any(|d| d.on == *known);
                let moves = row[i].abs() > ROUNDING * sizes[i];
                let what = format!(
                    "{}, {mode}: {} on {}: {:e} of {:e}",
                    self.what,
                    name(place as usize),
                    name(*known),
                    row[i],
                    sizes[i]
                );
                assert!(is_stated || !moves, "not stated: {what}");
                // however little, as what rounding has left of a shape
                assert!(!is_stated || row[i] != 0.0, "stands still: {what}");
            }
            let known = |d: &Dependency| moved.iter().any(|(known, _)| *known == d.on);
            assert!(
                stated.iter().all(known),
                "{}: {}",
                self.what,
                name(place as usize)
            );
        }
    }

    /// While initialising: by what is read after one number has been set anew.
    fn check_initial(&self, sizes: &[f64]) {
        let responses = self.responses();
        let mut instance = self.started(1.1, 8.3);
        let read = |instance: &mut Instance| {
            let mut values = vec![0.0; responses.len()];
            instance.reals(&responses, &mut values).unwrap();
            values
        };
        let moved = self.knowns().map(|known| {
            let (at, mut value) = ([known as u32], [0.0]);
            instance.reals(&at, &mut value).unwrap();
            let [own] = value;
            let mut slopes = vec![0.0; responses.len()];
            let by_one = instance.directional_derivative(&responses, &at, &[own], &mut slopes);
            by_one.unwrap();
            let mut with = |value: f64| {
                instance.set_reals(&at, &[value]).unwrap();
                read(&mut instance)
            };
            let (low, high) = (with(own), with(own * 1.3));
            with(own);
            let changes = low.iter().zip(high).map(|(a, b)| b - a);
            // what is lost in a sum is no change, but a slope
            let moved = changes
                .zip(slopes)
                .map(|(change, slope)| match change == 0.0 {
                    true => slope,
                    false => change,
                });
            (known, moved.collect())
        });
        let moved: Vec<(usize, Vec<f64>)> = moved.collect();
        let size = |i: usize| {
            moved
                .iter()
                .map(|(_, row)| row[i].abs())
                .fold(sizes[i], f64::max)
        };
        let sizes: Vec<f64> = (0..sizes.len()).map(size).collect();
        self.check("initialising", |v| &v.initial_dependencies, &moved, &sizes);
    }

    /// Derivatives of all responses in motion, a row per input and visible state.
    fn slopes(&self, shift: f64, wind: f64) -> Vec<(usize, Vec<f64>)> {
        let responses = self.responses();
        let mut instance = self.started(shift, wind);
        let table = self.table.variables();
        let states = self.table.state_rates().len();
        if states > 0 {
            // every state other than zero, as an importer that integrates may have it
            instance = instance.for_model_exchange().unwrap();
            instance.exit_initialization().unwrap();
            let all: Vec<f64> = (0..states).map(|i| 0.01 + 1e-4 * i as f64).collect();
            instance.set_continuous_states(&all).unwrap();
        } else {
            instance.exit_initialization().unwrap();
            instance.do_step(0.0, 0.013).unwrap();
        }
        let states = table.iter().filter_map(|v| v.derivative_of);
        let inputs = (0..table.len()).filter(|i| table[*i].causality == Causality::Input);
        let knowns = inputs.chain(states);
        let row = |known: usize| {
            let mut row = vec![0.0; responses.len()];
            instance
                .directional_derivative(&responses, &[known as u32], &[1.0], &mut row)
                .unwrap();
            (known, row)
        };
        knowns.map(row).collect()
    }

    /// While it moves; returns the largest slope of each response.
    fn check_moving(&self) -> Vec<f64> {
        let (usual, in_more_wind) = (self.slopes(1.1, 8.3), self.slopes(1.1, 9.9));
        let tuned = self.slopes(1.2, 8.3);
        let size = |i: usize| {
            usual
                .iter()
                .map(|(_, row)| row[i].abs())
                .fold(0.0, f64::max)
        };
        let sizes: Vec<f64> = (0..self.responses().len()).map(size).collect();
        self.check("moving", |v| &v.direct_inputs, &usual, &sizes);
        for (i, place) in self.responses().into_iter().enumerate() {
            let variable = &self.table.variables()[place as usize];
            for dependency in &variable.direct_inputs {
                let at = usual
                    .iter()
                    .position(|(known, _)| *known == dependency.on)
                    .unwrap();
                let near = |other: &[(usize, Vec<f64>)]| {
                    (other[at].1[i] - usual[at].1[i]).abs() <= 1e-12 * usual[at].1[i].abs()
                };
                let found = match (near(&in_more_wind), near(&tuned)) {
                    (true, true) => DependencyKind::Constant,
                    (true, false) => DependencyKind::Tunable,
                    (false, _) => DependencyKind::Dependent,
                };
                // what the wind does is no factor
                let is_wind = self.table.variables()[dependency.on].role == Role::WindSpeed;
                let expected = if is_wind {
                    DependencyKind::Dependent
                } else {
                    found
                };
                assert_eq!(
                    dependency.kind, expected,
                    "{}: {} on {}",
                    self.what, variable.name, dependency.on
                );
            }
        }
        sizes
    }

    fn checked(&self) {
        self.check_initial(&self.check_moving());
    }
}

fn fixture(kind: &str) -> TrainedModel {
    TrainedModel::from_json(&std::fs::read_to_string(models::model_file(kind)).unwrap()).unwrap()
}

#[test]
fn sections_depend_on_what_is_stated() {
    for kind in models::KINDS {
        let mut model = fixture(kind);
        for gusts in [
            None,
            Some(RationalAdmittance::None),
            Some(RationalAdmittance::Liepmann),
        ] {
            ProbedUnit::section(kind, &model, gusts).checked();
        }
        (model.section.axis_offset_m, model.section.mass_offset_m) = (Some(0.0), Some(0.0));
        model.section.vertical.damping_ratio = 0.0;
        ProbedUnit::section(
            &format!("{kind} with offsets"),
            &model,
            Some(RationalAdmittance::Liepmann),
        )
        .checked();
    }
}

#[test]
fn sections_of_three_motions_depend_on_what_is_stated() {
    for form in [
        Form::default(),
        Form::Rational {
            lags: 2,
            added_mass: true,
        },
    ] {
        let model = three_dof::trained(form, 1.5);
        ProbedUnit::section("three motions", &model, Some(RationalAdmittance::Liepmann)).checked();
    }
}

#[test]
fn bridges_depend_on_what_is_stated() {
    for motions in [TWO, THREE] {
        let exported = langenuen("LN21-5200", motions).export(&BridgeExportOptions::default());
        let (model, export) = exported.unwrap();
        ProbedUnit::bridge(motions, &model, &export).checked();
    }
}

/// With dampers, gusts on strips and turbulence; and without wind.
#[test]
fn damped_bridges_in_gusts_depend_on_what_is_stated() {
    let study = read(&(lively().file.text + crate::dampers::BLOCKS));
    let mut field = study
        .first_field(&study.buffeting_block().unwrap(), 35.0)
        .unwrap();
    let rows = field.gusts.iter_mut().flatten();
    rows.for_each(|row| row.truncate(50));
    let wanted = BridgeExportOptions {
        gust_strips: Some(3),
        turbulence: Some(field),
        ..BridgeExportOptions::default()
    };
    let (model, export) = study.export(&wanted).unwrap();
    ProbedUnit::bridge("dampers and gusts", &model, &export).checked();
    let (model, whole) = study.export(&BridgeExportOptions::default()).unwrap();
    let (model, export) = study.structure(model, whole, true).unwrap();
    ProbedUnit::bridge("structure", &model, &export).checked();
}
