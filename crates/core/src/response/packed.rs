//! A product of matrix and vector for small matrices that are used often.

use nalgebra::DMatrix;

/// States smaller than this have died out. Numbers below 1e-308 are computed thirty times slower; products with the
/// coefficients of a step stay above.
const DIED_OUT: f64 = 1e-250;

/// Rows are padded to whole groups of this many, so that the inner loop has a fixed length.
pub(super) const LANES: usize = 4;

/// Groups whose sums run at once: as many as the registers of a processor hold, so that every number of the vector is
/// fetched once for all of them.
const GROUPS: usize = 3;
/// Columns up to which they do: sums of more wait for the matrix, and not for the vector.
const FEW_COLUMNS: usize = 64;

/// A matrix stored for `y = W v`, in groups of rows.
#[derive(Debug, Clone)]
pub(super) struct Packed {
    pub rows: usize,
    columns: usize,
    /// For each block of `GROUPS` groups of `LANES` rows, the columns one after the other.
    blocks: Vec<[[f64; LANES]; GROUPS]>,
    /// The same for the one or two groups behind them.
    rest: Vec<[f64; LANES]>,
}

impl Packed {
    pub(super) fn new(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> f64) -> Self {
        let group = |group: usize, j: usize| -> [f64; LANES] {
            std::array::from_fn(|lane| {
                let i = group * LANES + lane;
                if i < rows { entry(i, j) } else { 0.0 }
            })
        };
        let groups = rows.div_ceil(LANES);
        let first_of_rest = groups - groups % GROUPS;
        let mut blocks = Vec::with_capacity(groups / GROUPS * columns);
        for first in (0..first_of_rest).step_by(GROUPS) {
            let column = |j| std::array::from_fn(|of_block| group(first + of_block, j));
            blocks.extend((0..columns).map(column));
        }
        let behind = |j| (first_of_rest..groups).map(move |g| (g, j));
        let rest = (0..columns).flat_map(behind);
        Self {
            rows,
            columns,
            blocks,
            rest: rest.map(|(g, j)| group(g, j)).collect(),
        }
    }

    /// A whole matrix.
    pub(super) fn of(m: &DMatrix<f64>) -> Self {
        Self::new(m.nrows(), m.ncols(), |i, j| m[(i, j)])
    }

    /// Becomes `Σ Wₖ xᵏ`, all of one shape.
    #[inline(never)]
    pub(super) fn set_polynomial(&mut self, powers: &[Self], x: f64) {
        with_vectors(|| self.horner(powers, x));
    }

    #[inline(always)]
    fn horner(&mut self, powers: &[Self], x: f64) {
        let (blocks, rest) = (&mut self.blocks, &mut self.rest);
        let lists = [
            blocks.as_flattened_mut().as_flattened_mut(),
            rest.as_flattened_mut(),
        ];
        for (list, sums) in lists.into_iter().enumerate() {
            sums.fill(0.0);
            for power in powers.iter().rev() {
                for (sum, w) in sums.iter_mut().zip(power.numbers()[list]) {
                    *sum = w + x * *sum;
                }
            }
        }
    }

    fn numbers(&self) -> [&[f64]; 2] {
        [
            self.blocks.as_flattened().as_flattened(),
            self.rest.as_flattened(),
        ]
    }

    /// [`apply`] within what already runs on the widest vectors.
    #[inline(always)]
    pub(super) fn set(&self, v: &[f64], y: &mut [f64]) {
        product(self, v, y, |sums| sums);
    }
}

/// Sums that run side by side, so that no addition waits for the one before it.
const PARTIAL_SUMS: usize = 4;

/// `y = W v` over the first `v.len()` columns, which may be fewer than `W` has.
///
/// Lanes and partial sums are added in one order on every processor: whatever vectors it has, the bits are the same.
// `inline` here and in what calls it: compiled with the crate of the unit, whose optimisation at link time keeps the sums in registers.
// Compiled with this one they lie on the stack, and a step takes 1300 instructions instead of 600.
#[inline]
pub(super) fn apply(w: &Packed, v: &[f64], y: &mut [f64]) {
    with_vectors(Apply { w, v, y });
}

/// [`apply`] to a state: what has died out becomes zero; returns whether all of the new state is finite.
#[inline]
pub(super) fn advanced(w: &Packed, v: &[f64], y: &mut [f64]) -> bool {
    with_vectors(Advance(Apply { w, v, y }))
}

/// Runs a product on vectors of four numbers where this processor has them: wider ones are no faster for so few.
#[inline(always)]
pub(super) fn with_vectors<P: pulp::NullaryFnOnce>(product: P) -> P::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(vectors) = pulp::x86::V3::try_new() {
        return vectors.vectorize(product);
    }
    with_baseline(product)
}

/// Apart, so that it takes no room where it is not used.
#[inline(never)]
fn with_baseline<P: pulp::NullaryFnOnce>(product: P) -> P::Output {
    product.call()
}

/// A product that is compiled for each set of vectors a processor may have.
struct Apply<'a> {
    w: &'a Packed,
    v: &'a [f64],
    y: &'a mut [f64],
}

struct Advance<'a>(Apply<'a>);

impl pulp::NullaryFnOnce for Apply<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.w.set(self.v, self.y);
    }
}

impl pulp::NullaryFnOnce for Advance<'_> {
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        let Apply { w, v, y } = self.0;
        let mut spoilt = [0.0; LANES];
        product(w, v, y, |sums| {
            std::array::from_fn(|lane| settle(sums[lane], &mut spoilt[lane]))
        });
        spoilt == [0.0; LANES]
    }
}

/// `y = W v`, each group of rows through `finish`.
#[inline(always)]
fn product(
    w: &Packed,
    v: &[f64],
    y: &mut [f64],
    mut finish: impl FnMut([f64; LANES]) -> [f64; LANES],
) {
    let (mut blocks, mut y) = (w.blocks.as_slice(), &mut y[..w.rows]);
    while y.len() > 2 * LANES {
        let (own, others) = blocks.split_at(w.columns);
        let groups = if v.len() > FEW_COLUMNS {
            one_by_one(&own[..v.len()], v)
        } else {
            sums(&own[..v.len()], v)
        };
        let groups = groups.map(&mut finish);
        (blocks, y) = (others, write(y, groups));
    }
    if y.len() > LANES {
        write(
            y,
            sums(&w.rest.as_chunks::<2>().0[..v.len()], v).map(finish),
        );
    } else if !y.is_empty() {
        write(
            y,
            sums(&w.rest.as_chunks::<1>().0[..v.len()], v).map(finish),
        );
    }
}

/// Writes groups of rows of which the last may hold more; returns the rows behind them.
#[inline(always)]
fn write<const N: usize>(rows: &mut [f64], groups: [[f64; LANES]; N]) -> &mut [f64] {
    if rows.len() >= N * LANES {
        let (rows, behind) = rows.split_at_mut(N * LANES);
        for (rows, group) in rows.as_chunks_mut().0.iter_mut().zip(groups) {
            *rows = group;
        }
        return behind;
    }
    for (rows, group) in rows.chunks_mut(LANES).zip(groups) {
        // lane by lane: so few are no copy of memory
        for (lane, sum) in group.into_iter().enumerate() {
            if let Some(row) = rows.get_mut(lane) {
                *row = sum;
            }
        }
    }
    &mut []
}

/// The sums of `N` groups of rows.
#[inline(always)]
fn sums<const N: usize>(columns: &[[[f64; LANES]; N]], v: &[f64]) -> [[f64; LANES]; N] {
    let mut sums = [[[0.0; LANES]; N]; PARTIAL_SUMS];
    let (four_columns, last) = columns.as_chunks::<PARTIAL_SUMS>();
    let (fours, rest) = v.as_chunks::<PARTIAL_SUMS>();
    for (four, x) in four_columns.iter().zip(fours) {
        for part in 0..PARTIAL_SUMS {
            add(&mut sums[part], &four[part], x[part]);
        }
    }
    for (sum, (column, x)) in sums.iter_mut().zip(last.iter().zip(rest)) {
        add(sum, column, *x);
    }
    let [a, b, c, d] = sums;
    std::array::from_fn(|group| {
        let [a, b, c, d] = [a[group], b[group], c[group], d[group]];
        std::array::from_fn(|lane| (a[lane] + b[lane]) + (c[lane] + d[lane]))
    })
}

/// The same, one group after the other, in a function of its own: compiled into its callers, so many sums may lose their vectors.
#[inline(never)]
fn one_by_one<const N: usize>(columns: &[[[f64; LANES]; N]], v: &[f64]) -> [[f64; LANES]; N] {
    with_vectors(OneByOne { columns, v })
}

struct OneByOne<'a, const N: usize> {
    columns: &'a [[[f64; LANES]; N]],
    v: &'a [f64],
}

impl<const N: usize> pulp::NullaryFnOnce for OneByOne<'_, N> {
    type Output = [[f64; LANES]; N];

    #[inline(always)]
    fn call(self) -> Self::Output {
        let mut all = [[0.0; LANES]; N];
        for (group, all) in all.iter_mut().enumerate() {
            let mut sums = [[0.0; LANES]; PARTIAL_SUMS];
            let (four_columns, last) = self.columns.as_chunks::<PARTIAL_SUMS>();
            let (fours, rest) = self.v.as_chunks::<PARTIAL_SUMS>();
            for (four, x) in four_columns.iter().zip(fours) {
                for part in 0..PARTIAL_SUMS {
                    for lane in 0..LANES {
                        sums[part][lane] += four[part][group][lane] * x[part];
                    }
                }
            }
            for (sum, (column, x)) in sums.iter_mut().zip(last.iter().zip(rest)) {
                for lane in 0..LANES {
                    sum[lane] += column[group][lane] * x;
                }
            }
            let [a, b, c, d] = sums;
            for lane in 0..LANES {
                all[lane] = (a[lane] + b[lane]) + (c[lane] + d[lane]);
            }
        }
        all
    }
}

#[inline(always)]
fn add<const N: usize>(sum: &mut [[f64; LANES]; N], column: &[[f64; LANES]; N], x: f64) {
    for (sum, column) in sum.iter_mut().zip(column) {
        for lane in 0..LANES {
            sum[lane] += column[lane] * x;
        }
    }
}

/// `x`, or zero where it has died out; `spoilt` stays zero as long as all are finite. Without a branch: this is part of
/// every step.
#[inline(always)]
fn settle(x: f64, spoilt: &mut f64) -> f64 {
    *spoilt += 0.0 * x;
    if x.abs() < DIED_OUT { 0.0 } else { x }
}

/// Whether all values are finite; those that have died out become zero.
pub(super) fn settled(values: &mut [f64]) -> bool {
    let mut spoilt = 0.0;
    for x in values {
        *x = settle(*x, &mut spoilt);
    }
    spoilt == 0.0
}

/// Largest magnitude; what is no number counts nothing.
#[inline(always)]
pub(super) fn largest_of(values: &[f64]) -> f64 {
    let mut lanes = [0.0; LANES];
    let (groups, rest) = values.as_chunks::<LANES>();
    let larger = |largest: &mut f64, x: f64| {
        if x.abs() > *largest {
            *largest = x.abs();
        }
    };
    for group in groups {
        for (largest, x) in lanes.iter_mut().zip(group) {
            larger(largest, *x);
        }
    }
    let mut largest = 0.0;
    for x in lanes.iter().chain(rest) {
        larger(&mut largest, *x);
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;

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
            let packed = Packed::of(&w);
            let v: Vec<f64> = (0..columns).map(|j| (0.7 * j as f64).cos()).collect();
            for v in [&v[..], &v[..columns / 2]] {
                let expected: Vec<_> = (0..rows).map(|i| row(&w, i, v)).collect();
                let (mut wide, mut plain) = (vec![9.0; rows + 1], vec![9.0; rows + 1]);
                apply(&packed, v, &mut wide);
                let (w, y) = (&packed, &mut plain[..]);
                with_baseline(Apply { w, v, y });
                for y in [&wide, &plain] {
                    assert_eq!(&y[..rows], expected, "{rows} by {columns}");
                    assert_eq!(y[rows], 9.0, "{rows} by {columns}");
                }
            }
        }
    }

    #[test]
    fn what_has_died_out_is_zero_and_what_has_outgrown_numbers_is_said_in_every_row() {
        for rows in 1..28 {
            for spoilt in 0..rows {
                let unit = Packed::new(rows, rows, |i, j| f64::from(u8::from(i == j)));
                let (mut v, mut y) = (vec![1e-260; rows], vec![9.0; rows]);
                assert!(advanced(&unit, &v, &mut y));
                assert_eq!(y, vec![0.0; rows]);
                for bad in [f64::INFINITY, f64::NAN] {
                    v[spoilt] = bad;
                    assert!(!advanced(&unit, &v, &mut y), "row {spoilt} of {rows}");
                }
            }
        }
    }
}
