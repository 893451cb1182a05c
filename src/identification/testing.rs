//! Helpers of the tests of this module: the test points of the thesis, and an onset by plain bisection.

use crate::aerodynamics::AerodynamicModel;
use crate::aeroelastic::CoupledSection;
use crate::section::SectionModel;
use crate::units::ReducedFrequency;

/// Motion frequencies of Table 3.2, Hz.
pub const FREQUENCIES_HZ: [f64; 8] = [0.25, 0.5, 0.8, 1.1, 1.4, 1.7, 2.0, 2.5];

/// Reduced frequencies of the eight motions at one speed, B = 0.5 m.
pub fn eight_k(speed_m_s: f64) -> Vec<ReducedFrequency> {
    FREQUENCIES_HZ
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
pub fn onset_m_s(model: &dyn AerodynamicModel) -> f64 {
    let structure = SectionModel::table_4_1().structure().unwrap();
    let section = CoupledSection::new(structure, model.realize().unwrap()).unwrap();
    let mut low = 5.0;
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
