//! Measured decks on the section of Table 4.1.

use super::flat_plate::by_determinant;
use super::jones::by_eigenvalues;
use super::{Case, Figure};
use crate::aerodynamics::derivatives::{
    DerivativeTable, Extrapolation, InterpolatedTable, Interpolation, embedded,
};
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::identification::{Constraints, Form, FrequencyFit, FrequencyWeights, fit_table};
use crate::section::{Dof, SectionModel};

const CHOICES: &str = "spread between weights and ways of interpolation";

/// Onset of a deck in m/s, between two figures computed with different weights or ways of interpolation.
const fn between(quantity: &'static str, low: f64, high: f64) -> Figure {
    // the ends are rounded to a tenth; as much again for the points that both test speeds share
    Figure::new(quantity, 0.5 * (low + high), 2, "m/s").within(0.5 * (high - low) + 0.1, CHOICES)
}

/// Onset of a one-lag fit in m/s.
const fn rational_onset(quantity: &'static str, expected: f64) -> Figure {
    Figure::new(quantity, expected, 2, "m/s").within(
        0.05,
        "the shared lag depends on how the sizes of the entries are measured",
    )
}

/// Figures about measured decks.
pub const CASES: &[Case] = &[
    Case {
        name: "rational-ln21-5200",
        what: "Measured deck LN21-5200, one-lag rational functions fitted to the derivatives, section of Table 4.1",
        figures: &[
            rational_onset("no added mass, weights 1/K², both speeds", 38.03),
            rational_onset("no added mass, weights 1/K², first speed", 37.94).headline(),
            rational_onset("no added mass, no weights", 36.46),
            rational_onset("no added mass, relative weights", 35.96),
            rational_onset("added mass, weights 1/K²", 37.67),
            rational_onset("added mass, no weights", 36.68),
            rational_onset("added mass, relative weights", 36.60),
        ],
        compute: rational_ln21_5200,
    },
    Case {
        name: "measured-decks-interpolated",
        what: "Measured decks, derivatives interpolated linearly in V/(ωB), section of Table 4.1",
        figures: &[
            between("LN20-5500", 36.3, 36.5),
            between("LN21-5200", 36.7, 36.9),
            between("LN21-5500", 37.2, 37.5),
            between("LN21-5800", 32.9, 32.9),
            between("LN21-6100", 24.7, 24.7),
        ],
        compute: || over_decks(|table| interpolated(table, Interpolation::LinearVHat)),
    },
    Case {
        name: "measured-decks-modified-akima",
        what: "Measured decks, Re G and Im G/K by modified Akima over ln K, points of the two speeds within 10 % in K as one, section of Table 4.1",
        figures: &[
            Figure::new("LN20-5500", 36.472, 3, "m/s"),
            Figure::new("LN21-5200", 36.789, 3, "m/s").headline(),
            Figure::new("LN21-5500", 37.411, 3, "m/s"),
            Figure::new("LN21-5800", 32.992, 3, "m/s"),
            Figure::new("LN21-6100", 25.894, 3, "m/s"),
        ],
        compute: || over_decks(|table| interpolated(table, Interpolation::ModifiedAkima)),
    },
    Case {
        name: "measured-decks-rational",
        what: "Measured decks, one-lag rational functions with added mass, relative weights, section of Table 4.1",
        figures: &[
            between("LN20-5500", 36.5, 36.5),
            between("LN21-5200", 36.6, 36.6),
            between("LN21-5500", 36.7, 38.3),
            between("LN21-5800", 34.0, 35.9),
            between("LN21-6100", 24.7, 27.1),
        ],
        compute: || over_decks(|table| rational(table, true, FrequencyWeights::Relative)),
    },
    Case {
        name: "measured-decks-laguerre",
        what: "Measured decks, continuous Laguerre, L = 3, pole searched, section of Table 4.1",
        figures: &[
            between("LN20-5500", 36.4, 36.4),
            between("LN21-5200", 37.0, 37.0),
            between("LN21-5500", 37.8, 37.8),
            between("LN21-5800", 33.5, 33.5),
            between("LN21-6100", 26.6, 26.6),
        ],
        compute: || over_decks(|table| fitted(table, FrequencyFit::default())),
    },
    Case {
        name: "measured-decks-dissipative",
        what: "Measured decks, continuous Laguerre, L = 3, that takes energy out of fast motion (the default), sections of Table 4.1 and IABSE 1.1a, ρ 1.19 kg/m³ for both",
        figures: &[
            dissipative_onset("LN20-5500, Table 4.1", 36.2),
            dissipative_onset("LN21-5200, Table 4.1", 37.0).headline(),
            dissipative_onset("LN21-5500, Table 4.1", 37.6),
            dissipative_onset("LN21-5800, Table 4.1", 33.8),
            dissipative_onset("LN21-6100, Table 4.1", 26.2),
            dissipative_onset("LN20-5500, IABSE 1.1a", 71.3),
            dissipative_onset("LN21-5200, IABSE 1.1a", 71.3),
            dissipative_onset("LN21-5500, IABSE 1.1a", 74.1),
            dissipative_onset("LN21-5800, IABSE 1.1a", 69.9),
            dissipative_onset("LN21-6100, IABSE 1.1a", 60.0),
            Figure::new(
                "wind speeds below the onset at which anything grows, of 2000",
                0.0,
                0,
                "",
            )
            .headline(),
        ],
        compute: dissipative,
    },
];

/// Wind speeds of each deck and section, from near still air to the onset.
const SPEEDS_BELOW: u8 = 200;

/// Onset of a model fitted under constraints in m/s.
const fn dissipative_onset(quantity: &'static str, expected: f64) -> Figure {
    Figure::new(quantity, expected, 1, "m/s")
        .computed("NumPy/CVXPY, cones")
        .within(
            0.01 * expected,
            "1 %: weights and searches of the pole differ by as much without constraints",
        )
}

/// Onset of each deck on the section of Table 4.1, on the full-scale one, and the speeds at which either grows below.
fn dissipative() -> Result<Vec<f64>> {
    let small = SectionModel::table_4_1();
    let full_scale = SectionModel {
        air_density_kg_m3: small.air_density_kg_m3,
        ..SectionModel::iabse_1_1a()
    };
    let sections = [(small, 50.0), (full_scale, 120.0)];
    let mut figures = Vec::new();
    let mut growing = 0.0;
    for (section, speed_max_m_s) in &sections {
        for name in embedded::names() {
            let table = embedded::deck(name)?;
            let samples = table.samples(&Dof::TWO);
            let (model, _) = fit_table(&samples, &Dof::TWO, &FrequencyFit::default())?;
            let coupled = CoupledSection::with_model(&section.structure()?, &model)?;
            let tested = Some(table.tested_range(&Dof::TWO));
            let onset = by_eigenvalues(&coupled, *speed_max_m_s, tested)?.speed_m_s;
            figures.push(onset);
            for i in 1..=SPEEDS_BELOW {
                // up to just below the onset, from near still air
                let speed = 0.999 * onset * f64::from(i) / f64::from(SPEEDS_BELOW);
                let roots = coupled.at(speed)?.eigenvalues()?;
                growing += f64::from(u8::from(roots.iter().any(|z| z.re > 0.0)));
            }
        }
    }
    figures.push(growing);
    Ok(figures)
}

fn over_decks(onset: fn(&DerivativeTable) -> Result<f64>) -> Result<Vec<f64>> {
    embedded::names()
        .map(|name| onset(&embedded::deck(name)?))
        .collect()
}

fn interpolated(table: &DerivativeTable, by: Interpolation) -> Result<f64> {
    let model = InterpolatedTable::by(by, table, &Dof::TWO, Extrapolation::Refuse)?;
    let range = model.tested_range();
    Ok(by_determinant(&SectionModel::table_4_1(), &model, range)?.speed_m_s)
}

fn rational(table: &DerivativeTable, added_mass: bool, weights: FrequencyWeights) -> Result<f64> {
    let form = Form::Rational {
        lags: 1,
        added_mass,
    };
    let fit = FrequencyFit {
        form,
        weights,
        ..FrequencyFit::default()
    };
    fitted(table, fit)
}

fn fitted(table: &DerivativeTable, fit: FrequencyFit) -> Result<f64> {
    // the reference figures are those of least squares alone
    let fit = FrequencyFit {
        constraints: Constraints::None,
        ..fit
    };
    let (model, _) = fit_table(&table.samples(&Dof::TWO), &Dof::TWO, &fit)?;
    let section = CoupledSection::with_model(&SectionModel::table_4_1().structure()?, &model)?;
    let tested = Some(table.tested_range(&Dof::TWO));
    Ok(by_eigenvalues(&section, 50.0, tested)?.speed_m_s)
}

fn rational_ln21_5200() -> Result<Vec<f64>> {
    use FrequencyWeights::{Derivatives, None as Unweighted, Relative};
    let table = embedded::deck("LN21-5200")?;
    let first = table.at_speed_group(0)?;
    Ok(vec![
        rational(&table, false, Derivatives)?,
        rational(&first, false, Derivatives)?,
        rational(&table, false, Unweighted)?,
        rational(&table, false, Relative)?,
        rational(&table, true, Derivatives)?,
        rational(&table, true, Unweighted)?,
        rational(&table, true, Relative)?,
    ])
}
