//! What an instance of FMI 3.0 is told later, or otherwise, than one of FMI 2.0.

use crate::description::{ModelDescription, Value};
use crate::library::{Component, Fmi3Functions, Int};

/// What is told to an instance at another time than in FMI 2.0.
pub(super) struct LateCalls {
    /// What each number was set to last, at first its start value: an element is set along with its whole array.
    pub(super) kept: Vec<f64>,
    /// Start and stop, s, and tolerance.
    pub(super) experiment: (f64, Option<f64>, Option<f64>),
    /// Whether the initialisation has begun, so that all numbers can be read.
    pub(super) begun: bool,
}

impl LateCalls {
    pub(super) fn new(description: &ModelDescription) -> Self {
        let start = |at: usize| match &description.variables[at].start {
            Some(Value::Real(x)) => *x,
            Some(Value::Integer(x)) => f64::from(*x),
            Some(Value::Boolean(x)) => f64::from(u8::from(*x)),
            _ => 0.0,
        };
        Self {
            kept: (0..description.elements.len()).map(start).collect(),
            experiment: (0.0, None, None),
            begun: false,
        }
    }

    pub(super) fn enter_initialization(&self, own: &Fmi3Functions, component: Component) -> Int {
        let stated = |number: Option<f64>| (u8::from(number.is_some()), number.unwrap_or(0.0));
        let (start_s, stop_s, tolerance) = self.experiment;
        let ((with_tolerance, tolerance), (with_stop, stop)) = (stated(tolerance), stated(stop_s));
        // SAFETY: the component lives; plain values
        unsafe {
            (own.enter_initialization_mode)(
                component,
                with_tolerance,
                tolerance,
                start_s,
                with_stop,
                stop,
            )
        }
    }
}
