//! Systems of FMUs: System Structure and Parameterization 1.0, an archive with the units, who is connected to whom, and their
//! parameters.

use super::description::number;
use super::package::archive;
use super::ssv::{VERSION, parameter_set};
use super::vocabulary::Element;
use crate::error::{Error, Result, ensure};
use crate::trained_model::Experiment;
use std::collections::{BTreeMap, BTreeSet};

const STRUCTURE: &str = "http://ssp-standard.org/SSP1/SystemStructureDescription";
const COMMON: &str = "http://ssp-standard.org/SSP1/SystemStructureCommon";

/// A unit of a system.
#[derive(Debug, Clone)]
pub struct SystemComponent {
    /// Name in the system.
    pub name: String,
    /// Its FMU.
    pub fmu: Vec<u8>,
    /// Start values of parameters and of inputs that are not connected.
    pub values: Vec<(String, f64)>,
}

/// An output of one component that is an input of another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Connection {
    /// SystemComponent and its output.
    pub from: [String; 2],
    /// SystemComponent and its input.
    pub to: [String; 2],
}

/// Units and how they are connected.
#[derive(Debug, Clone)]
pub struct System {
    /// Name.
    pub name: String,
    /// The units.
    pub components: Vec<SystemComponent>,
    /// Who is connected to whom.
    pub connections: Vec<Connection>,
    /// What an importer runs that is not told otherwise.
    pub experiment: Experiment,
}

impl System {
    /// Its archive: the description, and units and parameter sets in `resources/`.
    ///
    /// # Errors
    /// [`Error::Input`] for a number that is not finite, for a connection of a component that is not there, and
    /// for an input with two.
    pub fn package(&self) -> Result<Vec<u8>> {
        for end in self.connections.iter().flat_map(|c| [&c.from, &c.to]) {
            let is_there = self.components.iter().any(|c| c.name == end[0]);
            let expected = "an output and an input of the components";
            ensure(is_there, "connection", expected, end.join("."))?;
        }
        let mut inputs: Vec<&[String; 2]> = self.connections.iter().map(|c| &c.to).collect();
        inputs.sort_unstable();
        if let Some(pair) = inputs.windows(2).find(|pair| pair[0] == pair[1]) {
            let found = format!("{} twice", pair[0].join("."));
            return Err(Error::input("connection", "an input each", found));
        }
        let mut files: BTreeMap<String, Vec<u8>> = BTreeMap::new();
        let description = self.description()?.into_bytes();
        files.insert("SystemStructure.ssd".into(), description);
        for component in &self.components {
            let values = parameter_set(&component.name, &component.values)?.into_bytes();
            files.insert(resource(&component.name, "ssv"), values);
            files.insert(resource(&component.name, "fmu"), component.fmu.clone());
        }
        archive(&files)
    }

    fn description(&self) -> Result<String> {
        let connection = |c: &Connection| {
            Element::new("ssd:Connection")
                .with("startElement", &c.from[0])
                .with("startConnector", &c.from[1])
                .with("endElement", &c.to[0])
                .with("endConnector", &c.to[1])
        };
        let components = self.components.iter().map(|of| self.component(&of.name));
        let system = Element::new("ssd:System")
            .with("name", &self.name)
            .containing([
                Element::new("ssd:Elements").containing(components),
                Element::new("ssd:Connections").containing(self.connections.iter().map(connection)),
            ]);
        let experiment = Element::new("ssd:DefaultExperiment")
            .with("startTime", number(0.0)?)
            .with("stopTime", number(self.experiment.stop_time_s)?);
        let root = Element::new("ssd:SystemStructureDescription")
            .with("xmlns:ssd", STRUCTURE)
            .with("xmlns:ssc", COMMON)
            .with("version", VERSION)
            .with("name", &self.name)
            .with(
                "generationTool",
                concat!("aerodeck ", env!("CARGO_PKG_VERSION")),
            );
        Ok(root.containing([system, experiment]).document())
    }

    /// A component with what is connected of it, an output that goes to several inputs once.
    fn component(&self, name: &str) -> Element {
        let connector = |kind: &'static str, [of, connector]: &[String; 2]| {
            (of == name).then(|| {
                Element::new("ssd:Connector")
                    .with("name", connector)
                    .with("kind", kind)
                    .containing([Element::new("ssc:Real")])
            })
        };
        let all = self.connections.iter();
        let inputs = all.filter_map(|c| connector("input", &c.to));
        let mut known = BTreeSet::new();
        let outputs = self.connections.iter().filter(|c| known.insert(&c.from));
        let connectors = inputs.chain(outputs.filter_map(|c| connector("output", &c.from)));
        let binding = Element::new("ssd:ParameterBinding").with("source", resource(name, "ssv"));
        Element::new("ssd:Component")
            .with("name", name)
            .with("type", "application/x-fmu-sharedlibrary")
            .with("source", resource(name, "fmu"))
            .containing([
                Element::new("ssd:Connectors").containing(connectors),
                Element::new("ssd:ParameterBindings").containing([binding]),
            ])
    }
}

fn resource(name: &str, ending: &str) -> String {
    format!("resources/{name}.{ending}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn system(connections: &[[&str; 4]]) -> System {
        let component = |name: &str| SystemComponent {
            name: name.to_owned(),
            fmu: Vec::new(),
            values: Vec::new(),
        };
        let connection = |ends: &[&str; 4]| {
            let [from, output, to, input] = ends.map(str::to_owned);
            Connection {
                from: [from, output],
                to: [to, input],
            }
        };
        System {
            name: "system".to_owned(),
            components: ["wind", "deck", "cable"].map(component).into(),
            connections: connections.iter().map(connection).collect(),
            experiment: Experiment {
                wind_speed_m_s: 20.0,
                initial_vertical_m: 0.01,
                initial_rotation_rad: 0.0,
                stop_time_s: 10.0,
                step_size_s: 0.01,
                onset_search_limit_m_s: 100.0,
            },
        }
    }

    #[test]
    fn an_output_of_several_inputs_is_one_connector() {
        let both = [["wind", "v", "deck", "v"], ["wind", "v", "cable", "v"]];
        let system = system(&both);
        assert!(system.package().is_ok());
        let text = system.description().unwrap();
        assert_eq!(text.matches("kind=\"output\"").count(), 1, "{text}");
        assert_eq!(text.matches("kind=\"input\"").count(), 2, "{text}");
        assert_eq!(text.matches("<ssd:Connection ").count(), 2, "{text}");
    }

    #[test]
    fn connections_of_nothing_and_two_into_one_input_are_refused() {
        let nowhere = system(&[["wind", "v", "tower", "v"]]).package();
        let message = nowhere.unwrap_err().to_string();
        assert!(message.contains("found tower.v"), "{message}");
        let twice = [["wind", "v", "deck", "v"], ["cable", "u", "deck", "v"]];
        let message = system(&twice).package().unwrap_err().to_string();
        assert!(message.contains("found deck.v twice"), "{message}");
    }
}
