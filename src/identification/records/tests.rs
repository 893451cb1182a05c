use super::*;
use crate::aerodynamics::{FlatPlate, RationalModel};
use crate::identification::options::PoleSearch;
use crate::identification::testing::{onset_m_s, records};
use crate::wind_tunnel::Record;

fn sources(records: &[Record]) -> Vec<&dyn RecordSource> {
    records.iter().map(|r| r as &dyn RecordSource).collect()
}

fn quiet(_: Progress) {}

/// Records of a rational function give back its coefficients: two speeds, given lags.
#[test]
fn rational_function_is_recovered_from_its_records() {
    let jones = RationalModel::jones_flat_plate();
    let mut all = records(&jones, 8.17, 0.0, 1);
    all.extend(records(&jones, 4.0, 0.0, 1));
    for weights in [
        TimeWeights::None,
        TimeWeights::PerRecord,
        TimeWeights::PerSegment,
    ] {
        let fit = TimeFit {
            form: Form::Rational {
                lags: 2,
                added_mass: true,
            },
            poles: PoleSearch::fixed(&jones.lags),
            weights,
            ..TimeFit::default()
        };
        let (model, report) = fit_records(&sources(&all), &fit, &quiet).unwrap();
        let Model::Rational(found) = &model else {
            panic!("not rational");
        };
        eprintln!("{found:?}");
        for e in &report.entries {
            eprintln!("{:?} {} {}", e.relative_rms, e.condition, e.cancellation);
        }
        // what remains is the force of the ramps beyond second order
        assert!((&found.a1 - &jones.a1).amax() < 1e-3);
        assert!((&found.a2 - &jones.a2).amax() < 1e-3);
        assert!((&found.a3 - &jones.a3).amax() < 1e-3);
    }
}

#[test]
fn flat_plate_onset() {
    let all = records(&FlatPlate::default(), 8.17, 0.0, 1);
    let start = std::time::Instant::now();
    let (model, report) = fit_records(&sources(&all), &TimeFit::default(), &quiet).unwrap();
    eprintln!(
        "{:?} {} {:?}",
        start.elapsed(),
        onset_m_s(&model),
        report.search[0].chosen
    );
    eprintln!("{:?}", report.search[0].points);
    eprintln!("{:?} {:?}", report.orders, report.notes);
    assert!((onset_m_s(&model) / 39.468 - 1.0).abs() < 1e-3);
}
