//! What a section and a bridge share: a structure coupled with its self-excited forces.

use super::calculated::CalculatedNumbers;
use super::coupled_indices::CoupledIndices;
use super::damping::PresentDamping;
use super::layout::Source;
use super::memory::{Memory, Now, starts};
use super::section::OnsetCard;
use super::sensitivity::SectionValues;
use super::trust::{beyond_linear, shown};
use super::unit::{Prepared, Unit};
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::lifecycle::State;
use crate::resources::Resources;
use crate::response::{Inputs, Outputs, SectionState, Stepper};
use crate::section::Dof;
use crate::variables::{LINEAR_ROTATION_RAD, Response, Role};
use std::cmp::Ordering;
use std::fmt::Debug;

/// Gusts have blown as they do now until the release: `gusts` for every group of lags.
fn blow_until_release(state: &mut SectionState, gusts: &[f64]) {
    let lags = state.gusts.len() / gusts.len().max(1);
    for (lagging, gust) in state.gusts.chunks_mut(lags.max(1)).zip(gusts) {
        lagging.fill(*gust);
    }
}

/// What follows from the parameters.
#[derive(Debug)]
pub(super) struct Built<B> {
    pub stepper: Stepper,
    pub damping: PresentDamping,
    /// What a section or a bridge has beside.
    pub own: B,
}

/// What a section and a bridge do each in their own way.
pub(super) trait CoupledKind: Debug + Send + Sized + 'static {
    /// What it has in [`Built`].
    type Own: Debug + Send;

    /// Of what its [tested winds](Self::tested_winds) are those, in words.
    const TESTED_AT: &'static str;

    /// What follows from the parameters in `values`.
    ///
    /// # Errors
    /// When they give nothing that can be simulated.
    fn build(&self, resources: &Resources, values: &[f64]) -> Result<Built<Self::Own>>;

    /// The parameters have changed, and what was built is replaced.
    fn replaces(_unit: &mut Coupled<Self>) {}

    /// The parameter at `index` was `before`: the motion stays where it is one of the units in which the state counts it; returns whether it
    /// is.
    fn keep_motion(_: &Coupled<Self>, _: &mut Memory, _index: usize, _before: f64) -> bool {
        false
    }

    /// Parameters or the limit of the search have changed.
    fn parameters_changed(&mut self) {}

    /// Loads the inputs of a memory, not necessarily that of the unit.
    fn load_inputs(unit: &mut Coupled<Self>, memory: &Memory);

    /// Displacements and rates of the coordinates at release with the initial values in `values`.
    fn motion_at_release(unit: &Coupled<Self>, values: &[f64]) -> [Vec<f64>; 2];

    /// What a role stands for in outputs of the coordinates; zero for what inputs and release do not act on.
    fn pick(unit: &Coupled<Self>, outputs: &Outputs, role: Role) -> f64;

    /// Of outputs of the coordinates, or their derivatives, what [`Known::Motion`](crate::variables::Known::Motion) stands for in `state`.
    fn motion(
        unit: &Coupled<Self>,
        state: &SectionState,
        outputs: &Outputs,
        response: Response,
        dof: Dof,
    ) -> f64;

    /// Greatest rotation, rad.
    fn rotation(unit: &Coupled<Self>, memory: &Memory) -> f64;

    /// Wind speeds at which it was tested, m/s, without a search; `None` where there are none, or they are not known.
    fn tested_winds(unit: &Coupled<Self>) -> Option<[f64; 2]>;

    /// Between which winds, m/s, around this one a motion is far from every test, although slower and faster ones were tested.
    fn untested_gap(unit: &Coupled<Self>, wind: f64) -> Option<[f64; 2]>;

    fn wind_is_tested(unit: &mut Coupled<Self>, now: &mut Now) -> bool {
        let wind = now.memory.values[unit.indices.wind_speed];
        let between = unit.beside_tests(wind) == Some(Ordering::Equal);
        between && Self::untested_gap(unit, wind).is_none()
    }

    /// Onset and divergence for the parameters that it has been built with, by a search.
    fn searched(unit: &Coupled<Self>, resources: &Resources, memory: &Memory) -> OnsetCard;

    /// The same by the shortest way that is known to be right.
    fn found(unit: &mut Coupled<Self>, resources: &Resources, memory: &Memory) -> OnsetCard {
        Self::searched(unit, resources, memory)
    }

    /// See [`Unit::watch`]; of wind and rotation it is said for both.
    fn watch(_unit: &mut Coupled<Self>, _now: &mut Now) {}

    /// See [`Prepared::advance`], in so many times the turbulence of an archive that has some.
    fn advance_in_turbulence(
        unit: &mut Coupled<Self>,
        memory: &mut Memory,
        step: f64,
        _factor: f64,
    ) -> Result<()> {
        let stepper = &mut unit.built.stepper;
        stepper.advance(&mut memory.system, &unit.inputs, step)
    }

    /// See [`Unit::repeat_outputs`].
    fn repeat_outputs(_unit: &mut Coupled<Self>, _memory: &mut Memory) -> bool {
        false
    }

    /// Writes outputs into the memory.
    fn write_outputs(unit: &Coupled<Self>, memory: &mut Memory);
}

/// A structure coupled with its self-excited forces, rebuilt when parameters change.
#[derive(Debug)]
pub(super) struct Coupled<S: CoupledKind> {
    pub own: S,
    pub indices: CoupledIndices,
    /// Of the parameters as they are.
    pub built: Built<S::Own>,
    /// Whether they have changed since.
    stale: bool,
    /// While initialising: the state has to be made anew from the values at release.
    release_pending: bool,
    /// Whether [`CoupledKind::keep_motion`] has changed the state.
    states_set: bool,
    /// Where the wind was beside the tested range after the last step.
    pub wind_was: Option<Ordering>,
    /// Whether it has been said since the initialisation that it is outside: a gust may cross a limit at every step.
    pub wind_left: bool,
    /// Whether it has been said that it lies in a gap between tests.
    gap_met: bool,
    /// The same of the rotation, which is beyond linear theory.
    rotation_left: bool,
    pub calculated: CalculatedNumbers,
    pub inputs: Inputs,
    /// Whether they are those of the memory, until one is set.
    pub inputs_stay: bool,
    pub outputs: Outputs,
}

impl<S: CoupledKind> Unit for Coupled<S> {
    fn inputs(&self) -> &[usize] {
        &self.indices.inputs
    }

    fn at_rest(&self) -> SectionState {
        SectionState {
            values: vec![0.0; self.section().states()],
            gusts: vec![0.0; self.built.stepper.gust_states()],
            ..SectionState::default()
        }
    }

    fn value_set(
        &mut self,
        memory: &mut Memory,
        index: usize,
        source: Source,
        before: Option<f64>,
    ) -> bool {
        let changed = before.is_some();
        match source {
            Source::Input | Source::Turbulence => {
                self.inputs_stay &= !changed;
                if memory.state == State::Initialization {
                    // lags stand where the gusts are
                    let is_gust = self.indices.gusts().contains(&index);
                    self.release_pending |= source == Source::Turbulence || is_gust;
                }
            }
            Source::Section if changed => {
                self.parameters_changed();
                let before = before.unwrap_or_default();
                self.states_set |= S::keep_motion(self, memory, index, before);
            }
            Source::Release if changed => self.release_pending = true,
            Source::Limit if changed => {
                self.calculated.card = None;
                self.own.parameters_changed();
            }
            _ => {}
        }
        false
    }

    fn has_set_states(&mut self) -> bool {
        std::mem::take(&mut self.states_set)
    }

    fn begin_initialization(&mut self) {
        (self.wind_was, self.wind_left, self.rotation_left) = (None, false, false);
        self.gap_met = false;
        self.calculated.begin_run();
        self.release_pending = true;
    }

    fn input_rate_set(&mut self, _: &mut Memory, _: usize) {
        self.inputs_stay = false;
    }

    fn replace(&mut self, new: &mut Memory, [same_system, same_limit]: [bool; 2]) {
        self.inputs_stay = false;
        self.stale |= !same_system;
        let same = same_system && same_limit;
        self.calculated.carry_over(new, same);
        self.release_pending = true;
    }

    fn prepared(
        &mut self,
        resources: &Resources,
        memory: &mut Memory,
    ) -> Result<&mut dyn Prepared> {
        if self.stale {
            let built = self.own.build(resources, &memory.values)?;
            S::replaces(self);
            self.built = built;
            self.stale = false;
        }
        if self.release_pending && memory.state == State::Initialization {
            S::load_inputs(self, memory);
            memory.system = self.release(&memory.values)?;
            self.release_pending = false;
        }
        Ok(self)
    }

    fn calculated(&mut self) -> Option<&mut CalculatedNumbers> {
        Some(&mut self.calculated)
    }

    fn watch(&mut self, now: &mut Now) {
        let wind = now.memory.values[self.indices.wind_speed];
        if self.beside_tests(wind) != self.wind_was {
            self.watch_wind(wind, &mut now.notices);
        }
        if !self.gap_met
            && let Some([from, to]) = S::untested_gap(self, wind)
        {
            self.gap_met = true;
            now.notices.push(format!(
                "wind_speed = {} m/s is in a gap, {from:.3} to {to:.3} m/s, between the speeds at which {}: the forces are \
                 interpolated over it",
                shown(wind),
                S::TESTED_AT
            ));
        }
        S::watch(self, now);
        let rotation = S::rotation(self, &now.memory);
        if rotation.abs() > LINEAR_ROTATION_RAD && !self.rotation_left {
            self.rotation_left = true;
            now.notices.push(beyond_linear(rotation));
        }
    }

    #[inline]
    fn repeat(&mut self, memory: &mut Memory, step: f64) -> Option<bool> {
        let (stepper, system) = (&mut self.built.stepper, &mut memory.system);
        let taken = self.inputs_stay && stepper.repeat(system, &self.inputs, step);
        taken.then(|| !self.rotation_left && S::rotation(self, memory).abs() > LINEAR_ROTATION_RAD)
    }

    fn repeat_outputs(&mut self, memory: &mut Memory) -> bool {
        S::repeat_outputs(self, memory)
    }

    fn state_index(&self, index: usize) -> Option<usize> {
        self.indices.state_entry[index]
    }
}

impl<S: CoupledKind> Coupled<S> {
    pub(super) fn new(own: S, resources: &Resources) -> Result<Self> {
        let table = &resources.table;
        let built = own.build(resources, &starts(table))?;
        let coordinates = built.stepper.section().structure().dofs.len();
        Ok(Self {
            own,
            indices: CoupledIndices::new(table)?,
            built,
            stale: false,
            release_pending: true,
            states_set: false,
            wind_was: None,
            wind_left: false,
            gap_met: false,
            rotation_left: false,
            calculated: CalculatedNumbers::new(table),
            inputs: Inputs::steady(0.0, coordinates),
            inputs_stay: false,
            outputs: Outputs::default(),
        })
    }

    /// Parameters have changed: all that follows from them.
    pub(super) fn parameters_changed(&mut self) {
        self.stale = true;
        self.inputs_stay = false;
        self.calculated.card = None;
        self.own.parameters_changed();
        self.release_pending = true;
    }

    /// Loads the inputs of the memory of the unit where they may be others; with a rate and in turbulence a step carries them on.
    pub(super) fn load_inputs_once(&mut self, memory: &Memory) {
        if self.inputs_stay {
            return;
        }
        S::load_inputs(self, memory);
        self.built.stepper.forget_step();
        let turbulence = self.indices.turbulence_factor;
        let moves = memory.input_rates.iter().any(|rate| *rate != 0.0)
            || turbulence.is_some_and(|index| memory.values[index] != 0.0);
        self.inputs_stay = !moves;
    }

    pub(super) fn section(&self) -> &CoupledSection {
        self.built.stepper.section()
    }

    /// State at release with the initial values in `values` and the gusts that are loaded.
    pub(super) fn release(&self, values: &[f64]) -> Result<SectionState> {
        let [displacement, rate] = S::motion_at_release(self, values);
        let mut state = self.built.stepper.released(&displacement, &rate)?;
        blow_until_release(&mut state, &self.inputs.gust_m_s);
        Ok(state)
    }

    /// `result` with the parameters of another memory.
    pub(super) fn with_parameters(
        &mut self,
        resources: &Resources,
        other: &Memory,
        result: impl FnOnce(&mut Self) -> Result<Vec<f64>>,
    ) -> Result<Vec<f64>> {
        let of_other = self.own.build(resources, &other.values)?;
        let present = std::mem::replace(&mut self.built, of_other);
        let found = result(self);
        self.built = present;
        found
    }

    /// What a variable that is no computed number stands for.
    pub(super) fn pick(&self, instant: &SectionValues, role: Role) -> f64 {
        let first = self.indices.first_filter;
        match role {
            Role::Filter(i) => instant.of_state(first + i),
            Role::FilterRate(i) => instant.of_rate(first + i),
            other => S::pick(self, &instant.outputs, other),
        }
    }

    /// All that there is in a state, with the inputs that are loaded.
    pub(super) fn instant(&mut self, state: &SectionState) -> Result<SectionValues> {
        SectionValues::new(&mut self.built.stepper, state, &self.inputs)
    }
}
