//! Dynamic time warping with its path, in little memory.
//!
//! Cumulated cost of aligning `X₂[0..=i]` with `X₁[0..=j]`, steps of unit weight (Sakoe and Chiba 1978):
//! `D(i,j) = (X₂[i] − X₁[j])² + min{D(i−1,j), D(i,j−1), D(i−1,j−1)}`.
//! The cells `i + j = d` of an antidiagonal depend only on the two antidiagonals before, so they are computed
//! together. Pairs of antidiagonals are kept at intervals; the path is followed back from one to the next by
//! recomputing only the triangle of cells that can lie on it. The path is the one the full matrix would give, to
//! the last tie: the values are the same numbers.

use crate::error::{Error, Result, ensure};

/// Antidiagonals between those kept. At 20 000 × 20 000 samples these take 13 MB and a triangle 0.3 MB.
const INTERVAL: usize = 512;

/// Cheapest alignment of two signals.
#[derive(Debug, Clone, PartialEq)]
pub struct WarpingPath {
    /// Sum of the squared differences along the path, `D` of the last cell (unit of the signals squared).
    pub distance: f64,
    /// Pairs (sample of the compared signal, sample of the reference) from first to last.
    pub cells: Vec<(usize, usize)>,
    /// Whether the path touches the band, so that a wider one may give a cheaper path.
    pub band_binds: bool,
}

/// Warps `compared` (rows) onto `reference` (columns), optionally only where `|row − column| ≤ band`.
///
/// Ties are resolved from the end, in the order row − 1, column − 1, diagonal. Without a band the path is the
/// global optimum. A path inside its band without touching it ([`WarpingPath::band_binds`] false) is the best of
/// the band; only the run without a band proves that no other is cheaper.
/// Time grows with the number of cells, memory with `(n + m) min(n, m)/512`.
///
/// # Errors
/// [`Error::Input`] if a signal is empty or the band does not reach the last cell; [`Error::Numerical`] if the
/// cost is not finite.
pub fn warping_path(
    compared: &[f64],
    reference: &[f64],
    band: Option<usize>,
) -> Result<WarpingPath> {
    ensure(
        !compared.is_empty() && !reference.is_empty(),
        "signals to be warped",
        "at least one sample each",
        format_args!("{} and {} samples", compared.len(), reference.len()),
    )?;
    let excess = compared.len().abs_diff(reference.len());
    let width = band.unwrap_or(usize::MAX);
    let expected = format_args!("at least {excess}, the difference of the lengths");
    ensure(width >= excess, "warping band, samples", expected, width)?;
    CostMatrix::new(compared, reference, band).path(INTERVAL)
}

/// The cost matrix, never formed.
struct CostMatrix<'a> {
    rows: &'a [f64],
    /// Reference in reverse, so that an antidiagonal runs forward through both signals.
    reversed_columns: Vec<f64>,
    band: Option<isize>,
}

/// Values of one antidiagonal from its first row on; infinite elsewhere.
#[derive(Clone, Default)]
struct Antidiagonal {
    first_row: isize,
    values: Vec<f64>,
}

impl Antidiagonal {
    fn at(&self, row: isize) -> f64 {
        let place = usize::try_from(row - self.first_row).ok();
        let value = place.and_then(|k| self.values.get(k).copied());
        value.unwrap_or(f64::INFINITY)
    }
}

/// The number of an antidiagonal, that antidiagonal, and the one before it.
type Checkpoint = (isize, [Antidiagonal; 2]);

/// From a cell to the one before it on the path: how many rows and how many antidiagonals back.
type Step = [u8; 2];

/// Cheapest predecessor and the step to it; the first of equal ones.
fn cheapest(row: f64, column: f64, diagonal: f64) -> (f64, Step) {
    let mut best = (row, [1, 1]);
    if column < best.0 {
        best = (column, [0, 1]);
    }
    if diagonal < best.0 {
        best = (diagonal, [1, 2]);
    }
    best
}

impl<'a> CostMatrix<'a> {
    fn new(rows: &'a [f64], columns: &[f64], band: Option<usize>) -> Self {
        Self {
            rows,
            reversed_columns: columns.iter().rev().copied().collect(),
            band: band.map(|r| r.min(rows.len() + columns.len()) as isize),
        }
    }

    fn row_count(&self) -> isize {
        self.rows.len() as isize
    }

    fn column_count(&self) -> isize {
        self.reversed_columns.len() as isize
    }

    fn last_diagonal(&self) -> isize {
        self.row_count() + self.column_count() - 2
    }

    /// First and last row of antidiagonal `d` (last < first if the band leaves none).
    fn row_range(&self, d: isize) -> (isize, isize) {
        let mut first = (d - (self.column_count() - 1)).max(0);
        let mut last = (self.row_count() - 1).min(d);
        if let Some(r) = self.band {
            // |row − column| = |2 row − d| ≤ r
            first = first.max((d - r + 1).div_euclid(2));
            last = last.min((d + r).div_euclid(2));
        }
        (first, last)
    }

    fn cost(&self, row: isize, d: isize) -> f64 {
        let column = (self.column_count() - 1 - d + row) as usize;
        let difference = self.rows[row as usize] - self.reversed_columns[column];
        difference * difference
    }

    fn path(&self, interval: usize) -> Result<WarpingPath> {
        let (distance, checkpoints) = self.sweep(interval as isize);
        if !distance.is_finite() {
            let what = "the cost of warping is too large for double precision";
            return Err(Error::Numerical(what.into()));
        }
        let cells = self.backtrack(checkpoints);
        let touches = |r| cells.iter().any(|&(i, j)| i.abs_diff(j) as isize == r);
        Ok(WarpingPath {
            distance,
            band_binds: self.band.is_some_and(touches),
            cells,
        })
    }

    /// All antidiagonals in turn: cost of the last cell, and the ones kept for the way back.
    fn sweep(&self, interval: isize) -> (f64, Vec<Checkpoint>) {
        // Row i stands at index i + 1; the cells beside the range hold infinity, so that no step leaves it.
        let size = self.rows.len() + 2;
        let [mut before, mut last, mut now] = [(); 3].map(|()| vec![f64::INFINITY; size]);
        last[1] = self.cost(0, 0);
        let mut checkpoints = vec![self.checkpoint(0, &last, &before)];
        for d in 1..=self.last_diagonal() {
            self.advance(d, &before, &last, &mut now);
            std::mem::swap(&mut before, &mut last);
            std::mem::swap(&mut last, &mut now);
            if d % interval == 0 && d < self.last_diagonal() {
                checkpoints.push(self.checkpoint(d, &last, &before));
            }
        }
        (last[self.rows.len()], checkpoints)
    }

    fn advance(&self, d: isize, before: &[f64], last: &[f64], now: &mut [f64]) {
        let (first, end) = self.row_range(d);
        let (from, to) = (first as usize, (end + 1) as usize);
        now[from] = f64::INFINITY;
        now[to + 1] = f64::INFINITY;
        if from >= to {
            return;
        }
        let shift = self.column_count() - 1 - d;
        let columns = &self.reversed_columns[(first + shift) as usize..(end + 1 + shift) as usize];
        let cells = now[from + 1..=to].iter_mut();
        let above = &last[from..to];
        let left = &last[from + 1..=to];
        let corner = &before[from..to];
        let signals = self.rows[from..to].iter().zip(columns);
        let predecessors = above.iter().zip(left).zip(corner);
        for ((cell, (x, y)), ((&a, &l), &c)) in cells.zip(signals).zip(predecessors) {
            let difference = x - y;
            let single = if l < a { l } else { a };
            let least = if c < single { c } else { single };
            *cell = difference * difference + least;
        }
    }

    fn checkpoint(&self, index: isize, last: &[f64], before: &[f64]) -> Checkpoint {
        let keep = |d: isize, buffer: &[f64]| {
            if d < 0 {
                return Antidiagonal::default();
            }
            let (first_row, end) = self.row_range(d);
            let values = (first_row..=end).map(|row| buffer[row as usize + 1]);
            let values = values.collect();
            Antidiagonal { first_row, values }
        };
        (index, [keep(index, last), keep(index - 1, before)])
    }

    /// The path, from the last cell back through one checkpoint after the other.
    fn backtrack(&self, mut checkpoints: Vec<Checkpoint>) -> Vec<(usize, usize)> {
        let mut row = self.row_count() - 1;
        let mut d = self.last_diagonal();
        let mut cells = vec![(row as usize, (d - row) as usize)];
        while let Some(checkpoint) = checkpoints.pop() {
            let base = checkpoint.0;
            if base >= d {
                continue;
            }
            let steps = self.steps(checkpoint, row, d);
            while d > base {
                let (first_row, of_cells) = &steps[(d - base - 1) as usize];
                let [rows, diagonals] = of_cells[(row - first_row) as usize];
                (row, d) = (row - isize::from(rows), d - isize::from(diagonals));
                cells.push((row as usize, (d - row) as usize));
            }
        }
        cells.reverse();
        cells
    }

    /// Steps of all cells from which `(apex_row, apex_d)` can be reached, back to a checkpoint: of each antidiagonal the first row and
    /// the steps from there on.
    fn steps(
        &self,
        checkpoint: Checkpoint,
        apex_row: isize,
        apex_d: isize,
    ) -> Vec<(isize, Vec<Step>)> {
        let (index, [mut last, mut before]) = checkpoint;
        let mut all = Vec::with_capacity((apex_d - index) as usize);
        for d in index + 1..=apex_d {
            let (first, end) = self.row_range(d);
            let first_row = first.max(apex_row - (apex_d - d));
            let cells = (first_row..=end.min(apex_row)).map(|row| {
                let (least, step) = cheapest(last.at(row - 1), last.at(row), before.at(row - 1));
                (self.cost(row, d) + least, step)
            });
            let (values, steps) = cells.unzip();
            before = std::mem::replace(&mut last, Antidiagonal { first_row, values });
            all.push((first_row, steps));
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The recursion as written, with the whole matrix.
    fn reference_path(x: &[f64], y: &[f64], band: usize) -> (f64, Vec<(usize, usize)>) {
        let mut table = vec![vec![f64::INFINITY; y.len() + 1]; x.len() + 1];
        table[0][0] = 0.0;
        for i in 1..=x.len() {
            for j in 1..=y.len() {
                if i.abs_diff(j) <= band {
                    let least = table[i - 1][j]
                        .min(table[i][j - 1])
                        .min(table[i - 1][j - 1]);
                    table[i][j] = (x[i - 1] - y[j - 1]).powi(2) + least;
                }
            }
        }
        let (mut i, mut j) = (x.len(), y.len());
        let mut cells = vec![(i - 1, j - 1)];
        while (i, j) != (1, 1) {
            let choices = [table[i - 1][j], table[i][j - 1], table[i - 1][j - 1]];
            let least = choices.iter().copied().fold(f64::INFINITY, f64::min);
            match choices.iter().position(|&c| c == least).unwrap() {
                0 => i -= 1,
                1 => j -= 1,
                _ => (i, j) = (i - 1, j - 1),
            }
            cells.push((i - 1, j - 1));
        }
        cells.reverse();
        (table[x.len()][y.len()], cells)
    }

    /// Small whole numbers, so that ties abound.
    fn steps(n: usize, seed: u64) -> Vec<f64> {
        let mut state = seed;
        (0..n)
            .map(|_| {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                (state >> 61) as f64
            })
            .collect()
    }

    #[test]
    fn paths_equal_those_of_the_whole_matrix_to_the_last_tie() {
        for (n, m, seed) in [
            (1, 1, 1),
            (1, 9, 2),
            (9, 1, 3),
            (40, 40, 4),
            (57, 31, 5),
            (30, 64, 6),
        ] {
            let (x, y) = (steps(n, seed), steps(m, seed + 100));
            for band in [None, Some(0), Some(1), Some(4), Some(35), Some(1000)] {
                if band.is_some_and(|r| r < n.abs_diff(m)) {
                    assert!(warping_path(&x, &y, band).is_err());
                    continue;
                }
                let (distance, cells) = reference_path(&x, &y, band.unwrap_or(usize::MAX));
                for interval in [1, 2, 3, 7, 50, 512] {
                    let path = CostMatrix::new(&x, &y, band).path(interval).unwrap();
                    assert_eq!(path.distance, distance);
                    assert_eq!(path.cells, cells, "n {n}, m {m}, band {band:?}");
                }
            }
        }
    }

    #[test]
    fn a_band_that_binds_is_reported() {
        // A pulse without flat parts, so without ties, 10 samples late: the free path leaves the diagonal by 10.
        let pulse = |centre: usize| -> Vec<f64> {
            (0..60)
                .map(|k| (-(k as f64 - centre as f64).powi(2) / 50.0).exp())
                .collect()
        };
        let (x, y) = (pulse(30), pulse(20));
        let path = |band| warping_path(&x, &y, band).unwrap();
        assert!(!path(None).band_binds);
        assert!(path(Some(4)).band_binds);
        assert!(path(Some(4)).distance > path(None).distance);
        assert!(!path(Some(20)).band_binds);
        assert_eq!(path(Some(20)).cells, path(None).cells);
    }

    #[test]
    fn unusable_input_is_refused() {
        assert!(warping_path(&[], &[1.0], None).is_err());
        assert!(warping_path(&[1e200], &[0.0], None).is_err());
    }
}
