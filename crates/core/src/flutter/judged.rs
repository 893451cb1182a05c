//! How far a search can be believed: the speeds at which every mode was inside what was tested.

use super::mode_words::the_mode;
use crate::aerodynamics::{Transfer, TransferMatrix};
use crate::bridge::Bridge;
use crate::error::Result;
use crate::section::Dof;
use crate::state_space::ValueAt;
use crate::units::{ReducedFrequency, ReducedFrequencyGap, ReducedFrequencyRange};
use nalgebra::{DMatrix, SymmetricEigen};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Reduced frequencies above the tested range at which forces are asked whether they damp.
const SAMPLES: usize = 120;
/// The highest of them over the highest tested one.
const REACH: f64 = 200.0;
/// Energy that motion may gain there over what it exchanges at the end of the tested range: what a condition that holds at
/// sampled `K` leaves between them.
const GAIN: f64 = 1e-3;
/// Part that what grows with `K²` may be no mass, of it and of what is exchanged at the end of the tested range.
const NO_MASS: f64 = 1e-2;

/// Speeds between which every mode was looked at and none grows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StableRange {
    /// Lowest speed at which all modes could be judged, m/s; 0 from still air.
    pub from_m_s: f64,
    /// Highest speed at which all modes could be judged, m/s.
    pub to_m_s: f64,
    /// Why nothing is known outside, where a speed that was asked for is.
    pub not_judged: Option<String>,
}

/// One onset by the data alone and by the fit as it is; `None` where there is none in the range searched.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MovedOnset {
    /// By the data alone, m/s.
    pub without_m_s: Option<f64>,
    /// Under the constraints, m/s.
    pub with_m_s: Option<f64>,
}

impl StableRange {
    /// A search that ends below says nothing that can be written.
    const WRITTEN_AS_ZERO_M_S: f64 = 5e-4;

    /// Every speed from still air to this one, m/s.
    pub fn up_to(to_m_s: f64) -> Self {
        Self {
            from_m_s: 0.0,
            to_m_s,
            not_judged: None,
        }
    }

    /// Whether nothing was judged, or nothing that can be written.
    pub fn is_empty(&self) -> bool {
        self.from_m_s > self.to_m_s || self.to_m_s < Self::WRITTEN_AS_ZERO_M_S
    }

    /// The answer in words.
    pub fn explain(&self) -> String {
        if self.is_empty() {
            let why = self.not_judged.as_deref();
            return format!("not judged: {}", why.unwrap_or("no speed was looked at"));
        }
        let mut text = format!("no flutter up to {:.3} m/s", self.to_m_s);
        if self.from_m_s > 0.0 {
            text.push_str(&format!(", judged from {:.3} m/s", self.from_m_s));
        }
        if let Some(why) = &self.not_judged {
            text.push_str(&format!(" ({why})"));
        }
        text
    }

    /// The speeds that are in both.
    pub fn and(self, other: Self) -> Self {
        let both = self.not_judged.into_iter().chain(other.not_judged);
        let why: Vec<String> = both.collect();
        Self {
            from_m_s: self.from_m_s.max(other.from_m_s),
            to_m_s: self.to_m_s.min(other.to_m_s),
            not_judged: (!why.is_empty()).then(|| why.join("; ")),
        }
    }
}

/// Motions faster than every test: whether the forces damp them, so that slower wind than any test is harmless or not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FastMotion {
    /// The forces of the fit take energy out of each of them.
    Damped,
    /// Forces take energy out of every motion at the highest tested `K`; above, nothing is known.
    DampedAtTheEnd,
    /// The forces damp them, but tests do not tell how forces go over into those of still air.
    Guessed,
    /// Neither: forces may feed some.
    Open,
}

impl FastMotion {
    /// By what forces do to [all](damps_fast_motion) of them, `damped` where they take energy out of each, and by the `tests` behind
    /// the forces, each in the reduced frequency of its own section.
    pub fn new(
        damped: Option<Self>,
        tests: impl IntoIterator<Item = ReducedFrequencyRange>,
    ) -> Self {
        let mut told = tests.into_iter().map(|tested| tell_of_slow_wind(&tested));
        match damped {
            None => Self::Open,
            // at least one, and all
            Some(damped) if told.next() == Some(true) && told.all(|told| told) => damped,
            Some(_) => Self::Guessed,
        }
    }

    /// Why damping in wind slower than every test is not known; `None` where no motion gains energy there and tests tell how forces go
    /// over into those of still air.
    pub fn why_open(self) -> Option<&'static str> {
        match self {
            Self::Damped | Self::DampedAtTheEnd => None,
            Self::Guessed => Some(
                "damping there is a guess: tests have to reach K 0.8 of their own section and to lead up to the highest over a factor of 2.5",
            ),
            Self::Open => Some("a motion may gain energy there"),
        }
    }
}

/// Measured in docs/verdict.md on decks cut to other tests.
fn tell_of_slow_wind(tested: &ReducedFrequencyRange) -> bool {
    let k = tested.max.full_width();
    let lower_ends = tested.lower_ends().map(|(end, _)| end.full_width());
    k >= 0.8 && k >= 2.5 * lower_ends.fold(0.0, f64::max)
}

/// The last mode that comes down among the tests as the wind rises.
#[derive(Debug, Clone, PartialEq)]
pub struct TestedFrom {
    /// Wind speed at which it does, m/s; by its last frequency where it lies above the tests at all speeds that were looked at.
    pub speed_m_s: f64,
    /// Its branch.
    pub branch: String,
    /// Motions at lower speeds than any test.
    pub below: FastMotion,
}

/// Why a mode cannot be judged beyond a speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Exit {
    /// Its `K` falls below this, the lowest tested.
    Below(ReducedFrequency),
    /// Its `K` comes into a gap between tests.
    Into(ReducedFrequencyGap),
    /// It cannot be followed any further.
    Lost,
}

impl Exit {
    /// At one of the [lower ends](ReducedFrequencyRange::lower_ends) of a range.
    pub(super) fn at(k: ReducedFrequency, gap: Option<ReducedFrequencyGap>) -> Self {
        gap.map_or(Self::Below(k), Self::Into)
    }

    fn explain(self) -> String {
        match self {
            Self::Below(k) => format!(
                "where its K falls below {:.3}, the lowest tested",
                k.full_width()
            ),
            Self::Into(gap) => format!("where its K comes to lie {}", gap.explain()),
            Self::Lost => "beyond which it cannot be followed".to_owned(),
        }
    }
}

/// Where modes come into the range of reduced frequencies that can be judged, and where they leave it.
#[derive(Debug, Default)]
pub(super) struct RangePassages {
    /// Speed, m/s, and branch.
    pub(super) entries: Vec<(f64, String)>,
    /// Whether forces take energy out of every motion before its entry.
    pub(super) damped_before: bool,
    /// The same at the other end, and why.
    pub(super) exits: Vec<(f64, String, Exit)>,
}

impl RangePassages {
    /// Adds the lower ends of `range` that the `K` of a branch passes between two speeds, and the upper end, if modes are
    /// judged from there. In fast motion `1/K` is all but linear in between; near divergence it is not, so that the first of the
    /// exits, which ends what is judged, is `refined` to the speed at which `1/K` is that of the end. `before` and `after` are
    /// `1/K` at the two.
    pub(super) fn look(
        &mut self,
        range: ReducedFrequencyRange,
        branch: &str,
        before: ValueAt,
        after: ValueAt,
        refined: impl Fn(f64) -> Option<f64>,
    ) {
        let slowness = |k: ReducedFrequency| 1.0 / k.full_width();
        let passes = |k: ReducedFrequency| {
            let (a, b, c) = (before.value, after.value, slowness(k));
            (a <= c && c < b).then(|| before.at + (after.at - before.at) * (c - a) / (b - a))
        };
        let ended = self.exits.iter().any(|exit| exit.0 <= before.at);
        for (k, gap) in range.lower_ends().filter(|_| !ended) {
            let exact = |speed| refined(slowness(k)).unwrap_or(speed);
            let exit = passes(k).map(|speed| (exact(speed), branch.to_owned(), Exit::at(k, gap)));
            self.exits.extend(exit);
        }
        let entry = passes(range.max).map(|speed| (speed, branch.to_owned()));
        self.entries.extend(entry);
    }

    fn last_entry(&self) -> Option<&(f64, String)> {
        self.entries.iter().max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// The last of the entries, with what is known of motions before it by forces of a section that was `tested`.
    pub(super) fn tested_from(&self, tested: Option<ReducedFrequencyRange>) -> Option<TestedFrom> {
        let damped = self.damped_before.then_some(FastMotion::Damped);
        self.last_entry().map(|(speed_m_s, branch)| TestedFrom {
            speed_m_s: *speed_m_s,
            branch: branch.clone(),
            below: FastMotion::new(damped, tested),
        })
    }

    /// That at which a mode leaves the tests first, below a speed.
    fn first_exit(&self, below_m_s: f64) -> Option<&(f64, String, Exit)> {
        let first = self.exits.iter().min_by(|a, b| a.0.total_cmp(&b.0));
        first.filter(|(speed, ..)| *speed < below_m_s)
    }

    /// The same in words.
    pub(super) fn end(&self, below_m_s: f64) -> Option<String> {
        let (speed, branch, exit) = self.first_exit(below_m_s)?;
        let (mode, exit) = (the_mode(branch), exit.explain());
        Some(format!(
            "{mode} can be judged up to {speed:.3} m/s, {exit}; above that these data say nothing"
        ))
    }

    /// Of the speeds that were looked at those at which every mode was judged.
    pub(super) fn judged(&self, looked_at: StableRange) -> StableRange {
        let highest = looked_at.to_m_s;
        let last = self.last_entry().filter(|_| !self.damped_before);
        let first = self.first_exit(highest);
        let from = last.map(|(speed, branch)| {
            let mode = the_mode(branch);
            format!("{mode} can be judged from {speed:.3} m/s on")
        });
        let to = self.end(highest);
        let why: Vec<String> = from.into_iter().chain(to).collect();
        looked_at.and(StableRange {
            from_m_s: last.map_or(0.0, |l| l.0),
            to_m_s: first.map_or(highest, |f| f.0),
            not_judged: (!why.is_empty()).then(|| why.join(", ")),
        })
    }
}

/// Why nothing is known below the speed at which a mode comes to the end `limit` of the range that can be judged.
pub(super) fn entry_reason(limit: ReducedFrequency) -> String {
    format!(
        "there its motion enters the range that can be judged, which ends at K {:.4}",
        limit.full_width()
    )
}

/// Whether forces take energy out of every motion that is faster than was tested, so that slower wind than any test is
/// known to be harmless although nothing was measured there: no shape of heave and rotation, and no sway, gains energy by
/// `Im G(K)` above `k_max`, and what grows with `K²` is a mass.
pub fn damps_fast_motion(
    dofs: &[Dof],
    k_max: ReducedFrequency,
    transfer: impl Fn(ReducedFrequency) -> Result<TransferMatrix>,
) -> Result<bool> {
    let mut size = 0.0;
    let mut before: Option<(f64, TransferMatrix)> = None;
    for i in 0..SAMPLES {
        let k = k_max.full_width() * REACH.powf(i as f64 / (SAMPLES as f64 - 1.0));
        let g = transfer(ReducedFrequency::from_full_width(k))?;
        for block in blocks(dofs) {
            let part = |of: &dyn Fn(usize, usize) -> f64| part(&block, of);
            let gain = part(&|i, j| 0.5 * (g[(i, j)].im + g[(j, i)].im) / k);
            if i == 0 {
                size = gain.norm().max(size);
            }
            if SymmetricEigen::new(gain).eigenvalues.max() > GAIN * size {
                return Ok(false);
            }
            // of the last two `K`, so that a stiffness, which may well be skew, is not in it
            if let Some((k_before, last)) = before.as_ref().filter(|_| i == SAMPLES - 1) {
                let rise =
                    (k / k_max.full_width()).powi(2) - (k_before / k_max.full_width()).powi(2);
                let inertia = part(&|i, j| (g[(i, j)].re - last[(i, j)].re) / rise);
                let skew = (&inertia - inertia.transpose()).norm();
                if skew > NO_MASS * (inertia.norm() + size * k_max.full_width()) {
                    return Ok(false);
                }
            }
        }
        before = Some((k, g));
    }
    Ok(true)
}

/// Whether the forces of every section of a bridge take energy out of each motion faster than `k`, a reduced frequency of the
/// bridge.
///
/// # Errors
/// As the forces of a section at a `K`.
pub fn bridge_damps_fast_motion(bridge: &Bridge, k: ReducedFrequency) -> Result<bool> {
    let mut asked: Vec<(&Arc<dyn Transfer>, f64)> = Vec::new();
    for group in bridge.groups.iter().filter(|g| g.wind_factor > 0.0) {
        let of_group = k.full_width() * group.width_m / (group.wind_factor * bridge.width_m());
        // sections in many winds are asked once, from the lowest on
        match asked
            .iter_mut()
            .find(|(forces, _)| Arc::ptr_eq(forces, &group.forces))
        {
            Some((_, least)) => *least = least.min(of_group),
            None => asked.push((&group.forces, of_group)),
        }
    }
    for (forces, k_max) in asked {
        let k_max = ReducedFrequency::from_full_width(k_max);
        if !damps_fast_motion(forces.dofs(), k_max, |k| forces.transfer(k))? {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Whether forces take energy out of every motion at one reduced frequency: no shape of heave and rotation, and no sway, gains
/// energy by `Im G`.
pub(super) fn damps_at(dofs: &[Dof], g: &TransferMatrix) -> bool {
    blocks(dofs).iter().all(|block| {
        let gain = part(block, &|i, j| 0.5 * (g[(i, j)].im + g[(j, i)].im));
        SymmetricEigen::new(gain).eigenvalues.max() <= 0.0
    })
}

/// The motions that are asked together: sway by itself, and the others.
fn blocks(dofs: &[Dof]) -> Vec<Vec<usize>> {
    let (sway, others) = (0..dofs.len()).partition(|i| dofs[*i] == Dof::Lateral);
    let mut blocks: Vec<Vec<usize>> = vec![sway, others];
    blocks.retain(|block| !block.is_empty());
    blocks
}

fn part(block: &[usize], of: &dyn Fn(usize, usize) -> f64) -> DMatrix<f64> {
    DMatrix::from_fn(block.len(), block.len(), |i, j| of(block[i], block[j]))
}
