//! What depends on what, by the pattern of `ż = A(V) z + B w`, `y = C(V) z + D w` as the unit itself computes them at generic wind
//! speeds and parameters, so that no number that happens to be zero hides anything.

mod pattern;

use super::Instance;
use super::bridge_unit::BridgeUnit;
use super::coupled::{Coupled, CoupledKind};
use super::section_unit::SectionUnit;
use crate::aerodynamics::Realization;
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::resources::Resources;
use crate::section::Dof;
use crate::variables::{
    Dependency, DependencyKind, Response, Role, SectionParameter, Variable, VariableTable,
    fill_computed_dependencies,
};
use pattern::Pattern;
use std::collections::BTreeMap;

/// What an importer sets, by the column of a pattern through which it acts.
type Sources = Vec<Vec<Dependency>>;

impl Resources {
    /// The table with what every variable depends on. That is no part of the identity: it follows from the rest, and what rounding
    /// leaves of a zero may differ from one processor to the next.
    ///
    /// # Errors
    /// As [`Instance::new`].
    pub fn described_table(&self) -> Result<VariableTable> {
        let mut table = self.table.clone();
        match (&self.bridge, &self.force) {
            (Some(options), _) => enter(&mut table, self, BridgeUnit::of_bridge(self, options)?)?,
            (None, None) => enter(&mut table, self, SectionUnit::of_section(self)?)?,
            // strips do nothing to one another: their rows say it
            (None, Some(_)) => {}
        }
        Ok(table)
    }
}

impl Instance {
    /// The table of [`Resources::described_table`], made when it is first asked for.
    ///
    /// # Errors
    /// As there.
    pub(crate) fn described_table(&mut self) -> Result<&VariableTable> {
        let table = match self.described.take() {
            Some(table) => table,
            None => self.now.resources.described_table()?,
        };
        Ok(self.described.insert(table))
    }
}

/// Enters the dependencies of a section or bridge.
fn enter<S: CoupledKind>(
    table: &mut VariableTable,
    resources: &Resources,
    unit: Coupled<S>,
) -> Result<()> {
    let mut pattern = Pattern::new(unit, resources)?;
    let variables = table.variables_mut();
    let at_once = set_while_moving(&mut pattern, variables);
    let at_release = set_at_release(&mut pattern, variables, &at_once);
    let motion = 2 * pattern.unit.section().structure().dofs.len();
    let entries = &pattern.unit.indices.state_entry;
    for (row, index) in pattern.responses.iter().enumerate() {
        let variable = &mut variables[*index];
        // dampers go along with the girder until the release, and the flow has settled
        let still = match variable.role {
            Role::Damper(_, response) => response == Response::Displacement,
            _ => variable
                .derivative_of
                .is_some_and(|of| entries[of] >= Some(motion)),
        };
        variable.direct_inputs = through(&pattern.moving[row], &at_once);
        variable.initial_dependencies.clear();
        if !still {
            let initial = through(&pattern.released[row], &at_release).into_iter();
            variable.initial_dependencies = initial.map(Dependency::of_initialization).collect();
        }
    }
    fill_computed_dependencies(variables);
    Ok(())
}

/// What a response depends on through the columns of its row.
fn through(row: &[Option<DependencyKind>], sources: &Sources) -> Vec<Dependency> {
    let mut found = BTreeMap::new();
    for (kind, on) in row.iter().zip(sources) {
        for of in on.iter().filter(|_| kind.is_some()) {
            let known = found.entry(of.on).or_insert(of.kind);
            *known = (*known).max(of.kind).max(kind.unwrap_or(of.kind));
        }
    }
    let dependencies = found.into_iter();
    dependencies
        .map(|(on, kind)| Dependency { on, kind })
        .collect()
}

/// Adds a number to the columns of what it loads.
fn add_loading<S: CoupledKind>(pattern: &mut Pattern<S>, index: usize, sources: &mut Sources) {
    let mut one = pattern.calm.clone();
    one.values[index] = 1.0;
    S::load_inputs(&mut pattern.unit, &one);
    let loaded = &pattern.unit.inputs;
    let loaded = loaded.force.iter().chain(&loaded.gust_m_s);
    let columns = sources[pattern.forces..].iter_mut().zip(loaded);
    for (list, _) in columns.filter(|(_, number)| **number != 0.0) {
        list.push(Dependency::constant(index));
    }
}

/// Inputs and the states that importers see.
fn set_while_moving<S: CoupledKind>(pattern: &mut Pattern<S>, table: &[Variable]) -> Sources {
    let mut sources = vec![Vec::new(); pattern.air + 1];
    let inputs = pattern.unit.indices.inputs.clone();
    sources[pattern.air].push(Dependency::constant(inputs[0]));
    for index in &inputs[1..] {
        add_loading(pattern, *index, &mut sources);
    }
    let entries = &pattern.unit.indices.state_entry;
    for index in table.iter().filter_map(|v| v.derivative_of) {
        if let Some(entry) = entries[index] {
            sources[entry].push(Dependency::constant(index));
        }
    }
    sources
}

/// Inputs, parameters, and what is stated of the release.
fn set_at_release(
    pattern: &mut Pattern<impl CoupledKind>,
    table: &[Variable],
    inputs: &Sources,
) -> Sources {
    let (forces, gusts, air) = (pattern.forces, pattern.gusts, pattern.air);
    let mut sources = inputs.clone();
    sources[..forces].iter_mut().for_each(Vec::clear);
    if let Some(factor) = pattern.unit.indices.turbulence_factor {
        add_loading(pattern, factor, &mut sources);
    }
    let initial = &pattern.unit.indices.initial;
    for (entry, index) in initial.iter().enumerate() {
        sources[entry].push(Dependency::constant(*index));
    }
    for (row, index) in pattern.responses.iter().enumerate() {
        if let Role::Damper(d, Response::Displacement) = table[*index].role {
            let of_modes = through(&pattern.moving[row][..initial.len()], &sources);
            sources[initial.len() + d].extend(of_modes);
        }
    }
    let section = pattern.unit.section();
    let filters = driven_filters(section);
    for (index, variable) in table.iter().enumerate() {
        for column in columns_of(variable, pattern, &filters) {
            sources[column].push(Dependency::plain(index));
        }
    }
    for (coordinate, driven) in filters.iter().enumerate() {
        let of_motion: Vec<_> = sources[coordinate].iter().map(|d| d.on).collect();
        for filter in driven {
            let of_filter = of_motion.iter().copied().map(Dependency::plain);
            sources[*filter].extend(of_filter);
        }
    }
    // lags stand where their gusts are
    let lagging = section.states()..forces;
    let lags = lagging.len() / (air - gusts).max(1);
    for lag in lagging.clone() {
        sources[lag] = sources[gusts + (lag - lagging.start) / lags].clone();
    }
    sources
}

/// The columns through which a parameter acts at the release, where springs are bent and nothing but what is stated moves.
fn columns_of(
    variable: &Variable,
    pattern: &Pattern<impl CoupledKind>,
    filters: &[Vec<usize>],
) -> Vec<usize> {
    let air = pattern.air;
    let dofs = &pattern.unit.section().structure().dofs;
    let forces = |on: &[Dof]| -> Vec<usize> {
        let acted_on = dofs.iter().zip(pattern.forces..);
        acted_on
            .filter(|(dof, _)| on.contains(dof))
            .map(|(_, column)| column)
            .collect()
    };
    let air_and_filters = |of: &[Dof]| -> Vec<usize> {
        let driven = dofs.iter().zip(filters).filter(|(dof, _)| of.contains(dof));
        driven
            .flat_map(|(_, filters)| filters.iter().copied())
            .chain([air])
            .collect()
    };
    match variable.role {
        Role::Section(parameter) => match parameter {
            SectionParameter::AirDensity => vec![air],
            SectionParameter::Width => air_and_filters(&[Dof::Vertical, Dof::Lateral]),
            SectionParameter::AxisOffset => air_and_filters(&[Dof::Vertical]),
            SectionParameter::MassOffset => forces(&[Dof::Vertical, Dof::Torsion]),
            SectionParameter::Inertia(dof)
            | SectionParameter::Frequency(dof)
            | SectionParameter::DampingRatio(dof) => forces(&[dof]),
        },
        Role::ModeFrequency(mode) => vec![pattern.forces + mode],
        // springs and dashpots of dampers are at rest
        Role::DamperParameter(i) if variable.quantity == Some("Mass") => {
            vec![pattern.unit.indices.initial.len() + i / 3]
        }
        _ => Vec::new(),
    }
}

/// The entries of the state that are filters which each coordinate drives, by itself or through others.
fn driven_filters(section: &CoupledSection) -> Vec<Vec<usize>> {
    let (a, b) = match section.aerodynamics() {
        Realization::Continuous(c) => (&c.a, &c.b),
        Realization::Discrete(d) => (&d.a, &d.b),
    };
    let driven = |drive: usize| {
        let mut driven: Vec<usize> = (0..b.nrows()).filter(|i| b[(*i, drive)] != 0.0).collect();
        let mut next = 0;
        while let Some(&at) = driven.get(next) {
            let fed = (0..a.nrows()).filter(|i| a[(*i, at)] != 0.0);
            let fed: Vec<usize> = fed.filter(|i| !driven.contains(i)).collect();
            driven.extend(fed);
            next += 1;
        }
        let first = 2 * b.ncols();
        driven.into_iter().map(|filter| first + filter).collect()
    };
    (0..b.ncols()).map(driven).collect()
}
