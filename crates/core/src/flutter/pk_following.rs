//! Modes of the p-k iteration followed over wind speed by what they are: small changes and like shapes from step to step.

use super::critical_point::OnsetMethod;
use super::determinant::StructureInWind;
use super::following::{
    Continued, Follower, MIN_ASSURANCE, Mode, Modes, SEPARATION, assurance, dimensionless,
};
use super::judged::{Exit, RangePassages};
use super::onset::Onset;
use super::still_air::{coupled_modes, is_coupled};
use crate::error::{Error, Result};
use crate::section::Structure;
use crate::state_space::{ValueAt, eigenvalues, eigenvector, first_order, root};
use crate::threads;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use nalgebra::{Complex, DVector};
use std::f64::consts::TAU;

/// Relative change of an eigenvalue over one step above which the step is halved.
const MAX_CHANGE: f64 = 0.05;
/// Modal assurance below which a mode is another one.
const OTHER_MODE: f64 = 0.5;
/// Damping at a refined crossing above which it is none.
const JUMP: f64 = 1e-6;
/// Lowest speed as `V/(fB)` of the slowest mode: nearly still air.
const NEARLY_STILL: f64 = 0.01;
/// Steps in which the air comes to its density where a table begins.
const AIR_STEPS: usize = 40;

/// Called with the modes at two neighbouring speeds.
pub(super) type OnStep<'a> = &'a mut dyn FnMut(&Modes, &Modes) -> Result<()>;

fn same_root(a: &Mode, b: &Mode) -> bool {
    (a.lambda - b.lambda).norm() <= SEPARATION * a.lambda.norm()
}

impl StructureInWind<'_> {
    /// Follows every mode from where it is first known over the rising `speeds`, and further to where it leaves the range
    /// of the model; back come the modes at the lowest speeds (m/s) at which they are known. `on_step` sees both ends of every step, also those where a mode enters or leaves.
    pub(super) fn march(
        &self,
        speeds: &[f64],
        on_step: OnStep<'_>,
    ) -> Result<(Vec<(f64, Mode)>, RangePassages)> {
        let entries = self.entries(speeds)?;
        let named = |(speed, mode): &(f64, Mode)| (*speed, self.name(mode.branch));
        let mut reach = RangePassages::default();
        if self.model.known_range().is_some() {
            reach.entries = entries.iter().map(named).collect();
        }
        let mut waiting = entries.iter().peekable();
        let mut at = Modes::default();
        for &speed in speeds {
            loop {
                let entry = waiting.peek().filter(|e| e.0 <= speed);
                let target = entry.map_or(speed, |e| e.0);
                if at.all.is_empty() {
                    at.speed = target;
                }
                if at.speed < target {
                    let before = at;
                    at = self.step(&before, target, &mut reach)?;
                    on_step(&before, &at)?;
                    if let Some(range) = self.model.known_range() {
                        let lowest = range.min.full_width() * (1.0 + SEPARATION);
                        let speed = at.speed;
                        at.all.retain(|m| self.k(speed, m).full_width() > lowest);
                    }
                }
                if at.speed < target {
                    continue;
                }
                match waiting.next_if(|e| e.0 <= speed) {
                    Some((_, mode)) => at.all.push(mode.clone()),
                    None => break,
                }
            }
        }
        Ok((entries, reach))
    }

    /// The modes at `target`, or where the first of them leaves the range of the model before that.
    fn step(&self, from: &Modes, target: f64, reach: &mut RangePassages) -> Result<Modes> {
        let next = self.advance(from, target)?;
        let Some(range) = self.model.known_range() else {
            return Ok(next);
        };
        let leaving = |m: &&Mode| self.k(target, m) < range.min;
        let mut first: Option<(f64, usize)> = None;
        for mode in next.all.iter().filter(leaving) {
            let beyond = |k: ReducedFrequency| k.full_width() - range.min.full_width();
            let Some(before) = from.mode(mode.branch) else {
                continue;
            };
            let end = |at: f64, mode: &Mode| ValueAt::new(at, beyond(self.k(at, mode)));
            let last = end(target, mode);
            let speed = root(end(from.speed, before), last, |v| {
                let modes = self.advance(&from.around(mode.branch), v)?;
                Ok(modes
                    .mode(mode.branch)
                    .map_or(last.value, |m| beyond(self.k(v, m))))
            })?;
            if first.is_none_or(|f| speed < f.0) {
                first = Some((speed, mode.branch));
            }
        }
        let Some((speed, branch)) = first.filter(|f| f.0 > from.speed) else {
            return Ok(next);
        };
        let exit = Exit::Below(range.min);
        reach.exits.push((speed, self.name(branch), exit));
        self.advance(from, speed)
    }

    /// Every mode where it is known first, by rising speed: in nearly still air, or at the highest `K` of a table.
    fn entries(&self, speeds: &[f64]) -> Result<Vec<(f64, Mode)>> {
        let still = self.still_air();
        let mut entries = match self.model.known_range() {
            Some(range) => self.entries_into(range.not_empty()?, &still)?,
            None => {
                let slowest = still.all.iter().map(|m| m.lambda.im / TAU);
                let slowest = slowest.fold(f64::INFINITY, f64::min);
                let speed = NEARLY_STILL * slowest * self.structure.width_m;
                let speed = speed.min(0.5 * speeds.first().copied().unwrap_or(f64::INFINITY));
                let modes = self.advance(&still, speed)?.all;
                modes.into_iter().map(|mode| (speed, mode)).collect()
            }
        };
        entries.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(entries)
    }

    /// The modes at the highest `K` of a table: those of the structure without air, followed while the air comes to its
    /// density.
    fn entries_into(
        &self,
        range: ReducedFrequencyRange,
        still: &Modes,
    ) -> Result<Vec<(f64, Mode)>> {
        let mut thin = self.structure.clone();
        let mut at: Vec<(f64, Mode)> = still.all.iter().map(|m| (0.0, m.clone())).collect();
        for i in 1..=AIR_STEPS {
            thin.air_density_kg_m3 = self.structure.air_density_kg_m3 * i as f64 / AIR_STEPS as f64;
            let before: Vec<Mode> = at.into_iter().map(|(_, mode)| mode).collect();
            let problem = StructureInWind {
                structure: &thin,
                ..*self
            };
            let solved = |mode: &Mode| problem.pk_mode_at(range.max, mode);
            at = self.of_each(&before, solved)?;
            for i in 0..at.len() {
                let double = (0..i).find(|&j| same_root(&at[i].1, &at[j].1));
                let start = double.and_then(|j| self.drawn_apart(&before, &at[i].1, &at[j].1));
                let own = start.map(|start| solved(&start)).transpose()?.flatten();
                let is_new = |own: &(f64, Mode)| at.iter().all(|(_, m)| !same_root(&own.1, m));
                if let Some(own) = own.filter(is_new) {
                    at[i] = own;
                }
            }
        }
        Ok(at)
    }

    /// Where a mode that came on the root of another can start anew: the first breath of wind mixes the shapes of modes of like
    /// frequencies, and what the `other` has not taken of them is left for it. Nothing for a section, whose roots are all computed.
    fn drawn_apart(&self, before: &[Mode], double: &Mode, other: &Mode) -> Option<Mode> {
        let of = |branch: usize| before.iter().find(|m| m.branch == branch);
        let (own, taken) = (of(double.branch)?, other.shape.normalize());
        let rest = |m: &Mode| {
            let shape = m.shape.normalize();
            let along = taken.dotc(&shape);
            shape - &taken * along
        };
        let (of_own, of_other) = (rest(own), rest(of(other.branch)?));
        let own_is_larger = of_own.norm() > of_other.norm();
        let shape = if own_is_larger { of_own } else { of_other };
        let is_left = self.structure.is_modal() && shape.norm() > SEPARATION;
        is_left.then(|| Mode::new(own.branch, own.lambda, shape))
    }

    /// What is found of each mode, on all cores where there are many.
    fn of_each<T: Send>(
        &self,
        modes: &[Mode],
        find: impl Fn(&Mode) -> Result<Option<T>> + Send + Sync,
    ) -> Result<Vec<T>> {
        let found = threads::each(modes, self.structure.is_modal(), find);
        found.into_iter().filter_map(Result::transpose).collect()
    }

    /// The modes in still air; an undamped one counts as damped, so that it can lose its damping.
    fn still_air(&self) -> Modes {
        let s = self.structure;
        let n = s.dofs.len();
        if let Some(all) = self.coupled() {
            return Modes { speed: 0.0, all };
        }
        let mode = |i: usize| {
            let (mass, stiffness) = (s.mass[(i, i)], s.stiffness[(i, i)]);
            let decay = s.damping[(i, i)] / (2.0 * mass);
            let omega = (stiffness / mass - decay * decay).max(0.0).sqrt();
            let mut shape = DVector::zeros(n);
            shape[i] = Complex::new(1.0, 0.0);
            let lambda = Complex::new(-decay, omega);
            still_mode(i, lambda, shape)
        };
        Modes {
            speed: 0.0,
            all: (0..n).map(mode).filter(|m| m.lambda.im > 0.0).collect(),
        }
    }

    /// Modes of a section with static unbalance or of a bridge with dampers, `None` without or when a section has one that does not
    /// oscillate. Unbalance draws the frequencies apart, so that they stay in the order of the degrees of freedom by themselves.
    fn coupled(&self) -> Option<Vec<Mode>> {
        let s = self.structure;
        let n = s.dofs.len();
        if !is_coupled(s) {
            return None;
        }
        let inverse = s.mass.clone().try_inverse()?;
        if s.is_modal() {
            let modes = coupled_modes(s, &inverse).ok()?.into_iter();
            let still = modes.map(|m| still_mode(m.branch, m.lambda, m.shape));
            return Some(still.collect());
        }
        let a = first_order(&inverse, &-&s.stiffness, &-&s.damping);
        let mut natural = eigenvalues(&a).ok()?;
        natural.retain(|z| z.im > 0.0);
        natural.sort_by(|a, b| a.im.total_cmp(&b.im));
        let rows = s.rows_by_frequency();
        let modes = rows.into_iter().zip(natural).map(|(row, lambda)| {
            let shape = eigenvector(&a, lambda).ok()?.rows(0, n).into_owned();
            Some(still_mode(row, lambda, shape))
        });
        let mut modes: Vec<_> = modes.collect::<Option<_>>()?;
        modes.sort_by_key(|m| m.branch);
        (modes.len() == n).then_some(modes)
    }

    fn continuous(&self, before: &Modes, after: &Modes) -> bool {
        let still = before.speed == 0.0;
        let doubled =
            (0..after.all.len()).any(|i| (0..i).any(|j| same_root(&after.all[i], &after.all[j])));
        !doubled
            && before.all.iter().zip(&after.all).all(|(a, b)| {
                let change = (b.lambda - a.lambda).norm() / a.lambda.norm();
                // the added mass of the air changes the modes at once, however slow the wind
                still || change < MAX_CHANGE && self.assurance(a, b) > MIN_ASSURANCE
            })
    }

    fn assurance(&self, a: &Mode, b: &Mode) -> f64 {
        let of = |m: &Mode| dimensionless(self.structure, &m.shape);
        assurance(&of(a), &of(b))
    }
}

impl Follower for StructureInWind<'_> {
    const METHOD: OnsetMethod = OnsetMethod::PkIteration;
    const MAX_HALVINGS: usize = 8;
    const LENGTHENS: bool = true;

    fn structure(&self) -> &Structure {
        self.structure
    }

    fn continued(&self, before: &Modes, speed: f64) -> Result<Continued> {
        // those that settle and oscillate
        let all = self.of_each(&before.all, |mode| self.pk_mode(speed, mode))?;
        let after = Modes { speed, all };
        let clear = after.all.len() == before.all.len() && self.continuous(before, &after);
        Ok(if clear { Ok(after) } else { Err(after) })
    }

    /// Where a step cannot be made smooth: the modes that went on; of two on one root the one that moved less, the first where
    /// both came on it together, as a mode does that enters a table on the root of another.
    fn without_lost(&self, before: &Modes, after: Modes) -> Result<Modes> {
        let moved = |mode: &Mode| {
            let old = before.mode(mode.branch);
            old.map_or(f64::INFINITY, |old| (mode.lambda - old.lambda).norm())
        };
        let nearest = |(i, m): (usize, &Mode)| {
            let mut rivals = after.all.iter().enumerate().filter(|r| same_root(r.1, m));
            rivals.all(|(j, rival)| j == i || (moved(m), i) < (moved(rival), j))
        };
        // a mode that would have to change its shape at once is another one: the branch ends here
        let same = |mode: &Mode| {
            let old = before.mode(mode.branch);
            before.speed == 0.0 || old.is_none_or(|old| self.assurance(old, mode) > OTHER_MODE)
        };
        let going_on = after.all.iter().enumerate();
        let going_on = going_on.filter(|(i, m)| nearest((*i, m)) && same(m));
        let all = going_on.map(|(_, m)| m.clone()).collect();
        Ok(Modes {
            speed: after.speed,
            all,
        })
    }

    fn lost(speed: f64) -> Error {
        Error::Numerical(format!("p-k: the mode is lost at {speed:.3} m/s"))
    }

    fn complete(&self, mut onset: Onset, _low: &Modes, mode: &Mode) -> Result<Option<Onset>> {
        if mode.lambda.re.abs() > JUMP * mode.lambda.norm() {
            // the damping jumps through zero: the iteration changed to another root
            return Ok(None);
        }
        let (speed, omega) = (onset.at.speed_m_s, mode.lambda.im);
        onset.damping_slope_s_m = self.damping_slope(speed, omega);
        Ok(Some(onset))
    }
}

/// A mode in still air; an undamped one counts as damped, so that it can lose its damping.
fn still_mode(branch: usize, lambda: Complex<f64>, shape: DVector<Complex<f64>>) -> Mode {
    let lambda = Complex::new(lambda.re.min(-f64::MIN_POSITIVE), lambda.im);
    Mode::new(branch, lambda, shape)
}
