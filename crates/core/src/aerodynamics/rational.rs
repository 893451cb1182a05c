//! Rational functions: Roger's form `G = a₁ + a₂ p + a₃ p² + Σ a_{l+3} p/(p + d_l)`, `p = iK` (1.23a), and the
//! minimum-state form.

mod minimum_state;

pub use minimum_state::MinimumStateModel;

use super::{ContinuousRealization, Realizable, Realization, Transfer, TransferMatrix};
use crate::error::{Result, ensure, positive};
use crate::section::Dof;
use crate::state_space::complex;
use crate::units::ReducedFrequency;
use nalgebra::{Complex, DMatrix};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Lags `d_l > 0`, dimensionless. In files a list of numbers, or a list of such lists.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::Lags;
///
/// assert_eq!(Lags::Shared(vec![0.09, 0.6]).count(), 2);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "a list of lags, or one list for each force")]
pub enum Lags {
    /// The same for all forces.
    Shared(Vec<f64>),
    /// Those of each force, one list per row of `G`, all of one length: the `d_l^y` of (1.23a).
    PerForce(Vec<Vec<f64>>),
}

impl Lags {
    /// Number of lags of a force.
    pub fn count(&self) -> usize {
        match self {
            Self::Shared(lags) => lags.len(),
            Self::PerForce(rows) => rows.first().map_or(0, Vec::len),
        }
    }

    /// Lags of the force in row `i`; of the last row for an `i` beyond it.
    pub fn of_force(&self, i: usize) -> &[f64] {
        match self {
            Self::Shared(lags) => lags,
            Self::PerForce(rows) => rows.get(i).or(rows.last()).map_or(&[], Vec::as_slice),
        }
    }

    /// Checks that there is a list for each of `n` forces, and that lags are positive.
    pub fn validate(&self, n: usize) -> Result<()> {
        const PLACE: &str = "rational model: lags";
        let lists = match self {
            Self::Shared(lags) => std::slice::from_ref(lags),
            Self::PerForce(rows) => {
                let (count, expected) = (rows.len(), format_args!("{n} lists, one per force"));
                ensure(count == n, PLACE, expected, count)?;
                let alike = rows.iter().all(|r| r.len() == rows[0].len());
                ensure(alike, PLACE, "lists of one length", "different lengths")?;
                rows
            }
        };
        for d in lists.iter().flatten() {
            positive(PLACE, *d)?;
        }
        Ok(())
    }
}

/// Rational-function model with lags shared by all entries, or lags of each force.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::{FlatPlate, RationalModel, Transfer};
/// use aerodeck::units::ReducedFrequency;
///
/// // Jones's two lags are Theodorsen's plate within two per cent
/// let k = ReducedFrequency::from_full_width(0.4);
/// let (jones, exact) = (RationalModel::jones_flat_plate().transfer(k)?, FlatPlate::default().transfer(k)?);
/// let lift_by_rotation = (jones[(0, 1)], exact[(0, 1)]);
/// assert!((lift_by_rotation.0 / lift_by_rotation.1 - 1.0).norm() < 0.02);
/// # Ok::<(), aerodeck::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RationalModel {
    /// Degrees of freedom of rows and columns.
    pub dofs: Vec<Dof>,
    /// Quasi-static term, n×n.
    #[serde(with = "crate::state_space::rows")]
    pub a1: DMatrix<f64>,
    /// Rate term, n×n.
    #[serde(with = "crate::state_space::rows")]
    pub a2: DMatrix<f64>,
    /// Added mass, n×n; zero when the model has none.
    #[serde(with = "crate::state_space::rows")]
    pub a3: DMatrix<f64>,
    /// Lags `d_l`, dimensionless, positive.
    pub lags: Lags,
    /// Lag terms, one n×n matrix per lag; row `i` belongs to the `l`-th lag of force `i`.
    #[serde(with = "crate::state_space::rows::list")]
    pub lag_terms: Vec<DMatrix<f64>>,
}

/// Checks that matrices are n×n and finite.
fn check_square(place: &str, n: usize, terms: &[&DMatrix<f64>]) -> Result<()> {
    let square = |m: &&DMatrix<f64>| m.shape() == (n, n) && m.iter().all(|x| x.is_finite());
    ensure(
        terms.iter().all(square),
        place,
        format_args!("finite {n}x{n} matrices"),
        "another shape or a number that is not finite",
    )
}

impl RationalModel {
    /// Forces that follow displacements by `a1` and rates by `a2`, at once.
    pub fn without_lags(dofs: &[Dof], a1: DMatrix<f64>, a2: DMatrix<f64>) -> Self {
        Self {
            dofs: dofs.to_vec(),
            a3: DMatrix::zeros(a1.nrows(), a1.ncols()),
            a1,
            a2,
            lags: Lags::Shared(Vec::new()),
            lag_terms: Vec::new(),
        }
    }

    /// Checks that shapes agree and lags are positive.
    pub fn validate(&self) -> Result<()> {
        let n = self.dofs.len();
        let mut terms = vec![&self.a1, &self.a2, &self.a3];
        terms.extend(&self.lag_terms);
        check_square("rational model", n, &terms)?;
        self.lags.validate(n)?;
        let (count, found) = (self.lags.count(), self.lag_terms.len());
        let expected = format_args!("one matrix per lag, {count} in all");
        ensure(found == count, "rational model: lag_terms", expected, found)
    }

    /// The different values of the `l`-th lag, each with the forces (rows) that have it: one for shared lags.
    pub fn lag_groups(&self, l: usize) -> Vec<(f64, Vec<bool>)> {
        let mut groups: Vec<(f64, Vec<bool>)> = Vec::new();
        let lag_of = |i: usize| self.lags.of_force(i)[l];
        for lag in (0..self.dofs.len()).map(lag_of) {
            if groups.iter().all(|(known, _)| *known != lag) {
                let has_it = |i: usize| lag_of(i) == lag;
                groups.push((lag, (0..self.dofs.len()).map(has_it).collect()));
            }
        }
        groups
    }

    /// The flat plate with R. T. Jones's approximation of Theodorsen's function,
    /// `C(k) ≈ 1 − 0.165 p/(p + 0.091) − 0.335 p/(p + 0.6)` (NACA Report 681, 1940): exact as a rational function.
    pub fn jones_flat_plate() -> Self {
        let m = |entries: [f64; 4]| DMatrix::from_row_slice(2, 2, &entries);
        // C multiplies p·[−2π, π/2·…]: the part p·(p/(p+d)) = p − d p/(p+d) feeds a₂ and the lag term
        let lag = |weight: f64, d: f64| {
            m([
                -2.0 * PI * d * weight,
                -2.0 * PI * weight * (1.0 - d / 4.0),
                -PI / 2.0 * d * weight,
                -PI / 2.0 * weight * (1.0 - d / 4.0),
            ])
        };
        Self {
            dofs: Dof::TWO.to_vec(),
            a1: m([0.0, 2.0 * PI, 0.0, PI / 2.0]),
            a2: m([-PI, 3.0 * PI / 4.0, -PI / 4.0, -PI / 16.0]),
            a3: m([-PI / 2.0, 0.0, 0.0, -PI / 64.0]),
            lags: Lags::Shared(vec![0.091, 0.6]),
            lag_terms: vec![lag(0.165, 0.091), lag(0.335, 0.6)],
        }
    }
}

impl Transfer for RationalModel {
    fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        let p = Complex::new(0.0, k.full_width());
        let feed = complex(&self.a1) + complex(&self.a2) * p + complex(&self.a3) * (p * p);
        let mut g = feed;
        for (l, term) in self.lag_terms.iter().enumerate() {
            for i in 0..self.dofs.len() {
                let filter = p / (p + self.lags.of_force(i)[l]);
                for j in 0..self.dofs.len() {
                    g[(i, j)] += filter * term[(i, j)];
                }
            }
        }
        Ok(g)
    }

    fn realizable(&self) -> Option<&dyn Realizable> {
        Some(self)
    }
}

impl Realizable for RationalModel {
    /// n states per lag; `p/(p+d) = 1 − d/(p+d)` puts `a_{l+3}` into `e₀`. Shared lags: one state per lag and motion,
    /// `x' = −d x + d r`. Lags of each force: one per lag and force, `x' = −d x + d Σ_j a_j r_j`.
    fn realize(&self) -> Realization {
        let n = self.dofs.len();
        let states = n * self.lags.count();
        let mut a = DMatrix::zeros(states, states);
        let mut b = DMatrix::zeros(states, n);
        let mut c = DMatrix::zeros(n, states);
        let mut e0 = self.a1.clone();
        for (l, term) in self.lag_terms.iter().enumerate() {
            e0 += term;
            for i in 0..n {
                let state = l * n + i;
                match &self.lags {
                    Lags::Shared(lags) => {
                        a[(state, state)] = -lags[l];
                        b[(state, i)] = lags[l];
                        c.column_mut(state).copy_from(&(-term.column(i)));
                    }
                    Lags::PerForce(rows) => {
                        a[(state, state)] = -rows[i][l];
                        b.row_mut(state).copy_from(&(term.row(i) * rows[i][l]));
                        c[(i, state)] = -1.0;
                    }
                }
            }
        }
        Realization::Continuous(ContinuousRealization {
            a,
            b,
            c,
            e0,
            e1: self.a2.clone(),
            e2: self.a3.clone(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Jones's lag coefficients as printed in the reference table (six decimals).
    #[test]
    fn jones_coefficients() {
        let jones = RationalModel::jones_flat_plate();
        let printed = [
            [-0.094342, -1.013140, -0.023586, -0.253285],
            [-1.262920, -1.789137, -0.315730, -0.447284],
        ];
        for (term, expected) in jones.lag_terms.iter().zip(printed) {
            for (i, value) in expected.iter().enumerate() {
                assert!((term[(i / 2, i % 2)] - value).abs() < 5e-7);
            }
        }
    }

    /// Lags of each force, different ones: the realisation gives the transfer matrix, and equal rows are shared lags.
    #[test]
    fn lags_of_each_force() {
        let jones = RationalModel::jones_flat_plate();
        let rows = |rows: [[f64; 2]; 2]| RationalModel {
            lags: Lags::PerForce(rows.map(|r| r.to_vec()).to_vec()),
            ..jones.clone()
        };
        let own = rows([[0.08, 0.7], [0.2, 0.5]]);
        own.validate().unwrap();
        let realization = own.realize();
        assert_eq!(realization.states(), 4);
        let same = rows([[0.091, 0.6]; 2]);
        for k in [0.0, 0.05, 0.4, 3.0].map(ReducedFrequency::from_full_width) {
            let g = own.transfer(k).unwrap();
            // a few sums of numbers of order one
            assert!((realization.transfer(k).unwrap() - &g).camax() < 1e-14);
            let p = Complex::new(0.0, k.full_width());
            let lift = p * jones.a2[(0, 1)]
                + jones.a1[(0, 1)]
                + p / (p + 0.08) * jones.lag_terms[0][(0, 1)]
                + p / (p + 0.7) * jones.lag_terms[1][(0, 1)];
            assert!((g[(0, 1)] - lift).norm() < 1e-14);
            let shared = jones.transfer(k).unwrap();
            assert!((same.transfer(k).unwrap() - shared).camax() < 1e-14);
        }
    }

    #[test]
    fn lags_that_do_not_fit_are_named() {
        let mut model = RationalModel::jones_flat_plate();
        let message = |m: &RationalModel| m.validate().unwrap_err().to_string();
        model.lags = Lags::PerForce(vec![vec![0.1, 0.5]]);
        assert!(message(&model).starts_with("rational model: lags: expected 2 lists"));
        model.lags = Lags::PerForce(vec![vec![0.1, 0.5], vec![0.1]]);
        assert!(message(&model).contains("lists of one length"));
        model.lags = Lags::Shared(vec![0.1, -0.5]);
        assert!(message(&model).contains("expected a positive number, found -0.5"));
        model.lags = Lags::Shared(vec![0.1]);
        assert!(message(&model).contains("one matrix per lag, 1 in all"));
        let text = serde_json::to_string(&RationalModel::jones_flat_plate()).unwrap();
        assert!(text.contains("\"lags\":[0.091,0.6]"), "{text}");
        let word = text.replace("[0.091,0.6]", "\"two\"");
        let message = serde_json::from_str::<RationalModel>(&word)
            .unwrap_err()
            .to_string();
        assert!(message.contains("a list of lags"), "{message}");
    }
}
