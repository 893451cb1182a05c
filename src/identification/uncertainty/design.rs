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

use crate::error::{Error, Result};
use crate::identification::least_squares::StreamingQr;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Directions in which a block is the only one to determine the parameters leave no residual to judge by.
const LEVERAGE_TOLERANCE: f64 = 1e-9;

/// Rows of one block and their residuals.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Block {
    /// What the block is, in words.
    pub name: String,
    /// r×P.
    pub rows: DMatrix<f64>,
    /// r.
    pub residual: DVector<f64>,
    /// Working variance of each row: relative sizes only.
    pub variance: DVector<f64>,
}

impl Block {
    /// Rows, residuals and working variance of several forces, one below the other.
    pub fn stacked(name: String, parts: &[(DMatrix<f64>, DVector<f64>, f64)]) -> Self {
        let blocks: Vec<Self> = parts
            .iter()
            .map(|(rows, residual, variance)| Self {
                name: String::new(),
                rows: rows.clone(),
                residual: residual.clone(),
                variance: DVector::from_element(residual.len(), *variance),
            })
            .collect();
        Self::joined(name, &blocks)
    }

    /// Several blocks as one.
    pub fn joined(name: String, blocks: &[Self]) -> Self {
        let count = blocks.iter().map(|b| b.residual.len()).sum();
        let width = blocks.first().map_or(0, |b| b.rows.ncols());
        let mut joined = Self {
            name,
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
}

/// Blocks of one fit with what is common to all of them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Design {
    blocks: Vec<Block>,
    /// `M⁻¹`, P×P.
    inverse: DMatrix<f64>,
    /// `Σ AᵀDA` with the working variances, P×P.
    working: DMatrix<f64>,
    /// Enlargement of the residuals of each block, r×r, symmetric.
    enlarge: Vec<DMatrix<f64>>,
}

impl Design {
    /// Prepares the blocks of one fit.
    ///
    /// # Errors
    /// [`Error::Numerical`] when the blocks do not determine all parameters or are fewer than two.
    pub fn new(blocks: Vec<Block>) -> Result<Self> {
        if blocks.len() < 2 {
            return Err(Error::Numerical(format!(
                "covariance: {} independent block(s), at least two are needed",
                blocks.len()
            )));
        }
        let parameters = blocks[0].rows.ncols();
        let mut qr = StreamingQr::new(parameters, 0);
        let mut working = DMatrix::zeros(parameters, parameters);
        for block in &blocks {
            let columns: Vec<Vec<f64>> = block
                .rows
                .column_iter()
                .map(|c| c.iter().copied().collect())
                .collect();
            let slices: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
            qr.push_columns(&slices);
            working += block.rows.transpose() * scaled(&block.rows, &block.variance);
        }
        let inverse = qr.finish().inverse_gram(parameters)?;
        let mut design = Self {
            blocks,
            inverse,
            working,
            enlarge: Vec::new(),
        };
        design.enlarge = design
            .blocks
            .iter()
            .map(|b| design.enlargement(b))
            .collect::<Result<_>>()?;
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
        let powers = eigen
            .eigenvalues
            .map(|x| if x > floor { x.sqrt().recip() } else { 0.0 });
        let middle = &eigen.eigenvectors * scaled(&eigen.eigenvectors.transpose(), &powers);
        Ok(scaled(&scaled(&middle, &root).transpose(), &root))
    }

    /// How much larger the contributions of groups of blocks are than those of the blocks, in the metric of the fit:
    /// one for independent blocks, the number of blocks in a group where all say the same.
    pub fn coherence(&self, groups: &[usize]) -> f64 {
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
    pub fn merged(self, groups: &[usize], names: &[String]) -> Vec<Block> {
        let mut parts: Vec<Vec<Block>> = names.iter().map(|_| Vec::new()).collect();
        for (block, group) in self.blocks.into_iter().zip(groups) {
            parts[*group].push(block);
        }
        let zipped = parts.into_iter().zip(names);
        zipped
            .map(|(blocks, name)| Block::joined(name.clone(), &blocks))
            .collect()
    }

    /// Names of the blocks.
    pub fn names(&self) -> Vec<String> {
        self.blocks.iter().map(|b| b.name.clone()).collect()
    }

    /// Contribution of each block to the errors of the parameters, P×G.
    pub fn contributions(&self) -> DMatrix<f64> {
        let columns: Vec<DVector<f64>> = self
            .blocks
            .iter()
            .zip(&self.enlarge)
            .map(|(b, enlarge)| &self.inverse * b.rows.transpose() * (enlarge * &b.residual))
            .collect();
        DMatrix::from_columns(&columns)
    }

    /// Satterthwaite's degrees of freedom of the variance of `contrast · parameters`, under the working variances.
    pub fn degrees_of_freedom(&self, contrast: &DVector<f64>) -> f64 {
        let along = &self.inverse * contrast;
        let u: Vec<DVector<f64>> = self
            .blocks
            .iter()
            .zip(&self.enlarge)
            .map(|(b, enlarge)| enlarge * (&b.rows * &along))
            .collect();
        let y: Vec<DVector<f64>> = self
            .blocks
            .iter()
            .zip(&u)
            .map(|(b, u)| &self.inverse * b.rows.transpose() * u)
            .collect();
        let weighted: Vec<DVector<f64>> = self
            .blocks
            .iter()
            .zip(&u)
            .map(|(b, u)| b.rows.transpose() * u.component_mul(&b.variance))
            .collect();
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
        if squares > 0.0 {
            (trace * trace / squares).max(1.0)
        } else {
            1.0
        }
    }

    /// How far the parameters move when each block counts as often as its weight says (one Gauss–Newton step).
    ///
    /// # Errors
    /// [`Error::Numerical`] when the weighted blocks do not determine all parameters.
    pub fn reweighted(&self, weights: &[f64]) -> Result<DVector<f64>> {
        let n = self.inverse.nrows();
        // in units in which the whole system is near the identity, so that the normal equations lose no digits
        let unit = self.inverse.diagonal().map(f64::sqrt);
        let mut gram = DMatrix::zeros(n, n);
        let mut right = DVector::zeros(n);
        for (block, weight) in self.blocks.iter().zip(weights) {
            let rows = DMatrix::from_fn(block.rows.nrows(), n, |i, j| block.rows[(i, j)] * unit[j]);
            gram.gemm(*weight, &rows.transpose(), &rows, 1.0);
            right.gemv(*weight, &rows.transpose(), &block.residual, 1.0);
        }
        let step = gram
            .cholesky()
            .ok_or_else(|| Error::Numerical("bootstrap: a replicate is singular".into()))?
            .solve(&right);
        Ok(step.component_mul(&unit))
    }
}

/// `diag(factors) m`.
fn scaled(m: &DMatrix<f64>, factors: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| factors[i] * m[(i, j)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    fn normal(random: &mut ChaCha8Rng) -> f64 {
        StandardNormal.sample(random)
    }

    /// Unequal blocks of a straight line and its errors.
    fn blocks(errors: &DVector<f64>, sizes: &[usize]) -> Vec<Block> {
        let total: usize = sizes.iter().sum();
        let x = DMatrix::from_fn(total, 2, |i, j| {
            (i as f64 * 0.7).sin().powi(j as i32) + 0.02 * (i * j) as f64
        });
        let solution = x.clone().svd(true, true).solve(errors, 0.0).unwrap();
        let residual = errors - &x * solution;
        let mut at = 0;
        sizes
            .iter()
            .map(|n| {
                let block = Block {
                    name: format!("{at}"),
                    rows: x.rows(at, *n).into(),
                    residual: residual.rows(at, *n).into(),
                    variance: DVector::from_element(*n, 1.0),
                };
                at += n;
                block
            })
            .collect()
    }

    /// White errors: the mean of many estimated variances is the true one, and twice the squared mean over the variance
    /// of the estimates is the number of degrees of freedom.
    #[test]
    fn variance_is_unbiased_and_its_degrees_of_freedom_are_those_stated() {
        const SIZES: [usize; 6] = [3, 5, 2, 9, 4, 7];
        const RUNS: usize = 4000;
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let contrast = DVector::from_vec(vec![0.3, 1.0]);
        let (mut sum, mut squares, mut truth, mut stated) = (0.0, 0.0, 0.0, 0.0);
        for _ in 0..RUNS {
            let errors = DVector::from_fn(30, |_, _| normal(&mut random));
            let design = Design::new(blocks(&errors, &SIZES)).unwrap();
            let along = design.contributions().transpose() * &contrast;
            let variance = along.norm_squared();
            sum += variance;
            squares += variance * variance;
            truth = contrast.dot(&(&design.inverse * &contrast));
            stated = design.degrees_of_freedom(&contrast);
        }
        let mean = sum / RUNS as f64;
        let spread = squares / RUNS as f64 - mean * mean;
        // standard error of the mean: √(2/ν/4000) = 1.2 % for ν near 3.5
        assert!((mean / truth - 1.0).abs() < 0.05, "{mean} {truth}");
        let found = 2.0 * mean * mean / spread;
        // kurtosis of a squared normal: the variance of 4000 estimates is good to about 8 %
        assert!((found / stated - 1.0).abs() < 0.2, "{found} {stated}");
    }

    /// Leaving a block out by its weight is the fit without it.
    #[test]
    fn a_weight_of_zero_leaves_a_block_out() {
        let mut random = ChaCha8Rng::seed_from_u64(2);
        let errors = DVector::from_fn(20, |_, _| normal(&mut random));
        let all = blocks(&errors, &[5, 7, 8]);
        let design = Design::new(all.clone()).unwrap();
        let step = design.reweighted(&[1.0, 0.0, 1.0]).unwrap();
        let x = DMatrix::from_fn(13, 2, |i, j| {
            if i < 5 {
                all[0].rows[(i, j)]
            } else {
                all[2].rows[(i - 5, j)]
            }
        });
        let b = DVector::from_fn(13, |i, _| {
            if i < 5 {
                all[0].residual[i]
            } else {
                all[2].residual[i - 5]
            }
        });
        let direct = x.svd(true, true).solve(&b, 0.0).unwrap();
        assert!((step - direct).amax() < 1e-12);
        assert!(design.reweighted(&[1.0; 3]).unwrap().amax() < 1e-12);
    }
}
