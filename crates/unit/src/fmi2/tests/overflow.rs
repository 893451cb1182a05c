//! Numbers beyond what a number can hold.

use super::*;
use crate::variables::StartValue;

/// A release that no number holds: neither what follows from it nor the run.
#[test]
fn a_release_that_overflows_is_refused() {
    for kind in ["continuous_laguerre", "rational", "discrete_laguerre"] {
        let unit = StartedUnit::new(kind);
        unit.ok(unit.set_up());
        unit.ok(unit.enter());
        unit.set("initial_heave", 1e308);
        let all = unit.archive.resources.table.variables().iter();
        let reals = all.filter(|v| matches!(v.value, StartValue::Real(_)));
        for variable in reals {
            let mut value = [0.0];
            match unit.try_get(&[&variable.name], &mut value) {
                fmi2Status::fmi2OK => assert!(value[0].is_finite(), "{kind}: {}", variable.name),
                other => assert_eq!(other, fmi2Status::fmi2Discard, "{kind}: {}", variable.name),
            }
        }
        if unit.exit() != fmi2Status::fmi2OK {
            unit.refused(unit.exit(), fmi2Status::fmi2Discard, &["overflowed"]);
            // everything is as it was: another release leads on
            unit.set("initial_heave", 0.01);
            unit.ok(unit.exit());
            unit.outputs();
        }
    }
}

/// A width that gives no section: it is refused, and another leads on.
#[test]
fn a_section_that_cannot_be_is_refused() {
    let unit = StartedUnit::new("continuous_laguerre");
    unit.ok(unit.set_up());
    unit.ok(unit.enter());
    let [width] = unit.get(["width"]);
    unit.set("width", 1e100);
    let read = unit.try_get(&["heave"], &mut [0.0]);
    for status in [read, unit.exit()] {
        unit.refused(status, fmi2Status::fmi2Discard, &["not positive definite"]);
    }
    unit.set("width", width);
    unit.ok(unit.exit());
    unit.ok(unit.step(0.0, 0.01));
}

/// A sampled model whose samples no step could count.
#[test]
fn samples_that_are_too_dense_are_refused() {
    let archive = Extracted::fixture("discrete_laguerre");
    let mut model = archive.resources.model;
    let Model::DiscreteLaguerre(m) = &mut model.model else {
        panic!("the fixture is sampled");
    };
    m.delta_s = 1e-30;
    let json = model.to_json().unwrap();
    let refused = Resources::from_bytes(json.as_bytes(), [None; 3]).unwrap_err();
    let words = refused.to_string();
    assert!(
        words.contains("delta_s") && words.contains("0.000001"),
        "{words}"
    );
}
