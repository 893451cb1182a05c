//! `damping_now` of every kind is the smallest damping of all eigenvalues, whatever wind was before.

use super::{Exported, fixture, index, instance, start};
use crate::aerodynamics::Realizable;
use crate::aeroelastic::CoupledSection;
use crate::flutter::smallest_damping;
use crate::trained_model::TrainedModel;

#[test]
fn the_damping_is_that_of_all_eigenvalues() {
    let kinds = [
        (
            Exported::Section("continuous_laguerre"),
            "continuous_laguerre",
            1e-12,
        ),
        (Exported::Section("rational"), "rational", 1e-12),
        // by steps of a series against a matrix exponential
        (
            Exported::Section("discrete_laguerre"),
            "discrete_laguerre",
            1e-11,
        ),
        // of modes, which are normalised
        (Exported::Bridge, "rational", 1e-11),
    ];
    for (kind, name, tolerance) in kinds {
        let json = String::from_utf8(fixture(name)).unwrap();
        let model = TrainedModel::from_json(&json).unwrap();
        let structure = model.section.structure().unwrap();
        let section = CoupledSection::new(structure, model.model.realize()).unwrap();
        let mut unit = instance(kind, false).unwrap();
        start(&mut unit);
        let [wind, damping] = ["wind_speed", "damping_now"].map(|name| index(&unit, name));
        for speed in [12.0, 12.1, 3.0, 40.0, 0.5, 25.0, 12.0] {
            unit.set_reals(&[wind], &[speed]).unwrap();
            let mut found = [f64::NAN];
            unit.reals(&[damping], &mut found).unwrap();
            let expected = smallest_damping(&section, speed).unwrap();
            assert!(
                (found[0] - expected).abs() < tolerance,
                "{kind:?}, {speed} m/s: {found:?}, {expected}"
            );
        }
    }
}

/// A sample that lasts longer than half a period shows another motion: what cannot be told is zero, with its reason.
#[test]
fn a_sampled_model_tells_no_damping_in_slow_wind() {
    let mut unit = instance(Exported::Section("discrete_laguerre"), false).unwrap();
    start(&mut unit);
    unit.take_notices();
    let [wind, damping] = ["wind_speed", "damping_now"].map(|name| index(&unit, name));
    unit.set_reals(&[wind], &[0.01]).unwrap();
    let mut found = [f64::NAN];
    unit.reals(&[damping], &mut found).unwrap();
    let notices = unit.take_notices().join("\n");
    assert_eq!(found, [0.0]);
    assert!(
        notices.contains("damping_now is not known") && notices.contains("half a period"),
        "{notices}"
    );
    // nor does it change, and the run goes on
    for speed in [0.01, 0.0] {
        unit.set_reals(&[wind], &[speed]).unwrap();
        let mut slope = [f64::NAN];
        unit.directional_derivative(&[damping], &[wind], &[1.0], &mut slope)
            .unwrap();
        assert_eq!(slope, [0.0]);
    }
    let mut fresh = instance(Exported::Section("discrete_laguerre"), false).unwrap();
    fresh.enter_initialization();
    fresh.set_reals(&[wind], &[0.0]).unwrap();
    let (mass, mut slope) = (index(&fresh, "mass"), [f64::NAN]);
    fresh
        .directional_derivative(&[damping], &[mass], &[1.0], &mut slope)
        .unwrap();
    assert_eq!(slope, [0.0]);
}
