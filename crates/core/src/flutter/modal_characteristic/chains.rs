//! The filters of a bridge, which come in chains that are alike for every mode.

use crate::aerodynamics::ContinuousRealization;
use crate::flutter::columns::{RealColumns, Shape};
use crate::state_space::Complex64;
use nalgebra::{DMatrix, DVector};

/// Filters that are driven by one coordinate each, alike for all coordinates of the chain.
#[derive(Debug, Clone)]
pub(super) struct Chain<Output = RealColumns> {
    /// L×L.
    pub(super) a: DMatrix<f64>,
    /// L.
    pub(super) b: DVector<f64>,
    /// What each filter does, n×n: column `j` for the chain that coordinate `j` drives, times `½ρB²`.
    pub(super) outputs: Vec<Output>,
}

impl Chain {
    /// `x = (λB I − V A)⁻¹ b` and `dx/dλ`.
    pub(super) fn response(
        &self,
        lambda: Complex64,
        width: f64,
        speed: f64,
    ) -> Option<(Shape, Shape)> {
        let n = self.b.len();
        let matrix = DMatrix::from_fn(n, n, |i, j| {
            let diagonal = if i == j {
                lambda * width
            } else {
                Complex64::default()
            };
            diagonal - self.a[(i, j)] * speed
        });
        let lu = matrix.lu();
        let x = lu.solve(&self.b.map(Complex64::from))?;
        let dx = lu.solve(&(&x * Complex64::from(-width)))?;
        Some((x, dx))
    }
}

/// The chains of a realisation: for every coordinate the filters it drives, those that are alike together; `force` makes the
/// force of what a filter does.
pub(super) fn chains(
    aero: &ContinuousRealization,
    force: impl Fn(&DMatrix<f64>) -> RealColumns,
) -> Vec<Chain> {
    let n = aero.b.ncols();
    let mut chains: Vec<Chain<DMatrix<f64>>> = Vec::new();
    for input in 0..n {
        for states in driven(aero, input) {
            let a = aero.a.select_rows(&states).select_columns(&states);
            let b =
                DVector::from_iterator(states.len(), states.iter().map(|s| aero.b[(*s, input)]));
            let alike = chains.iter().position(|c| c.a == a && c.b == b);
            let at = alike.unwrap_or_else(|| {
                let outputs = vec![DMatrix::zeros(n, n); states.len()];
                chains.push(Chain { a, b, outputs });
                chains.len() - 1
            });
            for (output, state) in chains[at].outputs.iter_mut().zip(&states) {
                let mut column = output.column_mut(input);
                column += aero.c.column(*state);
            }
        }
    }
    let chain = |c: Chain<DMatrix<f64>>| Chain {
        a: c.a,
        b: c.b,
        outputs: c.outputs.iter().map(&force).collect(),
    };
    chains.into_iter().map(chain).collect()
}

/// The filters that one coordinate drives, those that feed one another together.
fn driven(aero: &ContinuousRealization, input: usize) -> Vec<Vec<usize>> {
    let n = aero.a.nrows();
    let mut seen = vec![false; n];
    let mut groups = Vec::new();
    for first in (0..n).filter(|i| aero.b[(*i, input)] != 0.0) {
        if std::mem::replace(&mut seen[first], true) {
            continue;
        }
        let mut group = vec![first];
        let mut next = 0;
        while next < group.len() {
            let at = group[next];
            next += 1;
            for (other, seen) in seen.iter_mut().enumerate() {
                let linked = aero.a[(at, other)] != 0.0 || aero.a[(other, at)] != 0.0;
                if linked && !std::mem::replace(seen, true) {
                    group.push(other);
                }
            }
        }
        group.sort_unstable();
        groups.push(group);
    }
    groups
}
