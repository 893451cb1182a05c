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
    format!(
        "{FILE}, line {}, {list}, index {}",
        unknown.line, unknown.index
    )
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
        f.error(
            d.variables[index - 1].place(),
            format!("to be listed in <{list}>: {why}"),
            "it is not",
        );
    }
    for unknown in found.iter().filter(|u| !expected.contains(&u.index)) {
        if let Some(v) = d.variable_at(unknown.index) {
            f.error(
                place(list, unknown),
                format!("only variables of which holds: {why}"),
                format!("`{}`", v.name),
            );
        }
    }
}

fn indices(
    d: &ModelDescription,
    mut belongs: impl FnMut(usize, &ScalarVariable) -> bool,
) -> BTreeSet<usize> {
    d.variables
        .iter()
        .enumerate()
        .filter(|(i, v)| belongs(i + 1, v))
        .map(|(i, _)| i + 1)
        .collect()
}

pub(super) fn outputs(d: &ModelDescription, f: &mut FmuFindings) {
    let expected = indices(d, |_, v| v.causality == Causality::Output);
    same_members(
        d,
        f,
        "Outputs",
        &d.outputs,
        &expected,
        "causality is output",
    );
}

pub(super) fn initial_unknowns(d: &ModelDescription, f: &mut FmuFindings) {
    let derivatives: BTreeSet<usize> = d.derivatives.iter().map(|u| u.index).collect();
    let states: BTreeSet<usize> = derivatives
        .iter()
        .filter_map(|i| d.variable_at(*i)?.derivative)
        .collect();
    let expected = indices(d, |index, v| {
        let unknown = matches!(
            v.effective_initial(),
            Some(Initial::Approx | Initial::Calculated)
        );
        let listed = derivatives.contains(&index) || states.contains(&index);
        match v.causality {
            Causality::Output => unknown,
            Causality::CalculatedParameter => true,
            _ => listed && unknown,
        }
    });
    same_members(
        d,
        f,
        "InitialUnknowns",
        &d.initial_unknowns,
        &expected,
        "output, state or derivative with initial approx or calculated, or calculated parameter",
    );
}

pub(super) fn state_derivatives(d: &ModelDescription, f: &mut FmuFindings) {
    for unknown in &d.derivatives {
        if let Some(v) = d.variable_at(unknown.index)
            && v.derivative.is_none()
        {
            f.error(
                place("Derivatives", unknown),
                "a variable with the attribute `derivative`",
                format!("`{}` without", v.name),
            );
        }
    }
}

pub(super) fn order(d: &ModelDescription, f: &mut FmuFindings) {
    for (list, unknowns) in lists(d) {
        for unknown in unknowns {
            if d.variable_at(unknown.index).is_none() {
                f.error(
                    place(list, unknown),
                    format!("an index in 1 .. {}", d.variables.len()),
                    unknown.index.to_string(),
                );
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
            f.error(
                place(list, &pair[1]),
                "ascending indices",
                format!("{} after {}", pair[1].index, pair[0].index),
            );
        }
    }
}

pub(super) fn dependencies(d: &ModelDescription, f: &mut FmuFindings) {
    for (list, unknowns) in lists(d) {
        for unknown in unknowns {
            let on = unknown.dependencies.as_deref().unwrap_or_default();
            for index in on.iter().filter(|i| d.variable_at(**i).is_none()) {
                f.error(
                    place(list, unknown),
                    format!("dependencies in 1 .. {}", d.variables.len()),
                    index.to_string(),
                );
            }
            if on.windows(2).any(|pair| pair[0] >= pair[1]) {
                f.warning(
                    place(list, unknown),
                    "dependencies in ascending order, each once",
                    format!("{on:?}"),
                );
            }
            kinds(f, list, unknown, on.len());
        }
    }
}

fn kinds(f: &mut FmuFindings, list: &str, unknown: &Unknown, dependencies: usize) {
    let Some(kinds) = &unknown.kinds else { return };
    if unknown.dependencies.is_none() {
        f.error(
            place(list, unknown),
            "dependenciesKind only along with dependencies",
            "it alone",
        );
    } else if kinds.len() != dependencies {
        f.error(
            place(list, unknown),
            format!("{dependencies} words in dependenciesKind, as many as dependencies"),
            kinds.len().to_string(),
        );
    }
    let allowed: &[&str] = if list == "InitialUnknowns" {
        &["dependent", "constant"]
    } else {
        &["dependent", "constant", "fixed", "tunable", "discrete"]
    };
    for kind in kinds.iter().filter(|k| !allowed.contains(&k.as_str())) {
        f.error(
            place(list, unknown),
            format!("dependenciesKind of {}", allowed.join(", ")),
            format!("`{kind}`"),
        );
    }
}
