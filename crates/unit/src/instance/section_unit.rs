//! The coupled section: a structure in self-excited wind forces. Onset and divergence are searched for when first asked
//! for after a change of parameters.

use super::coupled::{Built, Coupled, CoupledKind};
use super::damping::PresentDamping;
use super::layout::index_of;
use super::memory::{Memory, Now};
use super::section::{self, OnsetCard};
use crate::aerodynamics::{Realizable, Realization};
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::flutter::UnwantedGrowth;
use crate::resources::Resources;
use crate::response::{Outputs, SectionState, Stepper};
use crate::section::{Dof, SectionModel};
use crate::units::{ReducedFrequencyGap, ReducedFrequencyRange};
use crate::variables::{Response, Role, VariableTable};
use std::sync::OnceLock;

/// Searches for growth of one instance at most: one takes as long as some thousand steps, and an importer may change
/// parameters at every communication point.
const GROWTH_SEARCHES: usize = 32;

/// Displacement, rate, acceleration and self-excited force of each degree of freedom.
type ResponseIndices = Vec<[usize; 4]>;

/// A suspended section: its forces, and what has been looked for and said with the parameters as they are.
#[derive(Debug)]
pub(super) struct SuspendedSection {
    responses: ResponseIndices,
    aerodynamics: Realization,
    /// Why damping is not known in wind slower than every test, once it has been asked.
    slow_wind: OnceLock<Option<&'static str>>,
    /// Whether growth below the onset has been looked for with the current parameters.
    growth_known: bool,
    /// Searches for growth that this instance may still do.
    growth_searches_left: usize,
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
            slow_wind: OnceLock::new(),
            growth_known: false,
            growth_searches_left: GROWTH_SEARCHES,
        };
        let mut unit = Self::new(own, resources)?;
        let gusts = unit.indices.gusts().len();
        unit.inputs.gust_m_s = vec![0.0; gusts];
        unit.inputs.gust_rate_m_s2 = vec![0.0; gusts];
        Ok(unit)
    }

    /// Growth below the onset for the parameters in `values`.
    fn growth(&self, resources: &Resources, values: &[f64]) -> Result<UnwantedGrowth> {
        let (model, limit) = (&resources.model, values[self.indices.limit]);
        let (section, coupled) = self.own.coupled(resources, values)?;
        match section::plainly_stable_to(model, &section, &coupled, limit) {
            Some(scanned_to_m_s) => Ok(UnwantedGrowth {
                scanned_to_m_s,
                ..UnwantedGrowth::default()
            }),
            None => section::growth_of(model, &coupled, limit),
        }
    }

    #[cold]
    fn watch_growth(&mut self, now: &mut Now) {
        let notices = &mut now.notices;
        self.own.growth_known = true;
        self.own.growth_searches_left -= 1;
        match self.growth(&now.resources, &now.memory.values) {
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

impl SuspendedSection {
    /// The section of the parameters in `values`, by itself and coupled with its forces.
    fn coupled(
        &self,
        resources: &Resources,
        values: &[f64],
    ) -> Result<(SectionModel, CoupledSection)> {
        let section = section::section_model(&resources.model, &resources.table, values);
        let coupled = CoupledSection::new(section.structure()?, self.aerodynamics.clone())?;
        Ok((section, coupled))
    }
}

impl CoupledKind for SuspendedSection {
    type Own = TestedWinds;

    const TESTED_AT: &'static str = "this section was tested at its frequencies in still air";

    fn build(&self, resources: &Resources, values: &[f64]) -> Result<Built<Self::Own>> {
        let (_, coupled) = self.coupled(resources, values)?;
        let stepper = Stepper::in_gusts(coupled, resources.gusts.as_ref());
        Ok(Built {
            own: TestedWinds::new(&stepper, resources.model.tested_range),
            stepper,
            damping: PresentDamping::default(),
        })
    }

    fn parameters_changed(&mut self) {
        self.growth_known = false;
    }

    fn load_inputs(unit: &mut SectionUnit, memory: &Memory) {
        unit.inputs_stay = false;
        let (inputs, indices) = (&mut unit.inputs, &unit.indices);
        let mut each = indices.inputs.iter().zip(&memory.input_rates);
        let mut load = |value: &mut f64, rate: &mut f64| {
            if let Some((index, given)) = each.next() {
                (*value, *rate) = (memory.values[*index], *given);
            }
        };
        load(&mut inputs.wind_speed_m_s, &mut inputs.wind_speed_rate_m_s2);
        for (force, rate) in inputs.force.iter_mut().zip(&mut inputs.force_rate) {
            load(force, rate);
        }
        for (gust, rate) in inputs.gust_m_s.iter_mut().zip(&mut inputs.gust_rate_m_s2) {
            load(gust, rate);
        }
    }

    fn motion_at_release(unit: &SectionUnit, values: &[f64]) -> [Vec<f64>; 2] {
        let initial: Vec<f64> = unit.indices.initial.iter().map(|i| values[*i]).collect();
        let (displacements, rates) = initial.split_at(unit.own.responses.len());
        [displacements.to_vec(), rates.to_vec()]
    }

    fn pick(unit: &SectionUnit, outputs: &Outputs, role: Role) -> f64 {
        let Role::Response(response, dof) = role else {
            return 0.0;
        };
        let mut dofs = unit.section().structure().dofs.iter();
        let row = dofs.position(|d| *d == dof);
        row.map_or(0.0, |row| outputs.lists()[response as usize][row])
    }

    fn motion(
        unit: &SectionUnit,
        _: &SectionState,
        outputs: &Outputs,
        response: Response,
        dof: Dof,
    ) -> f64 {
        Self::pick(unit, outputs, Role::Response(response, dof))
    }

    fn rotation(unit: &SectionUnit, memory: &Memory) -> f64 {
        memory.system.values[unit.own.responses.len() - 1]
    }

    #[inline]
    fn tested_winds(unit: &SectionUnit) -> Option<[f64; 2]> {
        unit.built.own.between
    }

    #[inline]
    fn untested_gap(unit: &SectionUnit, wind: f64) -> Option<[f64; 2]> {
        let mut gaps = unit.built.own.gaps.iter();
        gaps.find(|[from, to]| *from < wind && wind < *to).copied()
    }

    fn searched(unit: &SectionUnit, resources: &Resources, memory: &Memory) -> OnsetCard {
        let (model, limit) = (&resources.model, memory.values[unit.indices.limit]);
        match unit.own.coupled(resources, &memory.values) {
            Ok((section, coupled)) => {
                let plain = section::plain_onset(model, &section, &coupled, limit);
                let slow_wind = || section::slow_wind(model);
                let slow_wind = *unit.own.slow_wind.get_or_init(slow_wind);
                OnsetCard::search(model, &coupled, limit, plain, slow_wind)
            }
            Err(why) => OnsetCard::unknown(&why),
        }
    }

    /// Says also, once for each set of parameters, where the section grows although nothing was tested there.
    fn watch(unit: &mut SectionUnit, now: &mut Now) {
        if !unit.own.growth_known && unit.own.growth_searches_left > 0 {
            unit.watch_growth(now);
        }
    }

    #[inline]
    fn repeat_outputs(unit: &mut SectionUnit, memory: &mut Memory) -> bool {
        let stepper = &mut unit.built.stepper;
        let found = match unit.inputs_stay {
            true => stepper.repeat_outputs(&memory.system, &unit.inputs),
            false => None,
        };
        let Some(found) = found.filter(|all| all.iter().all(|x| x.is_finite())) else {
            return false;
        };
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

/// Wind speeds, m/s, at which a section was tested, by its motions at their frequencies in still air.
#[derive(Debug, Clone)]
pub(super) struct TestedWinds {
    /// From the lowest to the highest at which every motion lies between the lowest and the highest test; `None` where there are none.
    between: Option<[f64; 2]>,
    /// Those at which a motion lies far from every test.
    gaps: Vec<[f64; 2]>,
}

impl TestedWinds {
    fn new(stepper: &Stepper, range: ReducedFrequencyRange) -> Self {
        let s = stepper.section().structure();
        let all: Vec<f64> = s.still_air_rad_s().collect();
        let (slowest, fastest) = all
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(a, b), w| (a.min(*w), b.max(*w)));
        let low = fastest * s.width_m / range.max.full_width();
        let high = slowest * s.width_m / range.min.full_width();
        let gaps = range.gaps().filter_map(ReducedFrequencyGap::unknown);
        Self {
            between: (low <= high).then_some([low, high]),
            gaps: gaps
                .flat_map(|gap| all.iter().map(move |w| (w * s.width_m, gap)))
                .map(|(speed, (from, to))| [speed / to, speed / from])
                .collect(),
        }
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
