//! What was not tested is not called tested or stable, and each run is told so.

use super::{Exported, fixture, index, instance};
use crate::aeroelastic::CoupledSection;
use crate::instance::Instance;
use crate::instance::section::OnsetCard;
use crate::onset_bounds::OnsetBounds;
use crate::resources::Resources;
use crate::section::Dof;
use crate::trained_model::TrainedModel;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};

fn trained() -> TrainedModel {
    TrainedModel::from_json(std::str::from_utf8(&fixture("rational")).unwrap()).unwrap()
}

fn flags<const N: usize>(unit: &mut Instance, names: [&str; N]) -> [bool; N] {
    names.map(|name| unit.boolean(index(unit, name)).unwrap())
}

/// Between tests that are far from each other the wind is not one that was tested, and what passes there below the onset is not known.
#[test]
fn a_gap_between_tests_is_no_test() {
    let mut model = trained();
    let k = ReducedFrequency::from_full_width;
    let parts = [
        ReducedFrequencyRange::between(k(0.05), k(0.1)),
        ReducedFrequencyRange::between(k(0.27), k(4.0)),
    ];
    model.tested_range = ReducedFrequencyRange::covering(parts).unwrap();
    let (json, tested) = (model.to_json().unwrap(), model.tested_range);
    let resources = Resources::from_bytes(json.as_bytes(), [None; 3]).unwrap();
    let mut unit = Instance::new(resources).unwrap();
    unit.enter_initialization();
    let (section, wind) = (model.section.clone(), index(&unit, "wind_speed"));
    let structure = section.structure().unwrap();
    let mut seen = [false; 2];
    for speed in 1..60 {
        let speed = f64::from(speed);
        unit.set_reals(&[wind], &[speed]).unwrap();
        let k = |w| ReducedFrequency::from_circular(w, section.width_m, speed);
        let all = structure.still_air_rad_s().all(|w| tested.contains(k(w)));
        assert_eq!(flags(&mut unit, ["wind_in_tested_range"]), [all], "{speed}");
        seen[usize::from(all)] = true;
    }
    assert_eq!((seen, model.section.dofs()), ([true; 2], Dof::TWO.to_vec()));
    unit.take_notices();
    // the onset lies among the tests, the other motion in the gap
    let names = ["onset_found", "onset_in_tested_range", "stable_below_onset"];
    assert_eq!(flags(&mut unit, names), [true, true, false]);
    let notices = unit.take_notices().join("\n");
    assert!(
        notices.contains("where its K comes to lie in a gap between the tested K 0.100 and 0.270"),
        "{notices}"
    );
    unit.set_reals(&[wind], &[35.0]).unwrap();
    unit.exit_initialization().unwrap();
    let notices = unit.take_notices().join("\n");
    assert!(
        notices.contains("m/s is in a gap, ") && notices.contains(", between the speeds at which"),
        "{notices}"
    );
}

/// Filters oscillate too, and are no motions: a heave that leaves the tests before the onset is told.
#[test]
fn a_motion_that_leaves_the_tests_is_not_stable() {
    for kind in ["rational", "continuous_laguerre"] {
        let told = [2.0, 0.7, 0.3].map(|hertz| {
            let mut unit = instance(Exported::Section(kind), false).unwrap();
            unit.enter_initialization();
            let frequency = index(&unit, "heave_frequency");
            unit.set_reals(&[frequency], &[hertz]).unwrap();
            let [stable] = flags(&mut unit, ["stable_below_onset"]);
            let notices = unit.take_notices().join("\n");
            assert!(
                stable || notices.contains("these data say nothing"),
                "{kind} {hertz}: {notices}"
            );
            stable
        });
        assert_eq!(told, [true, false, false], "{kind}");
    }
}

/// Below the lowest speed of a sampled model nothing is known of the way to an onset there.
#[test]
fn an_onset_below_the_lowest_speed_of_a_sampled_model_is_told() {
    let json = fixture("discrete_laguerre");
    let model = TrainedModel::from_json(std::str::from_utf8(&json).unwrap()).unwrap();
    let structure = model.section.structure().unwrap();
    let section = CoupledSection::with_model(&structure, &model.model).unwrap();
    let mut card = OnsetCard::nothing_found(0.1);
    card.numbers.stable_below = true;
    card.look_beside_tests(&section, Some(model.tested_range));
    assert!(!card.numbers.stable_below);
    let [said] = &card.warnings[..] else {
        panic!("{:?}", card.warnings);
    };
    assert!(
        said.starts_with("the onset lies at or below ")
            && said.ends_with(
                "m/s, the lowest wind speed at which the sampled model knows its forces"
            ),
        "{said}"
    );
}

/// Another run has another log: what must be known of the onset stands in each, once.
#[test]
fn each_run_is_told_what_its_onset_is_worth() {
    let bounds = OnsetBounds {
        low_m_s: 5.0,
        high_m_s: 60.0,
        undetermined: Some("not determined by these data".into()),
    };
    let json = serde_json::to_string(&bounds).unwrap();
    let files = [None, None, Some(json.as_bytes())];
    let mut unit =
        Instance::new(Resources::from_bytes(&fixture("rational"), files).unwrap()).unwrap();
    let told = |unit: &mut Instance, what: &str| {
        flags(unit, ["onset_found"]);
        flags(unit, ["onset_found"]);
        unit.take_notices().join("\n").matches(what).count()
    };
    for run in 0..2 {
        unit.enter_initialization();
        assert_eq!(
            told(&mut unit, "not determined by these data"),
            1,
            "run {run}"
        );
        let damping = index(&unit, "torsion_damping_ratio");
        for ratio in [0.01, 0.02] {
            unit.set_reals(&[damping], &[ratio]).unwrap();
            let times = usize::from(ratio == 0.01);
            assert_eq!(
                told(&mut unit, "interval of what was exported"),
                times,
                "run {run}"
            );
        }
        unit.reset();
    }
    // without an interval nothing is said of one
    let mut unit = instance(Exported::Section("rational"), false).unwrap();
    unit.enter_initialization();
    let damping = index(&unit, "torsion_damping_ratio");
    unit.set_reals(&[damping], &[0.01]).unwrap();
    assert_eq!(told(&mut unit, "interval of what was exported"), 0);
}
