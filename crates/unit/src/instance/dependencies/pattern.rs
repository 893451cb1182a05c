//! The pattern of the matrices of a unit: which response follows what acts, and by what kind of factor.

use crate::error::Result;
use crate::instance::coupled::{Coupled, CoupledKind};
use crate::instance::layout::Source;
use crate::instance::memory::Memory;
use crate::instance::sensitivity::SectionValues;
use crate::instance::unit::Unit;
use crate::resources::Resources;
use crate::variables::{DependencyKind, Role, Variable};

/// Wind speeds, m/s, at which nothing vanishes by chance.
const WINDS_M_S: [f64; 2] = [7.3, 11.9];
/// In place of a parameter that is zero, whatever its unit.
const IN_PLACE_OF_ZERO: f64 = 0.01;
/// Relative change of a parameter by which it shows whether a factor depends on it.
const CHANGE: f64 = 1e-3;

/// Kinds of factors by column; `None` for zeros.
type PatternRow = Vec<Option<DependencyKind>>;

/// What acts on a unit at an instant has a column each: the entries of its state with lagging gusts behind, forces on its coordinates,
/// channels of the gusts, and last the wind, with what else scales all that the air does.
pub(super) struct Pattern<S: CoupledKind> {
    /// With generic parameters.
    pub unit: Coupled<S>,
    /// The same at rest, every input zero.
    pub calm: Memory,
    /// Where forces and gusts begin, and the last one.
    pub forces: usize,
    pub gusts: usize,
    pub air: usize,
    /// Indices of the responses, which are the rows.
    pub responses: Vec<usize>,
    /// While it moves.
    pub moving: Vec<PatternRow>,
    /// At the release, to which dampers have gone along: their springs are slack.
    pub released: Vec<PatternRow>,
}

impl<S: CoupledKind> Pattern<S> {
    pub(super) fn new(mut unit: Coupled<S>, resources: &Resources) -> Result<Self> {
        let table = resources.table.variables();
        let start = Memory::new(resources, unit.inputs().len(), unit.at_rest());
        let with = |value: fn(usize, &Variable) -> f64| {
            let mut memory = start.clone();
            for (i, (own, variable)) in memory.values.iter_mut().zip(table).enumerate() {
                *own = generic(variable, *own) * value(i, variable);
            }
            memory
        };
        let mut calm = with(|_, _| 1.0);
        let changed = with(|i, _| 1.0 + CHANGE * (1 + i % 7) as f64);
        let slack = with(|_, v| match (v.role, v.quantity) {
            (Role::DamperParameter(_), Some("Frequency" | "DampingRatio")) => 0.0,
            _ => 1.0,
        });
        unit.parameters_changed();
        unit.prepared(resources, &mut calm)?;
        S::load_inputs(&mut unit, &calm);
        let inputs = &unit.inputs;
        let forces = calm.system.all().len();
        let gusts = forces + inputs.force.len();
        let air = gusts + inputs.gust_m_s.len();
        let is_response = |index: &usize| {
            let source = Source::from_role(table[*index].role);
            matches!(source, Source::Response | Source::State | Source::Rate)
        };
        let responses: Vec<usize> = (0..table.len()).filter(is_response).collect();
        let roles: Vec<Role> = responses.iter().map(|index| table[*index].role).collect();
        let mut entries = |of: &Memory, wind: f64| {
            unit.with_parameters(resources, of, |unit| {
                S::load_inputs(unit, of);
                let mut all = Vec::with_capacity(roles.len() * (air + 1));
                for column in 0..=air {
                    let values = response(unit, of, [forces, gusts, air], column, wind)?;
                    all.extend(roles.iter().map(|role| unit.pick(&values, *role)));
                }
                Ok(all)
            })
        };
        let [first, second] = WINDS_M_S;
        let [usual, in_more_wind] = [entries(&calm, first)?, entries(&calm, second)?];
        let [changed, slack] = [entries(&changed, first)?, entries(&slack, first)?];
        let rows = |present: &[f64]| -> Vec<PatternRow> {
            let entry = |row, column| {
                let at = column * roles.len() + row;
                let kind = if column == air || in_more_wind[at] != usual[at] {
                    DependencyKind::Dependent
                } else if changed[at] != usual[at] {
                    DependencyKind::Tunable
                } else {
                    DependencyKind::Constant
                };
                (present[at] != 0.0).then_some(kind)
            };
            let row = |row| (0..=air).map(|column| entry(row, column)).collect();
            (0..roles.len()).map(row).collect()
        };
        Ok(Self {
            moving: rows(&usual),
            released: rows(&slack),
            unit,
            calm,
            forces,
            gusts,
            air,
            responses,
        })
    }
}

/// A start value that hides nothing: inputs are off, parameters on.
fn generic(variable: &Variable, start: f64) -> f64 {
    match Source::from_role(variable.role) {
        Source::Input | Source::Turbulence => 0.0,
        Source::Section if start == 0.0 => IN_PLACE_OF_ZERO,
        _ => start,
    }
}

/// What one of something does to a unit at rest, and what more wind does to one in motion.
fn response<S: CoupledKind>(
    unit: &mut Coupled<S>,
    rest: &Memory,
    [forces, gusts, air]: [usize; 3],
    column: usize,
    wind: f64,
) -> Result<SectionValues> {
    // sines of whole numbers have nothing to do with one another
    let uneven = |count: usize| (1..=count).map(|i| (i as f64).sin());
    let (is_air, mut on) = (column == air, rest.clone());
    for (index, value) in unit.inputs().iter().zip(uneven(unit.inputs().len())) {
        on.values[*index] = if is_air { value } else { 0.0 };
    }
    S::load_inputs(unit, &on);
    let (stepper, inputs) = (&unit.built.stepper, &mut unit.inputs);
    inputs.wind_speed_m_s = wind;
    if is_air {
        let state = rest.system.with_all(&uneven(forces).collect::<Vec<_>>());
        return Ok(SectionValues::by_speed(stepper, &state, inputs));
    }
    let mut state = rest.system.clone();
    if column < forces {
        state.set_number(column, 1.0);
    } else if column < gusts {
        inputs.force[column - forces] = 1.0;
    } else {
        inputs.gust_m_s[column - gusts] = 1.0;
    }
    unit.instant(&state)
}
