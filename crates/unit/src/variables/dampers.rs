//! The dampers of a bridge as variables: strokes, and what may be tuned.

use super::dof_names::names_of;
use super::real::{SMALLEST, real};
use super::{Response, Role, Variable};
use crate::bridge::Dampers;
use crate::section::Dof;
use crate::si;

/// The stroke of every mass with its rates.
pub(super) fn strokes(dampers: &Dampers) -> impl Iterator<Item = Variable> {
    let masses = dampers.masses.iter().enumerate();
    masses.flat_map(|(d, damper)| {
        let of = [
            ("stroke", "Stroke", "Position"),
            ("stroke_rate", "Rate of the stroke", "Velocity"),
            (
                "stroke_acceleration",
                "Second rate of the stroke",
                "Acceleration",
            ),
        ];
        let units = names_of(Dof::Vertical).units;
        let all = Response::MOTION.into_iter().zip(of).zip(units);
        all.map(move |((response, (name, what, quantity)), unit)| {
            let text = format!(
                "{what}, displacement less that of the girder, of {}",
                damper.name
            );
            let name = format!("damper[{}].{name}", d + 1);
            real(name, Role::Damper(d, response), text).quantity(quantity, Some(unit))
        })
    })
}

/// What may be tuned, in the order of [`Bridge::tunable`](crate::bridge::Bridge::tunable).
pub(super) fn parameters(dampers: &Dampers) -> Vec<Variable> {
    let mut table: Vec<Variable> = Vec::new();
    let mut add = |name: String, text: String, start, min, quantity, unit| {
        let role = Role::DamperParameter(table.len());
        let variable = real(name, role, text).quantity(quantity, unit);
        table.push(variable.min(min).start(start));
    };
    for (d, damper) in dampers.masses.iter().enumerate() {
        let name = |what: &str| format!("damper[{}].{what}", d + 1);
        let text = |what: &str| format!("{what} of {}", damper.name);
        add(
            name("mass"),
            text("Mass"),
            damper.mass_kg,
            SMALLEST,
            "Mass",
            Some(&si::KILOGRAM),
        );
        add(
            name("frequency"),
            text("Natural frequency, while the girder is held,"),
            damper.frequency_hz,
            SMALLEST,
            "Frequency",
            Some(&si::HERTZ),
        );
        add(
            name("damping_ratio"),
            text("Ratio to critical damping, while the girder is held,"),
            damper.damping_ratio,
            0.0,
            "DampingRatio",
            None,
        );
    }
    for (l, link) in dampers.links.iter().enumerate() {
        let unit = match link.at.motion {
            Dof::Torsion => &si::NEWTON_METRE_SECOND_PER_RADIAN,
            _ => &si::NEWTON_SECOND_PER_METRE,
        };
        add(
            format!("link[{}].coefficient", l + 1),
            format!("Force over speed of {}", link.name),
            link.coefficient,
            0.0,
            "DampingCoefficient",
            Some(unit),
        );
    }
    table
}
