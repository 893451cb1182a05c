//! The coupled section: a structure in self-excited wind forces. Onset and divergence are searched for when first asked
//! for after a change of parameters.

use super::coupled::{Coupled, CoupledKind};
use super::damping::PresentDamping;
use super::layout::index_of;
use super::memory::Memory;
use super::section::{self, OnsetCard};
use super::sensitivity::SectionValues;
use super::trust::tested_winds;
use crate::aerodynamics::{Realizable, Realization};
use crate::error::Result;
use crate::flutter::UnwantedGrowth;
use crate::resources::Resources;
use crate::response::{Outputs, RepeatableStep, SectionState, Stepper};
use crate::section::Dof;
use crate::variables::{Response, Role, VariableTable};

/// Searches for growth of one instance at most: one takes as long as some thousand steps, and an importer may change
/// parameters at every communication point.
const GROWTH_SEARCHES: usize = 32;

/// Displacement, rate, acceleration and self-excited force of each degree of freedom.
type ResponseIndices = Vec<[usize; 4]>;

/// Whether the loaded inputs are those of the memory, and whether a step can be repeated with them.
#[derive(Debug, Clone, Copy)]
enum LoadedInputs {
    /// Those of the memory may be others.
    Stale,
    /// They are those of the memory.
    Current,
    /// And a step has been taken with them that may be taken again.
    Repeatable(RepeatableStep),
}

/// A suspended section: its forces, and what has been looked for and said with the parameters as they are.
#[derive(Debug)]
pub(super) struct SuspendedSection {
    responses: ResponseIndices,
    aerodynamics: Realization,
    /// Whether growth below the onset has been looked for with the current parameters.
    growth_known: bool,
    /// Searches for growth that this instance may still do.
    growth_searches_left: usize,
    /// Whether the wind was in the tested range after the last step.
    pub wind_was_tested: bool,
    /// What has been said since the initialisation: a gust may cross a limit at every step.
    pub wind_left: bool,
    pub rotation_left: bool,
    loaded: LoadedInputs,
}

/// What follows from the parameters of a section.
#[derive(Debug)]
pub(super) struct BuiltSection {
    stepper: Stepper,
    damping: PresentDamping,
    /// Wind speeds (m/s) at which it was tested, see [`tested_winds`].
    pub tested_winds: Option<[f64; 2]>,
}

pub(super) type SectionUnit = Coupled<SuspendedSection>;

impl SectionUnit {
    /// The section of a trained model.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for a model without a realisation, or whose section cannot be coupled with it.
    pub(super) fn of_section(resources: &Resources) -> Result<Self> {
        let responses = response_indices(&resources.table)?;
        let own = SuspendedSection {
            responses,
            aerodynamics: resources.model.model.realize(),
            growth_known: false,
            growth_searches_left: GROWTH_SEARCHES,
            wind_was_tested: false,
            wind_left: false,
            rotation_left: false,
            loaded: LoadedInputs::Stale,
        };
        let mut unit = Self::new(own, resources)?;
        let gusts = unit.indices.gusts().len();
        unit.inputs.gust_m_s = vec![0.0; gusts];
        unit.inputs.gust_rate_m_s2 = vec![0.0; gusts];
        Ok(unit)
    }

    /// Growth below the onset for the parameters in `values`.
    fn growth(&self, resources: &Resources, values: &[f64]) -> Result<UnwantedGrowth> {
        let Resources { model, table, .. } = resources;
        let limit = values[self.indices.limit];
        let section = section::coupled_section(model, table, &self.own.aerodynamics, values)?;
        let forces = &self.own.aerodynamics;
        if let Some(speed) = section::plainly_stable_to(model, table, forces, values, limit) {
            return Ok(UnwantedGrowth::none_up_to(speed));
        }
        section::growth_of(model, &section, limit)
    }

    #[cold]
    fn watch_growth(&mut self, resources: &Resources, memory: &Memory, notices: &mut Vec<String>) {
        self.own.growth_known = true;
        self.own.growth_searches_left -= 1;
        match self.growth(resources, &memory.values) {
            Ok(growth) if growth.is_none() => {}
            Ok(growth) => notices.push(format!(
                "with these parameters the section {}",
                growth.explain()
            )),
            // no reason to end a run
            Err(e) => notices.push(format!("growth below the onset could not be judged: {e}")),
        }
        if self.own.growth_searches_left == 0 {
            notices.push(format!(
                "growth below the onset is no longer looked for after {GROWTH_SEARCHES} changes of parameters"
            ));
        }
    }
}

impl CoupledKind for SuspendedSection {
    type Built = BuiltSection;

    fn build(&self, resources: &Resources, values: &[f64]) -> Result<BuiltSection> {
        let Resources {
            model,
            table,
            gusts,
            ..
        } = resources;
        let section = section::coupled_section(model, table, &self.aerodynamics, values)?;
        let stepper = Stepper::in_gusts(section, gusts.as_ref());
        Ok(BuiltSection {
            tested_winds: tested_winds(&stepper, resources),
            stepper,
            damping: PresentDamping::default(),
        })
    }

    fn stepper(built: &BuiltSection) -> &Stepper {
        &built.stepper
    }

    fn parts(built: &mut BuiltSection) -> (&mut Stepper, &mut PresentDamping) {
        (&mut built.stepper, &mut built.damping)
    }

    fn parameters_changed(&mut self) {
        self.growth_known = false;
    }

    fn inputs_changed(&mut self) {
        self.loaded = LoadedInputs::Stale;
    }

    fn forget_warnings(&mut self) {
        (self.wind_was_tested, self.wind_left) = (false, false);
        self.rotation_left = false;
    }

    fn load_inputs(unit: &mut SectionUnit, memory: &Memory) {
        unit.own.loaded = LoadedInputs::Stale;
        let (inputs, rates) = (&mut unit.inputs, &memory.input_rates);
        inputs.wind_speed_m_s = unit.indices.wind_speed(memory);
        inputs.wind_speed_rate_m_s2 = rates[0];
        for (i, index) in unit.indices.forces().iter().enumerate() {
            inputs.force[i] = memory.values[*index];
            inputs.force_rate[i] = rates[i + 1];
        }
        let of_gusts = &rates[unit.indices.first_gust..];
        for (i, index) in unit.indices.gusts().iter().enumerate() {
            inputs.gust_m_s[i] = memory.values[*index];
            inputs.gust_rate_m_s2[i] = of_gusts[i];
        }
    }

    /// They are loaded once until one is set.
    fn load_own_inputs(unit: &mut SectionUnit, memory: &Memory) {
        if matches!(unit.own.loaded, LoadedInputs::Stale) {
            Self::load_inputs(unit, memory);
            // with a rate, a step carries them on
            if memory.input_rates.iter().all(|rate| *rate == 0.0) {
                unit.own.loaded = LoadedInputs::Current;
            }
        }
    }

    fn motion_at_release(unit: &SectionUnit, values: &[f64]) -> [Vec<f64>; 2] {
        let initial: Vec<f64> = unit.indices.initial.iter().map(|i| values[*i]).collect();
        let (displacements, rates) = initial.split_at(unit.own.responses.len());
        [displacements.to_vec(), rates.to_vec()]
    }

    fn pick(_: &SectionUnit, instant: &SectionValues, role: Role) -> f64 {
        instant.pick(role)
    }

    fn motion(
        unit: &SectionUnit,
        _: &SectionState,
        outputs: &Outputs,
        response: Response,
        dof: Dof,
    ) -> f64 {
        let mut dofs = unit.built.stepper.section().structure().dofs.iter();
        let row = dofs.position(|d| *d == dof);
        row.map_or(0.0, |row| outputs.lists()[response as usize][row])
    }

    fn rotation(unit: &SectionUnit, memory: &Memory) -> f64 {
        memory.system.values[unit.own.responses.len() - 1]
    }

    fn wind_is_tested(
        unit: &mut SectionUnit,
        _: &Resources,
        memory: &mut Memory,
        _: &mut Vec<String>,
    ) -> bool {
        unit.in_tested_winds(memory)
    }

    fn searched(unit: &SectionUnit, resources: &Resources, memory: &Memory) -> OnsetCard {
        let Resources { model, table, .. } = resources;
        let (values, forces) = (&memory.values, &unit.own.aerodynamics);
        let limit = unit.indices.limit(memory);
        match section::coupled_section(model, table, forces, values) {
            Ok(section) => {
                let plain = section::plain_onset(model, table, forces, values, limit);
                OnsetCard::search(model, &section, limit, plain)
            }
            Err(why) => OnsetCard::unknown(&why),
        }
    }

    /// Says also, once for each set of parameters, where the section grows although nothing was tested there.
    fn watch(
        unit: &mut SectionUnit,
        resources: &Resources,
        memory: &Memory,
        notices: &mut Vec<String>,
    ) {
        if unit.trust_changes(memory) {
            unit.watch_trust(memory, notices);
        }
        if !unit.own.growth_known && unit.own.growth_searches_left > 0 {
            unit.watch_growth(resources, memory, notices);
        }
    }

    fn advance(unit: &mut SectionUnit, memory: &mut Memory, step: f64) -> Result<()> {
        Self::load_own_inputs(unit, memory);
        let (stepper, inputs) = (&mut unit.built.stepper, &unit.inputs);
        stepper.advance(&mut memory.system, inputs, step)?;
        if !matches!(unit.own.loaded, LoadedInputs::Stale) {
            let repeatable = stepper.repeatable(&memory.system, inputs, step);
            unit.own.loaded = repeatable.map_or(LoadedInputs::Current, LoadedInputs::Repeatable);
        }
        Ok(())
    }

    #[inline]
    fn repeat(unit: &mut SectionUnit, memory: &mut Memory, step: f64) -> Option<bool> {
        let LoadedInputs::Repeatable(last) = &unit.own.loaded else {
            return None;
        };
        let (stepper, system) = (&mut unit.built.stepper, &mut memory.system);
        let taken = last.step_s == step && stepper.repeat(system, &unit.inputs, last.columns);
        taken.then(|| unit.rotation_news(memory))
    }

    #[inline]
    fn repeat_outputs(unit: &mut SectionUnit, memory: &mut Memory) -> bool {
        let LoadedInputs::Repeatable(last) = &unit.own.loaded else {
            return false;
        };
        let stepper = &mut unit.built.stepper;
        let found = stepper.repeat_outputs(&memory.system, &unit.inputs, last.columns);
        if !found.iter().all(|x| x.is_finite()) {
            return false;
        }
        let (accelerations, forces) = found.split_at(unit.own.responses.len());
        write(&unit.own.responses, accelerations, forces, memory);
        true
    }

    fn write_outputs(unit: &SectionUnit, memory: &mut Memory) {
        let Outputs {
            acceleration,
            self_excited_force,
            ..
        } = &unit.outputs;
        write(
            &unit.own.responses,
            acceleration,
            self_excited_force,
            memory,
        );
    }
}

fn response_indices(table: &VariableTable) -> Result<ResponseIndices> {
    let dofs = table.dofs().into_iter();
    dofs.map(|dof| {
        let mut indices = [0; 4];
        for (slot, response) in indices.iter_mut().zip(Response::ALL) {
            *slot = index_of(table, Role::Response(response, dof))?;
        }
        Ok(indices)
    })
    .collect()
}

#[inline(always)]
fn write(responses: &ResponseIndices, accelerations: &[f64], forces: &[f64], memory: &mut Memory) {
    let each = responses.iter().zip(accelerations.iter().zip(forces));
    for (indices, (acceleration, force)) in each {
        memory.values[indices[2]] = *acceleration;
        memory.values[indices[3]] = *force;
    }
}
