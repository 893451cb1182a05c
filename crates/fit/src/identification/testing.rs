//! Helpers of the tests of this module: the test points and records of the thesis, and an onset by plain bisection.

use super::{Constraints, FrequencyFit, TimeFit};
use crate::aerodynamics::{Realizable, Transfer};
use crate::aeroelastic::CoupledSection;
use crate::files::derivatives::TABLE_3_2_FREQUENCIES_HZ;
use crate::section::SectionModel;
use crate::units::ReducedFrequency;
use crate::wind_tunnel::{Record, TunnelPlan};

/// A fit to a table by least squares alone, for what is to be recovered exactly or was computed so.
pub(crate) fn table_alone() -> FrequencyFit {
    FrequencyFit {
        constraints: Constraints::None,
        ..FrequencyFit::default()
    }
}

/// The same for records.
pub(crate) fn records_alone() -> TimeFit {
    TimeFit {
        constraints: Constraints::None,
        ..TimeFit::default()
    }
}

/// Reduced frequencies of the eight motions at one speed, B = 0.5 m.
pub(crate) fn eight_k(speed_m_s: f64) -> Vec<ReducedFrequency> {
    TABLE_3_2_FREQUENCIES_HZ
        .iter()
        .map(|&f| ReducedFrequency::from_hertz(f, 0.5, speed_m_s))
        .collect()
}

fn growth(section: &CoupledSection, speed: f64) -> f64 {
    let values = section.at(speed).unwrap().eigenvalues().unwrap();
    // modes only: a filter pole is no flutter
    values
        .iter()
        .filter(|z| z.im > 1.0)
        .map(|z| z.re)
        .fold(f64::NEG_INFINITY, f64::max)
}

/// First wind speed (m/s) above 5 at which a mode of the Table 4.1 section stops being damped.
pub(super) fn onset_m_s(model: &dyn Realizable) -> f64 {
    onset_above(model, 5.0)
}

/// The same above another speed.
pub(crate) fn onset_above(model: &dyn Realizable, speed_m_s: f64) -> f64 {
    let structure = SectionModel::table_4_1().structure().unwrap();
    let section = CoupledSection::with_model(&structure, model).unwrap();
    let mut low = speed_m_s;
    while growth(&section, low + 0.5) < 0.0 {
        low += 0.5;
        assert!(low < 80.0, "stable up to 80 m/s");
    }
    let mut high = low + 0.5;
    while high - low > 1e-9 {
        let middle = 0.5 * (low + high);
        if growth(&section, middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Forced-vibration records of Table 3.2 at the given speeds, one per speed and motion, B = 0.5 m: the exact linear response
/// of `model` with white noise on the forces.
pub(super) fn records(
    model: &dyn Transfer,
    speeds_m_s: &[f64],
    noise_fraction: f64,
    seed: u64,
) -> Vec<Record> {
    let plan = TunnelPlan {
        speeds_m_s: speeds_m_s.to_vec(),
        noise_fraction,
        seed,
        ..TunnelPlan::default()
    };
    plan.records_from_model(model, "test", 0.5).unwrap()
}
