//! The head of the description: version, identifier, capabilities, log categories, default experiment; and units, which are defined
//! once, with a meaning, wherever one is used.

use super::super::description::{FILE, ModelDescription, UnitDefinition};
use super::super::findings::FmuFindings;
use std::collections::HashMap;

fn place(what: &str) -> String {
    format!("{FILE}, {what}")
}

/// Whether a text is a name in C: letters, digits and underscores, no digit first.
pub(super) fn is_identifier(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}

pub(super) fn head(d: &ModelDescription, f: &mut FmuFindings) {
    let known = d.fmi_version == "2.0" || d.fmi_version.starts_with("3.");
    if !d.fmi_version.is_empty() && !known {
        let expected = "2.0 (also for 2.0.1 to 2.0.5), or 3.0";
        let found = format!("`{}`", d.fmi_version);
        f.error(place("fmiVersion"), expected, found);
    }
    if d.guid.trim().is_empty() {
        let expected = "a fingerprint that ties description and binary together";
        f.error(place("guid"), expected, "an empty string");
    }
    if d.model_name.trim().is_empty() {
        f.error(place("modelName"), "a name", "an empty string");
    }
    let naming = d.variable_naming_convention.as_str();
    if !["flat", "structured"].contains(&naming) {
        let (place, found) = (place("variableNamingConvention"), format!("`{naming}`"));
        f.error(place, "flat or structured", found);
    }
}

pub(super) fn co_simulation(d: &ModelDescription, f: &mut FmuFindings) {
    let Some(slave) = &d.co_simulation else {
        f.error(FILE, "an FMU for co-simulation", "no <CoSimulation>");
        return;
    };
    let id = &slave.model_identifier;
    if !is_identifier(id) {
        let found = format!("`{id}`");
        f.error(place("modelIdentifier"), "a valid C identifier", found);
    }
    if slave.needs_execution_tool {
        let expected = "an FMU that runs by itself";
        let found = "one that needs another program";
        f.warning(place("needsExecutionTool"), expected, found);
    }
    if slave.can_serialize_fmu_state && !slave.can_get_and_set_fmu_state {
        let expected = "canGetAndSetFMUstate along with it";
        f.error(place("canSerializeFMUstate"), expected, "false");
    }
}

pub(super) fn log_categories(d: &ModelDescription, f: &mut FmuFindings) {
    let names = d.log_categories.iter().map(String::as_str);
    f.each_once(&place("LogCategories"), "each category once", names);
}

pub(super) fn default_experiment(d: &ModelDescription, f: &mut FmuFindings) {
    let e = &d.default_experiment;
    let place = |what: &str| place(&format!("DefaultExperiment, {what}"));
    let start = e.start_time.unwrap_or(0.0);
    if let Some(stop) = e.stop_time.filter(|stop| *stop <= start) {
        let expected = format!("a time after the start, {start} s");
        f.error(place("stopTime"), expected, stop.to_string());
    }
    for (name, value) in [("stepSize", e.step_size), ("tolerance", e.tolerance)] {
        if let Some(value) = value.filter(|v| *v <= 0.0) {
            f.error(place(name), "a positive number", value.to_string());
        }
    }
}

pub(super) fn unit_definitions(d: &ModelDescription, f: &mut FmuFindings) {
    let names = d.units.iter().map(|u| u.name.as_str());
    f.each_once(&format!("{FILE}, UnitDefinitions"), "each unit once", names);
    for unit in &d.units {
        let place = format!("{FILE}, line {}, unit `{}`", unit.line, unit.name);
        if unit.factor == Some(0.0) {
            f.error(&place, "a factor to the base unit other than 0", "0");
        }
        let names = unit.display_units.iter().map(|(name, _)| name.as_str());
        f.each_once(&place, "each display unit once", names);
        for (display, _) in unit.display_units.iter().filter(|u| u.1 == 0.0) {
            let place = format!("{place}, display unit `{display}`");
            f.error(place, "a factor other than 0", "0");
        }
    }
}

pub(super) fn unit_uses(d: &ModelDescription, f: &mut FmuFindings) {
    // the first of each name, as everywhere
    let mut units: HashMap<&str, &UnitDefinition> = HashMap::new();
    for unit in &d.units {
        units.entry(&unit.name).or_insert(unit);
    }
    let variables = d.variables.iter().map(|v| (v.place(), &v.attributes));
    let types = d.types.iter().map(|t| {
        let place = format!("{FILE}, line {}, type `{}`", t.line, t.name);
        (place, &t.attributes)
    });
    for (place, attributes) in variables.chain(types) {
        let display = attributes.display_unit.as_ref();
        let undefined = |name: &str| format!("`{name}`, which is not defined");
        let Some(name) = &attributes.unit else {
            if let Some(display) = display {
                let expected = format!("a unit for the display unit `{display}`");
                f.error(place, expected, "none");
            }
            continue;
        };
        let Some(unit) = units.get(name.as_str()) else {
            f.error(place, "a unit of <UnitDefinitions>", undefined(name));
            continue;
        };
        if let Some(display) = display
            && !unit.display_units.iter().any(|(name, _)| name == display)
        {
            let expected = format!("a display unit of `{name}`");
            f.error(place, expected, undefined(display));
        }
    }
}
