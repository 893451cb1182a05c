//! Elements of `modelDescription.xml` as structs; their fields stand in the order of the schema.

use super::number;
use crate::error::Result;
use crate::fmu::si::Unit;
use crate::fmu::variables::{
    self, Causality, Initial, Value, Variability, Variable, VariableTable,
};
use serde::Serialize;

#[derive(Serialize)]
#[serde(rename = "fmiModelDescription")]
pub(super) struct Root {
    #[serde(rename = "@fmiVersion")]
    pub fmi_version: &'static str,
    #[serde(rename = "@modelName")]
    pub model_name: String,
    #[serde(rename = "@guid")]
    pub guid: String,
    #[serde(rename = "@description")]
    pub description: String,
    #[serde(rename = "@version")]
    pub version: &'static str,
    #[serde(rename = "@license")]
    pub license: String,
    #[serde(rename = "@generationTool")]
    pub generation_tool: &'static str,
    #[serde(rename = "@variableNamingConvention")]
    pub variable_naming_convention: &'static str,
    #[serde(rename = "CoSimulation")]
    pub co_simulation: CoSimulation,
    #[serde(rename = "UnitDefinitions")]
    pub units: Units,
    #[serde(rename = "LogCategories")]
    pub log_categories: Categories,
    #[serde(rename = "DefaultExperiment")]
    pub experiment: DefaultExperiment,
    #[serde(rename = "ModelVariables")]
    pub variables: Variables,
    #[serde(rename = "ModelStructure")]
    pub structure: Structure,
}

/// What the runtime can do.
#[derive(Serialize)]
pub(super) struct CoSimulation {
    #[serde(rename = "@modelIdentifier")]
    identifier: &'static str,
    #[serde(rename = "@needsExecutionTool")]
    needs_execution_tool: bool,
    #[serde(rename = "@canHandleVariableCommunicationStepSize")]
    variable_step: bool,
    #[serde(rename = "@canInterpolateInputs")]
    interpolates_inputs: bool,
    #[serde(rename = "@maxOutputDerivativeOrder")]
    output_derivatives: u32,
    #[serde(rename = "@canRunAsynchronuously")]
    asynchronous: bool,
    #[serde(rename = "@canBeInstantiatedOnlyOncePerProcess")]
    only_once: bool,
    #[serde(rename = "@canNotUseMemoryManagementFunctions")]
    own_memory: bool,
    #[serde(rename = "@canGetAndSetFMUstate")]
    state: bool,
    #[serde(rename = "@canSerializeFMUstate")]
    serialized_state: bool,
    #[serde(rename = "@providesDirectionalDerivative")]
    directional_derivative: bool,
}

impl CoSimulation {
    pub(super) fn new(identifier: &'static str) -> Self {
        Self {
            identifier,
            needs_execution_tool: false,
            variable_step: true,
            interpolates_inputs: true,
            output_derivatives: 1,
            asynchronous: false,
            only_once: false,
            own_memory: true,
            state: true,
            serialized_state: true,
            directional_derivative: true,
        }
    }
}

#[derive(Serialize)]
pub(super) struct Units {
    #[serde(rename = "Unit")]
    list: Vec<UnitElement>,
}

#[derive(Serialize)]
struct UnitElement {
    #[serde(rename = "@name")]
    name: &'static str,
    #[serde(rename = "BaseUnit")]
    base: BaseUnit,
    #[serde(rename = "DisplayUnit")]
    display: Vec<DisplayUnit>,
}

#[derive(Serialize)]
struct BaseUnit {
    #[serde(rename = "@kg", skip_serializing_if = "is_zero")]
    kg: i8,
    #[serde(rename = "@m", skip_serializing_if = "is_zero")]
    m: i8,
    #[serde(rename = "@s", skip_serializing_if = "is_zero")]
    s: i8,
    #[serde(rename = "@rad", skip_serializing_if = "is_zero")]
    rad: i8,
    #[serde(rename = "@factor", skip_serializing_if = "Option::is_none")]
    factor: Option<String>,
}

#[derive(Serialize)]
struct DisplayUnit {
    #[serde(rename = "@name")]
    name: &'static str,
    #[serde(rename = "@factor")]
    factor: String,
}

fn is_zero(exponent: &i8) -> bool {
    *exponent == 0
}

/// Every unit that a variable uses, once, in the order of first use.
pub(super) fn units(table: &VariableTable) -> Result<Units> {
    let mut used: Vec<&'static Unit> = Vec::new();
    for unit in table.variables().iter().filter_map(|v| v.unit) {
        if used.iter().all(|u| u.name != unit.name) {
            used.push(unit);
        }
    }
    let list = used.into_iter().map(unit_element).collect::<Result<_>>()?;
    Ok(Units { list })
}

fn unit_element(unit: &'static Unit) -> Result<UnitElement> {
    let display = unit.display.iter().map(|d| {
        Ok(DisplayUnit {
            name: d.name,
            factor: number(d.factor)?,
        })
    });
    Ok(UnitElement {
        name: unit.name,
        base: BaseUnit {
            kg: unit.base.kg,
            m: unit.base.m,
            s: unit.base.s,
            rad: unit.base.rad,
            factor: (unit.factor != 1.0)
                .then(|| number(unit.factor))
                .transpose()?,
        },
        display: display.collect::<Result<_>>()?,
    })
}

#[derive(Serialize)]
pub(super) struct Categories {
    #[serde(rename = "Category")]
    list: Vec<Category>,
}

#[derive(Serialize)]
struct Category {
    #[serde(rename = "@name")]
    name: &'static str,
    #[serde(rename = "@description")]
    description: &'static str,
}

pub(super) fn log_categories(categories: &[(&'static str, &'static str)]) -> Categories {
    let list = categories
        .iter()
        .map(|&(name, description)| Category { name, description })
        .collect();
    Categories { list }
}

#[derive(Serialize)]
pub(super) struct DefaultExperiment {
    #[serde(rename = "@startTime")]
    pub start: String,
    #[serde(rename = "@stopTime")]
    pub stop: String,
    #[serde(rename = "@stepSize")]
    pub step: String,
}

#[derive(Serialize)]
pub(super) struct Variables {
    #[serde(rename = "ScalarVariable")]
    pub list: Vec<ScalarVariable>,
}

#[derive(Serialize)]
pub(super) struct ScalarVariable {
    #[serde(rename = "@name")]
    pub name: &'static str,
    #[serde(rename = "@valueReference")]
    pub reference: usize,
    #[serde(rename = "@description")]
    pub description: String,
    #[serde(rename = "@causality")]
    pub causality: &'static str,
    #[serde(rename = "@variability")]
    pub variability: &'static str,
    #[serde(rename = "@initial", skip_serializing_if = "Option::is_none")]
    pub initial: Option<&'static str>,
    #[serde(rename = "$value")]
    pub value: TypedValue,
}

#[derive(Serialize)]
pub(super) enum TypedValue {
    Real(RealElement),
    Integer(StartElement),
    Boolean(StartElement),
    String(StartElement),
}

#[derive(Serialize)]
pub(super) struct RealElement {
    #[serde(rename = "@quantity", skip_serializing_if = "Option::is_none")]
    quantity: Option<&'static str>,
    #[serde(rename = "@unit", skip_serializing_if = "Option::is_none")]
    unit: Option<&'static str>,
    #[serde(rename = "@displayUnit", skip_serializing_if = "Option::is_none")]
    display_unit: Option<&'static str>,
    #[serde(rename = "@min", skip_serializing_if = "Option::is_none")]
    min: Option<String>,
    #[serde(rename = "@max", skip_serializing_if = "Option::is_none")]
    max: Option<String>,
    #[serde(rename = "@nominal", skip_serializing_if = "Option::is_none")]
    nominal: Option<String>,
    #[serde(rename = "@start", skip_serializing_if = "Option::is_none")]
    start: Option<String>,
}

#[derive(Serialize)]
pub(super) struct StartElement {
    #[serde(rename = "@start", skip_serializing_if = "Option::is_none")]
    start: Option<String>,
}

pub(super) fn typed_value(v: &Variable) -> Result<TypedValue> {
    let text = |x: Option<f64>| x.map(number).transpose();
    let start = |start: Option<String>| StartElement { start };
    Ok(match &v.value {
        Value::Real(value) => TypedValue::Real(RealElement {
            quantity: v.quantity,
            unit: v.unit.map(|u| u.name),
            display_unit: v.display_unit,
            min: text(v.min)?,
            max: text(v.max)?,
            nominal: text(v.nominal)?,
            start: text(*value)?,
        }),
        Value::Integer(value) => TypedValue::Integer(start(value.map(|i| i.to_string()))),
        Value::Boolean(value) => TypedValue::Boolean(start(value.map(|b| b.to_string()))),
        Value::String(value) => TypedValue::String(start(Some(value.clone()))),
    })
}

pub(super) fn causality(c: Causality) -> &'static str {
    match c {
        Causality::Input => "input",
        Causality::Output => "output",
        Causality::Parameter => "parameter",
        Causality::CalculatedParameter => "calculatedParameter",
        Causality::Local => "local",
    }
}

pub(super) fn variability(v: Variability) -> &'static str {
    match v {
        Variability::Constant => "constant",
        Variability::Fixed => "fixed",
        Variability::Tunable => "tunable",
        Variability::Continuous => "continuous",
    }
}

pub(super) fn initial(i: Initial) -> &'static str {
    match i {
        Initial::Exact => "exact",
        Initial::Calculated => "calculated",
    }
}

#[derive(Serialize)]
pub(super) struct Structure {
    #[serde(rename = "Outputs")]
    outputs: Unknowns,
    #[serde(rename = "InitialUnknowns")]
    initial_unknowns: Unknowns,
}

#[derive(Serialize)]
struct Unknowns {
    #[serde(rename = "Unknown")]
    list: Vec<Unknown>,
}

#[derive(Serialize)]
struct Unknown {
    #[serde(rename = "@index")]
    index: usize,
    #[serde(rename = "@dependencies")]
    dependencies: String,
    #[serde(rename = "@dependenciesKind", skip_serializing_if = "String::is_empty")]
    kinds: String,
}

/// Outputs and unknowns of the initialisation with their dependencies, by one-based index, in the order of the table.
pub(super) fn structure(table: &VariableTable) -> Structure {
    let list = |wanted: fn(&Variable) -> bool, unknown: fn((usize, &Variable)) -> Unknown| {
        let variables = table.variables().iter().enumerate();
        Unknowns {
            list: variables.filter(|(_, v)| wanted(v)).map(unknown).collect(),
        }
    };
    Structure {
        outputs: list(
            |v| v.causality == variables::Causality::Output,
            |(i, v)| unknown(i, v.direct_inputs.iter().map(|&on| (on, "dependent"))),
        ),
        initial_unknowns: list(Variable::is_initial_unknown, |(i, v)| {
            let dependencies = v.initial_dependencies.iter();
            unknown(
                i,
                dependencies.map(|d| (d.on, if d.constant { "constant" } else { "dependent" })),
            )
        }),
    }
}

fn unknown(at: usize, on: impl Iterator<Item = (usize, &'static str)>) -> Unknown {
    let (indices, kinds): (Vec<_>, Vec<_>) =
        on.map(|(on, kind)| ((on + 1).to_string(), kind)).unzip();
    Unknown {
        index: at + 1,
        dependencies: indices.join(" "),
        kinds: kinds.join(" "),
    }
}
