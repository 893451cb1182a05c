//! Derivatives of an exported bridge. Outputs are linear in state, forces and gusts, and the derivative with respect to the wind
//! is closed; only parameters are differenced.

use super::bridge_built::Built;
use super::bridge_unit::BridgeUnit;
use super::layout::Source;
use super::memory::Memory;
use super::section::OnsetCard;
use super::sensitivity::{SectionValues, add, central_difference, parameter_step};
use super::trust::{Known, MonitoredUnit, is_of_onset, without_motion};
use super::unit::{Differentiable, Prepared};
use crate::error::Result;
use crate::flutter::smallest_damping;
use crate::lifecycle::State;
use crate::refusal::CallResult;
use crate::resources::Resources;
use crate::variables::{Calculated, Role, Safety};

impl Differentiable for BridgeUnit {
    /// `ẏ = C ż + D ẇ + (∂y/∂V) V̇`.
    fn output_rates(&mut self, memory: &mut Memory, outputs: &[Role]) -> CallResult<Vec<f64>> {
        self.load_inputs(memory);
        let stepper = &mut self.built.stepper;
        let velocity = stepper.state_derivative(&memory.system, &self.inputs)?;
        let velocity = memory.system.with_all(&velocity);
        let by_wind = self.by_wind(memory);
        let wind_rate = self.inputs.wind_speed_rate_m_s2;
        let inputs = &mut self.inputs;
        std::mem::swap(&mut inputs.force, &mut inputs.force_rate);
        std::mem::swap(&mut inputs.gust_m_s, &mut inputs.gust_rate_m_s2);
        let mut rates = self.modal(&velocity)?;
        add(&mut rates, &by_wind.outputs, wind_rate);
        let rate = |role: &Role| match role {
            Role::Status(_) => Ok(self.present_by_wind(memory, *role)? * wind_rate),
            response => Ok(self.pick(&rates, *response)),
        };
        outputs.iter().map(rate).collect()
    }

    fn derivatives(
        &mut self,
        resources: &Resources,
        memory: &mut Memory,
        known: usize,
        unknowns: &[Role],
    ) -> CallResult<Vec<f64>> {
        let role = resources.table.variables()[known].role;
        let instant = match (Source::of(role), role) {
            (_, Role::WindSpeed) => {
                self.load_inputs(memory);
                let by_wind = self.by_wind(memory);
                let slope = |role: &Role| match role {
                    Role::Status(_) => self.present_by_wind(memory, *role),
                    other => Ok(self.pick_of(&by_wind, *other)),
                };
                return Ok(unknowns.iter().map(slope).collect::<Result<_>>()?);
            }
            (Source::Limit, _) => return Ok(self.by_limit(resources, memory, unknowns)),
            (Source::Section, _) => {
                return self.by_parameter(resources, memory, known, unknowns);
            }
            _ => self.by_unit(memory, known)?,
        };
        let derivative = |unknown: &Role| self.pick_of(&instant, *unknown);
        Ok(unknowns.iter().map(derivative).collect())
    }
}

impl BridgeUnit {
    /// What a force, a gust, a state or a coordinate at release of one does.
    fn by_unit(&mut self, memory: &Memory, known: usize) -> Result<SectionValues> {
        let mut unit = memory.clone();
        let inputs = &self.places.inputs[1..];
        for place in inputs.iter().chain(&self.places.initial) {
            unit.values[*place] = f64::from(u8::from(*place == known));
        }
        if let Some(place) = self.places.turbulence_factor {
            unit.values[place] = 0.0;
        }
        unit.input_rates.fill(0.0);
        self.load_inputs(&unit);
        let released = self.places.initial.contains(&known);
        // while initialising the lags stand where the gusts are
        let initial = memory.state == State::Initialization;
        let mut state = if released || initial {
            self.release(&unit.values)?
        } else {
            self.built.at_rest()
        };
        if let Some(entry) = self.places.state_entry[known] {
            state.set_number(entry, 1.0);
        }
        self.instant(&state)
    }

    /// What is found below the limit of the search does not depend on it; what is not found is the limit.
    fn by_limit(
        &mut self,
        resources: &Resources,
        memory: &mut Memory,
        unknowns: &[Role],
    ) -> Vec<f64> {
        self.calculate(resources, memory, &mut Vec::new());
        let place = |which| resources.table.find(Role::Calculated(which));
        let limit = memory.values[self.places.limit];
        let none = |found, speed| {
            let is = |which, value| place(which).is_some_and(|p| memory.values[p] == value);
            is(found, 0.0) && is(speed, limit)
        };
        let slope = |role: &Role| match Known::of(*role) {
            Some(Known::Calculated(which)) => match which {
                Calculated::OnsetSpeed => none(Calculated::OnsetFound, which),
                Calculated::DivergenceSpeed => none(Calculated::DivergenceFound, which),
                Calculated::OnsetFrequency
                | Calculated::OnsetReducedVelocity
                | Calculated::OnsetFound
                | Calculated::OnsetInTestedRange
                | Calculated::DivergenceFound
                | Calculated::StableBelowOnset => false,
            },
            Some(Known::Status(status)) => match status {
                Safety::FlutterSpeed | Safety::FlutterMargin => {
                    none(Calculated::OnsetFound, Calculated::OnsetSpeed)
                }
                Safety::DampingNow | Safety::WindInTestedRange | Safety::AmplitudeInLinearRange => {
                    false
                }
            },
            None => false,
        };
        unknowns
            .iter()
            .map(|u| f64::from(u8::from(slope(u))))
            .collect()
    }

    fn by_parameter(
        &mut self,
        resources: &Resources,
        memory: &Memory,
        known: usize,
        unknowns: &[Role],
    ) -> CallResult<Vec<f64>> {
        let Some(options) = &resources.bridge else {
            return Ok(vec![0.0; unknowns.len()]);
        };
        let step = parameter_step(memory.values[known]);
        central_difference(resources, memory, known, step, |other| {
            let changed = Built::new(resources, options, &other.values)?;
            let present = std::mem::replace(&mut self.built, changed);
            let found = self.unknowns(other, unknowns);
            self.built = present;
            Ok(found?)
        })
    }

    /// The unknowns of a bridge that is released with the values in `memory`.
    fn unknowns(&mut self, memory: &Memory, unknowns: &[Role]) -> Result<Vec<f64>> {
        self.load_inputs(memory);
        let state = self.release(&memory.values)?;
        let instant = self.instant(&state)?;
        let wind = memory.values[self.places.inputs[0]];
        let wants = |wanted: fn(&Role) -> bool| unknowns.iter().any(wanted);
        let limit = memory.values[self.places.limit];
        let card =
            wants(is_of_onset).then(|| OnsetCard::of_bridge(&self.built, self.tested, limit).0);
        let damping = if unknowns.contains(&Role::Status(Safety::DampingNow)) {
            smallest_damping(self.built.stepper.section(), wind)?
        } else {
            0.0
        };
        let calculated = |which| card.as_ref().map_or(0.0, |card| card.value(which));
        let value = |unknown: &Role| {
            let still = without_motion(*unknown, calculated, wind, damping);
            still.unwrap_or_else(|| self.pick_of(&instant, *unknown))
        };
        Ok(unknowns.iter().map(value).collect())
    }
}
