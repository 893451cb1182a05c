//! Equilibria against closed forms: the plate at an angle, its divergence, a fold, the end of a table.

use super::*;
use crate::aerodynamics::derivatives::TableHeader;
use crate::aerodynamics::quasi_steady::{Arms, CoefficientRow, StaticCoefficients};
use crate::section::SectionModel;
use std::f64::consts::PI;

fn table(moment: impl Fn(f64) -> f64) -> StaticCoefficients {
    let rows = (-20..=20)
        .map(|degrees| {
            let angle_deg = f64::from(degrees);
            CoefficientRow {
                angle_deg,
                drag: 0.05,
                lift: 2.0 * PI * angle_deg.to_radians(),
                moment: moment(angle_deg.to_radians()),
            }
        })
        .collect();
    StaticCoefficients::new("made up", TableHeader::default(), rows).unwrap()
}

fn path(moment: impl Fn(f64) -> f64, speeds: &[f64]) -> (EquilibriumPath, Structure) {
    let structure = SectionModel::iabse_1_1a().structure().unwrap();
    let theory = QuasiSteady::new(table(moment), Arms::default(), &structure.dofs).unwrap();
    let path = static_equilibria(&structure, &theory, speeds).unwrap();
    (path, structure)
}

/// `k θ = p B² (c₀ + c₁ θ)`: `θ = p B² c₀/(k − p B² c₁)`.
#[test]
fn a_straight_moment_curve_has_a_closed_form() {
    let speeds = [0.0, 20.0, 60.0, 80.0];
    let (path, s) = path(|a| 0.01 + PI / 2.0 * a, &speeds);
    assert_eq!((path.points.len(), path.end), (4, None));
    for point in &path.points {
        let p = 0.5 * s.air_density_kg_m3 * point.speed_m_s.powi(2);
        let wind = p * s.width_m.powi(2);
        let expected = wind * 0.01 / (s.stiffness[(1, 1)] - wind * PI / 2.0);
        assert!((point.rotation_rad - expected).abs() < 1e-12 * expected.abs().max(1.0));
        let lift = p * s.width_m * 2.0 * PI * expected;
        assert!((point.displacement[0] - lift / s.stiffness[(0, 0)]).abs() < 1e-10);
        let left = 1.0 - wind * PI / 2.0 / s.stiffness[(1, 1)];
        assert!((point.stiffness_left - left).abs() < 1e-12);
    }
}

/// The plate diverges at 90.466 m/s, computed independently in closed form.
#[test]
fn the_plate_diverges() {
    let (path, s) = path(|a| PI / 2.0 * a, &[80.0, 90.0, 91.0]);
    assert_eq!(path.points.len(), 2);
    let Some(EquilibriumEnd::Divergence { speed_m_s, .. }) = path.end else {
        panic!("{:?}", path.end)
    };
    let exact = (s.stiffness[(1, 1)] / (0.25 * PI * s.air_density_kg_m3)).sqrt() / s.width_m;
    assert!(
        (speed_m_s / exact - 1.0).abs() < 1e-8,
        "{speed_m_s} {exact}"
    );
    assert!((speed_m_s - 90.466).abs() < 5e-4);
}

/// `c = c₀ + c₁θ + c₂θ²`: the two equilibria meet where `p B² (c₁ + 2√(c₀c₂)) = k`.
#[test]
fn a_fold_is_divergence() {
    let (c0, c1, c2) = (0.01, 1.0, 4.0_f64);
    let (path, s) = path(|a| c0 + c1 * a + c2 * a * a, &[60.0, 120.0]);
    let Some(EquilibriumEnd::Divergence {
        speed_m_s,
        rotation_rad,
    }) = path.end
    else {
        panic!("{:?}", path.end)
    };
    let pressure = s.stiffness[(1, 1)] / (s.width_m.powi(2) * (c1 + 2.0 * (c0 * c2).sqrt()));
    let exact = (2.0 * pressure / s.air_density_kg_m3).sqrt();
    assert!(
        (speed_m_s / exact - 1.0).abs() < 1e-9,
        "{speed_m_s} {exact}"
    );
    // the rotation comes to the fold with the root of the distance in pressure
    assert!(
        (rotation_rad - (c0 / c2).sqrt()).abs() < 1e-5,
        "{rotation_rad}"
    );
}

#[test]
fn leaving_the_table_is_said() {
    let (path, s) = path(|_| 0.2, &[30.0, 60.0, 90.0, 200.0]);
    let Some(EquilibriumEnd::OutsideTable {
        speed_m_s,
        rotation_rad,
    }) = path.end
    else {
        panic!("{:?}", path.end)
    };
    let pressure = s.stiffness[(1, 1)] * 20f64.to_radians() / (0.2 * s.width_m.powi(2));
    let exact = (2.0 * pressure / s.air_density_kg_m3).sqrt();
    assert!(
        (speed_m_s / exact - 1.0).abs() < 1e-9,
        "{speed_m_s} {exact}"
    );
    assert!((rotation_rad.to_degrees() - 20.0).abs() < 1e-6);
    assert!(path.end.unwrap().explain().contains("leaves the table"));
}

#[test]
fn speeds_must_rise_and_degrees_of_freedom_agree() {
    let structure = SectionModel::iabse_1_1a().structure().unwrap();
    let theory = QuasiSteady::new(table(|a| a), Arms::default(), &Dof::THREE).unwrap();
    let message = static_equilibria(&structure, &theory, &[10.0]).unwrap_err();
    assert!(message.to_string().contains("lateral"), "{message}");
    let theory = QuasiSteady::new(table(|a| a), Arms::default(), &Dof::TWO).unwrap();
    let message = static_equilibria(&structure, &theory, &[10.0, 5.0]).unwrap_err();
    assert!(message.to_string().contains("5 after 10"), "{message}");
}
