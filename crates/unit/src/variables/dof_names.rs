//! Names, units and words of the degrees of freedom.

use crate::section::Dof;
use crate::si::{self, SiUnit};

/// Names, units and words of one degree of freedom.
pub(super) struct DofNames {
    /// Displacement, rate, acceleration, force.
    pub responses: [&'static str; 4],
    /// Units of the same.
    pub units: [&'static SiUnit; 4],
    /// External force.
    pub external: &'static str,
    /// Displacement and rate at release.
    pub initial: [&'static str; 2],
    /// Inertia, frequency, damping ratio.
    pub support: [&'static str; 3],
    pub inertia_unit: &'static SiUnit,
    pub inertia_quantity: &'static str,
    /// The motion and its sign.
    pub motion: &'static str,
    /// The force and its sign.
    pub force: &'static str,
    pub force_quantity: &'static str,
    /// Quantities of displacement, rate, acceleration.
    pub quantities: [&'static str; 3],
}

const HEAVE: DofNames = DofNames {
    responses: ["heave", "heave_rate", "heave_acceleration", "lift"],
    units: [
        &si::METRE,
        &si::METRE_PER_SECOND,
        &si::METRE_PER_SECOND2,
        &si::NEWTON_PER_METRE,
    ],
    external: "external_lift",
    initial: ["initial_heave", "initial_heave_rate"],
    support: ["mass", "heave_frequency", "heave_damping_ratio"],
    inertia_unit: &si::KILOGRAM_PER_METRE,
    inertia_quantity: "MassPerLength",
    motion: "vertical displacement, positive up",
    force: "vertical force per unit length of span, positive up",
    force_quantity: "ForcePerLength",
    quantities: ["Length", "Velocity", "Acceleration"],
};

static SWAY: DofNames = DofNames {
    responses: ["sway", "sway_rate", "sway_acceleration", "drag"],
    external: "external_drag",
    initial: ["initial_sway", "initial_sway_rate"],
    support: ["sway_mass", "sway_frequency", "sway_damping_ratio"],
    motion: "lateral displacement, positive downwind",
    force: "lateral force per unit length of span, positive downwind",
    ..HEAVE
};

static ROTATION: DofNames = DofNames {
    responses: [
        "rotation",
        "rotation_rate",
        "rotation_acceleration",
        "moment",
    ],
    units: [
        &si::RADIAN,
        &si::RADIAN_PER_SECOND,
        &si::RADIAN_PER_SECOND2,
        &si::NEWTON_METRE_PER_METRE,
    ],
    external: "external_moment",
    initial: ["initial_rotation", "initial_rotation_rate"],
    support: ["inertia", "torsion_frequency", "torsion_damping_ratio"],
    inertia_unit: &si::KILOGRAM_METRE2_PER_METRE,
    inertia_quantity: "MomentOfInertiaPerLength",
    motion: "rotation, positive nose-up",
    force: "moment per unit length of span about the reference point, positive nose-up",
    force_quantity: "MomentPerLength",
    quantities: ["Angle", "AngularVelocity", "AngularAcceleration"],
};

pub(super) fn names_of(dof: Dof) -> &'static DofNames {
    match dof {
        Dof::Vertical => &HEAVE,
        Dof::Lateral => &SWAY,
        Dof::Torsion => &ROTATION,
    }
}

/// The kind of motion, as an adjective.
pub(super) fn motion(dof: Dof) -> &'static str {
    match dof {
        Dof::Torsion => "torsional",
        other => other.name(),
    }
}
