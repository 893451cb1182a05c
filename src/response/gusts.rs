//! Gusts on a section over a step: their lags, the force they exert, and the Taylor series of both.

use super::MAX_DOFS;
use crate::aerodynamics::GustForce;
use crate::section::Structure;
use nalgebra::DMatrix;

/// Gust forces of a section, `F = V Q g` with `Q = ½ρ diag(B, B, B²) A` about its axis and `g` the gusts through their lags.
#[derive(Debug, Clone)]
pub(super) struct Gusts {
    /// `Q`, n×2.
    by_gust: DMatrix<f64>,
    /// `p/B` (1/m) and weight of each lag.
    lags: Vec<[f64; 2]>,
    /// Part of a gust that acts at once.
    direct: f64,
    series: LagSeries,
}

/// Memory of a series: each lag of `u`, then each of `w`.
#[derive(Debug, Clone, Default)]
struct LagSeries {
    term: Vec<f64>,
    lacking: Vec<f64>,
    passed: [f64; 2],
    largest: f64,
    last: f64,
}

/// A gust and its rate, for `u` and `w`: m/s, m/s².
pub(super) type GustCourse = [[f64; 2]; 2];

impl Gusts {
    pub fn new(force: &GustForce, structure: &Structure) -> Self {
        let n = structure.dofs.len();
        let about_axis =
            structure.forces_at_axis(DMatrix::from_fn(n, 2, |i, j| force.coefficients[i][j]));
        let half_rho = 0.5 * structure.air_density_kg_m3;
        let lags = force.admittance.lags();
        // the weights of lags sum to one
        let direct = if lags.is_empty() { 1.0 } else { 0.0 };
        Self {
            direct,
            by_gust: DMatrix::from_fn(n, 2, |i, j| {
                half_rho * structure.dofs[i].force_scale(structure.width_m) * about_axis[(i, j)]
            }),
            lags: lags
                .iter()
                .map(|[p, w]| [p / structure.width_m, *w])
                .collect(),
            series: LagSeries::default(),
        }
    }

    /// Numbers of the state: gusts behind each lag.
    pub fn states(&self) -> usize {
        2 * self.lags.len()
    }

    /// Largest `p/B`, 1/m.
    pub fn fastest(&self) -> f64 {
        self.lags.iter().map(|[p, _]| *p).fold(0.0, f64::max)
    }

    /// Gusts as the deck feels them.
    fn passed(&self, gust: [f64; 2], lagging: &[f64]) -> [f64; 2] {
        let count = self.lags.len();
        std::array::from_fn(|j| {
            let of_component = &lagging[j * count..(j + 1) * count];
            let lagged = self.lags.iter().zip(of_component).map(|([_, w], g)| w * g);
            self.direct * gust[j] + lagged.sum::<f64>()
        })
    }

    /// `Q g`: force per unit length and 1 m/s of wind.
    pub fn force_per_wind(&self, gust: [f64; 2], lagging: &[f64]) -> [f64; MAX_DOFS] {
        self.times(self.passed(gust, lagging))
    }

    fn times(&self, passed: [f64; 2]) -> [f64; MAX_DOFS] {
        let mut force = [0.0; MAX_DOFS];
        for (i, row) in self.by_gust.row_iter().enumerate() {
            force[i] = row[0] * passed[0] + row[1] * passed[1];
        }
        force
    }

    /// Rates of the lagging gusts per 1 m/s of wind, `(p/B)(u − g)`.
    pub fn rates_per_wind(&self, gust: [f64; 2], lagging: &[f64]) -> Vec<f64> {
        let count = self.lags.len().max(1);
        let rate = |(i, g): (usize, &f64)| self.lags[i % count][0] * (gust[i / count] - g);
        lagging.iter().enumerate().map(rate).collect()
    }

    /// Begins the series of one part at the present lagging gusts.
    pub fn begin(&mut self, lagging: &[f64]) {
        let s = &mut self.series;
        s.term.clear();
        s.term.extend_from_slice(lagging);
        s.lacking.clear();
        s.lacking.resize(lagging.len(), 0.0);
        s.passed = [0.0; 2];
        s.largest = largest(lagging);
        s.last = s.largest;
    }

    /// The force of order `k` in time over `tau`, in wind that begins at `wind` and changes by `change`, under gusts with these
    /// coefficients of order `k`; adds the lagging gusts of order `k + 1` to `sum`.
    pub fn next(
        &mut self,
        (k, tau): (usize, f64),
        (wind, change): (f64, f64),
        gust: [f64; 2],
        sum: &mut [f64],
    ) -> [f64; MAX_DOFS] {
        let passed = self.passed(gust, &self.series.term);
        let before = std::mem::replace(&mut self.series.passed, passed);
        let felt = std::array::from_fn(|j| wind * passed[j] + change * before[j]);
        let (count, factor) = (self.lags.len().max(1), tau / (k + 1) as f64);
        let s = &mut self.series;
        for (i, sum) in sum.iter_mut().enumerate() {
            let lacking = gust[i / count] - s.term[i];
            let pole = self.lags[i % count][0];
            s.term[i] = factor * pole * (wind * lacking + change * s.lacking[i]);
            s.lacking[i] = lacking;
            *sum += s.term[i];
        }
        let size = largest(&s.term);
        s.largest = s.largest.max(size).max(largest(&gust));
        s.last = size;
        self.times(felt)
    }

    /// Whether the last term is below `part` of the largest gust.
    pub fn settled(&self, part: f64) -> bool {
        self.series.last <= part * self.series.largest
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |a, x| a.max(x.abs()))
}
