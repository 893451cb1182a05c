//! Which way is up and which way the wind blows, in the axes of a finite-element model.

use crate::bridge::BridgeMode;
use crate::error::{Error, Result, ensure};
use nalgebra::{Matrix3, Vector3};
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

/// Takes directions of the model to up, downwind and along the girder, about which a right-handed rotation lifts the windward edge.
pub(super) type Frame = Matrix3<f64>;

impl Direction {
    fn unit(&self, place: &str) -> Result<Vector3<f64>> {
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
        let length = Vector3::from(vector).norm();
        let is_one = length > 0.0 && length.is_finite();
        let expected = "a direction of three finite numbers, not all zero";
        ensure(is_one, place, expected, format_args!("{vector:?}"))?;
        Ok(Vector3::from(vector) / length)
    }
}

impl WindAxes {
    /// The axes as unit vectors.
    ///
    /// # Errors
    /// [`Error::Input`] for directions that are none, or not square to each other.
    pub(super) fn frame(&self) -> Result<Frame> {
        let up = self.up.unit("modes.axes.up")?;
        let downwind = self.downwind.unit("modes.axes.downwind")?;
        let cosine = up.dot(&downwind);
        let (place, expected) = ("modes.axes.downwind", "a direction square to `up`");
        let found = format_args!("an angle with the cosine {cosine:.4}");
        ensure(cosine.abs() <= SQUARE, place, expected, found)?;
        // about a, the windward edge -d moves along a × (-d); that is up for a = up × d
        Ok(Matrix3::from_columns(&[up, downwind, up.cross(&downwind)]).transpose())
    }
}

/// Vertical, lateral displacement and rotation of displacements and rotations along the axes of the model.
pub(super) fn motion(frame: &Frame, u: &[f64; 6]) -> [f64; 3] {
    let [x, y, z, rotation @ ..] = *u;
    let translation = frame * Vector3::new(x, y, z);
    let rotation = frame * Vector3::from(rotation);
    [translation.x, translation.y, rotation.z]
}

/// A mode with displacements and rotations along the axes of the model; its damping is not known.
pub(super) fn mode(
    frame: &Frame,
    number: usize,
    frequency_hz: f64,
    generalised_mass: f64,
    shape: &[[f64; 6]],
) -> BridgeMode {
    BridgeMode {
        number,
        frequency_hz,
        generalised_mass,
        damping_ratio: 0.0,
        shape: shape.iter().map(|u| motion(frame, u)).collect(),
    }
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
        assert_eq!(frame.row(2), Vector3::x().transpose());
        assert_eq!(
            motion(&frame, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
            [3.0, -2.0, 4.0]
        );
        let other = axes("z", "y").frame().unwrap();
        assert_eq!(
            motion(&other, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
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
