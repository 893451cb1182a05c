//! Models trained on forced-vibration records of the virtual tunnel.

use super::jones::{by_eigenvalues, couple};
use super::{Case, Figure};
use crate::aerodynamics::FlatPlate;
use crate::aerodynamics::derivatives::embedded;
use crate::error::Result;
use crate::flutter::Onset;
use crate::identification::{DiscreteFit, TimeFit, fit_discrete, fit_records};
use crate::section::{Dof, SectionModel};
use crate::trained_model::Model;
use crate::units::ReducedFrequencyRange;
use crate::wind_tunnel::{Record, RecordSource, TunnelPlan};

const THESIS: &str = "thesis, Figure 4.3";
const RECORDS: &str = "records with other ramps and rests";

/// Figures about models trained on records.
pub const CASES: &[Case] = &[
    Case {
        name: "thesis-flat-plate",
        what: "Discrete Laguerre of the thesis (α = 0.6), flat-plate records at 8.17 m/s, section of Table 4.1",
        figures: &[
            Figure::new("L = 3: onset (exact: 39.468)", 37.68, 2, "m/s")
                .within(0.1, RECORDS)
                .headline(),
            Figure::new("L = 3: frequency at onset", 3.64, 2, "Hz").within(0.01, RECORDS),
            Figure::new("L = 5: onset", 38.90, 2, "m/s").within(0.1, RECORDS),
            Figure::new("L = 5: frequency at onset", 3.55, 2, "Hz").within(0.01, RECORDS),
        ],
        compute: thesis_flat_plate,
    },
    Case {
        name: "thesis-headline",
        what: "Discrete Laguerre of the thesis (L = 3, α = 0.6), records of the measured deck LN21-5200, section of Table 4.1",
        figures: &[
            Figure::new("records at 8.18 m/s: onset", 37.6, 1, "m/s")
                .published(THESIS)
                .within(0.4, "the thesis names neither deck nor weights; 1 %")
                .headline(),
            Figure::new("records at 8.18 m/s: onset", 37.87, 2, "m/s")
                .within(0.15, RECORDS)
                .headline(),
            Figure::new("records at 8.18 m/s: frequency at onset", 3.91, 2, "Hz")
                .within(0.01, RECORDS),
            Figure::new("records at 10.94 m/s: onset", 38.78, 2, "m/s").within(0.15, RECORDS),
        ],
        compute: thesis_headline,
    },
    Case {
        name: "laguerre-flat-plate-records",
        what: "Continuous Laguerre (L = 3), flat-plate records at 8.17 and 4.0 m/s with 5 % noise, section of Table 4.1",
        figures: &[Figure::new("onset", 39.468, 3, "m/s")
            .within(0.197, "0.5 % of the exact onset")
            .headline()],
        compute: laguerre_flat_plate,
    },
];

fn sources(records: &[Record]) -> Vec<&dyn RecordSource> {
    records.iter().map(|r| r as &dyn RecordSource).collect()
}

fn onset(model: &Model, tested: ReducedFrequencyRange) -> Result<Onset> {
    let section = couple(&SectionModel::table_4_1(), model)?;
    by_eigenvalues(&section, 50.0, Some(tested))
}

fn discrete_onset(records: &[Record], filters: usize) -> Result<Onset> {
    let fit = DiscreteFit {
        filters,
        ..DiscreteFit::default()
    };
    let (model, report) = fit_discrete(&sources(records), &fit, &|_| {})?;
    onset(&model, report.tested_range)
}

fn thesis_flat_plate() -> Result<Vec<f64>> {
    let plan = TunnelPlan {
        speeds_m_s: vec![8.17],
        ..TunnelPlan::default()
    };
    let records = plan.records_from_model(&FlatPlate::default(), "flat plate", 0.5)?;
    let mut figures = Vec::new();
    for filters in [3, 5] {
        let onset = discrete_onset(&records, filters)?;
        figures.extend([onset.speed_m_s, onset.frequency_hz]);
    }
    Ok(figures)
}

fn thesis_headline() -> Result<Vec<f64>> {
    let table = embedded::deck("LN21-5200")?;
    let at = |group: usize| -> Result<Onset> {
        let table = table.at_speed_group(group)?;
        let records = TunnelPlan::default().records_from_table(&table, &Dof::TWO)?;
        discrete_onset(&records, 3)
    };
    let (first, second) = (at(0)?, at(1)?);
    Ok(vec![
        first.speed_m_s,
        first.speed_m_s,
        first.frequency_hz,
        second.speed_m_s,
    ])
}

fn laguerre_flat_plate() -> Result<Vec<f64>> {
    let plan = TunnelPlan {
        noise_fraction: 0.05,
        ..TunnelPlan::default()
    };
    let records = plan.records_from_model(&FlatPlate::default(), "flat plate", 0.5)?;
    let (model, report) = fit_records(&sources(&records), &TimeFit::default(), &|_| {})?;
    Ok(vec![onset(&model, report.tested_range)?.speed_m_s])
}
