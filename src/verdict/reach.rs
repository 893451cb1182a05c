//! The wind speeds at which every mode has a reduced frequency that was tested.

use crate::flutter::{FlutterCurves, ModeBranch, ModePoint};
use crate::units::{ReducedFrequency, ReducedFrequencyRange};

/// How far tests reach as the wind rises.
#[derive(Debug, Clone, PartialEq)]
pub struct Reach {
    /// Lowest speed at which every mode lies among the tests, m/s.
    pub from_m_s: f64,
    /// Highest, m/s.
    pub to_m_s: f64,
    /// The mode that leaves the tests first, and the speed up to which it was followed.
    pub leaves: Option<String>,
    /// Lowest reduced frequency of any mode over the wind speed, in rising order of the speed: m/s, `K`.
    pub(super) lowest: Vec<(f64, f64)>,
}

impl Reach {
    /// Tests that reach every speed.
    pub fn everywhere() -> Self {
        Self {
            from_m_s: 0.0,
            to_m_s: f64::INFINITY,
            leaves: None,
            lowest: Vec::new(),
        }
    }

    /// Tests of which it is not known at which speeds modes are among them.
    pub fn nowhere() -> Self {
        Self {
            to_m_s: 0.0,
            ..Self::everywhere()
        }
    }

    /// The speeds of `curves`, of a structure of this width, at which every mode lies among the tests.
    pub fn of(curves: &FlutterCurves, width_m: f64, tested: ReducedFrequencyRange) -> Self {
        let mut reach = Self::everywhere();
        for branch in &curves.branches {
            reach.narrow(branch, width_m, tested);
        }
        if curves.ended.is_some() {
            let last = |b: &ModeBranch| b.points.last().map_or(0.0, |p| p.speed_m_s);
            let followed = curves.branches.iter().map(last).fold(0.0, f64::max);
            reach.to_m_s = reach.to_m_s.min(followed);
        }
        let mut all: Vec<&ModePoint> = curves.branches.iter().flat_map(|b| &b.points).collect();
        all.sort_by(|a, b| a.speed_m_s.total_cmp(&b.speed_m_s));
        let mut least = f64::INFINITY;
        for point in all {
            let k = reduced(point, width_m);
            if k < least {
                least = k;
                reach.lowest.push((point.speed_m_s, k));
            }
        }
        reach
    }

    /// Leaves out the speeds at which a mode lies outside the tests.
    fn narrow(&mut self, branch: &ModeBranch, width_m: f64, tested: ReducedFrequencyRange) {
        let (min, max) = (tested.min.full_width(), tested.max.full_width());
        let mut before: Option<(f64, f64)> = None;
        for point in &branch.points {
            let here = (point.speed_m_s, reduced(point, width_m));
            // K falls about as 1/V: V K is straight between neighbouring speeds
            let at = |k: f64| match before {
                Some((v, was)) if was != here.1 => {
                    v + (here.0 - v) * ((was - k) / (was - here.1)).clamp(0.0, 1.0)
                }
                _ => here.0,
            };
            if here.1 > max {
                self.from_m_s = self.from_m_s.max(here.0);
            } else if before.is_some_and(|(_, was)| was > max) {
                self.from_m_s = self.from_m_s.max(at(max));
            }
            if here.1 < min {
                let left = at(min);
                if left < self.to_m_s {
                    self.to_m_s = left;
                    self.leaves = Some(branch.name.clone());
                }
                return;
            }
            before = Some(here);
        }
    }

    /// The reduced frequencies below `tested` that modes come to at speeds up to this one; `None` where there are none.
    pub fn missing_up_to(
        &self,
        speed_m_s: f64,
        tested: ReducedFrequencyRange,
    ) -> Option<ReducedFrequencyRange> {
        let within = self.lowest.iter().take_while(|(v, _)| *v <= speed_m_s);
        let (_, least) = within.last()?;
        let min = ReducedFrequency::from_full_width(*least);
        (min < tested.min).then(|| ReducedFrequencyRange::between(min, tested.min))
    }
}

fn reduced(point: &ModePoint, width_m: f64) -> f64 {
    ReducedFrequency::from_hertz(point.frequency_hz, width_m, point.speed_m_s).full_width()
}
