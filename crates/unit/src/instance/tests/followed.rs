//! The onset of a bridge is followed where that is safe, and searched for where it is not.

use super::{Exported, index, resources, start};
use crate::instance::Instance;
use crate::instance::bridge_built::BuiltBridge;
use crate::instance::bridge_onset::SearchedOnset;
use crate::instance::memory::starts;
use crate::instance::section::OnsetCard;
use crate::onset_start::OnsetStart;
use crate::resources::Resources;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};

const LIMIT: f64 = 100.0;

fn built(resources: &Resources, changed: &[(&str, f64)]) -> BuiltBridge {
    let mut values = starts(&resources.table);
    for (name, value) in changed {
        values[resources.table.find_name(name).unwrap()] = *value;
    }
    BuiltBridge::new(resources, &values).unwrap()
}

fn searched(built: &BuiltBridge) -> (OnsetCard, SearchedOnset) {
    let (card, searched) = OnsetCard::of_bridge(built, None, None, LIMIT);
    (card, searched.unwrap())
}

/// By two ways: the motion followed, and the search of all eigenvalues.
#[test]
fn what_is_followed_is_what_a_search_finds() {
    let resources = resources(Exported::Bridge);
    let (_, known) = searched(&built(&resources, &[]));
    for changed in [
        &[("air_density", 1.5)][..],
        &[("air_density", 0.9)],
        &[("mode[2].frequency", 4.4)],
        &[
            ("mode[1].frequency", 2.3),
            ("mode[1].damping_ratio", 0.0038),
        ],
    ] {
        let mut now = built(&resources, changed);
        let found = known.followed(&mut now, LIMIT).unwrap();
        let (card, _) = searched(&now);
        let numbers = card.numbers;
        for (found, expected) in [
            (found.speed_m_s, numbers.speed_m_s.value),
            (found.frequency_hz(), numbers.frequency_hz.value),
        ] {
            assert!(
                (found / expected - 1.0).abs() < 1e-8,
                "{changed:?}: {found}, {expected}"
            );
        }
    }
}

/// Whether searched or followed: below the onset another motion leaves tests that end just below that of the onset.
#[test]
fn a_motion_that_leaves_the_tests_is_not_stable() {
    let resources = resources(Exported::Bridge);
    let (_, known) = searched(&built(&resources, &[]));
    let mut now = built(&resources, &[("air_density", 1.3)]);
    let onset = known.followed(&mut now, LIMIT).unwrap();
    let width = now.own.bridge.width_m();
    let k = ReducedFrequency::from_hertz(onset.frequency_hz(), width, onset.speed_m_s);
    for (lowest, stable) in [(0.1, true), (0.99, false)] {
        let end = |part| ReducedFrequency::from_full_width(part * k.full_width());
        let tested = Some(ReducedFrequencyRange::between(end(lowest), end(100.0)));
        let (card, _) = OnsetCard::of_bridge(&now, tested, None, LIMIT);
        let followed = OnsetCard::of_followed(&mut now, tested, None, LIMIT, &onset).unwrap();
        for card in [card, followed] {
            assert_eq!(card.numbers.stable_below, stable, "{lowest}: {card:?}");
            let told = card.warnings.join("\n").contains("the lowest tested");
            assert_eq!(told, !stable, "{lowest}: {card:?}");
        }
    }
}

/// Far parameters, a limit below, and a mode that has lost its damping: nothing is answered without a search.
#[test]
fn what_cannot_be_trusted_is_not_followed() {
    let resources = resources(Exported::Bridge);
    let mut default = built(&resources, &[]);
    let (card, known) = searched(&default);
    let onset = card.numbers.speed_m_s.value;
    assert!(known.followed(&mut default, 0.99 * onset).is_none());
    let mut far = built(&resources, &[("air_density", 1.7)]);
    assert!(known.followed(&mut far, LIMIT).is_none());
    // a search that had seen three times the damping below the onset
    let start = OnsetStart::at(
        onset,
        card.numbers.frequency_hz.value,
        default.stepper.section(),
    );
    let mut start = start.unwrap();
    assert!(
        SearchedOnset::from(&default, &start)
            .unwrap()
            .followed(&mut default, LIMIT)
            .is_some()
    );
    start.damping_below[0] *= 3.0;
    assert!(
        SearchedOnset::from(&default, &start)
            .unwrap()
            .followed(&mut default, LIMIT)
            .is_none()
    );
}

/// A start that comes with the archive gives the onset that a unit without one finds.
#[test]
fn a_start_in_the_archive_gives_the_same_onset() {
    let plain = resources(Exported::Bridge);
    let default = built(&plain, &[]);
    let (card, _) = searched(&default);
    let onset = card.numbers.speed_m_s.value;
    let mut given = resources(Exported::Bridge);
    // a little off: the unit settles by itself
    let hertz = card.numbers.frequency_hz.value;
    let start = OnsetStart::at(onset, hertz, default.stepper.section()).unwrap();
    given.bridge.as_mut().unwrap().onset = Some(start);
    let mut unit = Instance::new(given).unwrap();
    start_and_read(&mut unit, onset);
}

fn start_and_read(unit: &mut Instance, expected: f64) {
    start(unit);
    let speed = index(unit, "onset_speed");
    let mut found = [f64::NAN];
    unit.reals(&[speed], &mut found).unwrap();
    assert!(
        (found[0] / expected - 1.0).abs() < 1e-8,
        "{found:?}, {expected}"
    );
}
