//! What a number that follows from parameters, wind and motion is made of.

use super::dual::Dual;
use super::response::Response;
use crate::section::Dof;
use crate::si::SiUnit;
use crate::standard::Causality;

/// What a row may read; only that is computed for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Known {
    /// Flutter onset and divergence.
    Onset,
    /// Wind speed.
    Wind,
    /// Smallest damping ratio at that wind.
    Damping,
    /// Whether the wind is one of the tests.
    TestedWind,
    /// Rotation of the deck.
    Rotation,
    /// A motion, or a rate of it, or its force per length; of a bridge that of the named node that is turned most, without forces; of a
    /// strip of forces alone what is set, and the force that is put out.
    Motion(Response, Dof),
    /// Length of a strip of forces alone, of which there are neither onset nor damping nor tests.
    Length,
}

/// Flutter onset and divergence for the parameters as they are. A speed up to which none was found is the limit of the search; one
/// that is not known is zero.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OnsetNumbers {
    /// Flutter onset, m/s.
    pub speed_m_s: Dual,
    /// Frequency there, Hz; zero where none is known.
    pub frequency_hz: Dual,
    /// `V* = V/(fB)` there; zero where none is known.
    pub reduced_velocity: Dual,
    /// Static divergence, m/s.
    pub divergence_m_s: Dual,
    /// Whether an onset was found.
    pub found: bool,
    /// Whether its reduced frequency lies in the tested range.
    pub in_tested_range: bool,
    /// Whether divergence was found.
    pub divergence_found: bool,
    /// Whether nothing grows below the onset at reduced frequencies that were not tested.
    pub stable_below: bool,
}

impl OnsetNumbers {
    /// Enters the slopes over the search's limit: what is found below does not depend on it; what is not found is the limit, or zero where
    /// it is not known.
    pub(crate) fn follow_limit(&mut self) {
        let searched = [
            (&mut self.speed_m_s, self.found),
            (&mut self.divergence_m_s, self.divergence_found),
        ];
        for (speed, found) in searched {
            if !found && speed.value != 0.0 {
                speed.slope = 1.0;
            }
        }
    }
}

/// The present moment, as far as a row reads it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Present {
    /// For the parameters.
    pub onset: OnsetNumbers,
    /// Wind speed, m/s.
    pub wind_m_s: Dual,
    /// Smallest damping ratio of the modes at that wind.
    pub damping_ratio: Dual,
    /// Whether every motion lies in the tested range at that wind.
    pub wind_is_tested: bool,
    /// Greatest rotation of the deck, rad.
    pub rotation_rad: Dual,
    /// Length of the strip, m.
    pub length_m: Dual,
    pub(crate) motion: [[Dual; 3]; 4],
}

impl Present {
    /// What [`Known::Motion`] stands for, in SI units.
    pub fn motion(&self, response: Response, dof: Dof) -> Dual {
        self.motion[response as usize][dof as usize]
    }

    pub(crate) fn motion_mut(&mut self, response: Response, dof: Dof) -> &mut Dual {
        &mut self.motion[response as usize][dof as usize]
    }
}

/// How a number follows from the present.
#[derive(Debug, Clone, Copy)]
pub enum Formula {
    /// A real number.
    Real(fn(&Present) -> Dual),
    /// A truth value, which has no derivative.
    Flag(fn(&Present) -> bool),
}

/// One number.
#[derive(Debug, Clone, Copy)]
pub struct ComputedNumber {
    pub(crate) name: &'static str,
    pub(crate) text: &'static str,
    /// Physical quantity in one word; of real numbers.
    pub(crate) quantity: Option<&'static str>,
    pub(crate) unit: Option<&'static SiUnit>,
    /// An output, or a calculated parameter, which is searched for when it is first read after a change.
    pub(crate) causality: Causality,
    pub(crate) reads: &'static [Known],
    pub(crate) formula: Formula,
}

/// Names are unique in a table.
impl PartialEq for ComputedNumber {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for ComputedNumber {}

impl ComputedNumber {
    /// A number of no dimension: its name, what it means, whether it is an output or a calculated
    /// parameter, and what its formula reads.
    pub const fn new(
        name: &'static str,
        text: &'static str,
        causality: Causality,
        reads: &'static [Known],
        formula: Formula,
    ) -> Self {
        Self {
            name,
            text,
            quantity: None,
            unit: None,
            causality,
            reads,
            formula,
        }
    }

    /// The same with its physical quantity and, where it has a dimension, its unit.
    pub const fn of_quantity(self, quantity: &'static str, unit: Option<&'static SiUnit>) -> Self {
        Self {
            quantity: Some(quantity),
            unit,
            ..self
        }
    }

    pub(crate) fn reads(&self, known: Known) -> bool {
        self.reads.contains(&known)
    }

    pub(crate) fn is_flag(&self) -> bool {
        matches!(self.formula, Formula::Flag(_))
    }

    /// Its value with its slope; truth values are 0 and 1.
    pub(crate) fn evaluate(&self, present: &Present) -> Dual {
        match self.formula {
            Formula::Real(formula) => formula(present),
            Formula::Flag(formula) => f64::from(u8::from(formula(present))).into(),
        }
    }
}
