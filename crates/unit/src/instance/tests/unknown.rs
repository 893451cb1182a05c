//! What is not known reads as nothing that is safe.

use super::{Exported, bridge_of, fixture, index, instance};
use crate::error::Error;
use crate::instance::Instance;
use crate::instance::section::OnsetCard;
use crate::onset_bounds::OnsetBounds;
use crate::resources::Resources;
use crate::trained_model::{Model, TrainedModel};
use crate::units::ReducedFrequency;

fn read<const N: usize>(unit: &mut Instance, names: [&str; N]) -> [f64; N] {
    let references = names.map(|name| index(unit, name));
    let mut values = [f64::NAN; N];
    unit.reals(&references, &mut values).unwrap();
    values
}

fn flag(unit: &mut Instance, name: &str) -> bool {
    let reference = index(unit, name);
    unit.boolean(reference).unwrap()
}

/// Where a search finds nothing its limit is what was judged.
#[test]
fn an_onset_that_is_not_there_is_the_limit() {
    let mut unit = instance(Exported::Section("rational"), false).unwrap();
    unit.enter_initialization();
    let limit = index(&unit, "onset_search_limit");
    unit.set_reals(&[limit], &[2.0]).unwrap();
    let speeds = read(&mut unit, ["onset_speed", "divergence_speed"]);
    assert_eq!(speeds, [2.0, 2.0]);
    assert!(!flag(&mut unit, "onset_found") && flag(&mut unit, "stable_below_onset"));
}

/// Nothing is stable below an onset that is not known, whatever has been judged before its search.
#[test]
fn an_onset_that_is_not_known_is_no_stable_one() {
    let mut card = OnsetCard::nothing_found(1.0);
    card.numbers.stable_below = true;
    card.onset_unknown(&Error::Numerical("no search".into()));
    card.judge(None);
    assert_eq!(card.numbers.speed_m_s.value, 0.0);
    assert!(!card.numbers.stable_below);
    assert!(card.warnings[0].contains("onset is not known"));
}

/// Without stiffness nothing is known, whatever the model and the motion.
#[test]
fn without_stiffness_nothing_is_stable() {
    for kind in ["rational", "continuous_laguerre", "discrete_laguerre"] {
        for frequency in ["heave_frequency", "torsion_frequency"] {
            let mut unit = instance(Exported::Section(kind), false).unwrap();
            unit.enter_initialization();
            let own = index(&unit, frequency);
            unit.set_reals(&[own], &[0.0]).unwrap();
            let speeds = read(&mut unit, ["onset_speed", "divergence_speed"]);
            assert_eq!(speeds, [0.0, 0.0], "{kind} {frequency}");
            let stable = flag(&mut unit, "stable_below_onset");
            assert!(!stable, "{kind} {frequency}");
        }
    }
}

/// What runs away without oscillating is growth below the onset, and is said.
#[test]
fn what_diverges_below_its_onset_is_not_stable() {
    let of_section = ["heave_frequency", "torsion_frequency"];
    for (kind, frequencies) in [
        (Exported::Section("rational"), of_section),
        (Exported::Section("continuous_laguerre"), of_section),
        (Exported::Bridge, ["mode[1].frequency", "mode[2].frequency"]),
    ] {
        let mut unit = instance(kind, false).unwrap();
        unit.enter_initialization();
        let all = ["onset_speed", "divergence_speed"];
        let [onset, divergence] = read(&mut unit, all);
        assert!(
            onset < divergence && flag(&mut unit, "stable_below_onset"),
            "{kind:?}"
        );
        unit.take_notices();
        let [vertical, torsion] = frequencies.map(|name| index(&unit, name));
        let mut lower = [f64::NAN];
        unit.reals(&[vertical], &mut lower).unwrap();
        unit.set_reals(&[torsion], &[0.6 * lower[0]]).unwrap();
        let [onset, divergence] = read(&mut unit, all);
        let notices = unit.take_notices().join("\n");
        assert!(divergence < onset, "{kind:?}: {divergence}, {onset}");
        assert!(!flag(&mut unit, "stable_below_onset"), "{kind:?}");
        assert!(
            notices.contains("static divergence at"),
            "{kind:?}: {notices}"
        );
    }
}

/// Tests that do not lead up to still air leave slow wind to a guess, and forces that feed some motion faster than every test
/// leave it open, also where an onset was found among the tests and no mode grows.
#[test]
fn slow_wind_of_which_no_test_tells_is_not_stable() {
    let damped = TrainedModel::from_json(std::str::from_utf8(&fixture("rational")).unwrap());
    let damped = damped.unwrap();
    let mut without_tests = damped.clone();
    without_tests.tested_range.max = ReducedFrequency::from_full_width(0.7);
    let mut feeding = damped.clone();
    let Model::Rational(forces) = &mut feeding.model else {
        panic!("the fixture is rational");
    };
    forces.a2[(0, 1)] += 10.0;
    for (model, why) in [
        (damped, None),
        (without_tests, Some("damping there is a guess")),
        (feeding, Some("a motion may gain energy there")),
    ] {
        let json = model.to_json().unwrap();
        let options = bridge_of(&model).to_json().unwrap();
        let section = Resources::from_bytes(json.as_bytes(), [None; 3]).unwrap();
        let bridge = Resources::of_bridge(json.as_bytes(), options.as_bytes(), None).unwrap();
        for resources in [section, bridge] {
            let mut unit = Instance::new(resources).unwrap();
            unit.enter_initialization();
            assert!(flag(&mut unit, "onset_found"));
            assert_eq!(flag(&mut unit, "stable_below_onset"), why.is_none());
            let notices = unit.take_notices().join("\n");
            match why {
                Some(why) => assert!(notices.contains(why), "{notices}"),
                None => assert!(!notices.contains("in slow wind"), "{notices}"),
            }
        }
    }
}

/// What the data leave so far open that it is no result is not read from the ends of its interval alone.
#[test]
fn an_onset_that_data_do_not_determine_says_so() {
    let model = fixture("rational");
    let bounds = OnsetBounds {
        low_m_s: 0.0,
        high_m_s: 60.0,
        undetermined: Some("not determined by these data: the interval contains zero".into()),
    };
    let json = serde_json::to_string(&bounds).unwrap();
    let files = [None, None, Some(json.as_bytes())];
    let section = Resources::from_bytes(&model, files).unwrap();
    let trained = TrainedModel::from_json(std::str::from_utf8(&model).unwrap()).unwrap();
    let mut options = bridge_of(&trained);
    options.onset_interval = Some(bounds);
    let options = options.to_json().unwrap();
    let bridge = Resources::of_bridge(&model, options.as_bytes(), None).unwrap();
    for resources in [section, bridge] {
        let mut unit = Instance::new(resources).unwrap();
        unit.enter_initialization();
        let [onset, low] = read(&mut unit, ["onset_speed", "onset_speed_low"]);
        let notices = unit.take_notices().join("\n");
        assert!(onset > low && low == 0.0);
        assert!(
            notices.contains("onset_speed as exported: not determined"),
            "{notices}"
        );
    }
}

/// Of a bridge as of a section: what cannot be computed for its parameters is zero and not found, with a notice that says so.
/// The search limit would read as safe.
#[test]
fn what_a_bridge_cannot_be_searched_for_is_zero() {
    let mut unit = instance(Exported::Bridge, false).unwrap();
    unit.enter_initialization();
    for density in [1e300, 1.25, 1e200, f64::MAX] {
        let own = index(&unit, "air_density");
        unit.set_reals(&[own], &[density]).unwrap();
        unit.take_notices();
        let [onset, frequency, margin, wind] = read(
            &mut unit,
            [
                "onset_speed",
                "onset_frequency",
                "flutter_margin",
                "wind_speed",
            ],
        );
        let notices = unit.take_notices().join("\n");
        let known = density == 1.25;
        assert_eq!(
            flag(&mut unit, "onset_found"),
            known,
            "{density}: {notices}"
        );
        if known {
            assert!(onset > 0.0 && frequency > 0.0 && !notices.contains("not known"));
            continue;
        }
        assert_eq!(
            (onset, frequency, margin),
            (0.0, 0.0, -wind),
            "{density}: {notices}"
        );
        assert!(!flag(&mut unit, "stable_below_onset"));
        assert!(
            notices.contains("flutter onset") && notices.contains("not known for these parameters"),
            "{density}: {notices}"
        );
    }
}

/// Filters of a bridge are those of all its modes: as many as continuous states beyond coordinates and rates.
#[test]
fn a_bridge_counts_its_filters() {
    let mut unit = instance(Exported::Bridge, false).unwrap();
    let filters = index(&unit, "filters");
    let count = unit.integer(filters).unwrap();
    let states = unit.state_count();
    assert_eq!(count as usize, states - 4);
    assert_eq!(count, 4);
}
