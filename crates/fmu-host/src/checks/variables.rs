//! Rules about single variables and about variables that share a value reference.

use super::super::description::{
    Causality, FILE, Initial, ModelDescription, ScalarVariable, Value, Variability, VariableType,
    initial_choices,
};
use super::super::findings::FmuFindings;
use super::head::is_identifier;
use std::collections::BTreeMap;

/// Names that one finding lists.
const MAX_NAMES: usize = 5;

pub(super) fn names(d: &ModelDescription, f: &mut FmuFindings) {
    let names = d.variables.iter().map(|v| v.name.as_str());
    f.each_once(&format!("{FILE}, ModelVariables"), "unique names", names);
    for v in &d.variables {
        if v.name.is_empty() || v.name.contains(['\r', '\n', '\t']) {
            let expected = "a name without line breaks and tabs";
            f.error(v.place(), expected, format!("{:?}", v.name));
        } else if d.variable_naming_convention == "structured" && !structured(&v.name) {
            let expected = "a structured name such as `a.b[1]` or `der(x)`";
            f.error(v.place(), expected, format!("`{}`", v.name));
        }
    }
}

/// Names of the convention `structured` (section 2.2.9): dotted identifiers with indices, `der(name)`, `der(name, n)`.
fn structured(name: &str) -> bool {
    if let Some(inner) = name.strip_prefix("der(").and_then(|n| n.strip_suffix(')')) {
        // a comma inside brackets stands between indices
        let order = inner.rsplit_once(',');
        let order = order.filter(|(_, order)| !order.contains(']'));
        let (inner, order) = order.unwrap_or((inner, "1"));
        return structured(inner.trim()) && order.trim().parse::<u32>().is_ok();
    }
    name.split('.').all(|part| {
        let (identifier, indices) = part.find('[').map_or((part, ""), |at| part.split_at(at));
        let quoted =
            identifier.len() > 2 && identifier.starts_with('\'') && identifier.ends_with('\'');
        let inside = indices.strip_prefix('[').and_then(|i| i.strip_suffix(']'));
        (quoted || is_identifier(identifier))
            && (indices.is_empty()
                || inside.is_some_and(|i| i.split(',').all(|n| n.trim().parse::<u32>().is_ok())))
    })
}

pub(super) fn types(d: &ModelDescription, f: &mut FmuFindings) {
    let types = d.types_by_name();
    for v in &d.variables {
        if v.kind == VariableType::Enumeration && v.declared_type.is_none() {
            f.error(v.place(), "the declared type of an enumeration", "none");
        }
        let Some(name) = &v.declared_type else {
            continue;
        };
        match types.get(name.as_str()) {
            None => {
                let found = format!("`{name}`, which is not defined");
                f.error(v.place(), "a type of <TypeDefinitions>", found);
            }
            Some(t) if t.kind != v.kind => {
                let expected = format!("a declared type of kind {:?}", v.kind);
                let found = format!("`{name}` of kind {:?}", t.kind);
                f.error(v.place(), expected, found);
            }
            Some(_) => {}
        }
    }
}

pub(super) fn combinations(d: &ModelDescription, f: &mut FmuFindings) {
    for v in &d.variables {
        if v.kind != VariableType::Real && v.variability == Variability::Continuous {
            let expected = "a variability other than continuous, since it is not Real";
            let found = match v.variability_stated {
                true => "continuous",
                false => "none stated, which means continuous",
            };
            f.error(v.place(), expected, found);
        } else if initial_choices(v.causality, v.variability).is_none() {
            let expected = "a legal combination of causality and variability";
            let found = format!("{:?} and {:?}", v.causality, v.variability).to_lowercase();
            f.error(v.place(), expected, found);
        }
    }
}

pub(super) fn initial(d: &ModelDescription, f: &mut FmuFindings) {
    for v in &d.variables {
        if let Some(stated) = v.initial
            && let Some((_, allowed)) = initial_choices(v.causality, v.variability)
            && !allowed.contains(&stated)
        {
            let expected = match allowed.is_empty() {
                true => "no `initial` on an input or on time".to_owned(),
                false => format!("initial to be one of {allowed:?}").to_lowercase(),
            };
            f.error(v.place(), expected, format!("{stated:?}").to_lowercase());
        }
    }
}

pub(super) fn start_presence(d: &ModelDescription, f: &mut FmuFindings) {
    for v in &d.variables {
        let initial = v.effective_initial();
        let needed = v.causality == Causality::Input
            || matches!(initial, Some(Initial::Exact | Initial::Approx));
        let forbidden =
            v.causality == Causality::Independent || initial == Some(Initial::Calculated);
        if needed && v.start.is_none() {
            f.error(v.place(), "a start value", "none");
        } else if forbidden && v.start.is_some() {
            let expected = "no start value, since it is calculated or time";
            f.error(v.place(), expected, "one");
        }
    }
}

pub(super) fn ranges(d: &ModelDescription, f: &mut FmuFindings) {
    let types = d.types_by_name();
    for v in &d.variables {
        let min = v.attribute(&types, |a| a.min);
        let max = v.attribute(&types, |a| a.max);
        if let (Some(min), Some(max)) = (min, max)
            && max < min
        {
            let expected = format!("max not below min = {min}");
            f.error(v.place(), expected, max.to_string());
        }
        let start = match &v.start {
            Some(Value::Real(x)) => *x,
            Some(Value::Integer(i)) => f64::from(*i),
            _ => continue,
        };
        if min.is_some_and(|m| start < m) || max.is_some_and(|m| start > m) {
            let low = min.map_or("-∞".into(), |m| m.to_string());
            let high = max.map_or("∞".into(), |m| m.to_string());
            let expected = format!("a start value in {low} .. {high}");
            f.error(v.place(), expected, start.to_string());
        }
        if v.attribute(&types, |a| a.nominal) == Some(0.0) {
            f.error(v.place(), "a nominal value other than 0", "0");
        }
    }
}

/// Section 2.2.7 on alias sets: at most one member can be set, constants stand apart, units agree.
pub(super) fn aliases(d: &ModelDescription, f: &mut FmuFindings) {
    let types = d.types_by_name();
    let mut sets: BTreeMap<(VariableType, u32), Vec<&ScalarVariable>> = BTreeMap::new();
    for v in &d.variables {
        // the two are the same C type
        let kind = match v.kind {
            VariableType::Enumeration => VariableType::Integer,
            kind => kind,
        };
        sets.entry((kind, v.value_reference)).or_default().push(v);
    }
    for ((_, reference), set) in sets.iter().filter(|(_, set)| set.len() > 1) {
        let name = |v: &&&ScalarVariable| format!("`{}`", v.name);
        let settable: Vec<_> = set.iter().filter(|v| v.settable()).collect();
        if settable.len() > 1 {
            let mut names: Vec<_> = settable.iter().take(MAX_NAMES).map(name).collect();
            if settable.len() > MAX_NAMES {
                names.push(format!("and {} more", settable.len() - MAX_NAMES));
            }
            let expected = format!("one settable variable for value reference {reference}");
            f.error(settable[1].place(), expected, names.join(", "));
        }
        let is_constant = |v: &&ScalarVariable| v.variability == Variability::Constant;
        if set.iter().any(is_constant) && !set.iter().all(is_constant) {
            let expected = format!("only constants or none with value reference {reference}");
            f.error(set[1].place(), expected, "both");
        }
        let unit = |v: &ScalarVariable| v.attribute(&types, |a| a.unit.clone());
        let first = unit(set[0]);
        if let Some(other) = set.iter().find(|v| unit(v) != first) {
            let expected = format!("the unit of its alias `{}`", set[0].name);
            let found = unit(other).unwrap_or_else(|| "none".into());
            f.error(other.place(), expected, found);
        }
    }
}

pub(super) fn derivatives(d: &ModelDescription, f: &mut FmuFindings) {
    for v in &d.variables {
        let Some(of) = v.derivative else { continue };
        match d.variable_at(of) {
            None => {
                let expected = format!("`derivative` in 1 .. {}", d.variables.len());
                f.error(v.place(), expected, of.to_string());
            }
            Some(state) if state.kind != VariableType::Real || v.kind != VariableType::Real => {
                let found = format!("derivative of `{}`", state.name);
                f.error(v.place(), "the derivative of a Real, itself a Real", found);
            }
            Some(_) => {}
        }
    }
}

pub(super) fn independent(d: &ModelDescription, f: &mut FmuFindings) {
    let is_time = |v: &&ScalarVariable| v.causality == Causality::Independent;
    if let Some(second) = d.variables.iter().filter(is_time).nth(1) {
        f.error(second.place(), "at most one independent variable", "two");
    }
}
