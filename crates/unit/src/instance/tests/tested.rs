//! A bridge is judged in the range in which its forces were tested, as a section is.

use super::{Exported, bridge_of, fixture, index, instance, start};
use crate::instance::Instance;
use crate::resources::Resources;
use crate::trained_model::TrainedModel;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};

fn number(unit: &mut Instance, name: &str) -> f64 {
    let mut value = [f64::NAN];
    unit.reals(&[index(unit, name)], &mut value).unwrap();
    value[0]
}

fn flag(unit: &mut Instance, name: &str) -> bool {
    unit.boolean(index(unit, name)).unwrap()
}

/// A section and the bridge of one node that it is, tested in this range and initialising.
fn both(range: ReducedFrequencyRange) -> [Instance; 2] {
    let json = String::from_utf8(fixture("rational")).unwrap();
    let mut model = TrainedModel::from_json(&json).unwrap();
    model.tested_range = range;
    let (json, options) = (model.to_json().unwrap(), bridge_of(&model));
    let options = options.to_json().unwrap();
    let section = Resources::from_bytes(json.as_bytes(), [None; 3]).unwrap();
    let bridge = Resources::of_bridge(json.as_bytes(), options.as_bytes(), None).unwrap();
    [section, bridge].map(|resources| {
        let mut unit = Instance::new(resources).unwrap();
        unit.enter_initialization();
        unit
    })
}

/// Answers of both with these parameters; the warnings hold `words`.
fn judge(units: &mut [Instance; 2], set: &[(&str, f64)], words: &str) {
    let answers = units.each_mut().map(|unit| {
        unit.take_notices();
        for (name, value) in set {
            unit.set_reals(&[index(unit, name)], &[*value]).unwrap();
        }
        let speed = number(unit, "onset_speed");
        let flags = ["onset_found", "onset_in_tested_range"].map(|name| flag(unit, name));
        let notices = unit.take_notices().join("\n");
        assert!(notices.contains(words), "{set:?}: {notices}");
        (speed, flags)
    });
    let [section, bridge] = answers;
    assert_eq!(section.1, bridge.1, "{set:?}");
    // what could be judged ends between two speeds that were looked at
    let tolerance = if section.1[0] { 1e-8 } else { 1e-3 };
    let off = (section.0 / bridge.0 - 1.0).abs();
    assert!(off < tolerance, "{set:?}: {section:?}, {bridge:?}");
}

#[test]
fn a_bridge_is_judged_where_it_was_tested() {
    let k = ReducedFrequency::from_full_width;
    let mut units = both(ReducedFrequencyRange::between(k(0.02), k(10.0)));
    judge(&mut units, &[], "");
    let [section, _] = &mut units;
    let [onset, frequency, width] =
        ["onset_speed", "onset_frequency", "width"].map(|name| number(section, name));
    let at = ReducedFrequency::from_hertz(frequency, width, onset).full_width();
    // tests that end below the onset judge no further, whatever the forces of the fit do there
    let mut short = both(ReducedFrequencyRange::between(k(1.4 * at), k(10.0)));
    judge(
        &mut short,
        &[("onset_search_limit", 0.99 * onset)],
        "is not known beyond",
    );
    assert!(number(&mut short[1], "onset_speed") < 0.8 * onset);
    judge(
        &mut short,
        &[("onset_search_limit", 2.0 * onset)],
        "outside the tested range",
    );
    // tests that begin where it grows already
    let mut slow = both(ReducedFrequencyRange::between(k(0.02), k(0.8 * at)));
    judge(&mut slow, &[], "unstable at and below");
    // an onset that leaves the range with the parameters, and comes back
    let mut near = both(ReducedFrequencyRange::between(k(0.98 * at), k(10.0)));
    judge(&mut near, &[], "");
    judge(
        &mut near,
        &[("air_density", 1.0)],
        "outside the tested range",
    );
    judge(&mut near, &[("air_density", 1.3)], "");
}

/// The end of the tests is said once, when the wind leaves them.
#[test]
fn a_wind_that_leaves_the_tests_is_said() {
    for (kind, words) in [
        (Exported::Section("rational"), "this section was tested"),
        (Exported::Bridge, "this bridge was tested"),
    ] {
        let mut unit = instance(kind, false).unwrap();
        start(&mut unit);
        let (wind, onset) = (index(&unit, "wind_speed"), number(&mut unit, "onset_speed"));
        for (i, speed) in [onset, 0.1, onset, 0.1].into_iter().enumerate() {
            unit.set_reals(&[wind], &[speed]).unwrap();
            assert_eq!(flag(&mut unit, "wind_in_tested_range"), speed == onset);
            unit.do_step(i as f64, 1.0).unwrap();
            let notices = unit.take_notices().join("\n");
            assert_eq!(notices.contains(words), i == 1, "{kind:?}, {i}: {notices}");
        }
        // from the beginning above them, or from below past all of them
        for first in [4.0 * onset, 0.1] {
            unit.reset();
            unit.set_reals(&[wind], &[first]).unwrap();
            start(&mut unit);
            for (i, speed) in [first, 4.0 * onset].into_iter().enumerate() {
                unit.set_reals(&[wind], &[speed]).unwrap();
                assert!(!flag(&mut unit, "wind_in_tested_range"));
                unit.do_step(i as f64, 1.0).unwrap();
                let said = unit.take_notices().join("\n").contains(words);
                assert_eq!(said, (i == 0) == (first > onset), "{kind:?}, {first}, {i}");
            }
        }
    }
}

/// Per cent are no factor: they made a search that did not end.
#[test]
fn a_wind_factor_has_a_limit() {
    let json = fixture("rational");
    let model = TrainedModel::from_json(std::str::from_utf8(&json).unwrap()).unwrap();
    let mut options = bridge_of(&model);
    options.groups[0].wind_factor = 90.0;
    let message = options.bridge().unwrap_err().to_string();
    assert!(
        message.contains("wind factor: expected at most 3, found 90"),
        "{message}"
    );
}
