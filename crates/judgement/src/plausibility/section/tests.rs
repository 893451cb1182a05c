//! Every slip of a section has its sentence, and right sections have none.

use super::super::sentences;
use super::*;
use crate::section::{Rotation, Translation};

/// A suspension bridge with a steel box of 26.4 m: 0.131 and 0.36 Hz.
fn box_girder() -> SectionModel {
    SectionModel::two_dof(
        26.4,
        1.25,
        Translation::new(14_500.0, 0.131, 0.005),
        Rotation::new(14_500.0 * 7.9 * 7.9, 0.36, 0.005),
    )
}

#[test]
fn sections_of_bridges_and_models_are_plausible() {
    let footbridge = SectionModel::two_dof(
        4.0,
        1.25,
        Translation::new(1500.0, 1.1, 0.004),
        Rotation::new(1500.0 * 1.2 * 1.2, 2.4, 0.004),
    );
    let concrete = SectionModel::two_dof(
        22.0,
        1.25,
        Translation::new(38_000.0, 0.26, 0.01),
        Rotation::new(38_000.0 * 6.2 * 6.2, 0.58, 0.01),
    );
    let sections = [
        SectionModel::table_4_1(),
        SectionModel::iabse_1_1a(),
        box_girder(),
        footbridge,
        concrete,
    ];
    for section in sections {
        assert_eq!(sentences(&of_section(&section)), Vec::<String>::new());
        let still = SectionModel {
            vertical: Translation {
                damping_ratio: 0.0,
                ..section.vertical.clone()
            },
            ..section
        };
        assert!(of_section(&still).is_empty());
    }
}

/// The findings of a section after a change.
fn found(mut section: SectionModel, change: impl Fn(&mut SectionModel)) -> Vec<Finding> {
    change(&mut section);
    of_section(&section)
}

/// The one doubt of the model of Table 4.1 with sway, after a change.
fn doubt(change: impl Fn(&mut SectionModel)) -> String {
    let mut section = SectionModel::table_4_1();
    section.lateral = Some(section.vertical.clone());
    let found = found(section, change);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].severity, FindingSeverity::Doubt);
    found[0].to_string()
}

#[test]
fn other_units_are_recognised_by_key() {
    assert_eq!(
        doubt(|s| s.width_m = 502.3),
        "section.width_m = 502.3: 0.02 to 100 m is usual; in mm it would be 0.5023 m"
    );
    assert_eq!(
        doubt(|s| s.air_density_kg_m3 = 1250.0),
        "section.air_density_kg_m3 = 1250: 0.7 to 1.6 kg/m³ is usual; in g/m³ it would be 1.25 kg/m³"
    );
    assert_eq!(
        doubt(|s| s.torsion.frequency_hz = Some(31.4)),
        "section.torsion.frequency_hz = 31.4: 1 to 20 Hz is usual at a width of 0.5 m; in rad/s it would be 4.997 Hz"
    );
    assert_eq!(
        doubt(|s| s.vertical.damping_ratio = 0.3),
        "section.vertical.damping_ratio = 0.3: a ratio to critical damping is usually 0.0005 to 0.02; in per cent it would be \
         0.003"
    );
    assert_eq!(
        doubt(|s| s.lateral.as_mut().unwrap().mass_kg_m = 0.015),
        "section.lateral.mass_kg_m = 0.015: that is 0.050 times the air in a square of the width (1.5 to 1000 is usual); in t/m \
         it would be 15 kg/m"
    );
    assert_eq!(
        doubt(|s| s.torsion.inertia_kg_m2_m = 600.0),
        "section.torsion.inertia_kg_m2_m = 600: with the mass that is a radius of gyration of 12.649 widths (decks have 0.2 to \
         0.45; 0.5 is all mass in both edges); were the mass in t/m, it would be 0.400 widths"
    );
    assert_eq!(
        doubt(|s| s.axis_offset_m = Some(-55.0)),
        "section.axis_offset_m = -55: the edge of the deck is 0.25 m from mid-chord; in mm it would be -0.055 m"
    );
    assert!(doubt(|s| s.width_m = 22_000.0).ends_with("in mm it would be 22 m"));
}

/// The semi-chord for the width: 0.84 widths of a uniform deck's 0.42, +36 % on the onset.
#[test]
fn a_semi_chord_is_no_width() {
    let found = found(SectionModel::iabse_1_1a(), |s| {
        s.torsion.inertia_kg_m2_m = s.vertical.mass_kg_m * (0.42 * s.width_m).powi(2);
        s.width_m /= 2.0;
    });
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(
        found[0].to_string(),
        format!(
            "section.torsion.inertia_kg_m2_m = {}: with the mass that is a radius of gyration of 0.840 widths (decks have 0.2 to \
             0.45; 0.5 is all mass in both edges); were width_m the semi-chord, B would be 31 m and this would be 0.420 widths",
            22_740.0 * (0.42 * 31.0_f64).powi(2)
        )
    );
    assert_eq!(found[0].severity, FindingSeverity::Doubt);
}

/// Circular frequencies for hertz, at a width where both could be a bridge's: the plate's flutter tells.
#[test]
fn circular_frequencies_of_a_wide_deck_are_recognised() {
    let found = found(box_girder(), |s| {
        for f in [&mut s.vertical.frequency_hz, &mut s.torsion.frequency_hz] {
            *f = f.map(|hz| hz * TAU);
        }
    });
    assert_eq!(found.len(), 1, "{found:?}");
    let text = found[0].to_string();
    assert!(
        text.starts_with(
            "section.torsion.frequency_hz = 2.261946710584651: with these masses and frequencies (0.8231 and 2.2619 Hz) a flat \
             plate flutters near "
        ),
        "{text}"
    );
    assert!(
        text.contains("in rad/s the frequencies would be 0.131 and 0.36 Hz"),
        "{text}"
    );
    assert_eq!(found[0].severity, FindingSeverity::Doubt);
}

/// Torsion below heave couples into no flutter, which looks safe.
#[test]
fn torsion_is_faster_than_heave() {
    let said = |change: fn(&mut SectionModel)| {
        let found = found(box_girder(), change);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].severity, FindingSeverity::Doubt);
        found[0].to_string()
    };
    assert_eq!(
        said(|s| s.vertical.frequency_hz = Some(0.823)),
        "section.torsion.frequency_hz = 0.36: it is not above that of heave, 0.8230 Hz, where decks have 1.3 to 4 times it; were \
         heave in rad/s, it would have 0.131 Hz"
    );
    assert!(
        said(|s| s.vertical.frequency_hz = s.torsion.frequency_hz).ends_with("1.3 to 4 times it")
    );
}

#[test]
fn a_requirement_at_the_scale_of_a_model_is_a_note() {
    let found = of_required_speed(Some(7.5), 31.0).unwrap();
    assert_eq!(found.severity, FindingSeverity::Note);
    assert_eq!(
        found.to_string(),
        "flutter.required_speed_m_s = 7.5: no deck of 31 m is built for less than 10 m/s; is it at the scale of a model, or in \
         another unit?"
    );
    for (speed, width) in [(Some(7.5), 0.5), (Some(60.0), 31.0), (None, 31.0)] {
        assert!(of_required_speed(speed, width).is_none());
    }
}

/// Stiffnesses are judged as the frequencies that they are.
#[test]
fn a_stiffness_is_a_frequency() {
    let found = found(box_girder(), |s| {
        s.vertical.frequency_hz = None;
        s.vertical.stiffness_n_m2 = Some(s.vertical.mass_kg_m * (TAU * 9.0_f64).powi(2));
    });
    assert!(
        found[0].to_string().contains("0.05 to 1 Hz is usual"),
        "{found:?}"
    );
}

/// Rare values are notes, which leave a verdict as it is.
#[test]
fn rare_values_are_notes() {
    for (damping, words) in [
        (
            0.05,
            "as a logarithmic decrement it would be a ratio of 0.007958",
        ),
        (
            0.0126,
            "usually 0.0005 to 0.01; as a logarithmic decrement it would be a ratio of 0.002005",
        ),
        (1e-4, "usually 0.0005 to 0.01"),
    ] {
        let found = found(box_girder(), |s| s.torsion.damping_ratio = damping);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].severity, FindingSeverity::Note);
        assert!(found[0].to_string().ends_with(words), "{}", found[0]);
    }
    let rare = found(box_girder(), |s| s.torsion.inertia_kg_m2_m *= 2.5);
    assert_eq!((rare.len(), rare[0].severity), (1, FindingSeverity::Note));
}
