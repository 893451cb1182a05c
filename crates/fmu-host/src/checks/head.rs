//! The head of the description: version, identifier, capabilities, log categories, default experiment.

use super::super::description::{FILE, ModelDescription};
use super::super::findings::FmuFindings;

pub(super) fn head(d: &ModelDescription, f: &mut FmuFindings) {
    let known = d.fmi_version == "2.0" || d.fmi_version.starts_with("3.");
    if !d.fmi_version.is_empty() && !known {
        f.error(
            format!("{FILE}, fmiVersion"),
            "2.0 (also for 2.0.1 to 2.0.5), or 3.0",
            format!("`{}`", d.fmi_version),
        );
    }
    if d.guid.trim().is_empty() {
        f.error(
            format!("{FILE}, guid"),
            "a fingerprint that ties description and binary together",
            "an empty string",
        );
    }
    if d.model_name.trim().is_empty() {
        f.error(format!("{FILE}, modelName"), "a name", "an empty string");
    }
    if !["flat", "structured"].contains(&d.variable_naming_convention.as_str()) {
        f.error(
            format!("{FILE}, variableNamingConvention"),
            "flat or structured",
            format!("`{}`", d.variable_naming_convention),
        );
    }
}

pub(super) fn co_simulation(d: &ModelDescription, f: &mut FmuFindings) {
    let Some(slave) = &d.co_simulation else {
        f.error(FILE, "an FMU for co-simulation", "no <CoSimulation>");
        return;
    };
    let id = &slave.model_identifier;
    let legal = id
        .chars()
        .next()
        .is_some_and(|c| c.is_ascii_alphabetic() || c == '_')
        && id.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !legal {
        f.error(
            format!("{FILE}, modelIdentifier"),
            "a valid C identifier",
            format!("`{id}`"),
        );
    }
    if slave.needs_execution_tool {
        f.warning(
            format!("{FILE}, needsExecutionTool"),
            "an FMU that runs by itself",
            "one that needs another program",
        );
    }
    if slave.can_serialize_fmu_state && !slave.can_get_and_set_fmu_state {
        f.error(
            format!("{FILE}, canSerializeFMUstate"),
            "canGetAndSetFMUstate along with it",
            "false",
        );
    }
}

pub(super) fn log_categories(d: &ModelDescription, f: &mut FmuFindings) {
    let place = format!("{FILE}, LogCategories");
    let names = d.log_categories.iter().map(String::as_str);
    f.each_once(&place, "each category once", names);
}

pub(super) fn default_experiment(d: &ModelDescription, f: &mut FmuFindings) {
    let e = &d.default_experiment;
    let place = |what: &str| format!("{FILE}, DefaultExperiment, {what}");
    let start = e.start_time.unwrap_or(0.0);
    if let Some(stop) = e.stop_time.filter(|stop| *stop <= start) {
        f.error(
            place("stopTime"),
            format!("a time after the start, {start} s"),
            format!("{stop}"),
        );
    }
    for (name, value) in [("stepSize", e.step_size), ("tolerance", e.tolerance)] {
        if let Some(value) = value.filter(|v| *v <= 0.0) {
            f.error(place(name), "a positive number", value.to_string());
        }
    }
}
