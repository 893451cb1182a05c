//! Systems of FMUs: System Structure and Parameterization 1.0, an archive with the units, who is connected to whom, and their
//! parameters.

use super::Element;
use super::description::number;
use super::package::archive;
use super::ssv::{VERSION, parameter_set};
use crate::error::{Result, ensure};
use crate::trained_model::Experiment;
use std::collections::BTreeMap;

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
    /// [`Error::Input`](crate::Error::Input) for a number that is not finite, and for a connection between what is not there.
    pub fn package(&self) -> Result<Vec<u8>> {
        for end in self.connections.iter().flat_map(|c| [&c.from, &c.to]) {
            let is_there = self.components.iter().any(|c| c.name == end[0]);
            let expected = "an output and an input of the components";
            ensure(is_there, "connection", expected, end.join("."))?;
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

    /// A component with what is connected of it.
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
        let inputs = all.clone().filter_map(|c| connector("input", &c.to));
        let connectors = inputs.chain(all.filter_map(|c| connector("output", &c.from)));
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
