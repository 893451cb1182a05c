//! The coupled section: a structure in self-excited wind forces. Onset and divergence are searched for when first asked
//! for after a change of parameters.

use super::calculated::CalculatedNumbers;
use super::coupled::{CoupledPlaces, CoupledUnit, blow_until_release};
use super::damping::PresentDamping;
use super::layout::Source;
use super::memory::{Memory, starts};
use super::section::{self, OnsetCard};
use super::section_places::{ResponsePlaces, response_places};
use super::sensitivity::{SectionValues, check_finite, finite};
use super::trust::{TrustWarnings, tested_winds};
use super::unit::{Differentiable, Prepared, Unit};
use crate::aerodynamics::{Realizable, Realization};
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::flutter::UnwantedGrowth;
use crate::lifecycle::State;
use crate::refusal::CallResult;
use crate::resources::Resources;
use crate::response::{Inputs, Outputs, RepeatableStep, SectionState, Stepper};
use crate::variables::{OnsetNumbers, Role};

/// Searches for growth of one instance at most: one takes as long as some thousand steps, and an importer may change
/// parameters at every communication point.
const GROWTH_SEARCHES: usize = 32;

/// What is known of the inputs.
#[derive(Debug, Clone, Copy)]
enum LoadedInputs {
    /// Those of the memory may be others.
    Stale,
    /// They are those of the memory.
    Current,
    /// And a step has been taken with them that may be taken again.
    Repeatable(RepeatableStep),
}

/// See the module.
#[derive(Debug)]
pub(super) struct SectionUnit {
    places: CoupledPlaces,
    responses: ResponsePlaces,
    aerodynamics: Realization,
    /// Of the current parameters.
    stepper: Stepper,
    /// Whether they have changed since.
    stale: bool,
    /// Wind speeds (m/s) at which it was tested, see [`tested_winds`].
    pub tested_winds: Option<[f64; 2]>,
    /// With that stepper.
    damping: PresentDamping,
    /// While initialising: the state has to be made anew from the values at release.
    release_pending: bool,
    calculated: CalculatedNumbers,
    /// Whether growth below the onset has been looked for with the current parameters.
    growth_known: bool,
    /// Searches for growth that this instance may still do.
    growth_searches_left: usize,
    pub warned: TrustWarnings,
    inputs: Inputs,
    loaded: LoadedInputs,
    outputs: Outputs,
}

impl SectionUnit {
    /// The section of a trained model.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for a model without a realisation, or whose section cannot be coupled with it.
    pub(super) fn new(resources: &Resources) -> Result<Self> {
        let responses = response_places(&resources.table)?;
        let places = CoupledPlaces::of_section(&resources.table, &responses)?;
        let gusts = places.gusts().len();
        let aerodynamics = resources.model.model.realize();
        let stepper = stepper(resources, &aerodynamics, &starts(&resources.table))?;
        Ok(Self {
            inputs: Inputs {
                gust_m_s: vec![0.0; gusts],
                gust_rate_m_s2: vec![0.0; gusts],
                ..Inputs::steady(0.0, responses.len())
            },
            places,
            responses,
            aerodynamics,
            tested_winds: tested_winds(&stepper, resources),
            stepper,
            stale: false,
            damping: PresentDamping::default(),
            release_pending: true,
            calculated: CalculatedNumbers::new(&resources.table),
            growth_known: false,
            growth_searches_left: GROWTH_SEARCHES,
            warned: TrustWarnings::default(),
            loaded: LoadedInputs::Stale,
            outputs: Outputs::default(),
        })
    }

    /// The inputs of the memory of this unit, which are loaded once until one is set.
    fn load_own_inputs(&mut self, memory: &Memory) {
        if matches!(self.loaded, LoadedInputs::Stale) {
            self.load_inputs(memory);
            // with a rate, a step carries them on
            if memory.input_rates.iter().all(|rate| *rate == 0.0) {
                self.loaded = LoadedInputs::Current;
            }
        }
    }

    /// Growth below the onset for the parameters in `values`.
    fn growth(&self, resources: &Resources, values: &[f64]) -> Result<UnwantedGrowth> {
        let Resources { model, table, .. } = resources;
        let limit = values[self.places.limit];
        let section = section::coupled_section(model, table, &self.aerodynamics, values)?;
        let forces = &self.aerodynamics;
        if let Some(speed) = section::plainly_stable_to(model, table, forces, values, limit) {
            return Ok(UnwantedGrowth::none_up_to(speed));
        }
        section::growth_of(model, &section, limit)
    }

    #[cold]
    fn watch_growth(&mut self, resources: &Resources, memory: &Memory, notices: &mut Vec<String>) {
        self.growth_known = true;
        self.growth_searches_left -= 1;
        match self.growth(resources, &memory.values) {
            Ok(growth) if growth.is_none() => {}
            Ok(growth) => notices.push(format!(
                "with these parameters the section {}",
                growth.explain()
            )),
            // no reason to end a run
            Err(e) => notices.push(format!("growth below the onset could not be judged: {e}")),
        }
        if self.growth_searches_left == 0 {
            notices.push(format!(
                "growth below the onset is no longer looked for after {GROWTH_SEARCHES} changes of parameters"
            ));
        }
    }

    pub(super) fn onset_card(&self, resources: &Resources, values: &[f64]) -> OnsetCard {
        let Resources { model, table, .. } = resources;
        let limit = values[self.places.limit];
        match section::coupled_section(model, table, &self.aerodynamics, values) {
            Ok(section) => {
                let plain = section::plain_onset(model, table, &self.aerodynamics, values, limit);
                OnsetCard::search(model, &section, limit, plain)
            }
            Err(why) => OnsetCard::unknown(&why),
        }
    }
}

impl Unit for SectionUnit {
    fn inputs(&self) -> &[usize] {
        &self.places.inputs
    }

    fn at_rest(&self) -> SectionState {
        SectionState {
            values: vec![0.0; self.stepper.section().states()],
            gusts: vec![0.0; self.stepper.gust_states()],
            ..SectionState::default()
        }
    }

    fn changed(&mut self, source: Source) {
        match source {
            Source::Input => self.loaded = LoadedInputs::Stale,
            Source::Section => {
                self.stale = true;
                self.loaded = LoadedInputs::Stale;
                self.calculated.forget();
                self.growth_known = false;
                self.release_pending = true;
            }
            Source::Release => self.release_pending = true,
            Source::Limit => {
                self.calculated.forget();
                self.growth_known = false;
            }
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
        self.warned = TrustWarnings::default();
        self.release_pending = true;
    }

    fn input_rate_set(&mut self, _: &mut Memory, _: usize) {
        self.loaded = LoadedInputs::Stale;
    }

    fn replace(&mut self, new: &mut Memory, same: &dyn Fn(Source) -> bool) {
        self.loaded = LoadedInputs::Stale;
        let same_section = same(Source::Section);
        self.stale |= !same_section;
        let same_limit = same(Source::Limit);
        self.calculated.carry_over(new, same_section && same_limit);
        self.release_pending = true;
    }

    fn prepared(
        &mut self,
        resources: &Resources,
        memory: &mut Memory,
    ) -> Result<&mut dyn Differentiable> {
        if self.stale {
            self.stepper = stepper(resources, &self.aerodynamics, &memory.values)?;
            self.stale = false;
            self.tested_winds = tested_winds(&self.stepper, resources);
            self.damping = PresentDamping::default();
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

    /// Says also, once for each set of parameters, where the section grows although nothing was tested there.
    fn watch(&mut self, resources: &Resources, memory: &Memory, notices: &mut Vec<String>) {
        if self.trust_changes(memory) {
            self.watch_trust(memory, notices);
        }
        if !self.growth_known && self.growth_searches_left > 0 {
            self.watch_growth(resources, memory, notices);
        }
    }

    fn repeat(&mut self, memory: &mut Memory, step: f64) -> Option<bool> {
        let LoadedInputs::Repeatable(last) = &self.loaded else {
            return None;
        };
        let (stepper, system) = (&mut self.stepper, &mut memory.system);
        let taken = last.step_s == step && stepper.repeat(system, &self.inputs, last.columns);
        taken.then(|| self.rotation_news(memory))
    }

    fn repeat_outputs(&mut self, memory: &mut Memory) -> bool {
        let LoadedInputs::Repeatable(last) = &self.loaded else {
            return false;
        };
        let found = self
            .stepper
            .repeat_outputs(&memory.system, &self.inputs, last.columns);
        if !found.iter().all(|x| x.is_finite()) {
            return false;
        }
        let (accelerations, forces) = found.split_at(self.responses.len());
        let each = self.responses.iter().zip(accelerations.iter().zip(forces));
        for (places, (acceleration, force)) in each {
            memory.values[places[2]] = *acceleration;
            memory.values[places[3]] = *force;
        }
        true
    }

    fn held_output(&self, place: usize) -> Option<usize> {
        self.places.state_entry[place]
    }
}

impl Prepared for SectionUnit {
    fn advance(&mut self, _: &Resources, memory: &mut Memory, step: f64) -> CallResult<bool> {
        self.load_own_inputs(memory);
        let stepper = &mut self.stepper;
        stepper.advance(&mut memory.system, &self.inputs, step)?;
        if !matches!(self.loaded, LoadedInputs::Stale) {
            let repeatable = stepper.repeatable(&memory.system, &self.inputs, step);
            self.loaded = repeatable.map_or(LoadedInputs::Current, LoadedInputs::Repeatable);
        }
        Ok(false)
    }

    fn state_rates(&mut self, memory: &Memory, rates: &mut [f64]) -> CallResult<()> {
        self.load_inputs(memory);
        let stepper = &mut self.stepper;
        stepper.write_derivative(&memory.system, &self.inputs, rates)?;
        finite(rates)
    }

    fn outputs(&mut self, _: &Resources, memory: &mut Memory) -> CallResult<()> {
        self.load_own_inputs(memory);
        let (stepper, inputs) = (&mut self.stepper, &self.inputs);
        stepper.outputs(&memory.system, inputs, &mut self.outputs)?;
        check_finite(&self.outputs)?;
        let Outputs {
            acceleration,
            self_excited_force,
            ..
        } = &self.outputs;
        for (i, places) in self.responses.iter().enumerate() {
            memory.values[places[2]] = acceleration[i];
            memory.values[places[3]] = self_excited_force[i];
        }
        Ok(())
    }

    /// Onset and divergence. A search that fails is no reason to end a run.
    fn calculate(&mut self, resources: &Resources, memory: &mut Memory, notices: &mut Vec<String>) {
        if self.calculated.are_known() {
            return;
        }
        let card = self.onset_card(resources, &memory.values);
        self.calculated.enter(card, memory, notices);
    }
}

impl CoupledUnit for SectionUnit {
    fn places(&self) -> &CoupledPlaces {
        &self.places
    }

    fn onset(&self) -> OnsetNumbers {
        self.calculated.onset()
    }

    fn parts(&mut self) -> (&mut Stepper, &mut Inputs) {
        (&mut self.stepper, &mut self.inputs)
    }

    fn section(&self) -> &CoupledSection {
        self.stepper.section()
    }

    fn load_inputs(&mut self, memory: &Memory) {
        self.loaded = LoadedInputs::Stale;
        let (inputs, rates) = (&mut self.inputs, &memory.input_rates);
        inputs.wind_speed_m_s = self.places.wind_speed(memory);
        inputs.wind_speed_rate_m_s2 = rates[0];
        for (i, place) in self.places.forces().iter().enumerate() {
            inputs.force[i] = memory.values[*place];
            inputs.force_rate[i] = rates[i + 1];
        }
        let of_gusts = &rates[self.places.first_gust..];
        for (i, place) in self.places.gusts().iter().enumerate() {
            inputs.gust_m_s[i] = memory.values[*place];
            inputs.gust_rate_m_s2[i] = of_gusts[i];
        }
    }

    fn release(&self, values: &[f64]) -> Result<SectionState> {
        let initial: Vec<f64> = self.places.initial.iter().map(|i| values[*i]).collect();
        let (displacements, rates) = initial.split_at(self.responses.len());
        let mut state = self.stepper.released(displacements, rates)?;
        blow_until_release(&mut state, &self.inputs.gust_m_s);
        Ok(state)
    }

    fn pick(&self, instant: &SectionValues, role: Role) -> f64 {
        instant.pick(role)
    }

    fn turn(&self, _: &SectionState, outputs: &Outputs) -> f64 {
        outputs.displacement.last().copied().unwrap_or(0.0)
    }

    fn rotation(&self, memory: &Memory) -> f64 {
        memory.system.values[self.responses.len() - 1]
    }

    fn damping_at(&mut self, wind: f64) -> Result<f64> {
        self.damping.at(&mut self.stepper, wind)
    }

    fn wind_is_tested(&mut self, _: &Resources, memory: &mut Memory, _: &mut Vec<String>) -> bool {
        self.in_tested_winds(memory)
    }

    fn searched(&self, resources: &Resources, memory: &Memory) -> OnsetNumbers {
        self.onset_card(resources, &memory.values).numbers
    }

    fn with_parameters(
        &mut self,
        resources: &Resources,
        other: &Memory,
        result: &mut dyn FnMut(&mut Self) -> Result<Vec<f64>>,
    ) -> Result<Vec<f64>> {
        let of_other = stepper(resources, &self.aerodynamics, &other.values)?;
        let present = std::mem::replace(&mut self.stepper, of_other);
        let found = result(self);
        self.stepper = present;
        found
    }
}

/// With the parameters in `values`.
fn stepper(resources: &Resources, forces: &Realization, values: &[f64]) -> Result<Stepper> {
    let section = section::coupled_section(&resources.model, &resources.table, forces, values)?;
    Ok(Stepper::in_gusts(section, resources.gusts.as_ref()))
}
