//! Static coefficients of a deck over the angle of attack, smooth between the tested angles.

use crate::aerodynamics::derivatives::TableHeader;
use crate::aerodynamics::spline::{POINTS_AT_LEAST, Spline};
use crate::error::{Error, Place, Result, ensure};
use crate::section::Dof;

/// Tables of more than this range are no deck tests.
const ANGLE_LIMIT_DEG: f64 = 180.0;

/// An angle may stand beyond the last row by this much, rounding of its conversion, rad.
const ROUNDING_RAD: f64 = 1e-12;

/// One tested angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoefficientRow {
    /// Angle of attack, degrees, nose-up positive.
    pub angle_deg: f64,
    /// `C_D`.
    pub drag: f64,
    /// `C_L`.
    pub lift: f64,
    /// `C_M`.
    pub moment: f64,
}

/// Coefficients and their slopes at one angle of attack.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct CoefficientsAt {
    /// `C_D`.
    pub drag: f64,
    /// `C_L`.
    pub lift: f64,
    /// `C_M`.
    pub moment: f64,
    /// `dC_D/dα`, per rad.
    pub drag_slope: f64,
    /// `dC_L/dα`, per rad.
    pub lift_slope: f64,
    /// `dC_M/dα`, per rad.
    pub moment_slope: f64,
}

impl CoefficientsAt {
    /// The coefficient of the force on a degree of freedom and its slope, per rad.
    pub fn coefficient(&self, dof: Dof) -> (f64, f64) {
        match dof {
            Dof::Vertical => (self.lift, self.lift_slope),
            Dof::Lateral => (self.drag, self.drag_slope),
            Dof::Torsion => (self.moment, self.moment_slope),
        }
    }
}

/// Static coefficients `C_D`, `C_L`, `C_M` over the angle of attack: cubic splines with continuous curvature.
#[derive(Debug, Clone, PartialEq)]
pub struct StaticCoefficients {
    /// Name of the deck.
    pub name: String,
    /// Where the figures come from.
    pub header: TableHeader,
    rows: Vec<CoefficientRow>,
    drag: Spline,
    lift: Spline,
    moment: Spline,
}

impl StaticCoefficients {
    /// A table after checking it: at least four rows, finite numbers, angles that rise strictly and lie within ±180°.
    pub fn new(
        name: impl Into<String>,
        header: TableHeader,
        rows: Vec<CoefficientRow>,
    ) -> Result<Self> {
        check_rows(&rows, |i| format!("row {}", i + 1))?;
        let spline = |pick: fn(&CoefficientRow) -> f64| {
            let angles = rows.iter().map(|r| r.angle_deg.to_radians()).collect();
            Spline::new(angles, rows.iter().map(pick).collect())
        };
        Ok(Self {
            name: name.into(),
            header,
            drag: spline(|r| r.drag),
            lift: spline(|r| r.lift),
            moment: spline(|r| r.moment),
            rows,
        })
    }

    /// The tested angles.
    pub fn rows(&self) -> &[CoefficientRow] {
        &self.rows
    }

    /// Lowest and highest tested angle, rad.
    pub fn range_rad(&self) -> (f64, f64) {
        let (low, high) = self.range_deg();
        (low.to_radians(), high.to_radians())
    }

    fn range_deg(&self) -> (f64, f64) {
        // `new` has checked that there are rows
        let last = self.rows.len() - 1;
        (self.rows[0].angle_deg, self.rows[last].angle_deg)
    }

    /// Coefficients and slopes at an angle of attack (rad).
    pub fn at(&self, angle_rad: f64) -> Result<CoefficientsAt> {
        let (low, high) = self.range_rad();
        if !(low - ROUNDING_RAD..=high + ROUNDING_RAD).contains(&angle_rad) {
            let (low, high) = self.range_deg();
            // asked for at every step of a run: words only where they are needed
            return Err(Error::input(
                format!("static coefficients {}", self.name),
                format!("an angle of attack from {low} to {high} deg"),
                format!("{:.4} deg", angle_rad.to_degrees()),
            ));
        }
        let (drag, drag_slope) = self.drag.at(angle_rad);
        let (lift, lift_slope) = self.lift.at(angle_rad);
        let (moment, moment_slope) = self.moment.at(angle_rad);
        Ok(CoefficientsAt {
            drag,
            lift,
            moment,
            drag_slope,
            lift_slope,
            moment_slope,
        })
    }
}

/// Refuses the first row that cannot be right, and too few of them; `place` is where each stands, by its position from 0.
pub fn check_rows<P: Into<Place>>(
    rows: &[CoefficientRow],
    place: impl Fn(usize) -> P,
) -> Result<()> {
    let check = |before: f64, row: &CoefficientRow| {
        let angle = row.angle_deg;
        for value in [angle, row.drag, row.lift, row.moment] {
            ensure(value.is_finite(), "", "finite numbers", value)?;
        }
        let (within, found) = (angle.abs() <= ANGLE_LIMIT_DEG, format_args!("{angle} deg"));
        ensure(within, "", "an angle within ±180 deg", found)?;
        let (rises, found) = (angle > before, format_args!("{angle} after {before}"));
        ensure(rises, "", "angles that rise from row to row", found)
    };
    let mut before = f64::NEG_INFINITY;
    for (i, row) in rows.iter().enumerate() {
        check(before, row).map_err(|e| e.at(place(i)))?;
        before = row.angle_deg;
    }
    let (count, last) = (rows.len(), rows.len().saturating_sub(1));
    ensure(
        count >= POINTS_AT_LEAST,
        place(last),
        "at least 4 rows of the table",
        count,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_per_radian_and_angles_outside_are_named() {
        let rows = [-10.0, -4.0, 2.0, 10.0]
            .map(|angle_deg: f64| CoefficientRow {
                angle_deg,
                drag: 0.05,
                lift: 6.0 * angle_deg.to_radians(),
                moment: 1.5 * angle_deg.to_radians(),
            })
            .to_vec();
        let table = StaticCoefficients::new("line", TableHeader::default(), rows).unwrap();
        let at = table.at(3f64.to_radians()).unwrap();
        assert!((at.lift_slope - 6.0).abs() < 1e-13 && (at.moment_slope - 1.5).abs() < 1e-13);
        assert!((at.drag - 0.05).abs() < 1e-15 && at.drag_slope.abs() < 1e-13);
        assert!(table.at(10f64.to_radians()).is_ok());
        let message = table.at(12f64.to_radians()).unwrap_err().to_string();
        assert_eq!(
            message,
            "static coefficients line: expected an angle of attack from -10 to 10 deg, found 12.0000 deg"
        );
        assert!(table.at(f64::NAN).is_err());
    }
}
