//! Numbers that follow from parameters, wind and motion, a row each: the variable, its value, its derivatives and what it depends on
//! are all made from the row.

use super::computed::Formula::{Flag, Real};
use super::computed::{ComputedNumber, Known};
use super::dependencies::dependent;
use super::real::{CALCULATED, DISCRETE, OUTPUT, SPEED, real};
use super::{Causality, Formula, Response, Role, StartValue, Variable};
use crate::section::Dof;
use crate::si;

/// Rotation up to which forces are taken as linear: 10 degrees.
pub(crate) const LINEAR_ROTATION_RAD: f64 = 10.0 * std::f64::consts::PI / 180.0;

const fn searched(name: &'static str, text: &'static str, formula: Formula) -> ComputedNumber {
    ComputedNumber::new(
        name,
        text,
        Causality::CalculatedParameter,
        &[Known::Onset],
        formula,
    )
}

const fn output(
    name: &'static str,
    text: &'static str,
    reads: &'static [Known],
    formula: Formula,
) -> ComputedNumber {
    ComputedNumber::new(name, text, Causality::Output, reads, formula)
}

/// Onset and divergence.
pub(super) const SEARCHED: &[ComputedNumber] = &[
    searched(
        "onset_speed",
        "Wind speed of flutter onset for the current parameters; onset_search_limit \
         when none was found, zero when it cannot be computed",
        Real(|p| p.onset.speed_m_s),
    )
    .of_quantity("Velocity", SPEED),
    searched(
        "onset_frequency",
        "Frequency at flutter onset; zero when none is known",
        Real(|p| p.onset.frequency_hz),
    )
    .of_quantity("Frequency", Some(&si::HERTZ)),
    searched(
        "onset_reduced_velocity",
        "Reduced velocity V/(f*B) at flutter onset; zero when none is known",
        Real(|p| p.onset.reduced_velocity),
    )
    .of_quantity("ReducedVelocity", None),
    searched(
        "divergence_speed",
        "Wind speed of static divergence for the current parameters; onset_search_limit \
         when none was found, zero when it cannot be computed",
        Real(|p| p.onset.divergence_m_s),
    )
    .of_quantity("Velocity", SPEED),
    searched(
        "onset_found",
        "Whether a flutter onset was found up to onset_search_limit",
        Flag(|p| p.onset.found),
    ),
    searched(
        "onset_in_tested_range",
        "Whether the reduced frequency at onset lies in the tested range of the model",
        Flag(|p| p.onset.in_tested_range),
    ),
    searched(
        "divergence_found",
        "Whether divergence was found up to onset_search_limit",
        Flag(|p| p.onset.divergence_found),
    ),
    searched(
        "stable_below_onset",
        "Whether nothing grows below onset_speed: false where the model feeds energy into motions \
         outside the tested range, or where that is not known",
        Flag(|p| p.onset.stable_below),
    ),
];

/// How far from flutter, and whether the answer can be trusted.
pub(super) const OF_THE_PRESENT: &[ComputedNumber] = &[
    output(
        "flutter_margin",
        "onset_speed less wind_speed",
        &[Known::Onset, Known::Wind],
        Real(|p| p.onset.speed_m_s - p.wind_m_s),
    )
    .of_quantity("Velocity", SPEED),
    output(
        "damping_now",
        "Smallest damping ratio of the modes at the present wind speed; negative when one grows",
        &[Known::Damping],
        Real(|p| p.damping_ratio),
    )
    .of_quantity("DampingRatio", None),
    output(
        "wind_in_tested_range",
        "Whether every motion, at its frequency in still air, lies in the tested range at the present wind speed",
        &[Known::TestedWind],
        Flag(|p| p.wind_is_tested),
    ),
    output(
        "amplitude_in_linear_range",
        "Whether the rotation is at most 10 degrees, where linear forces end",
        &[Known::Rotation],
        Flag(|p| p.rotation_rad.value.abs() <= LINEAR_ROTATION_RAD),
    ),
    output(
        "flutter_speed",
        "onset_speed once more, for tools that take outputs only",
        &[Known::Onset],
        Real(|p| p.onset.speed_m_s),
    )
    .of_quantity("Velocity", SPEED),
];

impl ComputedNumber {
    /// Its variable, without what it depends on.
    pub(super) fn variable(&'static self) -> Variable {
        let kind = match (self.causality, self.is_flag()) {
            (Causality::Output, false) => OUTPUT,
            (Causality::Output, true) => DISCRETE,
            _ => CALCULATED,
        };
        let variable = Variable {
            quantity: self.quantity,
            unit: self.unit,
            ..real(self.name, Role::Computed(self), kind, self.text)
        };
        match self.is_flag() {
            true => Variable {
                value: StartValue::Boolean(None),
                ..variable
            },
            false => variable.shown_if(self.unit == Some(&si::HERTZ)),
        }
    }
}

/// Fills in what the computed numbers of a section or bridge depend on: what is searched for and damped on all parameters of the
/// structure; wind and rotation on themselves.
pub(super) fn fill_dependencies(table: &mut [Variable]) {
    let places = |wanted: &dyn Fn(Role) -> bool| -> Vec<usize> {
        (0..table.len())
            .filter(|i| wanted(table[*i].role))
            .collect()
    };
    let wind = places(&|r| r == Role::WindSpeed);
    let parameters = places(&|r| {
        matches!(
            r,
            Role::Section(_)
                | Role::ModeParameter(..)
                | Role::DamperParameter(_)
                | Role::OnsetSearchLimit
        )
    });
    let modes = places(&|r| matches!(r, Role::InitialMode(_)));
    let release = places(&|r| r == Role::InitialDisplacement(Dof::Torsion));
    let states_are_seen = table.iter().any(|v| v.derivative_of.is_some());
    let turns = places(&|r| match r {
        Role::Response(Response::Displacement, dof) => dof == Dof::Torsion,
        Role::Filter(entry) => entry < modes.len(),
        _ => false,
    });
    for variable in table.iter_mut() {
        let Role::Computed(number) = variable.role else {
            continue;
        };
        let reads = |any: &[Known]| any.iter().any(|known| number.reads(*known));
        let (mut direct, mut initial) = (Vec::new(), Vec::new());
        if reads(&[Known::Onset, Known::Damping, Known::TestedWind]) {
            initial.extend(&parameters);
        }
        if reads(&[Known::Wind, Known::Damping, Known::TestedWind]) {
            direct.extend(&wind);
            initial.extend(&wind);
        }
        if reads(&[Known::Rotation]) {
            initial.extend(release.iter().chain(&modes));
            direct.extend(turns.iter().filter(|_| states_are_seen));
        }
        direct.sort_unstable();
        variable.direct_inputs = direct;
        initial.sort_unstable();
        variable.initial_dependencies = dependent(initial);
    }
}
