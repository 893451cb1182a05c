//! What is not known, as an importer of FMI 3.0 reads it.

use super::*;

/// The rule of FMI 2.0: what could not be searched for is zero and not found, never the search limit, and the log says why.
#[test]
fn what_cannot_be_searched_for_is_zero_with_a_warning() {
    for (name, value, speed, found, words) in [
        (
            "torsion_frequency",
            0.0,
            "divergence_speed",
            "divergence_found",
            "divergence",
        ),
        (
            "air_density",
            1e300,
            "onset_speed",
            "onset_found",
            "flutter onset",
        ),
    ] {
        let unit = NewStandardUnit::new("rational", None, false);
        unit.ok(unsafe { fmi3SetDebugLogging(unit.handle, 1, 0, null()) });
        unit.ok(unsafe { fmi3EnterInitializationMode(unit.handle, 0, 0.0, 0.0, 1, 100.0) });
        unit.set(name, &[value]);
        assert_eq!(
            (unit.get(speed, 1)[0], unit.flag(found)),
            (0.0, false),
            "{name}"
        );
        let messages = unit.messages.lock().unwrap().join("\n");
        assert!(
            messages.contains(words) && messages.contains("not known for these parameters"),
            "{name}: {messages}"
        );
    }
}
