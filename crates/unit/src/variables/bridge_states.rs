//! The continuous states of a whole bridge, for importers that integrate and for linear state spaces: mass-normalised modes, filters
//! of the self-excited forces, gusts behind the lags of their admittance.

use super::real::{INNER, real};
use super::section::{filter, gust_filter};
use super::{Role, Variable};
use crate::bridge_options::BridgeOptions;
use crate::response::Stepper;
use std::f64::consts::TAU;

/// States at most: what depends on what is listed for each, which of more is megabytes of text.
const MOST: usize = 800;

/// Adds the states and their rates to the table of a bridge.
pub(super) fn add(table: &mut Vec<Variable>, options: &BridgeOptions, stepper: &Stepper) {
    let states = States {
        first: table.len(),
        modes: options.coordinates(),
        filters: stepper.section().aerodynamics().states(),
        lags: stepper.gust_states(),
    };
    if states.count() > MOST {
        return;
    }
    table.extend(states.variables(options));
    for entry in 0..states.count() {
        table[states.rate(entry)].derivative_of = Some(states.state(entry));
    }
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

    /// Index of an entry of the state of what is simulated.
    fn state(&self, entry: usize) -> usize {
        match entry.checked_sub(2 * self.modes) {
            Some(behind) => self.first + 3 * self.modes + 2 * behind,
            None => self.first + entry,
        }
    }

    /// Index of its rate; that of a coordinate is a state itself.
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
