//! Forces of the rigid model on the rig about its centre of rotation.

use super::plan::{ModelBody, StaticWind};
use nalgebra::{Rotation3, Vector3};

/// Force and moment about the centre of rotation, global axes: N, N·m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Wrench {
    pub force: Vector3<f64>,
    pub moment: Vector3<f64>,
}

impl Wrench {
    /// From drag, lift (N) and nose-up moment (N·m), which is one about −z.
    pub fn section(drag: f64, lift: f64, moment: f64) -> Self {
        Self {
            force: Vector3::new(drag, lift, 0.0),
            moment: Vector3::new(0.0, 0.0, -moment),
        }
    }

    pub fn add(&mut self, other: Self) {
        self.force += other.force;
        self.moment += other.moment;
    }
}

/// Motion of the model at one instant; vertical (m), lateral (m), torsion (rad), and their rates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Kinematics {
    pub displacement: [f64; 3],
    pub velocity: [f64; 3],
    pub acceleration: [f64; 3],
}

/// Gravity and inertia of a body of `length_m`.
pub(super) fn gravity_and_inertia(body: &ModelBody, length_m: f64, state: &Kinematics) -> Wrench {
    let mass = body.mass_kg_m * length_m;
    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), -state.displacement[2]);
    let arm = turn * Vector3::from(body.centre_of_gravity_m);
    let spin = Vector3::new(0.0, 0.0, -state.velocity[2]);
    let spin_rate = Vector3::new(0.0, 0.0, -state.acceleration[2]);
    let centre = Vector3::new(state.acceleration[1], state.acceleration[0], 0.0);
    let acceleration = centre + spin_rate.cross(&arm) + spin.cross(&spin.cross(&arm));
    let weight = Vector3::new(0.0, -mass * body.gravity_m_s2, 0.0);
    let force = weight - mass * acceleration;
    Wrench {
        force,
        moment: arm.cross(&force) - spin_rate * (body.inertia_kg_m2_m * length_m),
    }
}

/// Steady load and quasi-steady buffeting as (drag, lift, moment) over `½ρV²`, `B`, `B`, `B²` and the length; gusts over
/// the mean speed. Linear in the gusts, as the buffeting forces of section 1.1 of the thesis.
pub(super) fn wind_coefficients(wind: &StaticWind, u: f64, w: f64) -> [f64; 3] {
    [
        wind.drag * (1.0 + 2.0 * u) + (wind.drag_slope - wind.lift) * w,
        wind.lift * (1.0 + 2.0 * u) + (wind.lift_slope + wind.drag) * w,
        wind.moment * (1.0 + 2.0 * u) + wind.moment_slope * w,
    ]
}
