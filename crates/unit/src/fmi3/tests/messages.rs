//! What the log says of calls and numbers.

use super::*;

/// Refusals name the function that was called, and nothing of FMI 2.0.
#[test]
fn messages_name_what_was_called() {
    let unit = NewStandardUnit::new("rational", None, false);
    let at = [1.0];
    let wind = [unit.reference("wind_speed")];
    let mut state = null_mut();
    unsafe {
        let status = fmi3DeserializeFMUState(unit.handle, [0_u8].as_ptr(), 1, &raw mut state);
        unit.refused(status, "fmi3DeserializeFMUState: ");
        let status = fmi3GetContinuousStateDerivatives(unit.handle, [0.0].as_mut_ptr(), 1);
        unit.refused(
            status,
            "fmi3GetContinuousStateDerivatives: it belongs to model exchange",
        );
        unit.start();
        unit.ok(fmi3Terminate(unit.handle));
        let status = fmi3SetFloat64(unit.handle, wind.as_ptr(), 1, at.as_ptr(), 1);
        unit.refused(
            status,
            "fmi3SetFloat64: not legal in the state `terminated`",
        );
    }
}

/// A wish that the description does not grant is answered in the log.
#[test]
fn event_mode_of_co_simulation_is_not_taken_silently() {
    let unit = NewStandardUnit::new("rational", None, false);
    for used in [0, 1] {
        unit.messages.lock().unwrap().clear();
        let handle = unit.instantiate(false, used);
        unsafe { fmi3FreeInstance(handle) };
        let messages = unit.messages.lock().unwrap().join("\n");
        assert_eq!(messages.contains("eventModeUsed"), used == 1, "{messages}");
    }
}

/// However late it is.
#[test]
fn a_step_is_not_taken_twice() {
    let (unit, start) = (NewStandardUnit::new("rational", None, false), 1.76e9);
    unit.ok(unsafe { fmi3EnterInitializationMode(unit.handle, 0, 0.0, start, 1, start + 1.0) });
    unit.ok(unsafe { fmi3ExitInitializationMode(unit.handle) });
    unit.ok(unit.step(start, 0.01));
    unit.refused(unit.step(start, 0.01), "fmi3DoStep: communication point");
}

/// No number of three hundred digits.
#[test]
fn numbers_are_short() {
    let unit = NewStandardUnit::new("rational", None, false);
    let mass = [unit.reference("mass")];
    let status = unsafe { fmi3SetFloat64(unit.handle, mass.as_ptr(), 1, [-1e300].as_ptr(), 1) };
    assert_eq!(status, fmi2Status::fmi2Discard);
    unit.ok(unsafe { fmi3Reset(unit.handle) });
    unit.set("initial_rotation", &[1e200]);
    unit.start();
    let messages = unit.messages.lock().unwrap();
    assert!(
        messages.iter().any(|m| m.contains("`mass` = -1e300")),
        "{messages:?}"
    );
    assert!(
        messages.iter().any(|m| m.contains("5.7e201 degrees")),
        "{messages:?}"
    );
    assert!(messages.iter().all(|m| m.len() < 200), "{messages:?}");
}
