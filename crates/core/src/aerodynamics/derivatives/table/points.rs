//! The points of a table, and what they have to be.

use crate::aerodynamics::derivatives::{Derivative, Part};
use crate::error::{Place, Result, ensure};
use crate::section::Dof;
use crate::units::{ReducedFrequency, SAME_SPEED, near_groups};
use std::collections::BTreeMap;

/// One test point of one derivative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DerivativePoint {
    /// Mean wind speed of the run, m/s; `None` when the source does not say.
    pub mean_speed_m_s: Option<f64>,
    /// Reduced velocity `V̂ = V/(ωB) = 1/K`.
    pub v_hat: f64,
    /// The derivative, dimensionless.
    pub value: f64,
}

impl DerivativePoint {
    /// Reduced frequency of the point.
    pub fn k(&self) -> ReducedFrequency {
        ReducedFrequency::from_v_hat(self.v_hat)
    }
}

/// Test points of one derivative: more than any tunnel measures, few enough for every reader and fit.
const POINTS_AT_MOST: usize = 10_000;
/// No derivative is larger, and squares and products of larger ones would leave the numbers of a computer.
const LARGEST_VALUE: f64 = 1e12;

/// Refuses more test points than a table can have.
pub fn check_point_count(place: impl Into<Place>, count: usize) -> Result<()> {
    ensure(
        count <= POINTS_AT_MOST,
        place,
        format_args!("at most {POINTS_AT_MOST} test points of a derivative"),
        count,
    )
}

pub(super) fn check_complete(points: &BTreeMap<Derivative, Vec<DerivativePoint>>) -> Result<()> {
    let has = |d: &Derivative| points.get(d).is_some_and(|p| !p.is_empty());
    let is_missing = |d: &Derivative| {
        let other = match d.part() {
            Part::Real => Part::Imaginary,
            Part::Imaginary => Part::Real,
        };
        let needed = d.force() != Dof::Lateral && d.motion() != Dof::Lateral
            || has(&Derivative::from_entry(d.force(), d.motion(), other))
            || points.contains_key(d);
        needed && !has(d)
    };
    let missing: Vec<&str> = Derivative::ALL
        .iter()
        .filter(|d| is_missing(d))
        .map(|d| d.name())
        .collect();
    ensure(
        missing.is_empty(),
        "derivatives",
        "points for H1 to H4 and A1 to A4, and for both members of every other pair",
        format_args!("none for {}", missing.join(", ")),
    )
}

pub(super) fn check_speeds_agree(
    points: &BTreeMap<Derivative, Vec<DerivativePoint>>,
) -> Result<()> {
    let all: Vec<_> = points.values().flatten().collect();
    let with_speed = all.iter().filter(|p| p.mean_speed_m_s.is_some()).count();
    ensure(
        with_speed == 0 || with_speed == all.len(),
        "mean speeds",
        "a mean speed at every point, or at none",
        format_args!("one at {with_speed} of {} points", all.len()),
    )
}

/// Refuses the first point of one derivative that cannot be right; `place` is where each stands, by its position from 0.
pub fn check_points<P: Into<Place>>(
    points: &[DerivativePoint],
    place: impl Fn(usize) -> P,
) -> Result<()> {
    let positive = |x: f64| x.is_finite() && x > 0.0;
    let check = |p: &DerivativePoint| {
        let (v_hat, value, speed) = (p.v_hat, p.value, p.mean_speed_m_s.unwrap_or(1.0));
        ensure(positive(v_hat), "", "a positive reduced velocity V̂", v_hat)?;
        let expected = format_args!("a value of the derivative, no larger than {LARGEST_VALUE:e}");
        ensure(value.abs() <= LARGEST_VALUE, "", expected, value)?;
        let is_wind = positive(speed);
        ensure(is_wind, "", "a positive mean wind speed, m/s", speed)
    };
    for (i, p) in points.iter().enumerate() {
        check(p).map_err(|e| e.at(place(i)))?;
    }
    check_monotone(points, place)
}

/// Within a speed group the frequencies are tested in rising or falling order, each once.
fn check_monotone<P: Into<Place>>(
    points: &[DerivativePoint],
    place: impl Fn(usize) -> P,
) -> Result<()> {
    let speeds = points.iter().filter_map(|p| p.mean_speed_m_s);
    let mut groups = near_groups(speeds, SAME_SPEED);
    if groups.is_empty() {
        groups.push(vec![0.0, f64::INFINITY]);
    }
    for group in groups {
        let (low, high) = (group[0], group[group.len() - 1]);
        let inside = |(_, p): &(usize, &DerivativePoint)| {
            let v = p.mean_speed_m_s.unwrap_or(1.0);
            low <= v && v <= high
        };
        let own = points.iter().enumerate().filter(inside);
        let own: Vec<_> = own.map(|(i, p)| (i, p.v_hat)).collect();
        let falling = own.windows(2).next().is_some_and(|w| w[1].1 < w[0].1);
        let check = |before: f64, after: f64| {
            let found = format_args!("V̂ = {after} after {before}");
            let once = "every reduced velocity V̂ once in a speed group";
            ensure(before != after, "", once, found)?;
            let direction = if falling { "falling" } else { "rising" };
            let steadily =
                format_args!("reduced velocities V̂ {direction} steadily in a speed group");
            ensure((after < before) == falling, "", steadily, found)
        };
        for pair in own.windows(2) {
            check(pair[0].1, pair[1].1).map_err(|e| e.at(place(pair[1].0)))?;
        }
    }
    Ok(())
}
