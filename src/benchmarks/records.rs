//! Models trained on forced-vibration records of the virtual tunnel.

use super::flat_plate::{WIDE, WITHOUT_ROTARY, by_determinant};
use super::jones::by_eigenvalues;
use super::{Case, Figure};
use crate::aerodynamics::FlatPlate;
use crate::aerodynamics::derivatives::embedded;
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::flutter::Onset;
use crate::identification::{Constraints, DiscreteFit, TimeFit, fit_discrete, fit_records};
use crate::section::{Dof, SectionModel};
use crate::trained_model::Model;
use crate::units::ReducedFrequencyRange;
use crate::wind_tunnel::{Record, RecordSource, TrainingMotion, TunnelPlan};

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
    Case {
        name: "iabse-1.1a-random-motion",
        what: "Continuous Laguerre (L = 3) trained on random motion of the flat plate, IABSE 1.1a with ρ = 1.2 kg/m³, without the apparent rotary inertia: V/(B(f_y + f_θ)/2) at onset; rivals trained on random motion, printed: Gaussian process 13.40, with aerodynamic prior 13.03",
        figures: &[
            Figure::new("exact plate", 13.33, 2, "").published(RANDOM_MOTION),
            Figure::new("exact plate: onset", 78.104, 3, "m/s"),
            Figure::new("exact plate: frequency at onset", 0.19374, 5, "Hz"),
            Figure::new("model trained on random motion", 13.331, 3, "")
                .within(0.0133, "0.1 % of the exact onset")
                .headline(),
        ],
        compute: random_motion,
    },
];

const RANDOM_MOTION: &str =
    "I. Kavrakov, A. McRobie, G. Morgenthal, J. Wind Eng. Ind. Aerodyn. 222 (2022) 104911";

fn sources(records: &[Record]) -> Vec<&dyn RecordSource> {
    records.iter().map(|r| r as &dyn RecordSource).collect()
}

fn onset(model: &Model, tested: ReducedFrequencyRange) -> Result<Onset> {
    let section = CoupledSection::with_model(&SectionModel::table_4_1().structure()?, model)?;
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

/// A model of the plate moved at random as in Table 3.2, one speed, white from 0.25 to 2.5 Hz; its onset as the full-scale
/// deck's.
fn random_motion() -> Result<Vec<f64>> {
    let mut section = SectionModel::iabse_1_1a();
    section.air_density_kg_m3 = 1.2;
    let structure = section.structure()?;
    let reduced = |speed: f64| {
        let frequencies = [
            section.vertical.frequency_hz.unwrap_or(f64::NAN),
            section.torsion.frequency_hz.unwrap_or(f64::NAN),
        ];
        speed / (section.width_m * 0.5 * (frequencies[0] + frequencies[1]))
    };
    let exact = by_determinant(&section, &WITHOUT_ROTARY, WIDE)?;
    let plan = TunnelPlan {
        speeds_m_s: vec![8.17],
        motion: TrainingMotion::WhiteNoise {
            min_hz: 0.25,
            max_hz: 2.5,
            duration_s: 180.0,
        },
        ..TunnelPlan::default()
    };
    let records = plan.records_from_model(&WITHOUT_ROTARY, "flat plate", 0.5)?;
    let (model, report) = fit_records(&sources(&records), &TimeFit::default(), &|_| {})?;
    let coupled = CoupledSection::with_model(&structure, &model)?;
    let trained = by_eigenvalues(&coupled, 120.0, Some(report.tested_range))?;
    Ok(vec![
        reduced(exact.speed_m_s),
        exact.speed_m_s,
        exact.frequency_hz,
        reduced(trained.speed_m_s),
    ])
}

fn laguerre_flat_plate() -> Result<Vec<f64>> {
    let plan = TunnelPlan {
        noise_fraction: 0.05,
        ..TunnelPlan::default()
    };
    let records = plan.records_from_model(&FlatPlate::default(), "flat plate", 0.5)?;
    // the reference figure is that of least squares alone
    let fit = TimeFit {
        constraints: Constraints::None,
        ..TimeFit::default()
    };
    let (model, report) = fit_records(&sources(&records), &fit, &|_| {})?;
    Ok(vec![onset(&model, report.tested_range)?.speed_m_s])
}
