//! A description of FMI 3.0 in the words of FMI 2.0, so that one reader, one set of rules and one set of trials serve both: numbers of
//! any width are `Real` or `Integer`, each element of an array is a variable of its own, and what `ModelStructure` refers to by value
//! reference it refers to by index.
//!
//! Clocks and binary variables have no counterpart and are left out.

use super::description::{ArrayElement, FILE};
use super::findings::FmuFindings;
use crate::xml::Element;
use std::collections::{HashMap, HashSet};

/// Types whose values are numbers, in the order of the functions that read and set them; what FMI 2.0 calls them.
pub(super) const NUMERIC: [(&str, &str); 11] = [
    ("Float64", "Real"),
    ("Float32", "Real"),
    ("Int8", "Integer"),
    ("UInt8", "Integer"),
    ("Int16", "Integer"),
    ("UInt16", "Integer"),
    ("Int32", "Integer"),
    ("UInt32", "Integer"),
    ("Int64", "Integer"),
    ("UInt64", "Integer"),
    ("Boolean", "Boolean"),
];
/// Most elements of all arrays, which are read one by one.
const MAX_ELEMENTS: usize = 1_000_000;

/// Attributes of the description and its capabilities that are spelt otherwise.
const RENAMED: [(&str, &str); 4] = [
    ("instantiationToken", "guid"),
    ("canGetAndSetFMUState", "canGetAndSetFMUstate"),
    ("canSerializeFMUState", "canSerializeFMUstate"),
    (
        "providesDirectionalDerivatives",
        "providesDirectionalDerivative",
    ),
];
/// Attributes that FMI 2.0 writes at the type of a variable, not at the variable.
const OF_THE_TYPE: [&str; 7] = [
    "declaredType",
    "quantity",
    "unit",
    "displayUnit",
    "min",
    "max",
    "nominal",
];

/// The description in the words of FMI 2.0, and where each of its variables stands in the FMU.
pub(super) fn translated(
    root: &Element,
    findings: &mut FmuFindings,
) -> (Element, Vec<ArrayElement>) {
    let mut described = Element {
        attributes: renamed(root),
        ..like(root, &root.name)
    };
    let variables = root.child("ModelVariables");
    let all = variables.map(|v| v.children.as_slice()).unwrap_or_default();
    let mut t = VariableIndex {
        sizes: all.iter().filter_map(structural).collect(),
        ..VariableIndex::default()
    };
    let sizes: Vec<Option<usize>> = all.iter().map(|v| t.place(v, findings)).collect();
    let mut list = variables.map(|list| {
        let made = all.iter().zip(sizes);
        like(list, &list.name).containing(made.flat_map(|(v, size)| t.variable(v, size)))
    });
    for child in &root.children {
        match child.name.as_str() {
            "ModelExchange" | "CoSimulation" => {
                let mut spelt = child.clone();
                spelt.attributes = renamed(child);
                described.children.push(spelt);
            }
            "TypeDefinitions" => {
                let types = child.children.iter().filter_map(simple_type);
                let types = like(child, &child.name).containing(types);
                // clocks and binaries alone leave no list
                described
                    .children
                    .extend((!types.children.is_empty()).then_some(types));
            }
            "ModelVariables" => described.children.extend(list.take()),
            "ModelStructure" => described.children.push(t.structure(child)),
            "ScheduledExecution" | "Annotations" => {}
            _ => described.children.push(child.clone()),
        }
    }
    (described, t.elements)
}

/// An element of that name in the same line.
fn like(of: &Element, name: &str) -> Element {
    Element {
        line: of.line,
        ..Element::new(name)
    }
}

fn renamed(of: &Element) -> Vec<(String, String)> {
    let mut spelt = of.attributes.clone();
    for (name, _) in &mut spelt {
        if let Some((_, two)) = RENAMED.iter().find(|(three, _)| three == name) {
            *name = (*two).to_owned();
        }
    }
    spelt
}

fn reference(of: &Element) -> &str {
    of.attribute("valueReference").unwrap_or("").trim()
}

/// What FMI 2.0 calls a type.
fn kind(of: &str) -> Option<&'static str> {
    let others = [("Enumeration", "Enumeration"), ("String", "String")];
    let mut all = NUMERIC.into_iter().chain(others);
    all.find(|(name, _)| *name == of).map(|(_, kind)| kind)
}

fn simple_type(of: &Element) -> Option<Element> {
    let mut typed = like(of, kind(of.name.strip_suffix("Type")?)?);
    let mut named = like(of, "SimpleType");
    for (name, value) in &of.attributes {
        let to = match name.as_str() {
            "name" | "description" => &mut named,
            _ => &mut typed,
        };
        to.attributes.push((name.clone(), value.clone()));
    }
    typed.children.clone_from(&of.children);
    Some(named.containing([typed]))
}

#[derive(Default)]
struct VariableIndex {
    elements: Vec<ArrayElement>,
    /// Index (from 1) of the first element of each variable, and how many there are, by value reference.
    indices: HashMap<String, (usize, usize)>,
    /// Elements that have a place.
    placed: usize,
    /// Value references of clocks and binary variables.
    left_out: HashSet<String>,
    /// Start values of structural parameters, by value reference.
    sizes: HashMap<String, usize>,
}

/// Value reference and start value of a structural parameter.
fn structural(v: &Element) -> Option<(String, usize)> {
    let reference = v.attribute("valueReference")?.trim().to_owned();
    let size = v.attribute("start")?.trim().parse().ok()?;
    (v.attribute("causality")? == "structuralParameter").then_some((reference, size))
}

impl VariableIndex {
    /// Number of elements; `None` for a variable that is no array.
    fn size(&self, v: &Element, findings: &mut FmuFindings) -> Option<usize> {
        let mut dimensions = v.children_named("Dimension").peekable();
        dimensions.peek()?;
        let of = |d: &Element| match (d.attribute("start"), d.attribute("valueReference")) {
            (Some(fixed), _) => fixed.trim().parse().ok(),
            (None, Some(reference)) => self.sizes.get(reference.trim()).copied(),
            _ => None,
        };
        let size = dimensions.try_fold(1_usize, |product, d| product.checked_mul(of(d)?));
        let size = size.filter(|size| self.placed.saturating_add(*size) <= MAX_ELEMENTS);
        if size.is_none() {
            let place = format!("{FILE}, line {}, {}", v.line, v.name);
            let expected =
                format!("dimensions that are known, at most {MAX_ELEMENTS} elements in all");
            findings.error(place, expected, "others");
        }
        Some(size.unwrap_or(0))
    }

    /// Gives the elements of a variable their indices; returns how many an array has.
    fn place(&mut self, v: &Element, findings: &mut FmuFindings) -> Option<usize> {
        let reference = reference(v).to_owned();
        if kind(&v.name).is_none() {
            self.left_out.insert(reference);
            return None;
        }
        let dimension = self.size(v, findings);
        let size = dimension.unwrap_or(1);
        let place = (self.placed + 1, size);
        if let Some(before) = self.indices.insert(reference, place) {
            let place = format!("{FILE}, line {}, {}", v.line, v.name);
            let found = format!("that of variable {}", before.0);
            findings.error(place, "a value reference of its own", found);
        }
        self.placed += size;
        dimension
    }

    /// The variable, or its elements.
    fn variable(&mut self, v: &Element, dimension: Option<usize>) -> Vec<Element> {
        let Some(kind) = kind(&v.name) else {
            return Vec::new();
        };
        let size = dimension.unwrap_or(1);
        let reference = reference(v);
        // as FMI 3.0 stores an enumeration
        let of_type = match kind {
            "Enumeration" => "Int64",
            _ => &v.name,
        };
        let function = NUMERIC.iter().position(|(name, _)| *name == of_type);
        let starts = starts(v);
        let mut made = Vec::with_capacity(size);
        for element in 0..size {
            // one start value stands for all
            let start = starts
                .get(element)
                .or(starts.first().filter(|_| starts.len() == 1));
            made.push(self.element(v, kind, dimension.map(|_| element), start));
            self.elements.push(ArrayElement {
                reference: reference.parse().unwrap_or(u32::MAX),
                element,
                size,
                function,
            });
        }
        made
    }

    /// One variable of FMI 2.0; its value reference is its place.
    fn element(
        &mut self,
        v: &Element,
        kind: &str,
        element: Option<usize>,
        start: Option<&String>,
    ) -> Element {
        let mut typed = like(v, kind);
        let mut scalar = like(v, "ScalarVariable");
        for (name, value) in &v.attributes {
            match name.as_str() {
                "name" => scalar = scalar.with("name", array_element_name(value, element)),
                "valueReference" => scalar = scalar.with(name, self.elements.len()),
                // their values are those of parameters until a configuration mode is entered
                "causality" if value == "structuralParameter" => {
                    scalar = scalar.with(name, "parameter");
                }
                "causality" | "variability" | "initial" | "description" => {
                    scalar = scalar.with(name, value);
                }
                "derivative" => {
                    let state = self.indices.get(value.trim());
                    let index = state.map(|(first, _)| first + element.unwrap_or(0));
                    typed = typed.with_any(name, index);
                }
                other if OF_THE_TYPE.contains(&other) => typed = typed.with(name, value),
                _ => {}
            }
        }
        if v.attribute("variability").is_none() {
            let variability = match v.attribute("causality") {
                Some("parameter" | "calculatedParameter" | "structuralParameter") => "fixed",
                _ if v.name.starts_with("Float") => "continuous",
                _ => "discrete",
            };
            scalar = scalar.with("variability", variability);
        }
        scalar.containing([typed.with_any("start", start)])
    }

    /// Lists by index; of an array every element, of which the first has the dependencies, on first elements.
    fn structure(&self, of: &Element) -> Element {
        let list = |from: &str, to: &str| {
            let mut unknowns: Vec<(usize, Element)> = Vec::new();
            for e in of.children_named(from) {
                let place = self.indices.get(reference(e)).copied();
                let (first, size) = place.unwrap_or_default();
                for index in first..first + size {
                    let unknown = like(e, "Unknown").with("index", index);
                    let unknown = match index == first {
                        true => self.dependencies(e, unknown),
                        false => unknown.with("dependencies", ""),
                    };
                    unknowns.push((index, unknown));
                }
            }
            unknowns.sort_by_key(|(index, _)| *index);
            like(of, to).containing(unknowns.into_iter().map(|(_, unknown)| unknown))
        };
        like(of, &of.name).containing([
            list("Output", "Outputs"),
            list("ContinuousStateDerivative", "Derivatives"),
            list("InitialUnknown", "InitialUnknowns"),
        ])
    }

    fn dependencies(&self, of: &Element, mut unknown: Element) -> Element {
        let Some(list) = of.attribute("dependencies") else {
            return unknown;
        };
        let kinds = of.attribute("dependenciesKind");
        let kinds: Option<Vec<&str>> = kinds.map(|k| k.split_whitespace().collect());
        let mut on: Vec<(usize, Option<&str>)> = Vec::new();
        for (place, reference) in list.split_whitespace().enumerate() {
            let kind = kinds.as_ref().and_then(|k| k.get(place).copied());
            match self.indices.get(reference) {
                Some((first, _)) => on.push((*first, kind)),
                // out of range, which the rules find
                None if !self.left_out.contains(reference) => on.push((0, kind)),
                None => {}
            }
        }
        on.sort_unstable();
        let indices: Vec<String> = on.iter().map(|(index, _)| index.to_string()).collect();
        unknown = unknown.with("dependencies", indices.join(" "));
        let words: Vec<&str> = on.iter().filter_map(|(_, kind)| *kind).collect();
        unknown.with_any("dependenciesKind", kinds.map(|_| words.join(" ")))
    }
}

/// Name of an element (counted from 0) of an array: `heave[2]`, `filter[1,2]`, `der(filter[1,2])`; that of the variable itself
/// where it is none.
pub fn array_element_name(array: &str, element: Option<usize>) -> String {
    let Some(element) = element else {
        return array.to_owned();
    };
    let (inner, end) = match array.strip_suffix(')') {
        Some(inner) if inner.starts_with("der(") => (inner, ")"),
        _ => (array, ""),
    };
    match inner.strip_suffix(']') {
        Some(open) => format!("{open},{}]{end}", element + 1),
        None => format!("{inner}[{}]{end}", element + 1),
    }
}

fn starts(v: &Element) -> Vec<String> {
    if v.name == "String" {
        let each = v
            .children_named("Start")
            .filter_map(|s| s.attribute("value"));
        return each.map(str::to_owned).collect();
    }
    let list = v.attribute("start").unwrap_or("");
    list.split_whitespace().map(str::to_owned).collect()
}
