use super::*;
use crate::aerodynamics::{RationalModel, Realizable, Transfer};
use crate::units::ReducedFrequency;
use nalgebra::Complex;
use std::f64::consts::TAU;

const DENSITY: f64 = 1.22;
const FLOW: StripFlow = StripFlow {
    width_m: 31.0,
    wind_factor: 1.0,
};

fn jones() -> PrescribedForces {
    PrescribedForces::new(
        RationalModel::jones_flat_plate().realize(),
        Dof::TWO.to_vec(),
    )
}

/// Heave, rotation and their rates and accelerations, of which so many are given.
fn take(
    forces: &mut PrescribedForces,
    state: &mut [f64],
    t: f64,
    wind: f64,
    motion: [[f64; 3]; 2],
    known: usize,
) {
    let motion = motion.map(|values| KnownMotion { values, known });
    forces.take(state, t, wind, &motion, &[FLOW]).unwrap();
}

fn ahead(forces: &mut PrescribedForces, state: &[f64], ahead_s: f64) -> [Dual; 2] {
    let mut found = [Dual::default(); 2];
    forces
        .ahead(state, &[FLOW], ahead_s, DENSITY, &mut found)
        .unwrap();
    found
}

/// A harmonic motion meets the transfer matrix, to the order of the cubic; the second path is `G(K)`.
#[test]
fn harmonic_motion_gives_the_transfer_matrix() {
    let (wind, frequency) = (40.0, 0.2);
    let omega = TAU * frequency;
    let k = ReducedFrequency::from_full_width(omega * FLOW.width_m / wind);
    let g = RationalModel::jones_flat_plate().transfer(k).unwrap();
    let amplitude = [0.4, 0.02];
    let motion = |t: f64| {
        amplitude.map(|a| {
            let (s, c) = (omega * t).sin_cos();
            [a * c, -a * omega * s, -a * omega * omega * c]
        })
    };
    let expected = |i: usize, t: f64| -> f64 {
        let q: Complex<f64> = (0..2)
            .map(|j| g[(i, j)] * (amplitude[j] * Dof::TWO[j].motion_scale(FLOW.width_m)))
            .sum();
        let scale = 0.5 * DENSITY * wind * wind * Dof::TWO[i].force_scale(FLOW.width_m);
        (q * Complex::new(0.0, omega * t).exp()).re * scale
    };
    // lags die out within twenty periods; largest error over one period relative to the largest force
    let error = |steps: usize, known: usize, ahead_steps: f64| -> f64 {
        let mut forces = jones();
        let mut state = forces.rest(1);
        let h = 1.0 / frequency / steps as f64;
        let mut worst: f64 = 0.0;
        for i in 0..21 * steps {
            let t = i as f64 * h;
            take(&mut forces, &mut state, t, wind, motion(t), known);
            if i >= 20 * steps {
                let found = ahead(&mut forces, &state, ahead_steps * h);
                for (row, force) in found.iter().enumerate() {
                    let instant = t + ahead_steps * h;
                    let size = (0..40).map(|m| expected(row, m as f64 / frequency / 40.0).abs());
                    let size = size.fold(0.0, f64::max);
                    worst = worst.max((force.value - expected(row, instant)).abs() / size);
                }
            }
        }
        worst
    };
    for known in 1..=3 {
        for ahead_steps in [0.0, 1.0, 1.5] {
            let (coarse, fine) = (
                error(50, known, ahead_steps),
                error(100, known, ahead_steps),
            );
            println!("known {known}, ahead {ahead_steps}: {coarse:.2e} {fine:.2e}");
            // second order at least: the acceleration of a cubic
            assert!(
                fine < 0.3 * coarse + 1e-5,
                "{known}, {ahead_steps}: {coarse} {fine}"
            );
            assert!(fine < 2e-2, "{fine}");
        }
    }
}

/// A cubic motion is met exactly, however it is cut into steps; a divided difference over steps of 0.01 s costs digits.
#[test]
fn a_cubic_motion_needs_no_small_steps() {
    let motion = |t: f64| {
        [1.0, 0.1].map(|a| {
            [
                a * (0.1 + 0.02 * t - 0.03 * t * t + 0.01 * t * t * t),
                a * (0.02 - 0.06 * t + 0.03 * t * t),
                a * (-0.06 + 0.06 * t),
            ]
        })
    };
    let run = |steps: usize| {
        let mut forces = jones();
        let mut state = forces.rest(1);
        for i in 0..=steps {
            let t = 4.0 * i as f64 / steps as f64;
            take(&mut forces, &mut state, t, 50.0, motion(t), 3);
        }
        ahead(&mut forces, &state, 0.5)
    };
    let (few, many) = (run(2), run(400));
    for (a, b) in few.iter().zip(&many) {
        assert!((a.value / b.value - 1.0).abs() < 1e-9, "{a:?} {b:?}");
        assert!((a.slope / b.slope - 1.0).abs() < 1e-8, "{a:?} {b:?}");
    }
}

/// The rate is that of the force.
#[test]
fn the_rate_is_that_of_the_force() {
    let mut forces = jones();
    let mut state = forces.rest(1);
    for i in 0..30 {
        let t = 0.1 * i as f64;
        let motion = [0.3, 0.05].map(|a| [a * (1.3 * t).sin(), 0.0, 0.0]);
        take(&mut forces, &mut state, t, 35.0, motion, 1);
    }
    let h = 1e-4;
    let [low, middle, high] = [-h, 0.0, h].map(|d| ahead(&mut forces, &state, 0.15 + d));
    for i in 0..2 {
        let difference = (high[i].value - low[i].value) / (2.0 * h);
        assert!((middle[i].slope / difference - 1.0).abs() < 1e-6);
    }
}

#[test]
fn what_cannot_be_computed_leaves_the_state() {
    let mut forces = jones();
    let mut state = forces.rest(1);
    take(&mut forces, &mut state, 0.0, 10.0, [[0.1, 0.0, 0.0]; 2], 1);
    let before = state.clone();
    for (time_s, wind_speed_m_s) in [(0.0, 10.0), (1e9, 10.0), (0.1, 1e12)] {
        let motion = [KnownMotion {
            values: [0.1, 0.0, 0.0],
            known: 1,
        }; 2];
        let taken = forces.take(&mut state, time_s, wind_speed_m_s, &motion, &[FLOW]);
        assert!(taken.is_err());
        assert_eq!(state, before);
    }
}
