//! Products and steps against the plain sums of their rows.

use super::*;
use crate::response::lanes::on_plain_numbers;

/// One row of `W v` in the order of the partial sums.
fn row(w: &DMatrix<f64>, i: usize, v: &[f64]) -> f64 {
    let mut sums = [0.0; PARTIAL_SUMS];
    for (j, x) in v.iter().enumerate() {
        sums[j % PARTIAL_SUMS] += w[(i, j)] * x;
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

#[test]
fn products_of_every_shape_have_the_bits_of_their_rows_whatever_the_vectors() {
    for (rows, columns) in
        (0..28).flat_map(|rows| (1..15).chain([64, 65, 71]).map(move |c| (rows, c)))
    {
        let w = DMatrix::from_fn(rows, columns, |i, j| {
            (3.7 * i as f64 + 1.3 * j as f64).sin()
        });
        let packed = Packed::new(&w);
        let v: Vec<f64> = (0..columns).map(|j| (0.7 * j as f64).cos()).collect();
        for v in [&v[..], &v[..columns / 2], &vec![0.0; columns]] {
            let expected: Vec<_> = (0..rows).map(|i| row(&w, i, v)).collect();
            let (mut wide, mut plain) = (vec![9.0; rows + 1], vec![9.0; rows + 1]);
            apply(&packed, v, &mut wide);
            let (w, y) = (&packed, &mut plain[..]);
            on_plain_numbers(Apply { w, v, y });
            for y in [&wide, &plain] {
                let bits = |y: &[f64]| y.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
                assert_eq!(bits(&y[..rows]), bits(&expected), "{rows} by {columns}");
                assert_eq!(y[rows], 9.0, "{rows} by {columns}");
            }
        }
    }
}

#[test]
fn what_has_died_out_is_zero_and_what_has_outgrown_numbers_is_said_in_every_row() {
    let by_vectors = |w: &Packed, v: &[f64], y: &mut [f64]| advanced(w, v, y);
    let by_plain_numbers =
        |w: &Packed, v: &[f64], y: &mut [f64]| on_plain_numbers(Advance(Apply { w, v, y }));
    for rows in 1..28 {
        for spoilt in 0..rows {
            for advanced in [by_vectors, by_plain_numbers] {
                let unit = Packed::new(&DMatrix::identity(rows, rows));
                let (mut v, mut y) = (vec![1e-260; rows], vec![9.0; rows]);
                v[spoilt] = 1e-240;
                assert!(advanced(&unit, &v, &mut y));
                let alive = |row| if row == spoilt { 1e-240 } else { 0.0 };
                assert_eq!(y, (0..rows).map(alive).collect::<Vec<_>>());
                for bad in [f64::INFINITY, f64::NAN] {
                    v[spoilt] = bad;
                    assert!(!advanced(&unit, &v, &mut y), "row {spoilt} of {rows}");
                }
            }
        }
    }
}
