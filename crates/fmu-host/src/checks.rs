//! Rules that the description must keep, beyond what FMPy's validation looks at. One function per rule.
//!
//! Rules are those of FMI 2.0.5, sections 2.2 and 4.3, with the strictest reading that some importer or checker takes.

mod head;
mod structure;
mod units;
mod variables;

use super::description::ModelDescription;
use super::findings::FmuFindings;

/// Applies every rule.
pub(super) fn check(description: &ModelDescription, findings: &mut FmuFindings) {
    for rule in RULES {
        rule(description, findings);
    }
}

type Rule = fn(&ModelDescription, &mut FmuFindings);

const RULES: [Rule; 20] = [
    head::head,
    head::co_simulation,
    head::log_categories,
    head::default_experiment,
    units::definitions,
    units::uses,
    variables::names,
    variables::types,
    variables::combinations,
    variables::initial,
    variables::start_presence,
    variables::ranges,
    variables::aliases,
    variables::derivatives,
    variables::independent,
    structure::outputs,
    structure::initial_unknowns,
    structure::state_derivatives,
    structure::order,
    structure::dependencies,
];

#[cfg(test)]
mod tests;
