//! What `modelDescription.xml` of a co-simulation FMU says, as plain values in the words of FMI 2.0.

pub use crate::standard::{Causality, Initial, Variability};
use std::collections::HashMap;

/// Name of the description in the archive.
pub(super) const FILE: &str = "modelDescription.xml";

/// Type of a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum VariableType {
    /// `fmi2Real`.
    Real,
    /// `fmi2Integer`.
    Integer,
    /// `fmi2Boolean`.
    Boolean,
    /// `fmi2String`.
    String,
    /// `fmi2Integer` with named values.
    Enumeration,
}

/// A value of a variable.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Real.
    Real(f64),
    /// Integer or enumeration.
    Integer(i32),
    /// Boolean.
    Boolean(bool),
    /// String.
    String(String),
}

impl std::fmt::Display for Value {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Real(v) => write!(f, "{v}"),
            Self::Integer(v) => write!(f, "{v}"),
            Self::Boolean(v) => write!(f, "{v}"),
            Self::String(v) => write!(f, "{v}"),
        }
    }
}

/// Attributes that a variable may take over from its declared type.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TypeAttributes {
    /// Unit.
    pub unit: Option<String>,
    /// Unit for display.
    pub display_unit: Option<String>,
    /// Smallest value.
    pub min: Option<f64>,
    /// Largest value.
    pub max: Option<f64>,
    /// Usual size.
    pub nominal: Option<f64>,
}

/// A variable of the FMU.
#[derive(Debug, Clone, PartialEq)]
pub struct ScalarVariable {
    /// Name.
    pub name: String,
    /// Handle, unique within its type except for aliases.
    pub value_reference: u32,
    /// What it is.
    pub description: Option<String>,
    /// Role; `local` when not stated.
    pub causality: Causality,
    /// Variability; `continuous` when not stated.
    pub variability: Variability,
    /// Whether the variability is stated.
    pub variability_stated: bool,
    /// `initial` as stated.
    pub initial: Option<Initial>,
    /// Type.
    pub kind: VariableType,
    /// Start value.
    pub start: Option<Value>,
    /// Name of the declared type.
    pub declared_type: Option<String>,
    /// Unit, range and the like.
    pub attributes: TypeAttributes,
    /// Index (from 1) of the variable whose derivative this is.
    pub derivative: Option<usize>,
    /// Line in the file.
    pub line: usize,
}

impl ScalarVariable {
    /// `initial` as stated, or its default; `None` for inputs and time, which have none, and for combinations of
    /// causality and variability that are not legal (table in section 2.2.7 of the standard).
    pub(crate) fn effective_initial(&self) -> Option<Initial> {
        let choices = initial_choices(self.causality, self.variability);
        self.initial.or(choices.and_then(|(default, _)| default))
    }

    /// Whether an importer may set it before initialisation ends or during the run.
    pub fn settable(&self) -> bool {
        let initial = self.effective_initial();
        let starts = matches!(initial, Some(Initial::Exact | Initial::Approx));
        self.causality == Causality::Input || (self.variability != Variability::Constant && starts)
    }

    /// An attribute of the variable or, when it states none, of its declared type among `types`
    /// (`ModelDescription::types_by_name`).
    pub fn attribute<T>(
        &self,
        types: &HashMap<&str, &SimpleType>,
        pick: impl Fn(&TypeAttributes) -> Option<T>,
    ) -> Option<T> {
        let declared = || types.get(self.declared_type.as_deref()?);
        pick(&self.attributes).or_else(|| pick(&declared()?.attributes))
    }

    /// Place for findings.
    pub(super) fn place(&self) -> String {
        format!("{FILE}, line {}, variable `{}`", self.line, self.name)
    }
}

/// Default `initial` and the values that may be stated; outer `None`: this combination is not legal.
pub(super) fn initial_choices(
    causality: Causality,
    variability: Variability,
) -> Option<(Option<Initial>, &'static [Initial])> {
    use Initial::{Approx, Calculated, Exact};
    let exact: &[Initial] = &[Exact];
    let computed: &[Initial] = &[Approx, Calculated];
    let any: &[Initial] = &[Exact, Approx, Calculated];
    match (causality, variability) {
        (Causality::Parameter, Variability::Fixed | Variability::Tunable)
        | (Causality::Output | Causality::Local, Variability::Constant) => {
            Some((Some(Exact), exact))
        }
        (
            Causality::CalculatedParameter | Causality::Local,
            Variability::Fixed | Variability::Tunable,
        ) => Some((Some(Calculated), computed)),
        (Causality::Input, Variability::Discrete | Variability::Continuous)
        | (Causality::Independent, Variability::Continuous) => Some((None, &[])),
        (Causality::Output | Causality::Local, Variability::Discrete | Variability::Continuous) => {
            Some((Some(Calculated), any))
        }
        _ => None,
    }
}

/// A unit.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitDefinition {
    /// Name.
    pub name: String,
    /// Factor to the SI unit; `None` when not stated.
    pub factor: Option<f64>,
    /// Units for display, with their factor: `value in display unit = factor · value + offset`.
    pub display_units: Vec<(String, f64)>,
    /// Line in the file.
    pub line: usize,
}

/// A declared type.
#[derive(Debug, Clone, PartialEq)]
pub struct SimpleType {
    /// Name.
    pub name: String,
    /// Type.
    pub kind: VariableType,
    /// Unit, range and the like.
    pub attributes: TypeAttributes,
    /// Line in the file.
    pub line: usize,
}

/// An entry of `ModelStructure`.
#[derive(Debug, Clone, PartialEq)]
pub struct Unknown {
    /// Index of the variable, from 1.
    pub index: usize,
    /// Indices of the variables it depends on; `None`: on all.
    pub dependencies: Option<Vec<usize>>,
    /// How it depends on each.
    pub kinds: Option<Vec<String>>,
    /// Line in the file.
    pub line: usize,
}

/// Capabilities of the slave.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CoSimulation {
    /// Name of the library in `binaries/` and prefix of its C code.
    pub model_identifier: String,
    /// Another program must run too.
    pub needs_execution_tool: bool,
    /// The step may change.
    pub can_handle_variable_communication_step_size: bool,
    /// Input derivatives are used.
    pub can_interpolate_inputs: bool,
    /// Highest derivative of outputs.
    pub max_output_derivative_order: u32,
    /// `fmi2DoStep` may return before it is done.
    pub can_run_asynchronously: bool,
    /// One instance per process.
    pub can_be_instantiated_only_once_per_process: bool,
    /// The memory callbacks are not used.
    pub can_not_use_memory_management_functions: bool,
    /// States can be saved and restored.
    pub can_get_and_set_fmu_state: bool,
    /// States can be turned into bytes and back.
    pub can_serialize_fmu_state: bool,
    /// Directional derivatives.
    pub provides_directional_derivative: bool,
}

/// What to run when nothing else is said.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DefaultExperiment {
    /// Start, s.
    pub start_time: Option<f64>,
    /// End, s.
    pub stop_time: Option<f64>,
    /// Relative tolerance.
    pub tolerance: Option<f64>,
    /// Communication step, s.
    pub step_size: Option<f64>,
}

/// Where a variable of FMI 3.0 stands: an element of an array, or a variable that is none (the only one of 1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ArrayElement {
    /// Value reference of the array.
    pub reference: u32,
    /// Place in it, from 0.
    pub element: usize,
    /// Elements of the array.
    pub size: usize,
    /// Which functions read and set it, in the order of [`super::reading_fmi3::NUMERIC`]; `None` for a string.
    pub function: Option<usize>,
}

/// The model description.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ModelDescription {
    /// Version of the standard.
    pub fmi_version: String,
    /// Name of the model.
    pub model_name: String,
    /// Fingerprint that must be handed to the binary.
    pub guid: String,
    /// Program that made it.
    pub generation_tool: Option<String>,
    /// `flat` or `structured`.
    pub variable_naming_convention: String,
    /// Capabilities; `None` when it is not for co-simulation.
    pub co_simulation: Option<CoSimulation>,
    /// Units.
    pub units: Vec<UnitDefinition>,
    /// Declared types.
    pub types: Vec<SimpleType>,
    /// Names of log categories.
    pub log_categories: Vec<String>,
    /// Default experiment.
    pub default_experiment: DefaultExperiment,
    /// Variables; their index in `ModelStructure` is one more than the position here.
    pub variables: Vec<ScalarVariable>,
    /// Outputs.
    pub outputs: Vec<Unknown>,
    /// State derivatives.
    pub derivatives: Vec<Unknown>,
    /// Unknowns of the initialisation.
    pub initial_unknowns: Vec<Unknown>,
    /// Of FMI 3.0 where each variable stands; its value reference here is its place in the list. Empty for FMI 2.0.
    pub(super) elements: Vec<ArrayElement>,
}

impl ModelDescription {
    /// Whether it is of FMI 3.0.
    pub(super) fn is_fmi3(&self) -> bool {
        self.fmi_version.starts_with('3')
    }

    /// The start values of all numbers of an FMU of FMI 3.0, in the order of its elements.
    pub(super) fn start_values(&self) -> Vec<f64> {
        let start = |at: usize| match &self.variables[at].start {
            Some(Value::Real(x)) => *x,
            Some(Value::Integer(x)) => f64::from(*x),
            Some(Value::Boolean(x)) => f64::from(u8::from(*x)),
            _ => 0.0,
        };
        (0..self.elements.len()).map(start).collect()
    }

    /// The variable of that name.
    pub fn variable(&self, name: &str) -> Option<&ScalarVariable> {
        self.variables.iter().find(|v| v.name == name)
    }

    /// The variable with this index, which counts from one.
    pub(super) fn variable_at(&self, index: usize) -> Option<&ScalarVariable> {
        self.variables.get(index.checked_sub(1)?)
    }

    /// The declared types by name, the first of each: to look them up for many variables.
    pub fn types_by_name(&self) -> HashMap<&str, &SimpleType> {
        let mut types = HashMap::new();
        for t in &self.types {
            types.entry(t.name.as_str()).or_insert(t);
        }
        types
    }
}
