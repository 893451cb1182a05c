//! Three degrees of freedom and 18 derivatives from the table to the FMU.

use crate::command::{onset_of, refused, succeeds};
use crate::three_dof;
use aerodeck::aerodynamics::Transfer;
use aerodeck::aerodynamics::derivatives::Derivative;
use aerodeck::aerodynamics::derivatives::Extrapolation;
use aerodeck::aerodynamics::derivatives::InterpolatedTable;
use aerodeck::aerodynamics::derivatives::Interpolation;
use aerodeck::aerodynamics::derivatives::Part;
use aerodeck::files::derivatives::embedded;
use aerodeck::flutter::{
    Onset, OnsetSearch, determinant_onset, divergence_by_eigenvalues, divergence_speed, find_onset,
    pk_onset,
};
use aerodeck::fmu::importer::Fmu;
use aerodeck::identification::Form;
use aerodeck::section::Dof;
use aerodeck::trained_model::TrainedModel;
use aerodeck::units::ReducedFrequency;
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

const SEARCH: OnsetSearch = OnsetSearch {
    speed_max_m_s: 60.0,
    speeds: 120,
};

fn forms() -> [Form; 2] {
    let rational = Form::Rational {
        lags: 2,
        added_mass: true,
    };
    [Form::default(), rational]
}

fn table_onset(lateral_hz: f64) -> Onset {
    let table = embedded::deck("LN21-5200").unwrap();
    let by = Interpolation::LinearVHat;
    let model = InterpolatedTable::by(by, &table, &Dof::THREE, Extrapolation::Refuse).unwrap();
    let structure = three_dof::section(lateral_hz).structure().unwrap();
    let range = model.tested_range();
    let found = determinant_onset("", &structure, &model, range, 60.0).unwrap();
    found.onset().unwrap().clone()
}

/// Every measured number stands at its place in `G`: row of the force, column of the motion.
#[test]
fn all_eighteen_derivatives_are_in_the_transfer_matrix() {
    let table = embedded::deck("LN21-5200").unwrap();
    // every point counts as it stands, also those of two speeds that nearly coincide
    let by = Interpolation::LinearVHat;
    let model = InterpolatedTable::by(by, &table, &Dof::THREE, Extrapolation::Hold).unwrap();
    for d in Derivative::ALL {
        let place = |dof| Dof::THREE.iter().position(|x| *x == dof).unwrap();
        for point in table.points(d) {
            let g = model.transfer(point.k()).unwrap()[(place(d.force()), place(d.motion()))];
            let part = if d.part() == Part::Real { g.re } else { g.im };
            let expected = point.value / (point.v_hat * point.v_hat);
            assert!((part - expected).abs() < 1e-12, "{d} at {}", point.v_hat);
        }
    }
}

/// Computed with NumPy and SciPy from the same table (3×3 determinant, linear in V̂): V, f, |y|/(B|θ|), phase.
#[test]
fn onset_of_the_table_by_the_determinant() {
    for (lateral_hz, expected) in [
        (1.2, [36.650_859, 3.977_691, 0.462_786, -173.638]),
        (3.9, [36.804_490, 3.968_463, 0.469_297, -173.396]),
        (4.1, [36.569_595, 3.981_875, 0.459_110, -173.774]),
    ] {
        let o = table_onset(lateral_hz);
        let mode = o.mode.unwrap();
        let found = [
            o.at.speed_m_s,
            o.at.frequency_hz,
            mode.mode_ratio,
            mode.phase_deg,
        ];
        for (found, expected) in found.iter().zip(expected) {
            // the digits given
            assert!(
                (found - expected).abs() < 6e-4 * (expected.abs() / 100.0).max(1e-3),
                "{found} {expected}"
            );
        }
    }
}

/// Eigenvalues of the realisation, 3×3 determinant and p-k iteration on one `G(K)`.
#[test]
fn three_routes_agree_on_fitted_models() {
    for form in forms() {
        let model: TrainedModel = three_dof::trained(form, 3.9);
        let section = three_dof::coupled(&model);
        let (s, tested) = (section.structure(), model.tested_range);
        let by_eigenvalues = find_onset("", &section, &SEARCH, Some(tested)).unwrap();
        let others = [
            determinant_onset("", s, &model.model, tested, 60.0).unwrap(),
            pk_onset("", s, &model.model, &SEARCH, Some(tested)).unwrap(),
        ];
        let first = by_eigenvalues.onset().unwrap();
        for other in others {
            let other = other.onset().unwrap();
            assert!((other.at.speed_m_s / first.at.speed_m_s - 1.0).abs() < 1e-9);
            assert!((other.at.frequency_hz / first.at.frequency_hz - 1.0).abs() < 1e-9);
            let ratios = [other, first].map(|o| o.mode.unwrap().mode_ratio);
            assert!((ratios[0] / ratios[1] - 1.0).abs() < 1e-6);
            let slopes = (
                other.damping_slope_s_m.unwrap(),
                first.damping_slope_s_m.unwrap(),
            );
            // the one by a one-sided difference over 1e-5 of the speed
            assert!((slopes.0 / slopes.1 - 1.0).abs() < 1e-3, "{slopes:?}");
        }
        // and the fit is near the table: the scatter of its two test speeds
        let table = table_onset(3.9).at.speed_m_s;
        assert!(
            (first.at.speed_m_s / table - 1.0).abs() < 0.03,
            "{} {table}",
            first.at.speed_m_s
        );
        let steady = model
            .model
            .transfer(ReducedFrequency::from_full_width(0.0))
            .unwrap();
        let closed = divergence_speed(s, &steady).unwrap().unwrap();
        let crossed = divergence_by_eigenvalues(&section, 120.0).unwrap().unwrap();
        assert!((closed / crossed - 1.0).abs() < 1e-9, "{closed} {crossed}");
    }
}

fn study() -> String {
    aerodeck::study::demo_study_text().replace(
        "torsion = {",
        "lateral = { mass_kg_m = 15.0, frequency_hz = 3.9, damping_ratio = 0.003 }\ntorsion = {",
    )
}

/// The whole chain with a lateral support; the FMU steps three degrees of freedom to the onset of the eigenvalues.
#[test]
fn a_study_with_a_lateral_support_ends_in_an_fmu() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    fs::write(at.join("study.toml"), study()).unwrap();
    succeeds(at, &["study", "study.toml"]);
    let summary: Value =
        serde_json::from_str(&fs::read_to_string(at.join("summary.json")).unwrap()).unwrap();
    let speed = |model: &str, method: &str| {
        onset_of(&summary, model, method)["speed_m_s"]
            .as_f64()
            .unwrap()
    };
    let eigenvalues = speed("Laguerre", "eigenvalues");
    let stepped = speed("Laguerre", "fmu_stepping");
    assert!(
        (stepped / eigenvalues - 1.0).abs() < 1e-4,
        "{stepped} {eigenvalues}"
    );
    assert!((eigenvalues / 36.804 - 1.0).abs() < 0.03);
    // modified Akima over ln K, computed with NumPy and SciPy
    assert!((speed("interpolated table", "determinant") - 36.965_935).abs() < 1e-5);
    let fmu = Fmu::open(at.join("deck_section.fmu")).unwrap();
    for name in [
        "sway",
        "sway_rate",
        "drag",
        "external_drag",
        "sway_mass",
        "initial_sway",
    ] {
        assert!(fmu.model_description().variable(name).is_some(), "{name}");
    }
    let all: Value =
        serde_json::from_str(&succeeds(at, &["flutter", "study.toml", "--all", "--json"])).unwrap();
    let routes = all["routes"]["routes"].as_array().unwrap();
    assert!(routes.len() >= 13);
    let kind = &routes[0]["mode"]["participation"];
    assert_eq!(kind.as_array().unwrap().len(), 3);
}

/// A deck without drag, or a table without its derivatives, is no deck for this section.
#[test]
fn a_lateral_support_needs_all_derivatives() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let plate = study().replace("source = \"LN21-5200\"", "source = \"flat plate\"");
    fs::write(at.join("study.toml"), plate).unwrap();
    refused(at, &["study", "study.toml"], &["deck.source", "lateral"]);
}
