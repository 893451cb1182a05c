//! What a degree of freedom does and feels.

/// Motion and force of one degree of freedom.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Response {
    /// Displacement or rotation.
    Displacement,
    /// Its first rate.
    Rate,
    /// Its second rate.
    Acceleration,
    /// Self-excited force or moment per unit length.
    SelfExcitedForce,
}

impl Response {
    /// Those of the motion.
    pub const MOTION: [Response; 3] = [Self::Displacement, Self::Rate, Self::Acceleration];

    /// All four, in the order of the outputs of a coupled system.
    pub const ALL: [Response; 4] = [
        Self::Displacement,
        Self::Rate,
        Self::Acceleration,
        Self::SelfExcitedForce,
    ];
}
