//! Numbers that follow from parameters, wind and motion, a row each: the variable, its value, its derivatives and what it depends on
//! are all made from the row.

use super::computed::Formula::{Flag, Real};
use super::computed::{ComputedNumber, Known};
use super::real::{SPEED, real};
use super::{
    Causality, Dependency, Formula, Response, Role, SectionParameter, StartValue, StripParameter,
    Variable,
};
use crate::section::Dof;
use crate::si;
use std::collections::BTreeSet;

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
        "Whether nothing grows below onset_speed: false where the structure diverges below it, where the model \
         feeds energy into motions outside the tested range, where a motion leaves that range before, or where that is not known",
        Flag(|p| p.onset.stable_below),
    ),
];

/// How far from flutter, and whether the answer can be trusted.
pub(super) const OF_THE_PRESENT: &[ComputedNumber] = &[
    output(
        "flutter_margin",
        "onset_speed less wind_speed; static divergence is not in it, see divergence_speed",
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
        "Whether every motion of a section, at its frequency in still air, or that of a bridge's onset, at its own, lies in the \
         tested range and in no gap of it at the present wind speed",
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

/// Outputs of each strip of forces alone beside its forces.
pub(super) const OF_A_STRIP: &[ComputedNumber] = &[];

impl ComputedNumber {
    /// Its variable of a strip whose variables have names that begin so, without what it depends on.
    pub(super) fn of_strip(&'static self, s: usize, names: &str) -> Variable {
        Variable {
            name: format!("{names}{}", self.name),
            role: Role::OfStrip(s, self),
            ..self.variable()
        }
    }

    /// Its variable, without what it depends on.
    pub(super) fn variable(&'static self) -> Variable {
        let variable = Variable {
            quantity: self.quantity,
            unit: self.unit,
            ..real(self.name, Role::Computed(self), self.text)
        };
        match self.is_flag() {
            true => Variable {
                value: StartValue::Boolean(None),
                ..variable
            },
            false => variable,
        }
    }
}

/// Enters what the computed numbers depend on, once that of motion and forces is known.
pub(crate) fn fill_computed_dependencies(table: &mut [Variable]) {
    let of_bridge = table.iter().any(|v| matches!(v.role, Role::InitialMode(_)));
    for at in 0..table.len() {
        let (number, strip) = match table[at].role {
            Role::Computed(number) => (number, None),
            Role::OfStrip(s, number) => (number, Some(s)),
            _ => continue,
        };
        let mut on = [BTreeSet::new(), BTreeSet::new()];
        let [direct, initial] = &mut on;
        for (index, variable) in table.iter().enumerate() {
            if number
                .reads
                .iter()
                .any(|known| follows(*known, variable.role, of_bridge, strip))
            {
                initial.insert(index);
                if variable.causality == Causality::Input {
                    direct.insert(index);
                }
            }
            let motion = match variable.role {
                Role::Response(response, dof) | Role::NodeMotion(_, response, dof) => {
                    Some([Known::Motion(response, dof), turns(response, dof)])
                }
                Role::Force(s, dof) if strip == Some(s) => {
                    Some([Known::Motion(Response::SelfExcitedForce, dof); 2])
                }
                _ => None,
            };
            if motion.is_some_and(|of| of.into_iter().any(|known| number.reads(known))) {
                direct.extend(variable.direct_inputs.iter().map(|d| d.on));
                initial.extend(variable.initial_dependencies.iter().map(|d| d.on));
            }
        }
        let [direct, initial] = on.map(|on| on.into_iter().map(Dependency::plain).collect());
        (table[at].direct_inputs, table[at].initial_dependencies) = (direct, initial);
    }
}

/// The rotation by its other name.
fn turns(response: Response, dof: Dof) -> Known {
    match (response, dof) {
        (Response::Displacement, Dof::Torsion) => Known::Rotation,
        (response, dof) => Known::Motion(response, dof),
    }
}

/// Whether what a row reads, of a strip or of the whole, follows a parameter or an input by itself. The forces of a bridge are tested at
/// the frequency of its onset.
fn follows(known: Known, on: Role, of_bridge: bool, strip: Option<usize>) -> bool {
    let (wind, limit) = (on == Role::WindSpeed, on == Role::OnsetSearchLimit);
    let parameter = on.is_tuned() || matches!(on, Role::Section(_));
    match known {
        Known::Onset => parameter || limit,
        Known::Wind => wind,
        Known::Damping => parameter || wind,
        Known::TestedWind if of_bridge => parameter || limit || wind,
        Known::TestedWind => {
            use SectionParameter::{Frequency, Width};
            wind || matches!(on, Role::Section(Width | Frequency(_)))
        }
        Known::Length => matches!(on, Role::Strip(s, StripParameter::Length) if strip == Some(s)),
        // others as those that are put out
        Known::Rotation | Known::Motion(..) => match on {
            Role::Motion(s, response, dof) if strip == Some(s) => {
                known == Known::Motion(response, dof) || known == turns(response, dof)
            }
            _ => false,
        },
    }
}
