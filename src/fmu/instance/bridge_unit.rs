//! The whole bridge: modal coordinates in self-excited wind forces, seen through some of its nodes.
//!
//! The stepper is that of the section: one exact matrix at constant wind, the Taylor series where the wind changes.

use super::layout::{Source, place};
use super::saving::Memory;
use super::section_derivatives::{add, speed_sensitivity};
use super::trust::{LINEAR_ROTATION_RAD, beyond_linear};
use super::unit::Unit;
use crate::aerodynamics::Transfer;
use crate::aeroelastic::CoupledSection;
use crate::bridge::Bridge;
use crate::error::Result;
use crate::flutter::{FlutterSearch, OnsetSearch, divergence_speed, find_onset};
use crate::fmu::bridge_options::BridgeOptions;
use crate::fmu::lifecycle::State;
use crate::fmu::refusal::{Answer, Refusal};
use crate::fmu::resources::Resources;
use crate::fmu::variables::{Calculated, ModeOutput, Role, VariableTable};
use crate::response::{Inputs, Outputs, SectionState, Stepper};
use crate::section::Dof;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use nalgebra::DMatrix;

/// Speeds of the search for the onset; more than for a section would take seconds.
const SPEEDS: usize = 60;

/// See the module.
#[derive(Debug)]
pub(super) struct BridgeUnit {
    bridge: Bridge,
    tested: Option<ReducedFrequencyRange>,
    stepper: Stepper,
    /// Displacements of the mass-normalised modes: vertical, lateral, rotation of each named node.
    shapes: DMatrix<f64>,
    /// Root of the generalised mass of each mode.
    roots: Vec<f64>,
    /// Wind, then the forces in the rows of `shapes`.
    inputs_at: Vec<usize>,
    /// What is put out, with its place.
    outputs_at: Vec<(usize, Role)>,
    initial_at: Vec<usize>,
    limit_at: usize,
    release_pending: bool,
    onset_current: bool,
    told: bool,
    inputs: Inputs,
    outputs: Outputs,
}

impl BridgeUnit {
    /// The bridge of an export.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for numbers that make no bridge; [`crate::Error::Numerical`] for a table that is not one of a bridge.
    pub fn new(table: &VariableTable, options: &BridgeOptions) -> Result<Self> {
        let bridge = options.bridge()?;
        let coupled = CoupledSection::new(bridge.structure(), bridge.forces().realize()?)?;
        let n = bridge.modes.len();
        let named = 0..options.named.len();
        let mut inputs_at = vec![place(table, Role::WindSpeed)?];
        for (node, dof) in named.flat_map(|node| Dof::THREE.map(|dof| (node, dof))) {
            inputs_at.push(place(table, Role::NodeForce(node, dof))?);
        }
        let initial_at = (0..n).map(|m| place(table, Role::InitialMode(m)));
        let outputs = table.variables().iter().enumerate();
        let outputs =
            outputs.filter(|(_, v)| matches!(v.role, Role::NodeMotion(..) | Role::Mode(..)));
        Ok(Self {
            shapes: bridge.shapes_at(&options.named),
            roots: bridge
                .modes
                .iter()
                .map(|m| m.generalised_mass.sqrt())
                .collect(),
            tested: options.tested_range,
            initial_at: initial_at.collect::<Result<_>>()?,
            limit_at: place(table, Role::OnsetSearchLimit)?,
            outputs_at: outputs.map(|(i, v)| (i, v.role)).collect(),
            inputs: Inputs::steady(0.0, n),
            stepper: Stepper::new(coupled),
            inputs_at,
            bridge,
            release_pending: true,
            onset_current: false,
            told: false,
            outputs: Outputs::default(),
        })
    }

    /// Wind and forces on the modes.
    fn load_inputs(&mut self, memory: &Memory) {
        self.inputs.wind_speed_m_s = memory.values[self.inputs_at[0]];
        self.inputs.wind_speed_rate_m_s2 = memory.input_rates[0];
        self.inputs.force.fill(0.0);
        self.inputs.force_rate.fill(0.0);
        for (row, place) in self.inputs_at[1..].iter().enumerate() {
            let (force, rate) = (memory.values[*place], memory.input_rates[row + 1]);
            if force == 0.0 && rate == 0.0 {
                continue;
            }
            for (m, phi) in self.shapes.row(row).iter().enumerate() {
                self.inputs.force[m] += phi * force;
                self.inputs.force_rate[m] += phi * rate;
            }
        }
    }

    fn release(&self, values: &[f64]) -> Result<SectionState> {
        let initial = self.initial_at.iter().zip(&self.roots);
        let displacement: Vec<f64> = initial.map(|(place, root)| values[*place] * root).collect();
        self.stepper
            .released(&displacement, &vec![0.0; displacement.len()])
    }

    /// What a role stands for in the motion of the mass-normalised modes.
    fn pick(&self, modal: &Outputs, role: Role) -> f64 {
        match role {
            Role::NodeMotion(node, response, dof) => {
                let row = self.shapes.row(3 * node + crate::bridge::motion_index(dof));
                let list = modal.lists()[response as usize];
                row.iter().zip(list).map(|(phi, x)| phi * x).sum()
            }
            Role::Mode(m, ModeOutput::Coordinate) => modal.displacement[m] / self.roots[m],
            Role::Mode(m, ModeOutput::Rate) => modal.rate[m] / self.roots[m],
            Role::Mode(m, ModeOutput::Force) => modal.self_excited_force[m] * self.roots[m],
            _ => 0.0,
        }
    }

    /// Outputs of the modes for a state, with the inputs that are loaded.
    fn modal(&mut self, state: &SectionState) -> Result<Outputs> {
        let mut outputs = Outputs::default();
        self.stepper.outputs(state, &self.inputs, &mut outputs)?;
        Ok(outputs)
    }

    /// `∂/∂V`, per m/s, in the state of `memory`.
    fn by_wind(&self, memory: &Memory) -> Outputs {
        let speed = memory.values[self.inputs_at[0]];
        let inputs = Inputs::steady(speed, self.roots.len());
        speed_sensitivity(&self.stepper, &memory.system, &inputs)
    }

    /// Onset and divergence up to `limit`, written where they stand in the table.
    fn search(&self, limit: f64, notices: &mut Vec<String>) -> [f64; 8] {
        let mut values = [0.0; 8];
        let mut set = |which: Calculated, value: f64| values[which as usize] = value;
        set(Calculated::OnsetSpeed, limit);
        set(Calculated::DivergenceSpeed, limit);
        let search = OnsetSearch {
            speed_max_m_s: limit,
            speeds: SPEEDS,
        };
        match find_onset("bridge", self.stepper.section(), &search, None) {
            Ok(FlutterSearch::Onset(o)) => {
                set(Calculated::OnsetSpeed, o.at.speed_m_s);
                set(Calculated::OnsetFrequency, o.at.frequency_hz);
                set(
                    Calculated::OnsetReducedVelocity,
                    o.at.reduced_velocity.v_star(),
                );
                set(Calculated::OnsetFound, 1.0);
                let tested = self
                    .tested
                    .is_some_and(|r| r.contains(o.at.reduced_frequency));
                set(Calculated::OnsetInTestedRange, f64::from(u8::from(tested)));
                set(Calculated::StableBelowOnset, 1.0);
                notices.extend(o.warnings);
            }
            Ok(FlutterSearch::UnstableAtOrBelow(start)) => {
                set(Calculated::OnsetSpeed, start.at.speed_m_s);
                set(Calculated::OnsetFrequency, start.at.frequency_hz);
                set(Calculated::OnsetFound, 1.0);
                notices.push(format!(
                    "the onset lies at {:.3} m/s or lower: {}",
                    start.at.speed_m_s, start.reason
                ));
            }
            Ok(FlutterSearch::StableUpTo(_)) => set(Calculated::StableBelowOnset, 1.0),
            Err(why) => notices.push(format!("flutter onset is not known: {why}")),
        }
        let still = ReducedFrequency::from_full_width(0.0);
        let divergence = self.bridge.forces().transfer(still);
        match divergence.and_then(|g| divergence_speed(self.stepper.section().structure(), &g)) {
            Ok(Some(speed)) if speed <= limit => {
                set(Calculated::DivergenceSpeed, speed);
                set(Calculated::DivergenceFound, 1.0);
            }
            Ok(_) => {}
            Err(why) => notices.push(format!("divergence is not known: {why}")),
        }
        values
    }
}

impl Unit for BridgeUnit {
    fn inputs(&self) -> &[usize] {
        &self.inputs_at
    }

    fn at_rest(&self) -> SectionState {
        SectionState {
            values: vec![0.0; self.stepper.section().states()],
            ..SectionState::default()
        }
    }

    fn changed(&mut self, source: Source) {
        match source {
            Source::Release => self.release_pending = true,
            Source::Limit => self.onset_current = false,
            _ => {}
        }
    }

    fn begin_initialization(&mut self) {
        self.told = false;
        self.release_pending = true;
    }

    fn replace(&mut self, new: &mut Memory, old: &Memory, same: &dyn Fn(Source) -> bool) {
        self.onset_current &= same(Source::Limit);
        if self.onset_current {
            // numbers that were searched for stay
            let stated = self
                .outputs_at
                .iter()
                .map(|(place, _)| *place)
                .max()
                .unwrap_or(0);
            for place in stated + 1..new.values.len() {
                if place != self.limit_at && !self.initial_at.contains(&place) {
                    new.values[place] = old.values[place];
                }
            }
        }
        self.release_pending = true;
    }

    fn prepare(&mut self, _: &Resources, memory: &mut Memory) -> Result<()> {
        if self.release_pending && memory.state == State::Initialization {
            memory.system = self.release(&memory.values)?;
            self.release_pending = false;
        }
        Ok(())
    }

    fn watch(&mut self, _: &Resources, memory: &Memory, notices: &mut Vec<String>) {
        if self.told {
            return;
        }
        let modes = &memory.system.values[..self.roots.len()];
        let rotation = |row: usize| -> f64 {
            self.shapes
                .row(row)
                .iter()
                .zip(modes)
                .map(|(phi, x)| phi * x)
                .sum()
        };
        let rotations = (2..self.shapes.nrows()).step_by(3).map(rotation);
        let largest = rotations.fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
        if largest.abs() > LINEAR_ROTATION_RAD {
            self.told = true;
            notices.push(beyond_linear(largest));
        }
    }

    fn advance(&mut self, _: &Resources, memory: &mut Memory, step: f64) -> Answer<bool> {
        self.load_inputs(memory);
        self.stepper
            .advance(&mut memory.system, &self.inputs, step)?;
        Ok(false)
    }

    fn outputs(&mut self, _: &Resources, memory: &mut Memory) -> Answer<()> {
        self.load_inputs(memory);
        let mut outputs = std::mem::take(&mut self.outputs);
        let made = self
            .stepper
            .outputs(&memory.system, &self.inputs, &mut outputs);
        self.outputs = outputs;
        made?;
        if !self
            .outputs
            .lists()
            .into_iter()
            .flatten()
            .all(|x| x.is_finite())
        {
            return Err(Refusal::discard(
                "outputs: the motion has grown beyond the range of numbers",
            ));
        }
        for (place, role) in &self.outputs_at {
            memory.values[*place] = self.pick(&self.outputs, *role);
        }
        Ok(())
    }

    fn calculate(&mut self, resources: &Resources, memory: &mut Memory, notices: &mut Vec<String>) {
        if self.onset_current {
            return;
        }
        let found = self.search(memory.values[self.limit_at], notices);
        for (place, variable) in resources.table.variables().iter().enumerate() {
            if let Role::Calculated(which) = variable.role {
                memory.values[place] = found[which as usize];
            }
        }
        self.onset_current = true;
    }

    /// `ẏ = C ż + D ẇ + (∂y/∂V) V̇`.
    fn output_rates(
        &mut self,
        _: &Resources,
        memory: &mut Memory,
        outputs: &[Role],
    ) -> Answer<Vec<f64>> {
        self.load_inputs(memory);
        let velocity = SectionState {
            values: self
                .stepper
                .state_derivative(&memory.system, &self.inputs)?,
            ..SectionState::default()
        };
        let wind_rate = self.inputs.wind_speed_rate_m_s2;
        self.inputs
            .force
            .copy_from_slice(&self.inputs.force_rate.clone());
        self.inputs.force_rate.fill(0.0);
        let mut rates = self.modal(&velocity)?;
        add(&mut rates, &self.by_wind(memory), wind_rate);
        Ok(outputs
            .iter()
            .map(|role| self.pick(&rates, *role))
            .collect())
    }

    /// Outputs are linear in state and forces; the derivative with respect to the wind is closed.
    fn derivatives(
        &mut self,
        resources: &Resources,
        memory: &mut Memory,
        known: usize,
        unknowns: &[Role],
    ) -> Answer<Vec<f64>> {
        let modal = match resources.table.variables()[known].role {
            Role::WindSpeed => self.by_wind(memory),
            Role::OnsetSearchLimit => {
                // what is found below the limit does not depend on it; what is not found is the limit
                self.calculate(resources, memory, &mut Vec::new());
                let value = |role| resources.table.find(role).map_or(0.0, |p| memory.values[p]);
                let none = |found| value(Role::Calculated(found)) == 0.0;
                let slope = |role: &Role| match role {
                    Role::Calculated(Calculated::OnsetSpeed) => none(Calculated::OnsetFound),
                    Role::Calculated(Calculated::DivergenceSpeed) => {
                        none(Calculated::DivergenceFound)
                    }
                    _ => false,
                };
                return Ok(unknowns
                    .iter()
                    .map(|u| f64::from(u8::from(slope(u))))
                    .collect());
            }
            _ => {
                let mut unit = memory.clone();
                for place in self.inputs_at[1..].iter().chain(&self.initial_at) {
                    unit.values[*place] = f64::from(u8::from(*place == known));
                }
                unit.input_rates.fill(0.0);
                let state = if self.initial_at.contains(&known) {
                    self.release(&unit.values)?
                } else {
                    self.at_rest()
                };
                self.load_inputs(&unit);
                self.modal(&state)?
            }
        };
        Ok(unknowns
            .iter()
            .map(|role| self.pick(&modal, *role))
            .collect())
    }
}
