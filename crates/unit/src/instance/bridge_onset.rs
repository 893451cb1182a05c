//! Onset and divergence of an exported bridge: searched for, or followed.
//!
//! The onset of a bridge whose parameters have changed, followed from that of a search: hundreds of eigenvalue problems less.
//!
//! What is followed is one motion, and another may have become critical before it, which is followed in its stead. An onset counts only
//! where all eigenvalues say the same: nothing grows just below it nor at close speeds down to the last at which no mode has lost much of
//! the damping that it had below the onset of the search. Everything else is searched for.

use super::bridge_built::BuiltBridge;
use super::section::OnsetCard;
use crate::aeroelastic::CoupledSection;
use crate::bridge::Bridge;
use crate::error::Result;
use crate::flutter::{
    CriticalPoint, FastMotion, FlutterSearch, NearbyOnset, Onset, OnsetMethod, OnsetSearch,
    bridge_damps_fast_motion,
};
use crate::onset_start::{COMPARED_AT, OnsetStart, simulated_onset};
use crate::units::{ReducedFrequency, ReducedFrequencyRange, ReducedVelocity};

/// Speeds of the search for the onset; more than for a section would take seconds.
const SPEEDS: usize = 60;
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

/// Why damping is not known in wind slower than every test of a bridge, in reduced frequencies of its own and of its `sections`; no
/// parameter changes it.
pub(super) fn slow_wind(
    bridge: &Bridge,
    tested: ReducedFrequencyRange,
    sections: &[ReducedFrequencyRange],
) -> Option<&'static str> {
    // what cannot be said is not said to be damped
    let damps = bridge_damps_fast_motion(bridge, tested.max).unwrap_or(false);
    let damped = damps.then_some(FastMotion::Damped);
    FastMotion::new(damped, sections.iter().copied()).why_open()
}

impl OnsetCard {
    fn of_divergence(built: &BuiltBridge, limit: f64) -> std::result::Result<Self, Self> {
        let structure = built.stepper.section().structure();
        Self::with_divergence(structure, &built.own.bridge.forces(), limit)
    }

    /// With an onset up to `limit`, m/s, that was followed from one nearby; `None` outside the tested range, where a search has more
    /// to say.
    pub(super) fn of_followed(
        built: &mut BuiltBridge,
        tested: Option<ReducedFrequencyRange>,
        slow_wind: Option<&str>,
        limit: f64,
        onset: &NearbyOnset,
    ) -> Option<Self> {
        let (speed, hertz) = (onset.speed_m_s, onset.frequency_hz());
        let k = ReducedFrequency::from_hertz(hertz, built.own.bridge.width_m(), speed);
        if tested.is_some_and(|range| !range.contains(k)) {
            return None;
        }
        let mut card = Self::of_divergence(built, limit).ok()?;
        card.set_onset(speed, hertz, ReducedVelocity::from(k), tested.is_some());
        card.numbers.stable_below = true;
        card.judge(slow_wind);
        // what still lies above every end of the tests has passed none
        let slowest = built.slowest_at(speed);
        let left = |k| tested.is_some_and(|t| t.lower_ends().any(|(end, _)| k < end));
        if slowest.is_none_or(left) {
            card.look_beside_tests(built.stepper.section(), tested);
        }
        Some(card)
    }

    /// Searches a bridge up to `limit`, m/s, as [`OnsetCard::search`] a section. The tested range is that of the girder, in reduced
    /// frequencies of the bridge. Beside it the onset from which others may be followed.
    pub(super) fn of_bridge(
        built: &BuiltBridge,
        tested: Option<ReducedFrequencyRange>,
        slow_wind: Option<&str>,
        limit: f64,
    ) -> (Self, Option<SearchedOnset>) {
        let mut card = match Self::of_divergence(built, limit) {
            Ok(card) => card,
            Err(unknown) => return (unknown, None),
        };
        let mut searched = None;
        let search = OnsetSearch::new(limit, SPEEDS);
        match simulated_onset("bridge", built.stepper.section(), &search, tested) {
            Ok(found) => {
                let onset = found.onset();
                searched = onset.and_then(|o| SearchedOnset::from_onset(built, o));
                let grows = onset.is_some_and(|o| !o.spurious_speeds_m_s.is_empty())
                    || matches!(found, FlutterSearch::UnstableAtOrBelow(_));
                card.numbers.stable_below = !grows;
                card.take(found, limit);
            }
            Err(why) => card.onset_unknown(&why),
        }
        card.judge(slow_wind);
        card.look_beside_tests(built.stepper.section(), tested);
        (card, searched)
    }
}
