//! Measured decks on the section of Table 4.1.

use super::flat_plate::by_determinant;
use super::jones::{by_eigenvalues, couple};
use super::{Case, Figure};
use crate::aerodynamics::derivatives::{
    DerivativeTable, Extrapolation, InterpolatedTable, embedded,
};
use crate::error::Result;
use crate::identification::{Form, FrequencyFit, FrequencyWeights, fit_table};
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
        compute: || over_decks(interpolated),
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
];

fn over_decks(onset: fn(&DerivativeTable) -> Result<f64>) -> Result<Vec<f64>> {
    embedded::names()
        .map(|name| onset(&embedded::deck(name)?))
        .collect()
}

fn interpolated(table: &DerivativeTable) -> Result<f64> {
    let model = InterpolatedTable::new(table, &Dof::TWO, Extrapolation::Refuse)?;
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
    let (model, _) = fit_table(&table.samples(&Dof::TWO), &Dof::TWO, &fit)?;
    let section = couple(&SectionModel::table_4_1(), &model)?;
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
