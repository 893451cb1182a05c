//! Outputs, their slopes over the wind speed in closed form, and differences over parameters.

use super::memory::Memory;
use crate::aerodynamics::Realization;
use crate::error::Result;
use crate::refusal::{CallResult, Refusal};
use crate::resources::Resources;
use crate::response::{Inputs, Outputs, SectionState, Stepper};
use nalgebra::{DMatrix, DVector};

/// Relative step of the central differences: truncation about 1e-8, rounding of an onset search about 1e-9.
const RELATIVE_STEP: f64 = 1e-4;
/// Step of a parameter that is zero.
const STEP_FROM_ZERO: f64 = 1e-6;

/// All that a section has at an instant, or its derivative with respect to one known.
#[derive(Debug, Default)]
pub(super) struct SectionValues {
    pub outputs: Outputs,
    /// `[q, q̇, x]`.
    state: Vec<f64>,
    /// Its rate.
    rate: Vec<f64>,
}

impl SectionValues {
    pub(super) fn new(
        stepper: &mut Stepper,
        state: &SectionState,
        inputs: &Inputs,
    ) -> Result<Self> {
        let mut outputs = Outputs::default();
        stepper.outputs(state, inputs, &mut outputs)?;
        let continuous = matches!(stepper.section().aerodynamics(), Realization::Continuous(_));
        Ok(Self {
            outputs,
            state: state.all(),
            rate: if continuous {
                stepper.state_derivative(state, inputs)?
            } else {
                Vec::new()
            },
        })
    }

    /// `∂/∂V` in a state, with these inputs.
    pub(super) fn by_speed(stepper: &Stepper, state: &SectionState, inputs: &Inputs) -> Self {
        Self {
            outputs: speed_sensitivity(stepper, state, inputs),
            state: Vec::new(),
            rate: rate_by_speed(stepper, state, inputs),
        }
    }

    /// An entry of the whole state `[q, q̇, x]`.
    pub(super) fn of_state(&self, entry: usize) -> f64 {
        self.state.get(entry).copied().unwrap_or(0.0)
    }

    /// Its rate.
    pub(super) fn of_rate(&self, entry: usize) -> f64 {
        let n = self.outputs.displacement.len();
        match entry {
            i if i < n => self.outputs.rate[i],
            i if i < 2 * n => self.outputs.acceleration[i - n],
            i => self.rate.get(i).copied().unwrap_or(0.0),
        }
    }
}

pub(super) fn add(outputs: &mut Outputs, other: &Outputs, factor: f64) {
    let lists = [
        (&mut outputs.displacement, &other.displacement),
        (&mut outputs.rate, &other.rate),
        (&mut outputs.acceleration, &other.acceleration),
        (&mut outputs.self_excited_force, &other.self_excited_force),
    ];
    for (list, terms) in lists {
        for (sum, term) in list.iter_mut().zip(terms) {
            *sum += factor * term;
        }
    }
}

/// `∂y/∂V` at a given state and external force. With `P(e)` the physical scaling, the aerodynamic part of the equation
/// of motion is `½ρV² P(e₀) q + ½ρVB P(e₁) q̇ + ½ρV² diag(B, B, B²) C x`; the acceleration follows through
/// `(M − ½ρB² P(e₂))⁻¹`, the force as `M` times the acceleration. Forces of gusts, `V Q g`, accelerate as external ones.
pub(super) fn speed_sensitivity(
    stepper: &Stepper,
    state: &SectionState,
    inputs: &Inputs,
) -> Outputs {
    let (section, speed) = (stepper.section(), inputs.wind_speed_m_s);
    let s = section.structure();
    let n = s.dofs.len();
    let part =
        |from: usize, count: usize| DVector::from_column_slice(&state.values[from..from + count]);
    let filters = part(2 * n, state.values.len() - 2 * n);
    let (rho, width) = (s.air_density_kg_m3, s.width_m);
    let scale = DMatrix::from_diagonal(&DVector::from_fn(n, |i, _| s.dofs[i].force_scale(width)));
    let direct = match section.aerodynamics() {
        Realization::Continuous(c) => {
            s.scaled(&c.e0) * part(0, n) * (rho * speed)
                + s.scaled(&c.e1) * part(n, n) * (0.5 * rho * width)
                + scale * (&c.c * filters) * (rho * speed)
        }
        Realization::Discrete(d) => scale * (&d.c * filters) * (rho * speed),
    };
    let gusts = DVector::from_vec(stepper.gusts_per_wind(state, inputs));
    let acceleration = section.inverse_mass() * (direct + &gusts);
    // gusts are no self-excited force
    let force = &s.mass * &acceleration - gusts;
    Outputs {
        displacement: vec![0.0; n],
        rate: vec![0.0; n],
        acceleration: acceleration.as_slice().to_vec(),
        self_excited_force: force.as_slice().to_vec(),
    }
}

/// `∂ż/∂V` of the filters and of the lagging gusts; zero for the motion, which [`speed_sensitivity`] gives.
fn rate_by_speed(stepper: &Stepper, state: &SectionState, inputs: &Inputs) -> Vec<f64> {
    let section = stepper.section();
    let first = 2 * section.structure().dofs.len();
    let mut rates = vec![0.0; state.values.len() + state.gusts.len()];
    let (values, lagging) = rates.split_at_mut(state.values.len());
    section.filter_rates_per_wind(&state.values, &mut values[first..]);
    stepper.lag_rates_per_wind(state, inputs, lagging);
    rates
}

/// The step of a central difference over a parameter of this value.
pub(super) fn parameter_step(value: f64) -> f64 {
    if value == 0.0 {
        STEP_FROM_ZERO
    } else {
        RELATIVE_STEP * value.abs()
    }
}

/// Derivatives with respect to the value at `known` by central differences over `step`, one-sided where the variable
/// would leave its limits; `at` gives the unknowns for a memory.
pub(super) fn central_difference(
    resources: &Resources,
    memory: &Memory,
    known: usize,
    step: f64,
    mut at: impl FnMut(&Memory) -> CallResult<Vec<f64>>,
) -> CallResult<Vec<f64>> {
    let variable = &resources.table.variables()[known];
    let mut other = memory.clone();
    let value = memory.values[known];
    let low = (value - step).max(variable.min.unwrap_or(f64::NEG_INFINITY));
    let high = (value + step).min(variable.max.unwrap_or(f64::INFINITY));
    other.values[known] = low;
    let below = at(&other)?;
    other.values[known] = high;
    let above = at(&other)?;
    let difference = |(a, b): (&f64, &f64)| (b - a) / (high - low);
    Ok(below.iter().zip(&above).map(difference).collect())
}

/// Refuses outputs, states and rates that no number holds any more.
pub(super) fn check_finite<'a>(numbers: impl IntoIterator<Item = &'a f64>) -> CallResult<()> {
    match numbers.into_iter().all(|x| x.is_finite()) {
        true => Ok(()),
        false => Err(overgrown()),
    }
}

#[cold]
fn overgrown() -> Refusal {
    Refusal::discard("outputs: the motion has overflowed")
}
