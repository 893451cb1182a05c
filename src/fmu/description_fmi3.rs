//! `modelDescription.xml` of FMI 3.0, made from the same variable table: strips, modes and nodes are arrays, and the time has a variable.

use super::description::{
    depending, described, experiment, log_categories, number, units, with_role, with_unit,
};
use super::package::label::Label;
use super::vocabulary::{
    Causality, Dependency, Element, Groups, MAX_STRIPS, MODEL_IDENTIFIER, Resources, StartValue,
    Variable, VariableTable, array_of,
};
use crate::error::Result;
use std::collections::BTreeMap;

/// The description of an exported model.
///
/// # Errors
/// [`crate::Error::Input`] when a number cannot stand in a description (not finite).
pub fn model_description(resources: &Resources, label: &Label) -> Result<String> {
    let table = &resources.described_table()?;
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
    variables.extend(listed.names());
    variables.extend(listed.strips());
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
            .with("providesPerElementDependencies", true)
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
        let array = array_of(v.role, &v.name);
        let description = match places.len() {
            1 => v.description.clone(),
            count => format!(
                "{} (the first of {count}{})",
                v.description,
                self.named(reference)
            ),
        };
        let element = Element::new(kind).with("name", array.as_deref().unwrap_or(&v.name));
        let element = with_role(element, reference, &description, v);
        let element = match &v.value {
            StartValue::Real(_) => {
                let starts = places.iter().filter_map(|p| match self.at(*p).value {
                    StartValue::Real(start) => start.map(number),
                    _ => None,
                });
                let starts = starts.collect::<Result<Vec<_>>>()?;
                let state = v.derivative_of.and_then(|s| self.groups.reference_of(s));
                with_unit(element, v)?
                    .with_any("start", (!starts.is_empty()).then(|| starts.join(" ")))
                    .with_any("derivative", state)
            }
            StartValue::Integer(start) => element.with_any("start", *start),
            StartValue::Boolean(start) => element.with_any("start", *start),
            StartValue::String(start) => {
                element.containing([Element::new("Start").with("value", start)])
            }
        };
        let dimension = array.map(|_| match self.groups.strips_reference() {
            Some(strips) => Element::new("Dimension").with("valueReference", strips),
            None => Element::new("Dimension").with("start", places.len()),
        });
        Ok(element.containing(dimension))
    }

    /// Where the names of the elements of an array stand, in words.
    fn named(&self, reference: usize) -> String {
        let mut all = self.groups.names();
        let of = all.find(|(_, names)| names.arrays.contains(&reference));
        of.map_or_else(String::new, |(_, names)| {
            format!(", named in {}", names.name)
        })
    }

    /// The names of the elements of arrays, as constants.
    fn names(&self) -> impl Iterator<Item = Element> {
        self.groups.names().map(|(reference, names)| {
            let kind = names.kind;
            let which = match names.name.strip_prefix(kind) {
                Some("_name") => {
                    format!("Names of the {kind}s, in the order of every array of them")
                }
                _ => {
                    let first = self.groups.all()[names.arrays[0]][0];
                    let (_, of) = self.at(first).name.split_once("].").unwrap_or_default();
                    format!(
                        "Names of the {kind}s that have {of}, in the order of every array of these"
                    )
                }
            };
            let starts = names.of.iter().map(|name| name.to_string_lossy());
            let starts = starts.map(|name| Element::new("Start").with("value", name));
            Element::new("String")
                .with("name", &names.name)
                .with("valueReference", reference)
                .with("description", which)
                .with("causality", "local")
                .with("variability", "constant")
                .with("initial", "exact")
                .containing([Element::new("Dimension").with("start", names.of.len())])
                .containing(starts)
        })
    }

    /// The number of strips, which importers choose in the configuration mode.
    fn strips(&self) -> Option<Element> {
        let (reference, strips) = self.groups.strips_reference().zip(self.groups.strips())?;
        let text = "Number of strips, to be chosen in the configuration mode: those beyond the exported ones are like the last";
        Some(
            Element::new("UInt64")
                .with("name", "strips")
                .with("valueReference", reference)
                .with("description", text)
                .with("causality", "structuralParameter")
                .with("variability", "fixed")
                .with("start", strips)
                .with("min", 1)
                .with("max", MAX_STRIPS),
        )
    }

    /// Outputs, rates of the states and unknowns of the initialisation with their dependencies, by value reference.
    fn structure(&self) -> Element {
        let all = || self.groups.all().iter().enumerate();
        let direct = |name: &'static str, reference: usize, places: &[u32]| {
            let on = places.iter().flat_map(|p| &self.at(*p).direct_inputs);
            self.unknown(name, reference, on)
        };
        let outputs = all().filter(|(_, places)| self.at(places[0]).causality == Causality::Output);
        let outputs = outputs.map(|(reference, places)| direct("Output", reference, places));
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
                let of = places.iter().map(|p| &self.at(*p).initial_dependencies);
                self.unknown("InitialUnknown", reference, of.flatten())
            });
        Element::new("ModelStructure")
            .containing(outputs)
            .containing(rates)
            .containing(initial)
    }

    fn unknown<'a>(
        &self,
        name: &'static str,
        reference: usize,
        on: impl Iterator<Item = &'a Dependency>,
    ) -> Element {
        let mut kinds = BTreeMap::new();
        for d in on {
            if let Some(reference) = self.groups.reference_of(d.on) {
                let kind = kinds.entry(reference).or_insert(d.kind);
                *kind = d.kind.max(*kind);
            }
        }
        let unknown = Element::new(name).with("valueReference", reference);
        depending(unknown, kinds.into_iter())
    }
}
