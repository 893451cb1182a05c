//! The whole bridge: modal coordinates in self-excited wind forces and gusts, seen through some of its nodes.
//!
//! The stepper is that of the section: one exact matrix at constant wind, the Taylor series where the wind changes or gusts
//! blow.

use super::bridge_built::Built;
use super::bridge_followed::SearchedOnset;
use super::bridge_places::BridgePlaces;
use super::layout::Source;
use super::memory::{Memory, starts};
use super::section::OnsetCard;
use super::sensitivity::{SectionValues, check_finite, finite};
use super::trust::{LINEAR_ROTATION_RAD, MonitoredUnit, beyond_linear};
use super::unit::{Differentiable, Prepared, Unit};
use crate::aeroelastic::CoupledSection;
use crate::bridge_options::BridgeOptions;
use crate::error::{Error, Result};
use crate::lifecycle::State;
use crate::refusal::CallResult;
use crate::resources::Resources;
use crate::response::{Inputs, Outputs, SectionState};
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use crate::variables::{ModeOutput, Role};
use nalgebra::DMatrix;

/// See the module.
#[derive(Debug)]
pub(super) struct BridgeUnit {
    pub places: BridgePlaces,
    /// What follows from the parameters.
    pub built: Built,
    /// Whether they have changed since.
    stale: bool,
    pub tested: Option<ReducedFrequencyRange>,
    /// Displacements of the mass-normalised modes: vertical, lateral, rotation of each named node.
    shapes: DMatrix<f64>,
    /// Root of the generalised mass of each mode.
    pub roots: Vec<f64>,
    release_pending: bool,
    onset_current: bool,
    /// From which the onset of other parameters is followed.
    searched: Option<SearchedOnset>,
    warned: bool,
    pub inputs: Inputs,
    outputs: Outputs,
}

impl BridgeUnit {
    /// The bridge of an export.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for numbers that make no bridge; [`crate::Error::Numerical`] for a table that is not one of a bridge.
    pub(super) fn new(resources: &Resources, options: &BridgeOptions) -> Result<Self> {
        let table = &resources.table;
        let built = Built::new(resources, options, &starts(table))?;
        // without a start the first onset is searched for
        let start = options.onset.as_ref();
        let searched = start.and_then(|start| SearchedOnset::from(&built, start).ok());
        let masses = options.modes.iter().map(|m| m.generalised_mass.sqrt());
        Ok(Self {
            places: BridgePlaces::new(table, options)?,
            shapes: built.bridge.shapes_at(&options.named),
            roots: masses.collect(),
            tested: options.tested_range,
            inputs: Inputs::steady(0.0, options.modes.len()),
            built,
            stale: false,
            release_pending: true,
            onset_current: false,
            searched,
            warned: false,
            outputs: Outputs::default(),
        })
    }

    /// Wind, and forces and gusts on the modes, at the time of the memory.
    pub(super) fn load_inputs(&mut self, memory: &Memory) {
        self.load_own_inputs(memory);
        let factor = self.turbulence_factor(memory);
        self.built
            .add_turbulence(&mut self.inputs, memory.time, factor);
    }

    /// The same without the turbulence of the archive.
    fn load_own_inputs(&mut self, memory: &Memory) {
        let rates = &memory.input_rates;
        self.inputs.wind_speed_m_s = memory.values[self.places.inputs[0]];
        self.inputs.wind_speed_rate_m_s2 = rates[0];
        self.inputs.force.fill(0.0);
        self.inputs.force_rate.fill(0.0);
        let forces = &self.places.inputs[1..self.places.first_gust];
        for (row, place) in forces.iter().enumerate() {
            let (force, rate) = (memory.values[*place], rates[row + 1]);
            if force == 0.0 && rate == 0.0 {
                continue;
            }
            for (m, phi) in self.shapes.row(row).iter().enumerate() {
                self.inputs.force[m] += phi * force;
                self.inputs.force_rate[m] += phi * rate;
            }
        }
        let gusts = &self.places.inputs[self.places.first_gust..];
        let gusts = gusts.iter().map(|place| memory.values[*place]);
        let gust_rates = rates[self.places.first_gust..].iter().copied();
        self.built.set_gusts(&mut self.inputs, gusts, gust_rates);
    }

    fn turbulence_factor(&self, memory: &Memory) -> f64 {
        let place = self.places.turbulence_factor;
        place.map_or(0.0, |place| memory.values[place])
    }

    /// State at release with the initial values in `values` and the gusts that are loaded, which have blown like that until then.
    pub(super) fn release(&self, values: &[f64]) -> Result<SectionState> {
        let initial = self.places.initial.iter().zip(&self.roots);
        let displacement: Vec<f64> = initial.map(|(place, root)| values[*place] * root).collect();
        let still = vec![0.0; displacement.len()];
        let mut state = self.built.stepper.released(&displacement, &still)?;
        let channels = &self.inputs.gust_m_s;
        let lags = state.gusts.len() / channels.len().max(1);
        for (lagging, gust) in state.gusts.chunks_mut(lags.max(1)).zip(channels) {
            lagging.fill(*gust);
        }
        Ok(state)
    }

    /// What a role stands for in the motion of the mass-normalised modes.
    pub(super) fn pick(&self, modal: &Outputs, role: Role) -> f64 {
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

    /// The same with the states and their rates.
    pub(super) fn pick_of(&self, instant: &SectionValues, role: Role) -> f64 {
        match role {
            Role::Filter(entry) => instant.of_state(entry),
            Role::FilterRate(entry) => instant.of_rate(entry),
            other => self.pick(&instant.outputs, other),
        }
    }

    /// Outputs of the modes for a state, with the inputs that are loaded.
    pub(super) fn modal(&mut self, state: &SectionState) -> Result<Outputs> {
        let mut outputs = Outputs::default();
        self.built
            .stepper
            .outputs(state, &self.inputs, &mut outputs)?;
        Ok(outputs)
    }

    /// All that there is in a state, with the inputs that are loaded.
    pub(super) fn instant(&mut self, state: &SectionState) -> Result<SectionValues> {
        SectionValues::of(&mut self.built.stepper, state, &self.inputs)
    }

    fn write(&mut self, card: OnsetCard, memory: &mut Memory, notices: &mut Vec<String>) {
        for (place, which) in &self.places.calculated {
            memory.values[*place] = card.value(*which);
        }
        notices.extend(card.warnings);
        self.onset_current = true;
    }

    /// `∂/∂V`, per m/s, in the state of `memory` with the inputs that are loaded.
    pub(super) fn by_wind(&self, memory: &Memory) -> SectionValues {
        SectionValues::by_speed(&self.built.stepper, &memory.system, &self.inputs)
    }
}

impl MonitoredUnit for BridgeUnit {
    fn coupled(&self) -> Option<&CoupledSection> {
        Some(self.built.stepper.section())
    }

    fn damping_at(&mut self, wind: f64) -> Result<f64> {
        self.built.damping_at(wind)
    }

    fn wind_speed(&self, memory: &Memory) -> f64 {
        memory.values[self.places.inputs[0]]
    }

    fn onset_speed(&self, memory: &Memory) -> f64 {
        memory.values[self.places.onset_speed]
    }

    /// Of a named node.
    fn rotation(&self, memory: &Memory) -> f64 {
        let modes = &memory.system.values[..self.roots.len()];
        let rotation = |row: usize| -> f64 {
            let shape = self.shapes.row(row);
            shape.iter().zip(modes).map(|(phi, x)| phi * x).sum()
        };
        let rotations = (2..self.shapes.nrows()).step_by(3).map(rotation);
        rotations.fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a })
    }

    /// At the frequency of flutter: the modes of a bridge have too many of their own.
    fn wind_is_tested(
        &mut self,
        resources: &Resources,
        memory: &mut Memory,
        notices: &mut Vec<String>,
    ) -> bool {
        self.calculate(resources, memory, notices);
        let found = memory.values[self.places.onset_found] != 0.0;
        let hertz = memory.values[self.places.onset_frequency];
        let wind = self.wind_speed(memory);
        let k = ReducedFrequency::from_hertz(hertz, self.built.bridge.width_m(), wind);
        found && wind > 0.0 && self.tested.is_some_and(|r| r.contains(k))
    }
}

impl Unit for BridgeUnit {
    fn inputs(&self) -> &[usize] {
        &self.places.inputs
    }

    fn at_rest(&self) -> SectionState {
        self.built.at_rest()
    }

    fn changed(&mut self, source: Source) {
        match source {
            Source::Section => {
                self.stale = true;
                self.onset_current = false;
                self.release_pending = true;
            }
            Source::Release => self.release_pending = true,
            Source::Limit => self.onset_current = false,
            _ => {}
        }
    }

    fn input_set(&mut self, memory: &mut Memory, place: usize, _: bool) -> bool {
        let gusts = &self.places.inputs[self.places.first_gust..];
        if memory.state == State::Initialization && gusts.contains(&place) {
            self.release_pending = true;
        }
        false
    }

    fn begin_initialization(&mut self) {
        self.warned = false;
        self.release_pending = true;
    }

    fn replace(&mut self, new: &mut Memory, old: &Memory, same: &dyn Fn(Source) -> bool) {
        let same_bridge = same(Source::Section);
        self.stale |= !same_bridge;
        self.onset_current &= same_bridge && same(Source::Limit);
        if self.onset_current {
            // numbers that were searched for stay
            for (place, _) in &self.places.calculated {
                new.values[*place] = old.values[*place];
            }
        }
        self.release_pending = true;
    }

    fn prepared(
        &mut self,
        resources: &Resources,
        memory: &mut Memory,
    ) -> Result<&mut dyn Differentiable> {
        if let (true, Some(options)) = (self.stale, &resources.bridge) {
            self.built = Built::new(resources, options, &memory.values)?;
            self.stale = false;
        }
        if self.release_pending && memory.state == State::Initialization {
            self.load_inputs(memory);
            memory.system = self.release(&memory.values)?;
            self.release_pending = false;
        }
        Ok(self)
    }

    fn cannot_calculate(&mut self, memory: &mut Memory, why: &Error, notices: &mut Vec<String>) {
        if !self.onset_current {
            self.write(OnsetCard::unknown(why), memory, notices);
        }
    }

    fn watch(&mut self, _: &Resources, memory: &Memory, notices: &mut Vec<String>) {
        if self.warned {
            return;
        }
        let rotation = self.rotation(memory);
        if rotation.abs() > LINEAR_ROTATION_RAD {
            self.warned = true;
            notices.push(beyond_linear(rotation));
        }
    }

    fn held_output(&self, place: usize) -> Option<usize> {
        self.places.state_entry[place]
    }
}

impl Prepared for BridgeUnit {
    fn advance(&mut self, _: &Resources, memory: &mut Memory, step: f64) -> CallResult<bool> {
        self.load_own_inputs(memory);
        let factor = self.turbulence_factor(memory);
        let (time, system) = (memory.time, &mut memory.system);
        self.built
            .advance(system, &self.inputs, time, step, factor)?;
        Ok(false)
    }

    fn state_rates(&mut self, memory: &Memory, rates: &mut [f64]) -> CallResult<()> {
        self.load_inputs(memory);
        let stepper = &mut self.built.stepper;
        stepper.write_derivative(&memory.system, &self.inputs, rates)?;
        finite(rates)
    }

    fn outputs(&mut self, _: &Resources, memory: &mut Memory) -> CallResult<()> {
        self.load_inputs(memory);
        let (stepper, inputs) = (&mut self.built.stepper, &self.inputs);
        stepper.outputs(&memory.system, inputs, &mut self.outputs)?;
        check_finite(&self.outputs)?;
        for (place, role) in &self.places.responses {
            memory.values[*place] = self.pick(&self.outputs, *role);
        }
        Ok(())
    }

    fn calculate(&mut self, _: &Resources, memory: &mut Memory, notices: &mut Vec<String>) {
        if self.onset_current {
            return;
        }
        let limit = memory.values[self.places.limit];
        let known = self.searched.as_ref();
        let followed = known.and_then(|known| known.followed(&mut self.built, limit));
        let card = match followed {
            Some(onset) => OnsetCard::of_followed(&self.built, self.tested, limit, &onset),
            None => {
                let (card, searched) = OnsetCard::of_bridge(&self.built, self.tested, limit);
                self.searched = searched;
                card
            }
        };
        self.write(card, memory, notices);
    }

    fn status(
        &mut self,
        resources: &Resources,
        memory: &mut Memory,
        role: Role,
        notices: &mut Vec<String>,
    ) -> f64 {
        self.present(resources, memory, role, notices)
    }
}
