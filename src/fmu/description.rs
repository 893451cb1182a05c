//! `modelDescription.xml`, made from the variable table.
//!
//! Order of elements and attributes follow the XML schema of FMI 2.0; an empty list is left out. The text holds no path, and a
//! date only where its label states one, so that an export is reproducible byte for byte.

use super::log_categories::LOG_CATEGORIES;
use super::package::label::Label;
use super::si::SiUnit;
use super::vocabulary::{
    Causality, Dependency, DependencyKind, Element, FmiTerm, MODEL_IDENTIFIER, Resources,
    StartValue, Variable, VariableTable,
};
use crate::error::{Error, Result};
use crate::trained_model::Experiment;

/// More communication points than this make FMPy double the step of the default experiment.
const MAX_DEFAULT_STEPS: f64 = 1000.0;
/// Relative tolerance for importers that integrate: with the defaults of some, a growing motion is a sixth off after a second.
const TOLERANCE: f64 = 1e-6;

/// The description of an exported model, of all its variables or of `reals_only`.
///
/// # Errors
/// [`Error::Input`] when a number cannot stand in a description (not finite).
pub fn model_description(resources: &Resources, reals_only: bool, label: &Label) -> Result<String> {
    let table = resources.described_table()?;
    let (table, references) = &table.listed(reals_only);
    let variables = references.iter().zip(table.variables());
    let variables = variables.map(|(reference, v)| scalar(*reference, v));
    let variables = variables.collect::<Result<Vec<_>>>()?;
    let root = described(resources, label, "2.0", "guid")
        .containing(interfaces(table))
        .containing([
            Element::new("UnitDefinitions").containing(units(table)?),
            log_categories(),
            experiment(&resources.model.experiment)?,
            Element::new("ModelVariables").containing(variables),
            structure(table),
        ]);
    Ok(root.document())
}

pub(super) fn log_categories() -> Element {
    let categories = LOG_CATEGORIES.iter().map(|(name, description)| {
        Element::new("Category")
            .with("name", name.to_string_lossy())
            .with("description", description)
    });
    Element::new("LogCategories").containing(categories)
}

/// The root of a description with its attributes; `identity` is what the standard calls the GUID.
pub(super) fn described(
    resources: &Resources,
    label: &Label,
    version: &str,
    identity: &'static str,
) -> Element {
    let Resources {
        force,
        bridge,
        guid,
        ..
    } = resources;
    let alone = bridge.as_ref().is_some_and(|b| b.structure_alone);
    let what = match (bridge, force) {
        (Some(_), _) if alone => "Structure of a bridge without its wind forces",
        (Some(_), _) => "Whole bridge under self-excited wind forces",
        (None, None) => "Bridge deck section under self-excited wind forces",
        (None, Some(_)) => "Self-excited wind forces on a bridge deck, for a structure outside",
    };
    let forces = match bridge {
        Some(_) => "forces at nodes",
        None => "forces per unit length",
    };
    let name = resources.words(|m| &m.name);
    let kind = match alone {
        true => "modes".to_owned(),
        false => resources.words(|m| m.model.kind()),
    };
    let source = resources.words(|m| &m.provenance.source);
    Element::new("fmiModelDescription")
        .with("fmiVersion", version)
        .with("modelName", line(label.name.as_deref().unwrap_or(&name)))
        .with(identity, guid)
        .with(
            "description",
            line(&format!(
                "{what} ({name}, {kind}), {forces}; data: {source}"
            )),
        )
        .with("version", env!("CARGO_PKG_VERSION"))
        .with_any("author", label.author.as_deref().map(line))
        .with_any("copyright", label.copyright.as_deref().map(line))
        // the texts, and what holds for the data, are inside
        .with("license", "MIT OR Apache-2.0")
        .with(
            "generationTool",
            concat!("aerodeck ", env!("CARGO_PKG_VERSION")),
        )
        .with_any("generationDateAndTime", label.generated.as_deref())
        .with("variableNamingConvention", "structured")
}

/// What the runtime can do.
fn interfaces(table: &VariableTable) -> Vec<Element> {
    let both = |name| {
        Element::new(name)
            .with("modelIdentifier", MODEL_IDENTIFIER)
            .with("needsExecutionTool", false)
    };
    let with_states = |element: Element| {
        element
            .with("canBeInstantiatedOnlyOncePerProcess", false)
            .with("canNotUseMemoryManagementFunctions", true)
            .with("canGetAndSetFMUstate", true)
            .with("canSerializeFMUstate", true)
            .with("providesDirectionalDerivative", true)
    };
    let co_simulation = both("CoSimulation")
        .with("canHandleVariableCommunicationStepSize", true)
        .with("canInterpolateInputs", true)
        .with("maxOutputDerivativeOrder", 1)
        // spelt so in the standard
        .with("canRunAsynchronuously", false);
    let model_exchange = (!table.state_rates().is_empty()).then(|| {
        with_states(both("ModelExchange").with("completedIntegratorStepNotNeeded", false))
    });
    let co_simulation = [with_states(co_simulation)];
    model_exchange.into_iter().chain(co_simulation).collect()
}

/// Every unit that a variable uses, once, in the order of first use.
pub(super) fn units(table: &VariableTable) -> Result<Vec<Element>> {
    let mut used: Vec<&'static SiUnit> = Vec::new();
    for unit in table.variables().iter().filter_map(|v| v.unit) {
        if used.iter().all(|u| u.name != unit.name) {
            used.push(unit);
        }
    }
    used.into_iter().map(unit_definition).collect()
}

fn unit_definition(unit: &SiUnit) -> Result<Element> {
    let mut base = Element::new("BaseUnit");
    for (name, exponent) in ["kg", "m", "s", "rad"].into_iter().zip(unit.base) {
        base = base.with_any(name, (exponent != 0).then_some(exponent));
    }
    let factor = (unit.factor != 1.0).then_some(unit.factor);
    let mut children = vec![base.with_any("factor", factor.map(number).transpose()?)];
    for (name, factor) in unit.display {
        let shown = Element::new("DisplayUnit").with("name", name);
        children.push(shown.with("factor", number(*factor)?));
    }
    Ok(Element::new("Unit")
        .with("name", unit.name)
        .containing(children))
}

/// Attributes hold one line.
pub(super) fn line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Shortest decimal that gives the same number back.
pub(super) fn number(x: f64) -> Result<String> {
    if x.is_finite() {
        Ok(format!("{x:?}"))
    } else {
        let (place, expected) = ("modelDescription.xml", "a finite number");
        Err(Error::input(place, expected, x.to_string()))
    }
}

fn scalar(reference: usize, v: &Variable) -> Result<Element> {
    let scalar = Element::new("ScalarVariable").with("name", &v.name);
    Ok(with_role(scalar, reference, &v.description, v).containing([typed(v)?]))
}

/// Adds what both versions say of a variable of any type, behind its name.
pub(super) fn with_role(of: Element, reference: usize, description: &str, v: &Variable) -> Element {
    of.with("valueReference", reference)
        .with("description", description)
        .with("causality", v.causality.word())
        .with("variability", v.variability.word())
        .with_any("initial", v.initial.map(FmiTerm::word))
}

/// Adds what both versions say of a real variable.
pub(super) fn with_unit(of: Element, v: &Variable) -> Result<Element> {
    let text = |x: Option<f64>| x.map(number).transpose();
    Ok(of
        .with_any("quantity", v.quantity)
        .with_any("unit", v.unit.map(|u| u.name))
        .with_any("displayUnit", v.display_unit)
        .with_any("min", text(v.min)?)
        .with_any("max", text(v.max)?)
        .with_any("nominal", text(v.nominal)?))
}

fn typed(v: &Variable) -> Result<Element> {
    let element = Element::new(v.value.type_name());
    Ok(match &v.value {
        StartValue::Real(start) => with_unit(element, v)?
            .with_any("start", start.map(number).transpose()?)
            .with_any("derivative", v.derivative_of.map(|state| state + 1)),
        StartValue::Integer(start) => element.with_any("start", *start),
        StartValue::Boolean(start) => element.with_any("start", *start),
        StartValue::String(start) => element.with("start", start),
    })
}

pub(super) fn experiment(e: &Experiment) -> Result<Element> {
    Ok(Element::new("DefaultExperiment")
        .with("startTime", number(0.0)?)
        .with("stopTime", number(e.stop_time_s)?)
        .with("tolerance", number(TOLERANCE)?)
        .with("stepSize", number(default_step_s(e))?))
}

/// Outputs, rates of the states and unknowns of the initialisation with their dependencies, by one-based index, in the order of the table.
fn structure(table: &VariableTable) -> Element {
    let variables = || table.variables().iter().enumerate();
    let outputs = variables().filter(|(_, v)| v.causality == Causality::Output);
    let outputs = outputs.map(|(i, v)| unknown(i, &v.direct_inputs));
    let initial = variables().filter(|(_, v)| v.is_initial_unknown());
    let initial = initial.map(|(i, v)| unknown(i, &v.initial_dependencies));
    let rates = table.state_rates().into_iter();
    let rates = rates.map(|i| unknown(i, &table.variables()[i].direct_inputs));
    let rates: Vec<Element> = rates.collect();
    let rates = (!rates.is_empty()).then(|| Element::new("Derivatives").containing(rates));
    Element::new("ModelStructure")
        .containing([Element::new("Outputs").containing(outputs)])
        .containing(rates)
        .containing([Element::new("InitialUnknowns").containing(initial)])
}

fn unknown(at: usize, on: &[Dependency]) -> Element {
    let on = on.iter().map(|d| (d.on + 1, d.kind));
    depending(Element::new("Unknown").with("index", at + 1), on)
}

/// Adds what an unknown depends on, by index or value reference.
pub(super) fn depending(
    unknown: Element,
    on: impl Iterator<Item = (usize, DependencyKind)>,
) -> Element {
    let (on, kinds): (Vec<_>, Vec<_>) = on.map(|(on, kind)| (on.to_string(), kind.word())).unzip();
    unknown.with("dependencies", on.join(" ")).with_any(
        "dependenciesKind",
        (!kinds.is_empty()).then(|| kinds.join(" ")),
    )
}

/// Step of the default experiment, s: that of the model, or the smallest multiple of it that needs no more than a
/// thousand communication points.
pub(crate) fn default_step_s(e: &Experiment) -> f64 {
    let steps = e.stop_time_s / e.step_size_s;
    // rounding of 10/0.01 must not make a thousand and one of a thousand
    let multiple = (steps / MAX_DEFAULT_STEPS * (1.0 - 1e-12)).ceil().max(1.0);
    e.step_size_s * multiple
}
