//! Everything a capability has to work on: all embedded decks and a bluff one, model-scale and full-scale sections, two
//! and three motions, wind from near zero to beyond the onset.

use aerodeck::aerodynamics::RationalModel;
use aerodeck::aerodynamics::derivatives::{Derivative, DerivativePoint, DerivativeTable};
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::files::derivatives::embedded;
use aerodeck::section::{SectionModel, Translation};

/// A section with its name.
pub struct NamedSection {
    pub name: &'static str,
    pub section: SectionModel,
}

/// Names of the embedded decks.
pub fn decks() -> Vec<DerivativeTable> {
    embedded::names()
        .map(|name| embedded::deck(name).unwrap())
        .collect()
}

/// Section of Table 4.1 and IABSE 1.1a with heave and rotation.
pub fn sections_of_two() -> Vec<NamedSection> {
    vec![
        NamedSection {
            name: "Table 4.1",
            section: SectionModel::table_4_1(),
        },
        NamedSection {
            name: "IABSE 1.1a",
            section: SectionModel::iabse_1_1a(),
        },
    ]
}

/// The same with a lateral degree of freedom: 3.9 and 1 Hz at model scale, 0.05 Hz at full scale.
pub fn sections_of_three() -> Vec<NamedSection> {
    let with = |name, mut section: SectionModel, frequency_hz| {
        section.lateral = Some(Translation {
            frequency_hz: Some(frequency_hz),
            ..section.vertical.clone()
        });
        NamedSection { name, section }
    };
    vec![
        with("Table 4.1, sway 3.9 Hz", SectionModel::table_4_1(), 3.9),
        with("Table 4.1, sway 1 Hz", SectionModel::table_4_1(), 1.0),
        with("IABSE 1.1a, sway 0.05 Hz", SectionModel::iabse_1_1a(), 0.05),
    ]
}

/// Every section.
pub fn sections() -> Vec<NamedSection> {
    let mut all = sections_of_two();
    all.extend(sections_of_three());
    all
}

/// A deck that feeds energy into its rotation at every speed: Jones's flat plate with `A2* = +V̂` exactly.
pub fn bluff_model() -> RationalModel {
    let mut model = RationalModel::jones_flat_plate();
    model.a2[(1, 1)] = 1.0;
    for lag in &mut model.lag_terms {
        lag[(1, 1)] = 0.0;
    }
    model
}

/// Its derivatives at V̂ = 1…8 (eight frequencies at 8 m/s): A2* is positive at every test point.
pub fn bluff_table() -> DerivativeTable {
    let width = 0.5;
    let v_hats = [1.0, 1.3, 1.8, 2.4, 3.2, 4.3, 5.8, 8.0];
    let frequencies = v_hats.map(|v_hat| 8.0 / (std::f64::consts::TAU * width * v_hat));
    DerivativeTable::sampled("bluff deck", &bluff_model(), width, &[8.0], &frequencies).unwrap()
}

/// A measured deck whose rotation is fed energy at every test point: its A2* made positive, `|A2*| + 0.1`.
pub fn made_bluff(table: &DerivativeTable) -> DerivativeTable {
    let points = table.derivatives().map(|derivative| {
        let fed = |mut point: DerivativePoint| {
            if derivative == Derivative::A2 {
                point.value = point.value.abs() + 0.1;
            }
            point
        };
        let points = table.points(derivative).iter().cloned().map(fed);
        (derivative, points.collect())
    });
    let name = format!("{} made bluff", table.name);
    DerivativeTable::new(name, table.width_m, table.header.clone(), points.collect()).unwrap()
}

/// Largest growth rate (1/s) of the coupled section at a wind speed, over all eigenvalues.
pub fn fastest_growth(section: &CoupledSection, speed_m_s: f64) -> f64 {
    let eigenvalues = section.at(speed_m_s).unwrap().eigenvalues().unwrap();
    eigenvalues.iter().map(|z| z.re).fold(f64::MIN, f64::max)
}
