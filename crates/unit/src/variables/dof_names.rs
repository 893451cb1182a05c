//! Names, units and words of the degrees of freedom.

use super::{Response, Variable};
use crate::section::Dof;
use crate::si::{self, SiUnit};

/// Names, units and words of one degree of freedom.
pub(super) struct DofNames {
    /// Displacement, with which the names of its rates begin.
    pub displacement: &'static str,
    /// Self-excited force.
    pub force_name: &'static str,
    /// Inertia.
    pub inertia: &'static str,
    /// With what the names of frequency and damping ratio begin.
    pub support: &'static str,
    /// Units and quantities of displacement, rate, acceleration, force.
    pub units: [&'static SiUnit; 4],
    pub quantities: [&'static str; 4],
    pub inertia_unit: &'static SiUnit,
    pub inertia_quantity: &'static str,
    /// The motion and its sign.
    pub motion: &'static str,
    /// The force and its sign.
    pub force: &'static str,
}

const HEAVE: DofNames = DofNames {
    displacement: "heave",
    force_name: "lift",
    inertia: "mass",
    support: "heave",
    units: [
        &si::METRE,
        &si::METRE_PER_SECOND,
        &si::METRE_PER_SECOND2,
        &si::NEWTON_PER_METRE,
    ],
    quantities: ["Length", "Velocity", "Acceleration", "ForcePerLength"],
    inertia_unit: &si::KILOGRAM_PER_METRE,
    inertia_quantity: "MassPerLength",
    motion: "vertical displacement, positive up",
    force: "vertical force per unit length of span, positive up",
};

static SWAY: DofNames = DofNames {
    displacement: "sway",
    force_name: "drag",
    inertia: "sway_mass",
    support: "sway",
    motion: "lateral displacement, positive downwind",
    force: "lateral force per unit length of span, positive downwind",
    ..HEAVE
};

static ROTATION: DofNames = DofNames {
    displacement: "rotation",
    force_name: "moment",
    inertia: "inertia",
    support: "torsion",
    units: [
        &si::RADIAN,
        &si::RADIAN_PER_SECOND,
        &si::RADIAN_PER_SECOND2,
        &si::NEWTON_METRE_PER_METRE,
    ],
    quantities: [
        "Angle",
        "AngularVelocity",
        "AngularAcceleration",
        "MomentPerLength",
    ],
    inertia_unit: &si::KILOGRAM_METRE2_PER_METRE,
    inertia_quantity: "MomentOfInertiaPerLength",
    motion: "rotation, positive nose-up",
    force: "moment per unit length of span about the reference point, positive nose-up",
};

pub(super) fn names_of(dof: Dof) -> &'static DofNames {
    match dof {
        Dof::Vertical => &HEAVE,
        Dof::Lateral => &SWAY,
        Dof::Torsion => &ROTATION,
    }
}

impl DofNames {
    /// Name of a motion, a rate of it, or its force.
    pub(super) fn name(&self, response: Response) -> String {
        let displacement = self.displacement;
        match response {
            Response::Displacement => displacement.to_owned(),
            Response::Rate => format!("{displacement}_rate"),
            Response::Acceleration => format!("{displacement}_acceleration"),
            Response::SelfExcitedForce => self.force_name.to_owned(),
        }
    }

    /// A motion, or a rate of it, in words.
    pub(super) fn describe(&self, response: Response) -> String {
        match response {
            Response::Displacement => capitalized(self.motion),
            Response::Rate => format!("Rate of the {}", self.motion),
            _ => format!("Second rate of the {}", self.motion),
        }
    }
}

impl Variable {
    /// With unit and quantity of a motion, a rate of it, or its force: degrees help.
    pub(super) fn measured_as(self, response: Response, dof: Dof) -> Self {
        let (w, i) = (names_of(dof), response as usize);
        self.quantity(w.quantities[i], Some(w.units[i]))
            .shown_if(dof == Dof::Torsion)
    }
}

fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map_or_else(String::new, |c| c.to_uppercase().chain(letters).collect())
}
