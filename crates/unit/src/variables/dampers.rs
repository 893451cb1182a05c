//! The dampers of a bridge as variables: strokes, and what may be tuned.

use super::real::{OUTPUT, SMALLEST, TUNABLE, real};
use super::{Response, Role, Variable};
use crate::bridge::Dampers;
use crate::section::Dof;
use crate::si;

/// The stroke of every mass with its rates.
pub(super) fn strokes(dampers: &Dampers) -> impl Iterator<Item = Variable> {
    let masses = dampers.masses.iter().enumerate();
    masses.flat_map(|(d, damper)| {
        let of = [
            ("stroke", "Stroke", "Position", &si::METRE),
            (
                "stroke_rate",
                "Rate of the stroke",
                "Velocity",
                &si::METRE_PER_SECOND,
            ),
            (
                "stroke_acceleration",
                "Second rate of the stroke",
                "Acceleration",
                &si::METRE_PER_SECOND2,
            ),
        ];
        let all = Response::MOTION.into_iter().zip(of);
        all.map(move |(response, (name, what, quantity, unit))| {
            let text = format!(
                "{what}, displacement less that of the girder, of {}",
                damper.name
            );
            real(
                format!("damper[{}].{name}", d + 1),
                Role::Damper(d, response),
                OUTPUT,
                text,
            )
            .quantity(quantity, Some(unit))
        })
    })
}

/// What may be tuned, in the order of [`Bridge::tunable`](crate::bridge::Bridge::tunable).
pub(super) fn parameters(dampers: &Dampers) -> Vec<Variable> {
    let masses = dampers.masses.iter().enumerate().flat_map(|(d, damper)| {
        let of = |what: &str, text: &str| {
            (
                format!("damper[{}].{what}", d + 1),
                format!("{text} of {}", damper.name),
            )
        };
        [
            (
                of("mass", "Mass"),
                damper.mass_kg,
                SMALLEST,
                "Mass",
                Some(&si::KILOGRAM),
            ),
            (
                of("frequency", "Natural frequency, while the girder is held,"),
                damper.frequency_hz,
                SMALLEST,
                "Frequency",
                Some(&si::HERTZ),
            ),
            (
                of(
                    "damping_ratio",
                    "Ratio to critical damping, while the girder is held,",
                ),
                damper.damping_ratio,
                0.0,
                "DampingRatio",
                None,
            ),
        ]
    });
    let links = dampers.links.iter().enumerate().map(|(l, link)| {
        let unit = match link.at.motion {
            Dof::Torsion => &si::NEWTON_METRE_SECOND_PER_RADIAN,
            _ => &si::NEWTON_SECOND_PER_METRE,
        };
        let named = (
            format!("link[{}].coefficient", l + 1),
            format!("Force over speed of {}", link.name),
        );
        (
            named,
            link.coefficient,
            0.0,
            "DampingCoefficient",
            Some(unit),
        )
    });
    let all = masses.chain(links).enumerate();
    let variable = |(i, ((name, text), start, min, quantity, unit))| {
        real(name, Role::DamperParameter(i), TUNABLE, text)
            .quantity(quantity, unit)
            .min(min)
            .start(start)
    };
    all.map(variable).collect()
}
