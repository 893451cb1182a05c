//! Sandwich covariance over blocks, with the small-sample corrections that few blocks need.
//!
//! Rows of one block (a segment of a record, a test run of a table) may be correlated in any way; blocks are
//! independent. With `M = Σ AᵍᵀAᵍ` the parameters err by `M⁻¹ Σ Aᵍᵀ eᵍ`, so that their covariance is the sum of the
//! squares of the blocks' contributions. Residuals are smaller than errors, the more the fit hangs on their block:
//! each block's are enlarged by `(I − Hᵍ)^(−1/2)`, taken so that the sum is unbiased if the errors are white (CR2 of
//! Bell & McCaffrey, "Bias reduction in standard errors for linear regression with multi-stage samples", Survey
//! Methodology 28, 2002), and the number of degrees of freedom is Satterthwaite's, from the same paper.
//!
//! A block comes as `Qᵀ` times its rows: whatever is outside the span of its columns contributes nothing.

use crate::error::{Error, Result, counted};
use crate::identification::least_squares::StreamingQr;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use serde::{Deserialize, Serialize};

/// Directions in which a block is the only one to determine the parameters leave no residual to judge by.
const LEVERAGE_TOLERANCE: f64 = 1e-9;

/// Rows of one block and their residuals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Block {
    /// What the block is, in words.
    pub name: String,
    /// Mean wind speed of its test, m/s, where it is known.
    pub speed_m_s: Option<f64>,
    /// Reduced frequency of its motion, where it has one.
    pub k: Option<f64>,
    /// r×P.
    #[serde(with = "crate::state_space::rows")]
    pub rows: DMatrix<f64>,
    /// r.
    #[serde(with = "super::columns_in_files")]
    pub residual: DVector<f64>,
    /// Working variance of each row: relative sizes only.
    #[serde(with = "super::columns_in_files")]
    pub variance: DVector<f64>,
}

impl Block {
    /// Several blocks as one, of the speed and frequency of the first.
    pub(crate) fn joined(name: String, blocks: &[Self]) -> Self {
        let count = blocks.iter().map(|b| b.residual.len()).sum();
        let width = blocks.first().map_or(0, |b| b.rows.ncols());
        let mut joined = Self {
            name,
            speed_m_s: blocks.first().and_then(|b| b.speed_m_s),
            k: blocks.first().and_then(|b| b.k),
            rows: DMatrix::zeros(count, width),
            residual: DVector::zeros(count),
            variance: DVector::zeros(count),
        };
        let mut at = 0;
        for block in blocks {
            let n = block.residual.len();
            joined.rows.rows_mut(at, n).copy_from(&block.rows);
            joined.residual.rows_mut(at, n).copy_from(&block.residual);
            joined.variance.rows_mut(at, n).copy_from(&block.variance);
            at += n;
        }
        joined
    }

    /// The same information in no more rows than columns, all of one working variance.
    fn compressed(self) -> Self {
        let mean = self.variance.mean();
        let (rows, residual) = if self.rows.nrows() > self.rows.ncols() {
            let qr = self.rows.qr();
            (qr.r(), qr.q().tr_mul(&self.residual))
        } else {
            (self.rows, self.residual)
        };
        Self {
            variance: DVector::from_element(residual.len(), mean),
            rows,
            residual,
            ..self
        }
    }
}

/// A random effect on the parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Effect {
    /// Each column times an independent standard normal number, P×m.
    #[serde(with = "crate::state_space::rows")]
    pub columns: DMatrix<f64>,
    /// Variance between speeds over that part of it which exceeds the blocks'.
    pub total: f64,
    pub degrees_of_freedom: f64,
}

/// The data that an estimate was made from, for another process as well: blocks of one fit with what is common to all of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Design {
    pub(super) blocks: Vec<Block>,
    /// Random effects of mean speeds beside the scatter of the blocks.
    pub(super) effects: Vec<Effect>,
    /// `M⁻¹`, or what is left of it along the tangent, P×P.
    #[serde(with = "crate::state_space::rows")]
    pub(super) inverse: DMatrix<f64>,
    /// Orthonormal directions that active constraints leave to the parameters, P×q; those of the parameters where nothing holds
    /// them.
    #[serde(with = "crate::state_space::rows")]
    tangent: DMatrix<f64>,
    /// `Σ AᵀDA` with the working variances, P×P.
    #[serde(with = "crate::state_space::rows")]
    working: DMatrix<f64>,
    /// Enlargement of the residuals of each block, r×r, symmetric.
    #[serde(with = "crate::state_space::rows::list")]
    enlarge: Vec<DMatrix<f64>>,
}

impl Design {
    /// Prepares the blocks of one fit, whose parameters active constraints leave only the directions of `tangent`.
    ///
    /// # Errors
    /// [`Error::Numerical`] when the blocks do not determine all parameters or are fewer than two.
    pub(crate) fn new(blocks: Vec<Block>, tangent: DMatrix<f64>) -> Result<Self> {
        if blocks.len() < 2 {
            return Err(Error::Numerical(format!(
                "covariance: {}, at least two are needed",
                counted(blocks.len(), "independent block")
            )));
        }
        let (parameters, free) = tangent.shape();
        let mut qr = StreamingQr::new(free, 0);
        let mut working = DMatrix::zeros(parameters, parameters);
        for block in &blocks {
            let along = along(&block.rows, &tangent);
            if along.nrows() > 0 {
                let columns = along.as_slice().chunks_exact(along.nrows());
                qr.push_columns(&columns.collect::<Vec<_>>());
            }
            working += block.rows.transpose() * scaled(&block.rows, &block.variance);
        }
        let inner = qr.finish().inverse_gram(free)?;
        let inverse = &tangent * inner * tangent.transpose();
        Self::assembled(blocks, inverse, tangent, working)
    }

    /// The same fit with its rows put together in other blocks.
    pub(crate) fn with_blocks(&self, blocks: Vec<Block>) -> Result<Self> {
        let p = self.inverse.nrows();
        let working = blocks.iter().fold(DMatrix::zeros(p, p), |sum, b| {
            sum + b.rows.tr_mul(&scaled(&b.rows, &b.variance))
        });
        Self::assembled(blocks, self.inverse.clone(), self.tangent.clone(), working)
    }

    fn assembled(
        blocks: Vec<Block>,
        inverse: DMatrix<f64>,
        tangent: DMatrix<f64>,
        working: DMatrix<f64>,
    ) -> Result<Self> {
        let mut design = Self {
            blocks,
            effects: Vec::new(),
            inverse,
            tangent,
            working,
            enlarge: Vec::new(),
        };
        let enlarge = design.blocks.iter().map(|b| design.enlargement(b));
        design.enlarge = enlarge.collect::<Result<_>>()?;
        Ok(design)
    }

    /// `D^½ (D^½ B D^½)^(−½) D^½` with the covariance `B` of the block's residuals under the working variances `D`.
    fn enlargement(&self, block: &Block) -> Result<DMatrix<f64>> {
        let hat = &block.rows * &self.inverse * block.rows.transpose();
        let across = &block.rows * &self.inverse;
        let weighted = scaled(&hat, &block.variance);
        let b = DMatrix::from_diagonal(&block.variance) - &weighted - weighted.transpose()
            + &across * &self.working * across.transpose();
        let root = block.variance.map(f64::sqrt);
        let inner = scaled(&scaled(&b, &root).transpose(), &root);
        if !inner.iter().all(|x| x.is_finite()) {
            return Err(Error::Numerical(format!(
                "covariance: block {} is not finite",
                block.name
            )));
        }
        let eigen = SymmetricEigen::try_new(inner, f64::EPSILON, 10_000)
            .ok_or_else(|| Error::Numerical("covariance: no eigenvalues of a block".into()))?;
        let floor = LEVERAGE_TOLERANCE * eigen.eigenvalues.amax();
        let power = |x: f64| if x > floor { x.sqrt().recip() } else { 0.0 };
        let powers = eigen.eigenvalues.map(power);
        let middle = &eigen.eigenvectors * scaled(&eigen.eigenvectors.transpose(), &powers);
        Ok(scaled(&scaled(&middle, &root).transpose(), &root))
    }

    /// How much larger the contributions of groups of blocks are than those of the blocks, in the metric of the fit:
    /// one for independent blocks, the number of blocks in a group where all say the same.
    pub(crate) fn coherence(&self, groups: &[usize]) -> f64 {
        let count = groups.iter().max().map_or(0, |g| g + 1);
        let mut sums = vec![DVector::zeros(self.inverse.nrows()); count];
        let size = |score: &DVector<f64>| score.dot(&(&self.inverse * score));
        let mut apart = 0.0;
        for ((block, enlarge), group) in self.blocks.iter().zip(&self.enlarge).zip(groups) {
            let score = block.rows.transpose() * (enlarge * &block.residual);
            apart += size(&score);
            sums[*group] += score;
        }
        let together: f64 = sums.iter().map(size).sum();
        if apart > 0.0 { together / apart } else { 1.0 }
    }

    /// The blocks put together in groups.
    pub(crate) fn merged(&self, groups: &[usize], names: Vec<String>) -> Vec<Block> {
        let named = names.into_iter().enumerate();
        let blocks = named.map(|(g, name)| Block::joined(name, &self.members(groups, g)));
        blocks.collect()
    }

    fn members(&self, groups: &[usize], group: usize) -> Vec<Block> {
        let own = self.blocks.iter().zip(groups).filter(|(_, g)| **g == group);
        own.map(|(b, _)| b.clone()).collect()
    }

    /// The blocks of each of `count` groups as one block, with the residuals of the common fit.
    pub(crate) fn clusters(&self, groups: &[usize], count: usize) -> Vec<Block> {
        let names = (1..=count).map(|g| format!("group {g}")).collect();
        let joined = self.merged(groups, names).into_iter();
        joined.map(Block::compressed).collect()
    }

    /// The fit to the blocks of one group alone in the first `kept` columns, and how far it is from the common one.
    ///
    /// # Errors
    /// [`Error::Numerical`] when the group does not determine all parameters.
    pub(crate) fn alone(
        &self,
        groups: &[usize],
        group: usize,
        kept: usize,
    ) -> Result<(Self, DVector<f64>)> {
        let mut blocks = self.members(groups, group);
        for block in &mut blocks {
            block.rows = block.rows.columns(0, kept).into_owned();
        }
        let tangent = constrained_to_zero(&self.tangent, kept);
        // determines the parameters, or says that it does not
        Self::new(blocks.clone(), tangent.clone())?;
        let all = Block::joined(String::new(), &blocks);
        let qr = along(&all.rows, &tangent).qr();
        let right = qr.q().tr_mul(&all.residual);
        let inner = qr.r().solve_upper_triangular(&right);
        let none = || Error::Numerical("covariance: one speed alone".into());
        let step = &tangent * inner.ok_or_else(none)?;
        for block in &mut blocks {
            block.residual -= &block.rows * &step;
        }
        Ok((Self::new(blocks, tangent)?, step))
    }

    /// Names of the blocks.
    pub(crate) fn names(&self) -> Vec<String> {
        self.blocks.iter().map(|b| b.name.clone()).collect()
    }

    /// Contribution of each block to the errors of the parameters, P×G.
    pub(crate) fn contributions(&self) -> DMatrix<f64> {
        let column = |(b, enlarge): (&Block, &DMatrix<f64>)| {
            &self.inverse * b.rows.transpose() * (enlarge * &b.residual)
        };
        let columns = self.blocks.iter().zip(&self.enlarge).map(column);
        DMatrix::from_columns(&columns.collect::<Vec<_>>())
    }

    /// Satterthwaite's degrees of freedom of the variance of `contrast · parameters`, under the working variances.
    pub(crate) fn degrees_of_freedom(&self, contrast: &DVector<f64>) -> f64 {
        let along = &self.inverse * contrast;
        let (mut u, mut y, mut weighted) = (Vec::new(), Vec::new(), Vec::new());
        for (b, enlarge) in self.blocks.iter().zip(&self.enlarge) {
            let own: DVector<f64> = enlarge * (&b.rows * &along);
            y.push(&self.inverse * b.rows.transpose() * &own);
            weighted.push(b.rows.transpose() * own.component_mul(&b.variance));
            u.push(own);
        }
        let (mut trace, mut squares) = (0.0, 0.0);
        for g in 0..u.len() {
            let spread = &self.working * &y[g];
            for h in 0..u.len() {
                let mut entry = spread.dot(&y[h]) - weighted[g].dot(&y[h]) - weighted[h].dot(&y[g]);
                if g == h {
                    entry += u[g].component_mul(&self.blocks[g].variance).dot(&u[g]);
                    trace += entry;
                }
                squares += entry * entry;
            }
        }
        match squares > 0.0 {
            true => (trace * trace / squares).max(1.0),
            false => 1.0,
        }
    }

    /// How far the parameters move when each block counts as often as its weight says (one Gauss–Newton step).
    ///
    /// # Errors
    /// [`Error::Numerical`] when the weighted blocks do not determine all parameters.
    pub(crate) fn reweighted(&self, weights: &[f64]) -> Result<DVector<f64>> {
        let own = self.tangent.tr_mul(&(&self.inverse * &self.tangent));
        // in units in which the whole system is near the identity, so that the normal equations lose no digits
        let unit = own.diagonal().map(f64::sqrt);
        let n = unit.len();
        let mut gram = DMatrix::zeros(n, n);
        let mut right = DVector::zeros(n);
        for (block, weight) in self.blocks.iter().zip(weights) {
            let rows = along(&block.rows, &self.tangent) * DMatrix::from_diagonal(&unit);
            gram.gemm(*weight, &rows.transpose(), &rows, 1.0);
            right.gemv(*weight, &rows.transpose(), &block.residual, 1.0);
        }
        let singular = || Error::Numerical("bootstrap: a replicate is singular".into());
        let step = gram.cholesky().ok_or_else(singular)?.solve(&right);
        Ok(&self.tangent * step.component_mul(&unit))
    }
}

/// Rows over the directions of a tangent; those of a fit without active constraints are the parameters themselves.
fn along(rows: &DMatrix<f64>, tangent: &DMatrix<f64>) -> DMatrix<f64> {
    if tangent.is_identity(0.0) {
        return rows.clone();
    }
    rows * tangent
}

/// The directions of a tangent in which all parameters from `kept` on stay as they are, without these.
fn constrained_to_zero(tangent: &DMatrix<f64>, kept: usize) -> DMatrix<f64> {
    let held = tangent.rows(kept, tangent.nrows() - kept).into_owned();
    let eigen = SymmetricEigen::new(held.tr_mul(&held));
    let still = |i: &usize| eigen.eigenvalues[*i] < LEVERAGE_TOLERANCE;
    let free: Vec<usize> = (0..eigen.eigenvalues.len()).filter(still).collect();
    tangent.rows(0, kept) * eigen.eigenvectors.select_columns(&free)
}

/// `diag(factors) m`.
fn scaled(m: &DMatrix<f64>, factors: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| factors[i] * m[(i, j)])
}

#[cfg(test)]
mod tests;
