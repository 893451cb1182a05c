//! Values that are possible but implausible: most of them are in another unit than the key says.

use super::Study;
use crate::section::SectionModel;

/// Widest deck, m.
const WIDEST_M: f64 = 100.0;
/// Narrowest model, m.
const NARROWEST_M: f64 = 0.03;
/// Air between a high mountain and a cold day, kg/m³.
const DENSITIES: (f64, f64) = (0.7, 1.6);
/// Highest ratio to critical damping of a structure.
const MOST_DAMPING: f64 = 0.1;
/// Decks narrower than this are models, m.
pub(super) const WIDEST_MODEL_M: f64 = 2.0;
/// Fastest suspension of a model and of a bridge, Hz.
const FASTEST_HZ: (f64, f64) = (20.0, 6.0);
/// Mass over that of the air in a square of the width, `m/(ρB²)`.
const MASS_RATIOS: (f64, f64) = (1.5, 1000.0);
/// Radius of gyration over the width, `√(J/m)/B`.
const RADII: (f64, f64) = (0.05, 1.0);
/// Largest amplitude over the width.
const MOST_AMPLITUDE: f64 = 0.5;
/// Smallest amplitude of rotation that is driven on purpose, degrees.
const LEAST_ROTATION_DEG: f64 = 0.05;

/// Implausible values of a section: one sentence per key, with the likely reason.
pub(crate) fn section_warnings(section: &SectionModel) -> Vec<String> {
    let (heave, twist) = (&section.vertical, &section.torsion);
    let sway = section.lateral.as_ref();
    let width = section.width_m;
    let mut found = Vec::new();
    found.extend(width_warning(width));
    found.extend(density_warning(section.air_density_kg_m3));
    let mut supports = vec![
        ("vertical", heave.frequency_hz, heave.damping_ratio),
        ("torsion", twist.frequency_hz, twist.damping_ratio),
    ];
    supports.extend(sway.map(|s| ("lateral", s.frequency_hz, s.damping_ratio)));
    for (name, frequency_hz, damping_ratio) in supports {
        found.extend(frequency_warning(name, frequency_hz, width));
        found.extend(damping_warning(name, damping_ratio));
    }
    found.extend(mass_warning("vertical", heave.mass_kg_m, section));
    found.extend(sway.and_then(|s| mass_warning("lateral", s.mass_kg_m, section)));
    found.extend(inertia_warning(section));
    found
}

fn width_warning(width_m: f64) -> Option<String> {
    let why = if width_m > WIDEST_M {
        let millimetres = width_m / 1e3;
        format!("no deck is wider than {WIDEST_M} m; in millimetres it would be {millimetres} m")
    } else if width_m < NARROWEST_M {
        "no model is that narrow; is it in kilometres or a semi-chord?".to_owned()
    } else {
        return None;
    };
    Some(warning("section.width_m", width_m, &why))
}

fn density_warning(density: f64) -> Option<String> {
    let (least, most) = DENSITIES;
    (!(least..=most).contains(&density)).then(|| {
        let usual = format!("air has {least} to {most} kg/m³; 1.2 at sea level");
        warning("section.air_density_kg_m3", density, &usual)
    })
}

fn damping_warning(name: &str, damping_ratio: f64) -> Option<String> {
    (damping_ratio > MOST_DAMPING).then(|| {
        let likely = format!(
            "a ratio to critical damping is usually 0.001 to 0.02; in per cent it would be {}",
            damping_ratio / 100.0
        );
        let key = format!("section.{name}.damping_ratio");
        warning(&key, damping_ratio, &likely)
    })
}

fn mass_warning(name: &str, mass: f64, section: &SectionModel) -> Option<String> {
    let (width, density) = (section.width_m, section.air_density_kg_m3);
    let ratio = mass / (density * width * width);
    let likely = if ratio < MASS_RATIOS.0 {
        "is it in t/m?"
    } else {
        "is it that of the whole model or span?"
    };
    (!(MASS_RATIOS.0..=MASS_RATIOS.1).contains(&ratio)).then(|| {
        let why = format!(
            "that is {ratio:.3} times the air in a square of the width (bridges have 5 to 100); {likely}"
        );
        warning(&format!("section.{name}.mass_kg_m"), mass, &why)
    })
}

fn inertia_warning(section: &SectionModel) -> Option<String> {
    let inertia = section.torsion.inertia_kg_m2_m;
    let radius = (inertia / section.vertical.mass_kg_m).sqrt() / section.width_m;
    (!(RADII.0..=RADII.1).contains(&radius)).then(|| {
        let why = format!(
            "with the mass that is a radius of gyration of {radius:.3} widths (decks have 0.2 to 0.5); another unit of mass, \
             inertia or width?"
        );
        warning("section.torsion.inertia_kg_m2_m", inertia, &why)
    })
}

fn frequency_warning(name: &str, frequency_hz: Option<f64>, width_m: f64) -> Option<String> {
    let hertz = frequency_hz?;
    let (what, fastest) = if width_m < WIDEST_MODEL_M {
        ("model", FASTEST_HZ.0)
    } else {
        ("bridge", FASTEST_HZ.1)
    };
    (hertz > fastest).then(|| {
        let why = format!(
            "no {what} moves faster than {fastest} Hz; in rad/s it would be {:.3} Hz",
            hertz / std::f64::consts::TAU
        );
        warning(&format!("section.{name}.frequency_hz"), hertz, &why)
    })
}

/// The same for a study: section and virtual tunnel.
pub(crate) fn study_warnings(study: &Study) -> Vec<String> {
    let mut found = section_warnings(&study.section);
    let width = study.section.width_m;
    let plan = &study.tunnel;
    for (key, amplitude) in [
        ("tunnel.vertical_amplitude_m", plan.vertical_amplitude_m),
        ("tunnel.lateral_amplitude_m", plan.lateral_amplitude_m),
        ("export.initial_vertical_m", study.export.initial_vertical_m),
    ] {
        if amplitude.abs() > MOST_AMPLITUDE * width {
            let why = format!(
                "that is {:.1} widths; in millimetres it would be {} m",
                amplitude.abs() / width,
                amplitude / 1e3
            );
            found.push(warning(key, amplitude, &why));
        }
    }
    if plan.torsion_amplitude_deg < LEAST_ROTATION_DEG {
        let degrees = plan.torsion_amplitude_deg.to_degrees();
        let why = format!("too small to measure; in radians it would be {degrees:.2} degrees");
        found.push(warning(
            "tunnel.torsion_amplitude_deg",
            plan.torsion_amplitude_deg,
            &why,
        ));
    }
    found
}

fn warning(key: &str, value: f64, why: &str) -> String {
    format!("{key} = {value}: {why}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::section::Translation;

    #[test]
    fn sections_of_bridges_and_models_are_plausible() {
        for section in [SectionModel::table_4_1(), SectionModel::iabse_1_1a()] {
            assert_eq!(section_warnings(&section), Vec::<String>::new());
        }
    }

    /// The one warning of the section of Table 4.1 after a change.
    fn warned(change: impl Fn(&mut SectionModel)) -> String {
        let mut section = SectionModel::table_4_1();
        section.lateral = Some(Translation {
            frequency_hz: Some(1.0),
            ..section.vertical.clone()
        });
        change(&mut section);
        section_warnings(&section).join("\n")
    }

    #[test]
    fn other_units_are_recognised_by_key() {
        let text = warned(|s| s.width_m = 502.3);
        assert!(text.contains("section.width_m = 502.3: "), "{text}");
        assert!(
            text.contains("in millimetres it would be 0.5023 m"),
            "{text}"
        );
        let text = warned(|s| s.torsion.frequency_hz = Some(31.4));
        assert!(
            text.contains("section.torsion.frequency_hz = 31.4: "),
            "{text}"
        );
        assert!(text.contains("in rad/s it would be 4.997 Hz"), "{text}");
        let text = warned(|s| s.vertical.damping_ratio = 0.3);
        assert!(
            text.contains("section.vertical.damping_ratio = 0.3: "),
            "{text}"
        );
        assert!(text.contains("in per cent it would be 0.003"), "{text}");
        let text = warned(|s| s.air_density_kg_m3 = 1190.0);
        assert!(
            text.contains("section.air_density_kg_m3 = 1190: "),
            "{text}"
        );
        let text = warned(|s| s.lateral.as_mut().unwrap().mass_kg_m = 0.015);
        assert!(
            text.contains("section.lateral.mass_kg_m = 0.015: "),
            "{text}"
        );
        assert!(text.contains("is it in t/m?"), "{text}");
        let text = warned(|s| s.torsion.inertia_kg_m2_m = 600.0);
        assert!(
            text.contains("section.torsion.inertia_kg_m2_m = 600: "),
            "{text}"
        );
    }
}
