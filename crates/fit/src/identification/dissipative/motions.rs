//! Which motions conditions hold together, and which filters a transfer function has.

use crate::identification::basis::Basis;
use crate::section::Dof;
use nalgebra::{DMatrix, DVector};

/// The motions of a model whose transfer functions have given bases.
pub(super) struct Motions<'a> {
    /// How many there are.
    pub count: usize,
    /// Those that conditions hold together: heave and torsion; sway by itself. Shapes that mix sway with the others are fed
    /// energy by quasi-steady theory itself (`[[2C_D, C_D′ − C_L], [2C_L, C_L′ + C_D]]` is indefinite at small drag), and nothing
    /// grows for it: frequencies of sway are far from the others', or its mass is.
    pub parts: Vec<Vec<usize>>,
    /// Which of `distinct` the basis of a transfer function is, row by row.
    pub basis_of: Vec<usize>,
    pub distinct: Vec<&'a Basis>,
}

impl<'a> Motions<'a> {
    /// For the bases of all transfer functions, row by row.
    pub(super) fn new(bases: &'a [Basis], dofs: &[Dof]) -> Self {
        let mut distinct: Vec<&Basis> = Vec::new();
        let mut basis_of = Vec::with_capacity(bases.len());
        for basis in bases {
            let known = distinct.iter().position(|d| d.same_columns(basis));
            basis_of.push(known.unwrap_or(distinct.len()));
            if known.is_none() {
                distinct.push(basis);
            }
        }
        let (sway, deck) = (0..dofs.len()).partition(|i| dofs[*i] == Dof::Lateral);
        let parts: [Vec<usize>; 2] = [deck, sway];
        Self {
            count: bases.len().isqrt(),
            parts: parts.into_iter().filter(|p| !p.is_empty()).collect(),
            basis_of,
            distinct,
        }
    }

    /// A shape of all motions from one of a part.
    pub(super) fn whole(&self, part: usize, shape: &[f64]) -> DVector<f64> {
        let mut v = DVector::zeros(self.count);
        for (&i, x) in self.parts[part].iter().zip(shape) {
            v[i] = *x;
        }
        v
    }

    /// A matrix over the motions of a part as one over all of them.
    pub(super) fn whole_matrix(&self, part: usize, matrix: &DMatrix<f64>) -> DMatrix<f64> {
        let mut whole = DMatrix::zeros(self.count, self.count);
        for (a, &i) in self.parts[part].iter().enumerate() {
            for (b, &j) in self.parts[part].iter().enumerate() {
                whole[(i, j)] = matrix[(a, b)];
            }
        }
        whole
    }
}
