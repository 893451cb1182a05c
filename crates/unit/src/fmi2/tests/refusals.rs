//! Wrong calls: the right status, a logged reason, nothing stored, the process alive.

use super::super::guard::guarded;
use super::*;
use crate::lifecycle::{Call, Interface, LEGAL_CALLS, State, StateSet};
use fmi2Status::{fmi2Discard, fmi2Error};

/// Calls `fmi2Instantiate` and gives back what it logged.
fn refused_creation(creation: &Creation) -> String {
    let messages = Messages::default();
    let functions = callbacks(&messages);
    assert!(creation.call(&functions, false).is_null());
    let log = messages.into_inner().unwrap();
    assert_eq!(log.len(), 1, "{log:?}");
    let (_, status, category, message) = log.into_iter().next().unwrap();
    assert_eq!((status, category.as_str()), (fmi2Error, "logStatusError"));
    message
}

#[test]
fn creation_is_refused_with_a_reason() {
    let archive = Extracted::fixture("rational");
    let c = |text: &str| Some(CString::new(text).unwrap());
    let with = |change: &dyn Fn(&mut Creation)| {
        let mut creation = Creation::right(&archive);
        change(&mut creation);
        refused_creation(&creation)
    };
    let message = with(&|x| x.guid = c("{00000000-0000-0000-0000-000000000000}"));
    assert!(message.contains("GUID: expected") && message.contains("{00000000-"));
    assert!(with(&|x| x.guid = None).contains("GUID"));
    assert!(with(&|x| x.kind = 2).contains("co-simulation"));
    assert!(with(&|x| x.name = c(" \t")).contains("blank"));
    assert!(with(&|x| x.name = None).contains("NULL"));
    assert!(with(&|x| x.location = None).contains("resource location"));
    assert!(with(&|x| x.location = c("")).contains("resource location"));
    assert!(with(&|x| x.location = c("https://example.org/")).contains("file URI"));
    let elsewhere = with(&|x| x.location = c("file:///no/such/place"));
    assert!(
        elsewhere.contains("/no/such/place/model.json"),
        "{elsewhere}"
    );
}

#[test]
fn damaged_models_are_refused_with_file_and_place() {
    let archive = Extracted::fixture("rational");
    let file = archive.folder.path().join("model.json");
    let right = std::fs::read_to_string(&file).unwrap();
    for (damaged, word) in [
        (right[..200].to_owned(), "line"),
        (String::new(), "line"),
        (
            right.replace("\"schema_version\": 1", "\"schema_version\": 7"),
            "schema_version",
        ),
        (
            right.replace("\"mass_kg_m\": 15.0", "\"mass_kg_m\": 0.0"),
            "mass_kg_m",
        ),
        // a model of one's own in somebody else's archive
        (
            right.replace("\"mass_kg_m\": 15.0", "\"mass_kg_m\": 16.0"),
            "GUID",
        ),
    ] {
        std::fs::write(&file, damaged).unwrap();
        let message = refused_creation(&Creation::right(&archive));
        assert!(message.contains(word), "{message}");
        if word != "GUID" {
            assert!(message.contains("model.json"), "{message}");
        }
    }
    std::fs::write(&file, [0xff, 0xfe]).unwrap();
    assert!(refused_creation(&Creation::right(&archive)).contains("UTF-8"));
}

#[test]
fn creation_without_logger_is_null() {
    let creation = Creation::right(&Extracted::fixture("rational"));
    assert!(creation.call(null(), false).is_null());
    let messages = Messages::default();
    let mut functions = callbacks(&messages);
    functions.logger = None;
    assert!(creation.call(&functions, false).is_null());
}

/// The URI with a slash at the end, and the copies that the unit makes of everything it was given.
#[test]
fn creation_copies_what_it_is_given() {
    let archive = Extracted::fixture("rational");
    let messages = Messages::default();
    let handle = {
        let mut creation = Creation::right(&archive);
        creation.location = CString::new(format!("{}/", archive.location())).ok();
        let functions = callbacks(&messages);
        creation.call(&functions, false)
    };
    assert!(!handle.is_null());
    assert_eq!(unsafe { fmi2DoStep(handle, 0.0, 0.1, 1) }, fmi2Error);
    assert_eq!(messages.lock().unwrap()[0].0, "deck");
    unsafe { fmi2FreeInstance(handle) };
    unsafe { fmi2FreeInstance(null()) };
}

#[test]
fn values_are_refused_whole() {
    let unit = StartedUnit::started("rational");
    let before = unit.get(["external_lift", "mass"]);
    let status = unit.try_set(&["external_lift", "mass"], &[7.0, -1.0]);
    unit.refused(status, fmi2Discard, &["`mass` = -1", "minimum"]);
    assert_eq!(unit.get(["external_lift", "mass"]), before);
    unit.ok(unit.step(0.0, 0.1)); // a discard does not end the run
    for (bad, shown) in [(f64::NAN, "NaN"), (f64::INFINITY, "inf")] {
        let unit = StartedUnit::started("rational");
        let status = unit.try_set(&["external_lift", "wind_speed"], &[7.0, bad]);
        unit.refused(status, fmi2Error, &["wind_speed", "finite", shown]);
        assert_eq!(unit.get(["external_lift", "wind_speed"]), [0.0, 38.0]);
    }
}

#[test]
fn steps_are_refused() {
    for (time, step, words) in [
        (0.0, -0.1, ["positive", "-0.1"]),
        (0.0, 0.0, ["positive", "found 0"]),
        (0.0, f64::NAN, ["positive", "NaN"]),
        (0.0, f64::INFINITY, ["positive", "inf"]),
        (0.5, 0.1, ["communication point", "0.5"]),
        (f64::NAN, 0.1, ["communication point", "NaN"]),
    ] {
        let unit = StartedUnit::started("rational");
        let before = unit.outputs();
        unit.refused(unit.step(time, step), fmi2Error, &words);
        assert_eq!(unit.outputs(), before);
        unit.refused(unit.step(0.0, 0.1), fmi2Error, &["fmi2DoStep", "`error`"]);
        unit.ok(unit.reset());
        unit.start();
        unit.ok(unit.step(0.0, 0.1));
    }
}

#[test]
fn the_stop_time_holds() {
    let unit = StartedUnit::new("rational");
    unit.ok(unsafe { fmi2SetupExperiment(unit.handle, 1, 1e-4, 2.0, 1, 3.0) });
    unit.ok(unit.enter());
    unit.ok(unit.exit());
    let mut time = 2.0;
    for _ in 0..10 {
        unit.ok(unit.step(time, 0.1)); // the sum ends at 3.0000000000000009
        time += 0.1;
    }
    unit.refused(unit.step(time, 0.1), fmi2Error, &["stop time 3 s"]);
    for (start, stop) in [(0.0, -1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
        let unit = StartedUnit::new("rational");
        let status = unsafe { fmi2SetupExperiment(unit.handle, 0, 0.0, start, 1, stop) };
        unit.refused(status, fmi2Error, &["start", "stop"]);
    }
}

#[test]
fn references_are_checked() {
    let mut number = 0.0;
    let mut integer = 0;
    let last = 9999;
    type Try<'a> = &'a mut dyn FnMut(&StartedUnit) -> fmi2Status;
    let cases: [(Try, [&str; 2]); 6] = [
        (
            &mut |u| unsafe { fmi2GetReal(u.handle, &raw const last, 1, &raw mut number) },
            ["9999", "no such variable"],
        ),
        (
            &mut |u| {
                let vr = u.references(&["heave"]);
                unsafe { fmi2GetInteger(u.handle, vr.as_ptr(), 1, &raw mut integer) }
            },
            ["`heave` is a real number", "not an integer"],
        ),
        (
            &mut |u| u.try_set(&["heave"], &[1.0]),
            ["`heave` (an output", "set"],
        ),
        (
            &mut |u| u.try_set(&["onset_speed"], &[1.0]),
            ["calculated parameter", "in any state"],
        ),
        (
            &mut |u| u.try_set(&["initial_heave"], &[1.0]),
            [
                "`initial_heave` (a parameter, Fixed)",
                "initialisation mode",
            ],
        ),
        (
            &mut |u| {
                let vr = u.references(&["filters"]);
                unsafe { fmi2SetInteger(u.handle, vr.as_ptr(), 1, [3].as_ptr()) }
            },
            ["`filters` (a constant", "set"],
        ),
    ];
    for (call, words) in cases {
        let unit = StartedUnit::started("rational");
        unit.refused(call(&unit), fmi2Error, &words);
    }
}

#[test]
fn null_arrays_and_null_instances_are_errors() {
    let unit = StartedUnit::started("rational");
    let status = unsafe { fmi2GetReal(unit.handle, null(), 2, null()) };
    unit.refused(status, fmi2Error, &["vr", "2 elements", "NULL"]);
    let nothing = null::<c_void>();
    for status in unsafe {
        [
            fmi2GetReal(nothing, null(), 0, null()),
            fmi2DoStep(nothing, 0.0, 0.1, 0),
            fmi2Reset(nothing),
            fmi2Terminate(nothing),
            fmi2CancelStep(nothing),
            fmi2GetFMUstate(nothing, null()),
            fmi2SetTime(nothing, 0.0),
        ]
    } {
        assert_eq!(status, fmi2Error);
    }
}

/// Brings a fresh unit into a state.
fn in_state(state: State) -> StartedUnit {
    in_state_of(Interface::CoSimulation, state)
}

fn in_state_of(interface: Interface, state: State) -> StartedUnit {
    let unit = match interface {
        Interface::CoSimulation => StartedUnit::new("rational"),
        Interface::ModelExchange => {
            super::model_exchange::exchanged(Extracted::fixture("rational"))
        }
    };
    if state == State::Error {
        assert_eq!(unit.exit(), fmi2Error);
        return unit;
    }
    if state != State::Instantiated {
        unit.ok(unit.set_up());
        unit.ok(unit.enter());
    }
    if !matches!(state, State::Instantiated | State::Initialization) {
        unit.ok(unit.exit());
    }
    match state {
        State::StepFailed => {
            unit.set_rate("wind_speed", -1000.0);
            assert_eq!(unit.step(0.0, 1.0), fmi2Discard);
        }
        State::Terminated => unit.ok(unsafe { fmi2Terminate(unit.handle) }),
        State::ContinuousTimeMode => unit.ok(unsafe { fmi2EnterContinuousTimeMode(unit.handle) }),
        _ => {}
    }
    unit
}

/// Every call of the table in every state of both interfaces: refused by the table if and only if it is not legal there.
#[test]
fn the_table_of_legal_calls_is_kept() {
    for interface in [Interface::CoSimulation, Interface::ModelExchange] {
        let states = State::ALL.into_iter();
        for state in states.filter(|s| s.interface().is_none_or(|of| of == interface)) {
            for (call, legal) in LEGAL_CALLS {
                let name = format!("{call:?}");
                let unit = in_state_of(interface, state);
                let status = unsafe { guarded(unit.handle, call, &name, |_| Ok(())) };
                let legal = legal[interface as usize];
                let foreign = legal == StateSet::NONE;
                let function = format!("fmi2{name}");
                if foreign {
                    unit.refused(status, fmi2Error, &[&function, "belongs to model exchange"]);
                } else if legal.contains(state) {
                    unit.ok(status);
                } else {
                    unit.refused(status, fmi2Error, &[&function, state.name(), "not legal"]);
                }
            }
        }
    }
}

#[test]
fn calls_in_the_wrong_order() {
    let unit = StartedUnit::new("rational");
    unit.refused(
        unit.exit(),
        fmi2Error,
        &["ExitInitializationMode", "instantiated"],
    );
    let unit = StartedUnit::new("rational");
    let status = unit.try_get(&["heave"], &mut [0.0]);
    unit.refused(status, fmi2Error, &["`heave` (an output", "instantiated"]);
    let unit = in_state(State::Terminated);
    unit.refused(unit.step(0.0, 0.1), fmi2Error, &["DoStep", "terminated"]);
    unit.outputs(); // may still be read
}

/// The wind would come to rest within the step and blow backwards.
#[test]
fn a_step_that_cannot_be_computed_is_discarded() {
    let unit = StartedUnit::started("rational");
    unit.ok(unit.step(0.0, 0.25));
    let c = unit.handle;
    let mut saved: fmi2FMUstate = null();
    unit.ok(unsafe { fmi2GetFMUstate(c, &raw mut saved) });
    let mut real = 0.0;
    let nothing = unsafe { fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &raw mut real) };
    unit.refused(nothing, fmi2Discard, &["nothing to report"]);
    let before = unit.outputs();
    unit.set_rate("wind_speed", -100.0);
    unit.refused(unit.step(0.25, 1.0), fmi2Discard, &["wind speed"]);
    assert_eq!(unit.outputs(), before);
    unit.ok(unsafe { fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &raw mut real) });
    assert_eq!(real, 0.25);
    let mut flag = 1;
    unit.ok(unsafe { fmi2GetBooleanStatus(c, fmi2Terminated, &raw mut flag) });
    assert_eq!(flag, 0);
    let mut text = std::ptr::null();
    let pending_status = 1;
    let status = unsafe { fmi2GetStringStatus(c, pending_status, &raw mut text) };
    unit.refused(status, fmi2Discard, &["nothing to report"]);
    assert!(unsafe { CStr::from_ptr(text) }.is_empty());
    let mut step_status = fmi2Error;
    let status = unsafe { fmi2GetStatus(c, fmi2DoStepStatus, &raw mut step_status) };
    unit.refused(status, fmi2Discard, &["nothing to report"]);
    let mut integer = 0;
    let status = unsafe { fmi2GetIntegerStatus(c, 7, &raw mut integer) };
    unit.refused(status, fmi2Discard, &["nothing to report"]);
    unit.ok(unsafe { fmi2SetFMUstate(c, saved) });
    unit.ok(unit.step(0.25, 1.0));
    unit.ok(unsafe { fmi2FreeFMUstate(c, &raw mut saved) });
}

#[test]
fn functions_that_are_not_offered_leave_the_run_alone() {
    let unit = StartedUnit::started("rational");
    let c = unit.handle;
    for (status, name) in unsafe {
        [
            (fmi2CancelStep(c), "CancelStep"),
            (fmi2EnterEventMode(c), "EnterEventMode"),
            (
                fmi2NewDiscreteStates(c, std::ptr::null_mut()),
                "NewDiscreteStates",
            ),
            (fmi2EnterContinuousTimeMode(c), "EnterContinuousTimeMode"),
            (
                fmi2CompletedIntegratorStep(c, 0, null(), null()),
                "CompletedIntegratorStep",
            ),
            (fmi2SetTime(c, 1.0), "SetTime"),
            (fmi2SetContinuousStates(c, null(), 0), "SetContinuousStates"),
            (fmi2GetDerivatives(c, null(), 0), "GetDerivatives"),
            (fmi2GetEventIndicators(c, null(), 0), "GetEventIndicators"),
            (fmi2GetContinuousStates(c, null(), 0), "GetContinuousStates"),
            (
                fmi2GetNominalsOfContinuousStates(c, null(), 0),
                "GetNominalsOfContinuousStates",
            ),
        ]
    } {
        let (_, logged, _, message) = unit.last_message().unwrap();
        assert_eq!((status, logged), (fmi2Error, fmi2Error));
        assert!(message.starts_with("fmi2"), "{message}");
        let all: Vec<_> = unit
            .messages
            .lock()
            .unwrap()
            .iter()
            .map(|m| m.3.clone())
            .collect();
        assert!(all.iter().any(|m| m.contains(name)));
    }
    unit.ok(unit.step(0.0, 0.1));
}

#[test]
fn a_panic_poisons_its_instance_only() {
    let (sick, well) = (
        StartedUnit::started("rational"),
        StartedUnit::started("rational"),
    );
    let status = unsafe {
        guarded(sick.handle, Call::GetReal, "GetReal", |_| {
            panic!("100 % #r1# broken")
        })
    };
    sick.refused(
        status,
        fmi2Error,
        &["internal error", "100 %% ##r1## broken"],
    );
    let poisoned = sick.step(0.0, 0.1);
    sick.refused(poisoned, fmi2Error, &["unusable"]);
    sick.refused(sick.reset(), fmi2Error, &["unusable"]);
    well.ok(well.step(0.0, 0.1));
}
