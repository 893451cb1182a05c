//! What a section and a bridge share: a structure coupled with its self-excited forces, and numbers of its present moment.

use super::memory::Memory;
use super::sensitivity::SectionValues;
use super::unit::Prepared;
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::flutter::smallest_damping;
use crate::resources::Resources;
use crate::response::{Inputs, Outputs, SectionState, Stepper};
use crate::variables::{ComputedNumber, Known, OnsetNumbers, Present, Role};

/// Relative step of a difference over the wind speed.
const WIND_STEP: f64 = 1e-5;

/// Derivative of the smallest damping ratio with respect to the wind speed, per m/s.
fn damping_slope(section: &CoupledSection, wind: f64) -> Result<f64> {
    let step = WIND_STEP * wind.max(1.0);
    let low = (wind - step).max(0.0);
    let rise = smallest_damping(section, wind + step)? - smallest_damping(section, low)?;
    Ok(rise / (wind + step - low))
}

/// How the present changes with what is asked for.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct PresentSlopes {
    pub wind: f64,
    pub rotation: f64,
    /// Of the upper end of the search for the onset.
    pub limit: f64,
}

/// Places in the table.
#[derive(Debug)]
pub(super) struct CoupledPlaces {
    /// Wind speed, then forces, then gusts: the inputs.
    pub inputs: Vec<usize>,
    /// Where the gusts begin among them.
    pub first_gust: usize,
    /// Displacements at release, then rates where they can be set.
    pub initial: Vec<usize>,
    /// Upper end of the search for the onset.
    pub limit: usize,
    /// Factor on the turbulence of the archive.
    pub turbulence_factor: Option<usize>,
    /// Entry of the state that a variable is; by place.
    pub state_entry: Vec<Option<usize>>,
}

impl CoupledPlaces {
    pub(super) fn wind_speed(&self, memory: &Memory) -> f64 {
        memory.values[self.inputs[0]]
    }

    pub(super) fn limit(&self, memory: &Memory) -> f64 {
        memory.values[self.limit]
    }

    pub(super) fn forces(&self) -> &[usize] {
        &self.inputs[1..self.first_gust]
    }

    pub(super) fn gusts(&self) -> &[usize] {
        &self.inputs[self.first_gust..]
    }
}

/// Gusts have blown as they do now until the release: `gusts` for every group of lags.
pub(super) fn blow_until_release(state: &mut SectionState, gusts: &[f64]) {
    let lags = state.gusts.len() / gusts.len().max(1);
    for (lagging, gust) in state.gusts.chunks_mut(lags.max(1)).zip(gusts) {
        lagging.fill(*gust);
    }
}

/// See the module.
pub(super) trait CoupledUnit: Prepared {
    fn places(&self) -> &CoupledPlaces;

    /// Onset and divergence as they were calculated last.
    fn onset(&self) -> OnsetNumbers;

    /// What steps it, and the inputs that are loaded.
    fn parts(&mut self) -> (&mut Stepper, &mut Inputs);

    fn section(&self) -> &CoupledSection;

    /// Loads the inputs of a memory.
    fn load_inputs(&mut self, memory: &Memory);

    /// State at release with the initial values in `values` and the gusts that are loaded.
    fn release(&self, values: &[f64]) -> Result<SectionState>;

    /// What a variable that is no computed number stands for.
    fn pick(&self, instant: &SectionValues, role: Role) -> f64;

    /// Of outputs of the coordinates, or their derivatives, the rotation that is greatest in `state`, rad.
    fn turn(&self, state: &SectionState, outputs: &Outputs) -> f64;

    /// Greatest rotation, rad.
    fn rotation(&self, memory: &Memory) -> f64;

    /// Smallest damping ratio at a wind speed, m/s.
    fn damping_at(&mut self, wind: f64) -> Result<f64>;

    fn wind_is_tested(
        &mut self,
        resources: &Resources,
        memory: &mut Memory,
        notices: &mut Vec<String>,
    ) -> bool;

    /// Onset and divergence for the parameters that it has been made with, by a search.
    fn searched(&self, resources: &Resources, memory: &Memory) -> OnsetNumbers;

    /// `result` with the parameters of another memory.
    fn with_parameters(
        &mut self,
        resources: &Resources,
        other: &Memory,
        result: &mut dyn FnMut(&mut Self) -> Result<Vec<f64>>,
    ) -> Result<Vec<f64>>;

    /// All that there is in a state, with the inputs that are loaded.
    fn instant(&mut self, state: &SectionState) -> Result<SectionValues> {
        let (stepper, inputs) = self.parts();
        SectionValues::of(stepper, state, inputs)
    }

    /// What a number reads of the present.
    fn read(
        &mut self,
        resources: &Resources,
        memory: &mut Memory,
        number: &ComputedNumber,
        notices: &mut Vec<String>,
    ) -> Present {
        let wind = self.places().wind_speed(memory);
        let mut present = Present {
            wind_m_s: wind.into(),
            ..Present::default()
        };
        for known in number.reads {
            match known {
                Known::Onset => {
                    self.calculate(resources, memory, notices);
                    present.onset = self.onset();
                }
                Known::Wind => {}
                Known::Damping => present.damping_ratio = self.damping(wind, notices).into(),
                Known::TestedWind => {
                    present.wind_is_tested = self.wind_is_tested(resources, memory, notices);
                }
                Known::Rotation => present.rotation_rad = self.rotation(memory).into(),
            }
        }
        present
    }

    /// Smallest damping ratio; 0, with the reason, where it is not known.
    fn damping(&mut self, wind: f64, notices: &mut Vec<String>) -> f64 {
        self.damping_at(wind).unwrap_or_else(|why| {
            notices.push(format!("damping_now is not known: {why}"));
            0.0
        })
    }

    /// Derivative of such a number.
    fn slope(
        &mut self,
        resources: &Resources,
        memory: &mut Memory,
        number: &ComputedNumber,
        by: PresentSlopes,
        notices: &mut Vec<String>,
    ) -> Result<f64> {
        if number.is_flag() {
            return Ok(0.0);
        }
        let mut present = self.read(resources, memory, number, notices);
        present.wind_m_s.slope = by.wind;
        present.rotation_rad.slope = by.rotation;
        present.onset.follow_limit(by.limit);
        if by.wind != 0.0 && number.reads(Known::Damping) {
            let wind = self.places().wind_speed(memory);
            present.damping_ratio.slope = by.wind * damping_slope(self.section(), wind)?;
        }
        Ok(number.of(&present).slope)
    }

    /// The unknowns of what is released with the values in `memory`, with the parameters that it has been made with.
    fn unknowns(
        &mut self,
        resources: &Resources,
        memory: &Memory,
        unknowns: &[Role],
    ) -> Result<Vec<f64>> {
        self.load_inputs(memory);
        let state = self.release(&memory.values)?;
        let instant = self.instant(&state)?;
        let wind = self.places().wind_speed(memory);
        let mut present = Present {
            wind_m_s: wind.into(),
            rotation_rad: self.turn(&state, &instant.outputs).into(),
            ..Present::default()
        };
        let read = |known: Known| {
            unknowns
                .iter()
                .any(|u| matches!(u, Role::Computed(n) if !n.is_flag() && n.reads(known)))
        };
        if read(Known::Onset) {
            present.onset = self.searched(resources, memory);
        }
        if read(Known::Damping) {
            present.damping_ratio = smallest_damping(self.section(), wind)?.into();
        }
        let value = |unknown: &Role| match unknown {
            // flags have no derivative
            Role::Computed(number) if number.is_flag() => 0.0,
            Role::Computed(number) => number.of(&present).value,
            other => self.pick(&instant, *other),
        };
        Ok(unknowns.iter().map(value).collect())
    }
}
