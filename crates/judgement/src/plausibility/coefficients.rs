//! Static coefficients: sizes, slopes that are those per degree, signs, arms in another unit.

use super::limits::significant;
use super::{Finding, FindingKind};
use crate::aerodynamics::quasi_steady::{Arms, CoefficientsAt};
use crate::section::Dof;
use std::f64::consts::PI;

/// Greatest usual coefficients over the width: drag of trusses, lift and moment of decks that are stalled.
const MOST_DRAG: f64 = 0.6;
const MOST_LIFT: f64 = 1.5;
const MOST_MOMENT: f64 = 0.5;
/// Slopes of lift and moment per rad: greatest usual ones, half more than those of a flat plate (2π, π/2); decks have a third of
/// them at least …
const MOST_SLOPES: (f64, f64) = (3.0 * PI, 0.75 * PI);
/// … and per degree a plate has 0.11 and 0.027.
const SLOPES_PER_DEGREE: (f64, f64) = (0.16, 0.04);
/// A reference point of quasi-steady theory lies within the deck or near it, in parts of the width.
const MOST_ARM: f64 = 1.0;

/// What is odd about static coefficients and slopes, per rad, at no rotation; `place` goes before the name of each.
pub fn of_coefficients(place: &str, at: &CoefficientsAt, arms: &Arms) -> Vec<Finding> {
    let mut found = Vec::new();
    let key = |name: &str| format!("{place}{name}");
    if at.drag < 0.0 {
        let text = "drag acts with the wind: it is positive downwind";
        let odd = Finding::doubt(FindingKind::Convention, key("drag"), text);
        found.push(odd.with_value(at.drag));
    }
    for (name, value, most) in [
        ("drag", at.drag, MOST_DRAG),
        ("lift", at.lift.abs(), MOST_LIFT),
        ("moment", at.moment.abs(), MOST_MOMENT),
    ] {
        if value > most {
            let text = format!(
                "{most} is the most that is usual, over the width and, for the moment, over its square"
            );
            let meant = "is it over the depth of the deck?".to_owned();
            found.push(Finding::unit(key(name), value, text).otherwise(meant));
        }
    }
    found.extend(slopes(place, at));
    for dof in Dof::THREE {
        let arm = arms.arm(dof);
        if arm.abs() > MOST_ARM {
            let text = "a part of the width, usually -1 to 1";
            let meant = "is it a length in m, to be divided by the width?".to_owned();
            let name = key(&format!("arms.{}", dof.name()));
            found.push(Finding::unit(name, arm, text).otherwise(meant));
        }
    }
    found
}

/// Slopes of lift and moment: their unit, of both at once, then their signs.
fn slopes(place: &str, at: &CoefficientsAt) -> Vec<Finding> {
    let both = [
        ("lift_slope", at.lift_slope, 2.0 * PI, MOST_SLOPES.0),
        ("moment_slope", at.moment_slope, 0.5 * PI, MOST_SLOPES.1),
    ];
    let small = |value: f64, most: f64| value.abs() < most;
    let per_degree =
        small(at.lift_slope, SLOPES_PER_DEGREE.0) && small(at.moment_slope, SLOPES_PER_DEGREE.1);
    let odd = |(name, value, plate, most): (&str, f64, f64, f64)| {
        let key = format!("{place}{name}");
        let text = format!("per rad a flat plate has {plate:.2}");
        let (degrees, radians) = (value.to_degrees(), value.to_radians());
        if per_degree && value != 0.0 {
            let meant = format!("per degree it would be {} per rad", significant(degrees));
            Some(Finding::unit(key, value, text).otherwise(meant))
        } else if value.abs() > most {
            let meant = format!(
                "of angles in radians that are taken for degrees it would be {} per rad",
                significant(radians)
            );
            let meant = (radians.abs() <= most).then_some(meant);
            Some(Finding::unit(key, value, text).otherwise(meant))
        } else if value < 0.0 {
            let text = "decks lift and turn nose-up as their angle of attack rises, few do not";
            let meant = "is lift positive down, or the moment nose-down?".to_owned();
            let odd = Finding::doubt(FindingKind::Convention, key, text).with_value(value);
            Some(odd.otherwise(meant).into_note())
        } else {
            None
        }
    };
    both.into_iter().filter_map(odd).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plausibility::{FindingSeverity, sentences};

    const PLATE: CoefficientsAt = CoefficientsAt {
        drag: 0.05,
        lift: -0.1,
        moment: 0.02,
        drag_slope: 0.0,
        lift_slope: 2.0 * PI,
        moment_slope: 0.5 * PI,
    };

    fn said(at: CoefficientsAt) -> String {
        sentences(&of_coefficients("static.", &at, &Arms::default())).join(" | ")
    }

    #[test]
    fn usual_coefficients_pass_unremarked() {
        assert_eq!(said(PLATE), "");
        // a truss: hardly any lift, much drag
        let truss = CoefficientsAt {
            drag: 0.5,
            lift_slope: 1.5,
            moment_slope: 0.02,
            ..PLATE
        };
        assert_eq!(said(truss), "");
        // drag alone is given
        let drag = CoefficientsAt {
            lift: 0.0,
            moment: 0.0,
            lift_slope: 0.0,
            moment_slope: 0.0,
            ..PLATE
        };
        assert_eq!(said(drag), "");
    }

    #[test]
    fn slopes_per_degree_are_told() {
        let at = CoefficientsAt {
            lift_slope: 0.1,
            moment_slope: 0.02,
            ..PLATE
        };
        assert_eq!(
            said(at),
            "static.lift_slope = 0.1: per rad a flat plate has 6.28; per degree it would be 5.73 per rad | \
             static.moment_slope = 0.02: per rad a flat plate has 1.57; per degree it would be 1.146 per rad"
        );
        let at = CoefficientsAt {
            lift_slope: 360.0,
            moment_slope: 90.0,
            ..PLATE
        };
        let text = said(at);
        assert!(
            text.contains("taken for degrees it would be 6.283 per rad"),
            "{text}"
        );
    }

    #[test]
    fn sizes_and_signs_are_told() {
        let at = CoefficientsAt {
            drag: 1.4,
            lift: 3.0,
            moment: 0.9,
            ..PLATE
        };
        assert_eq!(said(at).matches("over the depth of the deck?").count(), 3);
        let at = CoefficientsAt {
            drag: -0.05,
            ..PLATE
        };
        assert_eq!(
            said(at),
            "static.drag = -0.05: drag acts with the wind: it is positive downwind"
        );
        let at = CoefficientsAt {
            moment_slope: -1.2,
            ..PLATE
        };
        let odd = of_coefficients("static.", &at, &Arms::default());
        // few decks do that: to be known, no more
        assert_eq!(odd[0].severity, FindingSeverity::Note);
        assert!(odd[0].to_string().ends_with("or the moment nose-down?"));
    }

    #[test]
    fn arms_in_metres_are_told() {
        let arms = Arms {
            vertical: 7.75,
            ..Arms::default()
        };
        assert_eq!(
            sentences(&of_coefficients("static.", &PLATE, &arms)),
            [
                "static.arms.vertical = 7.75: a part of the width, usually -1 to 1; is it a length in m, to be divided by the width?"
            ]
        );
    }
}
