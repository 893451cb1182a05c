//! Which terms of a form answer at once, without a filter.

use serde::{Deserialize, Serialize};

/// Feed-through of the motion (`e0`), its rate (`e1`) and its acceleration (`e2`), each on or off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FeedThrough {
    /// Motion.
    pub e0: bool,
    /// Rate.
    pub e1: bool,
    /// Acceleration (added mass of the air).
    pub e2: bool,
}

impl Default for FeedThrough {
    fn default() -> Self {
        Self {
            e0: true,
            e1: true,
            e2: true,
        }
    }
}

impl FeedThrough {
    pub(crate) fn none() -> Self {
        Self {
            e0: false,
            e1: false,
            e2: false,
        }
    }

    /// Derivative orders that are on.
    pub(crate) fn orders(self) -> impl Iterator<Item = usize> {
        let terms = [self.e0, self.e1, self.e2].into_iter().enumerate();
        terms.filter_map(|(order, on)| on.then_some(order))
    }

    pub(crate) fn count(self) -> usize {
        self.orders().count()
    }
}
