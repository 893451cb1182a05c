use super::*;
use crate::aerodynamics::FlatPlate;
use crate::identification::testing::{onset_m_s, records};

fn sources(records: &[crate::wind_tunnel::Record]) -> Vec<&dyn RecordSource> {
    records.iter().map(|r| r as &dyn RecordSource).collect()
}

/// The thesis's formulation on flat-plate records (8.17 m/s, α = 0.6), computed independently with NumPy.
#[test]
fn thesis_formulation_on_the_flat_plate() {
    let all = records(&FlatPlate::default(), 8.17, 0.0, 1);
    for (filters, expected) in [(3, 37.68), (5, 38.90)] {
        let fit = DiscreteFit {
            filters,
            ..DiscreteFit::default()
        };
        let (model, report) = fit_discrete(&sources(&all), &fit, &|_| ()).unwrap();
        eprintln!("{} {:?}", onset_m_s(&model), report.notes);
        assert!((onset_m_s(&model) - expected).abs() < 0.1);
    }
}
