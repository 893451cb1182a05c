//! What is odd about a study: its section and its virtual tunnel.

use super::Study;
use crate::plausibility::{Finding, of_section};

/// Largest amplitude over the width.
const MOST_AMPLITUDE: f64 = 0.5;
/// Smallest amplitude of rotation that is driven on purpose, degrees.
const LEAST_ROTATION_DEG: f64 = 0.05;

/// What is odd about a study beside its deck.
pub(crate) fn study_findings(study: &Study) -> Vec<Finding> {
    let mut found = of_section(&study.section);
    let width = study.section.width_m;
    let plan = &study.tunnel;
    for (key, amplitude) in [
        ("tunnel.vertical_amplitude_m", plan.vertical_amplitude_m),
        ("tunnel.lateral_amplitude_m", plan.lateral_amplitude_m),
        ("export.initial_vertical_m", study.export.initial_vertical_m),
    ] {
        if amplitude.abs() > MOST_AMPLITUDE * width {
            let text = format!("that is {:.1} widths", amplitude.abs() / width);
            let meant = format!("in millimetres it would be {} m", amplitude / 1e3);
            found.push(Finding::unit(key, amplitude, text).otherwise(meant));
        }
    }
    if plan.torsion_amplitude_deg < LEAST_ROTATION_DEG {
        let degrees = plan.torsion_amplitude_deg.to_degrees();
        let key = "tunnel.torsion_amplitude_deg";
        let found_there = Finding::unit(key, plan.torsion_amplitude_deg, "too small to measure");
        let meant = format!("in radians it would be {degrees:.2} degrees");
        found.push(found_there.otherwise(meant));
    }
    found.extend(plan.findings());
    if let Some(block) = &study.coefficients {
        found.extend(block.findings(&study.directory, &study.section.dofs()));
    }
    found
}
