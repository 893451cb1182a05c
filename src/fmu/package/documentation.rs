//! `documentation/index.html` of an exported section, made from the variable table and the trained model, and the variables of an archive as
//! its own description lists them.

use crate::aerodynamics::{RationalAdmittance, Realizable, Transfer};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result};
use crate::flutter::{Onset, OnsetSearch, find_onset};
use crate::fmu::package::runtime::Runtime;
use crate::fmu::vocabulary::{
    Element, FmiVersion, ForceOptions, Resources, Role, SectionParameter, Variable, VariableTable,
    each_once,
};
use crate::plausibility;
use crate::plausibility::{Finding, of_model, of_trained};
use crate::section::{Dof, SectionModel};
use crate::trained_model::{Model, TrainedModel};
use crate::units::{ReducedFrequency, ReducedVelocity};
use crate::verdict::{Evidence, Phenomenon, Severity, Verdict};
use askama::Template;
use std::collections::HashSet;

/// The page: one file, nothing loaded from elsewhere; version, names and types are those of the archive's `description`.
///
/// # Errors
/// [`Error::Input`] and [`Error::Numerical`] when the onset of the default section cannot be computed.
pub(super) fn documentation(
    resources: &Resources,
    runtimes: &[Runtime],
    description: &Element,
    verdict: Option<&Verdict>,
) -> Result<String> {
    let model = &resources.model;
    let fmi = description.attribute("fmiVersion").unwrap_or_default();
    let version = match fmi {
        "3.0" => FmiVersion::Three,
        _ => FmiVersion::Two,
    };
    let filters = resources.models().map(|m| m.model.realize().states());
    let page = DocumentationPage {
        model,
        name: resources.words(|m| &m.name),
        kind: resources.words(|m| m.model.kind()),
        fmi,
        exchange: description.child("ModelExchange").is_some(),
        has_arrays: version == FmiVersion::Three,
        guid: resources.guid.to_string(),
        version: env!("CARGO_PKG_VERSION"),
        filters: filters.max().unwrap_or(0),
        lateral: resources.models().any(|m| m.section.lateral.is_some()),
        platforms: runtimes
            .iter()
            .map(|r| (r.path_in_archive(version), r.words))
            .collect(),
        groups: groups(&shown(resources, description), version),
        models: resources.models().collect(),
        judged: match (&resources.force, verdict) {
            (None, _) => "Stability of the section as exported",
            (Some(_), Some(_)) => {
                "Stability of the structure that was judged with these forces, not of one that takes them"
            }
            (Some(_), None) => "What looks wrong in the forces",
        },
        stability: match (&resources.force, verdict) {
            (None, _) => stability(model, verdict)?,
            (Some(_), Some(verdict)) => sentences(verdict, None),
            (Some(_), None) => of_forces(resources),
        },
        force: resources.force.as_ref(),
        gusts: gusts(resources),
        sampling: resources.models().find_map(sampling),
    };
    page.render()
        .map_err(|e| Error::Numerical(format!("documentation page: {e}")))
}

#[derive(Template)]
#[template(path = "fmu_documentation.html")]
struct DocumentationPage<'a> {
    model: &'a TrainedModel,
    name: String,
    kind: String,
    fmi: &'a str,
    exchange: bool,
    has_arrays: bool,
    guid: String,
    version: &'static str,
    filters: usize,
    lateral: bool,
    platforms: Vec<(String, &'static str)>,
    groups: Vec<Group<'a>>,
    models: Vec<&'a TrainedModel>,
    judged: &'static str,
    stability: Vec<String>,
    force: Option<&'a ForceOptions>,
    gusts: Option<String>,
    sampling: Option<[String; 3]>,
}

/// What is said of gusts, where they are inputs.
fn gusts(resources: &Resources) -> Option<String> {
    let admittance = resources.gusts.as_ref()?.admittance;
    let further = resources.force.iter().flat_map(|force| &force.further);
    let further = further.filter_map(|f| f.gusts.as_ref());
    let all = resources.gusts.iter().chain(further);
    let sources = each_once(all.map(|g| g.source.as_str()));
    Some(gust_words(GUSTS_ARE_INPUTS, &sources, admittance))
}

pub(super) const GUSTS_ARE_INPUTS: &str = "Gusts along the mean wind and upwards are inputs";

/// What gusts act, of which coefficients their forces are, and what they pass first.
pub(super) fn gust_words(what: &str, source: &str, admittance: RationalAdmittance) -> String {
    let behind = match admittance {
        RationalAdmittance::None => "no admittance",
        RationalAdmittance::Sears => "the admittance of Sears",
        RationalAdmittance::Liepmann => "the admittance of Liepmann",
    };
    format!("{what}. The forces of gusts are those of {source}, with {behind}.")
}

/// Variables of one role.
struct Group<'a> {
    title: &'static str,
    note: &'static str,
    rows: Vec<Row<'a>>,
}

/// Of several strips those of the first of each model alone: all strips of a model have the same variables.
fn shown<'a>(resources: &Resources, description: &'a Element) -> Vec<Row<'a>> {
    let parts = resources.parts();
    let firsts: Vec<usize> = parts.iter().map(|p| p.strips.start).collect();
    let strip = |v: &Variable| {
        let name = v.name.strip_prefix("der(").unwrap_or(&v.name);
        name.split_once("].").map(|(strip, _)| strip.to_owned())
    };
    let of_first = |v: &&Variable| matches!(v.role, Role::Motion(s, ..) if firsts.contains(&s));
    let all = resources.table.variables().iter();
    let named: HashSet<String> = all.filter(of_first).filter_map(strip).collect();
    rows(description, &resources.table, |v| {
        strip(v).is_some_and(|strip| !named.contains(&strip))
    })
}

fn groups<'a>(rows: &[Row<'a>], version: FmiVersion) -> Vec<Group<'a>> {
    let group = |title, note, causality: &str, variability: &str| {
        let belongs =
            |row: &&Row<'_>| row.causality == causality && row.variability.starts_with(variability);
        Group {
            title,
            note,
            rows: rows.iter().filter(belongs).cloned().collect(),
        }
    };
    let inputs = match version {
        FmiVersion::Two => {
            "Continuous: held over a communication step, or on a straight line when the importer sets input derivatives."
        }
        FmiVersion::Three => "Continuous: held over a communication step.",
    };
    let tunable =
        "A change holds from the next communication step on and updates the calculated parameters.";
    let calculated = "From the current parameters; available from the initialisation mode on.";
    let changed = "Parameters that may be changed while running";
    let kept = "Parameters that are fixed once initialised";
    let computed = "Calculated parameters";
    vec![
        group("Inputs", inputs, "input", ""),
        group("Outputs", "At the communication points.", "output", ""),
        group(
            "Structural parameters",
            "Sizes of arrays, to be chosen before the initialisation.",
            "structuralParameter",
            "",
        ),
        group(changed, tunable, "parameter", "tunable"),
        group(kept, "", "parameter", "fixed"),
        group(computed, calculated, "calculatedParameter", ""),
        group("States and their rates", "", "local", "continuous"),
        group("Constants", "", "local", "constant"),
        group("Time", "", "independent", ""),
    ]
}

fn v_star(k: &ReducedFrequency) -> f64 {
    ReducedVelocity::from(*k).v_star()
}

fn still_air_hz(section: &SectionModel, dof: &Dof) -> f64 {
    SectionParameter::Frequency(*dof).value_in(section)
}

/// Sentences on the section as exported: the verdict that goes with it, or what its own searches amount to.
fn stability(model: &TrainedModel, verdict: Option<&Verdict>) -> Result<Vec<String>> {
    let structure = model.section.structure()?;
    let search = OnsetSearch::up_to(model.experiment.onset_search_limit_m_s);
    let section = CoupledSection::with_model(&structure, &model.model)?;
    let found = match find_onset(&model.name, &section, &search, Some(model.tested_range)) {
        Ok(found) => found,
        // a page that says so is better than no FMU
        Err(e) => return Ok(vec![format!("Flutter onset could not be determined: {e}.")]),
    };
    let motion = found.onset().map(motion);
    let own;
    let verdict = match verdict {
        Some(verdict) => verdict,
        None => {
            let at_rest = ReducedFrequency::from_full_width(0.0);
            let at_rest = model.model.transfer(at_rest)?;
            let tested = model.tested_range;
            let evidence =
                Evidence::of_section("the model", &section, &at_rest, tested, &search, found);
            own = Verdict::judge(&Evidence {
                implausible: of_trained(&model.section, model),
                ..evidence
            });
            &own
        }
    };
    Ok(sentences(verdict, motion))
}

/// What looks wrong in forces that have no section to be judged with.
fn of_forces(resources: &Resources) -> Vec<String> {
    let of = |m: &TrainedModel| of_model(&m.name, &m.model, m.tested_range, &[]);
    let found: Vec<Finding> = resources.models().flat_map(of).collect();
    plausibility::sentences(&found)
}

/// A verdict, sentence by sentence, with what is known of the motion at the onset.
pub(super) fn sentences(verdict: &Verdict, motion: Option<String>) -> Vec<String> {
    let mut sentences = vec![
        format!("{}.", verdict.headline),
        verdict.explanation.clone(),
    ];
    sentences.extend(motion);
    let divergence = verdict.critical.all();
    let divergence = divergence.filter(|c| c.phenomenon == Phenomenon::Divergence);
    sentences.extend(divergence.map(|c| {
        format!(
            "Static divergence at {} m/s by {}.",
            digits(c.best_m_s),
            c.forces
        )
    }));
    sentences.extend(verdict.doubts.iter().map(|d| match d.severity {
        Severity::Severe => format!("Severe doubt: {}.", d.text),
        Severity::Minor => format!("To be known: {}.", d.text),
    }));
    sentences
}

/// The motion at the onset.
fn motion(onset: &Onset) -> String {
    let (at, mode) = (&onset.at, onset.mode_in_words());
    let [speed, hertz] = [at.speed_m_s, at.frequency_hz].map(digits);
    let (v_star, k) = (
        at.reduced_velocity.v_star(),
        at.reduced_frequency.full_width(),
    );
    let [v_star, k] = [v_star, k].map(digits);
    format!("Flutter onset at {speed} m/s with {hertz} Hz, V* = {v_star}, K = {k}; {mode}.")
}

/// Of a discrete model: Δs, the wind speed of the experiment, and Δt there.
fn sampling(model: &TrainedModel) -> Option<[String; 3]> {
    let Model::DiscreteLaguerre(discrete) = &model.model else {
        return None;
    };
    let speed = model.experiment.wind_speed_m_s;
    let step_s = discrete.delta_s * model.section.width_m / speed;
    Some([discrete.delta_s, speed, step_s].map(digits))
}

/// Four significant digits.
fn digits(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return x.to_string();
    }
    let before = x.abs().log10().floor() as i32 + 1;
    let decimals = usize::try_from(4 - before).unwrap_or(0);
    format!("{x:.decimals$}")
}

/// A variable, or an array of them, in the words of the description.
#[derive(Debug, Clone)]
pub(super) struct Row<'a> {
    pub name: &'a str,
    pub kind: String,
    pub unit: String,
    pub start: String,
    pub limits: String,
    pub description: &'a str,
    pub causality: &'a str,
    pub variability: &'a str,
}

/// All but the variables of the `table` that are `left_out`.
pub(super) fn rows<'a>(
    description: &'a Element,
    table: &VariableTable,
    left_out: impl Fn(&Variable) -> bool,
) -> Vec<Row<'a>> {
    let out = table.variables().iter().filter(|v| left_out(v));
    let out: std::collections::HashSet<&str> = out.map(|v| v.name.as_str()).collect();
    let all = || description.child("ModelVariables").into_iter();
    let all = || all().flat_map(|list| &list.children);
    let named = |reference: &str| {
        let mut all = all();
        let found = all.find(|e| e.attribute("valueReference") == Some(reference));
        found.and_then(|e| e.attribute("name"))
    };
    let rows = all().map(|element| row(element, &named));
    rows.filter(|row| !out.contains(row.name)).collect()
}

fn row<'a>(element: &'a Element, named: &dyn Fn(&str) -> Option<&'a str>) -> Row<'a> {
    // FMI 2.0 has the type inside of the variable, FMI 3.0 in its place
    let typed = match element.name.as_str() {
        "ScalarVariable" => element.children.first().unwrap_or(element),
        _ => element,
    };
    let of = |name: &str| element.attribute(name).unwrap_or_default();
    let size = |d: &'a Element| {
        let of_another = || named(d.attribute("valueReference")?);
        d.attribute("start").or_else(of_another)
    };
    let sizes = element.children_named("Dimension").filter_map(size);
    let sizes = sizes.map(|size| format!("[{size}]"));
    let texts = element.children_named("Start");
    let mut starts: Vec<&str> = texts.filter_map(|e| e.attribute("value")).collect();
    starts.extend(
        typed
            .attribute("start")
            .iter()
            .flat_map(|s| match typed.name.as_str() {
                "String" => vec![*s],
                _ => s.split(' ').collect(),
            }),
    );
    // what all elements of an array begin with stands once
    starts.dedup();
    let unit = typed.attribute("unit").unwrap_or("–");
    let limit = |sign: &str, name: &str| Some(format!("{sign} {}", typed.attribute(name)?));
    let limits = [limit("≥", "min"), limit("≤", "max")];
    Row {
        name: of("name"),
        kind: typed.name.clone() + &sizes.collect::<String>(),
        unit: match typed.attribute("displayUnit") {
            Some(shown) => format!("{unit} (shown in {shown})"),
            None => unit.to_owned(),
        },
        start: starts.join(", "),
        limits: limits.into_iter().flatten().collect::<Vec<_>>().join(", "),
        description: of("description"),
        causality: of("causality"),
        variability: of("variability"),
    }
}

#[cfg(test)]
mod tests {
    use super::digits;

    #[test]
    fn four_digits_whatever_the_size() {
        for (x, text) in [
            (39.468_2, "39.47"),
            (0.091_234_5, "0.09123"),
            (-123.456, "-123.5"),
            (12_345.6, "12346"),
            (0.0, "0"),
        ] {
            assert_eq!(digits(x), text);
        }
    }
}
