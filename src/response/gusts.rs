//! Gusts over a step: their lags, the force they exert, and the Taylor series of both.
//!
//! Gusts act through channels, each with lags of its own speed: the two components on a section; on a bridge what all gusts of
//! one wind and width do to each mode. Lags are linear, so those of a mode serve all strips.

use crate::aerodynamics::{GustForce, RationalAdmittance};
use crate::section::Structure;
use nalgebra::DMatrix;

/// Gust forces `F = V Q g` with `g` the channels through their lags.
#[derive(Debug, Clone)]
pub(super) struct Gusts {
    force: ByChannel,
    /// 1/m of each channel: a lag follows at its pole times this times the wind.
    passing: Vec<f64>,
    /// Pole and weight of each lag.
    lags: &'static [[f64; 2]],
    /// Part of a gust that acts at once.
    direct: f64,
    series: LagSeries,
}

/// `Q`.
#[derive(Debug, Clone)]
enum ByChannel {
    /// n×channels: `½ρ diag(B, B, B²) A` about the axis of a section.
    Section(DMatrix<f64>),
    /// Channels are forces per 1 m/s of wind on so many modes, once for each wind and width.
    Modes(usize),
}

/// Memory of a series: the lags of each channel, one channel after the other.
#[derive(Debug, Clone, Default)]
struct LagSeries {
    term: Vec<f64>,
    lacking: Vec<f64>,
    passed: Vec<f64>,
    before: Vec<f64>,
    force: Vec<f64>,
    largest: f64,
    last: f64,
}

/// Gusts over a piece of time, in each channel.
#[derive(Debug, Clone, Copy)]
pub(super) struct GustCourse<'a> {
    pub gust: &'a [f64],
    pub rate: &'a [f64],
    /// Time of the piece after that of `gust`, s.
    pub after: f64,
}

impl GustCourse<'_> {
    fn at(&self, channel: usize, time: f64) -> f64 {
        stated(self.gust, channel) + (self.after + time) * stated(self.rate, channel)
    }
}

impl Gusts {
    /// On a section.
    pub fn new(force: &GustForce, structure: &Structure) -> Self {
        let n = structure.dofs.len();
        let about_axis =
            structure.forces_at_axis(DMatrix::from_fn(n, 2, |i, j| force.coefficients[i][j]));
        let half_rho = 0.5 * structure.air_density_kg_m3;
        let by_gust = DMatrix::from_fn(n, 2, |i, j| {
            half_rho * structure.dofs[i].force_scale(structure.width_m) * about_axis[(i, j)]
        });
        let passing = vec![structure.width_m.recip(); 2];
        Self::of(ByChannel::Section(by_gust), passing, force.admittance)
    }

    /// On a bridge: `passing` is the wind factor over the width of each group of `modes` channels.
    pub fn on_modes(modes: usize, passing: &[f64], admittance: RationalAdmittance) -> Self {
        let passing = passing.iter().flat_map(|p| vec![*p; modes]).collect();
        Self::of(ByChannel::Modes(modes), passing, admittance)
    }

    fn of(force: ByChannel, passing: Vec<f64>, admittance: RationalAdmittance) -> Self {
        let lags = admittance.lags();
        Self {
            force,
            passing,
            lags,
            // the weights of lags sum to one
            direct: if lags.is_empty() { 1.0 } else { 0.0 },
            series: LagSeries::default(),
        }
    }

    /// Numbers of the state: each channel behind each lag.
    pub fn states(&self) -> usize {
        self.passing.len() * self.lags.len()
    }

    /// Largest speed of a lag, 1/m.
    pub fn fastest(&self) -> f64 {
        let pole = self.lags.iter().map(|[p, _]| *p).fold(0.0, f64::max);
        pole * self.passing.iter().copied().fold(0.0, f64::max)
    }

    /// Channel `j` as it is felt.
    fn passed(&self, j: usize, gust: f64, lagging: &[f64]) -> f64 {
        let count = self.lags.len();
        let of_channel = &lagging[j * count..(j + 1) * count];
        let lagged = self.lags.iter().zip(of_channel).map(|([_, w], g)| w * g);
        self.direct * gust + lagged.sum::<f64>()
    }

    /// `Q g`: force per unit length and 1 m/s of wind.
    pub fn force_per_wind(&self, gust: &[f64], lagging: &[f64]) -> Vec<f64> {
        let each = 0..self.passing.len();
        let passed: Vec<f64> = each
            .map(|j| self.passed(j, stated(gust, j), lagging))
            .collect();
        let mut force = Vec::new();
        self.force.times(&passed, &mut force);
        force
    }

    /// Rates of the lagging gusts per 1 m/s of wind.
    pub fn rates_per_wind(&self, gust: &[f64], lagging: &[f64]) -> Vec<f64> {
        let rate = |(i, g): (usize, &f64)| {
            let (channel, speed) = self.lag(i);
            speed * (stated(gust, channel) - g)
        };
        lagging.iter().enumerate().map(rate).collect()
    }

    /// Channel of a number of the state, and the speed of its lag, 1/m.
    fn lag(&self, i: usize) -> (usize, f64) {
        let count = self.lags.len();
        let channel = i / count;
        (channel, self.lags[i % count][0] * self.passing[channel])
    }

    /// Begins the series of one part at the present lagging gusts.
    pub fn begin(&mut self, lagging: &[f64]) {
        let s = &mut self.series;
        s.term.clear();
        s.term.extend_from_slice(lagging);
        s.lacking.clear();
        s.lacking.resize(lagging.len(), 0.0);
        s.passed.clear();
        s.passed.resize(self.passing.len(), 0.0);
        s.largest = largest(lagging);
        s.last = s.largest;
    }

    /// The force of order `k` in time over `tau` from `start` on, in wind that begins at `wind` and changes by `change`; adds
    /// the lagging gusts of order `k + 1` to `sum`.
    pub fn next(
        &mut self,
        k: usize,
        (start, tau): (f64, f64),
        (wind, change): (f64, f64),
        course: GustCourse<'_>,
        sum: &mut [f64],
    ) -> &[f64] {
        let mut s = std::mem::take(&mut self.series);
        let gust = |j: usize| match k {
            0 => course.at(j, start),
            1 => tau * stated(course.rate, j),
            _ => 0.0,
        };
        std::mem::swap(&mut s.before, &mut s.passed);
        s.passed.clear();
        s.passed
            .extend((0..self.passing.len()).map(|j| self.passed(j, gust(j), &s.term)));
        for (before, passed) in s.before.iter_mut().zip(&s.passed) {
            *before = wind * passed + change * *before;
        }
        self.force.times(&s.before, &mut s.force);
        let factor = tau / (k + 1) as f64;
        for (i, sum) in sum.iter_mut().enumerate() {
            let (channel, speed) = self.lag(i);
            let lacking = gust(channel) - s.term[i];
            s.term[i] = factor * speed * (wind * lacking + change * s.lacking[i]);
            s.lacking[i] = lacking;
            *sum += s.term[i];
        }
        s.last = largest(&s.term);
        let blown = (0..self.passing.len()).map(|j| gust(j).abs());
        s.largest = blown.fold(s.largest.max(s.last), f64::max);
        self.series = s;
        &self.series.force
    }

    /// Whether the last term is below `part` of the largest gust.
    pub fn settled(&self, part: f64) -> bool {
        self.series.last <= part * self.series.largest
    }
}

impl ByChannel {
    /// `Q` times what is felt of each channel.
    fn times(&self, felt: &[f64], force: &mut Vec<f64>) {
        force.clear();
        match self {
            Self::Section(matrix) => force.extend(
                matrix
                    .row_iter()
                    .map(|row| row.iter().zip(felt).map(|(q, g)| q * g).sum::<f64>()),
            ),
            Self::Modes(modes) => {
                force.resize(*modes, 0.0);
                for of_group in felt.chunks_exact(*modes) {
                    force.iter_mut().zip(of_group).for_each(|(f, g)| *f += g);
                }
            }
        }
    }
}

/// Gust of a channel.
fn stated(gusts: &[f64], channel: usize) -> f64 {
    gusts.get(channel).copied().unwrap_or(0.0)
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |a, x| a.max(x.abs()))
}
