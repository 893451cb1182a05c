//! The continuous states of a whole bridge, for importers that integrate and for linear state spaces: mass-normalised modes, filters
//! of the self-excited forces, gusts behind the lags of their admittance.

use super::dependencies::dependent;
use super::real::{INNER, real};
use super::section::{filter, gust_filter};
use super::{InitialDependency, ModeOutput, Response, Role, Variable};
use crate::aerodynamics::{ContinuousRealization, Realization};
use crate::bridge_options::BridgeOptions;
use crate::error::{Error, Result};
use crate::response::Stepper;
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// States at most: what depends on what is listed for each, which of more is megabytes of text.
const MOST: usize = 800;

/// Adds the states and their rates to the table of a bridge, and enters on which states everything depends.
pub(super) fn add(
    table: &mut Vec<Variable>,
    options: &BridgeOptions,
    stepper: &Stepper,
) -> Result<()> {
    let Realization::Continuous(air) = stepper.section().aerodynamics() else {
        return Err(Error::Numerical(
            "bridge: expected forces that are continuous in time, found sampled ones".into(),
        ));
    };
    let states = States {
        first: table.len(),
        modes: options.coordinates(),
        filters: air.a.nrows(),
        lags: stepper.gust_states(),
    };
    if states.count() > MOST {
        return Ok(());
    }
    table.extend(states.variables(options));
    for entry in 0..states.count() {
        table[states.rate(entry)].derivative_of = Some(states.state(entry));
    }
    let known = StateDependencies::of(table);
    for variable in &mut table[..states.first] {
        variable.direct_inputs.extend(states.behind(variable.role));
        variable.direct_inputs.sort_unstable();
    }
    states.modes_depend(table, &known);
    states.filters_depend(table, &known, air);
    states.lags_depend(table, &known);
    Ok(())
}

/// Where the states stand in the table: coordinates, rates and accelerations of the modes, then filters and lagging gusts, each with
/// its rate.
struct States {
    first: usize,
    modes: usize,
    filters: usize,
    lags: usize,
}

impl States {
    fn count(&self) -> usize {
        2 * self.modes + self.filters + self.lags
    }

    /// Place of an entry of the state of what is simulated.
    fn state(&self, entry: usize) -> usize {
        match entry.checked_sub(2 * self.modes) {
            Some(behind) => self.first + 3 * self.modes + 2 * behind,
            None => self.first + entry,
        }
    }

    /// Place of its rate; that of a coordinate is a state itself.
    fn rate(&self, entry: usize) -> usize {
        match entry.checked_sub(2 * self.modes) {
            Some(_) => self.state(entry) + 1,
            None => self.first + self.modes + entry,
        }
    }

    fn variables(&self, options: &BridgeOptions) -> Vec<Variable> {
        let orders = (0..3).flat_map(|order| (0..self.modes).map(move |m| (m, order)));
        let modes = orders.map(|(m, order)| normalised(options, m, order));
        let behind = 2 * self.modes;
        let filters =
            (0..self.filters).flat_map(|i| filter(behind + i, &format!("filter[{}]", i + 1)));
        let lags = (0..self.lags).flat_map(|i| {
            gust_filter(
                behind + self.filters + i,
                &format!("gust_filter[{}]", i + 1),
            )
        });
        modes.chain(filters).chain(lags).collect()
    }

    fn coordinates(&self) -> Vec<usize> {
        (0..self.modes).map(|m| self.state(m)).collect()
    }

    fn rates(&self) -> Vec<usize> {
        (0..self.modes).map(|m| self.rate(m)).collect()
    }

    fn all(&self) -> Vec<usize> {
        (0..self.count()).map(|entry| self.state(entry)).collect()
    }

    /// The states on which an output depends.
    fn behind(&self, output: Role) -> Vec<usize> {
        match output {
            Role::Mode(m, ModeOutput::Coordinate) => vec![self.state(m)],
            Role::Mode(m, ModeOutput::Rate) => vec![self.rate(m)],
            Role::NodeMotion(_, Response::Displacement, _)
            | Role::Damper(_, Response::Displacement) => self.coordinates(),
            Role::NodeMotion(_, Response::Rate, _) | Role::Damper(_, Response::Rate) => {
                self.rates()
            }
            Role::NodeMotion(..) | Role::Mode(..) | Role::Damper(..) => self.all(),
            _ => Vec::new(),
        }
    }

    fn modes_depend(&self, table: &mut [Variable], known: &StateDependencies) {
        for m in 0..self.modes {
            let released = known.released(m).iter().copied();
            table[self.state(m)].initial_dependencies = dependent(released);
            let rate = self.rate(m);
            table[rate].direct_inputs = vec![rate];
            let acceleration = &mut table[self.rate(self.modes + m)];
            acceleration.direct_inputs = [known.inputs.clone(), self.all()].concat();
            acceleration.direct_inputs.sort_unstable();
            acceleration.initial_dependencies = known.of_forces.clone();
        }
    }

    fn filters_depend(
        &self,
        table: &mut [Variable],
        known: &StateDependencies,
        air: &ContinuousRealization,
    ) {
        for i in 0..self.filters {
            let entry = 2 * self.modes + i;
            let linked = |k: &usize| air.a[(i, *k)] != 0.0;
            let filters = (0..self.filters).filter(linked);
            let driven = (0..self.modes).filter(|m| air.b[(i, *m)] != 0.0);
            let states = driven.chain(filters.map(|k| 2 * self.modes + k));
            let mut direct: Vec<usize> = states.map(|entry| self.state(entry)).collect();
            direct.extend(known.wind);
            direct.sort_unstable();
            let drivers = drivers(air, i);
            let settled = drivers.iter().flat_map(|m| known.released(*m)).copied();
            let settled: BTreeSet<usize> = settled.collect();
            let settled: Vec<usize> = settled.into_iter().collect();
            table[self.state(entry)].initial_dependencies = dependent(settled.iter().copied());
            let rate = &mut table[self.rate(entry)];
            rate.direct_inputs = direct;
            rate.initial_dependencies = dependent(with(&settled, known.wind));
        }
    }

    fn lags_depend(&self, table: &mut [Variable], known: &StateDependencies) {
        for i in 0..self.lags {
            let entry = 2 * self.modes + self.filters + i;
            let (state, rate) = (self.state(entry), self.rate(entry));
            table[state].initial_dependencies = dependent(known.blowing.iter().copied());
            table[rate].initial_dependencies = dependent(with(&known.blowing, known.wind));
            let gusts = with(&known.gusts, known.wind);
            table[rate].direct_inputs = with(&gusts, Some(state));
        }
    }
}

/// What states depend on, by place in the table.
struct StateDependencies {
    /// Wind, forces and gusts.
    inputs: Vec<usize>,
    wind: Option<usize>,
    gusts: Vec<usize>,
    /// Gusts, and what is in the archive.
    blowing: Vec<usize>,
    /// The coordinate of each mode at release.
    release: Vec<usize>,
    /// What the forces of the instant depend on while initialising.
    of_forces: Vec<InitialDependency>,
}

impl StateDependencies {
    fn of(table: &[Variable]) -> Self {
        let places = |wanted: fn(Role) -> bool| -> Vec<usize> {
            let all = table.iter().enumerate();
            all.filter(|(_, v)| wanted(v.role))
                .map(|(i, _)| i)
                .collect()
        };
        let of_force = |v: &&Variable| matches!(v.role, Role::Mode(_, ModeOutput::Force));
        let forces = table.iter().find(of_force);
        Self {
            inputs: places(|r| matches!(r, Role::WindSpeed | Role::NodeForce(..) | Role::Gust(..))),
            wind: places(|r| r == Role::WindSpeed).first().copied(),
            gusts: places(|r| matches!(r, Role::Gust(..))),
            blowing: places(|r| matches!(r, Role::Gust(..) | Role::TurbulenceFactor)),
            release: places(|r| matches!(r, Role::InitialMode(_))),
            of_forces: forces.map_or(vec![], |v| v.initial_dependencies.clone()),
        }
    }
}

impl StateDependencies {
    /// On which coordinates at release that of a mode, or of a damper, depends.
    fn released(&self, coordinate: usize) -> &[usize] {
        match self.release.get(coordinate) {
            Some(own) => std::slice::from_ref(own),
            None => &self.release,
        }
    }
}

/// The modes that drive a filter, by itself or through others.
fn drivers(air: &ContinuousRealization, filter: usize) -> Vec<usize> {
    let mut chain = vec![filter];
    let mut next = 0;
    while let Some(&at) = chain.get(next) {
        next += 1;
        for other in 0..air.a.ncols() {
            if air.a[(at, other)] != 0.0 && !chain.contains(&other) {
                chain.push(other);
            }
        }
    }
    let drives = |m: &usize| chain.iter().any(|i| air.b[(*i, *m)] != 0.0);
    (0..air.b.ncols()).filter(drives).collect()
}

fn with(places: &[usize], further: Option<usize>) -> Vec<usize> {
    let mut all: Vec<usize> = places.iter().copied().chain(further).collect();
    all.sort_unstable();
    all
}

/// Mass-normalised coordinate of a mode, its rate or its second rate.
fn normalised(options: &BridgeOptions, m: usize, order: usize) -> Variable {
    let mode = options.modes.get(m);
    let damper = m.checked_sub(options.modes.len());
    let (name, text) = [
        ("coordinate", "Coordinate"),
        ("rate", "Rate of the coordinate"),
        ("acceleration", "Second rate of the coordinate"),
    ][order];
    let n = options.coordinates();
    let role = match order {
        2 => Role::FilterRate(n + m),
        _ => Role::Filter(order * n + m),
    };
    let (whose, of_mass) = match (mode, damper) {
        (Some(mode), _) => (
            format!("mode[{}]", mode.number),
            format!(
                "mode {} times the root of its generalised mass",
                mode.number
            ),
        ),
        (None, damper) => {
            let number = damper.unwrap_or(0) + 1;
            (
                format!("damper[{number}]"),
                format!("damper {number}, its displacement, times the root of its mass"),
            )
        }
    };
    let text = format!("{text} of {of_mass}, in SI units");
    let released = options.modes.iter().zip(&options.initial);
    let sizes = released.map(|(mode, start)| (start * mode.generalised_mass.sqrt()).abs());
    let size = sizes.fold(0.0, f64::max);
    let size = if size > 0.0 { size } else { 1.0 };
    let masses = damper.and_then(|d| options.dampers.masses.get(d));
    let hertz = mode
        .map(|m| m.frequency_hz)
        .or(masses.map(|d| d.frequency_hz));
    let omega = TAU * hertz.unwrap_or(1.0);
    real(format!("{whose}.normalised_{name}"), role, INNER, text)
        .nominal(size * omega.powi(order as i32))
}
