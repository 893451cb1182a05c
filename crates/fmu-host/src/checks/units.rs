//! Units: defined once, with a meaning, and every one that is used is defined.

use super::super::description::{FILE, ModelDescription, UnitDefinition};
use super::super::findings::FmuFindings;
use std::collections::HashMap;

pub(super) fn definitions(d: &ModelDescription, f: &mut FmuFindings) {
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

pub(super) fn uses(d: &ModelDescription, f: &mut FmuFindings) {
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
