//! The committed example, and files that are wrong.

use super::*;

const EXAMPLE: &str = include_str!("../../../examples/validation_case.toml");

#[test]
fn the_example_passes() {
    let case = UserCase::from_toml(EXAMPLE, "".into()).unwrap();
    let results = case.run();
    assert!(results.len() >= 10);
    for r in &results {
        assert!(
            r.passed,
            "{}: {:?} instead of {} {:?}",
            r.quantity, r.found, r.expected, r.problem
        );
    }
}

#[test]
fn a_wrong_figure_does_not_pass() {
    let case = UserCase::from_toml(&EXAMPLE.replace("77.480", "77.490"), "".into()).unwrap();
    let failed: Vec<_> = case.run().into_iter().filter(|r| !r.passed).collect();
    assert_eq!(failed.len(), 2, "{failed:?}");
    assert!((failed[0].deviation.unwrap() + 0.010).abs() < 1e-3);
}

#[test]
fn expected_figures_keep_their_digits_under_a_wide_tolerance() {
    let wide = EXAMPLE.replace(
        "expected = 0.03115\ntolerance = 0.000005",
        "expected = 0.03115\ntolerance = 0.1",
    );
    let results = UserCase::from_toml(&wide, "".into()).unwrap().run();
    assert_eq!(results.last().unwrap().decimals, 5);
}

#[test]
fn a_case_that_cannot_be_computed_says_why() {
    let text = EXAMPLE.replace(
        "flat_plate = { rotary_inertia = false }",
        "model = \"none.json\"",
    );
    let results = UserCase::from_toml(&text, "".into()).unwrap().run();
    assert!(results.iter().all(|r| !r.passed));
    assert!(results[0].problem.as_ref().unwrap().contains("none.json"));
}

#[test]
fn wrong_files_are_refused_with_their_line() {
    for (from, to, said) in [
        (
            "schema = 1",
            "schema = 2",
            "line 3, schema: expected 1, found 2",
        ),
        (
            "mass_kg_m = 22740.0",
            "mass_kg_m = -1.0",
            "vertical.mass_kg_m",
        ),
        (
            "quantity = \"onset_speed\"",
            "quantity = \"speed\"",
            "onset_frequency",
        ),
        (
            "route = \"determinant\"",
            "route = \"fmu_stepping\"",
            ".route: expected `eigenvalues`",
        ),
        ("dof = \"torsion\"", "", "`speed_m_s` and `dof`"),
        (
            "flat_plate = { rotary_inertia = false }",
            "",
            "exactly one of",
        ),
        (
            "tolerance = 0.0005",
            "tolerance = 0.0",
            "tolerance: expected a positive number",
        ),
    ] {
        assert!(EXAMPLE.contains(from), "{from}");
        let text = EXAMPLE.replacen(from, to, 1);
        let message = UserCase::from_toml(&text, "".into())
            .unwrap_err()
            .to_string();
        assert!(
            message.contains(said) && message.starts_with("line"),
            "{message}"
        );
    }
}
