//! What the routes that follow modes over wind speed share: the modes, and what is watched from one speed to the next.

use super::answer::{Findings, UnstableStart};
use super::critical_point::{CriticalPoint, OnsetMethod};
use super::judged::{Exit, entry_reason};
use super::onset::Onset;
use crate::error::{Error, Result};
use crate::section::Structure;
use crate::state_space::{ValueAt, root};
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use nalgebra::{Complex, DVector};

/// Modal assurance between neighbouring speeds below which a step is halved.
pub(super) const MIN_ASSURANCE: f64 = 0.9;
/// Two modes closer than this, relatively, are one root found twice.
pub(super) const SEPARATION: f64 = 1e-9;

/// Modes around another: those up to this part of its eigenvalue, and this many at least.
const AROUND: f64 = 0.1;
const NEAREST: usize = 4;
/// Part of a wind speed that is no step.
const NO_STEP: f64 = 1e-6;
/// Growth up to this part of the eigenvalue is rounding.
const ROUNDING: f64 = 1e-9;

/// Whether a real part is above rounding.
pub(super) fn growing(lambda: &Complex<f64>) -> bool {
    lambda.re > ROUNDING * lambda.norm()
}

/// Whether an eigenvalue has an imaginary part above rounding; of a pair the one in the upper half plane.
pub(super) fn oscillates(lambda: &Complex<f64>) -> bool {
    lambda.im > 1e-6 * lambda.norm()
}

/// One mode at one wind speed.
#[derive(Debug, Clone)]
pub(super) struct Mode {
    /// Place of the degree of freedom that the mode moves in still air.
    pub(super) branch: usize,
    /// Eigenvalue, rad/s, in the upper half plane.
    pub(super) lambda: Complex<f64>,
    /// Displacements (n): m, rad.
    pub(super) shape: DVector<Complex<f64>>,
    /// How the eigenvalue came here, where the next is predicted by it.
    pub(super) course: EigenvalueTrend,
}

impl Mode {
    /// The mode of a branch that nothing is known to have come from.
    pub(super) fn new(branch: usize, lambda: Complex<f64>, shape: DVector<Complex<f64>>) -> Self {
        let course = EigenvalueTrend::default();
        Self {
            branch,
            lambda,
            shape,
            course,
        }
    }
}

/// How an eigenvalue went over the last wind speeds: the divided differences of Newton's interpolation.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct EigenvalueTrend {
    /// The speed before, m/s.
    before: Option<f64>,
    /// First difference, rad/s per m/s.
    slope: Complex<f64>,
    /// Second difference.
    bend: Complex<f64>,
}

impl EigenvalueTrend {
    /// What an eigenvalue at `speed` is going to change by up to `next`, on a straight line.
    pub(super) fn straight(&self, speed: f64, next: f64) -> Complex<f64> {
        self.slope * (next - speed)
    }

    /// The same on a parabola.
    pub(super) fn curved(&self, speed: f64, next: f64) -> Complex<f64> {
        let further = self.before.map_or(0.0, |before| next - before);
        self.straight(speed, next) + self.bend * ((next - speed) * further)
    }

    /// The course at `next`, to where the eigenvalue has changed from `speed`.
    pub(super) fn to(&self, speed: f64, next: f64, change: Complex<f64>) -> Self {
        // what is left of a way that was halved is rounding, and its difference quotient noise
        if (next - speed).abs() <= NO_STEP * next.abs() {
            return *self;
        }
        let slope = change / (next - speed);
        let bend = self.before.filter(|before| *before != next);
        Self {
            before: Some(speed),
            slope,
            bend: bend.map_or(Complex::default(), |before| {
                (slope - self.slope) / (next - before)
            }),
        }
    }
}

/// The modes that oscillate at one wind speed, in the order of the degrees of freedom.
#[derive(Debug, Clone, Default)]
pub(super) struct Modes {
    /// m/s.
    pub(super) speed: f64,
    pub(super) all: Vec<Mode>,
}

impl Modes {
    /// The mode of a branch, unless it has stopped oscillating.
    pub(super) fn mode(&self, branch: usize) -> Option<&Mode> {
        self.all.iter().find(|m| m.branch == branch)
    }

    /// The mode of a branch with those that it may meet: what they do together, the others leave alone.
    pub(super) fn around(&self, branch: usize) -> Self {
        let Some(mode) = self.mode(branch) else {
            return self.clone();
        };
        let distance = |m: &Mode| (m.lambda - mode.lambda).norm();
        let mut all: Vec<f64> = self.all.iter().map(distance).collect();
        all.sort_by(f64::total_cmp);
        let nearest = all.get(NEAREST).copied().unwrap_or(f64::INFINITY);
        let far = nearest.max(AROUND * mode.lambda.norm());
        let near = self.all.iter().filter(|m| distance(m) <= far);
        Self {
            speed: self.speed,
            all: near.cloned().collect(),
        }
    }
}

/// Modes that clearly go on from those before, or else what is found in their place.
pub(super) type Continued = std::result::Result<Modes, Modes>;

/// A route that follows the modes of a structure over wind speed.
pub(super) trait Follower {
    /// The route.
    const METHOD: OnsetMethod;

    fn structure(&self) -> &Structure;

    /// Halvings of a step before what is left of the modes goes on.
    const MAX_HALVINGS: usize;

    /// Whether steps become longer again after they were halved.
    const LENGTHENS: bool;

    /// The modes at `speed` where each clearly goes on from one before, else what is found there.
    fn continued(&self, before: &Modes, speed: f64) -> Result<Continued>;

    /// The modes that go on where no step is short enough, `after` being what is found there: at that speed, or at the one before.
    fn without_lost(&self, before: &Modes, after: Modes) -> Result<Modes>;

    /// The modes at `speed`, by as many intermediate speeds as continuity needs.
    fn advance(&self, from: &Modes, speed: f64) -> Result<Modes> {
        self.advance_with(from, speed, None)
    }

    /// The same, but no further than a branch is among them.
    fn advance_with(&self, from: &Modes, speed: f64, branch: Option<usize>) -> Result<Modes> {
        let mut at = from.clone();
        let (mut step, mut halvings) = (speed - at.speed, 0);
        while at.speed != speed {
            let beyond = (at.speed + step - speed) * step.signum() >= 0.0;
            let target = if beyond { speed } else { at.speed + step };
            match self.continued(&at, target)? {
                Ok(next) => {
                    at = next;
                    // one place that asks for short steps is soon behind
                    if Self::LENGTHENS && halvings > 0 {
                        halvings -= 1;
                        step *= 2.0;
                    }
                }
                Err(_) if halvings < Self::MAX_HALVINGS => {
                    halvings += 1;
                    step *= 0.5;
                }
                Err(after) => {
                    let left = self.without_lost(&at, after)?;
                    if branch.is_some_and(|branch| left.mode(branch).is_none()) {
                        return Ok(at);
                    }
                    if left.speed == at.speed {
                        (step, halvings) = (speed - at.speed, 0);
                    }
                    at = left;
                }
            }
        }
        Ok(at)
    }

    /// The error for a mode that has ended at `speed`.
    fn lost(speed: f64) -> Error;

    /// The onset with what this route knows besides, `low` being the modes at a speed below; `None` where it is none.
    fn complete(&self, onset: Onset, low: &Modes, mode: &Mode) -> Result<Option<Onset>>;

    /// The mode of a branch at `speed`, from the modes nearby.
    fn mode_at(&self, from: &Modes, speed: f64, branch: usize) -> Result<Mode> {
        let modes = self.advance(&from.around(branch), speed)?;
        modes.mode(branch).cloned().ok_or_else(|| Self::lost(speed))
    }

    /// `K` of a mode.
    fn k(&self, speed: f64, mode: &Mode) -> ReducedFrequency {
        ReducedFrequency::from_circular(mode.lambda.im, self.structure().width_m, speed)
    }

    /// Name of the branch.
    fn name(&self, branch: usize) -> String {
        self.structure().branch_name(branch)
    }
}

/// The search for an onset along one route.
pub(super) struct OnsetWatch<'a, F> {
    /// Name of the force model.
    pub(super) model: &'a str,
    pub(super) follower: &'a F,
    /// Reduced frequencies into which modes may come with rising speed.
    pub(super) tested: Option<ReducedFrequencyRange>,
    /// Reduced frequencies in which a mode can be judged; `None` everywhere.
    pub(super) judged: Option<ReducedFrequencyRange>,
}

impl<F: Follower> OnsetWatch<'_, F> {
    /// Adds what happens between two neighbouring speeds: modes that lose their damping, modes that come into the tested
    /// range growing, and where modes can no longer be judged.
    pub(super) fn step(&self, low: &Modes, high: &Modes, found: &mut Findings) -> Result<()> {
        self.look(low, high, found);
        for after in &high.all {
            let Some(before) = low.mode(after.branch) else {
                continue;
            };
            let grows = [before, after].map(|mode| mode.lambda.re >= 0.0);
            if grows[0] != grows[1] {
                let (speed, mode) = self.zero(low, high, after.branch, |_, m| m.lambda.re)?;
                let (s, name) = (self.follower.structure(), self.follower.name(mode.branch));
                if grows[1] {
                    let onset = Onset::new(self.motion(speed, &mode), s, &mode.shape, name);
                    let onset = self.follower.complete(onset, low, &mode)?;
                    found.crossings.extend(onset);
                } else {
                    found.recoveries.push((speed, name));
                }
            }
            if grows.contains(&true) {
                found.starts.extend(self.entry(low, high, after.branch)?);
            }
        }
        Ok(())
    }

    /// Adds the ends of what can be judged that modes pass between two speeds.
    fn look(&self, low: &Modes, all_high: &Modes, found: &mut Findings) {
        let Some(range) = self.judged else { return };
        let slowness = |v: f64, mode: &Mode| 1.0 / self.follower.k(v, mode).full_width();
        for before in &low.all {
            let branch = self.follower.name(before.branch);
            let lost = all_high.mode(before.branch).is_none();
            let last;
            let high = if lost {
                let (follower, end) = (self.follower, all_high.speed);
                let reached = follower.advance_with(low, end, Some(before.branch));
                last = reached.unwrap_or_else(|_| low.clone());
                &last
            } else {
                all_high
            };
            if let Some(after) = high.mode(before.branch) {
                let refined = |limit: f64| {
                    let beyond = |v: f64, mode: &Mode| slowness(v, mode) - limit;
                    let passage = self.zero(low, high, after.branch, beyond);
                    passage.ok().map(|(speed, _)| speed)
                };
                let [before, after] = [(low, before), (high, after)]
                    .map(|(at, mode)| ValueAt::new(at.speed, slowness(at.speed, mode)));
                found.reach.look(range, &branch, before, after, refined);
            }
            if lost {
                found.reach.exits.push((high.speed, branch, Exit::Lost));
            }
        }
    }

    fn motion(&self, speed: f64, mode: &Mode) -> CriticalPoint {
        let s = self.follower.structure();
        CriticalPoint::of_motion(self.model, F::METHOD, s, speed, mode.lambda.im)
    }

    /// Growth of a mode where it can be judged first.
    pub(super) fn start(&self, speed: f64, mode: &Mode, reason: String) -> UnstableStart {
        let (at, branch) = (self.motion(speed, mode), self.follower.name(mode.branch));
        let mut start = UnstableStart::new(at, mode.lambda.re, branch, reason);
        let k = start.at.reduced_frequency;
        start.in_tested_range = self.tested.map(|range| range.contains(k));
        start
    }

    /// A mode that comes into the tested range between two speeds and grows there.
    fn entry(&self, low: &Modes, high: &Modes, branch: usize) -> Result<Option<UnstableStart>> {
        let Some(range) = self.tested else {
            return Ok(None);
        };
        let beyond =
            |v: f64, mode: &Mode| range.max.full_width() - self.follower.k(v, mode).full_width();
        let is_beyond = |modes: &Modes| {
            let mode = modes.mode(branch);
            mode.is_some_and(|mode| self.follower.k(modes.speed, mode) > range.max)
        };
        if !is_beyond(low) || is_beyond(high) {
            return Ok(None);
        }
        let (speed, mode) = self.zero(low, high, branch, beyond)?;
        Ok(growing(&mode.lambda).then(|| {
            let mut start = self.start(speed, &mode, entry_reason(range.max));
            start.in_tested_range = Some(true);
            start
        }))
    }

    /// The speed between two at which a number of one mode is zero, and the mode there.
    fn zero(
        &self,
        low: &Modes,
        high: &Modes,
        branch: usize,
        value: impl Fn(f64, &Mode) -> f64,
    ) -> Result<(f64, Mode)> {
        let mode_at = |v: f64| self.follower.mode_at(low, v, branch);
        let end = |modes: &Modes| {
            let mode = modes.mode(branch).ok_or_else(|| F::lost(modes.speed))?;
            Ok(ValueAt::new(modes.speed, value(modes.speed, mode)))
        };
        let speed = root(end(low)?, end(high)?, |v| Ok(value(v, &mode_at(v)?)))?;
        Ok((speed, mode_at(speed)?))
    }
}

/// Displacements in the dimensionless motion `(y/B, x/B, θ)`.
pub(super) fn dimensionless(s: &Structure, shape: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
    DVector::from_fn(shape.len(), |i, _| {
        shape[i] * s.dofs[i].motion_scale(s.width_m)
    })
}

/// Modal assurance criterion of two shapes: 1 for the same shape.
pub(super) fn assurance(u: &DVector<Complex<f64>>, v: &DVector<Complex<f64>>) -> f64 {
    u.dotc(v).norm_sqr() / (u.norm_squared() * v.norm_squared())
}
