//! Linearised quasi-steady forces against finite differences, their quasi-steady limit and their realisation.

use aerodeck::aerodynamics::quasi_steady::{Arms, QuasiSteady};
use aerodeck::aerodynamics::{Realizable, Transfer};
use aerodeck::files::coefficients::embedded;
use aerodeck::section::Dof;
use aerodeck::units::ReducedFrequency;

/// Fourth-order central difference: error `h⁴/30` of the fifth derivative plus rounding over `h`, both near 1e-12.
fn derivative(f: impl Fn(f64) -> [f64; 3]) -> [f64; 3] {
    let h = 1e-3;
    let at = [f(-2.0 * h), f(-h), f(h), f(2.0 * h)];
    std::array::from_fn(|i| (at[0][i] - 8.0 * at[1][i] + 8.0 * at[2][i] - at[3][i]) / (12.0 * h))
}

#[test]
fn agrees_with_finite_differences_of_the_nonlinear_forces() {
    let arms = Arms {
        lateral: 0.17,
        vertical: -0.25,
        torsion: -0.32,
    };
    let table = embedded::coefficients("synthetic box girder").unwrap();
    for dofs in [&Dof::TWO[..], &Dof::THREE[..]] {
        let theory = QuasiSteady::new(table.clone(), arms, dofs).unwrap();
        for degrees in [-6.3_f64, 0.0, 1.7, 5.1] {
            let theta = degrees.to_radians();
            let linear = theory.linearised(theta).unwrap();
            let at = |dx: f64, dy: f64, rate: f64, turn: f64| {
                let forces = theory.specific_forces(theta + turn, [1.0 + dx, dy, rate]);
                forces.unwrap()
            };
            let by_u = derivative(|h| at(h, 0.0, 0.0, 0.0));
            let by_w = derivative(|h| at(0.0, h, 0.0, 0.0));
            let by_rate = derivative(|h| at(0.0, 0.0, h, 0.0));
            let by_turn = derivative(|h| at(0.0, 0.0, 0.0, h));
            for (i, _) in dofs.iter().enumerate() {
                let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-8, "{a} {b}");
                close(linear.buffeting[(i, 0)], by_u[i]);
                close(linear.buffeting[(i, 1)], by_w[i]);
                for (j, dof) in dofs.iter().enumerate() {
                    let (e0, e1) = match dof {
                        Dof::Vertical => (0.0, -by_w[i]),
                        Dof::Lateral => (0.0, -by_u[i]),
                        Dof::Torsion => (by_turn[i], by_rate[i]),
                    };
                    close(linear.e0[(i, j)], e0);
                    close(linear.e1[(i, j)], e1);
                }
            }
        }
    }
}

/// `H1* = −(C'_L + C_D)V̂`, `A3* = C'_M V̂²`: the quasi-steady limit in derivatives.
#[test]
fn derivatives_of_the_quasi_steady_limit() {
    let table = embedded::coefficients("flat plate").unwrap();
    let theory = QuasiSteady::new(table, Arms::default(), &Dof::TWO).unwrap();
    let k = ReducedFrequency::from_v_hat(7.0);
    let g = theory.linearised(0.0).unwrap().transfer(k).unwrap();
    let square = k.full_width().powi(2);
    let h1 = g[(0, 0)].im / square;
    let a3 = g[(1, 1)].re / square;
    let slope = std::f64::consts::TAU;
    assert!((h1 + (slope + 0.01) * 7.0).abs() < 1e-10);
    assert!((a3 - slope / 4.0 * 49.0).abs() < 1e-10);
}

#[test]
fn the_realisation_is_the_transfer() {
    let table = embedded::coefficients("synthetic box girder").unwrap();
    let arms = Arms {
        vertical: -0.25,
        ..Arms::default()
    };
    let linear = QuasiSteady::new(table, arms, &Dof::THREE).unwrap();
    let linear = linear.linearised(0.03).unwrap();
    let k = ReducedFrequency::from_full_width(0.7);
    let again = linear.realize().transfer(k).unwrap();
    assert!((again - linear.transfer(k).unwrap()).camax() < 1e-15);
}
