//! What reaches the importer's logger.

use super::*;
use fmi2Status::fmi2Error;

/// Runs an initialisation with these log settings; returns the categories that were written.
fn categories_of(on: bool, names: &[&CStr]) -> Vec<String> {
    let unit = StartedUnit::new("rational");
    let pointers: Vec<_> = names.iter().map(|n| n.as_ptr()).collect();
    let on = fmi2Boolean::from(on);
    unit.ok(unsafe { fmi2SetDebugLogging(unit.handle, on, names.len(), pointers.as_ptr()) });
    unit.start();
    unit.messages
        .lock()
        .unwrap()
        .iter()
        .map(|m| m.2.clone())
        .collect()
}

#[test]
fn events_are_written_where_they_are_wanted() {
    assert!(categories_of(false, &[]).is_empty());
    assert_eq!(categories_of(true, &[]), ["logEvents"]);
    assert_eq!(categories_of(true, &[c"logAll"]), ["logEvents"]);
    assert_eq!(
        categories_of(true, &[c"logStatusError", c"logEvents"]),
        ["logEvents"]
    );
    assert!(categories_of(true, &[c"logStatusWarning"]).is_empty());
    assert!(categories_of(false, &[c"logEvents"]).is_empty());
}

#[test]
fn unknown_categories_are_refused() {
    let unit = StartedUnit::new("rational");
    let names = [c"logEverything".as_ptr()];
    let status = unsafe { fmi2SetDebugLogging(unit.handle, 1, 1, names.as_ptr()) };
    unit.refused(status, fmi2Error, &["logEverything"]);
    // the run goes on
    unit.start();
    unit.ok(unit.step(0.0, 0.1));
    let names = [std::ptr::null()];
    let unit = StartedUnit::new("rational");
    let status = unsafe { fmi2SetDebugLogging(unit.handle, 1, 1, names.as_ptr()) };
    unit.refused(status, fmi2Error, &["log category"]);
}

/// An onset outside the tested range is reported once, as a warning, when it is asked for.
#[test]
fn warnings_of_the_onset_search_are_written() {
    let mut model = Extracted::fixture("rational").resources.model;
    model.tested_range.max = crate::units::ReducedFrequency::from_full_width(0.11);
    // growth comes down to the tested range at 65 m/s
    model.experiment.onset_search_limit_m_s = 50.0;
    let unit = StartedUnit::instantiate(Extracted::new(&model.to_json().unwrap()));
    unit.ok(unsafe { fmi2SetDebugLogging(unit.handle, 1, 0, null()) });
    unit.start();
    unit.messages.lock().unwrap().clear();
    assert!(!unit.flag("onset_in_tested_range"));
    let (_, status, category, message) = unit.last_message().unwrap();
    assert_eq!(
        (status, category.as_str()),
        (fmi2Status::fmi2Warning, "logStatusWarning")
    );
    assert!(message.contains("outside the tested range"), "{message}");
    unit.get(["onset_speed"]);
    assert_eq!(unit.messages.lock().unwrap().len(), 1);
}

#[test]
fn platform_and_version() {
    let text = |p| unsafe { CStr::from_ptr(p) }.to_str().unwrap();
    assert_eq!(text(fmi2GetTypesPlatform()), "default");
    assert_eq!(text(fmi2GetVersion()), "2.0");
}
