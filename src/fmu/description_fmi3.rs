//! `modelDescription.xml` of FMI 3.0, made from the same variable table: strips, modes and nodes are arrays, and the time has a variable.

use super::description::{described, experiment, log_categories, number, units};
use super::groups::{Groups, array_of};
use super::identity::MODEL_IDENTIFIER;
use super::package::label::Label;
use super::resources::Resources;
use super::standard::FmiTerm;
use super::variables::{Causality, InitialDependency, StartValue, Variable, VariableTable};
use super::xml::Element;
use crate::error::Result;
use std::collections::BTreeSet;

/// The description of an exported model.
///
/// # Errors
/// [`crate::Error::Input`] when a number cannot stand in a description (not finite).
pub fn model_description(resources: &Resources, label: &Label) -> Result<String> {
    let table = &resources.table;
    let groups = Groups::new(table);
    let listed = GroupedVariables { table, groups };
    let mut variables = Vec::new();
    for (reference, places) in listed.groups.all().iter().enumerate() {
        variables.push(listed.variable(reference, places)?);
    }
    variables.push(
        Element::new("Float64")
            .with("name", "time")
            .with("valueReference", listed.groups.time())
            .with("description", "Time")
            .with("causality", "independent")
            .with("variability", "continuous")
            .with("unit", "s"),
    );
    let second = Element::new("Unit")
        .with("name", "s")
        .containing([Element::new("BaseUnit").with("s", 1)]);
    let root = described(resources, label, "3.0", "instantiationToken")
        .containing(interfaces(table))
        .containing([
            Element::new("UnitDefinitions")
                .containing(units(table)?)
                .containing([second]),
            log_categories(),
            experiment(&resources.model.experiment)?,
            Element::new("ModelVariables").containing(variables),
            listed.structure(),
        ]);
    Ok(root.document())
}

/// What the runtime can do.
fn interfaces(table: &VariableTable) -> Vec<Element> {
    let both = |name| {
        Element::new(name)
            .with("modelIdentifier", MODEL_IDENTIFIER)
            .with("needsExecutionTool", false)
            .with("canBeInstantiatedOnlyOncePerProcess", false)
            .with("canGetAndSetFMUState", true)
            .with("canSerializeFMUState", true)
            .with("providesDirectionalDerivatives", true)
            .with("providesAdjointDerivatives", true)
            .with("providesPerElementDependencies", false)
    };
    let co_simulation = both("CoSimulation")
        .with("canHandleVariableCommunicationStepSize", true)
        .with("maxOutputDerivativeOrder", 1)
        .with("providesIntermediateUpdate", false)
        .with("mightReturnEarlyFromDoStep", false)
        .with("canReturnEarlyAfterIntermediateUpdate", false)
        .with("hasEventMode", false)
        .with("providesEvaluateDiscreteStates", false);
    let model_exchange = (!table.state_rates().is_empty()).then(|| {
        both("ModelExchange")
            .with("needsCompletedIntegratorStep", true)
            .with("providesEvaluateDiscreteStates", false)
    });
    model_exchange.into_iter().chain([co_simulation]).collect()
}

struct GroupedVariables<'a> {
    table: &'a VariableTable,
    groups: Groups,
}

impl GroupedVariables<'_> {
    fn at(&self, place: u32) -> &Variable {
        &self.table.variables()[place as usize]
    }

    fn variable(&self, reference: usize, places: &[u32]) -> Result<Element> {
        let v = self.at(places[0]);
        let kind = match v.value {
            StartValue::Real(_) => "Float64",
            StartValue::Integer(_) => "Int32",
            StartValue::Boolean(_) => "Boolean",
            StartValue::String(_) => "String",
        };
        let text = |x: Option<f64>| x.map(number).transpose();
        let array = array_of(v.role, &v.name);
        let description = match places.len() {
            1 => v.description.clone(),
            count => format!("{} (the first of {count})", v.description),
        };
        let element = Element::new(kind)
            .with("name", array.as_deref().unwrap_or(&v.name))
            .with("valueReference", reference)
            .with("description", description)
            .with("causality", v.causality.word())
            .with("variability", v.variability.word())
            .with_any("initial", v.initial.map(FmiTerm::word));
        let element = match &v.value {
            StartValue::Real(_) => {
                let starts = places.iter().filter_map(|p| match self.at(*p).value {
                    StartValue::Real(start) => start.map(number),
                    _ => None,
                });
                let starts = starts.collect::<Result<Vec<_>>>()?;
                let state = v.derivative_of.and_then(|s| self.groups.reference_of(s));
                element
                    .with_any("quantity", v.quantity)
                    .with_any("unit", v.unit.map(|u| u.name))
                    .with_any("displayUnit", v.display_unit)
                    .with_any("min", text(v.min)?)
                    .with_any("max", text(v.max)?)
                    .with_any("nominal", text(v.nominal)?)
                    .with_any("start", (!starts.is_empty()).then(|| starts.join(" ")))
                    .with_any("derivative", state)
            }
            StartValue::Integer(start) => element.with_any("start", *start),
            StartValue::Boolean(start) => element.with_any("start", *start),
            StartValue::String(start) => {
                element.containing([Element::new("Start").with("value", start)])
            }
        };
        let dimension = array.map(|_| Element::new("Dimension").with("start", places.len()));
        Ok(element.containing(dimension))
    }

    /// Outputs, rates of the states and unknowns of the initialisation with their dependencies, by value reference.
    fn structure(&self) -> Element {
        let all = || self.groups.all().iter().enumerate();
        let direct = |name: &'static str, reference: usize, places: &[u32]| {
            let on = places.iter().flat_map(|p| &self.at(*p).direct_inputs);
            self.unknown(name, reference, on.map(|on| (*on, "dependent")))
        };
        let outputs = all()
            .filter(|(_, places)| self.at(places[0]).causality == Causality::Output)
            .map(|(reference, places)| direct("Output", reference, places));
        let rates = self.table.state_rates().into_iter();
        let rates = rates.filter_map(|place| {
            let reference = self.groups.reference_of(place)?;
            let places = &self.groups.all()[reference];
            // an array once: its numbers follow one another among the states
            let first = places.first().is_some_and(|p| *p as usize == place);
            first.then(|| direct("ContinuousStateDerivative", reference, places))
        });
        let initial = all()
            .filter(|(_, places)| self.at(places[0]).is_initial_unknown())
            .map(|(reference, places)| {
                let of = places
                    .iter()
                    .flat_map(|p| &self.at(*p).initial_dependencies);
                let kind =
                    |d: &InitialDependency| if d.constant { "constant" } else { "dependent" };
                self.unknown("InitialUnknown", reference, of.map(|d| (d.on, kind(d))))
            });
        Element::new("ModelStructure")
            .containing(outputs)
            .containing(rates)
            .containing(initial)
    }

    fn unknown<'k>(
        &self,
        name: &'static str,
        reference: usize,
        on: impl Iterator<Item = (usize, &'k str)>,
    ) -> Element {
        let on: BTreeSet<(usize, &str)> = on
            .filter_map(|(place, kind)| Some((self.groups.reference_of(place)?, kind)))
            .collect();
        let (references, kinds): (Vec<_>, Vec<_>) = on
            .into_iter()
            .map(|(on, kind)| (on.to_string(), kind))
            .unzip();
        Element::new(name)
            .with("valueReference", reference)
            .with("dependencies", references.join(" "))
            .with_any(
                "dependenciesKind",
                (!kinds.is_empty()).then(|| kinds.join(" ")),
            )
    }
}
