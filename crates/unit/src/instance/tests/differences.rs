//! Derivatives while initialising are what differences of the values say, with gusts among the inputs.

use super::{Kind, driven};
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
        Kind::Section("continuous_laguerre"),
        Kind::Section("rational"),
        Kind::Patched,
        Kind::Bridge,
        Kind::Damped,
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
