//! One variable of the table: what it stands for, its type, its limits and what it depends on.

use super::computed::ComputedNumber;
use super::parameters::SectionParameter;
use super::response::Response;
use crate::aerodynamics::GustComponent;
use crate::section::Dof;
use crate::si::SiUnit;
use crate::standard::{Causality, FmiTerm, Initial, Variability};

/// Type of a variable, with its start value where it has one.
#[derive(Debug, Clone, PartialEq)]
pub enum StartValue {
    /// A real number.
    Real(Option<f64>),
    /// An integer.
    Integer(Option<i32>),
    /// A truth value.
    Boolean(Option<bool>),
    /// A text.
    String(String),
}

impl StartValue {
    /// Name of the type.
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::Real(_) => "Real",
            Self::Integer(_) => "Integer",
            Self::Boolean(_) => "Boolean",
            Self::String(_) => "String",
        }
    }
}

/// The quantity behind a variable: what getters and setters dispatch on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Wind speed `V`.
    WindSpeed,
    /// External force on a degree of freedom.
    ExternalForce(Dof),
    /// Gust at a strip, counted from zero.
    Gust(usize, GustComponent),
    /// Motion or self-excited force of a degree of freedom.
    Response(Response, Dof),
    /// A property of the section.
    Section(SectionParameter),
    /// Displacement at release.
    InitialDisplacement(Dof),
    /// Rate at release.
    InitialRate(Dof),
    /// Upper end of the search for onset and divergence.
    OnsetSearchLimit,
    /// Computed from parameters, wind and state.
    Computed(&'static ComputedNumber),
    /// A state that is no motion, counted from zero: filters of the aerodynamic model, then gusts behind the lags of their
    /// admittance.
    Filter(usize),
    /// Its rate.
    FilterRate(usize),
    /// Never changes.
    Constant,
    /// Motion of a degree of freedom of a strip, counted from zero.
    Motion(usize, Response, Dof),
    /// Self-excited force on a strip, per unit length of span.
    Force(usize, Dof),
    /// The same on the whole strip.
    TotalForce(usize, Dof),
    /// A property of a strip.
    Strip(usize, StripParameter),
    /// Computed from wind, motion and forces of a strip.
    OfStrip(usize, &'static ComputedNumber),
    /// How far ahead of the motion the force is put out, in communication steps.
    Prediction,
    /// Which derivatives of the motion the importer sets.
    MotionDerivatives,
    /// External force on a node of a bridge, by its index among those named.
    NodeForce(usize, Dof),
    /// Motion of a node of a bridge.
    NodeMotion(usize, Response, Dof),
    /// Coordinate of a mode of a bridge, its rate, or the self-excited force on it.
    Mode(usize, Response),
    /// Modal coordinate at release.
    InitialMode(usize),
    /// Natural frequency of a mode of a bridge without wind, Hz.
    ModeFrequency(usize),
    /// Ratio of its damping to critical.
    ModeDamping(usize),
    /// Stroke of a mass damper, or a rate of it.
    Damper(usize, Response),
    /// A property of the dampers, in the order of [`Bridge::tunable`](crate::bridge::Bridge::tunable).
    DamperParameter(usize),
    /// Factor on the turbulence that a bridge has in its archive.
    TurbulenceFactor,
}

impl Role {
    /// Whether it is one of the numbers of [`Bridge::tunable`](crate::bridge::Bridge::tunable), which stand in that order in the table.
    pub(crate) fn is_tuned(self) -> bool {
        matches!(
            self,
            Self::Section(SectionParameter::AirDensity)
                | Self::ModeFrequency(_)
                | Self::ModeDamping(_)
                | Self::DamperParameter(_)
        )
    }

    /// What it is to the importer, and when it changes.
    pub(crate) fn kind(self) -> (Causality, Variability) {
        match self {
            Self::WindSpeed
            | Self::ExternalForce(_)
            | Self::Gust(..)
            | Self::Motion(..)
            | Self::NodeForce(..) => (Causality::Input, Variability::Continuous),
            Self::Response(..)
            | Self::Force(..)
            | Self::TotalForce(..)
            | Self::NodeMotion(..)
            | Self::Mode(..)
            | Self::Damper(..) => (Causality::Output, Variability::Continuous),
            Self::Section(_)
            | Self::Strip(..)
            | Self::Prediction
            | Self::ModeFrequency(_)
            | Self::ModeDamping(_)
            | Self::DamperParameter(_)
            | Self::TurbulenceFactor => (Causality::Parameter, Variability::Tunable),
            Self::InitialDisplacement(_)
            | Self::InitialRate(_)
            | Self::InitialMode(_)
            | Self::OnsetSearchLimit
            | Self::MotionDerivatives => (Causality::Parameter, Variability::Fixed),
            Self::Constant => (Causality::Local, Variability::Constant),
            Self::Filter(_) | Self::FilterRate(_) => (Causality::Local, Variability::Continuous),
            Self::Computed(number) | Self::OfStrip(_, number) => {
                let variability = match (number.causality, number.is_flag()) {
                    (Causality::Output, false) => Variability::Continuous,
                    (Causality::Output, true) => Variability::Discrete,
                    _ => Variability::Tunable,
                };
                (number.causality, variability)
            }
        }
    }
}

/// A property of a strip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StripParameter {
    /// Deck width `B`.
    Width,
    /// Length of span.
    Length,
    /// Wind speed at the strip over the input.
    WindFactor,
}

/// By what an importer may count on a known, from the most to the least.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum DependencyKind {
    /// It is multiplied by a constant.
    Constant,
    /// It is multiplied by a number that changes with parameters only.
    Tunable,
    /// Nothing.
    Dependent,
}

impl FmiTerm for DependencyKind {
    const ALL: &'static [(&'static str, Self)] = &[
        ("constant", Self::Constant),
        ("tunable", Self::Tunable),
        ("dependent", Self::Dependent),
    ];
}

/// One known that an unknown depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dependency {
    /// Index of the known in the table.
    pub on: usize,
    /// How.
    pub kind: DependencyKind,
}

impl Dependency {
    /// Of which no more is known.
    pub(crate) fn plain(on: usize) -> Self {
        let kind = DependencyKind::Dependent;
        Self { on, kind }
    }

    /// The same by a constant factor.
    pub(crate) fn constant(on: usize) -> Self {
        let kind = DependencyKind::Constant;
        Self { on, kind }
    }

    /// The same while initialising, where the standard knows of no factors that are tuned.
    pub(crate) fn of_initialization(self) -> Self {
        match self.kind {
            DependencyKind::Constant => self,
            DependencyKind::Tunable | DependencyKind::Dependent => Self::plain(self.on),
        }
    }
}

/// One variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Name, unique in the table.
    pub name: String,
    /// What it means, with sign and reference.
    pub description: String,
    /// What it stands for.
    pub role: Role,
    /// Whether descriptions list it; the others stay in the runtime, unnamed.
    pub is_listed: bool,
    /// What it is to the importer.
    pub causality: Causality,
    /// When it changes.
    pub variability: Variability,
    /// How it is initialised; `None` for inputs.
    pub initial: Option<Initial>,
    /// Type and start value.
    pub value: StartValue,
    /// Unit of a dimensional number.
    pub unit: Option<&'static SiUnit>,
    /// Name of the unit it is best shown in, one of the display units of `unit`.
    pub display_unit: Option<&'static str>,
    /// Physical quantity in one word.
    pub quantity: Option<&'static str>,
    /// Smallest value that is accepted.
    pub min: Option<f64>,
    /// Largest value that is accepted.
    pub max: Option<f64>,
    /// Usual size.
    pub nominal: Option<f64>,
    /// The variable whose rate it is, by index in the table (rates of states only).
    pub derivative_of: Option<usize>,
    /// Inputs and states that act on it without delay, by index in the table (outputs and rates of states only).
    pub direct_inputs: Vec<Dependency>,
    /// What it depends on while initialising, by index in the table (unknowns only).
    pub initial_dependencies: Vec<Dependency>,
}

impl Variable {
    /// Whether it is one of the unknowns of the initialisation mode.
    pub fn is_initial_unknown(&self) -> bool {
        self.initial == Some(Initial::Calculated)
    }

    /// Whether it is found by integration.
    pub(crate) fn is_state(&self) -> bool {
        matches!(
            self.role,
            Role::Response(Response::Displacement | Response::Rate, _) | Role::Filter(_)
        )
    }
}
