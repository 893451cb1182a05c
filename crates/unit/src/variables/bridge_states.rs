//! The continuous states of a whole bridge, for importers that integrate and for linear state spaces: mass-normalised modes, filters
//! of the self-excited forces, gusts behind the lags of their admittance.

use super::real::real;
use super::section::{filter, gust_filter};
use super::{Role, Variable};
use crate::bridge_options::BridgeOptions;
use crate::response::Stepper;
use std::f64::consts::TAU;

/// States at most: what depends on what is listed for each, which of more is megabytes of text.
const MOST: usize = 800;

/// Adds the states and their rates to the table of a bridge: coordinates, rates and accelerations of the modes, then filters and
/// lagging gusts, each with its rate.
pub(super) fn add(table: &mut Vec<Variable>, options: &BridgeOptions, stepper: &Stepper) {
    let (first, modes) = (table.len(), options.coordinates());
    let lags = 2 * modes + stepper.section().aerodynamics().states();
    let count = lags + stepper.gust_states();
    if count > MOST {
        return;
    }
    for order in 0..3 {
        table.extend((0..modes).map(|m| normalised(options, m, order)));
    }
    for i in 2 * modes..count {
        table.extend(match i.checked_sub(lags) {
            None => filter(i, &format!("filter[{}]", i + 1 - 2 * modes)),
            Some(lag) => gust_filter(i, &format!("gust_filter[{}]", lag + 1)),
        });
    }
    let mut states = vec![0; count];
    for (index, variable) in table.iter_mut().enumerate().skip(first) {
        variable.derivative_of = match variable.role {
            Role::Filter(i) => {
                states[i] = index;
                // the rate of a coordinate is a state itself
                let of_coordinate = i.checked_sub(modes).filter(|m| *m < modes);
                of_coordinate.map(|m| states[m])
            }
            Role::FilterRate(i) => Some(states[i]),
            _ => None,
        };
    }
}

/// Mass-normalised coordinate of a mode, its rate or its second rate.
fn normalised(options: &BridgeOptions, m: usize, order: usize) -> Variable {
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
    let (whose, of_mass, hertz) = match options.modes.get(m) {
        Some(mode) => {
            let number = mode.number;
            let of_mass = format!("mode {number} times the root of its generalised mass");
            (format!("mode[{number}]"), of_mass, mode.frequency_hz)
        }
        None => {
            let d = m - options.modes.len();
            let (number, hertz) = (d + 1, options.dampers.masses[d].frequency_hz);
            let of_mass = format!("damper {number}, its displacement, times the root of its mass");
            (format!("damper[{number}]"), of_mass, hertz)
        }
    };
    let text = format!("{text} of {of_mass}, in SI units");
    let released = options.modes.iter().zip(&options.initial);
    let sizes = released.map(|(mode, start)| (start * mode.generalised_mass.sqrt()).abs());
    let size = sizes.fold(0.0, f64::max);
    let size = if size > 0.0 { size } else { 1.0 };
    real(format!("{whose}.normalised_{name}"), role, text)
        .nominal(size * (TAU * hertz).powi(order as i32))
}
