//! The wind speeds at which every mode has a reduced frequency that was tested.

use crate::flutter::{FlutterCurves, ModePoint, StableRange, TestedFrom};
use crate::units::{ReducedFrequency, ReducedFrequencyRange};

/// How far tests reach as the wind rises.
#[derive(Debug, Clone, PartialEq)]
pub struct Reach {
    /// Lowest speed at which every mode lies among the tests, or above them where the forces damp every such motion, m/s.
    pub from_m_s: f64,
    /// The last mode that comes among the tests as the wind rises; `None` where all are from the beginning.
    pub tested_from: Option<TestedFrom>,
    /// Highest, m/s.
    pub to_m_s: f64,
    /// Why nothing is known outside.
    pub why: Option<String>,
    /// Lowest reduced frequency of any mode over the wind speed, in rising order of the speed: m/s, `K`.
    pub(super) lowest: Vec<(f64, f64)>,
}

impl Reach {
    /// Tests that reach every speed.
    pub fn everywhere() -> Self {
        Self {
            from_m_s: 0.0,
            tested_from: None,
            to_m_s: f64::INFINITY,
            why: None,
            lowest: Vec::new(),
        }
    }

    /// Tests of a table, beyond which nothing is searched.
    pub fn of_table(tested_from: Option<TestedFrom>) -> Self {
        Self {
            tested_from,
            ..Self::everywhere()
        }
    }

    /// Tests of which it is not known at which speeds modes are among them.
    pub fn nowhere() -> Self {
        Self {
            to_m_s: 0.0,
            ..Self::everywhere()
        }
    }

    /// The speeds that a search of a structure of this width could `judge`; its modes are in `curves`.
    pub fn new(
        judged: StableRange,
        tested_from: Option<TestedFrom>,
        curves: &FlutterCurves,
        width_m: f64,
    ) -> Self {
        let mut all: Vec<&ModePoint> = curves.branches.iter().flat_map(|b| &b.points).collect();
        all.sort_by(|a, b| a.speed_m_s.total_cmp(&b.speed_m_s));
        let mut lowest: Vec<(f64, f64)> = Vec::new();
        for point in all {
            let k = ReducedFrequency::from_hertz(point.frequency_hz, width_m, point.speed_m_s)
                .full_width();
            if lowest.last().is_none_or(|(_, least)| k < *least) {
                lowest.push((point.speed_m_s, k));
            }
        }
        Self {
            from_m_s: judged.from_m_s,
            tested_from,
            to_m_s: judged.to_m_s,
            why: judged.not_judged,
            lowest,
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
