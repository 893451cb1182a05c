//! A product of matrix and vector for small matrices that are used often.

use super::lanes::{FourLanes, LANES, OnLanes, on_lanes};
use nalgebra::DMatrix;
use pulp::f64x4;

/// States smaller than this have died out. Numbers below 1e-308 are computed thirty times slower; products with the
/// coefficients of a step stay above.
const DIED_OUT: f64 = 1e-250;

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
    pub(super) fn new(matrix: &DMatrix<f64>) -> Self {
        let (rows, columns) = matrix.shape();
        let entries = matrix.as_slice();
        let group = |group: usize, j: usize| -> [f64; LANES] {
            let rest = &entries[j * rows + group * LANES..(j + 1) * rows];
            std::array::from_fn(|lane| rest.get(lane).copied().unwrap_or(0.0))
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

    fn numbers(&self) -> [&[f64]; 2] {
        [
            self.blocks.as_flattened().as_flattened(),
            self.rest.as_flattened(),
        ]
    }

    /// [`apply`] within what already runs on vectors, each group of rows through `finish`.
    #[inline(always)]
    pub(super) fn set<S: FourLanes>(
        &self,
        simd: S,
        v: &[f64],
        y: &mut [f64],
        mut finish: impl FnMut(f64x4) -> f64x4,
    ) {
        let y = &mut y[..self.rows];
        if y.len() > 2 * LANES && y.len() <= (GROUPS + 1) * LANES && v.len() <= FEW_COLUMNS {
            // most sections, without a loop, whose needs would lie in the way
            let y = set_groups(simd, &self.blocks, v, y, &mut finish);
            if !y.is_empty() {
                set_groups(simd, self.rest.as_chunks::<1>().0, v, y, &mut finish);
            }
            return;
        }
        let (mut blocks, mut y) = (self.blocks.as_slice(), y);
        while y.len() > 2 * LANES {
            let (own, others) = blocks.split_at(self.columns);
            y = if v.len() > FEW_COLUMNS {
                let own = &own[..v.len()];
                // one after the other: so many columns wait for the matrix, not for the vector
                let groups = std::array::from_fn::<_, GROUPS, _>(|g| sums(simd, own, g, v));
                write(y, groups.map(|[group]| group), &mut finish)
            } else {
                set_groups(simd, own, v, y, &mut finish)
            };
            blocks = others;
        }
        if y.len() > LANES {
            set_groups(simd, self.rest.as_chunks::<2>().0, v, y, &mut finish);
        } else if !y.is_empty() {
            set_groups(simd, self.rest.as_chunks::<1>().0, v, y, &mut finish);
        }
    }
}

crate::vectorised! {
    /// `sum` becomes `Σ Wₖ xᵏ`, all of one shape.
    pub(super) fn set_polynomial<'a>(sum: &'a mut Packed, powers: &'a [Packed], x: f64) -> () {
        let lists = [
            sum.blocks.as_flattened_mut().as_flattened_mut(),
            sum.rest.as_flattened_mut(),
        ];
        for (list, sums) in lists.into_iter().enumerate() {
            let (fours, rest) = sums.as_chunks_mut::<{ 4 * LANES }>();
            let behind = 4 * LANES * fours.len();
            for (i, sums) in fours.iter_mut().enumerate() {
                let of = |w: &Packed| w.numbers()[list].as_chunks().0[i];
                *sums = polynomial(powers.iter().rev().map(of), x);
            }
            for (i, sums) in rest.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
                let of = |w: &Packed| w.numbers()[list][behind..].as_chunks().0[i];
                *sums = polynomial(powers.iter().rev().map(of), x);
            }
        }
    }
}

/// `Σ wₖ xᵏ` from the highest power on, in registers.
#[inline(always)]
fn polynomial<const N: usize>(powers: impl Iterator<Item = [f64; N]>, x: f64) -> [f64; N] {
    powers.fold([0.0; N], |sum, w| {
        std::array::from_fn(|i| w[i] + x * sum[i])
    })
}

/// Sums that run side by side, so that no addition waits for the one before it.
const PARTIAL_SUMS: usize = 4;

/// `y = W v` over the first `v.len()` columns, which may be fewer than `W` has.
///
/// Lanes and partial sums are added in one order on every processor: whatever vectors it has, the bits are the same.
#[inline]
pub(super) fn apply(w: &Packed, v: &[f64], y: &mut [f64]) {
    on_lanes(Apply { w, v, y });
}

/// [`apply`] to a state: what has died out becomes zero; returns whether the new state is finite, and the sum of its magnitudes.
#[inline]
pub(super) fn advanced(w: &Packed, v: &[f64], y: &mut [f64]) -> bool {
    on_lanes(Advance(Apply { w, v, y }))
}

struct Apply<'a> {
    w: &'a Packed,
    v: &'a [f64],
    y: &'a mut [f64],
}

struct Advance<'a>(Apply<'a>);

impl OnLanes for Apply<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: FourLanes>(self, simd: S) {
        self.w.set(simd, self.v, self.y, |x| x);
    }
}

impl OnLanes for Advance<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<S: FourLanes>(self, simd: S) -> bool {
        let Apply { w, v, y } = self.0;
        let (zero, least) = (simd.splat_f64s(0.0), simd.splat_f64s(DIED_OUT));
        let mut total = zero;
        w.set(simd, v, y, |x| {
            let size = simd.abs_f64s(x);
            total = simd.add_f64s(total, size);
            simd.and_f64s(x, pulp::cast(simd.less_than_or_equal_f64s(least, size)))
        });
        simd.reduce_sum_f64s(total).is_finite()
    }
}

/// Sums of `N` groups of rows, finished and written; returns the rows behind them.
#[inline(always)]
fn set_groups<'a, S: FourLanes, const N: usize>(
    simd: S,
    columns: &[[[f64; LANES]; N]],
    v: &[f64],
    y: &'a mut [f64],
    finish: &mut impl FnMut(f64x4) -> f64x4,
) -> &'a mut [f64] {
    write(y, sums::<S, N, N>(simd, &columns[..v.len()], 0, v), finish)
}

/// Finishes and writes groups of rows of which the last may hold more; returns the rows behind them.
#[inline(always)]
fn write<'a, const N: usize>(
    rows: &'a mut [f64],
    groups: [f64x4; N],
    finish: &mut impl FnMut(f64x4) -> f64x4,
) -> &'a mut [f64] {
    if rows.len() >= N * LANES {
        let (rows, behind) = rows.split_at_mut(N * LANES);
        let rows = rows.as_chunks_mut::<LANES>().0;
        for group in 0..N {
            rows[group] = pulp::cast(finish(groups[group]));
        }
        return behind;
    }
    for (rows, group) in rows.chunks_mut(LANES).zip(groups) {
        let group: [f64; LANES] = pulp::cast(finish(group));
        // lane by lane: so few are no copy of memory
        for (lane, sum) in group.into_iter().enumerate() {
            if let Some(row) = rows.get_mut(lane) {
                *row = sum;
            }
        }
    }
    &mut []
}

/// The sums of `M` of `N` groups of rows, from group `first` on.
#[inline(always)]
fn sums<S: FourLanes, const N: usize, const M: usize>(
    simd: S,
    columns: &[[[f64; LANES]; N]],
    first: usize,
    v: &[f64],
) -> [f64x4; M] {
    let product = |column: &[[f64; LANES]; N], x: f64, group: usize| {
        simd.mul_f64s(pulp::cast(column[first + group]), simd.splat_f64s(x))
    };
    let add = |sum: &mut [f64x4; M], column: &[[f64; LANES]; N], x: f64| {
        for (group, sum) in sum.iter_mut().enumerate() {
            *sum = simd.add_f64s(*sum, product(column, x, group));
        }
    };
    let (mut four_columns, last) = columns.as_chunks::<PARTIAL_SUMS>();
    let (mut fours, rest) = v.as_chunks::<PARTIAL_SUMS>();
    let mut sums = [[simd.splat_f64s(0.0); M]; PARTIAL_SUMS];
    if let ([four, columns @ ..], [x, values @ ..]) = (four_columns, fours) {
        // added to zero are only as many as it takes for no sum to be -0
        add(&mut sums[0], &four[0], x[0]);
        for part in 1..PARTIAL_SUMS {
            for (group, sum) in sums[part].iter_mut().enumerate() {
                *sum = product(&four[part], x[part], group);
            }
        }
        (four_columns, fours) = (columns, values);
    }
    for (four, x) in four_columns.iter().zip(fours) {
        for part in 0..PARTIAL_SUMS {
            add(&mut sums[part], &four[part], x[part]);
        }
    }
    // one after the other, not by a number that only the run knows: sums stay in registers
    if let ([column, ..], [x, ..]) = (last, rest) {
        add(&mut sums[0], column, *x);
    }
    if let ([_, column, ..], [_, x, ..]) = (last, rest) {
        add(&mut sums[1], column, *x);
    }
    if let ([_, _, column, ..], [_, _, x, ..]) = (last, rest) {
        add(&mut sums[2], column, *x);
    }
    let [mut a, b, c, d] = sums;
    for group in 0..M {
        let halves = [(a[group], b[group]), (c[group], d[group])];
        let [ab, cd] = halves.map(|(x, y)| simd.add_f64s(x, y));
        a[group] = simd.add_f64s(ab, cd);
    }
    a
}

/// Whether all values are finite; those that have died out become zero. Without a branch: this is part of every step.
pub(super) fn flush_subnormals(values: &mut [f64]) -> bool {
    let mut spoilt = 0.0;
    for x in values {
        // stays zero as long as all are finite
        spoilt += 0.0 * *x;
        *x = if x.abs() < DIED_OUT { 0.0 } else { *x };
    }
    spoilt == 0.0
}

/// Largest magnitude; what is no number counts nothing.
#[inline(always)]
pub(super) fn largest_of(values: &[f64]) -> f64 {
    let larger = |largest: f64, x: &f64| if x.abs() > largest { x.abs() } else { largest };
    let (groups, rest) = values.as_chunks::<LANES>();
    let mut lanes = [0.0; LANES];
    for group in groups {
        lanes = std::array::from_fn(|lane| larger(lanes[lane], &group[lane]));
    }
    let largest = if groups.is_empty() {
        0.0
    } else {
        lanes.iter().fold(0.0, larger)
    };
    rest.iter().fold(largest, larger)
}

#[cfg(test)]
mod tests;
