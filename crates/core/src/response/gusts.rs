//! Gusts over a step: their lags, the force they exert, and the Taylor series of both.
//!
//! Gusts act through channels, each with lags of its own speed: the two components on a section; on a bridge what all gusts of
//! one wind and width do to each mode. Lags are linear, so those of a mode serve all strips.

use crate::aerodynamics::{GustForce, RationalAdmittance};
use crate::section::Structure;
use nalgebra::DMatrix;
use std::ops::Range;

/// Gust forces `F = V Q g` with `g` the channels through their lags.
#[derive(Debug, Clone)]
pub(super) struct Gusts {
    force: ByChannel,
    channels: usize,
    /// Pole and weight of each lag.
    lags: &'static [[f64; 2]],
    /// How fast each number of the state follows its gust, 1/m times the wind: the pole of its lag over the width.
    speeds: Vec<f64>,
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
    force: Vec<f64>,
    largest: f64,
    last: f64,
}

/// A part of a step, over which one series reaches.
#[derive(Debug, Clone, Copy)]
pub(super) struct SeriesPart {
    /// Time since the start of the step, s.
    pub start: f64,
    /// How long it is, s.
    pub tau: f64,
    /// Wind speed at its beginning, m/s.
    pub wind: f64,
    /// How much that changes over it, m/s.
    pub change: f64,
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
    pub(super) fn new(force: &GustForce, structure: &Structure) -> Self {
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
    pub(super) fn on_modes(modes: usize, passing: &[f64], admittance: RationalAdmittance) -> Self {
        let passing = passing.iter().flat_map(|p| vec![*p; modes]).collect();
        Self::of(ByChannel::Modes(modes), passing, admittance)
    }

    /// `passing`: 1/m of each channel.
    fn of(force: ByChannel, passing: Vec<f64>, admittance: RationalAdmittance) -> Self {
        let lags = admittance.lags();
        let of_channel = |p: &f64| lags.iter().map(|[pole, _]| pole * p).collect::<Vec<_>>();
        Self {
            force,
            channels: passing.len(),
            lags,
            speeds: passing.iter().flat_map(of_channel).collect(),
            // the weights of lags sum to one
            direct: if lags.is_empty() { 1.0 } else { 0.0 },
            series: LagSeries::default(),
        }
    }

    /// Numbers of the state: each channel behind each lag.
    pub(super) fn states(&self) -> usize {
        self.speeds.len()
    }

    /// Largest speed of a lag, 1/m.
    pub(super) fn fastest(&self) -> f64 {
        self.speeds.iter().copied().fold(0.0, f64::max)
    }

    /// Numbers of the state that belong to a channel.
    fn of_channel(&self, j: usize) -> Range<usize> {
        j * self.lags.len()..(j + 1) * self.lags.len()
    }

    /// A channel as it is felt.
    fn passed(&self, gust: f64, lagging: &[f64]) -> f64 {
        let lagged = self.lags.iter().zip(lagging).map(|([_, w], g)| w * g);
        self.direct * gust + lagged.sum::<f64>()
    }

    /// `Q g`: force per unit length and 1 m/s of wind.
    pub(super) fn force_per_wind(&self, gust: &[f64], lagging: &[f64], force: &mut [f64]) {
        force.fill(0.0);
        for j in 0..self.channels {
            let felt = self.passed(stated(gust, j), &lagging[self.of_channel(j)]);
            self.force.add(j, felt, force);
        }
    }

    /// Rates of the lagging gusts per 1 m/s of wind.
    pub(super) fn rates_per_wind(&self, gust: &[f64], lagging: &[f64], rates: &mut [f64]) {
        for j in 0..self.channels {
            let (gust, range) = (stated(gust, j), self.of_channel(j));
            for i in range {
                rates[i] = self.speeds[i] * (gust - lagging[i]);
            }
        }
    }

    /// Begins the series of one part at the present lagging gusts.
    pub(super) fn begin(&mut self, lagging: &[f64]) {
        let s = &mut self.series;
        s.term.clear();
        s.term.extend_from_slice(lagging);
        s.lacking.clear();
        s.lacking.resize(lagging.len(), 0.0);
        s.passed.clear();
        s.passed.resize(self.channels, 0.0);
        s.force.resize(self.force.motions(), 0.0);
        s.largest = largest(lagging);
        s.last = s.largest;
    }

    /// The force of order `k` over a part; adds the lagging gusts of order `k + 1` to `sum`.
    pub(super) fn next(
        &mut self,
        k: usize,
        part: SeriesPart,
        course: GustCourse<'_>,
        sum: &mut [f64],
    ) -> &[f64] {
        let mut s = std::mem::take(&mut self.series);
        let SeriesPart { wind, change, .. } = part;
        let factor = part.tau / (k + 1) as f64;
        s.force.fill(0.0);
        for j in 0..self.channels {
            let gust = match k {
                0 => course.at(j, part.start),
                1 => part.tau * stated(course.rate, j),
                _ => 0.0,
            };
            let range = self.of_channel(j);
            let term = &mut s.term[range.clone()];
            let passed = self.passed(gust, term);
            self.force
                .add(j, wind * passed + change * s.passed[j], &mut s.force);
            s.passed[j] = passed;
            let lags = term.iter_mut().zip(&mut s.lacking[range.clone()]);
            let places = sum[range.clone()].iter_mut().zip(&self.speeds[range]);
            for ((term, lacking), (sum, speed)) in lags.zip(places) {
                let now = gust - *term;
                *term = factor * speed * (wind * now + change * *lacking);
                *lacking = now;
                *sum += *term;
            }
            s.largest = s.largest.max(gust.abs());
        }
        s.last = largest(&s.term);
        s.largest = s.largest.max(s.last);
        self.series = s;
        &self.series.force
    }

    /// Whether the last term is below `part` of the largest gust.
    pub(super) fn settled(&self, part: f64) -> bool {
        self.series.last <= part * self.series.largest
    }
}

impl ByChannel {
    fn motions(&self) -> usize {
        match self {
            Self::Section(matrix) => matrix.nrows(),
            Self::Modes(modes) => *modes,
        }
    }

    /// Adds what a channel does that is felt so strongly.
    fn add(&self, channel: usize, felt: f64, force: &mut [f64]) {
        match self {
            Self::Section(matrix) => {
                for (force, q) in force.iter_mut().zip(&matrix.column(channel)) {
                    *force += q * felt;
                }
            }
            Self::Modes(modes) => force[channel % modes] += felt,
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
