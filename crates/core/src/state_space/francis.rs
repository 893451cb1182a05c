//! Eigenvalues of a real Hessenberg matrix by Francis's double shift (Martin, Peters and Wilkinson 1970).
//!
//! The iteration of the linear-algebra library never ends on some of our matrices: it forms its first column as `h₁₁² − tr h₁₁ + det`,
//! which cancels to nothing beside equal eigenvalues, such as the lag states of several motions in nearly still air, and it has no
//! exceptional shifts. Here the column is divided by `h₂₁` before it is summed, and every tenth sweep takes another shift.

use nalgebra::{Complex, DMatrix};

/// Sweeps at most for a row of the matrix, exceptional shifts included; three are usual.
const MAX_SWEEPS_A_ROW: usize = 30;
/// Sweeps between two exceptional shifts.
const EXCEPTIONAL: usize = 10;

/// The trailing 2 × 2 block whose eigenvalues are the shifts: its diagonal `x`, `y` and the product `w` of the others.
type Shifts = [f64; 3];

/// Makes a matrix upper Hessenberg by elimination with pivots, which keeps its eigenvalues: half the work of reflections.
pub(super) fn reduce(a: &mut DMatrix<f64>) {
    let n = a.nrows();
    for k in 1..n.saturating_sub(1) {
        let pivot = k + a.column(k - 1).rows(k, n - k).iamax();
        a.swap_rows(k, pivot);
        a.swap_columns(k, pivot);
        let head = a[(k, k - 1)];
        if head == 0.0 {
            continue;
        }
        // the factors stand where the zeros will be
        let (before, columns) = a.as_mut_slice().split_at_mut(k * n);
        let factors = &mut before[(k - 1) * n + k + 1..];
        factors.iter_mut().for_each(|f| *f /= head);
        for column in columns.chunks_exact_mut(n) {
            let (above, below) = column.split_at_mut(k + 1);
            subtract(below, factors, above[k]);
        }
        let (column, others) = columns.split_at_mut(n);
        for (other, factor) in others.chunks_exact(n).zip(&*factors) {
            subtract(column, other, -factor);
        }
        factors.fill(0.0);
    }
}

/// `from −= factor what`.
fn subtract(from: &mut [f64], what: &[f64], factor: f64) {
    if factor != 0.0 {
        from.iter_mut()
            .zip(what)
            .for_each(|(x, w)| *x -= factor * w);
    }
}

/// Appends the eigenvalues of an upper Hessenberg matrix, which is spoilt; `None` when the iteration does not converge. Takes no
/// memory where there is room for them.
pub(super) fn append_eigenvalues(
    h: &mut DMatrix<f64>,
    found: &mut Vec<Complex<f64>>,
) -> Option<()> {
    let norm: f64 = h.iter().map(|x| x.abs()).sum();
    // what exceptional shifts took off the diagonal
    let mut taken = 0.0;
    let mut size = h.nrows();
    let mut left = MAX_SWEEPS_A_ROW * size;
    // for the eigenvalue at hand
    let mut sweeps = 0;
    while size > 0 {
        let last = size - 1;
        let first = deflate(h, last, norm);
        match size - first {
            1 => found.push(Complex::new(h[(last, last)] + taken, 0.0)),
            2 => found.extend(pair(h, last).map(|l| l + taken)),
            _ => {
                left = left.checked_sub(1)?;
                let exceptional = sweeps > 0 && sweeps % EXCEPTIONAL == 0;
                let shifts = if exceptional {
                    exceptional_shifts(h, last, &mut taken)
                } else {
                    trailing(h, last)
                };
                sweeps += 1;
                sweep(h, first, last, shifts);
                continue;
            }
        }
        size = first;
        sweeps = 0;
    }
    Some(())
}

/// First row of the block that ends at `last`: the subdiagonal entry before it is negligible, beside the diagonal and in what it
/// changes of the eigenvalues (Ahues and Tisseur 1997), which matters where rows differ in size.
fn deflate(h: &mut DMatrix<f64>, last: usize, norm: f64) -> usize {
    for l in (1..=last).rev() {
        let beside = h[(l - 1, l - 1)].abs() + h[(l, l)].abs();
        let scale = if beside > 0.0 { beside } else { norm };
        if h[(l, l - 1)].abs() <= f64::EPSILON * scale && changes_nothing(h, l) {
            h[(l, l - 1)] = 0.0;
            return l;
        }
    }
    0
}

/// Whether the entry before the diagonal of row `l` may be dropped without a change of the eigenvalues of its 2 × 2 block.
fn changes_nothing(h: &DMatrix<f64>, l: usize) -> bool {
    let sorted = |a: f64, b: f64| (a.abs().max(b.abs()), a.abs().min(b.abs()));
    let (beside, least) = sorted(h[(l, l - 1)], h[(l - 1, l)]);
    let (apart, below) = sorted(h[(l, l)], h[(l - 1, l - 1)] - h[(l, l)]);
    let sum = beside + apart;
    sum == 0.0
        || least * (beside / sum) <= (f64::EPSILON * below * (apart / sum)).max(f64::MIN_POSITIVE)
}

fn trailing(h: &DMatrix<f64>, last: usize) -> Shifts {
    let w = h[(last, last - 1)] * h[(last - 1, last)];
    [h[(last, last)], h[(last - 1, last - 1)], w]
}

/// Eigenvalues of the 2 × 2 block that ends at `last`.
fn pair(h: &DMatrix<f64>, last: usize) -> [Complex<f64>; 2] {
    let [x, y, w] = trailing(h, last);
    let p = 0.5 * (y - x);
    let q = p * p + w;
    if q < 0.0 {
        let z = Complex::new(x + p, (-q).sqrt());
        return [z, z.conj()];
    }
    let z = p + q.sqrt().copysign(p);
    let other = if z == 0.0 { x } else { x - w / z };
    [Complex::new(x + z, 0.0), Complex::new(other, 0.0)]
}

fn exceptional_shifts(h: &mut DMatrix<f64>, last: usize, taken: &mut f64) -> Shifts {
    let x = h[(last, last)];
    *taken += x;
    for i in 0..=last {
        h[(i, i)] -= x;
    }
    let s = h[(last, last - 1)].abs() + h[(last - 1, last - 2)].abs();
    [0.75 * s, 0.75 * s, -0.4375 * s * s]
}

/// First row of the sweep, between `first` and `last − 2`, and the first column of the double shift there, up to scale.
fn start(h: &DMatrix<f64>, first: usize, last: usize, [x, y, w]: Shifts) -> (usize, [f64; 3]) {
    let mut m = last - 2;
    loop {
        let z = h[(m, m)];
        let (r, s) = (x - z, y - z);
        let column = [
            (r * s - w) / h[(m + 1, m)] + h[(m, m + 1)],
            h[(m + 1, m + 1)] - z - r - s,
            h[(m + 2, m + 1)],
        ];
        let scale: f64 = column.iter().map(|c| c.abs()).sum();
        let column = column.map(|c| if scale > 0.0 { c / scale } else { c });
        if m == first {
            return (m, column);
        }
        // two small subdiagonal entries in a row: the sweep may start between them
        let beside = h[(m - 1, m - 1)].abs() + z.abs() + h[(m + 1, m + 1)].abs();
        let left = h[(m, m - 1)].abs() * (column[1].abs() + column[2].abs());
        if left <= f64::EPSILON * column[0].abs() * beside {
            return (m, column);
        }
        m -= 1;
    }
}

/// One double QR sweep over the rows `first..=last`.
fn sweep(h: &mut DMatrix<f64>, first: usize, last: usize, shifts: Shifts) {
    let (m, mut column) = start(h, first, last, shifts);
    for i in m + 2..=last {
        h[(i, i - 2)] = 0.0;
        if i > m + 2 {
            h[(i, i - 3)] = 0.0;
        }
    }
    for k in m..last {
        let rows = if k + 1 < last { 3 } else { 2 };
        let mut scale = 1.0;
        if k > m {
            column = std::array::from_fn(|i| if i < rows { h[(k + i, k - 1)] } else { 0.0 });
            scale = column.iter().map(|c| c.abs()).sum();
            if scale == 0.0 {
                continue;
            }
            column = column.map(|c| c / scale);
        }
        let norm = column.iter().map(|c| c * c).sum::<f64>().sqrt();
        let s = norm.copysign(column[0]);
        if s == 0.0 {
            continue;
        }
        if k > m {
            h[(k, k - 1)] = -s * scale;
            // the others of the column are reflected to zero
            (1..rows).for_each(|i| h[(k + i, k - 1)] = 0.0);
        } else if first < m {
            h[(k, k - 1)] = -h[(k, k - 1)];
        }
        reflect(h, k, rows, last, first, s, column);
    }
}

/// Householder reflection of `column` to `−s e₁`, from both sides; of two rows where the third is none.
fn reflect(
    h: &mut DMatrix<f64>,
    k: usize,
    rows: usize,
    last: usize,
    first: usize,
    s: f64,
    column: [f64; 3],
) {
    let head = column[0] + s;
    let left = [head / s, column[1] / s, column[2] / s];
    let right = [1.0, column[1] / head, column[2] / head];
    let n = h.nrows();
    let entries = h.as_mut_slice();
    for column in entries[k * n..(last + 1) * n].chunks_exact_mut(n) {
        let block = &mut column[k..k + rows];
        let p: f64 = block.iter().zip(right).map(|(x, r)| x * r).sum();
        block.iter_mut().zip(left).for_each(|(x, l)| *x -= p * l);
    }
    let seen = first..=(k + 3).min(last);
    let (one, others) = entries[k * n..(k + rows) * n].split_at_mut(n);
    let (two, three) = others.split_at_mut(n);
    let one = one[seen.clone()].iter_mut();
    let pairs = one.zip(&mut two[seen.clone()]);
    if three.is_empty() {
        for (x, y) in pairs {
            let p = left[0] * *x + left[1] * *y;
            *x -= p;
            *y -= p * right[1];
        }
    } else {
        for ((x, y), z) in pairs.zip(&mut three[seen]) {
            let p = left[0] * *x + left[1] * *y + left[2] * *z;
            *x -= p;
            *y -= p * right[1];
            *z -= p * right[2];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Hessenberg;

    /// Every value found is an exact eigenvalue of a matrix that differs by rounding.
    fn check(a: &DMatrix<f64>) {
        let mut found = Vec::new();
        let mut reduced = a.clone();
        reduce(&mut reduced);
        append_eigenvalues(&mut reduced, &mut found).unwrap();
        judge(a, found);
        // by reflections, another way
        let mut found = Vec::new();
        append_eigenvalues(&mut Hessenberg::new(a.clone()).unpack_h(), &mut found).unwrap();
        judge(a, found);
    }

    fn judge(a: &DMatrix<f64>, found: Vec<Complex<f64>>) {
        let n = a.nrows();
        assert_eq!(found.len(), n);
        for l in &found {
            let less = a.map(|x| Complex::new(x, 0.0)) - DMatrix::identity(n, n) * *l;
            let smallest = less.singular_values().min();
            assert!(smallest < 1e-14 * a.norm() * n as f64, "{l}: {smallest:e}");
        }
        let sum: Complex<f64> = found.iter().sum();
        assert!((sum.re - a.trace()).abs() < 1e-13 * a.norm() * n as f64);
        assert!(sum.im.abs() < 1e-13 * a.norm() * n as f64);
    }

    /// All eigenvalues on a circle about zero: without exceptional shifts nothing moves.
    #[test]
    fn cyclic_matrices() {
        for n in 3..12 {
            check(&DMatrix::from_fn(n, n, |i, j| {
                f64::from(u8::from(i == (j + 1) % n))
            }));
        }
    }

    /// Three motions in nearly still air with two lags each: the lag poles are three times the same, coupled by next to nothing.
    #[test]
    fn equal_poles_that_hardly_touch() {
        for coupling in [0.0, 1e-10, 1e-8, 1e-6] {
            let mut a = DMatrix::<f64>::zeros(12, 12);
            for i in 0..3 {
                let mode = i as f64 + 1.0;
                a[(i, 3 + i)] = 1.0;
                a[(3 + i, i)] = -0.1 * mode * mode;
                a[(3 + i, 3 + i)] = -0.002 * mode;
                for (lag, pole) in [4.3e-5, 6.5e-4].into_iter().enumerate() {
                    let at = 6 + 3 * lag + i;
                    a[(at, i)] = pole;
                    a[(at, at)] = -pole;
                    for row in 3..6 {
                        a[(row, at)] = coupling * (1.0 + (row * at) as f64).sin();
                    }
                }
            }
            check(&a);
        }
    }

    #[test]
    fn matrices_without_a_pattern() {
        for n in [1, 2, 3, 7, 20, 40] {
            let mut state = n as u64;
            check(&DMatrix::from_fn(n, n, |_, _| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                (state >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
            }));
        }
    }
}
