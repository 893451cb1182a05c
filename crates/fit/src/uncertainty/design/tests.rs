//! Unbiased variances and weights of blocks.

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
                speed_m_s: None,
                k: None,
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
        let design = Design::new(blocks(&errors, &SIZES), DMatrix::identity(2, 2)).unwrap();
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
    let design = Design::new(all.clone(), DMatrix::identity(2, 2)).unwrap();
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

/// Along a tangent the covariance is that of the fit in the coordinates of the tangent.
#[test]
fn a_tangent_is_the_fit_in_its_own_coordinates() {
    let mut random = ChaCha8Rng::seed_from_u64(9);
    let errors = DVector::from_fn(30, |_, _| normal(&mut random));
    let all = blocks(&errors, &[5, 7, 8, 10]);
    let tangent = DMatrix::from_column_slice(2, 1, &[0.6, -0.8]);
    let held = Design::new(all.clone(), tangent.clone()).unwrap();
    let inner = all.iter().map(|b| Block {
        rows: &b.rows * &tangent,
        ..b.clone()
    });
    let own = Design::new(inner.collect(), DMatrix::identity(1, 1)).unwrap();
    let expected = &tangent * own.contributions();
    assert!((held.contributions() - expected).amax() < 1e-12);
    let weights = [0.5, 2.0, 1.0, 0.3];
    let step = &tangent * own.reweighted(&weights).unwrap();
    assert!((held.reweighted(&weights).unwrap() - step).amax() < 1e-12);
    let contrast = DVector::from_vec(vec![1.0, 0.2]);
    let freedom = own.degrees_of_freedom(&tangent.tr_mul(&contrast));
    assert!((held.degrees_of_freedom(&contrast) - freedom).abs() < 1e-9);
}
