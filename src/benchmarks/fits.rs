//! Models fitted to the flat plate, and the thesis's own guidelines for its discrete filters.

use super::jones::by_eigenvalues;
use super::{Case, Figure};
use crate::aerodynamics::FlatPlate;
use crate::aerodynamics::laguerre::{alpha_lower_bound, alpha_upper_bound, impulse_response};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result};
use crate::identification::{
    Constraints, FeedThrough, Form, FrequencyFit, PoleSearch, fit_table, sample_model,
};
use crate::section::{Dof, SectionModel};
use crate::trained_model::Model;
use crate::units::ReducedFrequency;

const THESIS_2_26: &str = "thesis, section 2.5, example (2.26) with α = 0.889";

/// Figures about fitted models.
pub const CASES: &[Case] = &[
    Case {
        name: "alpha-guideline",
        what: "Discrete Laguerre filters: bounds of α by (2.36) and (2.37), memory of the filters",
        figures: &[
            Figure::new("bound of α for 3 Hz sampled at 200 Hz", 0.8283, 4, ""),
            Figure::new("bound of α for 2.5 Hz sampled at 200 Hz", 0.8547, 4, ""),
            Figure::new("|g₃| at sample 176, α = 0.889", 0.0096, 4, "").published(THESIS_2_26),
            Figure::new(
                "upper bound of α for a memory of 176 samples, filters up to g₃",
                0.889,
                3,
                "",
            )
            .published(THESIS_2_26)
            .within(0.001, "printed α puts |g₃| at 0.0096, the bound at 0.01"),
        ],
        compute: guideline,
    },
    Case {
        name: "fits-flat-plate-table-4.1",
        what: "Models fitted to the flat plate at the eight K of 8.17 m/s (relative weights), section of Table 4.1",
        figures: &[
            Figure::new("Laguerre, L = 3, pole 0.305: onset", 39.473, 3, "m/s")
                .within(0.001, "the pole is given to three digits"),
            Figure::new("Laguerre, L = 3, pole searched: onset", 39.468, 3, "m/s")
                .within(0.0395, "0.1 % of the exact onset")
                .headline(),
            Figure::new("one lag, no added mass: onset", 39.40, 2, "m/s").headline(),
            Figure::new("one lag, no added mass: lag", 0.289, 3, ""),
            Figure::new("two lags, added mass: onset", 39.456, 3, "m/s").headline(),
            Figure::new("two lags, added mass: first lag", 0.149, 3, ""),
            Figure::new("two lags, added mass: second lag", 0.538, 3, ""),
        ],
        compute: flat_plate_fits,
    },
];

fn guideline() -> Result<Vec<f64>> {
    let g = impulse_response(0.889, 4, 177);
    Ok(vec![
        alpha_lower_bound(3.0, 200.0),
        alpha_lower_bound(2.5, 200.0),
        g[(3, 176)].abs(),
        alpha_upper_bound(4, 176),
    ])
}

/// Reduced frequencies of Table 3.2 on the section of Table 4.1.
fn tested_k(speed_m_s: f64) -> Vec<ReducedFrequency> {
    [0.25, 0.5, 0.8, 1.1, 1.4, 1.7, 2.0, 2.5]
        .iter()
        .map(|f| ReducedFrequency::from_hertz(*f, 0.5, speed_m_s))
        .collect()
}

fn flat_plate_fits() -> Result<Vec<f64>> {
    let samples = sample_model(&FlatPlate::default(), &tested_k(8.17))?;
    let fit = |form: Form, poles: PoleSearch| {
        let options = FrequencyFit {
            form,
            poles,
            // the reference figures are those of least squares alone
            constraints: Constraints::None,
            ..FrequencyFit::default()
        };
        Ok::<_, Error>(fit_table(&samples, &Dof::TWO, &options)?.0)
    };
    let laguerre = || Form::Laguerre {
        filters: 3,
        feed_through: FeedThrough::default(),
        pole_per_transfer_function: false,
    };
    let rational = |lags, added_mass| Form::Rational { lags, added_mass };
    let given = fit(laguerre(), PoleSearch::fixed(&[0.305]))?;
    let searched = fit(laguerre(), PoleSearch::default())?;
    let one = fit(rational(1, false), PoleSearch::default())?;
    let two = fit(rational(2, true), PoleSearch::default())?;
    let mut figures = vec![onset(&given)?, onset(&searched)?, onset(&one)?];
    figures.extend(lags(&one));
    figures.push(onset(&two)?);
    figures.extend(lags(&two));
    Ok(figures)
}

fn onset(model: &Model) -> Result<f64> {
    let section = CoupledSection::with_model(&SectionModel::table_4_1().structure()?, model)?;
    Ok(by_eigenvalues(&section, 80.0, None)?.speed_m_s)
}

fn lags(model: &Model) -> Vec<f64> {
    match model {
        Model::Rational(m) => m.lags.of_force(0).to_vec(),
        _ => Vec::new(),
    }
}
