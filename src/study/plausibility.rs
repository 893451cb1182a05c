//! What is odd about a study: its section and its virtual tunnel.

use super::Study;
use crate::plausibility::{Finding, of_required_speed, of_section};

/// Largest amplitude over the width.
const MOST_AMPLITUDE: f64 = 0.5;
/// Largest rotation, of a motion about the mean, degrees.
const MOST_ROTATION_DEG: f64 = 20.0;
/// Smallest amplitude of rotation that is driven on purpose, degrees.
const LEAST_ROTATION_DEG: f64 = 0.05;

/// What is odd about a study beside its deck.
pub(crate) fn study_findings(study: &Study) -> Vec<Finding> {
    let mut found = of_section(&study.section);
    let width = study.section.width_m;
    found.extend(of_required_speed(study.flutter.required_speed_m_s, width));
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
    for (key, degrees) in [
        ("tunnel.torsion_amplitude_deg", plan.torsion_amplitude_deg),
        (
            "export.initial_rotation_deg",
            study.export.initial_rotation_deg,
        ),
    ] {
        if degrees.abs() > MOST_ROTATION_DEG {
            let text = format!("more than {MOST_ROTATION_DEG} degrees are no small rotation");
            found.push(Finding::unit(key, degrees, text));
        }
    }
    if plan.noise_fraction > 1.0 {
        let (key, part) = ("tunnel.noise_fraction", plan.noise_fraction);
        let meant = format!("in per cent it would be {}", part / 100.0);
        found.push(Finding::unit(key, part, "more noise than force").otherwise(meant));
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

#[cfg(test)]
mod tests {
    use super::*;

    type Change = fn(&mut Study);

    #[test]
    fn numbers_in_another_unit_are_found_at_their_key() {
        let text = crate::study::new_study_text("LN21-5200", &Default::default());
        let study = Study::from_toml(&text, ".".into()).unwrap();
        assert_eq!(study_findings(&study), Vec::new());
        let changes: [(&str, Change); 5] = [
            ("noise_fraction", |s| s.tunnel.noise_fraction = 5.0),
            ("torsion_amplitude_deg", |s| {
                s.tunnel.torsion_amplitude_deg = 90.0
            }),
            ("initial_rotation_deg", |s| {
                s.export.initial_rotation_deg = -1000.0
            }),
            ("initial_vertical_m", |s| s.export.initial_vertical_m = 10.0),
            ("air_density_kg_m3", |s| s.tunnel.air_density_kg_m3 = 1000.0),
        ];
        for (key, change) in changes {
            let mut changed = study.clone();
            change(&mut changed);
            let found = study_findings(&changed);
            assert!(
                found.len() == 1 && found[0].place.contains(key),
                "{key}: {found:?}"
            );
        }
    }
}
