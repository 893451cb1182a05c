//! Continuous Laguerre (or Takenaka–Malmquist) model with feed-through, the default of this crate:
//! `G = e₀ + e₁ iK + e₂ (iK)² + Σ c_l Λ_l(iK)`.

use super::bank::{FilterBank, side_by_side};
use crate::aerodynamics::{
    ContinuousRealization, Realizable, Realization, Transfer, TransferMatrix, check_matrix,
};
use crate::error::{Result, ensure};
use crate::section::Dof;
use crate::state_space::complex;
use crate::units::ReducedFrequency;
use nalgebra::{Complex, DMatrix};
use serde::{Deserialize, Serialize};

/// One filter chain driven by one motion, with its coefficients for every force.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FilterTerm {
    /// Index into the model's degrees of freedom of the motion that drives the chain.
    pub input: usize,
    /// The chain.
    pub poles: FilterBank,
    /// `c`, one row per force, one column per filter (n×L); rows of zeros where another chain serves the force.
    #[serde(with = "crate::state_space::rows")]
    pub coefficients: DMatrix<f64>,
}

/// Orthonormal filters with feed-through.
///
/// One [`FilterTerm`] per motion when the poles are shared; one per motion and force when every transfer function has
/// its own pole.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::{FilterBank, FilterTerm, LaguerreModel, Realizable, Realization};
/// use aerodeck::section::Dof;
/// use nalgebra::DMatrix;
///
/// let one = |x| DMatrix::from_element(1, 1, x);
/// let model = LaguerreModel {
///     dofs: vec![Dof::Torsion],
///     e0: one(1.2),
///     e1: one(-0.4),
///     e2: one(0.0),
///     terms: vec![FilterTerm {
///         input: 0,
///         poles: FilterBank::new(vec![0.5; 3])?,
///         coefficients: DMatrix::from_row_slice(1, 3, &[0.1, -0.05, 0.02]),
///     }],
/// };
/// model.validate()?;
/// let Realization::Continuous(filters) = model.realize() else { panic!() };
/// assert_eq!(filters.a.nrows(), 3);
/// # Ok::<(), aerodeck::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LaguerreModel {
    /// Degrees of freedom of rows and columns.
    pub dofs: Vec<Dof>,
    /// Feed-through of the motion, n×n; zero when switched off.
    #[serde(with = "crate::state_space::rows")]
    pub e0: DMatrix<f64>,
    /// Feed-through of its rate, n×n.
    #[serde(with = "crate::state_space::rows")]
    pub e1: DMatrix<f64>,
    /// Feed-through of its acceleration, n×n.
    #[serde(with = "crate::state_space::rows")]
    pub e2: DMatrix<f64>,
    /// Filter chains.
    pub terms: Vec<FilterTerm>,
}

impl LaguerreModel {
    /// Checks that shapes agree.
    pub fn validate(&self) -> Result<()> {
        let n = self.dofs.len();
        for (name, m) in [("e0", &self.e0), ("e1", &self.e1), ("e2", &self.e2)] {
            check_matrix(format_args!("Laguerre model: {name}"), m, n, n)?;
        }
        for (i, term) in self.terms.iter().enumerate() {
            // the poles of a file have not passed through the constructor yet
            FilterBank::new(term.poles.poles().to_vec())?;
            let (filters, c) = (term.poles.count(), &term.coefficients);
            let fits = c.shape() == (n, filters) && c.iter().all(|x| x.is_finite());
            ensure(
                term.input < n && fits,
                format_args!("Laguerre model: terms[{i}]"),
                format_args!("an input below {n} and finite {n}x{filters} coefficients"),
                not_fitting(term.input, c),
            )?;
        }
        Ok(())
    }
}

/// What is said of a term whose input or coefficients are none.
pub(super) fn not_fitting(input: usize, c: &DMatrix<f64>) -> String {
    let (rows, columns) = c.shape();
    format!("input {input}, {rows}x{columns} coefficients, or one that is not finite")
}

impl Transfer for LaguerreModel {
    fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        let p = Complex::new(0.0, k.full_width());
        let mut g = complex(&self.e0) + complex(&self.e1) * p + complex(&self.e2) * (p * p);
        for term in &self.terms {
            for (l, filter) in term.poles.response(p).into_iter().enumerate() {
                for i in 0..g.nrows() {
                    g[(i, term.input)] += filter * term.coefficients[(i, l)];
                }
            }
        }
        Ok(g)
    }

    fn realizable(&self) -> Option<&dyn Realizable> {
        Some(self)
    }
}

impl Realizable for LaguerreModel {
    fn realize(&self) -> Realization {
        let terms = self.terms.iter();
        let chains = terms.map(|t| (t.input, t.poles.matrices(), &t.coefficients));
        let [a, b, c] = side_by_side(self.dofs.len(), chains);
        Realization::Continuous(ContinuousRealization {
            a,
            b,
            c,
            e0: self.e0.clone(),
            e1: self.e1.clone(),
            e2: self.e2.clone(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn realisation_and_closed_form_agree() {
        let model = LaguerreModel {
            dofs: Dof::TWO.to_vec(),
            e0: DMatrix::from_row_slice(2, 2, &[0.1, 6.0, 0.0, 1.5]),
            e1: DMatrix::from_row_slice(2, 2, &[-3.0, 2.0, -0.8, -0.2]),
            e2: DMatrix::from_row_slice(2, 2, &[-1.5, 0.0, 0.0, -0.05]),
            terms: (0..2)
                .map(|input| FilterTerm {
                    input,
                    poles: FilterBank::laguerre(0.3 + 0.1 * input as f64, 3).unwrap(),
                    coefficients: DMatrix::from_fn(2, 3, |i, l| {
                        0.3 * i as f64 - 0.2 * l as f64 + 0.1
                    }),
                })
                .collect(),
        };
        model.validate().unwrap();
        let realization = model.realize();
        for k in [0.05, 0.3, 1.4] {
            let k = ReducedFrequency::from_full_width(k);
            let difference = model.transfer(k).unwrap() - realization.transfer(k).unwrap();
            assert!(difference.iter().all(|z| z.norm() < 1e-12));
        }
    }
}
