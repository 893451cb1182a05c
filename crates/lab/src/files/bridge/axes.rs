//! Which way is up and which way the wind blows, in the axes of a finite-element model.

use crate::error::{Error, Result, ensure};
use serde::{Deserialize, Serialize};

/// Directions closer to one line than this (cosine) are no two axes.
const SQUARE: f64 = 1e-6;

/// A direction: `x`, `-y`, `+z`, or three components.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "an axis (`x`, `-y`) or a direction of three numbers"
)]
pub enum Direction {
    /// An axis with its sign.
    Axis(String),
    /// Components, of any length.
    Vector([f64; 3]),
}

/// Up and downwind in the axes of the model; the wind blows square to the girder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WindAxes {
    /// Up.
    pub up: Direction,
    /// Where the wind blows to.
    pub downwind: Direction,
}

/// Unit vectors of vertical and lateral motion, and the axis about which a right-handed rotation lifts the windward edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MotionDirections {
    up: [f64; 3],
    downwind: [f64; 3],
    pub(super) nose_up: [f64; 3],
}

impl Direction {
    fn unit(&self, place: &str) -> Result<[f64; 3]> {
        let vector = match self {
            Self::Vector(v) => *v,
            Self::Axis(name) => {
                let (sign, letter) = match name.strip_prefix('-') {
                    Some(rest) => (-1.0, rest),
                    None => (1.0, name.strip_prefix('+').unwrap_or(name)),
                };
                let index = ["x", "y", "z"].iter().position(|a| *a == letter);
                let index = index.ok_or_else(|| {
                    Error::input(place, "x, y, z, -x, -y or -z", format!("`{name}`"))
                })?;
                let mut v = [0.0; 3];
                v[index] = sign;
                v
            }
        };
        let length = dot(vector, vector).sqrt();
        ensure(
            length > 0.0 && length.is_finite(),
            place,
            "a direction of three finite numbers, not all zero",
            format_args!("{vector:?}"),
        )?;
        Ok(vector.map(|x| x / length))
    }
}

impl WindAxes {
    /// The axes as unit vectors.
    ///
    /// # Errors
    /// [`Error::Input`] for directions that are none, or not square to each other.
    pub(super) fn frame(&self) -> Result<MotionDirections> {
        let up = self.up.unit("modes.axes.up")?;
        let downwind = self.downwind.unit("modes.axes.downwind")?;
        let cosine = dot(up, downwind);
        ensure(
            cosine.abs() <= SQUARE,
            "modes.axes.downwind",
            "a direction square to `up`",
            format_args!("an angle with the cosine {cosine:.4}"),
        )?;
        // about a, the windward edge -d moves along a × (-d); that is up for a = up × d
        let nose_up = [
            up[1] * downwind[2] - up[2] * downwind[1],
            up[2] * downwind[0] - up[0] * downwind[2],
            up[0] * downwind[1] - up[1] * downwind[0],
        ];
        Ok(MotionDirections {
            up,
            downwind,
            nose_up,
        })
    }
}

impl MotionDirections {
    /// Vertical, lateral displacement and rotation of displacements and rotations along the axes of the model.
    pub(super) fn motion(&self, u: &[f64; 6]) -> [f64; 3] {
        let translation = [u[0], u[1], u[2]];
        let rotation = [u[3], u[4], u[5]];
        [
            dot(self.up, translation),
            dot(self.downwind, translation),
            dot(self.nose_up, rotation),
        ]
    }

    /// Place of a point along the girder, m.
    pub(super) fn along(&self, point: &[f64; 3]) -> f64 {
        dot(self.nose_up, *point)
    }

    /// Place of a point downwind and up, m.
    pub(super) fn across(&self, point: &[f64; 3]) -> [f64; 2] {
        [dot(self.downwind, *point), dot(self.up, *point)]
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axes(up: &str, downwind: &str) -> WindAxes {
        WindAxes {
            up: Direction::Axis(up.into()),
            downwind: Direction::Axis(downwind.into()),
        }
    }

    /// Wind along −y, z up: a right-handed rotation about x lifts the edge at +y, which is windward.
    #[test]
    fn the_windward_edge_rises() {
        let frame = axes("z", "-y").frame().unwrap();
        assert_eq!(frame.nose_up, [1.0, 0.0, 0.0]);
        assert_eq!(
            frame.motion(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
            [3.0, -2.0, 4.0]
        );
        let other = axes("z", "y").frame().unwrap();
        assert_eq!(
            other.motion(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
            [3.0, 2.0, -4.0]
        );
    }

    #[test]
    fn directions_that_are_none_are_refused() {
        assert!(
            axes("w", "x")
                .frame()
                .unwrap_err()
                .to_string()
                .contains("x, y, z")
        );
        assert!(
            axes("z", "z")
                .frame()
                .unwrap_err()
                .to_string()
                .contains("square to `up`")
        );
    }
}
