//! From the XML tree to a [`ModelDescription`]. What is legal is taken; what is not becomes a finding and a default.

use super::description::{
    Causality, CoSimulation, DefaultExperiment, FILE, ModelDescription, ScalarVariable, SimpleType,
    TypeAttributes, UnitDefinition, Unknown, Value, Variability, VariableType,
};
use super::findings::FmuFindings;
use crate::standard::FmiTerm;
use crate::xml::Element;
use std::str::FromStr;

/// Children of the root in the order of the schema.
const ROOT_CHILDREN: [&str; 9] = [
    "ModelExchange",
    "CoSimulation",
    "UnitDefinitions",
    "TypeDefinitions",
    "LogCategories",
    "DefaultExperiment",
    "VendorAnnotations",
    "ModelVariables",
    "ModelStructure",
];

impl FmuFindings {
    /// Reads the description, with findings for everything that could not be read as the standard has it.
    pub(super) fn description(&mut self, root: &Element) -> ModelDescription {
        self.root(root);
        let below = |outer: &str, inner: &'static str| {
            let outer = root.child(outer).into_iter();
            outer.flat_map(move |e| e.children_named(inner))
        };
        let structure = root.child("ModelStructure");
        let [outputs, derivatives, initial_unknowns] =
            ["Outputs", "Derivatives", "InitialUnknowns"].map(|list| {
                let list = structure.and_then(|s| s.child(list)).into_iter();
                let unknowns = list.flat_map(|l| l.children_named("Unknown"));
                unknowns.map(|e| self.unknown(e)).collect()
            });
        ModelDescription {
            fmi_version: self.required(root, "fmiVersion"),
            model_name: self.required(root, "modelName"),
            guid: self.required(root, "guid"),
            generation_tool: text(root, "generationTool"),
            variable_naming_convention: text(root, "variableNamingConvention")
                .unwrap_or_else(|| "flat".into()),
            co_simulation: root.child("CoSimulation").map(|e| self.co_simulation(e)),
            units: below("UnitDefinitions", "Unit")
                .map(|e| self.unit(e))
                .collect(),
            types: below("TypeDefinitions", "SimpleType")
                .filter_map(|e| self.simple_type(e))
                .collect(),
            log_categories: below("LogCategories", "Category")
                .map(|e| self.required(e, "name"))
                .collect(),
            default_experiment: root
                .child("DefaultExperiment")
                .map(|e| self.default_experiment(e))
                .unwrap_or_default(),
            variables: below("ModelVariables", "ScalarVariable")
                .map(|e| self.variable(e))
                .collect(),
            outputs,
            derivatives,
            initial_unknowns,
            elements: Vec::new(),
        }
    }

    fn root(&mut self, root: &Element) {
        if root.name != "fmiModelDescription" {
            self.error(place(root), "<fmiModelDescription>", tag(&root.name));
        }
        let mut last = 0;
        for child in &root.children {
            match ROOT_CHILDREN.iter().position(|n| *n == child.name) {
                None => {
                    let expected = "an element of the FMI 2.0 schema";
                    self.error(place(child), expected, tag(&child.name));
                }
                Some(position) if position < last => {
                    let (own, other) = (tag(&child.name), tag(ROOT_CHILDREN[last]));
                    let expected = format!("{own} before {other}");
                    self.error(place(child), expected, "it after that");
                }
                Some(position) => last = position,
            }
        }
        for needed in ["ModelVariables", "ModelStructure"] {
            if root.child(needed).is_none() {
                self.error(FILE, tag(needed), "none");
            }
        }
        for list in [
            "UnitDefinitions",
            "TypeDefinitions",
            "LogCategories",
            "ModelVariables",
        ] {
            if let Some(empty) = root.child(list).filter(|l| l.children.is_empty()) {
                self.error(place(empty), "at least one entry", "an empty list");
            }
        }
    }

    fn required(&mut self, e: &Element, name: &str) -> String {
        text(e, name).unwrap_or_else(|| {
            self.error(place(e), format!("the attribute `{name}`"), "none");
            String::new()
        })
    }

    fn parsed<T: FromStr>(&mut self, e: &Element, name: &str, what: &str) -> Option<T> {
        let value = e.attribute(name)?.trim();
        let parsed = value.parse();
        parsed.map_err(|_| self.not_a(e, name, what, value)).ok()
    }

    fn not_a(&mut self, e: &Element, name: &str, what: &str, found: &str) {
        let place = format!("{}, attribute `{name}`", place(e));
        self.error(place, what, format!("`{found}`"));
    }

    /// A finite number. `INF` and `NaN` are spellings of XML Schema; the standard forbids both.
    fn real(&mut self, e: &Element, name: &str) -> Option<f64> {
        let value: f64 = self.parsed(e, name, "a number")?;
        if !value.is_finite() {
            self.not_a(e, name, "a finite number", e.attribute(name).unwrap_or(""));
            return None;
        }
        Some(value)
    }

    fn boolean(&mut self, e: &Element, name: &str) -> Option<bool> {
        match e.attribute(name)?.trim() {
            "true" | "1" => Some(true),
            "false" | "0" => Some(false),
            other => {
                self.not_a(e, name, "true or false", other);
                None
            }
        }
    }

    fn choice<T: FmiTerm>(&mut self, e: &Element, name: &str) -> Option<T> {
        let value = e.attribute(name)?;
        let found = T::ALL.iter().find(|(n, _)| *n == value).map(|(_, t)| *t);
        if found.is_none() {
            let names: Vec<_> = T::ALL.iter().map(|(n, _)| *n).collect();
            self.not_a(e, name, &format!("one of {}", names.join(", ")), value);
        }
        found
    }

    fn co_simulation(&mut self, e: &Element) -> CoSimulation {
        let mut flag = |name: &str| self.boolean(e, name).unwrap_or(false);
        CoSimulation {
            needs_execution_tool: flag("needsExecutionTool"),
            can_handle_variable_communication_step_size: flag(
                "canHandleVariableCommunicationStepSize",
            ),
            can_interpolate_inputs: flag("canInterpolateInputs"),
            // spelt so in the standard
            can_run_asynchronously: flag("canRunAsynchronuously"),
            can_be_instantiated_only_once_per_process: flag("canBeInstantiatedOnlyOncePerProcess"),
            can_not_use_memory_management_functions: flag("canNotUseMemoryManagementFunctions"),
            can_get_and_set_fmu_state: flag("canGetAndSetFMUstate"),
            can_serialize_fmu_state: flag("canSerializeFMUstate"),
            provides_directional_derivative: flag("providesDirectionalDerivative"),
            max_output_derivative_order: self
                .parsed(e, "maxOutputDerivativeOrder", "a whole number")
                .unwrap_or(0),
            model_identifier: self.required(e, "modelIdentifier"),
        }
    }

    fn default_experiment(&mut self, e: &Element) -> DefaultExperiment {
        DefaultExperiment {
            start_time: self.real(e, "startTime"),
            stop_time: self.real(e, "stopTime"),
            tolerance: self.real(e, "tolerance"),
            step_size: self.real(e, "stepSize"),
        }
    }

    fn unit(&mut self, e: &Element) -> UnitDefinition {
        let factor = e.child("BaseUnit").map(|b| {
            for exponent in ["kg", "m", "s", "A", "K", "mol", "cd", "rad"] {
                self.parsed::<i32>(b, exponent, "a whole number");
            }
            self.factor(b)
        });
        UnitDefinition {
            name: self.required(e, "name"),
            factor,
            display_units: e
                .children_named("DisplayUnit")
                .map(|d| (self.required(d, "name"), self.factor(d)))
                .collect(),
            line: e.line,
        }
    }

    /// The factor of a conversion, of which the offset must be a number too.
    fn factor(&mut self, e: &Element) -> f64 {
        let factor = self.real(e, "factor");
        self.real(e, "offset");
        factor.unwrap_or(1.0)
    }

    fn simple_type(&mut self, e: &Element) -> Option<SimpleType> {
        let name = self.required(e, "name");
        let (kind, child) = self.typed_child(e)?;
        Some(SimpleType {
            name,
            kind,
            attributes: self.type_attributes(child),
            line: e.line,
        })
    }

    fn typed_child<'e>(&mut self, e: &'e Element) -> Option<(VariableType, &'e Element)> {
        let kinds = [
            ("Real", VariableType::Real),
            ("Integer", VariableType::Integer),
            ("Boolean", VariableType::Boolean),
            ("String", VariableType::String),
            ("Enumeration", VariableType::Enumeration),
        ];
        let mut kinds = kinds.into_iter();
        let found = kinds.find_map(|(name, kind)| Some((kind, e.child(name)?)));
        if found.is_none() {
            let expected = "one of Real, Integer, Boolean, String, Enumeration";
            self.error(place(e), expected, "none");
        }
        found
    }

    fn type_attributes(&mut self, e: &Element) -> TypeAttributes {
        TypeAttributes {
            unit: text(e, "unit"),
            display_unit: text(e, "displayUnit"),
            min: self.real(e, "min"),
            max: self.real(e, "max"),
            nominal: self.real(e, "nominal"),
        }
    }

    fn variable(&mut self, e: &Element) -> ScalarVariable {
        let (kind, child) = self.typed_child(e).unwrap_or((VariableType::Real, e));
        let stated = self.choice(e, "variability");
        self.required(e, "valueReference");
        ScalarVariable {
            name: self.required(e, "name"),
            value_reference: self
                .parsed(e, "valueReference", "a whole number below 2³²")
                .unwrap_or(u32::MAX),
            description: text(e, "description"),
            causality: self.choice(e, "causality").unwrap_or(Causality::Local),
            variability: stated.unwrap_or(Variability::Continuous),
            variability_stated: stated.is_some(),
            initial: self.choice(e, "initial"),
            start: self.start(child, kind),
            declared_type: text(child, "declaredType"),
            attributes: self.type_attributes(child),
            derivative: self.parsed(child, "derivative", "an index"),
            kind,
            line: e.line,
        }
    }

    fn start(&mut self, e: &Element, kind: VariableType) -> Option<Value> {
        match kind {
            VariableType::Real => self.real(e, "start").map(Value::Real),
            VariableType::Integer | VariableType::Enumeration => {
                let whole = self.parsed(e, "start", "a whole number");
                whole.map(Value::Integer)
            }
            VariableType::Boolean => self.boolean(e, "start").map(Value::Boolean),
            VariableType::String => text(e, "start").map(Value::String),
        }
    }

    fn unknown(&mut self, e: &Element) -> Unknown {
        self.required(e, "index");
        let mut index = |word: &str| {
            let index = word.parse();
            index
                .map_err(|_| self.not_a(e, "dependencies", "indices", word))
                .ok()
        };
        let words = |name: &str| e.attribute(name).map(str::split_whitespace);
        let dependencies = words("dependencies").map(|list| list.filter_map(&mut index).collect());
        Unknown {
            dependencies,
            kinds: words("dependenciesKind").map(|list| list.map(str::to_owned).collect()),
            index: self.parsed(e, "index", "an index").unwrap_or(0),
            line: e.line,
        }
    }
}

fn text(e: &Element, name: &str) -> Option<String> {
    e.attribute(name).map(str::to_owned)
}

fn tag(name: &str) -> String {
    format!("<{name}>")
}

fn place(e: &Element) -> String {
    let name = e.attribute("name").map(|n| format!(" `{n}`"));
    let name = name.unwrap_or_default();
    format!("{FILE}, line {}, {}{name}", e.line, e.name)
}
