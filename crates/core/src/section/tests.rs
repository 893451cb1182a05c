use super::*;

#[test]
fn frequency_and_stiffness_are_interchangeable() {
    let by_frequency = SectionModel::table_4_1();
    let mut by_stiffness = by_frequency.clone();
    by_stiffness.vertical.frequency_hz = None;
    by_stiffness.vertical.stiffness_n_m2 = Some(15.0 * (TAU * 2.0) * (TAU * 2.0));
    let (a, b) = (
        by_frequency.structure().unwrap(),
        by_stiffness.structure().unwrap(),
    );
    assert!((a.stiffness - b.stiffness).amax() < 1e-9);
    assert!((a.damping - b.damping).amax() < 1e-12);
}

#[test]
fn impossible_sections_are_refused_by_key() {
    let mut section = SectionModel::table_4_1();
    section.vertical.mass_kg_m = -3.0;
    let message = section.structure().unwrap_err().to_string();
    assert_eq!(
        message,
        "section.vertical.mass_kg_m: expected a positive number, found -3"
    );
    let mut section = SectionModel::table_4_1();
    section.torsion.stiffness_n = Some(1.0);
    assert!(
        section
            .structure()
            .unwrap_err()
            .to_string()
            .contains("found both")
    );
    let mut section = SectionModel::table_4_1();
    section.mass_offset_m = Some(-0.21);
    assert_eq!(
        section.structure().unwrap_err().to_string(),
        "section.mass_offset_m: expected less than the radius of gyration about the axis, 0.2000 m, found -0.21"
    );
}
