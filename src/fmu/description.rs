//! `modelDescription.xml`, made from the variable table.
//!
//! Order of elements and attributes follow the XML schema of FMI 2.0; an empty list is left out. The text holds no date
//! and no path, so that an export is reproducible byte for byte.

mod xml;

use super::identity::MODEL_IDENTIFIER;
use super::variables::{Variable, VariableTable};
use crate::error::{Error, Result};
use crate::trained_model::{Experiment, TrainedModel};
use uuid::Uuid;

/// More communication points than this make FMPy double the step of the default experiment.
const MAX_DEFAULT_STEPS: f64 = 1000.0;

/// Categories of log messages with their descriptions, as the standard names them.
use super::log_categories::LOG_CATEGORIES;

/// The description of an exported model.
///
/// # Errors
/// [`Error::Input`] when a number cannot stand in a description (not finite).
pub fn model_description(
    model: &TrainedModel,
    table: &VariableTable,
    guid: &Uuid,
) -> Result<String> {
    let root = xml::Root {
        fmi_version: "2.0",
        model_name: line(&model.name),
        guid: guid.to_string(),
        description: line(&format!(
            "Bridge deck section under self-excited wind forces ({}), forces per unit length; data: {}",
            model.model.kind(),
            model.provenance.source
        )),
        version: env!("CARGO_PKG_VERSION"),
        license: line(&format!(
            "MIT OR Apache-2.0; data of the model: {}",
            model.provenance.licence
        )),
        generation_tool: concat!("aerodeck ", env!("CARGO_PKG_VERSION")),
        variable_naming_convention: "flat",
        co_simulation: xml::CoSimulation::new(MODEL_IDENTIFIER),
        units: xml::units(table)?,
        log_categories: xml::log_categories(&LOG_CATEGORIES),
        experiment: experiment(&model.experiment)?,
        variables: xml::Variables {
            list: table
                .variables()
                .iter()
                .enumerate()
                .map(|(i, v)| scalar(i, v))
                .collect::<Result<_>>()?,
        },
        structure: xml::structure(table),
    };
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let mut writer = quick_xml::se::Serializer::new(&mut text);
    writer.indent(' ', 2);
    serde::Serialize::serialize(&root, writer)
        .map_err(|e| Error::Numerical(format!("modelDescription.xml: {e}")))?;
    text.push('\n');
    Ok(text)
}

/// Attributes hold one line.
fn line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Shortest decimal that gives the same number back.
fn number(x: f64) -> Result<String> {
    if x.is_finite() {
        Ok(format!("{x:?}"))
    } else {
        Err(Error::input(
            "modelDescription.xml",
            "a finite number",
            x.to_string(),
        ))
    }
}

fn scalar(reference: usize, v: &Variable) -> Result<xml::ScalarVariable> {
    Ok(xml::ScalarVariable {
        name: v.name,
        reference,
        description: v.description.clone(),
        causality: xml::causality(v.causality),
        variability: xml::variability(v.variability),
        initial: v.initial.map(xml::initial),
        value: xml::typed_value(v)?,
    })
}

fn experiment(e: &Experiment) -> Result<xml::DefaultExperiment> {
    Ok(xml::DefaultExperiment {
        start: number(0.0)?,
        stop: number(e.stop_time_s)?,
        step: number(default_step_s(e))?,
    })
}

/// Step of the default experiment, s: that of the model, or the smallest multiple of it that needs no more than a
/// thousand communication points.
pub fn default_step_s(e: &Experiment) -> f64 {
    let steps = e.stop_time_s / e.step_size_s;
    // rounding of 10/0.01 must not make a thousand and one of a thousand
    let multiple = (steps / MAX_DEFAULT_STEPS * (1.0 - 1e-12)).ceil().max(1.0);
    e.step_size_s * multiple
}
