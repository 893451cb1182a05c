//! `ModelStructure`: what is listed, in which order, and on what it depends.

use super::super::description::{
    Causality, FILE, Initial, ModelDescription, ScalarVariable, Unknown,
};
use super::super::findings::FmuFindings;
use std::collections::BTreeSet;

type Lists<'a> = [(&'static str, &'a [Unknown]); 3];

fn lists(d: &ModelDescription) -> Lists<'_> {
    [
        ("Outputs", &d.outputs),
        ("Derivatives", &d.derivatives),
        ("InitialUnknowns", &d.initial_unknowns),
    ]
}

fn place(list: &str, unknown: &Unknown) -> String {
    let Unknown { line, index, .. } = unknown;
    format!("{FILE}, line {line}, {list}, index {index}")
}

/// The list must name exactly the variables of `expected` (indices from 1).
fn same_members(
    d: &ModelDescription,
    f: &mut FmuFindings,
    list: &str,
    found: &[Unknown],
    expected: &BTreeSet<usize>,
    why: &str,
) {
    let listed: BTreeSet<usize> = found.iter().map(|u| u.index).collect();
    for index in expected.difference(&listed) {
        let expected = format!("to be listed in <{list}>: {why}");
        f.error(d.variables[index - 1].place(), expected, "it is not");
    }
    for unknown in found.iter().filter(|u| !expected.contains(&u.index)) {
        if let Some(v) = d.variable_at(unknown.index) {
            let expected = format!("only variables of which holds: {why}");
            f.error(place(list, unknown), expected, format!("`{}`", v.name));
        }
    }
}

fn indices(
    d: &ModelDescription,
    belongs: impl Fn(usize, &ScalarVariable) -> bool,
) -> BTreeSet<usize> {
    let all = (1..).zip(&d.variables);
    let members = all.filter(|(index, v)| belongs(*index, v));
    members.map(|(index, _)| index).collect()
}

pub(super) fn outputs(d: &ModelDescription, f: &mut FmuFindings) {
    let expected = indices(d, |_, v| v.causality == Causality::Output);
    let why = "causality is output";
    same_members(d, f, "Outputs", &d.outputs, &expected, why);
}

pub(super) fn initial_unknowns(d: &ModelDescription, f: &mut FmuFindings) {
    let derivatives: BTreeSet<usize> = d.derivatives.iter().map(|u| u.index).collect();
    let states: BTreeSet<usize> = derivatives
        .iter()
        .filter_map(|i| d.variable_at(*i)?.derivative)
        .collect();
    let expected = indices(d, |index, v| {
        let initial = v.effective_initial();
        let unknown = matches!(initial, Some(Initial::Approx | Initial::Calculated));
        let listed = derivatives.contains(&index) || states.contains(&index);
        match v.causality {
            Causality::Output => unknown,
            Causality::CalculatedParameter => true,
            _ => listed && unknown,
        }
    });
    let (list, listed) = ("InitialUnknowns", &d.initial_unknowns);
    let why =
        "output, state or derivative with initial approx or calculated, or calculated parameter";
    same_members(d, f, list, listed, &expected, why);
}

pub(super) fn state_derivatives(d: &ModelDescription, f: &mut FmuFindings) {
    for unknown in &d.derivatives {
        if let Some(v) = d.variable_at(unknown.index)
            && v.derivative.is_none()
        {
            let expected = "a variable with the attribute `derivative`";
            let found = format!("`{}` without", v.name);
            f.error(place("Derivatives", unknown), expected, found);
        }
    }
}

pub(super) fn order(d: &ModelDescription, f: &mut FmuFindings) {
    for (list, unknowns) in lists(d) {
        for unknown in unknowns {
            if d.variable_at(unknown.index).is_none() {
                let expected = format!("an index in 1 .. {}", d.variables.len());
                f.error(place(list, unknown), expected, unknown.index.to_string());
            }
        }
        let mut seen = BTreeSet::new();
        for unknown in unknowns {
            if !seen.insert(unknown.index) {
                f.error(place(list, unknown), "each variable once", "it twice");
            }
        }
        // the order of outputs and derivatives is the exporter's
        if list == "InitialUnknowns"
            && let Some(pair) = unknowns.windows(2).find(|p| p[0].index > p[1].index)
        {
            let found = format!("{} after {}", pair[1].index, pair[0].index);
            f.error(place(list, &pair[1]), "ascending indices", found);
        }
    }
}

pub(super) fn dependencies(d: &ModelDescription, f: &mut FmuFindings) {
    for (list, unknowns) in lists(d) {
        for unknown in unknowns {
            let on = unknown.dependencies.as_deref().unwrap_or_default();
            for index in on.iter().filter(|i| d.variable_at(**i).is_none()) {
                let expected = format!("dependencies in 1 .. {}", d.variables.len());
                f.error(place(list, unknown), expected, index.to_string());
            }
            if on.windows(2).any(|pair| pair[0] >= pair[1]) {
                let expected = "dependencies in ascending order, each once";
                f.warning(place(list, unknown), expected, format!("{on:?}"));
            }
            kinds(f, list, unknown, on.len());
        }
    }
}

fn kinds(f: &mut FmuFindings, list: &str, unknown: &Unknown, dependencies: usize) {
    let Some(kinds) = &unknown.kinds else { return };
    let place = place(list, unknown);
    if unknown.dependencies.is_none() {
        let expected = "dependenciesKind only along with dependencies";
        f.error(&place, expected, "it alone");
    } else if kinds.len() != dependencies {
        let expected = format!("{dependencies} words in dependenciesKind, as many as dependencies");
        f.error(&place, expected, kinds.len().to_string());
    }
    let allowed: &[&str] = match list {
        "InitialUnknowns" => &["dependent", "constant"],
        _ => &["dependent", "constant", "fixed", "tunable", "discrete"],
    };
    for kind in kinds.iter().filter(|k| !allowed.contains(&k.as_str())) {
        let expected = format!("dependenciesKind of {}", allowed.join(", "));
        f.error(&place, expected, format!("`{kind}`"));
    }
}
