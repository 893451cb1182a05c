//! Degenerate lags: several that do the work of one.
//!
//! Unbounded least squares drives lags together, with large coefficients that cancel. The search says when a lag stops
//! at a bound or at the least ratio, the entries say when their terms cancel; here the finished model is looked at, so
//! that lags which were given are judged as well.

use crate::aerodynamics::{Lags, MinimumStateModel};
use crate::trained_model::Model;

/// Lags closer than this ratio have columns that differ by less than 2 % of their size at any K.
pub(crate) const NEAR_EQUAL_RATIO: f64 = 1.05;
/// Cosine above which two rows of `E` count as parallel.
const PARALLEL: f64 = 0.99;
/// A state whose force is smaller than this part of the largest does nothing.
const IDLE: f64 = 1e-6;

/// Adds a note for every pair of lags that are nearly equal, and for states of the minimum-state form that do nothing.
pub(crate) fn note_lags(model: &Model, notes: &mut Vec<String>) {
    match model {
        Model::Rational(m) => match &m.lags {
            Lags::Shared(lags) => note_pairs(lags, "", &|_, _| true, notes),
            Lags::PerForce(rows) => {
                for (force, lags) in m.dofs.iter().zip(rows) {
                    let whose = format!("{} force: ", force.name());
                    note_pairs(lags, &whose, &|_, _| true, notes);
                }
            }
        },
        Model::MinimumState(m) => note_states(m, notes),
        _ => {}
    }
}

fn note_pairs(
    lags: &[f64],
    whose: &str,
    alike: &dyn Fn(usize, usize) -> bool,
    notes: &mut Vec<String>,
) {
    for i in 0..lags.len() {
        for j in i + 1..lags.len() {
            let ratio = (lags[i] / lags[j]).ln().abs().exp();
            if ratio < NEAR_EQUAL_RATIO && alike(i, j) {
                notes.push(format!(
                    "{whose}degenerate lags: {:.4} and {:.4} are nearly equal, so that their terms only differ by \
                     cancelling; fewer lags would fit as well",
                    lags[i], lags[j]
                ));
            }
        }
    }
}

/// Equal lags are no fault of the minimum-state form as long as their states are driven by different motions.
fn note_states(model: &MinimumStateModel, notes: &mut Vec<String>) {
    let parallel = |i: usize, j: usize| {
        let (a, b) = (model.e.row(i), model.e.row(j));
        a.dot(&b).abs() > PARALLEL * a.norm() * b.norm()
    };
    note_pairs(&model.lags, "", &parallel, notes);
    let strength = |l: usize| model.d.column(l).norm() * model.e.row(l).norm();
    let strengths: Vec<f64> = (0..model.lags.len()).map(strength).collect();
    let largest = strengths.iter().copied().fold(0.0, f64::max);
    for (lag, strength) in model.lags.iter().zip(&strengths) {
        if *strength <= IDLE * largest {
            notes.push(format!(
                "degenerate lags: the state of the lag {lag:.4} does nothing; fewer states would fit as well"
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::RationalModel;
    use nalgebra::DMatrix;

    fn notes(model: Model) -> Vec<String> {
        let mut notes = Vec::new();
        note_lags(&model, &mut notes);
        notes
    }

    #[test]
    fn nearly_equal_lags_are_named() {
        let mut model = RationalModel::jones_flat_plate();
        assert!(notes(Model::Rational(model.clone())).is_empty());
        model.lags = Lags::PerForce(vec![vec![0.1, 0.6], vec![0.3, 0.3003]]);
        let said = notes(Model::Rational(model.clone()));
        assert_eq!(said.len(), 1);
        assert!(
            said[0]
                .starts_with("torsion force: degenerate lags: 0.3000 and 0.3003 are nearly equal")
        );
        let mut small = MinimumStateModel {
            dofs: model.dofs.clone(),
            a1: model.a1.clone(),
            a2: model.a2.clone(),
            a3: model.a3.clone(),
            lags: vec![0.3, 0.3],
            d: DMatrix::from_element(2, 2, 1.0),
            e: DMatrix::identity(2, 2),
        };
        assert!(notes(Model::MinimumState(small.clone())).is_empty());
        small.e.fill(1.0);
        small.d.column_mut(1).fill(0.0);
        let said = notes(Model::MinimumState(small));
        assert!(said[0].contains("nearly equal") && said[1].contains("does nothing"));
    }
}
