//! The columns of a linear fit: feed-through and filters, in the frequency domain and as a linear system.
//!
//! Orthonormal filters and Roger's lag terms differ only in the filter column; everything else of the identification
//! is common to them.

use super::entry_report::EntryReport;
use super::form::{FeedThrough, Form};
use crate::aerodynamics::laguerre::FilterTerm;
use crate::aerodynamics::{FilterBank, Lags, LaguerreModel, RationalModel};
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::trained_model::Model;
use nalgebra::{Complex, DMatrix, DVector};

/// Feed-through columns followed by filters with given poles.
#[derive(Debug, Clone)]
pub(crate) struct Basis {
    feed: FeedThrough,
    bank: FilterBank,
    /// Whether its poles are those of lag terms `p/(p + d_l)` instead of `Λ_l(p)`.
    lags: bool,
}

impl Basis {
    /// The basis of `form` with the poles `poles`, one per filter.
    pub(crate) fn new(form: &Form, poles: &[f64]) -> Result<Self> {
        let lags = form.has_lags();
        let basis = Self::orthonormal(form, poles)?;
        Ok(Self { lags, ..basis })
    }

    /// Orthonormal filters that span the same space: for the search of poles, whose objective depends on the space
    /// only.
    pub(crate) fn orthonormal(form: &Form, poles: &[f64]) -> Result<Self> {
        Ok(Self {
            feed: form.feed_through(),
            bank: FilterBank::new(poles.to_vec())?,
            lags: false,
        })
    }

    /// Whether another basis has the same columns.
    pub(crate) fn same_columns(&self, other: &Self) -> bool {
        self.feed == other.feed && self.lags == other.lags && self.poles() == other.poles()
    }

    /// Poles of the filters.
    pub(crate) fn poles(&self) -> &[f64] {
        self.bank.poles()
    }

    pub(crate) fn feed(&self) -> FeedThrough {
        self.feed
    }

    /// Number of columns of one input.
    pub(crate) fn len(&self) -> usize {
        self.feed.count() + self.poles().len()
    }

    /// Values of all columns at the complex frequency `p = iK`.
    pub(crate) fn columns(&self, p: Complex<f64>) -> Vec<Complex<f64>> {
        let powers = [Complex::new(1.0, 0.0), p, p * p];
        let mut columns: Vec<_> = self.feed.orders().map(|order| powers[order]).collect();
        if self.lags {
            columns.extend(self.poles().iter().map(|d| p / (p + d)));
        } else {
            columns.extend(self.bank.response(p));
        }
        columns
    }

    /// Value and slope `d/dp` of all columns at `p = 0`.
    pub(crate) fn at_zero(&self) -> [Vec<f64>; 2] {
        let [mut value, mut slope] = [0, 1].map(|order| -> Vec<f64> {
            let feed = self.feed.orders();
            feed.map(|o| f64::from(u8::from(o == order))).collect()
        });
        if self.lags {
            value.resize(self.len(), 0.0);
            slope.extend(self.poles().iter().map(|d| 1.0 / d));
            return [value, slope];
        }
        // the logarithmic derivative of Λ_l: −1/π_l from its own pole, −2/π_j from every all-pass before it
        let mut before = 0.0;
        let filters = self.bank.response(Complex::new(0.0, 0.0));
        for (filter, pole) in filters.iter().zip(self.poles()) {
            value.push(filter.re);
            slope.push(filter.re * (before - 1.0 / pole));
            before -= 2.0 / pole;
        }
        [value, slope]
    }

    /// Names of the columns as in the equations: `e0 … c0 …`, or `a1 … a4 …`.
    pub(crate) fn names(&self) -> Vec<String> {
        let (feed, shift, filter, first) = match self.lags {
            false => ("e", 0, "c", 0),
            true => ("a", 1, "a", 4),
        };
        let filters = (0..self.poles().len()).map(|l| format!("{filter}{}", first + l));
        let orders = self.feed.orders();
        let names = orders.map(|order| format!("{feed}{}", order + shift));
        names.chain(filters).collect()
    }

    /// The filters in dimensionless time, `x' = A x + b r + b₁ r'`: `A`, and `b` beside `b₁`; their outputs are their states.
    pub(crate) fn filters(&self) -> (DMatrix<f64>, DMatrix<f64>) {
        let count = self.poles().len();
        let mut drive = DMatrix::zeros(count, 2);
        if self.lags {
            // (1.28), corrected: δ' = r' − d δ
            drive.column_mut(1).fill(1.0);
            let poles = DVector::from_fn(count, |l, _| -self.poles()[l]);
            return (DMatrix::from_diagonal(&poles), drive);
        }
        let (a, on_motion) = self.bank.matrices();
        drive.set_column(0, &on_motion);
        (a, drive)
    }
}

/// The model whose entries, row by row, have these poles and coefficients, in the order of the columns of their bases.
///
/// # Errors
/// Poles that are not positive, or a model that does not pass its own check.
pub(crate) fn assemble(
    form: &Form,
    dofs: &[Dof],
    poles: &[Vec<f64>],
    coefficients: &[Vec<f64>],
) -> Result<Model> {
    let n = dofs.len();
    let feed = form.feed_through();
    let part = |order: usize| {
        let column = feed.orders().position(|o| o == order);
        let entry = |i: usize, j: usize| column.map_or(0.0, |c| coefficients[i * n + j][c]);
        DMatrix::from_fn(n, n, entry)
    };
    let filter = |i: usize, j: usize, l: usize| coefficients[i * n + j][feed.count() + l];
    if let Form::Rational { .. } | Form::RationalPerForce { .. } = form {
        let term = |l| DMatrix::from_fn(n, n, |i, j| filter(i, j, l));
        let lags = match form.poles_per_force() {
            true => Lags::PerForce(poles.iter().step_by(n).cloned().collect()),
            false => Lags::Shared(poles[0].clone()),
        };
        let model = RationalModel {
            dofs: dofs.to_vec(),
            a1: part(0),
            a2: part(1),
            a3: part(2),
            lag_terms: (0..poles[0].len()).map(term).collect(),
            lags,
        };
        model.validate()?;
        return Ok(Model::Rational(model));
    }
    let term = |(input, chain): (usize, &Vec<f64>)| {
        let coefficient = |force: usize, l: usize| match poles[force * n + input] == *chain {
            true => filter(force, input, l),
            false => 0.0,
        };
        Ok(FilterTerm {
            input,
            poles: FilterBank::new(chain.clone())?,
            coefficients: DMatrix::from_fn(n, chain.len(), coefficient),
        })
    };
    let chains = once_an_input(n, poles).into_iter();
    let model = LaguerreModel {
        dofs: dofs.to_vec(),
        e0: part(0),
        e1: part(1),
        e2: part(2),
        terms: chains.map(term).collect::<Result<_>>()?,
    };
    model.validate()?;
    Ok(Model::Laguerre(model))
}

/// The model that the accounts of its entries, row by row, describe.
///
/// # Errors
/// As [`assemble`].
pub(super) fn model_of(form: &Form, dofs: &[Dof], reports: &[EntryReport]) -> Result<Model> {
    let poles: Vec<Vec<f64>> = reports.iter().map(|r| r.poles.clone()).collect();
    let values: Vec<Vec<f64>> = reports.iter().map(EntryReport::values).collect();
    assemble(form, dofs, &poles, &values)
}

/// What the transfer functions of every input have, row by row in `entries`, each once: one chain serves all forces that share it.
pub(super) fn once_an_input<T: PartialEq>(n: usize, entries: &[T]) -> Vec<(usize, &T)> {
    let mut all: Vec<(usize, &T)> = Vec::new();
    for input in 0..n {
        for own in entries.iter().skip(input).step_by(n) {
            if !all.contains(&(input, own)) {
                all.push((input, own));
            }
        }
    }
    all
}

/// Index of a degree of freedom in `dofs`.
pub(crate) fn index_of(dofs: &[Dof], dof: Dof, place: &str) -> Result<usize> {
    dofs.iter().position(|d| *d == dof).ok_or_else(|| {
        let known: Vec<_> = dofs.iter().map(|d| d.name()).collect();
        Error::input(place, known.join(" or "), dof.name())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Value and slope at zero against the columns at ±1e-5: central differences err by the square of that times third
    /// derivatives of up to 1e4.
    #[test]
    fn slopes_at_zero_are_those_of_the_columns() {
        let step = 1e-5;
        for form in [
            Form::takenaka_malmquist(3),
            Form::Rational {
                lags: 3,
                added_mass: true,
            },
        ] {
            let basis = Basis::new(&form, &[0.2, 0.5, 0.9]).unwrap();
            let [value, slope] = basis.at_zero();
            // the columns are real on the real axis
            let at = |p: f64| basis.columns(Complex::new(p, 0.0));
            for c in 0..basis.len() {
                assert!((at(0.0)[c].re - value[c]).abs() < 1e-14);
                let difference = (at(step)[c].re - at(-step)[c].re) / (2.0 * step);
                assert!((difference - slope[c]).abs() < 1e-6, "{c}");
            }
        }
    }
}
