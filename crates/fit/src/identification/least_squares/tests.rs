use super::*;

/// Deterministic numbers in (−1, 1).
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

fn system(rows: usize, columns: usize) -> (DMatrix<f64>, DMatrix<f64>) {
    let mut next = noise(7);
    let a = DMatrix::from_fn(rows, columns, |_, _| next());
    let b = DMatrix::from_fn(rows, 2, |i, m| a[(i, 0)] * (m as f64 + 1.0) + next());
    (a, b)
}

fn accumulated(a: &DMatrix<f64>, b: &DMatrix<f64>) -> Factor {
    let mut qr = StreamingQr::new(a.ncols(), b.ncols());
    for i in 0..a.nrows() {
        let row: Vec<f64> = a.row(i).iter().chain(b.row(i).iter()).copied().collect();
        qr.push_row(&row);
    }
    qr.finish()
}

/// Every nested solution against a singular value decomposition of the whole matrix.
#[test]
fn nested_solutions_match_a_dense_svd() {
    let (a, b) = system(1000, 6);
    let factor = accumulated(&a, &b);
    for leading in 1..=6 {
        let columns = a.columns(0, leading).into_owned();
        let dense = columns.clone().svd(true, true).solve(&b, 0.0).unwrap();
        let ours = factor.solve(leading).unwrap();
        assert!((&ours - &dense).amax() < 1e-12);
        for m in 0..2 {
            let residual = (b.column(m) - &columns * dense.column(m)).norm_squared();
            assert!((factor.residual_sum(leading, m) - residual).abs() < 1e-10 * residual);
        }
    }
    let two = factor.select(&[4, 1]);
    let some = DMatrix::from_columns(&[a.column(4), a.column(1)]);
    let dense = some.clone().svd(true, true).solve(&b, 0.0).unwrap();
    assert!((two.solve(2).unwrap() - &dense).amax() < 1e-12);
    let residual = (b.column(1) - &some * dense.column(1)).norm_squared();
    assert!((two.residual_sum(2, 1) / residual - 1.0).abs() < 1e-10);
    let gram = (a.transpose() * &a).try_inverse().unwrap();
    assert!((factor.inverse_gram(6).unwrap() - gram).amax() < 1e-12);
}

/// Rows in one go, as columns, and as two factors stacked: one answer.
#[test]
fn ways_of_stacking_agree() {
    let (a, b) = system(777, 4);
    let whole = accumulated(&a, &b);
    let mut by_columns = StreamingQr::new(4, 2);
    let all: Vec<Vec<f64>> = a
        .column_iter()
        .chain(b.column_iter())
        .map(|c| c.iter().copied().collect())
        .collect();
    let slices: Vec<&[f64]> = all.iter().map(Vec::as_slice).collect();
    by_columns.push_columns(&slices);
    let by_columns = by_columns.finish();
    let mut stacked = StreamingQr::new(4, 1);
    for (from, count) in [(0, 300), (300, 477)] {
        let part = accumulated(&a.rows(from, count).into(), &b.rows(from, count).into());
        stacked.absorb(&part, &[0, 1, 2, 3], 1, 1.0);
    }
    let stacked = stacked.finish();
    let expected = whole.solve(4).unwrap();
    assert!((by_columns.solve(4).unwrap() - &expected).amax() < 1e-13);
    assert!((stacked.solve(4).unwrap() - expected.column(1)).amax() < 1e-13);
    assert_eq!(stacked.rows, 777);
    assert!((stacked.residual_sum(4, 0) / whole.residual_sum(4, 1) - 1.0).abs() < 1e-12);
}

/// Columns 1e-9 and 1e9 in size are as well conditioned as columns of size one; a repeated column is found.
#[test]
fn scaling_is_no_rank_deficiency() {
    let (mut a, b) = system(400, 4);
    let before = accumulated(&a, &b).condition(4);
    a.column_mut(1).scale_mut(1e-9);
    a.column_mut(2).scale_mut(1e9);
    let scaled = accumulated(&a, &b);
    assert!((scaled.condition(4) / before - 1.0).abs() < 1e-9);
    assert_eq!(scaled.undetermined(4), None);
    let twice = a.column(0) * 3.0 + a.column(1);
    a.column_mut(3).copy_from(&twice);
    let deficient = accumulated(&a, &b);
    assert_eq!(deficient.undetermined(4), Some(3));
    assert!(deficient.solve(4).is_err() && deficient.solve(3).is_ok());
}
