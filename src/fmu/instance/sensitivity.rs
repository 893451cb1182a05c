//! Derivatives: of outputs in time, and of unknowns with respect to inputs, initial values and parameters.
//!
//! Outputs are linear in state and forces, `y = C(V) z + D w`, so their derivatives are products with the same
//! matrices; the derivative with respect to the wind speed is closed too. Only section properties are differenced.

use super::Instance;
use super::layout::{DataType, Source};
use super::values::{check_finite, check_order};
use crate::aerodynamics::Realization;
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::fmu::lifecycle::State;
use crate::fmu::refusal::{Answer, Refusal};
use crate::fmu::variables::Role;
use crate::response::{Inputs, Outputs, SectionState, Stepper};
use crate::section::Dof;
use nalgebra::{DMatrix, DVector};

/// Relative step of the central differences: truncation about 1e-8, rounding of an onset search about 1e-9.
const RELATIVE_STEP: f64 = 1e-4;
/// Step of a parameter that is zero.
const STEP_FROM_ZERO: f64 = 1e-6;

impl Instance {
    /// First time derivatives of outputs, per second, with the current input rates.
    ///
    /// # Errors
    /// A reference that is no output, or another order than one.
    pub fn output_rates(
        &mut self,
        references: &[u32],
        orders: &[i32],
        rates: &mut [f64],
    ) -> Answer<()> {
        for (reference, order) in references.iter().zip(orders) {
            self.response_of(*reference)?;
            check_order(*order)?;
        }
        if references.is_empty() {
            return Ok(());
        }
        let all = self.time_derivative()?;
        for (reference, rate) in references.iter().zip(rates) {
            *rate = pick(&all, self.response_of(*reference)?);
        }
        Ok(())
    }

    /// `ẏ = C ż + D ẇ + (∂y/∂V) V̇` of all outputs.
    fn time_derivative(&mut self) -> Answer<Outputs> {
        self.prepare()?;
        self.load_inputs();
        let Some(stepper) = &mut self.stepper else {
            return Ok(Outputs::default());
        };
        let velocity = SectionState {
            values: stepper.state_derivative(&self.memory.section, &self.inputs)?,
            ..SectionState::default()
        };
        let driven = Inputs {
            force: self.inputs.force_rate.clone(),
            ..Inputs::steady(self.inputs.wind_speed_m_s, self.inputs.force.len())
        };
        let mut rates = Outputs::default();
        stepper.outputs(&velocity, &driven, &mut rates)?;
        let by_speed = speed_sensitivity(
            stepper.section(),
            &self.memory.section,
            self.inputs.wind_speed_m_s,
        );
        add(&mut rates, &by_speed, self.inputs.wind_speed_rate_m_s2);
        check_finite(&rates)?;
        Ok(rates)
    }

    /// `Σ (∂unknown/∂known) seed`: outputs with respect to inputs; while initialising also outputs and calculated
    /// parameters with respect to initial values (exact) and section properties (central differences).
    ///
    /// # Errors
    /// References that are no such unknowns or knowns in the current state; a derivative that does not exist.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seeds: &[f64],
        results: &mut [f64],
    ) -> Answer<()> {
        let unknowns = unknowns
            .iter()
            .map(|r| self.unknown(*r))
            .collect::<Answer<Vec<_>>>()?;
        let knowns = knowns
            .iter()
            .map(|r| self.known(*r))
            .collect::<Answer<Vec<_>>>()?;
        self.prepare()?;
        let mut sums = vec![0.0; unknowns.len()];
        for (known, seed) in knowns.into_iter().zip(seeds) {
            let column = self.column(known, &unknowns)?;
            for (sum, derivative) in sums.iter_mut().zip(column) {
                *sum += seed * derivative;
            }
        }
        if !sums.iter().all(|x| x.is_finite()) {
            return Err(Refusal::discard(
                "directional derivative: beyond the range of numbers",
            ));
        }
        results.copy_from_slice(&sums);
        Ok(())
    }

    fn response_of(&self, reference: u32) -> Answer<Role> {
        let (place, access) = self.typed(reference, DataType::Real)?;
        let variable = &self.table().variables()[place];
        if access.source == Source::Response {
            Ok(variable.role)
        } else {
            Err(Refusal::error(format!("`{}` is no output", variable.name)))
        }
    }

    fn unknown(&self, reference: u32) -> Answer<Role> {
        let (place, access) = self.typed(reference, DataType::Real)?;
        let variable = &self.table().variables()[place];
        match access.source {
            Source::Response => Ok(variable.role),
            Source::Calculated if self.memory.state == State::Initialization => Ok(variable.role),
            _ => Err(self.refused(place, "unknown")),
        }
    }

    /// Place of a known.
    fn known(&self, reference: u32) -> Answer<usize> {
        let (place, access) = self.typed(reference, DataType::Real)?;
        let initializing = self.memory.state == State::Initialization;
        match access.source {
            Source::Input => Ok(place),
            Source::Section | Source::Release | Source::Limit if initializing => Ok(place),
            _ => Err(self.refused(place, "known")),
        }
    }

    fn refused(&self, place: usize, what: &str) -> Refusal {
        Refusal::error(format!(
            "directional derivative: `{}` is no {what} in the state `{}`",
            self.table().variables()[place].name,
            self.memory.state.name()
        ))
    }

    /// Derivatives of all unknowns with respect to one known.
    fn column(&mut self, known: usize, unknowns: &[Role]) -> Answer<Vec<f64>> {
        let outputs = match self.layout.source(known) {
            Source::Input => self.by_input(known)?,
            Source::Release => self.by_release(known)?,
            _ => return self.by_difference(known, unknowns),
        };
        Ok(unknowns.iter().map(|u| pick(&outputs, *u)).collect())
    }

    fn by_input(&mut self, known: usize) -> Result<Outputs> {
        self.load_inputs();
        let speed = self.inputs.wind_speed_m_s;
        let Some(stepper) = &mut self.stepper else {
            return Ok(Outputs::default());
        };
        if known == self.layout.wind_speed {
            let section = stepper.section();
            return Ok(speed_sensitivity(section, &self.memory.section, speed));
        }
        let mut unit = Inputs::steady(speed, self.layout.force.len());
        for (force, place) in unit.force.iter_mut().zip(&self.layout.force) {
            *force = f64::from(u8::from(*place == known));
        }
        let at_rest = SectionState {
            values: vec![0.0; self.memory.section.values.len()],
            ..SectionState::default()
        };
        let mut outputs = Outputs::default();
        stepper.outputs(&at_rest, &unit, &mut outputs)?;
        Ok(outputs)
    }

    /// The release is linear in its displacements and rates.
    fn by_release(&mut self, known: usize) -> Result<Outputs> {
        let mut unit = vec![0.0; self.memory.values.len()];
        unit[known] = 1.0;
        let speed = self.memory.values[self.layout.wind_speed];
        let still = Inputs::steady(speed, self.layout.force.len());
        let mut outputs = Outputs::default();
        if let Some(stepper) = &self.stepper {
            let state = self.release(stepper, &unit)?;
            if let Some(stepper) = &mut self.stepper {
                stepper.outputs(&state, &still, &mut outputs)?;
            }
        }
        Ok(outputs)
    }

    /// Central differences; one-sided where the parameter would leave its limits.
    fn by_difference(&mut self, known: usize, unknowns: &[Role]) -> Answer<Vec<f64>> {
        let variable = &self.table().variables()[known];
        let value = self.memory.values[known];
        let step = if value == 0.0 {
            STEP_FROM_ZERO
        } else {
            RELATIVE_STEP * value.abs()
        };
        let low = (value - step).max(variable.min.unwrap_or(f64::NEG_INFINITY));
        let high = (value + step).min(variable.max.unwrap_or(f64::INFINITY));
        let below = self.with_value(known, low, unknowns)?;
        let above = self.with_value(known, high, unknowns)?;
        let difference = |(a, b): (&f64, &f64)| (b - a) / (high - low);
        Ok(below.iter().zip(&above).map(difference).collect())
    }

    /// The unknowns with one other value.
    fn with_value(&mut self, place: usize, value: f64, unknowns: &[Role]) -> Answer<Vec<f64>> {
        let mut values = self.memory.values.clone();
        values[place] = value;
        let wants = |wanted: fn(&Role) -> bool| unknowns.iter().any(wanted);
        let mut outputs = Outputs::default();
        if wants(|u| matches!(u, Role::Response(..))) {
            let mut stepper: Stepper = self.new_stepper(&values)?;
            let state = self.release(&stepper, &values)?;
            self.load_inputs();
            stepper.outputs(&state, &self.inputs, &mut outputs)?;
        }
        let card = if wants(|u| matches!(u, Role::Calculated(_))) {
            Some(self.onset_card(&values))
        } else {
            None
        };
        let value = |unknown: &Role| match (unknown, &card) {
            (Role::Calculated(which), Some(card)) => card.value(*which),
            (other, _) => pick(&outputs, *other),
        };
        Ok(unknowns.iter().map(value).collect())
    }
}

/// The entry of `outputs` that a role stands for; zero for what inputs and release do not act on.
fn pick(outputs: &Outputs, role: Role) -> f64 {
    let Role::Response(response, dof) = role else {
        return 0.0;
    };
    let list = outputs.lists()[response as usize];
    let index = match dof {
        Dof::Vertical => 0,
        Dof::Lateral => 1,
        Dof::Torsion => list.len().saturating_sub(1),
    };
    list.get(index).copied().unwrap_or(0.0)
}

fn add(outputs: &mut Outputs, other: &Outputs, factor: f64) {
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
/// `(M − ½ρB² P(e₂))⁻¹`, the force as `M` times the acceleration.
fn speed_sensitivity(section: &CoupledSection, state: &SectionState, speed: f64) -> Outputs {
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
    let acceleration = section.inverse_mass() * direct;
    let force = &s.mass * &acceleration;
    Outputs {
        displacement: vec![0.0; n],
        rate: vec![0.0; n],
        acceleration: acceleration.as_slice().to_vec(),
        self_excited_force: force.as_slice().to_vec(),
    }
}
