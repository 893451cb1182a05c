//! Which of all crossings is the answer, as [`find_onset`](crate::flutter::find_onset) chooses it.

use super::{Crossing, Roots, Sweep, SweepOutcome, SweptOnset};
use crate::units::ReducedFrequency;

impl<const N: usize> Sweep<'_, N> {
    /// Notes the speed of the slowest mode where modes leave the tested range.
    pub(super) fn leave(&mut self, roots: &Roots<N>) {
        if self.sweep.lower_ends.contains(&roots.k) {
            let alive = (0..N).filter(|i| roots.alive[*i]);
            let speeds = alive.map(|i| roots.omega[i].re * self.supports.width / roots.k);
            self.left = speeds.fold(self.left, f64::min);
        }
    }

    /// Speed of the lowest crossing inside the tested range so far: nothing above it can be the answer.
    pub(super) fn lowest(&self) -> f64 {
        let found = self.crossings[..self.found].iter().flatten();
        found
            .filter(|c| c.destabilises && self.inside(c))
            .map(|c| c.speed)
            .chain(self.unstable().map(|(speed, _)| speed))
            .fold(f64::INFINITY, f64::min)
    }

    /// Growth where a mode was first judged, of those that are no extrapolation.
    fn unstable(&self) -> Option<(f64, f64)> {
        let is_tested = self.sweep.forces.tested.is_some();
        if is_tested { self.entered } else { self.still }
    }

    fn k(&self, c: &Crossing) -> ReducedFrequency {
        ReducedFrequency::from_circular(c.omega, self.supports.width, c.speed)
    }

    /// Whether its `K` lies between the lowest and the highest tested.
    fn inside(&self, c: &Crossing) -> bool {
        let tested = self.sweep.forces.tested;
        tested.is_none_or(|range| range.spans(self.k(c)))
    }

    /// The lowest crossing inside the tested range or growth where a mode enters it, else the lowest outside.
    pub(super) fn choose(&self) -> SweepOutcome {
        let all = || {
            let found = self.crossings[..self.found].iter().flatten();
            found.filter(|c| c.destabilises)
        };
        let by_speed = |a: &&Crossing, b: &&Crossing| a.speed.total_cmp(&b.speed);
        let trusted = all().filter(|c| self.inside(c)).min_by(by_speed);
        let swept = |(speed, omega): (f64, f64), in_tested_range| SweptOnset {
            speed_m_s: speed,
            frequency_hz: omega / std::f64::consts::TAU,
            in_tested_range,
            spurious: all().filter(|c| c.speed < speed).count()
                + usize::from(self.still.is_some_and(|s| s.0 < speed)),
        };
        let below = |start: &(f64, f64)| trusted.is_none_or(|c| start.0 <= c.speed);
        if let Some(start) = self.unstable().filter(below) {
            return SweepOutcome::UnstableAtOrBelow(swept(start, true));
        }
        match (trusted.or_else(|| all().min_by(by_speed)), self.still) {
            (Some(chosen), _) => {
                let tested = self.sweep.forces.tested;
                let inside = tested.is_none_or(|range| range.contains(self.k(chosen)));
                SweepOutcome::Onset(swept((chosen.speed, chosen.omega), inside))
            }
            (None, Some(still)) => SweepOutcome::UnstableAtOrBelow(swept(still, false)),
            (None, None) => SweepOutcome::Stable {
                judged_to_m_s: self.left.min(self.sweep.speed_max),
            },
        }
    }
}
