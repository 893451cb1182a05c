//! Onset and divergence of an exported bridge.

use super::bridge_built::BuiltBridge;
use super::bridge_followed::SearchedOnset;
use super::section::OnsetCard;
use crate::bridge::Bridge;
use crate::flutter::{
    FastMotion, FlutterSearch, NearbyOnset, OnsetSearch, bridge_damps_fast_motion,
};
use crate::onset_start::simulated_onset;
use crate::units::{ReducedFrequency, ReducedFrequencyRange, ReducedVelocity};

/// Speeds of the search for the onset; more than for a section would take seconds.
const SPEEDS: usize = 60;

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
    fn of_divergence(built: &BuiltBridge, limit: f64) -> Result<Self, Self> {
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
        let search = OnsetSearch {
            speed_max_m_s: limit,
            speeds: SPEEDS,
        };
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
