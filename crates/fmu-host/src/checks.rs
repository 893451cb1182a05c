//! The whole check of an FMU: archive, description and binary, then running it; and the rules that the description must keep, beyond what
//! FMPy's validation looks at. One function per rule.
//!
//! Rules are those of FMI 2.0.5, sections 2.2 and 4.3, with the strictest reading that some importer or checker takes.

mod head;
mod structure;
mod variables;

use super::description::ModelDescription;
use super::findings::{CheckReport, FmuFindings, FmuSeverity};
use super::{Fmu, library, trials};

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
    head::unit_definitions,
    head::unit_uses,
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

impl Fmu {
    /// Checks archive, description and binary, then runs the FMU if nothing stands against it: its code runs in this process,
    /// with all rights of it.
    pub fn check(&self) -> CheckReport {
        self.examined(true)
    }

    /// Checks archive and description without loading any code of the FMU.
    pub fn check_without_running(&self) -> CheckReport {
        self.examined(false)
    }

    fn examined(&self, running: bool) -> CheckReport {
        let mut findings = self.findings.clone();
        check(&self.description, &mut findings);
        self.check_files(&mut findings);
        let mut trials = Vec::new();
        let mut messages = Vec::new();
        let mut ran = None;
        match self.binary() {
            Err(e) => findings.error("archive", "a binary for this machine", e.to_string()),
            Ok(_) if !running => {}
            Ok(binary) => {
                let inside = binary.strip_prefix(self.folder.path());
                let place = inside.unwrap_or(&binary).display().to_string();
                let before = findings.0.len();
                library::check_symbols(&binary, self.description.is_fmi3(), &place, &mut findings);
                if findings.0.len() == before {
                    ran = Some(place);
                    (trials, messages) = trials::run(self, &mut findings);
                }
            }
        }
        CheckReport {
            file: self.path.display().to_string(),
            model_name: self.description.model_name.clone(),
            generation_tool: self.description.generation_tool.clone().unwrap_or_default(),
            platforms: self.platforms(),
            variables: self.description.variables.len(),
            findings: findings.0,
            ran,
            trials,
            messages,
        }
    }

    fn check_files(&self, findings: &mut FmuFindings) {
        let mut seen = std::collections::HashSet::new();
        for entry in &self.entries {
            if !seen.insert(entry.to_lowercase()) {
                let place = format!("archive, entry `{entry}`");
                let expected = "names that differ in more than case";
                findings.warning(place, expected, "the same twice");
            }
        }
        let icon = match self.description.is_fmi3() {
            false => "model.png",
            true => "terminalsAndIcons/icon.png",
        };
        for (file, what) in [
            ("documentation/index.html", "documentation"),
            (icon, "an icon"),
        ] {
            if !self.entries.iter().any(|e| e == file) {
                let expected = format!("{what} ({file})");
                findings.add(FmuSeverity::Note, "archive", expected, "none");
            }
        }
    }
}

#[cfg(test)]
mod tests;
