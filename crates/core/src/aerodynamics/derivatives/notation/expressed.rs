//! A table in the words and numbers of a convention.

use super::Convention;
use crate::aerodynamics::derivatives::{Derivative, DerivativePoint, DerivativeTable, TableHeader};
use crate::units::ReducedFrequency;
use serde::Serialize;

/// A derivative table as a file in some convention holds it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExpressedTable {
    /// Name of the deck.
    pub name: String,
    /// Width `B` of the section model, m.
    pub width_m: f64,
    /// Where the table comes from.
    #[serde(skip)]
    pub header: TableHeader,
    /// How its numbers are to be read.
    pub convention: Convention,
    /// The numbers, in the order of [`Derivative::ALL`].
    pub derivatives: Vec<ExpressedDerivative>,
}

/// All test points of one number.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExpressedDerivative {
    /// Its name in the notation.
    pub name: &'static str,
    /// Its place in the matrix, by Scanlan's name.
    pub derivative: Derivative,
    /// Its points in test order.
    pub points: Vec<ExpressedPoint>,
}

/// One test point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ExpressedPoint {
    /// Mean wind speed of the run, m/s; `None` when the source does not say.
    pub mean_speed_m_s: Option<f64>,
    /// Reduced velocity or frequency, as the convention has it.
    pub argument: f64,
    /// The number, dimensionless.
    pub value: f64,
}

impl Convention {
    /// The table in this convention.
    pub fn express(&self, table: &DerivativeTable) -> ExpressedTable {
        let of_one = |derivative: Derivative| {
            let points = table.points(derivative).iter();
            ExpressedDerivative {
                name: self.notation.name_of(derivative),
                derivative,
                points: points.map(|p| self.express_point(derivative, p)).collect(),
            }
        };
        ExpressedTable {
            name: table.name.clone(),
            width_m: table.width_m,
            header: table.header.clone(),
            convention: *self,
            derivatives: table.derivatives().map(of_one).collect(),
        }
    }

    /// One point of `derivative` in this convention.
    pub fn express_point(&self, derivative: Derivative, point: &DerivativePoint) -> ExpressedPoint {
        ExpressedPoint {
            mean_speed_m_s: point.mean_speed_m_s,
            argument: self.argument.at_v_hat(point.v_hat),
            value: point.value * self.factor(derivative, point.k()),
        }
    }

    /// One point in this convention as the crate has it.
    pub fn read_point(&self, derivative: Derivative, point: &ExpressedPoint) -> DerivativePoint {
        let v_hat = self.argument.to_v_hat(point.argument);
        let k = ReducedFrequency::from_v_hat(v_hat);
        DerivativePoint {
            mean_speed_m_s: point.mean_speed_m_s,
            v_hat,
            value: point.value / self.factor(derivative, k),
        }
    }
}
