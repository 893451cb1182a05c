//! The whole bridge: modal coordinates in self-excited wind forces and gusts, seen through some of its nodes.
//!
//! The stepper is that of the section: one exact matrix at constant wind, the Taylor series where the wind changes or gusts
//! blow.

use super::bridge_built::{BuiltBridge, TunedBridge};
use super::bridge_onset::{SearchedOnset, slow_wind};
use super::coupled::{Built, Coupled, CoupledKind};
use super::memory::{Memory, Now};
use super::section::OnsetCard;
use super::unit::Prepared;
use crate::bridge_options::BridgeOptions;
use crate::error::Result;
use crate::onset_start::OnsetStart;
use crate::resources::Resources;
use crate::response::{Outputs, SectionState};
use crate::section::Dof;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use crate::variables::{Response, Role};
use nalgebra::DMatrix;
use std::sync::OnceLock;

/// A bridge in its modes: its variables, and what has been said of the parameters as they are.
#[derive(Debug)]
pub(super) struct ModalBridge {
    /// Motions and modes: indices, and what they stand for.
    responses: Vec<(usize, Role)>,
    tested: Option<ReducedFrequencyRange>,
    /// Reduced frequencies of the tests of each section.
    section_ranges: Vec<ReducedFrequencyRange>,
    /// Why damping is not known in wind slower than every test, once it has been asked.
    slow_wind: OnceLock<Option<&'static str>>,
    /// Root of the generalised mass of each mode.
    roots: Vec<f64>,
    /// Indices of the masses of dampers.
    masses: Vec<usize>,
    /// Onset of the bridge as it was exported, until something follows from it.
    start: Option<OnsetStart>,
    /// From which the onset of other parameters is followed.
    searched: Option<SearchedOnset>,
}

pub(super) type BridgeUnit = Coupled<ModalBridge>;

impl ModalBridge {
    /// See [`slow_wind`].
    fn slow_wind(&self, built: &BuiltBridge) -> Option<&'static str> {
        let ask = || slow_wind(&built.own.bridge, self.tested?, &self.section_ranges);
        *self.slow_wind.get_or_init(ask)
    }
}

impl BridgeUnit {
    /// `K` of flutter in a wind of 1 m/s, as far as its frequency is known.
    fn flutter_k_at_one(&self) -> Option<f64> {
        let onset = self.calculated.onset();
        let start = self.own.start.map(|start| start.frequency_hz);
        let hertz = start.or(onset.found.then_some(onset.frequency_hz.value))?;
        let width = self.built.own.bridge.width_m();
        Some(ReducedFrequency::from_hertz(hertz, width, 1.0).full_width())
    }

    /// The bridge of an export.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for numbers that make no bridge; [`crate::Error::Numerical`] for a table that is not one of a bridge.
    pub(super) fn of_bridge(resources: &Resources, options: &BridgeOptions) -> Result<Self> {
        let table = &resources.table;
        let responses = (0..).zip(table.variables()).filter(|(_, v)| {
            matches!(
                v.role,
                Role::NodeMotion(..) | Role::Mode(..) | Role::Damper(..)
            )
        });
        let roots = options.modes.iter().map(|m| m.generalised_mass.sqrt());
        let masses = (0..).zip(table.variables()).filter(
            |(_, v)| matches!(v.role, Role::DamperParameter(_) if v.quantity == Some("Mass")),
        );
        let own = ModalBridge {
            responses: responses.map(|(index, v)| (index, v.role)).collect(),
            roots: roots.collect(),
            masses: masses.map(|(index, _)| index).collect(),
            tested: options.tested_range,
            section_ranges: options.section_ranges.clone(),
            slow_wind: OnceLock::new(),
            // without a start the first onset is searched for
            start: options.onset,
            searched: None,
        };
        Self::new(own, resources)
    }

    /// Makes the start that came with the archive one to follow, as long as the bridge is the one that was exported.
    fn take_start(&mut self) {
        if let Some(start) = self.own.start.take() {
            self.own.searched = SearchedOnset::from(&self.built, &start).ok();
        }
    }

    /// Loads wind, and forces and gusts on the modes, without the turbulence of the archive.
    fn load_without_turbulence(&mut self, memory: &Memory) {
        let rates = &memory.input_rates;
        self.inputs.wind_speed_m_s = memory.values[self.indices.wind_speed];
        self.inputs.wind_speed_rate_m_s2 = rates[0];
        self.inputs.force.fill(0.0);
        self.inputs.force_rate.fill(0.0);
        for (row, index) in self.indices.forces().iter().enumerate() {
            let (force, rate) = (memory.values[*index], rates[row + 1]);
            if force == 0.0 && rate == 0.0 {
                continue;
            }
            for (m, phi) in self.built.own.shapes.row(row).iter().enumerate() {
                self.inputs.force[m] += phi * force;
                self.inputs.force_rate[m] += phi * rate;
            }
        }
        let gusts = self.indices.gusts().iter();
        let gusts = gusts.map(|index| memory.values[*index]);
        let gust_rates = rates[self.indices.first_gust..].iter().copied();
        self.built
            .own
            .set_gusts(&mut self.inputs, gusts, gust_rates);
    }

    /// Displacement in a row of the shapes by mass-normalised coordinates.
    pub(super) fn at_row(&self, row: usize, modes: &[f64]) -> f64 {
        product(&self.built.own.shapes, row, modes)
    }

    /// The row of the shapes that is the greatest rotation of a named node.
    fn most_turned(&self, modes: &[f64]) -> usize {
        let (mut most, mut greatest) = (2, 0.0);
        for row in (2..self.built.own.shapes.nrows()).step_by(3) {
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

impl CoupledKind for ModalBridge {
    type Own = TunedBridge;

    const TESTED_AT: &'static str = "this bridge was tested at the frequency of its onset";

    fn build(&self, resources: &Resources, values: &[f64]) -> Result<BuiltBridge> {
        BuiltBridge::new(resources, values)
    }

    fn replaces(unit: &mut BridgeUnit) {
        unit.take_start();
    }

    /// The mass of a damper counts by its root.
    fn keep_motion(unit: &BridgeUnit, memory: &mut Memory, index: usize, before: f64) -> bool {
        let Some(d) = unit.own.masses.iter().position(|mass| *mass == index) else {
            return false;
        };
        let coordinate = unit.own.roots.len() + d;
        let rate = unit.section().structure().dofs.len() + coordinate;
        let factor = (memory.values[index] / before).sqrt();
        for entry in [coordinate, rate] {
            memory.system.values[entry] *= factor;
        }
        true
    }

    fn load_inputs(unit: &mut BridgeUnit, memory: &Memory) {
        unit.inputs_stay = false;
        unit.load_without_turbulence(memory);
        if let Some(index) = unit.indices.turbulence_factor {
            let (factor, inputs) = (memory.values[index], &mut unit.inputs);
            if let Some(record) = &unit.built.own.turbulence {
                let (gust, rate) = (&mut inputs.gust_m_s, &mut inputs.gust_rate_m_s2);
                record.add(memory.time, factor, gust, rate);
            }
        }
    }

    fn motion_at_release(unit: &BridgeUnit, values: &[f64]) -> [Vec<f64>; 2] {
        let initial = unit.indices.initial.iter().zip(&unit.own.roots);
        let modes: Vec<f64> = initial.map(|(index, root)| values[*index] * root).collect();
        // masses of dampers go with the girder
        let masses = unit.built.own.bridge.dampers.masses.iter().enumerate();
        let dampers = masses.map(|(d, damper)| {
            -product(&unit.built.own.strokes, d, &modes) * damper.mass_kg.sqrt()
        });
        let all: Vec<f64> = modes.iter().copied().chain(dampers).collect();
        let still = vec![0.0; all.len()];
        [all, still]
    }

    fn pick(unit: &BridgeUnit, modal: &Outputs, role: Role) -> f64 {
        let (own, roots) = (&unit.built.own, &unit.own.roots);
        match role {
            Role::NodeMotion(node, response, dof) => {
                let row = 3 * node + dof as usize;
                unit.at_row(row, modal.lists()[response as usize])
            }
            Role::Damper(d, response) => product(&own.strokes, d, modal.lists()[response as usize]),
            // modes are mass-normalised in the state
            Role::Mode(m, Response::SelfExcitedForce) => modal.self_excited_force[m] * roots[m],
            Role::Mode(m, response) => modal.lists()[response as usize][m] / roots[m],
            _ => 0.0,
        }
    }

    /// Of a named node; forces are those on modes.
    fn motion(
        unit: &BridgeUnit,
        state: &SectionState,
        outputs: &Outputs,
        response: Response,
        dof: Dof,
    ) -> f64 {
        if response == Response::SelfExcitedForce {
            return 0.0;
        }
        let rotation = unit.most_turned(&state.values[..unit.own.roots.len()]);
        let row = rotation - Dof::Torsion as usize + dof as usize;
        unit.at_row(row, outputs.lists()[response as usize])
    }

    fn rotation(unit: &BridgeUnit, memory: &Memory) -> f64 {
        let modes = &memory.system.values[..unit.own.roots.len()];
        unit.at_row(unit.most_turned(modes), modes)
    }

    /// At the frequency of flutter, as far as it is known: the modes of a bridge have too many of their own.
    #[inline]
    fn tested_winds(unit: &BridgeUnit) -> Option<[f64; 2]> {
        let (range, at_one) = (unit.own.tested?, unit.flutter_k_at_one()?);
        Some([range.max, range.min].map(|k| at_one / k.full_width()))
    }

    #[inline]
    fn untested_gap(unit: &BridgeUnit, wind: f64) -> Option<[f64; 2]> {
        let (range, at_one) = (unit.own.tested?, unit.flutter_k_at_one()?);
        let gap = range.gap_at(ReducedFrequency::from_full_width(at_one / wind))?;
        gap.unknown().map(|(from, to)| [at_one / to, at_one / from])
    }

    fn wind_is_tested(unit: &mut BridgeUnit, now: &mut Now) -> bool {
        unit.calculate(now);
        let onset = unit.calculated.onset();
        let wind = now.memory.values[unit.indices.wind_speed];
        let (hertz, width) = (onset.frequency_hz.value, unit.built.own.bridge.width_m());
        let k = ReducedFrequency::from_hertz(hertz, width, wind);
        onset.found && wind > 0.0 && unit.own.tested.is_some_and(|r| r.contains(k))
    }

    fn searched(unit: &BridgeUnit, _: &Resources, memory: &Memory) -> OnsetCard {
        let (own, built) = (&unit.own, &unit.built);
        let limit = memory.values[unit.indices.limit];
        OnsetCard::of_bridge(built, own.tested, own.slow_wind(built), limit).0
    }

    /// Followed, where it can be.
    fn found(unit: &mut BridgeUnit, _: &Resources, memory: &Memory) -> OnsetCard {
        unit.take_start();
        let limit = memory.values[unit.indices.limit];
        let (own, built) = (&mut unit.own, &mut unit.built);
        let known = own.searched.as_ref();
        let onset = known.and_then(|known| known.followed(built, limit));
        let (tested, slow_wind) = (own.tested, own.slow_wind(built));
        let card =
            onset.and_then(|onset| OnsetCard::of_followed(built, tested, slow_wind, limit, &onset));
        card.unwrap_or_else(|| {
            let (card, searched) = OnsetCard::of_bridge(built, tested, slow_wind, limit);
            own.searched = searched;
            card
        })
    }

    fn advance_in_turbulence(
        unit: &mut BridgeUnit,
        memory: &mut Memory,
        step: f64,
        factor: f64,
    ) -> Result<()> {
        unit.load_without_turbulence(memory);
        let Built { stepper, own, .. } = &mut unit.built;
        let times = [memory.time, step, factor];
        own.advance(stepper, &mut memory.system, &unit.inputs, times)
    }

    fn write_outputs(unit: &BridgeUnit, memory: &mut Memory) {
        for (index, role) in &unit.own.responses {
            memory.values[*index] = Self::pick(unit, &unit.outputs, *role);
        }
    }
}
