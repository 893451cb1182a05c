//! Places and rectangles of figures, px from the upper left corner.

use std::ops::Add;

/// A place, or the way between two, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Px {
    pub(super) x: f64,
    pub(super) y: f64,
}

impl Px {
    pub(super) const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }
}

impl Add for Px {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y)
    }
}

/// A rectangle of the panel, px, y down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Area {
    pub(super) fn overlap(&self, other: &Self) -> f64 {
        let width = self.right.min(other.right) - self.left.max(other.left);
        let height = self.bottom.min(other.bottom) - self.top.max(other.top);
        width.max(0.0) * height.max(0.0)
    }
    pub(super) fn size(&self) -> f64 {
        (self.right - self.left) * (self.bottom - self.top)
    }
    pub(super) fn middle(&self) -> Px {
        Px::new(
            0.5 * (self.left + self.right),
            0.5 * (self.top + self.bottom),
        )
    }
    /// The same with a margin on every side.
    pub(super) fn grown(&self, margin: f64) -> Self {
        Self {
            left: self.left - margin,
            top: self.top - margin,
            right: self.right + margin,
            bottom: self.bottom + margin,
        }
    }
    /// The point of the area that is nearest to another.
    pub(super) fn nearest(&self, at: Px) -> Px {
        Px::new(
            at.x.clamp(self.left, self.right),
            at.y.clamp(self.top, self.bottom),
        )
    }
    pub(super) fn contains(&self, at: Px) -> bool {
        self.left <= at.x && at.x <= self.right && self.top <= at.y && at.y <= self.bottom
    }
}
