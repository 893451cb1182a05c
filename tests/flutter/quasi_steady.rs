//! Onsets of quasi-steady forces: three routes, galloping, the end of the equilibrium.

use aerodeck::aerodynamics::quasi_steady::Arms;
use aerodeck::aerodynamics::quasi_steady::QuasiSteady;
use aerodeck::aeroelastic::{CoupledSection, static_equilibria};
use aerodeck::files::coefficients::embedded;
use aerodeck::flutter::find_onset;
use aerodeck::flutter::*;
use aerodeck::section::{Dof, SectionModel};
use aerodeck::units::{ReducedFrequency, ReducedFrequencyRange};

fn plate(arms: Arms) -> QuasiSteady {
    let table = embedded::coefficients("flat plate").unwrap();
    QuasiSteady::new(table, arms, &Dof::TWO).unwrap()
}

/// The plate stays at rotation zero, so the linear model is the same at every speed: eigenvalues of one coupled
/// section and the determinant give the same onset.
#[test]
fn three_routes_to_the_onset_of_the_plate() {
    let structure = SectionModel::table_4_1().structure().unwrap();
    let theory = plate(Arms {
        vertical: -0.25,
        torsion: 0.2,
        lateral: 0.0,
    });
    let search = OnsetSearch {
        speed_max_m_s: 80.0,
        speeds: 160,
    };
    let found = quasi_steady_onset("plate", &structure, &theory, &search).unwrap();
    let onset = found.search.onset().unwrap();
    let linear = theory.linearised(0.0).unwrap();
    let section = CoupledSection::with_model(&structure, &linear).unwrap();
    let eigenvalues = find_onset("plate", &section, &search, None).unwrap();
    let eigenvalues = eigenvalues.onset().unwrap();
    assert!((onset.at.speed_m_s / eigenvalues.at.speed_m_s - 1.0).abs() < 1e-9);
    let ratios = [onset, eigenvalues].map(|o| o.mode.unwrap().mode_ratio);
    assert!((ratios[0] / ratios[1] - 1.0).abs() < 1e-6);
    let slopes = (onset.damping_slope_s_m, eigenvalues.damping_slope_s_m);
    assert!((slopes.0.unwrap() / slopes.1.unwrap() - 1.0).abs() < 1e-3);
    let range = ReducedFrequencyRange::between(
        ReducedFrequency::from_full_width(0.02),
        ReducedFrequency::from_full_width(10.0),
    );
    let determinant =
        aerodeck::flutter::determinant_onset("plate", &structure, &linear, range, 80.0).unwrap();
    let determinant = determinant.onset().unwrap();
    assert!((onset.at.speed_m_s / determinant.at.speed_m_s - 1.0).abs() < 1e-8);
    assert!((onset.at.frequency_hz / determinant.at.frequency_hz - 1.0).abs() < 1e-8);
    assert!(
        onset.warnings.iter().any(|w| w.contains("does not hold"))
            == (onset.at.reduced_velocity.v_star() < 10.0)
    );
}

/// Den Hartog: a vertical mode gallops where the aerodynamic damping `½ρVB(C'_L + C_D)` eats up its own, `2mζω`.
#[test]
fn galloping_of_a_bluff_section() {
    use aerodeck::aerodynamics::derivatives::TableHeader;
    use aerodeck::aerodynamics::quasi_steady::{CoefficientRow, StaticCoefficients};
    let rows = [-10.0, -5.0, 0.0, 5.0, 10.0]
        .map(|angle_deg: f64| CoefficientRow {
            angle_deg,
            drag: 1.2,
            lift: -3.2 * angle_deg.to_radians(),
            moment: 0.0,
        })
        .to_vec();
    let table = StaticCoefficients::new("bluff", TableHeader::default(), rows).unwrap();
    let theory = QuasiSteady::new(table, Arms::default(), &Dof::TWO).unwrap();
    let s = SectionModel::table_4_1().structure().unwrap();
    let search = OnsetSearch {
        speed_max_m_s: 20.0,
        speeds: 40,
    };
    let found = quasi_steady_onset("bluff", &s, &theory, &search).unwrap();
    let onset = found.search.onset().unwrap();
    let exact = s.damping[(0, 0)] / (0.5 * s.air_density_kg_m3 * s.width_m * 2.0);
    assert!(
        (onset.at.speed_m_s / exact - 1.0).abs() < 1e-9,
        "{} {exact}",
        onset.at.speed_m_s
    );
    assert_eq!(onset.branch, "vertical");
    assert_eq!(
        found.mode.unwrap().kind,
        aerodeck::flutter::Instability::Galloping
    );
}

/// With a quasi-steady plate without arms the twist diverges before anything flutters, or the other way round: both
/// ends of the search are said.
#[test]
fn the_end_of_the_equilibrium_ends_the_search() {
    let mut section = SectionModel::iabse_1_1a();
    // a heavily damped section does not flutter below its divergence
    section.vertical.damping_ratio = 0.9;
    section.torsion.damping_ratio = 0.9;
    let structure = section.structure().unwrap();
    let search = OnsetSearch {
        speed_max_m_s: 120.0,
        speeds: 60,
    };
    let found = quasi_steady_onset("plate", &structure, &plate(Arms::default()), &search);
    let found = found.unwrap();
    let FlutterSearch::StableUpTo(range) = found.search else {
        panic!("{found:?}")
    };
    let speed = range.to_m_s;
    assert!((speed - 90.466).abs() < 5e-4, "{speed}");
    assert!(
        found
            .equilibrium_end
            .unwrap()
            .explain()
            .contains("divergence")
    );
}

#[test]
fn modes_end_with_the_equilibrium() {
    let structure = SectionModel::iabse_1_1a().structure().unwrap();
    let theory = plate(Arms::default());
    let speeds: Vec<f64> = (1..=12).map(|i| 10.0 * f64::from(i)).collect();
    let path = static_equilibria(&structure, &theory, &speeds).unwrap();
    let curves = quasi_steady_modes("plate", &structure, &theory, &path).unwrap();
    assert_eq!(path.points.len(), 9);
    // the heaving mode is overdamped before that
    assert_eq!(curves.branches[1].points.len(), 9);
    assert!((curves.branches[0].points[0].frequency_hz - 0.1).abs() < 0.002);
}
