//! Derivatives while initialising are what differences of the values say, with gusts among the inputs.

use super::{Exported, driven, start};
use crate::instance::Instance;
use crate::variables::{Causality, Initial, Role, StartValue, Variable};

fn real(v: &Variable) -> bool {
    matches!(v.value, StartValue::Real(_))
}

fn all(unit: &mut Instance, indices: &[u32]) -> Vec<f64> {
    let mut values = vec![f64::NAN; indices.len()];
    unit.reals(indices, &mut values).unwrap();
    values
}

#[test]
fn derivatives_while_initialising_are_differences() {
    for kind in [
        Exported::Section("continuous_laguerre"),
        Exported::Section("rational"),
        Exported::Patched,
        Exported::Bridge,
        Exported::Damped,
    ] {
        let mut unit = driven(kind, true);
        unit.set_up_experiment(0.0, None).unwrap();
        unit.enter_initialization();
        let table = unit.table().variables().to_vec();
        let indices = |wanted: &dyn Fn(&Variable) -> bool| -> Vec<u32> {
            (0..)
                .zip(&table)
                .filter(|(_, v)| real(v) && wanted(v))
                .map(|(i, _)| i)
                .collect()
        };
        let unknowns = indices(&|v| {
            v.initial == Some(Initial::Calculated) && !matches!(v.role, Role::Computed(_))
        });
        let knowns = indices(&|v| {
            v.causality == Causality::Input
                || matches!(
                    v.role,
                    Role::InitialDisplacement(_) | Role::InitialRate(_) | Role::InitialMode(_)
                )
        });
        for (i, known) in knowns.iter().enumerate() {
            unit.set_reals(&[*known], &[0.01 + 0.003 * i as f64])
                .unwrap();
        }
        let wind = unit.table().find_name("wind_speed").unwrap() as u32;
        unit.set_reals(&[wind], &[9.0]).unwrap();
        for known in knowns {
            let value = all(&mut unit, &[known])[0];
            let step = 1e-4 * value.abs().max(1.0);
            let mut at = |value: f64| {
                unit.set_reals(&[known], &[value]).unwrap();
                all(&mut unit, &unknowns)
            };
            let (above, below) = (at(value + step), at(value - step));
            at(value);
            for ((unknown, a), b) in unknowns.iter().zip(&above).zip(&below) {
                let mut slope = [f64::NAN];
                unit.directional_derivative(&[*unknown], &[known], &[1.0], &mut slope)
                    .unwrap();
                let difference = (a - b) / (2.0 * step);
                // what rounding leaves of values, and of the sums behind rates of states that stand still
                let size = a.abs().max(b.abs()) / step;
                let off = (slope[0] - difference).abs();
                assert!(
                    off <= 1e-7 * difference.abs() + 1e-12 * size + 1e-9,
                    "{kind:?}: {} by {}: {}, {difference}",
                    table[*unknown as usize].name,
                    table[known as usize].name,
                    slope[0]
                );
            }
        }
    }
}

/// Motion that has not been set since the last step goes on; what sets it, and by how much, is the derivative.
#[test]
fn derivatives_of_forces_after_a_step_are_differences() {
    for kind in [
        Exported::Forces("rational"),
        Exported::Forces("discrete_laguerre"),
        Exported::Patched,
    ] {
        let mut unit = driven(kind, false);
        start(&mut unit);
        let table = unit.table().variables().to_vec();
        let of = |wanted: fn(&Role) -> bool| -> Vec<u32> {
            let all = (0..).zip(&table);
            all.filter(|(_, v)| wanted(&v.role))
                .map(|(i, _)| i)
                .collect()
        };
        let motions = of(|role| matches!(role, Role::Motion(..)));
        let forces = of(|role| matches!(role, Role::Force(..) | Role::TotalForce(..)));
        for step in 0..4 {
            let motion = |i: &u32| 1e-3 * f64::from(*i + 3 * step).sin();
            let now: Vec<f64> = motions.iter().map(motion).collect();
            unit.set_reals(&motions, &now).unwrap();
            unit.do_step(0.01 * f64::from(step), 0.01).unwrap();
        }
        let stepped = unit.snapshot();
        for known in motions {
            let mut at = |change: f64| {
                unit.restore(&stepped).unwrap();
                let value = all(&mut unit, &[known])[0];
                unit.set_reals(&[known], &[value + change]).unwrap();
                all(&mut unit, &forces)
            };
            let (above, below) = (at(1e-3), at(-1e-3));
            unit.restore(&stepped).unwrap();
            let slope = |force: &u32| {
                let mut slope = [f64::NAN];
                unit.directional_derivative(&[*force], &[known], &[1.0], &mut slope)
                    .unwrap();
                slope[0]
            };
            let slopes: Vec<f64> = forces.iter().map(slope).collect();
            for ((slope, a), b) in slopes.iter().zip(&above).zip(&below) {
                let difference = (a - b) / 2e-3;
                let size = slopes.iter().fold(1.0, |m: f64, s| m.max(s.abs()));
                assert!(
                    (slope - difference).abs() <= 1e-9 * size,
                    "{kind:?}, {}: {slope}, {difference}",
                    table[known as usize].name
                );
            }
        }
    }
}
