//! The coupled section: a structure in self-excited wind forces. Onset and divergence are searched for when first asked
//! for after a change of parameters.

use super::damping::PresentDamping;
use super::layout::Source;
use super::memory::Memory;
use super::section::{self, OnsetCard};
use super::section_places::SectionPlaces;
use super::sensitivity::{check_finite, finite};
use super::trust::{MonitoredUnit, TrustWarnings, tested_winds};
use super::unit::{Differentiable, Prepared, Unit};
use crate::aerodynamics::{GustForce, Realizable, Realization};
use crate::error::{Error, Result};
use crate::flutter::UnwantedGrowth;
use crate::lifecycle::State;
use crate::refusal::CallResult;
use crate::resources::Resources;
use crate::response::{Inputs, Outputs, RepeatableStep, SectionState, Stepper};
use crate::variables::Role;

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
    pub places: SectionPlaces,
    inputs_at: Vec<usize>,
    aerodynamics: Realization,
    /// Numbers of the state of the gusts.
    lags: usize,
    /// Stepper of the current parameters; `None` after they have changed.
    pub stepper: Option<Stepper>,
    /// Wind speeds (m/s) at which it was tested, see [`tested_winds`].
    pub tested_winds: Option<[f64; 2]>,
    /// With that stepper.
    pub damping: PresentDamping,
    /// While initialising: the state has to be made anew from the values at release.
    release_pending: bool,
    onset_current: bool,
    /// Whether growth below the onset has been looked for with the current parameters.
    growth_known: bool,
    /// Searches for growth that this instance may still do.
    growth_searches_left: usize,
    pub warned: TrustWarnings,
    pub inputs: Inputs,
    loaded: LoadedInputs,
    outputs: Outputs,
}

impl SectionUnit {
    /// The section of a trained model.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for a model without a realisation.
    pub(super) fn new(resources: &Resources) -> Result<Self> {
        let places = SectionPlaces::new(&resources.table)?;
        let forces = places.force.iter().chain(&places.gusts).copied();
        let inputs = std::iter::once(places.wind_speed).chain(forces);
        Ok(Self {
            inputs_at: inputs.collect(),
            lags: resources.gusts.as_ref().map_or(0, GustForce::states),
            inputs: Inputs {
                gust_m_s: vec![0.0; places.gusts.len()],
                gust_rate_m_s2: vec![0.0; places.gusts.len()],
                ..Inputs::steady(0.0, places.force.len())
            },
            places,
            aerodynamics: resources.model.model.realize(),
            stepper: None,
            tested_winds: None,
            damping: PresentDamping::default(),
            release_pending: true,
            onset_current: false,
            growth_known: false,
            growth_searches_left: GROWTH_SEARCHES,
            warned: TrustWarnings::default(),
            loaded: LoadedInputs::Stale,
            outputs: Outputs::default(),
        })
    }

    pub(super) fn new_stepper(&self, resources: &Resources, values: &[f64]) -> Result<Stepper> {
        let Resources { model, table, .. } = resources;
        let section = section::coupled_section(model, table, &self.aerodynamics, values)?;
        Ok(Stepper::in_gusts(section, resources.gusts.as_ref()))
    }

    /// State at release with the initial values in `values`.
    pub(super) fn release(&self, stepper: &Stepper, values: &[f64]) -> Result<SectionState> {
        let pick = |places: &[usize]| places.iter().map(|i| values[*i]).collect::<Vec<_>>();
        let mut state = stepper.released(
            &pick(&self.places.initial_displacement),
            &pick(&self.places.initial_rate),
        )?;
        // gusts have blown as they do now until the release
        let each = state.gusts.len() / 2;
        for (lagging, place) in state.gusts.chunks_mut(each.max(1)).zip(&self.places.gusts) {
            lagging.fill(values[*place]);
        }
        Ok(state)
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

    /// The inputs of any memory.
    pub(super) fn load_inputs(&mut self, memory: &Memory) {
        self.loaded = LoadedInputs::Stale;
        let (values, rates) = (&memory.values, &memory.input_rates);
        self.inputs.wind_speed_m_s = values[self.places.wind_speed];
        self.inputs.wind_speed_rate_m_s2 = rates[0];
        for (i, place) in self.places.force.iter().enumerate() {
            self.inputs.force[i] = values[*place];
            self.inputs.force_rate[i] = rates[i + 1];
        }
        let behind = 1 + self.places.force.len();
        for (i, place) in self.places.gusts.iter().enumerate() {
            self.inputs.gust_m_s[i] = values[*place];
            self.inputs.gust_rate_m_s2[i] = rates[behind + i];
        }
    }

    /// Growth below the onset for the parameters in `values`.
    fn growth(&self, resources: &Resources, values: &[f64]) -> Result<UnwantedGrowth> {
        let Resources { model, table, .. } = resources;
        let speed_max_m_s = values[self.places.search_limit];
        let section = section::coupled_section(model, table, &self.aerodynamics, values)?;
        let (forces, limit) = (&self.aerodynamics, speed_max_m_s);
        if let Some(speed) = section::plainly_stable_to(model, table, forces, values, limit) {
            return Ok(UnwantedGrowth::none_up_to(speed));
        }
        section::growth_of(model, &section, speed_max_m_s)
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
        let limit = values[self.places.search_limit];
        match section::coupled_section(model, table, &self.aerodynamics, values) {
            Ok(section) => {
                let plain = section::plain_onset(model, table, &self.aerodynamics, values, limit);
                OnsetCard::search(model, &section, limit, plain)
            }
            Err(why) => OnsetCard::unknown(&why),
        }
    }

    fn write(&mut self, card: OnsetCard, memory: &mut Memory, notices: &mut Vec<String>) {
        for (place, which) in &self.places.calculated {
            memory.values[*place] = card.value(*which);
        }
        notices.extend(card.warnings);
        self.onset_current = true;
    }
}

impl Unit for SectionUnit {
    fn inputs(&self) -> &[usize] {
        &self.inputs_at
    }

    fn at_rest(&self) -> SectionState {
        SectionState {
            values: vec![0.0; 2 * self.places.force.len() + self.aerodynamics.states()],
            gusts: vec![0.0; self.lags],
            ..SectionState::default()
        }
    }

    fn changed(&mut self, source: Source) {
        match source {
            Source::Input => self.loaded = LoadedInputs::Stale,
            Source::Section => {
                self.stepper = None;
                self.loaded = LoadedInputs::Stale;
                self.onset_current = false;
                self.growth_known = false;
                self.release_pending = true;
            }
            Source::Release => self.release_pending = true,
            Source::Limit => {
                self.onset_current = false;
                self.growth_known = false;
            }
            _ => {}
        }
    }

    fn input_set(&mut self, memory: &mut Memory, place: usize, _: bool) -> bool {
        if memory.state == State::Initialization && self.places.gusts.contains(&place) {
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

    fn replace(&mut self, new: &mut Memory, old: &Memory, same: &dyn Fn(Source) -> bool) {
        self.loaded = LoadedInputs::Stale;
        let same_section = same(Source::Section);
        if !same_section {
            self.stepper = None;
        }
        let same_limit = same(Source::Limit);
        self.onset_current &= same_section && same_limit;
        self.growth_known &= same_section && same_limit;
        if self.onset_current {
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
        if self.stepper.is_none() {
            let stepper = self.new_stepper(resources, &memory.values)?;
            self.tested_winds = tested_winds(&stepper, resources);
            self.stepper = Some(stepper);
            self.damping = PresentDamping::default();
        }
        if self.release_pending && memory.state == State::Initialization {
            if let Some(stepper) = &self.stepper {
                memory.system = self.release(stepper, &memory.values)?;
            }
            self.release_pending = false;
        }
        Ok(self)
    }

    fn cannot_calculate(&mut self, memory: &mut Memory, why: &Error, notices: &mut Vec<String>) {
        if !self.onset_current {
            self.write(OnsetCard::unknown(why), memory, notices);
        }
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
        let (LoadedInputs::Repeatable(last), Some(stepper)) = (&self.loaded, &mut self.stepper)
        else {
            return None;
        };
        let taken =
            last.step_s == step && stepper.repeat(&mut memory.system, &self.inputs, last.columns);
        taken.then(|| self.rotation_news(memory))
    }

    fn held_output(&self, place: usize) -> Option<usize> {
        self.places.state_entry[place]
    }
}

impl Prepared for SectionUnit {
    fn advance(&mut self, _: &Resources, memory: &mut Memory, step: f64) -> CallResult<bool> {
        self.load_own_inputs(memory);
        if let Some(stepper) = &mut self.stepper {
            stepper.advance(&mut memory.system, &self.inputs, step)?;
            if !matches!(self.loaded, LoadedInputs::Stale) {
                let repeatable = stepper.repeatable(&memory.system, &self.inputs, step);
                self.loaded = repeatable.map_or(LoadedInputs::Current, LoadedInputs::Repeatable);
            }
        }
        Ok(false)
    }

    fn state_rates(&mut self, memory: &Memory, rates: &mut [f64]) -> CallResult<()> {
        self.load_inputs(memory);
        let Some(stepper) = &mut self.stepper else {
            return Ok(());
        };
        stepper.write_derivative(&memory.system, &self.inputs, rates)?;
        finite(rates)
    }

    fn outputs(&mut self, _: &Resources, memory: &mut Memory) -> CallResult<()> {
        self.load_own_inputs(memory);
        if let Some(stepper) = &mut self.stepper {
            stepper.outputs(&memory.system, &self.inputs, &mut self.outputs)?;
        }
        check_finite(&self.outputs)?;
        for (i, places) in self.places.responses.iter().enumerate() {
            for (place, list) in places.iter().zip(self.outputs.lists()) {
                memory.values[*place] = list[i];
            }
        }
        Ok(())
    }

    /// Onset and divergence. A search that fails is no reason to end a run.
    fn calculate(&mut self, resources: &Resources, memory: &mut Memory, notices: &mut Vec<String>) {
        if self.onset_current {
            return;
        }
        let card = self.onset_card(resources, &memory.values);
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
