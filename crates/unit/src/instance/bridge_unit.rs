//! The whole bridge: modal coordinates in self-excited wind forces and gusts, seen through some of its nodes.
//!
//! The stepper is that of the section: one exact matrix at constant wind, the Taylor series where the wind changes or gusts
//! blow.

use super::bridge_built::Built;
use super::bridge_followed::SearchedOnset;
use super::calculated::CalculatedNumbers;
use super::coupled::{CoupledPlaces, CoupledUnit, blow_until_release};
use super::layout::Source;
use super::memory::{Memory, starts};
use super::section::OnsetCard;
use super::sensitivity::{SectionValues, check_finite, finite};
use super::trust::beyond_linear;
use super::unit::{Differentiable, Prepared, Unit};
use crate::aeroelastic::CoupledSection;
use crate::bridge_options::BridgeOptions;
use crate::error::Result;
use crate::lifecycle::State;
use crate::onset_start::OnsetStart;
use crate::refusal::CallResult;
use crate::resources::Resources;
use crate::response::{Inputs, Outputs, SectionState, Stepper};
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use crate::variables::{LINEAR_ROTATION_RAD, ModeOutput, OnsetNumbers, Role};
use nalgebra::DMatrix;

/// See the module.
#[derive(Debug)]
pub(super) struct BridgeUnit {
    places: CoupledPlaces,
    /// Motions and modes: places, and what they stand for.
    responses: Vec<(usize, Role)>,
    /// What follows from the parameters.
    built: Built,
    /// Whether they have changed since.
    stale: bool,
    tested: Option<ReducedFrequencyRange>,
    /// Displacements of the mass-normalised modes: vertical, lateral, rotation of each named node.
    shapes: DMatrix<f64>,
    /// Root of the generalised mass of each mode.
    roots: Vec<f64>,
    release_pending: bool,
    calculated: CalculatedNumbers,
    /// Onset of the bridge as it was exported, until something follows from it.
    start: Option<OnsetStart>,
    /// From which the onset of other parameters is followed.
    searched: Option<SearchedOnset>,
    warned: bool,
    inputs: Inputs,
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
        let masses = options.modes.iter().map(|m| m.generalised_mass.sqrt());
        Ok(Self {
            places: CoupledPlaces::of_bridge(table, options)?,
            responses: (0..)
                .zip(table.variables())
                .filter(|(_, v)| {
                    matches!(
                        v.role,
                        Role::NodeMotion(..) | Role::Mode(..) | Role::Damper(..)
                    )
                })
                .map(|(place, v)| (place, v.role))
                .collect(),
            shapes: built.bridge.shapes_at(&options.named),
            roots: masses.collect(),
            tested: options.tested_range,
            inputs: Inputs::steady(0.0, options.coordinates()),
            built,
            stale: false,
            release_pending: true,
            calculated: CalculatedNumbers::new(&resources.table),
            // without a start the first onset is searched for
            start: options.onset,
            searched: None,
            warned: false,
            outputs: Outputs::default(),
        })
    }

    /// Makes the start that came with the archive one to follow, as long as the bridge is the one that was exported.
    fn take_start(&mut self) {
        if let Some(start) = self.start.take() {
            self.searched = SearchedOnset::from(&self.built, &start).ok();
        }
    }

    /// Loads wind, and forces and gusts on the modes, without the turbulence of the archive.
    fn load_own_inputs(&mut self, memory: &Memory) {
        let rates = &memory.input_rates;
        self.inputs.wind_speed_m_s = self.places.wind_speed(memory);
        self.inputs.wind_speed_rate_m_s2 = rates[0];
        self.inputs.force.fill(0.0);
        self.inputs.force_rate.fill(0.0);
        for (row, place) in self.places.forces().iter().enumerate() {
            let (force, rate) = (memory.values[*place], rates[row + 1]);
            if force == 0.0 && rate == 0.0 {
                continue;
            }
            for (m, phi) in self.shapes.row(row).iter().enumerate() {
                self.inputs.force[m] += phi * force;
                self.inputs.force_rate[m] += phi * rate;
            }
        }
        let gusts = self.places.gusts().iter();
        let gusts = gusts.map(|place| memory.values[*place]);
        let gust_rates = rates[self.places.first_gust..].iter().copied();
        self.built.set_gusts(&mut self.inputs, gusts, gust_rates);
    }

    fn turbulence_factor(&self, memory: &Memory) -> f64 {
        let place = self.places.turbulence_factor;
        place.map_or(0.0, |place| memory.values[place])
    }

    /// What a role stands for in the motion of the mass-normalised modes.
    fn pick_modal(&self, modal: &Outputs, role: Role) -> f64 {
        match role {
            Role::NodeMotion(node, response, dof) => {
                let row = 3 * node + crate::bridge::motion_index(dof);
                self.at_row(row, modal.lists()[response as usize])
            }
            Role::Damper(d, response) => {
                let list = modal.lists()[response as usize];
                product(&self.built.strokes, d, list)
            }
            Role::Mode(m, ModeOutput::Coordinate) => modal.displacement[m] / self.roots[m],
            Role::Mode(m, ModeOutput::Rate) => modal.rate[m] / self.roots[m],
            Role::Mode(m, ModeOutput::Force) => modal.self_excited_force[m] * self.roots[m],
            _ => 0.0,
        }
    }

    /// Displacement in a row of the shapes by mass-normalised coordinates.
    pub(super) fn at_row(&self, row: usize, modes: &[f64]) -> f64 {
        product(&self.shapes, row, modes)
    }

    /// The row of the shapes that is the greatest rotation of a named node.
    fn most_turned(&self, modes: &[f64]) -> usize {
        let (mut most, mut greatest) = (2, 0.0);
        for row in (2..self.shapes.nrows()).step_by(3) {
            let turned = self.at_row(row, modes).abs();
            if turned > greatest {
                (most, greatest) = (row, turned);
            }
        }
        most
    }
}

/// A row of a matrix times as many numbers as there are.
fn product(matrix: &DMatrix<f64>, row: usize, numbers: &[f64]) -> f64 {
    matrix
        .row(row)
        .iter()
        .zip(numbers)
        .map(|(phi, x)| phi * x)
        .sum()
}

impl CoupledUnit for BridgeUnit {
    fn places(&self) -> &CoupledPlaces {
        &self.places
    }

    fn onset(&self) -> OnsetNumbers {
        self.calculated.onset()
    }

    fn parts(&mut self) -> (&mut Stepper, &mut Inputs) {
        (&mut self.built.stepper, &mut self.inputs)
    }

    fn section(&self) -> &CoupledSection {
        self.built.stepper.section()
    }

    fn load_inputs(&mut self, memory: &Memory) {
        self.load_own_inputs(memory);
        let factor = self.turbulence_factor(memory);
        self.built
            .add_turbulence(&mut self.inputs, memory.time, factor);
    }

    fn release(&self, values: &[f64]) -> Result<SectionState> {
        let initial = self.places.initial.iter().zip(&self.roots);
        let mut displacement: Vec<f64> =
            initial.map(|(place, root)| values[*place] * root).collect();
        // masses of dampers go with the girder
        for (d, damper) in self.built.bridge.dampers.masses.iter().enumerate() {
            let stroke = product(&self.built.strokes, d, &displacement[..self.roots.len()]);
            displacement.push(-stroke * damper.mass_kg.sqrt());
        }
        let still = vec![0.0; displacement.len()];
        let mut state = self.built.stepper.released(&displacement, &still)?;
        blow_until_release(&mut state, &self.inputs.gust_m_s);
        Ok(state)
    }

    fn pick(&self, instant: &SectionValues, role: Role) -> f64 {
        match role {
            Role::Filter(entry) => instant.of_state(entry),
            Role::FilterRate(entry) => instant.of_rate(entry),
            other => self.pick_modal(&instant.outputs, other),
        }
    }

    /// Of a named node.
    fn turn(&self, state: &SectionState, outputs: &Outputs) -> f64 {
        let row = self.most_turned(&state.values[..self.roots.len()]);
        self.at_row(row, &outputs.displacement)
    }

    fn rotation(&self, memory: &Memory) -> f64 {
        let modes = &memory.system.values[..self.roots.len()];
        self.at_row(self.most_turned(modes), modes)
    }

    fn damping_at(&mut self, wind: f64) -> Result<f64> {
        self.built.damping_at(wind)
    }

    /// At the frequency of flutter: the modes of a bridge have too many of their own.
    fn wind_is_tested(
        &mut self,
        resources: &Resources,
        memory: &mut Memory,
        notices: &mut Vec<String>,
    ) -> bool {
        self.calculate(resources, memory, notices);
        let onset = self.calculated.onset();
        let wind = self.places.wind_speed(memory);
        let (hertz, width) = (onset.frequency_hz.value, self.built.bridge.width_m());
        let k = ReducedFrequency::from_hertz(hertz, width, wind);
        onset.found && wind > 0.0 && self.tested.is_some_and(|r| r.contains(k))
    }

    fn searched(&self, _: &Resources, memory: &Memory) -> OnsetNumbers {
        let limit = self.places.limit(memory);
        OnsetCard::of_bridge(&self.built, self.tested, limit)
            .0
            .numbers
    }

    fn with_parameters(
        &mut self,
        resources: &Resources,
        other: &Memory,
        result: &mut dyn FnMut(&mut Self) -> Result<Vec<f64>>,
    ) -> Result<Vec<f64>> {
        let Some(options) = &resources.bridge else {
            return result(self);
        };
        let of_other = Built::new(resources, options, &other.values)?;
        let present = std::mem::replace(&mut self.built, of_other);
        let found = result(self);
        self.built = present;
        found
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
                self.calculated.forget();
                self.release_pending = true;
            }
            Source::Release => self.release_pending = true,
            Source::Limit => self.calculated.forget(),
            _ => {}
        }
    }

    fn input_set(&mut self, memory: &mut Memory, place: usize, _: bool) -> bool {
        if memory.state == State::Initialization && self.places.gusts().contains(&place) {
            self.release_pending = true;
        }
        false
    }

    fn begin_initialization(&mut self) {
        self.warned = false;
        self.release_pending = true;
    }

    fn replace(&mut self, new: &mut Memory, same: &dyn Fn(Source) -> bool) {
        let same_bridge = same(Source::Section);
        self.stale |= !same_bridge;
        self.calculated
            .carry_over(new, same_bridge && same(Source::Limit));
        self.release_pending = true;
    }

    fn prepared(
        &mut self,
        resources: &Resources,
        memory: &mut Memory,
    ) -> Result<&mut dyn Differentiable> {
        if let (true, Some(options)) = (self.stale, &resources.bridge) {
            let built = Built::new(resources, options, &memory.values)?;
            self.take_start();
            self.built = built;
            self.stale = false;
        }
        if self.release_pending && memory.state == State::Initialization {
            self.load_inputs(memory);
            memory.system = self.release(&memory.values)?;
            self.release_pending = false;
        }
        Ok(self)
    }

    fn calculated(&mut self) -> Option<&mut CalculatedNumbers> {
        Some(&mut self.calculated)
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
        for (place, role) in &self.responses {
            memory.values[*place] = self.pick_modal(&self.outputs, *role);
        }
        Ok(())
    }

    fn calculate(&mut self, _: &Resources, memory: &mut Memory, notices: &mut Vec<String>) {
        if self.calculated.are_known() {
            return;
        }
        let limit = self.places.limit(memory);
        self.take_start();
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
        self.calculated.enter(card, memory, notices);
    }
}
