//! Gusts over a step: their lags, the force they exert, and the Taylor series of both.
//!
//! Gusts act through channels, each with lags of its own speed: the two components on a section; on a bridge what all gusts of
//! one wind and width do to each mode. Lags are linear, so those of a mode serve all strips.

use super::linked::Sparse;
use super::packed::largest_of;
use super::values::{Inputs, SectionState, stated};
use crate::aerodynamics::{GustForce, LAGS, RationalAdmittance};
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::section::Structure;
use crate::state_space::StateEquation;
use nalgebra::{DMatrix, DVector};
use std::array;

/// Gust forces `F = V Q g` with `g` the channels through their lags.
#[derive(Debug, Clone)]
pub(super) struct Gusts {
    /// `Q`, n×channels.
    by_channel: Sparse,
    motions: usize,
    channels: usize,
    /// Whether they blow on a section, whose steps are those of its importer; on a bridge turbulence cuts them.
    pub on_section: bool,
    /// Weight of each lag; of no account where nothing lags.
    weights: [f64; LAGS],
    /// How fast each number of the state follows its gust, 1/m times the wind: the pole of its lag over the width.
    speeds: Vec<f64>,
    /// Channels in the present order of time of a series.
    gusts: Vec<f64>,
    /// The lags of each channel in it, one channel after the other, and what they lack of their gust.
    term: Vec<f64>,
    lacking: Vec<f64>,
    /// `Q g` of this order and the one before, and the force.
    felt: [Vec<f64>; 2],
    force: Vec<f64>,
    largest: f64,
    last: f64,
}

/// A part of a step, over which one series reaches.
#[derive(Debug, Clone, Copy)]
pub(super) struct SeriesPart {
    /// Time since that of the inputs, s.
    pub start: f64,
    /// How long it is, s.
    pub tau: f64,
    /// Wind speed at its beginning, m/s.
    pub wind: f64,
    /// How much that changes over it, m/s.
    pub change: f64,
}

impl Gusts {
    /// On a section: `½ρ diag(B, B, B²) A` about its axis.
    pub(super) fn new(force: &GustForce, structure: &Structure) -> Self {
        let n = structure.dofs.len();
        let about_axis =
            structure.forces_at_axis(DMatrix::from_fn(n, 2, |i, j| force.coefficients[i][j]));
        let half_rho = 0.5 * structure.air_density_kg_m3;
        let by_gust = DMatrix::from_fn(n, 2, |i, j| {
            half_rho * structure.dofs[i].force_scale(structure.width_m) * about_axis[(i, j)]
        });
        let per_width = vec![structure.width_m.recip(); 2];
        Self {
            on_section: true,
            ..Self::by_channel(&by_gust, &per_width, force.admittance)
        }
    }

    /// On a bridge, whose channels are forces per 1 m/s of wind on each mode: `per_width` is the wind factor over the width of
    /// each group of `modes` channels.
    pub(super) fn on_modes(
        modes: usize,
        per_width: &[f64],
        admittance: RationalAdmittance,
    ) -> Self {
        let per_width: Vec<f64> = per_width.iter().flat_map(|p| vec![*p; modes]).collect();
        let by_gust = DMatrix::from_fn(modes, per_width.len(), |i, j| {
            f64::from(u8::from(j % modes == i))
        });
        Self::by_channel(&by_gust, &per_width, admittance)
    }

    /// `Q` by channel; `per_width`: 1/m of each.
    fn by_channel(
        by_gust: &DMatrix<f64>,
        per_width: &[f64],
        admittance: RationalAdmittance,
    ) -> Self {
        let (lags, (motions, channels)) = (admittance.lags(), by_gust.shape());
        let of_channel = |p: &f64| lags.iter().map(|[pole, _]| pole * p).collect::<Vec<_>>();
        Self {
            by_channel: Sparse::new(by_gust),
            motions,
            channels,
            on_section: false,
            weights: array::from_fn(|lag| lags.get(lag).map_or(0.0, |[_, weight]| *weight)),
            speeds: per_width.iter().flat_map(of_channel).collect(),
            gusts: Vec::new(),
            term: Vec::new(),
            lacking: Vec::new(),
            felt: Default::default(),
            force: Vec::new(),
            largest: 0.0,
            last: 0.0,
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

    /// `Q g`: force per unit length and 1 m/s of wind.
    #[inline(always)]
    pub(super) fn force_per_wind(&self, gust: &[f64], lagging: &[f64], force: &mut [f64]) {
        force.fill(0.0);
        let gust = |j| stated(gust, j);
        add_force(&self.by_channel, self.weights, gust, lagging, force);
    }

    /// Rates of the lagging gusts per 1 m/s of wind.
    pub(super) fn rates_per_wind(&self, gust: &[f64], lagging: &[f64], rates: &mut [f64]) {
        for (i, (rate, speed)) in rates.iter_mut().zip(&self.speeds).enumerate() {
            *rate = speed * (stated(gust, i / LAGS) - lagging[i]);
        }
    }

    /// The section in a steady wind with its lagging gusts: states `[z, g]`, inputs the forces, then the gusts of all channels.
    ///
    /// # Errors
    /// As [`CoupledSection::at`].
    pub(super) fn system(&self, section: &CoupledSection, wind: f64) -> Result<StateEquation> {
        let alone = section.equation_at(wind)?;
        let (states, n) = alone.b.shape();
        let (all, lags) = (states + self.states(), self.states());
        let mut a = DMatrix::zeros(all, all);
        let mut b = DMatrix::zeros(all, n + self.channels);
        a.view_mut((0, 0), (states, states)).copy_from(&alone.a);
        b.view_mut((0, 0), (states, n)).copy_from(&alone.b);
        let (mut force, mut rates) = (vec![0.0; n], vec![0.0; lags]);
        for i in 0..lags + self.channels {
            let mut unit = vec![0.0; lags + self.channels];
            unit[i] = wind;
            let (lagging, gust) = unit.split_at(lags);
            self.force_per_wind(gust, lagging, &mut force);
            self.rates_per_wind(gust, lagging, &mut rates);
            let mut column = match i.checked_sub(lags) {
                None => a.column_mut(states + i),
                Some(channel) => b.column_mut(n + channel),
            };
            column.rows_mut(states, lags).copy_from_slice(&rates);
            let force = DVector::from_column_slice(&force);
            column.rows_mut(0, states).copy_from(&(&alone.b * force));
        }
        Ok(StateEquation { a, b })
    }

    /// Writes `[z, g]` and the inputs of [`system`](Self::system), then their rates unless all are zero.
    pub(super) fn load(&self, operand: &mut Vec<f64>, state: &SectionState, inputs: &Inputs) {
        operand.clear();
        operand.extend_from_slice(&state.values);
        operand.extend_from_slice(&state.gusts);
        operand.extend_from_slice(&inputs.force);
        operand.extend((0..self.channels).map(|j| stated(&inputs.gust_m_s, j)));
        let mut rates = inputs.force_rate.iter().chain(&inputs.gust_rate_m_s2);
        if rates.any(|rate| *rate != 0.0) {
            operand.extend_from_slice(&inputs.force_rate);
            operand.extend((0..self.channels).map(|j| stated(&inputs.gust_rate_m_s2, j)));
        }
    }

    /// Begins the series of one part at the present lagging gusts.
    pub(super) fn begin(&mut self, lagging: &[f64]) {
        self.term.clear();
        self.term.extend_from_slice(lagging);
        self.lacking.clear();
        self.lacking.resize(lagging.len(), 0.0);
        for list in self.felt.iter_mut().chain([&mut self.force]) {
            list.clear();
            list.resize(self.motions, 0.0);
        }
        self.largest = largest_of(lagging);
        self.last = self.largest;
    }

    /// The force of order `k` over a part; adds the lagging gusts of order `k + 1` to `sum`.
    #[inline(always)]
    pub(super) fn next(
        &mut self,
        k: usize,
        part: SeriesPart,
        inputs: &Inputs,
        sum: &mut [f64],
    ) -> &[f64] {
        let SeriesPart { wind, change, .. } = part;
        let s = self;
        if k <= 2 {
            s.gusts.clear();
            s.gusts.extend((0..s.channels).map(|j| match k {
                0 => stated(&inputs.gust_m_s, j) + part.start * stated(&inputs.gust_rate_m_s2, j),
                1 => part.tau * stated(&inputs.gust_rate_m_s2, j),
                _ => 0.0,
            }));
            s.largest = s.largest.max(largest_of(&s.gusts));
        }
        s.felt.swap(0, 1);
        s.felt[0].fill(0.0);
        let (gust, felt) = (|j| s.gusts[j], &mut s.felt[0]);
        add_force(&s.by_channel, s.weights, gust, &s.term, felt);
        let [felt, before] = &s.felt;
        for (force, (felt, before)) in s.force.iter_mut().zip(felt.iter().zip(before)) {
            *force = wind * felt + change * before;
        }
        let factor = part.tau / (k + 1) as f64;
        let lags = lanes(&mut s.term).iter_mut().zip(lanes(&mut s.lacking));
        let places = lanes(sum).iter_mut().zip(s.speeds.as_chunks::<LAGS>().0);
        for (gust, ((term, lacking), (sum, speed))) in s.gusts.iter().zip(lags.zip(places)) {
            let now = term.map(|term| gust - term);
            *term = array::from_fn(|i| factor * speed[i] * (wind * now[i] + change * lacking[i]));
            *lacking = now;
            *sum = array::from_fn(|i| sum[i] + term[i]);
        }
        s.last = largest_of(&s.term);
        s.largest = s.largest.max(s.last);
        &s.force
    }

    /// Whether the last term is below `part` of the largest gust.
    #[inline(always)]
    pub(super) fn converged(&self, part: f64) -> bool {
        self.last <= part * self.largest
    }
}

/// Adds `Q g` of the channels, behind their lags where there are any: their weights sum to one.
#[inline(always)]
fn add_force(
    by_channel: &Sparse,
    weights: [f64; LAGS],
    gust: impl Fn(usize) -> f64,
    lagging: &[f64],
    force: &mut [f64],
) {
    if lagging.is_empty() {
        return by_channel.add(gust, force);
    }
    let (lagging, _) = lagging.as_chunks::<LAGS>();
    let felt = |j: usize| {
        let [a, b, c, d] = array::from_fn(|lag| weights[lag] * lagging[j][lag]);
        (a + b) + (c + d)
    };
    by_channel.add(felt, force);
}

/// The lags of each channel.
fn lanes(of_channels: &mut [f64]) -> &mut [[f64; LAGS]] {
    of_channels.as_chunks_mut().0
}
