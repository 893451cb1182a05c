//! The onset of a bridge whose parameters have changed, followed from that of a search: hundreds of eigenvalue problems less.
//!
//! What is followed is one motion, and another may have become critical before it, which is followed in its stead. An onset counts only
//! where all eigenvalues say the same: nothing grows just below it nor at close speeds down to the last at which no mode has lost much of
//! the damping that it had below the onset of the search. Everything else is searched for.

use super::bridge_built::BuiltBridge;
use crate::aeroelastic::CoupledSection;
use crate::bridge::Bridge;
use crate::error::Result;
use crate::flutter::{CriticalPoint, NearbyOnset, Onset, OnsetMethod};
use crate::onset_start::{COMPARED_AT, OnsetStart};
use crate::units::ReducedFrequency;

/// Change of a parameter, as a part of it, beyond which an onset is searched for.
const NEAR: f64 = 0.3;
/// Bridges on the way to one whose motion cannot be followed at once.
const STEPS: usize = 5;
/// Part of the damping that has to be left.
const LEFT: f64 = 0.5;
/// Speed below the onset, as a part of it, at which nothing may grow: far more than the onset is uncertain by, far less than
/// another mode needs to lose its damping.
const JUST_BELOW: f64 = 1.0 - 1e-5;
/// Speeds below that one at which nothing may grow either, as a motion does that is damped again before the onset, and how far they
/// are apart, as a part of the onset: down to those of [`COMPARED_AT`].
const LOOKED_AT: usize = 9;
const APART: f64 = 0.015;
/// Motions that take the place of another at most.
const OTHERS: usize = 3;

/// An onset that was searched for.
#[derive(Debug, Clone)]
pub(super) struct SearchedOnset {
    motion: NearbyOnset,
    damping_below: [f64; 2],
    /// Of the bridge that was searched.
    parameters: Vec<f64>,
}

impl SearchedOnset {
    /// That of a search; `None` where there is more to say of it than a speed.
    pub(super) fn from_onset(built: &BuiltBridge, onset: &Onset) -> Option<Self> {
        let start = OnsetStart::from_onset(onset, built.stepper.section())?;
        Self::from(built, &start).ok()
    }

    /// That which came with the archive, for the bridge as it was exported.
    pub(super) fn from(built: &BuiltBridge, start: &OnsetStart) -> Result<Self> {
        let bridge = &built.own.bridge;
        let (speed, hertz) = (start.speed_m_s, start.frequency_hz);
        let k = ReducedFrequency::from_hertz(hertz, bridge.width_m(), speed);
        let at = CriticalPoint::new("bridge", OnsetMethod::Eigenvalues, speed, hertz, k);
        Ok(Self {
            motion: NearbyOnset::new(bridge, &at)?,
            damping_below: start.damping_below,
            parameters: parameters(&mut bridge.clone()),
        })
    }

    /// The onset of a bridge up to `limit`, m/s; `None` where it has to be searched for.
    pub(super) fn followed(&self, built: &mut BuiltBridge, limit: f64) -> Option<NearbyOnset> {
        let now = parameters(&mut built.own.bridge);
        let near = |(now, then): (&f64, &f64)| (now - then).abs() <= NEAR * then.abs();
        if now.len() != self.parameters.len() || !now.iter().zip(&self.parameters).all(near) {
            return None;
        }
        let at_once = self.motion.follow(built.stepper.section());
        let mut next = at_once.or_else(|| self.in_steps(&built.own.bridge, &now))?;
        if !next.resembles(&self.motion) {
            return None;
        }
        // another motion may have become critical before it, and a third before that
        for _ in 0..=OTHERS {
            let speed = next.speed_m_s;
            if !(speed > 0.0 && speed <= limit) {
                return None;
            }
            if !grows_below(built, speed)? {
                return self.is_damped(built, speed).then_some(next);
            }
            next = built.least_damped()?.follow(built.stepper.section())?;
        }
        None
    }

    /// Whether well below an onset the damping that there was is left.
    fn is_damped(&self, built: &mut BuiltBridge, onset_m_s: f64) -> bool {
        let mut parts = COMPARED_AT.iter().zip(&self.damping_below);
        parts.all(|(part, before)| {
            let damping = built.damping_at(part * onset_m_s);
            *before > 0.0 && damping.is_ok_and(|d| d > LEFT * before)
        })
    }

    /// The motion followed through bridges between that of the search and the one with the parameters `now`.
    fn in_steps(&self, bridge: &Bridge, now: &[f64]) -> Option<NearbyOnset> {
        let mut between = bridge.clone();
        let mut motion = self.motion.clone();
        for step in 1..=STEPS {
            let part = step as f64 / STEPS as f64;
            let values = self.parameters.iter().zip(now);
            for (parameter, (a, b)) in between.tunable().zip(values) {
                *parameter = a + part * (b - a);
            }
            let forces = between.forces().realize().ok()?;
            let section = CoupledSection::new(between.structure(), forces).ok()?;
            motion = motion.follow(&section)?;
        }
        Some(motion)
    }
}

/// Whether something grows just below an onset or at the speeds below that; `None` where that is not known, as where all damping dips
/// between two of them.
fn grows_below(built: &mut BuiltBridge, onset_m_s: f64) -> Option<bool> {
    let mut seen: Vec<f64> = Vec::with_capacity(LOOKED_AT + 1);
    for i in 0..=LOOKED_AT {
        let part = JUST_BELOW - APART * i as f64;
        let damping = built.damping_at(part * onset_m_s).ok()?;
        if damping <= 0.0 {
            return Some(true);
        }
        seen.push(damping);
    }
    let dips = |d: &[f64]| d[1] < LEFT * d[0].min(d[2]);
    (!seen.windows(3).any(dips)).then_some(false)
}

/// What may be tuned.
fn parameters(bridge: &mut Bridge) -> Vec<f64> {
    bridge.tunable().map(|parameter| *parameter).collect()
}
