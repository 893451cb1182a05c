//! Columns of a model and their derivatives with respect to searched poles, in one chain of filters that spans both.
//!
//! The derivative of a filter with the pole `p` has that pole twice; a Takenaka–Malmquist chain that passes through
//! all poles a second time spans it exactly (for Laguerre filters one more of the same pole is enough). One pass over
//! the records with that chain serves coefficients and poles, and its leading columns are those of the fit.

use super::parameters::{STEP, SearchedPole, moved_pole};
use crate::error::{Error, Result};
use crate::identification::basis::Basis;
use crate::identification::form::Form;
use nalgebra::{Complex, DMatrix};

/// Frequencies at which columns are compared, for each column.
const POINTS_PER_COLUMN: usize = 4;

/// One transfer function in the columns of a longer chain.
#[derive(Debug, Clone)]
pub(super) struct Expansion {
    /// Poles of the longer chain.
    pub extended: Vec<f64>,
    /// Columns of the model in those of the longer chain, E×N.
    pub native: DMatrix<f64>,
    /// Derivatives with respect to the searched poles, E×(number of these); zero for poles of other transfer functions.
    pub slopes: DMatrix<f64>,
}

impl Expansion {
    /// For the chains of every transfer function, row by row, their coefficients one after the other, and the searched poles.
    ///
    /// # Errors
    /// Chains whose columns cannot be told apart.
    pub(super) fn each(
        form: &Form,
        chains: &[Vec<f64>],
        values: &[f64],
        searched: &[SearchedPole],
    ) -> Result<Vec<Self>> {
        let (mut first, n) = (0, chains.len().isqrt());
        let expanded = |(e, chain): (usize, &Vec<f64>)| {
            let own = Self::new(form, chain, &values[first..], [e / n, e % n], searched)?;
            first += own.native.ncols();
            Ok(own)
        };
        chains.iter().enumerate().map(expanded).collect()
    }

    /// For the chain of the transfer function `(i, j)`, whose coefficients come first in `values`, with room for derivatives where
    /// poles were searched.
    fn new(
        form: &Form,
        chain: &[f64],
        values: &[f64],
        [i, j]: [usize; 2],
        searched: &[SearchedPole],
    ) -> Result<Self> {
        let count = form.collapse(chain).len();
        let mut extended = chain.to_vec();
        if !searched.is_empty() {
            extended.extend(form.collapse(chain));
        }
        let own = Basis::new(form, chain)?;
        let longer = Basis::orthonormal(form, &extended)?;
        let native = express(&longer, chain, own.len(), &|p| own.columns(p))?;
        let mut slopes = DMatrix::zeros(longer.len(), searched.len());
        if !searched.is_empty() {
            let pairs = (0..count).map(|m| moved_pole(form, chain, m));
            let pairs = pairs.collect::<Result<Vec<_>>>()?;
            let sum = |basis: &Basis, p: Complex<f64>| -> Complex<f64> {
                let columns = basis.columns(p);
                columns.iter().zip(values).map(|(z, c)| z * *c).sum()
            };
            let all = express(&longer, chain, count, &|p| {
                let slope = |((up, down), pole): (&(Basis, Basis), &f64)| {
                    (sum(up, p) - sum(down, p)) / (2.0 * STEP * pole)
                };
                pairs.iter().zip(chain).map(slope).collect()
            })?;
            let searched = searched.iter().enumerate();
            let own = searched.filter(|(_, pole)| pole.is_of(i, j));
            for (m, pole) in own {
                slopes.column_mut(m).copy_from(&all.column(pole.index));
            }
        }
        Ok(Self {
            extended,
            native,
            slopes,
        })
    }
}

/// `count` functions of the complex frequency in the columns of a basis, by least squares on a grid about the poles of a chain.
fn express(
    basis: &Basis,
    chain: &[f64],
    count: usize,
    functions: &dyn Fn(Complex<f64>) -> Vec<Complex<f64>>,
) -> Result<DMatrix<f64>> {
    let low = chain.iter().copied().fold(f64::INFINITY, f64::min) / 20.0;
    let high = chain.iter().copied().fold(0.0, f64::max) * 20.0;
    let points = POINTS_PER_COLUMN * basis.len();
    let step = (high / low).ln() / (points as f64 - 1.0);
    let table = |f: &dyn Fn(Complex<f64>) -> Vec<Complex<f64>>, width: usize| {
        let mut m = DMatrix::zeros(2 * points, width);
        for i in 0..points {
            let p = Complex::new(0.0, low * (step * i as f64).exp());
            for (c, z) in f(p).into_iter().enumerate() {
                m[(2 * i, c)] = z.re;
                m[(2 * i + 1, c)] = z.im;
            }
        }
        m
    };
    let mut columns = table(&|p| basis.columns(p), basis.len());
    let scale: Vec<f64> = columns.column_iter().map(|c| c.norm()).collect();
    for (mut column, s) in columns.column_iter_mut().zip(&scale) {
        column.unscale_mut(*s);
    }
    let values = table(functions, count);
    let svd = columns.try_svd(true, true, f64::EPSILON, 10_000);
    let solution = svd.and_then(|svd| svd.solve(&values, 1e-13).ok());
    let none = || Error::Numerical("covariance: columns of a chain of filters".into());
    let solution = solution.ok_or_else(none)?;
    Ok(DMatrix::from_fn(scale.len(), count, |i, j| {
        solution[(i, j)] / scale[i]
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::form::FeedThrough;

    /// Columns and slopes written in the longer chain against those computed directly, away from the grid.
    #[test]
    fn the_longer_chain_spans_columns_and_derivatives() {
        let feed_through = FeedThrough::default();
        let forms = [
            (
                Form::Laguerre {
                    filters: Some(3),
                    feed_through,
                    pole_per_transfer_function: false,
                },
                vec![0.4],
            ),
            (
                Form::TakenakaMalmquist {
                    filters: 2,
                    feed_through,
                    pole_per_transfer_function: false,
                },
                vec![0.091, 0.6],
            ),
            (
                Form::Rational {
                    lags: 2,
                    added_mass: true,
                },
                vec![0.15, 0.5],
            ),
        ];
        for (form, free) in forms {
            let chain = form.expand(&free);
            let own = Basis::new(&form, &chain).unwrap();
            let values: Vec<f64> = (0..own.len()).map(|c| 1.0 - 0.3 * c as f64).collect();
            let pole = |index: usize| SearchedPole {
                entry: None,
                apart: Vec::new(),
                index,
            };
            let searched: Vec<_> = (0..free.len()).map(pole).collect();
            let expansion = Expansion::new(&form, &chain, &values, [0, 0], &searched).unwrap();
            let longer = Basis::orthonormal(&form, &expansion.extended).unwrap();
            for k in [0.037, 0.31, 1.9] {
                let p = Complex::new(0.0, k);
                let long = longer.columns(p);
                let in_long = |m: &DMatrix<f64>, c: usize| -> Complex<f64> {
                    long.iter().enumerate().map(|(e, z)| z * m[(e, c)]).sum()
                };
                for (c, z) in own.columns(p).into_iter().enumerate() {
                    assert!((in_long(&expansion.native, c) - z).norm() < 1e-10 * (1.0 + z.norm()));
                }
                for m in 0..free.len() {
                    // a wider step than that of the expansion: differences of 1e-4 err by their square
                    let at = |factor: f64| -> Complex<f64> {
                        let mut poles = free.clone();
                        poles[m] *= factor;
                        let basis = Basis::new(&form, &form.expand(&poles)).unwrap();
                        basis
                            .columns(p)
                            .iter()
                            .zip(&values)
                            .map(|(z, v)| z * *v)
                            .sum()
                    };
                    let direct = (at(1.0 + 1e-4) - at(1.0 - 1e-4)) / (2e-4 * free[m]);
                    let found = in_long(&expansion.slopes, m);
                    assert!(
                        (found - direct).norm() < 1e-6 * direct.norm(),
                        "{form:?} {found} {direct}"
                    );
                }
            }
        }
    }
}
