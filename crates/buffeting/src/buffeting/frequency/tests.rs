//! A section against the bridge that it is.

use super::*;
use crate::aerodynamics::RationalModel;
use crate::bridge::Bridge;
use crate::buffeting::{
    Admittance, Coherence, Gust, GustSpectrum, SpectrumShape, Turbulence, turbulence_field,
};
use crate::section::SectionModel;
use std::f64::consts::PI;
use std::sync::Arc;

/// The same spectra and the same gusts, but for the points by which a line of a record is taken.
#[test]
fn a_section_is_a_bridge_of_one_node() {
    let section = SectionModel::iabse_1_1a();
    let gust = Gust {
        spectrum: GustSpectrum {
            shape: SpectrumShape::Kaimal {},
            length_m: 40.0,
            intensity: 0.06,
        },
        admittance: Admittance::Sears {},
    };
    let turbulence = Turbulence {
        along: None,
        vertical: Some(gust),
    };
    let (structure, jones) = (
        section.structure().unwrap(),
        RationalModel::jones_flat_plate(),
    );
    let own = BuffetingProblem::of_section(&structure, &jones, None, &turbulence).unwrap();
    let bridge = Bridge::of_section(&section, Arc::new(jones.clone())).unwrap();
    let plate = [[[0.0, 2.0 * PI], [0.0, 0.0], [0.0, PI / 2.0]]];
    let coherence = Coherence::default();
    let bridge = BuffetingProblem::of_bridge(&bridge, &plate, turbulence, coherence).unwrap();
    let over = vec![1e-3, 0.05, 0.1, 0.2, 0.278, 2.0];
    let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    let found = own.spectra_over(over.clone(), 45.0, &[0]).unwrap().motion;
    let expected = bridge.spectra_over(over, 45.0, &[0]).unwrap().motion;
    for (i, row) in [(0, 0), (1, 2)] {
        for (a, b) in found[i].iter().zip(&expected[row]) {
            near(*a, *b);
        }
    }
    let of = |problem| FrequencyDomain::new(problem, 45.0).unwrap();
    let (own_hz, bridge_hz) = (of(&own).resolved_hz(), of(&bridge).resolved_hz());
    assert_eq!(own_hz.len(), bridge_hz.len());
    own_hz[1..]
        .iter()
        .zip(&bridge_hz[1..])
        .for_each(|(a, b)| near(*a, *b));
    let field = |problem| turbulence_field(problem, 45.0, 0.1, 256, 3).unwrap();
    let ([_, a], [_, b]) = (field(&own), field(&bridge));
    for (a, b) in a[0].iter().zip(&b[0]) {
        assert!((a - b).abs() < 0.05, "{a} {b}");
    }
}
